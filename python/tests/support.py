"""Common functions of the tests."""
import os
import subprocess
import tempfile
import unittest

import numpy as np

SOLIDS = "scene:solids?detail=3000"
SIZE = (48, 32)


def program() -> str:
    """Returns the path of the command line program, which UMBRAGE_PROGRAM names."""
    name = os.environ.get("UMBRAGE_PROGRAM")
    if not name:
        raise unittest.SkipTest("UMBRAGE_PROGRAM names no program")
    return name


def bytes_of_program(*words: str, ending: str = ".png") -> bytes:
    """Runs the command line program and returns the file that it writes."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "picture" + ending)
        subprocess.run([program(), *words, "--device", "cpu", "--config", "none", "-o", file], check=True)
        with open(file, "rb") as picture:
            return picture.read()


def plane_depth(width: int = 48, height: int = 32) -> np.ndarray:
    """Returns the depth of a sphere in front of a wall."""
    y, x = np.mgrid[0:height, 0:width]
    r = np.hypot(x - width / 2, y - height / 2) / height
    return np.where(r < 0.3, 2.5 - np.sqrt(np.maximum(0.09 - r * r, 0)), 3).astype(np.float32)
