"""Draws models with Blender 4.3 for docs/ranking.md: blender -b -P blender.py -- workbench|cycles OUTPUT_FOLDER MODEL..."""
import math
import os
import sys

import bpy
from mathutils import Matrix, Vector

SIZE = 400


def load(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    kind = path.rsplit(".", 1)[1].lower()
    importers = {
        "obj": bpy.ops.wm.obj_import,
        "ply": bpy.ops.wm.ply_import,
        "stl": bpy.ops.wm.stl_import,
        "glb": bpy.ops.import_scene.gltf,
    }
    importers[kind](filepath=path)
    objects = [o for o in bpy.context.scene.objects if o.type == "MESH"]
    for o in objects:
        if kind == "ply":  # these files have +y up
            o.matrix_world = Matrix.Rotation(math.radians(90), 4, "X") @ o.matrix_world
        if kind != "glb":
            o.data.shade_smooth()
            o.data.set_sharp_from_angle(angle=math.radians(40))
    bpy.context.view_layer.update()
    return [o.matrix_world @ v.co for o in objects for v in o.data.vertices]


def add_camera(points):
    """Views the points from 30 degrees to the side and 20 above, as Umbrage does. Returns their lowest corner, centre and radius."""
    low = Vector([min(p[i] for p in points) for i in range(3)])
    high = Vector([max(p[i] for p in points) for i in range(3)])
    center, radius = (low + high) / 2, (high - low).length / 2
    azimuth, elevation = math.radians(30), math.radians(20)
    side = Vector((math.sin(azimuth), -math.cos(azimuth), math.tan(elevation))).normalized()
    data = bpy.data.cameras.new("camera")
    data.angle, data.clip_start, data.clip_end = math.radians(35), radius * 0.01, radius * 100
    camera = bpy.data.objects.new("camera", data)
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    camera.rotation_euler = side.to_track_quat("Z", "Y").to_euler()
    camera.location = center + side * radius * 4
    bpy.context.view_layer.update()
    some = points[:: max(1, len(points) // 20000)]
    fitted, _ = camera.camera_fit_coords(bpy.context.evaluated_depsgraph_get(), [x for p in some for x in p])
    camera.location = center + (fitted - center) * 1.18
    return low, center, radius


def light_workbench(scene):
    scene.render.engine = "BLENDER_WORKBENCH"
    shading = scene.display.shading
    shading.light, shading.color_type = "STUDIO", "MATERIAL"
    shading.show_cavity, shading.cavity_type, shading.show_shadows = True, "BOTH", True


def light_cycles(scene, low, center, radius):
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 48, False  # Debian builds Blender without a denoiser
    world = scene.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    image = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    lights = os.path.join(bpy.utils.resource_path("SYSTEM"), "datafiles/studiolights/world/studio.exr")
    image.image = bpy.data.images.load(lights)
    world.node_tree.links.new(image.outputs[0], world.node_tree.nodes["Background"].inputs[0])
    bpy.ops.mesh.primitive_plane_add(size=radius * 40, location=(center.x, center.y, low.z))
    bpy.context.object.is_shadow_catcher = True


engine, folder, *models = sys.argv[sys.argv.index("--") + 1 :]
for model in models:
    placed = add_camera(load(model))
    scene = bpy.context.scene
    scene.render.film_transparent = True
    if engine == "cycles":
        light_cycles(scene, *placed)
    else:
        light_workbench(scene)
    scene.render.filepath = os.path.join(folder, os.path.basename(model).split(".")[0] + ".png")
    bpy.ops.render.render(write_still=True)
