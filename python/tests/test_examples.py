"""Tests that the programs of examples/python run and are short, and, if mypy is installed, that types are complete."""
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

from support import SOLIDS

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
EXAMPLES = os.path.join(ROOT, "examples", "python")


def run(name: str, *words: str, code: int = 0) -> str:
    program = [sys.executable, os.path.join(EXAMPLES, name + ".py"), *words]
    ran = subprocess.run(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    if ran.returncode != code:
        raise AssertionError(ran.stderr)
    return ran.stdout


class Examples(unittest.TestCase):
    def test_depth_map(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            target = os.path.join(folder, "relief.png")
            self.assertIn("320 x 240", run("depth_map", target))
            self.assertTrue(os.path.exists(target))

    def test_material_chart(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            target = os.path.join(folder, "chart.gltf")
            run("material_chart", target)
            with open(target, encoding="utf-8") as file:
                self.assertEqual(len(json.load(file)["materials"]), 25)

    def test_numpy_mesh(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("64 x 48", run("numpy_mesh", os.path.join(folder, "wave.png"), "64"))
            self.assertEqual(sorted(os.listdir(folder)), ["wave_0.png", "wave_1.png"])

    def test_thumbnails(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("solids.png", run("thumbnails", folder, SOLIDS))
            self.assertIn("code 3", run("thumbnails", folder, SOLIDS, "missing.obj", code=1))
            self.assertEqual(os.listdir(folder), ["solids.png"])

    @unittest.skipUnless(importlib.util.find_spec("torch"), "torch is not installed")
    def test_torch_tensor(self) -> None:
        self.assertIn("light arrives", run("torch_tensor"))

    def test_they_are_short(self) -> None:
        for name in os.listdir(EXAMPLES):
            if name.endswith(".py"):
                with open(os.path.join(EXAMPLES, name)) as file:
                    self.assertLess(len(file.readlines()), 60, name)


class Notebook(unittest.TestCase):
    FILE = os.path.join(ROOT, "examples", "gallery.ipynb")

    def test_its_cells_run(self) -> None:
        with open(self.FILE, encoding="utf-8") as file:
            cells = [cell for cell in json.load(file)["cells"] if cell["cell_type"] == "code"]
        names: dict = {}
        with unittest.mock.patch.dict(os.environ, UMBRAGE_GALLERY_SIZE="64"):
            for cell in cells:
                self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))  # as committed
                lines = "".join(cell["source"]).split("\n")
                exec("\n".join(lines[:-1]), names)
                shown = eval(lines[-1], names)  # the result that the cell shows
                self.assertIsNotNone(shown)
                if hasattr(shown, "_repr_png_"):
                    self.assertTrue(shown._repr_png_().startswith(b"\x89PNG"))
        self.assertEqual(names["picture"].height, 48)
        self.assertEqual(names["shaded"]["ao"].shape, (48, 64))

    @unittest.skipUnless(
        importlib.util.find_spec("nbclient") and importlib.util.find_spec("ipykernel"), "Jupyter is not installed"
    )
    def test_jupyter_runs_it(self) -> None:
        words = (
            "import sys, nbclient, nbformat\n"
            "notebook = nbclient.NotebookClient(nbformat.read(sys.argv[1], 4), kernel_name='python3').execute()\n"
            "print(sum('image/png' in output.get('data', {}) for cell in notebook.cells for output in cell.get('outputs', ())))"
        )
        with tempfile.TemporaryDirectory() as folder:
            environment = dict(os.environ, UMBRAGE_GALLERY_SIZE="64", HOME=folder)
            ran = subprocess.run(
                [sys.executable, "-c", words, self.FILE], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE
            )
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertGreater(int(ran.stdout), 0)


class Types(unittest.TestCase):
    @unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed")
    def test_mypy_finds_nothing(self) -> None:
        words = ["--strict", "--python-version", "3.8", os.path.join(ROOT, "python", "umbrage")]
        with tempfile.TemporaryDirectory() as cache:
            environment = {"MYPY_CACHE_DIR": cache, **os.environ}  # reuses the build's cache of NumPy's types
            program = [sys.executable, "-m", "mypy", *words]
            ran = subprocess.run(program, env=environment, stdout=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(ran.returncode, 0, ran.stdout)


if __name__ == "__main__":
    unittest.main()
