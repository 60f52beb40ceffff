"""Random tests: any arguments give a picture or an UmbrageError, never another exception, a crash, or a change of
memory that is not an output."""
import random
import unittest
import warnings

import numpy as np

import umbrage

TRIES = 1500
SHAPES = [(8, 12)] * 6 + [(8, 12, 3)] * 4 + [(8, 12, 4), (8, 12, 1), (0, 4), (3, 8, 12), (5,), (), (7, 12, 3), (1, 9000)]
TYPES = ["f4"] * 6 + ["f2", "f8", "u1", "u2", "u4", "i4", "i8", "?", ">f4", "c8", "O", "S3", "M8[s]"]
OTHERS = (None, 3, "x", object(), b"abc", [], {}, (1, 2, 3), [[1.0, 2.0], [3.0]], float("nan"))


class Hostile(unittest.TestCase):
    def setUp(self) -> None:
        self.dice = random.Random(7)
        self.numbers = np.random.RandomState(7)

    def array(self, *shapes: tuple) -> object:
        roll = self.dice.random()
        if roll < 0.05:
            return self.dice.choice(OTHERS)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            values = self.numbers.standard_normal(self.dice.choice(shapes or SHAPES)) + self.dice.choice((0, 3))
            array = np.array(values * self.dice.choice((1, 10, 1e30, 0))).astype(self.dice.choice(TYPES))
        if array.dtype.kind == "f" and array.size and self.dice.random() < 0.2:
            array.flat[self.dice.randrange(array.size)] = self.dice.choice((np.nan, np.inf, -np.inf))
        if roll < 0.15:
            return array.T if roll < 0.1 else array[::-1] if array.ndim else array
        return np.broadcast_to(array, (8, 12) + array.shape) if roll < 0.25 and array.ndim < 2 else array

    def some(self, **chances: object) -> dict:
        return {name: make() for name, make in chances.items() if self.dice.random() < 0.3}  # type: ignore[operator]

    def tried(self, work: object, **arguments: object) -> int:
        """Returns 1 if a picture was made, 0 after an UmbrageError."""
        try:
            work(**arguments)  # type: ignore[operator]
            return 1
        except (umbrage.InternalError, umbrage.DeviceError):
            raise
        except umbrage.UmbrageError:
            return 0

    def test_shading(self) -> None:
        shader, made, any_array = umbrage.Shader(device="cpu", look="ao"), 0, self.array
        for _ in range(TRIES):
            images = self.some(**{"layer1.depth": any_array, "emission": any_array, "nix": any_array})
            given = self.some(normal=any_array, albedo=any_array, object_id=any_array, images=lambda: images)
            given.update(self.some(out=lambda: self.dice.choice((any_array(), {"ao": any_array(), "depth": any_array()}))))
            made += self.tried(shader.shade, depth=any_array((8, 12)), **given)
        self.assertGreater(made, 20)

    def test_scenes(self) -> None:
        made, any_array = 0, self.array

        def draw(**given: object) -> None:
            scene = umbrage.Scene(**given)  # type: ignore[arg-type]
            scene.bounds
            scene.render(size=(12, 8), look="ao", device="cpu")

        for _ in range(TRIES):
            faces = self.dice.choice((None, self.numbers.randint(-1, 9, (5, 3)), self.numbers.randint(0, 8, (5, 4)), any_array()))
            colors, normals = (lambda: any_array((8, 3), (8, 4), (3,))), (lambda: any_array((8, 3)))
            given = self.some(colors=colors, normals=normals, uv=any_array, albedo=any_array, texture=any_array)
            made += self.tried(draw, vertices=any_array((8, 3), (8, 3), (8, 2)), faces=faces, **given)
        self.assertGreater(made, 20)


if __name__ == "__main__":
    unittest.main()
