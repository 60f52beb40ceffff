"""Tests of render: results are bitwise identical to those of the command line; cameras, passes, files, scenes."""
import os
import pathlib
import struct
import subprocess
import tempfile
import threading
import types
import unittest
import warnings
import zlib

import numpy as np

import umbrage
from support import SIZE, SOLIDS, bytes_of_program, program

CUBE = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
QUADS = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])


def pixels_of_png(data: bytes) -> np.ndarray:
    """Returns the pixels of a PNG whose rows use any filter."""
    at, parts, head = 8, b"", b""
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        head, parts = (body, parts) if kind == b"IHDR" else (head, parts + body if kind == b"IDAT" else parts)
        at += 12 + length
    width, height, bits, color = struct.unpack(">IIBB", head[:10])
    channels = {0: 1, 2: 3, 6: 4}[color]
    step = channels * bits // 8
    raw = np.frombuffer(zlib.decompress(parts), np.uint8).reshape(height, -1)
    rows = np.zeros((height + 1, raw.shape[1] - 1 + step), np.int64)
    for y in range(height):
        row, above = rows[y + 1], rows[y]
        for x in range(step, row.size):
            left, up, corner = row[x - step], above[x], above[x - step]
            nearest = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (abs(left + up - 2 * corner), 2, corner))
            guess = (0, left, up, (left + up) // 2, nearest[2])[raw[y, 0]]
            row[x] = (raw[y, x - step + 1] + guess) & 255
    flat = rows[1:, step:].astype(np.uint8).tobytes()
    return np.frombuffer(flat, ">u2" if bits == 16 else np.uint8).reshape(height, width, channels)


class Equality(unittest.TestCase):
    def saved(self, picture: umbrage.Picture, ending: str = ".png", **how: object) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / ("picture" + ending)
            picture.save(file, **how)  # type: ignore[arg-type]
            return file.read_bytes()

    def test_several_models_are_one_scene(self) -> None:
        cube = "scene:solids?detail=1000"
        one, two = umbrage.Scene.of(cube), umbrage.Scene.of([cube, cube])
        np.testing.assert_array_equal(one.bounds, two.bounds)
        picture = umbrage.render([cube, cube], size=(24, 16), look="lit", passes="object_id", device="cpu")
        self.assertEqual(picture.picture.shape, (16, 24, 4))

    def test_passes_stay_out_of_png(self) -> None:
        many = umbrage.render("scene:solids?detail=1000", size=(24, 16), look="lit", passes="depth", device="cpu")
        alone = umbrage.render("scene:solids?detail=1000", size=(24, 16), look="lit", device="cpu")
        self.assertEqual(self.saved(many), self.saved(alone))

    def test_files_equal_those_of_the_command_line(self) -> None:
        for words, arguments in (
            ((), {}),
            (("--look", "cartoon", "--anti-aliasing", "2"), {"look": "cartoon", "anti_aliasing": 2}),
            (("--camera-azimuth-angle", "30", "--no-background"), {"camera": {"azimuth_deg": 30}, "transparent": True}),
            (("--quality", "draft", "--set", "bitmask.radius=15%"), {"quality": "draft", "settings": {"bitmask.radius": "15%"}}),
            (("--ao", "none", "--background-color", "1,0,0.25"), {"occlusion": "none", "background": (1, 0, 0.25)}),
            (("--up", "+Z", "--guard-band", "10%"), {"up": "+Z", "guard_band": 10}),
        ):
            with self.subTest(words):
                picture = umbrage.render(SOLIDS, size=SIZE, device="cpu", **arguments)
                expected = bytes_of_program(SOLIDS, "--resolution", "48,32", *words)
                self.assertEqual(self.saved(picture), expected)
                self.assertEqual(picture._repr_png_(), expected)
                channels = pixels_of_png(expected).shape[2]
                np.testing.assert_array_equal(picture.picture[..., :channels], pixels_of_png(expected))

    def test_numbers_of_16_bits_and_half_floats(self) -> None:
        expected = bytes_of_program(SOLIDS, "--resolution", "48,32", "--bits", "16")
        for dtype in ("float32", "uint16"):
            picture = umbrage.render(SOLIDS, size=SIZE, device="cpu", dtype=dtype)
            self.assertEqual(picture.picture.dtype, dtype)
            self.assertEqual(self.saved(picture, bits=16), expected)
        np.testing.assert_array_equal(picture.picture[..., :3], pixels_of_png(expected))
        half = umbrage.render(SOLIDS, size=SIZE, device="cpu", dtype=np.float16).picture
        self.assertLess(np.abs(half - picture.picture / 65535.0).max(), 1e-3)
        with self.assertWarns(umbrage.UmbrageWarning):
            self.saved(umbrage.render(SOLIDS, size=SIZE, device="cpu"), bits=16)

    def test_passes_equal_those_of_the_command_line(self) -> None:
        picture = umbrage.render(SOLIDS, size=SIZE, device="cpu", passes=("depth", "normal", "ao", "object_id"))
        for name, channels in (("depth", 1), ("normal", 3), ("ao", 1)):
            self.assertEqual(picture[name].shape, (32, 48, 3)[: 2 + channels // 3])
            if channels == 1:
                file = bytes_of_program(SOLIDS, "--resolution", "48,32", "--passes", name, ending=".pfm")
                values = np.frombuffer(file[-4 * 48 * 32 :], "<f4").reshape(32, 48)[::-1]
                np.testing.assert_array_equal(picture[name], values)
                continue
            file = bytes_of_program(SOLIDS, "--resolution", "48,32", "--passes", name, "--bits", "16")
            values = pixels_of_png(file) / 65535 * 2 - 1
            np.testing.assert_allclose(picture[name], values, atol=1e-4)
        self.assertEqual(list(picture), ["color", "depth", "normal", "ao", "object_id"])
        self.assertEqual(picture["object_id"].dtype, np.uint32)
        np.testing.assert_array_equal(picture["object_id"] == 2**32 - 1, np.isinf(picture["depth"]))

    def test_strokes(self) -> None:
        picture = umbrage.render(SOLIDS, size=SIZE, look="cartoon", strokes=True, device="cpu")
        expected = bytes_of_program(SOLIDS, "--resolution", "48,32", "--look", "cartoon", ending=".svg")
        self.assertEqual(self.saved(picture, ".svg"), expected)
        self.assertIn(picture.strokes[0].kind, ("outline", "fold", "crease"))
        self.assertEqual(picture.strokes[0].points.shape[1], 3)

    def test_exr_holds_passes(self) -> None:
        picture = umbrage.render(SOLIDS, size=SIZE, passes="beauty,depth,ao", device="cpu")
        data = self.saved(picture, ".exr", half=True)
        self.assertTrue(data.startswith(b"v/1\x01") and b"depth.Z" in data and b"ao" in data)

    def test_exr_is_that_of_the_program(self) -> None:
        for more in ({}, {"transparent": True}):
            picture = umbrage.render(SOLIDS, size=SIZE, passes="beauty", device="cpu", **more)
            beauty, alpha = picture["beauty"][..., :3], picture["beauty"][..., 3:]
            self.assertEqual(picture["beauty"].shape, (32, 48, 4))
            self.assertTrue((beauty[np.broadcast_to(alpha == 0, beauty.shape)] == 0).all())
            if not more:
                file = bytes_of_program(SOLIDS, "--resolution", "48,32", ending=".exr")
                self.assertEqual(self.saved(picture, ".exr"), file)

    def test_beauty_is_the_sum_of_its_parts(self) -> None:
        parts = ["beauty_direct", "beauty_ambient", "beauty_indirect", "beauty_background"]
        picture = umbrage.render(SOLIDS, size=SIZE, passes=["beauty"] + parts, device="cpu")
        total = sum(picture[name] for name in parts)
        np.testing.assert_allclose(total, picture["beauty"][..., :3], atol=1e-5)

    def test_exr_of_display_values_has_a_warning(self) -> None:
        picture = umbrage.render(SOLIDS, size=SIZE, look="ao", device="cpu")
        with self.assertWarnsRegex(umbrage.UmbrageWarning, "beauty"):
            self.saved(picture, ".exr")


class Reuse(unittest.TestCase):
    def test_a_renderer_goes_on_after_a_wrong_value(self) -> None:
        renderer = umbrage.Renderer("scene:solids?detail=1000", size=(24, 18), look="ao", device="cpu")
        expected = renderer.render().picture
        for wrong in (
            {"look": "nope"},
            {"quality": "best"},
            {"occlusion": "nope"},
            {"hdri_file": "nope.hdr"},
            {"settings": {"box.size": 99}},
            {"camera": {"zoom": -1}},
            {"passes": ("nope",)},
            {"width": 50},
            {"settings": {"height": 20}},
        ):
            with self.assertRaises(umbrage.UmbrageError, msg=str(wrong)):
                renderer.render(**wrong)
            self.assertTrue((renderer.render().picture == expected).all(), wrong)
        with self.assertRaises(umbrage.UsageError):
            renderer.set("width", 3)

    def test_a_renderer_keeps_what_is_the_same(self) -> None:
        with umbrage.Renderer(SOLIDS, size=SIZE, look="ao", device="cpu") as renderer:
            renderer.prepare()
            first = renderer.render()
            turned = renderer.render({"azimuth_deg": 90})
            again = renderer.render()
            settled = renderer.render(settings={"traced.rays": 1})
            small = renderer.render(size=(20, 10), passes=("depth",))
            self.assertEqual(renderer.counter("hierarchies_built"), 1)
        np.testing.assert_array_equal(first.picture, again.picture)
        self.assertTrue((first.picture != turned.picture).any())
        self.assertTrue((first.picture != settled.picture).any())
        self.assertEqual((small.width, small.height, small["depth"].shape), (20, 10, (10, 20)))
        with self.assertRaisesRegex(umbrage.UsageError, "closed"):
            renderer.render()

    def test_a_renderer_orbits_at_one_distance(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            model = os.path.join(folder, "long.obj")
            lines = [f"v {8 * x} {y} {z}" for x, y, z in CUBE] + ["f " + " ".join(str(k + 1) for k in q) for q in QUADS]
            pathlib.Path(model).write_text("\n".join(lines))
            center = np.mean(umbrage.Scene.load(model).bounds, axis=0)

            def distance(picture: umbrage.Picture) -> float:
                view = np.reshape(picture._view.view_from_world, (3, 4))  # type: ignore[union-attr]
                return float(np.linalg.norm(view[:, :3].T @ view[:, 3] + center))

            with umbrage.Renderer(model, size=SIZE, look="ao", device="cpu") as renderer:
                first = renderer.render()
                for azimuth, elevation in ((30, 0), (60, 0), (250, 20), (0, -10)):
                    orbit = renderer.render({"azimuth_deg": azimuth, "elevation_deg": elevation})
                    self.assertAlmostEqual(distance(orbit), distance(first), places=4)
                fitted = renderer.render({"azimuth_deg": 60, "orbit": False})
                turned = renderer.render({"azimuth_deg": 90}, passes="depth")
            alone = umbrage.render(model, size=SIZE, look="ao", device="cpu", camera={"azimuth_deg": 60})
            self.assertGreater(abs(distance(fitted) - distance(first)), 0.5)
            self.assertEqual(distance(alone), distance(fitted))
            # It is the camera of a turntable.
            words = (model, "--resolution", "48,32", "--look", "ao", "--passes", "depth", "--turntable", "4")
            subprocess.run([program(), *words, "--device", "cpu", "-o", os.path.join(folder, "turn.pfm")], check=True)
            file = pathlib.Path(folder, "turn_0001.pfm").read_bytes()
            values = np.frombuffer(file[-4 * 48 * 32 :], "<f4").reshape(32, 48)[::-1]
            near = np.isclose(turned["depth"], values, rtol=1e-3) | (np.isinf(values) & np.isinf(turned["depth"]))
            self.assertLess(np.count_nonzero(~near), 8)

    def test_lights_move_with_the_camera(self) -> None:
        expected = bytes_of_program(SOLIDS, "--resolution", "48,32", "--camera-azimuth-angle", "150")
        with umbrage.Renderer(SOLIDS, size=SIZE, device="cpu") as renderer:
            front = renderer.render().picture
            orbit = renderer.render({"azimuth_deg": 150}).picture
            picture = renderer.render({"azimuth_deg": 150, "orbit": False}).picture
        np.testing.assert_array_equal(picture[..., :3], pixels_of_png(expected))
        for each in (orbit, picture):  # not burnt out from behind
            self.assertLess(abs(float(np.mean(each[..., :3])) - float(np.mean(front[..., :3]))), 8)

    def test_out_is_written_where_it_lies(self) -> None:
        with umbrage.Renderer(SOLIDS, size=SIZE, device="cpu") as renderer:
            expected = renderer.render(passes=("normal",))
            everything = np.zeros((32, 60, 5), np.uint8)
            upside_down = everything[::-1, 4:52, 1:4]
            normals = np.zeros((3, 48, 32), np.float32)
            made = renderer.render(out={"color": upside_down, "normal": normals.T[:, :, ::-1]})
            self.assertIs(made.picture, upside_down)
            np.testing.assert_array_equal(everything[::-1, 4:52, 1:4], expected.picture[..., :3])
            np.testing.assert_array_equal(normals[::-1].T, expected["normal"])
            self.assertFalse(everything[:, :4].any() or everything[:, 52:].any() or everything[..., (0, 4)].any())

    def test_threads_render_at_the_same_time(self) -> None:
        scene = umbrage.Scene.load(SOLIDS)
        expected = scene.render(size=SIZE, device="cpu").picture
        made, failed = [], []

        def work() -> None:
            try:
                with umbrage.Renderer(scene, size=SIZE, device="cpu") as renderer:
                    made.extend(renderer.render().picture for _ in range(5))
            except BaseException as error:
                failed.append(error)

        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failed, [])
        self.assertEqual(len(made), 15)
        for each in made:
            np.testing.assert_array_equal(each, expected)


class Scenes(unittest.TestCase):
    def picture(self, scene: umbrage.Scene) -> np.ndarray:
        return scene.render(size=SIZE, device="cpu").picture

    def test_arrays_of_any_kind(self) -> None:
        expected = self.picture(umbrage.Scene(CUBE, QUADS))
        wide = np.zeros((8, 7), np.float32)
        wide[:, 2:5] = CUBE
        triangles = np.concatenate([QUADS[:, :3], QUADS[:, (0, 2, 3)]], axis=1).reshape(-1, 3)
        for vertices, faces in (
            (CUBE.astype(np.float64), triangles.astype(np.uint8)),
            (CUBE.tolist(), triangles.astype(">i8")),
            (wide[:, 2:5], triangles.astype(np.uint16)),
            (np.asfortranarray(CUBE), np.asfortranarray(triangles)),
            (CUBE[::-1].copy()[::-1], triangles.astype(np.int32)[::-1].copy()[::-1]),
            (memoryview(CUBE), np.hstack([np.full((6, 1), 4), QUADS]).ravel()),
        ):
            np.testing.assert_array_equal(self.picture(umbrage.Scene(vertices, faces)), expected)

    def test_colors_bounds_and_places(self) -> None:
        grey = self.picture(umbrage.Scene(CUBE, QUADS, colors=(1.0, 1.0, 1.0)))
        red = self.picture(umbrage.Scene(CUBE, QUADS, colors=np.tile(np.array([255, 0, 0], np.uint8), (8, 1))))
        np.testing.assert_array_equal(red, self.picture(umbrage.Scene(CUBE, QUADS, colors=(1.0, 0.0, 0.0))))
        self.assertTrue((grey != red).any())
        scene = umbrage.Scene(up="+Z")
        place = np.eye(4)
        place[:3, 3] = (0, 0, 2)
        scene.add_mesh(CUBE, QUADS, instances=[np.eye(4), place], albedo=(1, 0.5, 0), name="cubes")
        np.testing.assert_array_equal(scene.bounds, [(0, 0, 0), (1, 1, 3)])
        self.assertEqual(scene.camera_count, 0)
        texture = np.zeros((2, 2, 3), np.uint8)
        textured = umbrage.Scene(CUBE, QUADS, uv=CUBE[:, :2], texture=texture, normals=CUBE - 0.5)
        self.assertTrue((self.picture(textured) != grey).any())
        points = umbrage.Scene(CUBE, colors=np.full((8, 3), 0.5), radii=np.full(8, 0.1))
        self.assertTrue((self.picture(points) != grey).any())

    def test_objects_of_other_libraries(self) -> None:
        expected = self.picture(umbrage.Scene(CUBE, QUADS))
        triangles = np.concatenate([QUADS[:, :3], QUADS[:, (0, 2, 3)]], axis=1).reshape(-1, 3)
        colors = np.full((8, 4), 255, np.uint8)
        visual = types.SimpleNamespace(kind="vertex", vertex_colors=colors)
        trimesh = types.SimpleNamespace(vertices=CUBE, faces=triangles, visual=visual)
        open3d = types.SimpleNamespace(vertices=CUBE, triangles=triangles, vertex_colors=np.ones((8, 3)), vertex_normals=[])
        padded = np.hstack([np.full((6, 1), 4), QUADS]).ravel()
        pyvista = types.SimpleNamespace(points=CUBE, faces=padded, point_data={"RGB": colors[:, :3]})
        mixed = np.concatenate([padded[:25], [3, *QUADS[5, :3], 3, *QUADS[5, [0, 2, 3]]]])
        white = self.picture(umbrage.Scene(CUBE, QUADS, colors=(1.0, 1.0, 1.0)))
        for thing in (
            trimesh,
            open3d,
            pyvista,
            types.SimpleNamespace(geometry={}, dump=lambda: [trimesh]),
        ):
            np.testing.assert_array_equal(self.picture(umbrage.Scene.of(thing)), white)
        np.testing.assert_array_equal(umbrage.render((CUBE, mixed), size=SIZE, device="cpu").picture, expected)
        cloud = types.SimpleNamespace(points=CUBE, colors=[], normals=[])
        self.assertEqual(umbrage.Scene.of(cloud).bounds.shape, (2, 3))

    def test_files(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "d\u00fcne.off")
            with open(file, "w") as off:
                off.write("OFF\n8 6 0\n")
                off.writelines(f"{x:g} {y:g} {z:g}\n" for x, y, z in CUBE)
                off.writelines("4 " + " ".join(map(str, quad)) + "\n" for quad in QUADS)
            np.testing.assert_array_equal(umbrage.Scene.load(file).bounds, [(0, 0, 0), (1, 1, 1)])
            with umbrage.Scene(pathlib.Path(file)) as scene, umbrage.Renderer(scene, size=SIZE, device="cpu") as renderer:
                scene.close()
                self.assertEqual(umbrage.render(pathlib.Path(file), size=SIZE, device="cpu").height, 32)
                with self.assertRaisesRegex(umbrage.UsageError, "the Scene was closed"):
                    renderer.render()


class Lists(unittest.TestCase):
    def test_what_there_is(self) -> None:
        self.assertIn("studio", umbrage.looks())
        self.assertIn("bitmask", umbrage.effects())
        self.assertIn("reference", umbrage.occlusions())
        self.assertIn("cpu", umbrage.devices())
        self.assertIn("scene:solids", umbrage.scenes())
        self.assertIn(".png", umbrage.file_formats())
        self.assertRegex(umbrage.__version__, r"^\d+\.\d+\.\d+$")

    def test_parameters(self) -> None:
        radius = umbrage.parameters("bitmask")["bitmask.radius"]
        self.assertEqual((radius.type, radius.initial), ("length", "10%"))
        self.assertEqual(umbrage.parameters("render")["ground"].choices, ("auto", "on", "off"))
        self.assertEqual(umbrage.parameters("render")["layers"].range, (1, 16))
        self.assertIn("depth_kind", umbrage.parameters("shade"))
        self.assertIn("up", umbrage.parameters("scene"))
        with self.assertRaises(umbrage.UsageError):
            umbrage.parameters("bitmusk")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            umbrage.render(SOLIDS, size=SIZE, device="cpu")


if __name__ == "__main__":
    unittest.main()
