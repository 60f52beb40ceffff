"""Tests that a failed call leaves scenes unchanged, and leaves no error that a later call would raise."""
import unittest
from typing import Any, Callable, Type
from unittest import mock

import numpy as np

import umbrage
from support import SOLIDS, plane_depth
from umbrage import _native as native

POINTS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], np.float32)
FACES = np.array([(0, 1, 2)])
DEPTH = plane_depth(12, 8)


class Base(unittest.TestCase):
    def raised(self, kind: Type[umbrage.UmbrageError], text: str, call: Callable[..., Any], **arguments: Any) -> None:
        with self.assertRaisesRegex(kind, text):
            call(**arguments)


class Scenes(Base):
    def setUp(self) -> None:
        self.scene = umbrage.Scene(POINTS, FACES)
        self.bounds = self.scene.bounds

    def check_unchanged(self) -> None:
        np.testing.assert_array_equal(self.scene.bounds, self.bounds)
        self.assertEqual(self.scene.add_mesh(POINTS, FACES), 1, "the number of the next mesh")

    def test_a_mesh_that_is_refused_is_not_there(self) -> None:
        far = POINTS + 9
        for wrong in (
            {"radii": -np.ones(4)},
            {"radii": np.full(4, np.inf)},
            {"faces": FACES, "radii": np.ones(4)},
            {"faces": FACES, "specular": -1},
            {"faces": FACES, "shininess": np.nan},
            {"faces": FACES, "emission": (0, -1, 0)},
            {"faces": FACES, "alpha_cutoff": 1e300},
            {"faces": FACES, "texture": np.zeros((0, 2, 3), np.uint8)},
            {"faces": FACES, "instances": np.full((1, 3, 4), np.nan)},
        ):
            with self.subTest(wrong):
                self.raised(umbrage.UsageError, "", self.scene.add_mesh, vertices=far, **wrong)
                np.testing.assert_array_equal(self.scene.bounds, self.bounds)
        self.check_unchanged()

    def test_all_of_several_models_are_added_or_none(self) -> None:
        good = (POINTS + 9, FACES)
        for bad in ((POINTS, FACES + 7), (POINTS[:0], FACES), (POINTS * np.nan, FACES)):
            self.raised(umbrage.UsageError, "", lambda: self.scene.add([good, bad]))
            self.raised(umbrage.UsageError, "", lambda: umbrage.Scene([good, bad]))
        self.check_unchanged()
        empty = umbrage.Scene()
        self.raised(umbrage.UsageError, "", lambda: empty.add([good, (POINTS, FACES + 7)]))
        self.raised(umbrage.UsageError, "the scene is empty", lambda: empty.bounds)

    @unittest.skipUnless(native.has("umbRemoveMesh"), "the library cannot take a mesh out")
    def test_what_the_library_refuses_is_taken_out_again(self) -> None:
        with mock.patch.object(native.lib, "umbSetMeshTexture", lambda *_: 4):
            texture = np.zeros((2, 2, 3), np.uint8)
            mesh = dict(vertices=POINTS + 9, faces=FACES, texture=texture, uv=POINTS[:, :2])
            self.raised(umbrage.DeviceError, "memory", self.scene.add_mesh, **mesh)
        np.testing.assert_array_equal(self.scene.bounds, self.bounds)


class Stale(Base):
    def test_an_output_that_is_not_there_leaves_no_error(self) -> None:
        out = np.zeros((8, 12), np.float32)
        with umbrage.Renderer(SOLIDS, size=(12, 8), device="cpu") as renderer, umbrage.Shader(device="cpu") as shader:
            for work in (renderer.render, lambda **how: shader.shade(DEPTH, **how)):
                self.raised(umbrage.UsageError, "dpeth", work, out={"dpeth": out})
                self.raised(umbrage.UsageError, "nromal", work, out={"ao": out, "nromal": out.copy()})
            self.raised(umbrage.UsageError, "norml", shader.shade, depth=DEPTH, images={"norml": DEPTH})
            self.raised(umbrage.UsageError, "albdo", shader.shade, depth=DEPTH, images={"albdo": DEPTH})
            renderer.render()
            shader.shade(DEPTH)

    def test_a_call_raises_its_own_error(self) -> None:
        lib = native.lib
        with umbrage.Renderer(SOLIDS, size=(12, 8), device="cpu") as renderer:
            job = renderer._job.pointer
            self.assertEqual(lib.umbSetJobString(job, b"lok", b"ao"), 2)  # its error is not read
            self.raised(umbrage.Cancelled, "returned False", renderer.render, progress=lambda done: False)
            self.raised(umbrage.UsageError, "aoo", renderer.render, passes="aoo")
            # An error that is stored with the thread.
            with mock.patch.object(lib, "umbExecuteJob", lambda _: lib.umbSetJobInt(None, b"width", 3)):
                self.raised(umbrage.UsageError, "NULL", renderer.render)
            renderer.render()


if __name__ == "__main__":
    unittest.main()
