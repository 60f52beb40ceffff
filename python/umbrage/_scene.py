"""Scene: meshes and clouds of points from files, arrays and objects of other libraries."""
from __future__ import annotations

import ctypes
import os
import threading
import warnings
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Iterator, List, Optional, Sequence, Tuple, Union

from . import _native as native
from ._arrays import _TYPES, as_array, image_array, image_of
from ._errors import UmbrageWarning, UsageError
from ._progress import Progress, Watch

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._picture import Picture

SCENE_PARAMETERS = frozenset(("up", "crease_angle_deg", "point_size", "point_sprites", "scene_index"))


def tell_warnings(texts: List[bytes], depth: int = 4) -> None:
    """Hands on what the library has warned of."""
    while texts:
        warnings.warn(texts.pop(0).decode("utf-8", "replace"), UmbrageWarning, stacklevel=depth)


class Scene:
    """Meshes and points, with colours and materials. World space, right-handed; any unit.

    ::

        scene = umbrage.Scene(vertices, faces, colors=colors)     # from arrays
        scene = umbrage.Scene.load("bunny.obj")                   # from a file
        scene = umbrage.Scene.of(trimesh.load("bunny.obj"))       # from another library
        scene.render(size=(800, 600), look="studio").save("bunny.png")

    Different threads may render one scene at the same time; changing it meanwhile is a UsageError.
    """

    def __init__(
        self,
        vertices: Any = None,
        faces: Any = None,
        *,
        colors: Any = None,
        normals: Any = None,
        uv: Any = None,
        up: Union[None, str, Sequence[float]] = None,
        **parameters: Any,
    ) -> None:
        """An empty scene, or one of a mesh: see add_mesh, which takes `colors`, `normals`, `uv` and more.

        `up`: which way is up in the world, "+Z" or three numbers; default +Y. Other parameters of
        umbrage.parameters("scene"), such as `crease_angle_deg`, hold for what is added afterwards.
        Errors: UsageError.
        """
        self._device = native.new_device("cpu", 1)  # computes nothing: errors and warnings are told to it
        self._handle = native.Handle(native.lib.umbNewScene(self._device.pointer), "Scene")
        self._lock = threading.Lock()
        self._readers = 0
        self._is_changing = False
        of_scene = {name: parameters.pop(name) for name in list(parameters) if name in SCENE_PARAMETERS}
        for name, value in dict(of_scene, up=up).items():
            self.set(name, value)
        if vertices is not None:
            self.add_mesh(vertices, faces, colors=colors, normals=normals, uv=uv, **parameters)
        elif faces is not None or colors is not None or normals is not None or uv is not None or parameters:
            raise UsageError("a mesh needs `vertices`")

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"], *more: Any, progress: Progress = None, **parameters: Any) -> Scene:
        """A scene of one model or several, as they stand in their files: OBJ, PLY, STL, glTF/GLB, ..., or a built-in
        one, "scene:NAME?detail=N". Keywords are those of umbrage.parameters("scene").

        Errors: UsageError; FileError; what `progress` raises.
        """
        scene = cls(**parameters)
        for each in (path,) + more:
            scene.add(each, progress=progress)
        return scene

    @classmethod
    def of(cls, thing: Any, **parameters: Any) -> Scene:
        """A scene of whatever it is: see add."""
        return thing if isinstance(thing, Scene) and not parameters else cls(**parameters).add(thing)

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter of umbrage.parameters("scene"); None: as at first. Errors: UsageError."""
        if value is not None and not isinstance(value, str):
            flat = as_array(value, name).ravel().tolist()
            value = ",".join(format(v, ".9g") if isinstance(v, float) else str(v) for v in flat)
        text = None if value is None else native.bytes_of(value)
        with self._changing():
            self._handle.check(native.lib.umbSetSceneParameter(self._handle.pointer, native.bytes_of(name), text))

    def add(self, thing: Any, *, progress: Progress = None) -> Scene:
        """Adds a model and returns the scene. `thing`: a path; a pair (vertices, faces); a mesh, scene or cloud of
        trimesh, a mesh or cloud of Open3D, a surface of PyVista, or an object that has the same attributes.

        Errors: UsageError; FileError; what `progress` raises.
        """
        if isinstance(thing, (str, os.PathLike)):
            with self._changing(), Watch(progress, is_before=True) as watch:
                self._load(native.bytes_of(os.fspath(thing)), watch)
            return self
        for mesh in _meshes_of(thing):
            self.add_mesh(**mesh)
        return self

    def _load(self, model: bytes, watch: Watch) -> None:
        lib, handle = native.lib, self._handle
        told: List[bytes] = []
        try:
            lib.umbSetDeviceLogCallback(self._device.pointer, native.append_to_list, told)
            lib.umbSetSceneProgressCallback(handle.pointer, native.tell_generator, watch.generator)
            handle.check(lib.umbLoadModel(handle.pointer, model))
        finally:
            lib.umbSetSceneProgressCallback(handle.pointer, native.no_progress, None)
            lib.umbSetDeviceLogCallback(self._device.pointer, native.no_log, None)
            tell_warnings(told)

    def add_mesh(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        colors: Any = None,
        normals: Any = None,
        uv: Any = None,
        radii: Any = None,
        name: str = "",
        albedo: Optional[Sequence[float]] = None,
        emission: Optional[Sequence[float]] = None,
        specular: Optional[float] = None,
        shininess: Optional[float] = None,
        texture: Any = None,
        instances: Any = None,
    ) -> int:
        """Adds a mesh, or without `faces` a cloud of points, and returns its number. Everything is copied.

        vertices: (N, 3) scene units. faces: (M, 3) indices from 0, or (M, K) convex polygons. colors: (N, 3) or (N, 4),
        or one colour for all; uint8 and uint16 are sRGB, floats linear, 0 to 1. normals: (N, 3). uv: (N, 2), (0, 0) is
        the texture's lower left corner. radii: (N,) of points, scene units. albedo, emission: three linear numbers.
        specular: peak of the highlight, 0 to 1. shininess: Blinn-Phong exponent. texture: (H, W, 3 or 4) uint8, sRGB,
        that multiplies the albedo. instances: (K, 3, 4) or (K, 4, 4), places of the mesh, world from mesh.
        Errors: UsageError, also for numbers that are not finite and indices beyond the vertices.
        """
        import numpy as np

        lib, scene = native.lib, self._handle
        points = _rows(vertices, "vertices", (3,), np.float32)
        if not np.isfinite(points).all():
            at = int(np.nonzero(~np.isfinite(points).all(axis=1))[0][0])
            raise UsageError(f"`vertices` holds a number that is not finite, in row {at}")
        count = len(points)
        buffers: List[Tuple[str, NDArray[Any]]] = [("position", points)]
        triangles = None if faces is None else _triangles(faces, count)
        if triangles is not None:
            buffers.append(("index", triangles))
        for each, values, sides in (("normal", normals, (3,)), ("uv", uv, (2,)), ("radius", radii, (1,))):
            if values is not None:
                buffers.append((each, _rows(values, each, sides, np.float32, count)))
        if colors is not None:
            buffers.append(("color", _colors(colors, count)))
        given = {"albedo": albedo, "emission": emission, "specular": specular, "shininess": shininess}
        floats = {each: _floats(value, each) for each, value in given.items() if value is not None}
        named = native.bytes_of(name)
        skin = None if texture is None else image_array(texture, "texture")
        places: Any = None if instances is None else _places(instances)
        with self._changing():
            mesh = lib.umbAddMesh(scene.pointer, named, count, 0 if triangles is None else len(triangles))
            if mesh < 0:
                scene.check(2)
            for each, array in buffers:
                buffer_type, channels = _TYPES[array.dtype.name], array.shape[1]
                scene.check(
                    lib.umbSetMeshBuffer(
                        scene.pointer, mesh, each.encode(), array.ctypes.data, buffer_type, channels, array.strides[0]
                    )
                )
            for each, numbers in floats.items():
                data = numbers.ctypes.data_as(ctypes.POINTER(ctypes.c_float))
                scene.check(lib.umbSetMeshFloats(scene.pointer, mesh, each.encode(), data, len(numbers)))
            if skin is not None:
                scene.check(lib.umbSetMeshTexture(scene.pointer, mesh, b"albedo", ctypes.byref(image_of(skin))))
            for k in range(0 if places is None else len(places)):
                data = places[k].ctypes.data_as(ctypes.POINTER(ctypes.c_float))
                scene.check(lib.umbAddMeshInstance(scene.pointer, mesh, data))
        return int(mesh)

    @property
    def bounds(self) -> NDArray[Any]:
        """The box that holds the scene: (2, 3) float32, lower and upper corner. Errors: UsageError for an empty one."""
        import numpy as np

        box = np.empty((2, 3), np.float32)
        corners = [corner.ctypes.data_as(ctypes.POINTER(ctypes.c_float)) for corner in box]
        with self.reading():
            self._handle.check(native.lib.umbGetSceneBounds(self._handle.pointer, *corners))
        return box

    @property
    def camera_count(self) -> int:
        """How many cameras the scene's files hold: camera={"index": 0} is the first one."""
        with self.reading():
            return int(native.lib.umbGetSceneCameraCount(self._handle.pointer))

    def render(self, **arguments: Any) -> Picture:
        """Draws the scene: see umbrage.render, whose keywords it takes."""
        from ._render import render

        return render(self, **arguments)

    @property
    def handle(self) -> native.Handle:
        """The library's scene."""
        return self._handle

    @contextmanager
    def reading(self) -> Iterator[None]:
        """While it is used."""
        with self._lock:
            if self._is_changing:
                raise UsageError("the scene is being changed by another thread")
            self._readers += 1
        try:
            yield
        finally:
            with self._lock:
                self._readers -= 1

    @contextmanager
    def _changing(self) -> Iterator[None]:
        with self._lock:
            if self._readers or self._is_changing:
                raise UsageError("the scene cannot be changed while it is rendered or changed by another thread")
            self._is_changing = True
        try:
            yield
        finally:
            with self._lock:
                self._is_changing = False


def _floats(values: Any, name: str) -> NDArray[Any]:
    """Errors: UsageError."""
    import numpy as np

    array = as_array(values, name).ravel()
    if array.dtype.kind not in "fiu":
        raise UsageError(f"`{name}` cannot be {values!r}: it takes numbers")
    return array.astype(np.float32)


def _rows(
    values: Any, name: str, sides: Tuple[int, ...], dtype: Any, count: Optional[int] = None
) -> NDArray[Any]:
    """Values of vertices as (count, side), a row packed. Errors: UsageError."""
    import numpy as np

    array = as_array(values, name)
    if array.ndim == 1 and sides == (1,):
        array = array[:, np.newaxis]
    if array.ndim != 2 or array.shape[1] not in sides or (count is not None and len(array) != count):
        rows = "N" if count is None else count
        wanted = " or ".join(f"({rows}, {side})" for side in sides)
        raise UsageError(f"`{name}` has the shape {array.shape}: it takes {wanted}")
    if dtype is not None:
        if array.dtype.kind not in "fiu":
            raise UsageError(f"`{name}` cannot be of {array.dtype.name}: it takes numbers")
        array = array.astype(dtype, copy=False)
    is_row_packed = array.shape[1] == 1 or array.strides[1] == array.dtype.itemsize
    if array.dtype.isnative and is_row_packed and (array.strides[0] != 0 or len(array) < 2):
        return array
    return np.array(array, dtype=array.dtype.newbyteorder("="), order="C")


def _triangles(faces: Any, vertex_count: int) -> NDArray[Any]:
    """Triangles as (M, 3) of unsigned integers. Errors: UsageError."""
    import numpy as np

    array = as_array(faces, "faces")
    if array.size and array.dtype.kind not in "iu":
        raise UsageError(f"`faces` cannot be of {array.dtype.name}: it takes whole numbers")
    if array.ndim == 1 and array.size:
        array = _padded_faces(array)
    if array.ndim != 2 or array.shape[1] < 3:
        raise UsageError(f"`faces` has the shape {array.shape}: it takes (M, 3), or (M, K) of polygons")
    if not len(array):
        raise UsageError("`faces` is empty: leave it out for a cloud of points")
    least, most = int(array.min()), int(array.max())
    if least < 0 or most >= vertex_count:
        at = int(np.nonzero((array < 0).any(axis=1) | (array >= vertex_count).any(axis=1))[0][0])
        raise UsageError(f"`faces` names vertices {array[at].tolist()} in row {at}: the mesh has {vertex_count}")
    if array.shape[1] > 3:
        fans = [array[:, (0, k, k + 1)] for k in range(1, array.shape[1] - 1)]
        array = np.stack(fans, axis=1).reshape(-1, 3)
    if array.dtype.kind == "i" or array.dtype.itemsize > 4:
        array = array.astype(np.uint32)
    return _rows(array, "faces", (3,), None)


def _padded_faces(array: NDArray[Any]) -> NDArray[Any]:
    """Faces as VTK has them, each after the number of its corners, as triangles."""
    import numpy as np

    corners = int(array[0])
    if corners >= 3 and array.size % (corners + 1) == 0 and (array[:: corners + 1] == corners).all():
        return array.reshape(-1, corners + 1)[:, 1:]
    triangles: List[List[int]] = []
    at, numbers = 0, array.tolist()
    while at < len(numbers):
        face = numbers[at + 1 : at + 1 + int(numbers[at])]
        if len(face) < 3:
            raise UsageError(f"`faces` holds a face of {len(face)} vertices, at {at}")
        triangles += [[face[0], face[k], face[k + 1]] for k in range(1, len(face) - 1)]
        at += 1 + len(face)
    return np.array(triangles)


def _colors(colors: Any, count: int) -> NDArray[Any]:
    """Colours of vertices as (count, 3 or 4). Errors: UsageError."""
    import numpy as np

    array = as_array(colors, "colors")
    if array.ndim == 1 and array.size in (3, 4):
        array = np.broadcast_to(array, (count, array.size))
    if array.dtype.name not in ("uint8", "uint16"):
        if array.dtype.kind != "f":
            raise UsageError(f"`colors` cannot be of {array.dtype.name}: it takes floats from 0 to 1, uint8 or uint16")
        array = array.astype(np.float32, copy=False)
        if not np.isfinite(array).all():
            raise UsageError("`colors` holds a number that is not finite")
    return _rows(array, "colors", (3, 4), None, count)


def _places(instances: Any) -> NDArray[Any]:
    import numpy as np

    array = as_array(instances, "instances")
    if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)):
        raise UsageError(f"`instances` has the shape {array.shape}: it takes (K, 3, 4) or (K, 4, 4)")
    return _floats(array[:, :3, :], "instances").reshape(-1, 12)


def _meshes_of(thing: Any) -> Iterator[Any]:
    """The arguments of add_mesh for objects of other libraries. Errors: UsageError."""
    import numpy as np

    if isinstance(thing, (tuple, list)) and len(thing) == 2:  # (vertices, faces)
        yield {"vertices": thing[0], "faces": thing[1]}
    elif hasattr(thing, "geometry") and hasattr(thing, "dump"):  # trimesh.Scene: its meshes at their places
        for mesh in thing.dump():
            for each in _meshes_of(mesh):
                yield each
    elif hasattr(thing, "vertices") and hasattr(thing, "triangles"):  # open3d.geometry.TriangleMesh
        yield {
            "vertices": thing.vertices,
            "faces": np.asarray(thing.triangles),
            "colors": _screen_colors(getattr(thing, "vertex_colors", None)),
            "normals": _some(getattr(thing, "vertex_normals", None)),
        }
    elif hasattr(thing, "vertices") and hasattr(thing, "faces"):  # trimesh.Trimesh
        skin = getattr(thing, "visual", None)
        has_colors = getattr(skin, "kind", None) == "vertex"
        colors = skin.vertex_colors if has_colors and skin is not None else None
        yield {"vertices": thing.vertices, "faces": thing.faces, "colors": colors}
    elif hasattr(thing, "points") and hasattr(thing, "faces"):  # pyvista.PolyData
        faces = np.asarray(thing.faces)
        yield {"vertices": thing.points, "faces": faces if faces.size else None, "colors": _vtk_colors(thing)}
    elif hasattr(thing, "points"):  # open3d.geometry.PointCloud
        yield {
            "vertices": thing.points,
            "colors": _screen_colors(getattr(thing, "colors", None)),
            "normals": _some(getattr(thing, "normals", None)),
        }
    elif hasattr(thing, "vertices"):  # trimesh.PointCloud
        yield {"vertices": thing.vertices, "colors": _some(getattr(thing, "colors", None))}
    else:
        raise UsageError(
            f"{type(thing).__name__} is no model: a path, (vertices, faces), an umbrage.Scene, or an object of trimesh, "
            "Open3D or PyVista is"
        )


def _some(values: Any) -> Any:
    """The array, or None where it is empty."""
    import numpy as np

    return None if values is None or len(values) == 0 else np.asarray(values)


def _screen_colors(values: Any) -> Any:
    """Floats that are shown as they are, which is sRGB, as integers, which are taken so."""
    import numpy as np

    array = _some(values)
    if array is None or array.dtype.kind != "f":
        return array
    return np.rint(np.clip(np.nan_to_num(array), 0, 1) * 65535).astype(np.uint16)


def _vtk_colors(surface: Any) -> Optional[NDArray[Any]]:
    """Colours of points, where they are 8-bit ones."""
    import numpy as np

    data = getattr(surface, "point_data", None)
    for values in [] if data is None else list(data.values()):
        array = np.asarray(values)
        if array.dtype == np.uint8 and array.ndim == 2 and array.shape[1] in (3, 4):
            return array
    return None
