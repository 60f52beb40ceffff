"""Tests of shade with files: the same picture as the command line's, facts, the camera, errors."""
import os
import pathlib
import tempfile
import unittest

import numpy as np

import umbrage
from support import SIZE, SOLIDS, bytes_of_program, plane_depth


def shade(*inputs: object, **arguments: object) -> umbrage.Picture:
    return umbrage.shade(*inputs, device="cpu", **arguments)  # type: ignore[arg-type]


def pixels_of_program(*words: str) -> np.ndarray:
    """Returns the red, green and blue of the picture that the command line makes, as float32."""
    pfm = bytes_of_program("shade", *words, ending=".pfm")
    kind, size, scale, values = pfm.split(b"\n", 3)
    assert kind == b"PF" and float(scale) < 0  # little-endian
    width, height = map(int, size.split())
    return np.frombuffer(values, "<f4").reshape(height, width, 3)[::-1]


class Files(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.file = self.folder / "rendered.exr"
        passes = ("beauty", "depth", "normal", "albedo")
        umbrage.render(SOLIDS, size=SIZE, look="lit", passes=passes, device="cpu").save(self.file)

    def test_picture_is_that_of_the_command_line(self) -> None:
        for path in (self.file, str(self.file)):
            for look in (None, "ao", "studio"):
                picture = shade(path, look=look, dtype="float32").picture
                expected = pixels_of_program(str(self.file), *(["--look", look] if look else []))
                np.testing.assert_array_equal(picture[..., :3], expected)

    def test_separate_files_and_parameters(self) -> None:
        depth = f"{self.file}:depth"
        picture = shade(depth=depth, depth_scale=2, fov=30, look="ao", dtype="float32", passes="depth")
        words = ("--depth", depth, "--depth-scale", "2", "--fov", "30", "--look", "ao")
        np.testing.assert_array_equal(picture.picture[..., :3], pixels_of_program(*words))
        stored = umbrage.render(SOLIDS, size=SIZE, look="lit", passes="depth", device="cpu")["depth"]
        np.testing.assert_array_equal(picture["depth"], 2 * stored)

    def test_an_array_in_a_file(self) -> None:
        y, x = np.mgrid[0:32, 0:48]
        depth = (plane_depth() + 0.02 * x + 0.01 * y).astype(np.float32)  # no depth is so frequent as to be background
        file = self.folder / "depth.pfm"
        with open(file, "wb") as out:
            out.write(b"Pf\n48 32\n-1.0\n" + depth[::-1].astype("<f4").tobytes())
        of_file = shade(depth=file, fov=40, look="ao", passes="depth")
        of_array = shade(depth, fov=40, look="ao", passes="depth")
        np.testing.assert_array_equal(of_file["depth"], of_array["depth"])

    def test_types_and_outputs(self) -> None:
        floats = shade(self.file, look="ao", dtype="float32").picture
        for dtype, most in (("uint8", 255), ("uint16", 65535)):
            picture = shade(self.file, look="ao", dtype=dtype).picture
            self.assertEqual(picture.dtype, np.dtype(dtype))
            np.testing.assert_array_equal(picture, (floats * np.float32(most) + np.float32(0.5)).astype(dtype))
        out = np.empty((SIZE[1], SIZE[0], 4), np.float32)
        self.assertIs(shade(self.file, look="ao", out=out).picture, out)
        np.testing.assert_array_equal(out, floats)
        with self.assertRaisesRegex(umbrage.UsageError, "pixels"):
            shade(self.file, look="ao", out=np.empty((3, 5, 4), np.uint8))
        ao = shade(self.file, effects="bitmask")
        self.assertEqual(ao["ao"].shape, (SIZE[1], SIZE[0]))

    def test_facts_and_camera(self) -> None:
        picture = shade(self.file, look="ao")
        self.assertTrue(any("depth" in fact for fact in picture.facts), picture.facts)
        info = umbrage.info(self.file)
        self.assertEqual(info.facts, picture.facts)
        self.assertTrue(any("normal" in layer for layer in info.layers), info.layers)
        shaded = self.folder / "shaded.exr"
        shade(self.file, look="ao", passes="beauty").save(shaded)
        self.assertIn(b"worldToCamera", shaded.read_bytes())
        self.assertEqual(shade(plane_depth()).facts, ())

    def test_a_shader_takes_files_and_arrays_in_turn(self) -> None:
        with umbrage.Shader(look="ao", device="cpu") as shader:
            first, array = shader.shade(self.file), shader.shade(plane_depth())
            again = shader.shade(self.file)
        np.testing.assert_array_equal(first.picture, again.picture)
        np.testing.assert_array_equal(array.picture, shade(plane_depth(), look="ao").picture)

    def test_errors(self) -> None:
        with self.assertRaisesRegex(umbrage.FileError, "none.exr"):
            shade("none.exr")
        with self.assertRaisesRegex(umbrage.FileError, "none.exr"):
            umbrage.info("none.exr")
        text = self.folder / "text.exr"
        text.write_text("text")
        with self.assertRaises(umbrage.FileError):
            shade(text)
        for inputs, named in (
            ((self.file, plane_depth()), {}),
            ((), {"depth": self.file, "normal": np.zeros((32, 48, 3), np.float32)}),
            ((self.file,), {"images": {"emission": np.zeros((32, 48, 3), np.float32)}}),
        ):
            with self.assertRaisesRegex(umbrage.UsageError, "files for all, or arrays for all"):
                shade(*inputs, **named)
        with self.assertRaisesRegex(umbrage.UsageError, "first argument"):
            shade(plane_depth(), depth=plane_depth())
        with self.assertRaisesRegex(umbrage.UsageError, "takes an array or a path"):
            shade()
        with self.assertRaisesRegex(umbrage.UsageError, "did you mean 'depth'"):
            umbrage.Shader(depth_file=os.fspath(self.file))
        with self.assertRaisesRegex(umbrage.UsageError, "takes a path"):
            umbrage.info(plane_depth())  # type: ignore[arg-type]


if __name__ == "__main__":
    unittest.main()
