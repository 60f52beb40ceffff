"""Tests of errors, progress, cancellation, Ctrl-C and processes."""
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import umbrage
from support import SIZE, SOLIDS, plane_depth

CUBE = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)


class Errors(unittest.TestCase):
    def refused(self, kind: type, code: int, text: str, model: object = SOLIDS, **arguments: object) -> None:
        with self.assertRaisesRegex(kind, text) as caught:
            umbrage.render(model, **{"size": SIZE, "device": "cpu", **arguments})  # type: ignore[arg-type]
        self.assertIsInstance(caught.exception, umbrage.UmbrageError)
        self.assertEqual(caught.exception.code, code)

    def test_kinds(self) -> None:
        self.refused(OSError, 3, "missing.obj", "missing.obj")
        self.refused(ValueError, 2, "solids", "scene:solid")
        self.refused(RuntimeError, 4, "vulkan:99", device="vulkan:99")
        self.refused(ValueError, 2, "did you mean 'studio'", look="studo")
        again = pickle.loads(pickle.dumps(umbrage.UsageError("text")))
        self.assertEqual((again.code, str(again)), (2, "text"))

    def test_arguments(self) -> None:
        for text, arguments in (
            ("width", {"size": (0, 3)}),
            ("width", {"size": (2.5, 3)}),
            ("height", {"size": (3, 10**12)}),
            ("16384", {"size": (16384, 16384)}),
            ("size", {"size": 3}),
            ("zom", {"camera": {"zom": 1}}),
            ("camera.zoom", {"camera": umbrage.Camera(zoom=0)}),
            ("camera.position", {"camera": {"position": (0, 1)}}),
            ("camera.position", {"camera": {"position": "here"}}),
            ("camera.position", {"camera": {"position": (0, float("nan"), 1)}}),
            ("radius", {"settings": {"bitmask.raduis": 1}}),
            ("aoo", {"passes": "aoo"}),
            ("foo", {"foo": 1}),
            ("anti_aliasing", {"anti_aliasing": {}}),
            ("up", {"up": "up"}),
        ):
            with self.subTest(text):
                self.refused(umbrage.UsageError, 2, text, **arguments)

    def test_what_is_wrong_is_found_before_the_model_is_read(self) -> None:
        self.refused(umbrage.UsageError, 2, "studio", "missing.obj", look="studo")

    def test_meshes(self) -> None:
        face = np.array([(0, 1, 2)])
        nan = CUBE.copy()
        nan[3, 1] = np.nan
        for text, arguments in (
            ("shape", {"vertices": CUBE[:, :2], "faces": face}),
            ("row 3", {"vertices": nan, "faces": face}),
            ("numbers", {"vertices": CUBE.astype(str), "faces": face}),
            ("1 to", {"vertices": CUBE[:0]}),
            ("mesh has 8", {"vertices": CUBE, "faces": face + 7}),
            ("mesh has 8", {"vertices": CUBE, "faces": face - 1}),
            ("integers", {"vertices": CUBE, "faces": face.astype(float)}),
            ("shape", {"vertices": CUBE, "faces": face[:, :2]}),
            ("empty", {"vertices": CUBE, "faces": face[:0]}),
            ("face of 2", {"vertices": CUBE, "faces": np.array([2, 0, 1, 3, 0, 1, 2])}),
            ("8, 3", {"vertices": CUBE, "faces": face, "normals": CUBE[:4]}),
            ("colors", {"vertices": CUBE, "faces": face, "colors": np.zeros((8, 3), np.int64)}),
            ("finite", {"vertices": CUBE, "faces": face, "colors": nan}),
            ("instances", {"vertices": CUBE, "faces": face, "instances": np.eye(3)}),
            ("albedo", {"vertices": CUBE, "faces": face, "albedo": (1, 2)}),
            ("radii", {"vertices": CUBE, "radii": np.zeros(8)}),
            ("needs", {"faces": face}),
        ):
            with self.subTest(text), self.assertRaisesRegex(umbrage.UsageError, text):
                umbrage.Scene(**arguments)
        self.refused(umbrage.UsageError, 2, "empty", umbrage.Scene())
        self.refused(umbrage.UsageError, 2, "not a model", 3)

    def test_files(self) -> None:
        picture = umbrage.render(SOLIDS, size=SIZE, device="cpu")
        with self.assertRaises(umbrage.FileError):
            picture.save("/nowhere/a.png")
        for name, how in (("a.gif", {}), ("a.png", {"bits": 12}), ("a.svg", {})):
            with self.assertRaises(umbrage.UsageError), tempfile.TemporaryDirectory() as folder:
                picture.save(os.path.join(folder, name), **how)
        with self.assertRaisesRegex(KeyError, "color"):
            picture["ao"]


class Progress(unittest.TestCase):
    def test_it_rises(self) -> None:
        received = []
        umbrage.render(SOLIDS, size=(200, 200), device="cpu", progress=received.append)
        self.assertTrue(received)
        self.assertEqual(received, sorted(received))
        self.assertTrue(0 <= received[0] and received[-1] <= 1)

    def test_false_and_exceptions_end_it(self) -> None:
        class Mine(Exception):
            pass

        def raises(done: float) -> None:
            try:
                raise KeyError("cause")
            except KeyError as error:
                raise Mine("text") from error

        depth = plane_depth(400, 400)
        with umbrage.Renderer(SOLIDS, size=(200, 200), device="cpu") as renderer, umbrage.Shader(device="cpu") as shader:
            for work in (renderer.render, lambda **how: shader.shade(depth, **how)):
                expected = work().picture
                out = np.full(expected.shape, 7, np.uint8)
                with self.assertRaises(umbrage.Cancelled) as caught:
                    work(progress=lambda done: False, out=out)
                self.assertEqual(caught.exception.code, 130)
                with self.assertRaises(Mine) as raised:
                    work(progress=raises, out=out)
                self.assertIsInstance(raised.exception.__cause__, KeyError)
                self.assertIsInstance(raised.exception.__context__, KeyError)
                self.assertTrue((out == 7).all())
                np.testing.assert_array_equal(work().picture, expected)
        with self.assertRaises(Mine):
            umbrage.Scene.load(SOLIDS, progress=raises)

    def test_a_bar(self) -> None:
        code = (
            "import sys; sys.modules['tqdm.auto'] = None\n"
            f"import umbrage; umbrage.render('{SOLIDS}', size=(64, 64), device='cpu', progress=True)"
        )
        piped = subprocess.run([sys.executable, "-c", code], stderr=subprocess.PIPE, check=True)
        self.assertEqual(piped.stderr, b"")
        ours, theirs = os.openpty()
        subprocess.run([sys.executable, "-c", code], stderr=theirs, check=True)
        os.close(theirs)
        self.assertIn(b"%", os.read(ours, 4096))
        os.close(ours)

    def test_integers_for_real_parameters(self) -> None:
        with umbrage.Renderer(SOLIDS, size=(8, 8), device="cpu") as renderer:
            with self.assertRaisesRegex(umbrage.UsageError, "1e\\+10|10000000000"):
                renderer.render(exposure=10**10)

    def test_no_use_within_its_own_callback(self) -> None:
        with umbrage.Renderer(SOLIDS, size=SIZE, device="cpu") as renderer:
            with self.assertRaisesRegex(umbrage.UsageError, "own progress callback"):
                renderer.render(progress=lambda done: renderer.render())
            scene = umbrage.Scene.load(SOLIDS)
            with self.assertRaisesRegex(umbrage.UsageError, "cannot be changed"):
                scene.render(size=SIZE, device="cpu", progress=lambda done: scene.add(SOLIDS))
            renderer.render()

    def test_ctrl_c(self) -> None:
        # A shell makes programs that it starts in the background ignore SIGINT.
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        with umbrage.Renderer(SOLIDS, size=(512, 512), quality="ultra", device="cpu", threads=1) as renderer:
            expected = renderer.render(size=(8, 8)).picture
            for attempt in range(4):
                timer = threading.Timer(0.05 + 0.05 * attempt, os.kill, (os.getpid(), signal.SIGINT))
                started = time.monotonic()
                with self.assertRaises(KeyboardInterrupt):
                    timer.start()
                    while time.monotonic() - started < 20:
                        renderer.render({"azimuth_deg": attempt})
                self.assertLess(time.monotonic() - started, 20)
                timer.join()
                np.testing.assert_array_equal(renderer.render(size=(8, 8)).picture, expected)

    def test_ctrl_c_while_progress_is_told(self) -> None:
        def interrupts(done: float) -> None:
            raise KeyboardInterrupt

        scene = umbrage.Scene()
        with self.assertRaises(KeyboardInterrupt):
            scene.add(SOLIDS, progress=interrupts)
        scene.add(SOLIDS)
        depth = plane_depth()
        with umbrage.Renderer(scene, size=SIZE, device="cpu") as renderer, umbrage.Shader(device="cpu") as shader:
            for work in (renderer.render, lambda **how: shader.shade(depth, **how)):
                with self.assertRaises(KeyboardInterrupt):
                    work(progress=interrupts)
                self.assertEqual(work().picture.shape, (32, 48, 4))

    def test_other_threads_run_meanwhile(self) -> None:
        ticks = []
        done = threading.Event()

        def tick() -> None:
            while not done.wait(0.002):
                ticks.append(time.monotonic())

        thread = threading.Thread(target=tick)
        thread.start()
        started = time.monotonic()
        umbrage.render(SOLIDS, size=(512, 512), device="cpu", threads=1)
        ended = time.monotonic()
        done.set()
        thread.join()
        self.assertGreater(len([t for t in ticks if started < t < ended]), (ended - started) / 0.1)


def _render_there(_: int) -> int:
    return int(umbrage.render(SOLIDS, size=SIZE, device="cpu").picture.sum())


def _use_forked(queue: object, renderer: umbrage.Renderer, shader: umbrage.Shader, scene: umbrage.Scene) -> None:
    received = []
    for work in (
        lambda: umbrage.render(SOLIDS, size=SIZE, device="cpu"),
        renderer.render,
        renderer.prepare,
        lambda: shader.shade(plane_depth()),
        lambda: scene.add(SOLIDS),
        lambda: scene.bounds,
        umbrage.Scene,
    ):
        try:
            work()
            received.append("nothing")
        except umbrage.DeviceError as error:
            received.append(str(error))
    with renderer, scene, shader:  # closes them
        pass
    queue.put(received)  # type: ignore[attr-defined]


class Processes(unittest.TestCase):
    def test_spawned_ones_render(self) -> None:
        expected = _render_there(0)
        with multiprocessing.get_context("spawn").Pool(2) as pool:
            self.assertEqual(pool.map(_render_there, range(3)), [expected] * 3)

    def test_forked_ones_are_told(self) -> None:
        context = multiprocessing.get_context("fork")
        with umbrage.Renderer(SOLIDS, size=SIZE, device="cpu") as renderer, umbrage.Shader(device="cpu") as shader:
            expected = renderer.render().picture
            queue = context.Queue()
            process = context.Process(target=_use_forked, args=(queue, renderer, shader, umbrage.Scene.load(SOLIDS)))
            process.start()
            received = queue.get(timeout=30)
            process.join(30)
            self.assertEqual(process.exitcode, 0)
            np.testing.assert_array_equal(renderer.render().picture, expected)
        self.assertEqual(len(received), 7)
        for text in received:
            self.assertIn("spawn", text)

    def test_those_that_are_forked_before_its_first_use_render(self) -> None:
        code = (
            "import multiprocessing, numpy, umbrage\n"
            f"def draw(k): return umbrage.render('{SOLIDS}', size=(8, 8), device='cpu').picture.shape\n"
            "umbrage.looks()\n"  # loads the library
            "with multiprocessing.get_context('fork').Pool(2) as pool: print(pool.map(draw, range(2)))"
        )
        ran = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, timeout=60)
        self.assertEqual((ran.returncode, ran.stdout.strip()), (0, b"[(8, 8, 4), (8, 8, 4)]"))


class Library(unittest.TestCase):
    def test_one_that_is_not_there_is_told(self) -> None:
        for name in ("/nowhere/libumbrage.so.1", "libc.so.6"):
            environment = dict(os.environ, UMBRAGE_LIBRARY=name)
            ran = subprocess.run([sys.executable, "-c", "import umbrage"], env=environment, stderr=subprocess.PIPE)
            self.assertEqual(ran.returncode, 1)
            self.assertIn(b"ImportError", ran.stderr)
            self.assertIn(name.encode(), ran.stderr)

    def test_numpy_comes_with_the_first_array(self) -> None:
        code = "import sys, umbrage; umbrage.looks(); sys.exit('numpy' in sys.modules)"
        self.assertEqual(subprocess.run([sys.executable, "-c", code]).returncode, 0)

    def test_functions_agree_with_the_header(self) -> None:
        header = os.environ.get("UMBRAGE_HEADER")
        if not header:
            self.skipTest("UMBRAGE_HEADER names no header")
        import re

        from umbrage import _native

        with open(header) as file:
            text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
        declared = {
            name: [] if words.strip() in ("", "void") else words.split(",")
            for name, words in re.findall(r"UMB_API[^;]*?\b(umb\w+)\(([^;]*)\);", text)
        }
        for name, _, *arguments in _native._FUNCTIONS:
            self.assertEqual(len(arguments), len(declared[name]), name)


if __name__ == "__main__":
    unittest.main()
