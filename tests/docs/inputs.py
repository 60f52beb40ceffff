"""Makes the input files that commands in the docs name."""
import json
import math
import pathlib
import shutil
import struct
import subprocess

BUNNY = pathlib.Path("/usr/share/glmark2/models/bunny.obj")
PLANES = "scene:solids?detail=20000 --resolution 96,64 -o {file} --passes "


def write_model(path):
    """A ball with bumps: 2 x 24 x 12 triangles."""
    columns, rows = 24, 12
    lines = []
    for row in range(rows + 1):
        for column in range(columns):
            theta, phi = math.pi * row / rows, 2 * math.pi * column / columns
            radius = 1 + 0.15 * math.sin(5 * theta) * math.sin(4 * phi)
            lines.append("v {:.4f} {:.4f} {:.4f}".format(radius * math.sin(theta) * math.cos(phi), radius * math.cos(theta),
                                                         radius * math.sin(theta) * math.sin(phi)))
    for row in range(rows):
        for column in range(columns):
            a, b = row * columns + column + 1, row * columns + (column + 1) % columns + 1
            lines += [f"f {a} {b} {b + columns}", f"f {a} {b + columns} {a + columns}"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def gltf(uri):
    """Returns the JSON and the buffer of a pyramid in glTF that has three animations; uri is that of the buffer, or None."""
    positions = [(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1), (0, 1.5, 0)]
    indices = [0, 1, 2, 0, 2, 3, 0, 4, 1, 1, 4, 2, 2, 4, 3, 3, 4, 0]
    parts = [(34962, "VEC3", 5126, 5, struct.pack("<15f", *(x for p in positions for x in p))),
             (34963, "SCALAR", 5123, 18, struct.pack("<18H", *indices)),
             (None, "SCALAR", 5126, 2, struct.pack("<2f", 0, 2)),
             (None, "VEC3", 5126, 2, struct.pack("<6f", 0, 0, 0, 0, 1, 0))]
    views, accessors, data = [], [], b""
    for target, kind, component, count, part in parts:
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(part), **({"target": target} if target else {})})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind})
        data += part
    accessors[0].update(min=[-1, 0, -1], max=[1, 1.5, 1])
    accessors[2].update(min=[0], max=[2])
    animation = {"samplers": [{"input": 2, "output": 3}],
                 "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}
    return json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                       "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "animations": [animation] * 3,
                       "accessors": accessors, "bufferViews": views,
                       "buffers": [{"byteLength": len(data), **({"uri": uri} if uri else {})}]}), data


def write_gltf(path):
    text, data = gltf(path.with_suffix(".bin").name)
    path.write_text(text, encoding="utf-8")
    path.with_suffix(".bin").write_bytes(data)


def write_glb(path):
    text, data = gltf(None)
    words = text.encode() + b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(words) + len(data)) +
                     struct.pack("<I4s", len(words), b"JSON") + words +
                     struct.pack("<I4s", len(data), b"BIN\0") + data)


def write_stl(path):
    """A tetrahedron as a binary STL file."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    path.write_bytes(bytes(80) + struct.pack("<I", len(faces)) +
                     b"".join(struct.pack("<12fH", 0, 0, 0, *(x for corner in face for x in corners[corner]), 0)
                              for face in faces))


def write_hdr(path):
    """Radiance HDR, 32 x 16: a bright patch in a grey sky."""
    pixels = b"".join(bytes((200, 200, 255, 128)) if (row, column) != (4, 8) else bytes((255, 240, 200, 138))
                      for row in range(16) for column in range(32))
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n" + pixels)


def write_tiff(path):
    """An elevation model: TIFF of 48 x 32 floats in one strip."""
    width, height = 48, 32
    heights = [20 * math.sin(column / 6) * math.cos(row / 5) for row in range(height) for column in range(width)]
    pixels = struct.pack(f"<{len(heights)}f", *heights)
    tags = [(256, width), (257, height), (258, 32), (259, 1), (262, 1), (273, 8), (277, 1), (278, height),
            (279, len(pixels)), (339, 3)]
    directory = struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags)
    path.write_bytes(struct.pack("<2sHI", b"II", 42, 8 + len(pixels)) + pixels + directory + struct.pack("<I", 0))


def write_wing(path):
    """A PLY file of 12 x 8 squares with values at its vertices."""
    columns, rows = 12, 8
    lines = ["ply", "format ascii 1.0", f"element vertex {(columns + 1) * (rows + 1)}"]
    lines += [f"property float {name}" for name in ("x", "y", "z", "pressure", "velocity_x", "velocity_y", "velocity_z")]
    lines += [f"element face {columns * rows}", "property list uchar int vertex_indices", "end_header"]
    for row in range(rows + 1):
        for column in range(columns + 1):
            x, z = column / columns, 3 * row / rows
            lines.append(f"{x} {0.1 * math.sin(math.pi * x):.4f} {z} {math.cos(4 * x) + 0.2 * z:.4f} {1 + x} 0 {0.3 * z}")
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            lines.append(f"4 {a} {a + columns + 1} {a + columns + 2} {a + 1}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_bunny(path):
    if BUNNY.exists():
        shutil.copy(BUNNY, path)
    else:
        write_model(path)


def write_folder(path):
    path.mkdir()
    write_model(path / "ball.obj")
    write_gltf(path / "pyramid.gltf")



# File that the docs name -> function that writes it, or words of the command that draws it. A page gets the files whose
# names it contains.
INPUTS = {
    "bunny.obj": write_bunny,
    "stanford-bunny.obj": write_bunny,
    "body.obj": write_model,
    "wheels.obj": write_model,
    "chart.gltf": write_gltf,
    "Sponza.gltf": write_gltf,
    "part.stl": write_stl,
    "wing.ply": write_wing,
    "robot.glb": write_glb,
    "model.glb": write_glb,
    "models": write_folder,
    "studio.hdr": write_hdr,
    "noon.hdr": write_hdr,
    "dem.tif": write_tiff,
    "render.exr": PLANES + "beauty",
    "five.exr": PLANES + "beauty",
    "shot.0001.exr": PLANES + "beauty",
    "shot.0002.exr": PLANES + "beauty",
    "f.0001.exr": PLANES + "beauty",
    "f.0002.exr": PLANES + "beauty",
    "z.png": PLANES + "depth",
    "n.png": PLANES + "normal",
    "color.png": PLANES + "albedo",
    "photo_depth.png": PLANES + "depth",
}


def make_inputs(program, folder, env):
    """Writes all files into the folder."""
    for name, how in INPUTS.items():
        if callable(how):
            how(folder / name)
        else:
            words = [word.format(file=folder / name) for word in how.split()]
            subprocess.run([program, *words], check=True, env=env, stdin=subprocess.DEVNULL)


def copy_inputs(text, source, folder):
    """Copies those files that a page names into the folder for its commands."""
    for name in INPUTS:
        shown = name if "0" not in name else name.split(".")[0] + ".####"
        if shown not in text and name != "render.exr" and name != "bunny.obj":
            continue
        for path in [source / name, (source / name).with_suffix(".bin")]:
            if path.is_dir():
                shutil.copytree(path, folder / path.name)
            elif path.exists():
                shutil.copy(path, folder)
