"""What a failed call leaves: no error that a later call would raise."""
import unittest
from typing import Any, Callable, Type
from unittest import mock

import numpy as np

import umbrage
from support import SOLIDS, plane_depth
from umbrage import _native as native

DEPTH = plane_depth(12, 8)


class Base(unittest.TestCase):
    def raised(self, kind: Type[umbrage.UmbrageError], text: str, call: Callable[..., Any], **arguments: Any) -> None:
        with self.assertRaisesRegex(kind, text):
            call(**arguments)


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
            self.assertEqual(lib.umbSetJobString(job, b"lok", b"ao"), 2)  # which nobody asks for
            self.raised(umbrage.Cancelled, "returned False", renderer.render, progress=lambda done: False)
            self.raised(umbrage.UsageError, "aoo", renderer.render, passes="aoo")
            # One that is noted with the thread.
            with mock.patch.object(lib, "umbExecuteJob", lambda _: lib.umbSetJobInt(None, b"width", 3)):
                self.raised(umbrage.UsageError, "NULL", renderer.render)
            renderer.render()


if __name__ == "__main__":
    unittest.main()
