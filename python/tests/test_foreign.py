"""Tests of meshes of trimesh, Open3D and PyVista, by mock objects with the attributes and types of those libraries."""
import os
import tempfile
import types
import unittest
from typing import Any, Dict, Iterator, List, Optional

import numpy as np

import umbrage

# A square of two triangles in the plane z = 0, seen from +z; corner 0 is the lower left one.
CORNERS = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float64)
TRIANGLES = np.array([(0, 1, 2), (0, 2, 3)])
UV = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float64)
RED, GREEN, BLUE, WHITE = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)
# Row 0 is the top row: red and green above, blue and white below.
PIXELS = np.repeat(np.repeat(np.array([(RED, GREEN), (BLUE, WHITE)], np.uint8), 8, axis=0), 8, axis=1)
LINEAR = {RED: (1, 0, 0), GREEN: (0, 1, 0), BLUE: (0, 0, 1), WHITE: (1, 1, 1)}
SIDE = 16


def albedo_of(thing: Any) -> np.ndarray:
    """Returns the albedo of the square's quarters: upper left, upper right, lower left, lower right."""
    camera = {"position": (0, 0, 4), "focal_point": (0, 0, 0), "view_up": (0, 1, 0)}
    made = umbrage.render(thing, size=(SIDE, SIDE), device="cpu", look="ao", passes="albedo", camera=camera)
    near, far = SIDE * 3 // 8, SIDE * 5 // 8
    return np.array([made["albedo"][y, x] for y in (near, far) for x in (near, far)])


def is_cloud(thing: Any) -> bool:
    """Returns whether it has points, which extend beyond the square."""
    lower, upper = umbrage.Scene(thing).bounds
    return bool((lower < (-1, -1, 0)).all() and (upper > (1, 1, 0)).all())


class Image:
    """A mock of an image of Pillow."""

    def __init__(self, pixels: np.ndarray, mode: str = "RGB", palette: Any = None) -> None:
        self.mode, self.info = mode, {}
        self._pixels, self._palette = pixels, palette
        self.__array_interface__ = pixels.__array_interface__

    def convert(self, mode: str) -> "Image":
        pixels = self._pixels if self.mode != "P" else self._palette[self._pixels]
        assert pixels.shape[2] == len(mode), "these tests convert palettes alone"
        return Image(pixels, mode)


# ---- trimesh ----


class Trimesh:
    def __init__(self, visual: Any = None) -> None:
        self.vertices, self.faces, self.visual = CORNERS.view(), TRIANGLES.view(), visual

    @property
    def triangles(self) -> np.ndarray:  # positions, unlike Open3D's
        return self.vertices[self.faces]

    @property
    def vertex_normals(self) -> np.ndarray:
        return np.tile((0.0, 0.0, 1.0), (4, 1))


def colored(**what: Any) -> Trimesh:
    return Trimesh(types.SimpleNamespace(**what))


def textured(material: Any, uv: Any = UV, **what: Any) -> Trimesh:
    return colored(kind="texture", uv=uv, material=material, **what)


def simple(image: Any = None, diffuse: Any = (102, 102, 102, 255)) -> Any:
    gray = np.array((102, 102, 102, 255), np.uint8)  # trimesh's default
    return types.SimpleNamespace(image=image, diffuse=np.array(diffuse, np.uint8), ambient=gray, glossiness=1.0)


def pbr(**what: Any) -> Any:
    names = ("baseColorTexture", "baseColorFactor", "emissiveFactor", "emissiveTexture", "alphaMode", "alphaCutoff")
    return types.SimpleNamespace(**{name: what.get(name) for name in names})


class TrimeshObjects(unittest.TestCase):
    def check(self, thing: Any, *expected: Any) -> None:
        np.testing.assert_allclose(albedo_of(thing), expected, atol=0.01)

    def test_colors(self) -> None:
        rgba = np.array([(*c, 255) for c in (RED, RED, RED, RED)], np.uint8)
        self.check(colored(kind="vertex", vertex_colors=rgba), *[LINEAR[RED]] * 4)
        plain = albedo_of((CORNERS, TRIANGLES))
        self.check(colored(kind=None), *plain)
        self.check(Trimesh(), *plain)

    def test_colors_of_faces(self) -> None:
        rgba = np.array([(*RED, 255), (*BLUE, 255)], np.uint8)  # the lower right triangle, the upper left triangle
        seen = albedo_of(colored(kind="face", face_colors=rgba))
        np.testing.assert_allclose(seen[0], LINEAR[BLUE], atol=0.01)
        np.testing.assert_allclose(seen[3], LINEAR[RED], atol=0.01)

    def test_textures(self) -> None:
        expected = [LINEAR[c] for c in (RED, GREEN, BLUE, WHITE)]
        self.check(textured(simple(Image(PIXELS))), *expected)
        self.check(textured(pbr(baseColorTexture=Image(PIXELS))), *expected)
        numbers = np.repeat(np.repeat(np.arange(4, dtype=np.uint8).reshape(2, 2), 8, axis=0), 8, axis=1)
        self.check(textured(simple(Image(numbers, "P", np.array([RED, GREEN, BLUE, WHITE], np.uint8)))), *expected)
        halved = textured(pbr(baseColorTexture=Image(PIXELS), baseColorFactor=np.array((128, 128, 128, 255), np.uint8)))
        self.check(halved, *(np.array(expected) * 128 / 255))  # glTF's factors are linear

    def test_materials_without_images(self) -> None:
        self.check(textured(simple(diffuse=(255, 0, 255, 255)), uv=None), *[(1, 0, 1)] * 4)
        self.check(textured(pbr(baseColorFactor=np.array((255, 51, 0, 255), np.uint8))), *[(1, 0.2, 0)] * 4)
        self.check(textured(pbr(baseColorFactor=np.array((0.5, 0.25, 0, 1)))), *[(0.5, 0.25, 0)] * 4)
        plain = albedo_of((CORNERS, TRIANGLES))
        self.check(textured(None), *plain)
        self.check(textured(pbr()), *plain)

    def test_several_materials(self) -> None:
        material = types.SimpleNamespace(materials=[simple(diffuse=(*RED, 255)), simple(diffuse=(*BLUE, 255))])
        seen = albedo_of(textured(material, face_materials=np.array([0, 1])))
        np.testing.assert_allclose(seen[[0, 3]], [LINEAR[BLUE], LINEAR[RED]], atol=0.01)

    def test_holes_and_light(self) -> None:
        hole = np.zeros((16, 16, 4), np.uint8)
        hole[:8, :8] = 255
        camera = {"position": (0, 0, 4), "focal_point": (0, 0, 0), "view_up": (0, 1, 0)}
        skin = pbr(baseColorTexture=Image(hole, "RGBA"), alphaMode="MASK")
        made = umbrage.render(textured(skin), size=(SIDE, SIDE), device="cpu", passes="depth", camera=camera)
        near, far = SIDE * 3 // 8, SIDE * 5 // 8
        self.assertTrue(np.isfinite(made["depth"][near, near]) and np.isinf(made["depth"][far, far]))
        glows = textured(pbr(emissiveFactor=np.array((0.5, 0.25, 0)), baseColorFactor=np.zeros(4)))
        made = umbrage.render(glows, size=(SIDE, SIDE), device="cpu", passes="emission", camera=camera)
        np.testing.assert_allclose(made["emission"][8, 8], (0.5, 0.25, 0), atol=0.01)

    def test_scenes_clouds_and_paths(self) -> None:
        cloud = types.SimpleNamespace(vertices=CORNERS, colors=np.full((4, 4), 255, np.uint8))
        path = types.SimpleNamespace(vertices=CORNERS, entities=[object()])
        scene = types.SimpleNamespace(geometry={}, graph=object(), dump=lambda: [Trimesh(), path])
        np.testing.assert_array_equal(umbrage.Scene(scene).bounds, [(-1, -1, 0), (1, 1, 0)])
        scene = types.SimpleNamespace(geometry={}, graph=object(), dump=lambda: [Trimesh(), cloud])
        self.assertTrue(is_cloud(scene))
        self.assertTrue(is_cloud(cloud))
        with self.assertRaisesRegex(umbrage.UsageError, "lines"):
            umbrage.Scene(path)
        nothing = types.SimpleNamespace(geometry={}, dump=lambda: [])
        with self.assertRaisesRegex(umbrage.UsageError, "the scene is empty"):
            umbrage.render(nothing)


# ---- Open3D ----


class Vector:
    """A mock of a Vector3dVector: a list that NumPy can read."""

    def __init__(self, values: Any, dtype: Any = np.float64) -> None:
        self._values = np.array(values, dtype)

    def __len__(self) -> int:
        return len(self._values)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> np.ndarray:
        return self._values


def open3d(**what: Any) -> Any:
    empty = np.zeros((0, 3))
    mesh = {
        "vertices": Vector(CORNERS),
        "triangles": Vector(TRIANGLES, np.int32),
        "vertex_colors": Vector(empty),
        "vertex_normals": Vector(empty),
        "triangle_normals": Vector(empty),
        "triangle_uvs": Vector(np.zeros((0, 2))),
        "textures": [],
        "triangle_material_ids": Vector([], np.int32),
    }
    return types.SimpleNamespace(**{**mesh, **what})


class TensorMap(dict):  # type: ignore[type-arg]
    pass


class Tensor:
    def __init__(self, values: Any, dtype: Any = np.float32) -> None:
        self._values = np.array(values, dtype)

    def cpu(self) -> "Tensor":
        return self

    def numpy(self) -> np.ndarray:
        return self._values


class Open3dObjects(unittest.TestCase):
    def check(self, thing: Any, *expected: Any) -> None:
        np.testing.assert_allclose(albedo_of(thing), expected, atol=0.01)

    def test_meshes(self) -> None:
        self.check(open3d(), *albedo_of((CORNERS, TRIANGLES)))
        # Floats are sRGB: 0.5 is 0.214 in linear light.
        self.check(open3d(vertex_colors=Vector([(0.5, 0, 1)] * 4)), *[(0.214, 0, 1)] * 4)
        normals = Vector([(0.0, 0.0, 1.0)] * 4)
        self.check(open3d(vertex_normals=normals), *albedo_of((CORNERS, TRIANGLES)))

    def test_textures(self) -> None:
        of_corners = UV[TRIANGLES.ravel()]
        turned = np.ascontiguousarray(PIXELS[::-1])  # flipped as Open3D's readers flip images
        expected = [LINEAR[c] for c in (RED, GREEN, BLUE, WHITE)]
        self.check(open3d(triangle_uvs=Vector(of_corners), textures=[turned]), *expected)
        blue, red = (np.full((1, 1, 3), c, np.uint8) for c in (BLUE, RED))
        ids = Vector([1, 0], np.int32)
        mesh = open3d(triangle_uvs=Vector(of_corners), textures=[blue, red], triangle_material_ids=ids)
        np.testing.assert_allclose(albedo_of(mesh)[[0, 3]], [LINEAR[BLUE], LINEAR[RED]], atol=0.01)

    def test_tensor_meshes(self) -> None:
        vertex = TensorMap(positions=Tensor(CORNERS), normals=Tensor([(0, 0, 1)] * 4))
        triangle = TensorMap(indices=Tensor(TRIANGLES, np.int64))
        mesh = types.SimpleNamespace(vertex=vertex, triangle=triangle, material=types.SimpleNamespace(texture_maps={}))
        self.check(mesh, *albedo_of((CORNERS, TRIANGLES)))
        vertex["colors"] = Tensor([RED] * 4, np.uint8)
        self.check(mesh, *[LINEAR[RED]] * 4)
        del vertex["colors"]
        triangle["texture_uvs"] = Tensor(UV[TRIANGLES])
        mesh.material.texture_maps["albedo"] = types.SimpleNamespace(as_tensor=lambda: Tensor(PIXELS, np.uint8))
        self.check(mesh, *[LINEAR[c] for c in (RED, GREEN, BLUE, WHITE)])
        cloud = types.SimpleNamespace(point=TensorMap(positions=Tensor(CORNERS)), to_legacy=lambda: None)
        self.assertTrue(is_cloud(cloud))

    def test_clouds_and_lines(self) -> None:
        cloud = types.SimpleNamespace(points=Vector(CORNERS), colors=Vector([(1, 0, 0)] * 4), normals=Vector(np.zeros((0, 3))))
        self.assertTrue(is_cloud(cloud))
        lines = types.SimpleNamespace(points=Vector(CORNERS), lines=Vector([(0, 1)], np.int32), colors=Vector([]))
        tensor_lines = types.SimpleNamespace(point=TensorMap(positions=Tensor(CORNERS)), line=TensorMap(), to_legacy=None)
        tetras = types.SimpleNamespace(vertices=Vector(CORNERS), tetras=Vector([(0, 1, 2, 3)], np.int32))
        for thing in (lines, tensor_lines, tetras):
            with self.assertRaisesRegex(umbrage.UsageError, "lines|tetras"):
                umbrage.Scene(thing)


# ---- PyVista ----


class PolyData:
    n_strips = 0

    def __init__(self, faces: Any, point_data: Any = (), cell_data: Any = (), lines: Any = (), active: Any = None) -> None:
        self.points = CORNERS.astype(np.float32)
        self.faces = np.array(faces, np.int64)
        self.faces.flags.writeable = False
        self.lines = np.array(lines, np.int64)
        self.point_data: Dict[str, Any] = dict(point_data)
        self.cell_data: Dict[str, Any] = dict(cell_data)
        self.active_scalars_name = active

    @property
    def n_cells(self) -> int:
        count = at = 0
        while at < self.faces.size:
            at, count = at + int(self.faces[at]) + 1, count + 1
        return count

    def extract_surface(self) -> "PolyData":
        return self

    def triangulate(self) -> "PolyData":
        return PolyData([3, 0, 1, 2, 3, 0, 2, 3], self.point_data, self.cell_data)


class Blocks:
    """A mock of a MultiBlock."""

    def __init__(self, *blocks: Any) -> None:
        self._blocks, self.n_blocks = blocks, len(blocks)

    def __iter__(self) -> Iterator[Any]:
        return iter(self._blocks)

    def keys(self) -> List[str]:
        return [f"Block-{k:02d}" for k in range(self.n_blocks)]


class PyVistaObjects(unittest.TestCase):
    QUAD = [4, 0, 1, 2, 3]
    HALVES = [3, 0, 1, 2, 3, 0, 2, 3]

    def check(self, thing: Any, *expected: Any) -> None:
        np.testing.assert_allclose(albedo_of(thing), expected, atol=0.01)

    def test_surfaces(self) -> None:
        plain = albedo_of((CORNERS, TRIANGLES))
        for faces in (self.QUAD, self.HALVES):
            self.check(PolyData(faces), *plain)
        strips = PolyData([])
        strips.n_strips = 1
        self.check(strips, *plain)

    def test_colors(self) -> None:
        numbers = {"height": np.zeros(4), "Normals": np.zeros((4, 3), np.float32)}
        red, blue = (np.tile(np.array(c, np.uint8), (4, 1)) for c in (RED, BLUE))
        self.check(PolyData(self.QUAD, {**numbers, "RGB": red}), *[LINEAR[RED]] * 4)
        self.check(PolyData(self.QUAD, {**numbers, "a": red, "b": blue}, active="b"), *[LINEAR[BLUE]] * 4)
        cells = {"colors": np.array([RED, BLUE], np.uint8)}
        seen = albedo_of(PolyData(self.HALVES, cell_data=cells))
        np.testing.assert_allclose(seen[[0, 3]], [LINEAR[BLUE], LINEAR[RED]], atol=0.01)
        self.check(PolyData(self.QUAD, cell_data={"ids": np.zeros((1, 3), np.int64)}), *albedo_of((CORNERS, TRIANGLES)))

    def test_grids_and_blocks(self) -> None:
        plain = albedo_of((CORNERS, TRIANGLES))
        grid = types.SimpleNamespace(points=CORNERS, cells=np.array([4, 0, 1, 2, 3]), celltypes=np.array([9]), n_cells=1)
        grid.extract_surface = lambda: PolyData(self.QUAD)
        self.check(grid, *plain)
        self.check(Blocks(None, grid), *plain)

    def test_clouds_and_lines(self) -> None:
        def refuses() -> None:
            raise RuntimeError("PointSet does not support cell-based operations")

        points = types.SimpleNamespace(points=CORNERS, point_data={}, n_cells=0, extract_surface=refuses)
        for thing in (points, PolyData([])):
            self.assertTrue(is_cloud(thing))
        for thing in (PolyData([], lines=[2, 0, 1]), types.SimpleNamespace(points=CORNERS, cells=[("triangle", TRIANGLES)])):
            with self.assertRaisesRegex(umbrage.UsageError, "lines|cells"):
                umbrage.Scene(thing)


# ---- Values as colours ----


def shown(thing: Any, **parameters: Any) -> np.ndarray:
    """Returns the grey of the square's quarters as in albedo_of, from 0 to 1 by display values."""
    camera = {"position": (0, 0, 4), "focal_point": (0, 0, 0), "view_up": (0, 1, 0)}
    made = umbrage.render(thing, size=(SIDE, SIDE), device="cpu", look="ao", occlusion="none", color_map="gray",
                          anti_aliasing=1, camera=camera, **parameters)
    near, far = SIDE * 3 // 8, SIDE * 5 // 8
    return np.array([np.asarray(made)[y, x, 0] / 255 for y in (near, far) for x in (near, far)])


class Values(unittest.TestCase):
    X = [0.0, 1.0, 1.0, 0.0]  # at the corners

    def rises(self, quarters: np.ndarray) -> None:
        """Expects grey to rise to the right."""
        left, right = quarters[[0, 2]], quarters[[1, 3]]
        self.assertTrue((left < 0.45).all() and (right > 0.55).all(), quarters)

    def test_arrays(self) -> None:
        model = (CORNERS, TRIANGLES)
        self.rises(shown(model, values=self.X))
        self.rises(shown(model, values=np.array(self.X, np.float32), color_by="pressure"))
        vectors = np.stack([np.zeros(4), self.X], axis=1)
        self.rises(shown(model, values={"v": vectors, "w": [3, 3, 3, 4]}, color_by="v"))
        self.rises(shown(model, values={"v": vectors}, color_component="y"))
        self.rises(shown(umbrage.Scene(CORNERS, TRIANGLES, values={"p": self.X}), color_by="p"))
        of_faces = shown(model, values=[1, 5])
        self.assertEqual((of_faces[0], of_faces[3]), (1.0, 0.0), "upper left and lower right")
        of_polygon = shown((CORNERS, np.array([[0, 1, 2, 3]])), values=[7], color_range=(0, 14))
        np.testing.assert_allclose(of_polygon, 0.5, atol=0.01)
        self.rises(shown((CORNERS, np.array([4, 0, 1, 2, 3])), values=self.X))
        with self.assertWarnsRegex(umbrage.UmbrageWarning, "2 of 2 triangles have no finite 'values'"):
            missing = shown(model, values=[np.nan, 0, 1, 0], missing_color=(1, 0, 0))
        np.testing.assert_allclose(missing, 1.0, atol=0.01)

    def test_a_renderer_shows_one_field_after_the_other(self) -> None:
        values = {"x": self.X, "flat": [5, 5, 5, 5]}
        with umbrage.Renderer((CORNERS, TRIANGLES), values=values, color_by="x", size=(16, 16), device="cpu") as renderer:
            first = np.array(renderer.render())
            with self.assertWarnsRegex(umbrage.UmbrageWarning, "all values of 'flat' are 5"):
                second = np.array(renderer.render(color_by="flat"))
            self.assertFalse((first == second).all())
            self.assertTrue((np.array(renderer.render(color_by="x")) == first).all())

    def test_other_libraries(self) -> None:
        for thing in (PolyData(PyVistaObjects.QUAD, {"p": self.X, "q": np.zeros(4)}, active="p"),
                      Blocks(PolyData(PyVistaObjects.HALVES, {"p": self.X}))):
            self.rises(shown(thing, color_by="p"))
        self.rises(shown(PolyData(PyVistaObjects.QUAD, {"q": np.zeros(4), "p": self.X}, active="p"), color_by=True))
        cells = shown(PolyData(PyVistaObjects.HALVES, cell_data={"c": [1.0, 5.0]}), color_by="c")
        self.assertEqual((cells[0], cells[3]), (1.0, 0.0))
        mesh = Trimesh()
        mesh.vertex_attributes, mesh.face_attributes = {"p": np.array(self.X)}, {"c": np.array([1.0, 5.0])}
        self.rises(shown(mesh, color_by="p"))
        self.rises(shown(mesh, color_by=True))
        self.assertEqual(shown(mesh, color_by="c")[3], 0.0)

    def test_errors(self) -> None:
        model = (CORNERS, TRIANGLES)
        for parameters, says in (
            ({"values": [1, 2, 3]}, r"`values` has the shape \(3, 1\)"),
            ({"values": [["a"] * 4]}, "values"),
            ({"values": {"a": self.X, "b": self.X}}, "`color_by` is missing: `values` has 'a', 'b'"),
            ({"values": {"a": self.X}, "color_by": "b"}, "no such field"),
            ({"color_by": "b"}, "has no fields of values"),
            ({"color_by": True}, "`color_by` cannot be True"),
            ({"values": self.X, "color_range": (2, 1)}, "low below high"),
            ({"values": self.X, "color_component": "3"}, "one component, 0"),
        ):
            with self.assertRaisesRegex(umbrage.UsageError, says):
                shown(model, **parameters)
        with self.assertRaisesRegex(umbrage.UsageError, "`values` is for a model"):
            umbrage.render("scene:solids", values=self.X)


class Models(unittest.TestCase):
    def test_what_is_none(self) -> None:
        for thing in (3, None, object(), np.zeros((4, 3)), {"vertices": CORNERS}):
            with self.assertRaisesRegex(umbrage.UsageError, "not a model"):
                umbrage.render(thing)
        with self.assertRaisesRegex(umbrage.UsageError, "another"):
            umbrage.Scene().add(umbrage.Scene())
        with self.assertRaisesRegex(umbrage.UsageError, "`colors` is for arrays"):
            umbrage.Scene(Trimesh(), colors=(1, 0, 0))

    def test_all_or_nothing(self) -> None:
        scene = umbrage.Scene()
        broken = types.SimpleNamespace(geometry={}, dump=lambda: [Trimesh(), object()])
        with self.assertRaisesRegex(umbrage.UsageError, "not a model"):
            scene.add(broken)
        with self.assertRaisesRegex(umbrage.UsageError, "empty"):
            scene.bounds

    def test_lists_of_models(self) -> None:
        np.testing.assert_array_equal(umbrage.Scene().add([Trimesh(), open3d()]).bounds, [(-1, -1, 0), (1, 1, 0)])

    def test_colors_are_those_of_files(self) -> None:
        colors = np.array([RED, GREEN, BLUE, (90, 120, 200)], np.uint8)
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "square.ply")
            with open(file, "w") as ply:
                ply.write("ply\nformat ascii 1.0\nelement vertex 4\n")
                ply.writelines(f"property float {name}\n" for name in "xyz")
                ply.writelines(f"property uchar {name}\n" for name in ("red", "green", "blue"))
                ply.write("element face 2\nproperty list uchar int vertex_indices\nend_header\n")
                ply.writelines(f"{x:g} {y:g} {z:g} {r} {g} {b}\n" for (x, y, z), (r, g, b) in zip(CORNERS, colors))
                ply.writelines("3 {} {} {}\n".format(*triangle) for triangle in TRIANGLES)
            expected = albedo_of(file)
        np.testing.assert_array_equal(albedo_of(umbrage.Scene(CORNERS, TRIANGLES, colors=colors)), expected)

    def test_paths(self) -> None:
        self.assertEqual(umbrage.Scene("scene:solids?detail=1000").bounds.shape, (2, 3))


if __name__ == "__main__":
    unittest.main()
