"""Tests with the real libraries whose objects test_foreign.py imitates: trimesh, Open3D and PyVista, where they are
installed, such as on Debian 13."""
import importlib
import os
import tempfile
import unittest
from typing import Any

import numpy as np
from test_foreign import BLUE, CORNERS, GREEN, LINEAR, PIXELS, RED, TRIANGLES, UV, WHITE, albedo_of, is_cloud

import umbrage


def library(name: str) -> Any:
    """Returns a module. Skips the test if it is not installed."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name.split(".")[0]:
            raise
        raise unittest.SkipTest(f"{name} is not installed") from error


def rgba(*colors: Any) -> np.ndarray:
    return np.array([(*color, 255) for color in colors], np.uint8)


class Libraries(unittest.TestCase):
    def check(self, thing: Any, *expected: Any) -> None:
        np.testing.assert_allclose(albedo_of(thing), expected, atol=0.01)

    def check_halves(self, thing: Any) -> None:
        np.testing.assert_allclose(albedo_of(thing)[[0, 3]], [LINEAR[BLUE], LINEAR[RED]], atol=0.01)

    def plain(self) -> np.ndarray:
        return albedo_of((CORNERS, TRIANGLES))


class RealTrimesh(Libraries):
    def setUp(self) -> None:
        self.trimesh = library("trimesh")

    def mesh(self, **what: Any) -> Any:
        return self.trimesh.Trimesh(CORNERS, TRIANGLES, process=False, **what)

    def test_meshes_and_colors(self) -> None:
        self.check(self.mesh(), *self.plain())
        self.check(self.mesh(vertex_colors=rgba(RED, RED, RED, RED)), *[LINEAR[RED]] * 4)
        self.check_halves(self.mesh(face_colors=rgba(RED, BLUE)))

    def test_textures(self) -> None:
        image = library("PIL.Image").fromarray(PIXELS)
        materials = self.trimesh.visual.material
        expected = [LINEAR[c] for c in (RED, GREEN, BLUE, WHITE)]
        for material in (materials.SimpleMaterial(image=image), materials.PBRMaterial(baseColorTexture=image)):
            self.check(self.mesh(visual=self.trimesh.visual.TextureVisuals(uv=UV, material=material)), *expected)

    def test_scenes_clouds_and_paths(self) -> None:
        scene = self.trimesh.Scene()
        scene.add_geometry(self.mesh(), transform=self.trimesh.transformations.translation_matrix((0, 0, 3)))
        np.testing.assert_allclose(umbrage.Scene(scene).bounds, [(-1, -1, 3), (1, 1, 3)], atol=1e-6)
        self.assertTrue(is_cloud(self.trimesh.PointCloud(CORNERS)))
        with self.assertRaisesRegex(umbrage.UsageError, "lines"):
            umbrage.Scene(self.trimesh.load_path(CORNERS[:2]))

    def test_files_are_drawn_as_by_umbrage(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "ball.ply")
            self.trimesh.creation.icosphere(subdivisions=3).export(path)
            own = umbrage.render(path, size=(48, 48), device="cpu").picture
            theirs = umbrage.render(self.trimesh.load(path), size=(48, 48), device="cpu").picture
        self.assertLess(np.abs(own.astype(int) - theirs.astype(int)).mean(), 2.0)


class RealOpen3d(Libraries):
    def setUp(self) -> None:
        self.open3d = library("open3d")

    def mesh(self) -> Any:
        o3d = self.open3d
        return o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(CORNERS), o3d.utility.Vector3iVector(TRIANGLES))

    def test_meshes_and_colors(self) -> None:
        mesh = self.mesh()
        self.check(mesh, *self.plain())
        mesh.paint_uniform_color((0.5, 0, 1))  # sRGB
        self.check(mesh, *[(0.214, 0, 1)] * 4)
        self.check(self.open3d.t.geometry.TriangleMesh.from_legacy(mesh), *[(0.214, 0, 1)] * 4)

    def test_textures(self) -> None:
        mesh, o3d = self.mesh(), self.open3d
        mesh.triangle_uvs = o3d.utility.Vector2dVector(UV[TRIANGLES.ravel()])
        mesh.triangle_material_ids = o3d.utility.IntVector([0, 0])
        mesh.textures = [o3d.geometry.Image(np.ascontiguousarray(PIXELS[::-1]))]  # as its readers flip images
        self.check(mesh, *[LINEAR[c] for c in (RED, GREEN, BLUE, WHITE)])

    def test_clouds_and_lines(self) -> None:
        o3d = self.open3d
        points = o3d.utility.Vector3dVector(CORNERS)
        self.assertTrue(is_cloud(o3d.geometry.PointCloud(points)))
        self.assertTrue(is_cloud(o3d.t.geometry.PointCloud.from_legacy(o3d.geometry.PointCloud(points))))
        with self.assertRaisesRegex(umbrage.UsageError, "lines"):
            umbrage.Scene(o3d.geometry.LineSet(points, o3d.utility.Vector2iVector([(0, 1)])))


class RealPyVista(Libraries):
    def setUp(self) -> None:
        self.pyvista = library("pyvista")

    def test_surfaces_and_colors(self) -> None:
        for faces in ([4, 0, 1, 2, 3], [3, 0, 1, 2, 3, 0, 2, 3]):
            self.check(self.pyvista.PolyData(CORNERS, faces), *self.plain())
        surface = self.pyvista.PolyData(CORNERS, [4, 0, 1, 2, 3])
        surface["height"] = np.zeros(4)
        surface["RGB"] = np.tile(np.array(RED, np.uint8), (4, 1))
        self.check(surface, *[LINEAR[RED]] * 4)
        halves = self.pyvista.PolyData(CORNERS, [3, 0, 1, 2, 3, 0, 2, 3])
        halves.cell_data["colors"] = np.array([RED, BLUE], np.uint8)
        self.check_halves(halves)

    def test_strips_grids_and_blocks(self) -> None:
        surface = self.pyvista.PolyData(CORNERS, [4, 0, 1, 2, 3])
        self.check(surface.triangulate().strip(), *self.plain())
        grid = surface.cast_to_unstructured_grid()
        self.check(grid, *self.plain())
        self.check(self.pyvista.MultiBlock([None, grid]), *self.plain())
        image = self.pyvista.ImageData(dimensions=(3, 3, 3), origin=(-1, -1, -1))
        np.testing.assert_allclose(umbrage.Scene(image).bounds, [(-1, -1, -1), (1, 1, 1)])

    def test_clouds_and_lines(self) -> None:
        for cloud in (self.pyvista.PolyData(CORNERS), self.pyvista.PointSet(CORNERS)):
            self.assertTrue(is_cloud(cloud))
        with self.assertRaisesRegex(umbrage.UsageError, "lines"):
            umbrage.Scene(self.pyvista.Line())

    def test_scans_are_drawn(self) -> None:
        ball = self.pyvista.Sphere(theta_resolution=40, phi_resolution=40)
        picture = umbrage.render(ball, size=(64, 64), device="cpu", passes="depth")
        covered = np.isfinite(picture["depth"]).mean()
        self.assertTrue(0.1 < covered < 0.9, covered)


if __name__ == "__main__":
    unittest.main()
