"""Tests of messages about invalid arguments: one sentence with the argument, the value and what is accepted."""
import copy
import math
import pickle
import re
import unittest
from typing import Any, Callable

import numpy as np

import umbrage
from support import SOLIDS, plane_depth

DEPTH = plane_depth(8, 8)
POINTS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], np.float32)
FACES = np.array([(0, 1, 2)])


def rendered(**arguments: Any) -> Callable[[], Any]:
    return lambda: umbrage.render("missing.obj", **{"size": (8, 8), "device": "cpu", **arguments})


def shaded(**arguments: Any) -> Callable[[], Any]:
    return lambda: umbrage.shade(**{"depth": DEPTH, "device": "cpu", **arguments})


def meshed(**arguments: Any) -> Callable[[], Any]:
    return lambda: umbrage.Scene(**{"vertices": POINTS, "faces": FACES, **arguments})


class Messages(unittest.TestCase):
    def said(self, call: Callable[[], Any], text: str) -> None:
        with self.subTest(text):
            with self.assertRaises(umbrage.UsageError) as caught:
                call()
            message = str(caught.exception)
            self.assertRegex(message, text)
            self.assertFalse(re.search(r"[\n]|umb[A-Z]|\bC\b|None None", message), message)
            self.assertLess(len(message), 900)
            self.assertFalse(message.endswith(".") and not message.endswith("..."), message)
            self.assertEqual(caught.exception.code, 2)

    def test_misspelt_names(self) -> None:
        for call, text in (
            (rendered(lok="ao"), r"no parameter 'lok' \(did you mean 'look'\?\)"),
            (rendered(siz=(3, 3)), "'size'"),
            (rendered(backgroud=(1, 1, 1)), "'background'"),
            (rendered(devise="cpu"), "'device'"),
            (rendered(uo="+Z"), "'up'"),
            (rendered(lok=None), "'look'"),
            (rendered(nothing_like_it=1), r"\(available: model, size, look, camera"),
            (rendered(camera={"zom": 2}), r"a camera has no parameter 'zom' \(did you mean 'zoom'\?\)"),
            (rendered(camera={"sight": 2}), "available: position, focal_point"),
            (rendered(camera={"azimuth": 30}), "'azimuth_deg'"),
            (rendered(camera={"fov": 30}), "'view_angle_deg'"),
            (rendered(size=256), r"such as \(1024, 1024\), not 256"),
            (rendered(no_background=True), "'transparent'"),
            (rendered(settings={"bitmask.raduis": 1}), "'radius'|'bitmask.radius'"),
            (rendered(settings={"bitmusk.radius": 1}), "'bitmask'"),
            (rendered(look="studo"), "'studio'"),
            (rendered(passes="depht"), "'depth'"),
            (shaded(fvo=40), "'fov'"),
            (shaded(nera=1), "'near'"),
            (shaded(near_plane=1), "'near'"),
            (shaded(scene_radios=1), "'scene_radius'"),
            (shaded(images={"norml": DEPTH}), "'normal'"),
            (shaded(effects="bitmusk"), "'bitmask'"),
            (meshed(colrs=POINTS), r"a Scene has no argument 'colrs' \(did you mean 'colors'\?\)"),
            (meshed(crease_angle=3), "available: vertices, faces, up, crease_angle_deg"),
            (lambda: umbrage.Scene.load(SOLIDS, point_sise=1), "'point_size'"),
            (lambda: umbrage.Scene(upp="+Z"), "'up'"),
            (lambda: umbrage.parameters("bitmusk"), "'bitmask'"),
            (lambda: umbrage.Shader(device="cpu").counter("planes_copid"), "'planes_copied'"),
        ):
            self.said(call, text)
        picture = umbrage.render(SOLIDS, size=(8, 8), device="cpu", passes="depth")
        with self.assertRaisesRegex(KeyError, "did you mean 'depth'"):
            picture["depht"]

    def test_wrong_types(self) -> None:
        for call, text in (
            (rendered(progress=3), "`progress` takes True, False or a function of one number, not 3"),
            (shaded(progress="bar"), "`progress` takes .* not 'bar'"),
            (lambda: umbrage.Scene().add(SOLIDS, progress=1), "`progress`"),
            (shaded(intrinsics=[[-9, 0, 4], [0, 9, 4], [0, 0, 1]]), "`intrinsics` has fx -9, fy 9, cx 4 and cy 4: .* above 0$"),
            (shaded(intrinsics=np.diag([1.5, 2, -1, 0])), "`intrinsics` has .* projection matrix .* `fov` or `window`"),
            (shaded(intrinsics=np.array([[9, 0, 4], [0, 9, 4], [0, 0, 1]]), fov=40), "`intrinsics` excludes `fov`"),
            (rendered(size=("abc", 3)), "`width` takes an integer, not 'abc'"),
            (rendered(size=(3, True)), "`height` takes an integer, not True"),
            (rendered(size=3), r"`size` takes \(width, height\), such as \(1024, 1024\), not 3"),
            (rendered(width="abc"), "`width` cannot be set: `size`"),
            (shaded(height=8), "`height` cannot be set: the shape of depth"),
            (rendered(look=3), "`look` takes one of .*, not 3"),
            (rendered(look=True), "`look` takes one of .*, not True"),
            (rendered(ground=1), "`ground` takes one of auto, on, off, not 1"),
            (rendered(quality=np.float32(2)), "`quality` takes one of .*, not 2.0"),
            (rendered(transparent=3), "`transparent` takes True or False, not 3"),
            (rendered(anti_aliasing="abc"), "`anti_aliasing` cannot be 'abc': it takes an integer"),
            (rendered(anti_aliasing=object()), "`anti_aliasing` takes an integer, not <object"),
            (rendered(anti_aliasing=True), "`anti_aliasing` takes an integer, not True"),
            (rendered(background="abc"), "`background` cannot be 'abc': it takes a CSS name"),
            (rendered(background={}), "`background` "),
            (rendered(background=[None] * 3), "`background` takes three numbers, not"),
            (rendered(camera=3), "`camera` takes a Camera or a dict, not 3"),
            (rendered(camera={"position": "here"}), "`camera.position` cannot be 'here'"),
            (rendered(passes=3), "`passes` takes names, not 3"),
            (rendered(settings=3), "`settings` takes a dict by name, not 3"),
            (rendered(settings={3: 3}), "`settings` takes a dict by name, not {3: 3}"),
            (rendered(device=3), "`device` takes a string, not 3"),
            (rendered(threads="all"), "`threads` takes an integer, not 'all'"),
            (rendered(dtype="int8"), "`dtype` takes one of uint8, uint16, float16, float32, not 'int8'"),
            (rendered(up=object()), "`up` takes a string or numbers, not"),
            (shaded(depth_scale=0.001), "`depth_scale` is for files"),
            (shaded(focal_length_px=-800), "`focal_length_px` cannot be '-800': it takes one number above 0"),
            (shaded(focal_length_px=800, fov=40), "`focal_length_px` excludes `fov` and `window`"),
            (shaded(intrinsics=[[1, 2]]), r"`intrinsics` has the shape \(1, 2\): it takes a 3 x 3 matrix"),
            (shaded(mask=[[True]]), r"`mask` has the shape \(1, 1\)"),
            (shaded(flip=True), "`flip` is for files"),
            (shaded(fov="abc"), "`fov` takes a number, not 'abc'"),
            (shaded(fov=math.nan), "`fov` cannot be nan: it takes degrees"),
            (shaded(near=[]), r"`near` takes a number, not \[\]"),
            (lambda: umbrage.shade("missing.npy", fov=500), "`fov` cannot be"),
            (lambda: umbrage.render(SOLIDS, size=(8, 8), device="cpu").save("lines.svg"), "strokes=True"),
            (shaded(window=3), "`window` cannot be '3': it takes 4 numbers"),
            (shaded(orthographic="abc"), "`orthographic` takes True or False, not 'abc'"),
            (shaded(images=3), "`images` takes a dict of arrays by name, not 3"),
            (shaded(out=3), "the output `color` takes an array, not 3"),
            (shaded(depth=None), "`depth` takes an array or a path, not None"),
            (shaded(depth=3), "`depth` has the shape"),
            (shaded(normal="abc"), "`depth` is an array and `normal` a path: give files for all, or arrays for all"),
            (shaded(images={"depth": DEPTH}), "two images 'depth'"),
            (meshed(vertices=object()), "`vertices` takes an array, not"),
            (meshed(name=3), "`name` takes a string, not 3"),
            (meshed(albedo=(1, 2)), r"`albedo` takes three numbers, not \(1, 2\)"),
            (meshed(shininess="abc"), "`shininess` takes a number, not 'abc'"),
            (meshed(normals=POINTS[:2]), "`normals` has the shape"),
            (meshed(texture="brick.png"), "`texture` takes an array, not 'brick.png'"),
            (meshed(texture=np.zeros((2, 2, 3))), "`texture` has the dtype float64: it takes uint8"),
            (meshed(texture=np.zeros((2, 2, 2), np.uint8)), "`texture` has the shape"),
            (meshed(texture=np.zeros((0, 2, 3), np.uint8)), "`texture` has the shape .* 1 to 16384 pixels per side"),
            (meshed(vertices=POINTS[:0]), "`vertices` has 0 rows: it takes 1 to 2147483647"),
            (meshed(radii=np.ones(4)), "`radii` is for point clouds: the mesh has faces"),
            (meshed(faces=None, radii=[1, 2, 0, 3]), "`radii` holds 0, in row 2: it takes finite numbers above 0"),
            (meshed(specular=-1), "`specular` cannot be -1: it takes a finite number, 0 or more"),
            (meshed(albedo=(1, math.inf, 1)), r"`albedo` cannot be \(1, inf, 1\)"),
            (meshed(up=[[[]]]), "`up`"),
            (meshed(texture=np.zeros((2, 2, 3), np.uint8)), "`texture` needs `uv`"),
            (meshed(instances=np.full((1, 4, 4), 0.5)), "last row is not 0, 0, 0, 1"),
            (meshed(vertices=None), "needs `vertices`"),
            (lambda: umbrage.Scene("missing.obj", FACES), "`faces` is for arrays"),
            (lambda: umbrage.Scene().set("up", b"x"), "`up`"),
            (lambda: umbrage.Scene().set(3, "x"), "`name` takes a string, not 3"),
            (lambda: umbrage.Scene().bounds, "the scene is empty: `add`"),
            (lambda: umbrage.parameters(3), "`owner` takes a string, not 3"),  # type: ignore[arg-type]
        ):
            self.said(call, text)

    def test_long_values_are_cut(self) -> None:
        self.said(rendered(look=[1] * 10000), r"`look` takes one of .*, not \[1, 1.*\.\.\.$")
        self.said(rendered(camera=np.zeros((1000, 1000))), r"not an array of the shape \(1000, 1000\)")

    def test_objects(self) -> None:
        renderer = umbrage.Renderer(SOLIDS, size=(8, 8), device="cpu")
        scene, shader = umbrage.Scene.load(SOLIDS), umbrage.Shader(device="cpu")
        for call, text in (
            (lambda: renderer.render(cmera={}), "'camera'"),
            (lambda: renderer.render(device="cpu"), "`device` cannot be changed"),
            (lambda: renderer.render(up="+Z"), "`up` cannot be changed"),
            (lambda: renderer.render(progress=0.5), "`progress`"),
            (lambda: renderer.set(3, 3), "`name` takes a string, not 3"),
            (lambda: renderer.counter(3), "`name` takes a string, not 3"),
            (lambda: renderer.render().save(3), "`path` takes a string or a path, not 3"),
            (lambda: renderer.render().save("a.png", bits="8"), "`bits` takes an integer, not '8'"),
            (lambda: renderer.render().save("a.exr", half=1), "`half` takes True or False, not 1"),
            (lambda: umbrage.Scene().render(), "the scene is empty"),
        ):
            self.said(call, text)
        for thing, kind in ((renderer, "Renderer"), (scene, "Scene"), (shader, "Shader")):
            for refused in (pickle.dumps, copy.copy, copy.deepcopy):
                with self.assertRaisesRegex(TypeError, f"a {kind} cannot be pickled or copied"):
                    refused(thing)
        with scene, shader, renderer:
            renderer.close()  # closes it a second time
        for call, text in (
            (renderer.render, "the Renderer was closed"),
            (lambda: renderer.device, "the Renderer was closed"),
            (lambda: renderer.counter("planes_copied"), "the Renderer was closed"),
            (lambda: shader.shade(DEPTH), "the Shader was closed"),
            (lambda: scene.add(SOLIDS), "the Scene was closed"),
            (scene.render, "the Scene was closed"),
        ):
            self.said(call, text)

    def test_pictures_can_be_pickled(self) -> None:
        picture = umbrage.render(SOLIDS, size=(8, 8), device="cpu", look="cartoon", passes="ao", strokes=True)
        again = pickle.loads(pickle.dumps(picture))
        np.testing.assert_array_equal(again.picture, picture.picture)
        np.testing.assert_array_equal(again["ao"], picture["ao"])
        self.assertEqual(len(again.strokes), len(picture.strokes))


class Lists(unittest.TestCase):
    TYPES = ("bool", "int", "float", "float2", "float3", "float4", "float9", "string", "length", "choice")

    def test_parameters_are_whole(self) -> None:
        for owner in ("render", "shade", "scene", *umbrage.effects()):
            for name, row in umbrage.parameters(owner).items():
                with self.subTest(name):
                    self.assertEqual(row.name, name)
                    self.assertIn(row.type, self.TYPES)
                    self.assertTrue(row.help)
                    self.assertEqual(bool(row.choices), row.type == "choice")
                    if row.range:
                        self.assertLess(*row.range)
                    if row.range and isinstance(row.default, (int, float)):
                        self.assertTrue(row.range[0] <= row.default <= row.range[1])

    def test_defaults_are_values_that_are_taken(self) -> None:
        rows = {**umbrage.parameters("render"), **umbrage.parameters("bitmask"), **umbrage.parameters("output")}
        with umbrage.Renderer(SOLIDS, size=(8, 8), device="cpu") as renderer:
            for name, row in rows.items():
                if row.default is not None and name not in ("width", "height"):
                    renderer.set(name, row.default)
        self.assertEqual(rows["bitmask.radius"].default, "10%")
        self.assertEqual(rows["bitmask.slices"].default, 2)
        self.assertIs(rows["bitmask.mips"].default, False)
        self.assertEqual(rows["bitmask.mode"].default, "thick")
        self.assertIsNone(rows["quality"].default)
        self.assertEqual(umbrage.parameters("shade")["window"].default, None)


if __name__ == "__main__":
    unittest.main()
