"""Scene: meshes and clouds of points from files, arrays and objects of other libraries."""
from __future__ import annotations

import ctypes
import os
import threading
import warnings
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Optional, Sequence, Tuple, Type, Union

from . import _native as native
from ._arrays import _TYPES, as_array, image_of, texture_array
from ._errors import UmbrageWarning, UsageError
from ._foreign import is_model, meshes_of
from ._progress import Progress, Watch, check_progress
from ._suggest import shown, suggestion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._picture import Picture

SCENE_PARAMETERS = ("up", "crease_angle_deg", "point_size", "point_sprites", "scene_index")
_OF_MESHES = (
    "colors",
    "normals",
    "uv",
    "radii",
    "name",
    "albedo",
    "emission",
    "specular",
    "shininess",
    "texture",
    "emission_texture",
    "alpha_cutoff",
    "instances",
)


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
        """An empty scene, or one of a mesh: see add_mesh, which takes `colors`, `normals`, `uv` and more. Or
        `vertices` alone is a model: see add.

        `up`: which way is up in the world, "+Z" or three numbers; default +Y. Other parameters of
        umbrage.parameters("scene"), such as `crease_angle_deg`, hold for what is added afterwards.
        Errors: UsageError.
        """
        mesh = dict(parameters, faces=faces, colors=colors, normals=normals, uv=uv)
        known = ("vertices", "faces") + SCENE_PARAMETERS + _OF_MESHES
        for name in mesh:
            if name not in known:
                raise UsageError(f"a Scene has no argument '{name}'{suggestion(name, known)}")
        self._device = native.new_device("cpu", 1)  # computes nothing: errors and warnings are told to it
        self._handle = native.Handle(native.lib.umbNewScene(self._device.pointer), "Scene")
        self._lock = threading.Lock()
        self._readers = 0
        self._is_changing = False
        self._is_empty = True
        self.set("up", up)
        for name in SCENE_PARAMETERS:
            if mesh.get(name) is not None:
                self.set(name, mesh[name])
        given = {name: value for name, value in mesh.items() if value is not None and name not in SCENE_PARAMETERS}
        if isinstance(vertices, (str, os.PathLike)) or is_model(vertices):
            if given:
                raise UsageError(f"`{next(iter(given))}` goes with arrays: {shown(vertices)} is a whole model")
            self.add(vertices)
        elif vertices is not None:
            self.add_mesh(vertices, **given)
        elif given:
            raise UsageError(f"`{next(iter(given))}` goes with a mesh, which needs `vertices`")

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"], *more: Any, progress: Progress = None, **parameters: Any) -> Scene:
        """A scene of one model or several, as they stand in their files: OBJ, PLY, STL, glTF/GLB, ..., or a built-in
        one, "scene:NAME?detail=N". Keywords are those of umbrage.parameters("scene").

        Errors: UsageError; FileError; what `progress` raises.
        """
        scene = cls(**_of_scenes(parameters))
        for each in (path,) + more:
            scene.add(each, progress=progress)
        return scene

    @classmethod
    def of(cls, thing: Any, **parameters: Any) -> Scene:
        """A scene of whatever it is: see add."""
        return thing if isinstance(thing, Scene) and not parameters else cls(**_of_scenes(parameters)).add(thing)

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter of umbrage.parameters("scene"); None: as at first. Errors: UsageError."""
        if value is not None and not isinstance(value, str):
            array = as_array(value, name, "a string or numbers")
            if array.dtype.kind not in "iuf":
                raise UsageError(f"`{name}` takes a string or numbers, not {shown(value)}")
            flat = array.ravel().tolist()
            value = ",".join(format(v, ".9g") if isinstance(v, float) else str(v) for v in flat)
        text = None if value is None else native.bytes_of(value, name)
        with self._changing():
            self._handle.check(native.lib.umbSetSceneParameter(self._handle.pointer, native.bytes_of(name, "name"), text))

    def add(self, thing: Any, *, progress: Progress = None) -> Scene:
        """Adds a model and returns the scene. `thing`: a path; a pair (vertices, faces); a mesh, scene or cloud of
        trimesh, a mesh or cloud of Open3D, a surface, grid or cloud of PyVista, or an object that has the same
        attributes. Colours of vertices and faces come with it, and textures of trimesh and Open3D.

        Errors: UsageError; FileError; what `progress` raises.
        """
        check_progress(progress)
        if isinstance(thing, (str, os.PathLike)):
            with self._changing(), Watch(progress, is_before=True) as watch:
                self._load(native.bytes_of(os.fspath(thing), "path"), watch)
                self._is_empty = False
            return self
        if isinstance(thing, Scene):
            raise UsageError("a Scene cannot be added to another: add to both what they have in common")
        for mesh in list(meshes_of(thing)):  # all of them, or none
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
        emission_texture: Any = None,
        alpha_cutoff: Optional[float] = None,
        instances: Any = None,
    ) -> int:
        """Adds a mesh, or without `faces` a cloud of points, and returns its number. Everything is copied.

        vertices: (N, 3) scene units. faces: (M, 3) indices from 0, or (M, K) convex polygons. colors: (N, 3) or (N, 4),
        or one colour for all; uint8 and uint16 are sRGB, floats linear, 0 to 1. normals: (N, 3). uv: (N, 2), (0, 0) is
        the texture's lower left corner. radii: (N,) of points, scene units. albedo, emission: three linear numbers; default
        a grey of 0.8, or 1 beside colours or a texture, which it multiplies; and 0.
        specular: peak of the highlight, 0 to 1. shininess: Blinn-Phong exponent. texture, emission_texture: (H, W),
        (H, W, 3) or (H, W, 4) uint8, sRGB, or an image of Pillow, which multiply albedo and emission. alpha_cutoff:
        parts of the texture with less alpha are cut away. instances: (K, 3, 4) or (K, 4, 4), places of the mesh, world
        from mesh.
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
        for each, argument, values, sides in (
            ("normal", "normals", normals, (3,)),
            ("uv", "uv", uv, (2,)),
            ("radius", "radii", radii, (1,)),
        ):
            if values is not None:
                buffers.append((each, _rows(values, argument, sides, np.float32, count)))
        if colors is not None:
            buffers.append(("color", _colors(colors, count)))
        is_colored = colors is not None or texture is not None  # they multiply the albedo, which else is a grey of 0.8
        given = {
            "albedo": (1.0, 1.0, 1.0) if albedo is None and is_colored else albedo,
            "emission": emission,
            "specular": specular,
            "shininess": shininess,
            "alpha_cutoff": alpha_cutoff,
        }
        floats = {
            each: _floats(value, each, 3 if each in ("albedo", "emission") else 1)
            for each, value in given.items()
            if value is not None
        }
        named = native.bytes_of(name, "name")
        skins = [
            (of, texture_array(image, argument))
            for of, argument, image in (("albedo", "texture", texture), ("emission", "emission_texture", emission_texture))
            if image is not None
        ]
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
            for of, skin in skins:
                scene.check(lib.umbSetMeshTexture(scene.pointer, mesh, of.encode(), ctypes.byref(image_of(skin))))
            for k in range(0 if places is None else len(places)):
                data = places[k].ctypes.data_as(ctypes.POINTER(ctypes.c_float))
                scene.check(lib.umbAddMeshInstance(scene.pointer, mesh, data))
            self._is_empty = False
        return int(mesh)

    @property
    def bounds(self) -> NDArray[Any]:
        """The box that holds the scene: (2, 3) float32, lower and upper corner. Errors: UsageError for an empty one."""
        import numpy as np

        box = np.empty((2, 3), np.float32)
        corners = [corner.ctypes.data_as(ctypes.POINTER(ctypes.c_float)) for corner in box]
        with self.reading():
            self.check_filled()
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

    def close(self) -> None:
        """Frees what it holds, before Python would. Renderers of it end with it."""
        if self._handle.pointer is not None and not native.is_forked():
            with self._changing():
                self._handle.close()
                self._device.close()

    def __enter__(self) -> Scene:
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()

    def __reduce__(self) -> Any:
        raise TypeError("a Scene cannot be pickled or copied: make one in each process")

    def check_filled(self) -> None:
        """Errors: UsageError for an empty one."""
        if self._is_empty:
            raise UsageError("the scene is empty: `add` and `add_mesh` fill it")

    @property
    def handle(self) -> native.Handle:
        """The library's scene."""
        return self._handle

    @contextmanager
    def reading(self) -> Iterator[None]:
        """While it is used."""
        self.check_open()
        with self._lock:
            if self._is_changing:
                raise UsageError("the scene is being changed by another thread")
            self._readers += 1
        try:
            yield
        finally:
            with self._lock:
                self._readers -= 1

    def check_open(self) -> None:
        """Errors: UsageError once it is closed; DeviceError in a forked process."""
        native.check_process()
        if self._handle.pointer is None:
            raise UsageError("the Scene was closed")

    @contextmanager
    def _changing(self) -> Iterator[None]:
        self.check_open()
        with self._lock:
            if self._readers or self._is_changing:
                raise UsageError("the scene cannot be changed while it is rendered or changed by another thread")
            self._is_changing = True
        try:
            yield
        finally:
            with self._lock:
                self._is_changing = False


def _of_scenes(parameters: Dict[str, Any]) -> Dict[str, Any]:
    """Errors: UsageError for others."""
    for name in parameters:
        if name not in SCENE_PARAMETERS:
            raise UsageError(f"a scene has no parameter '{name}'{suggestion(name, SCENE_PARAMETERS)}")
    return parameters


def _floats(values: Any, name: str, count: Optional[int] = None) -> NDArray[Any]:
    """So many numbers. Errors: UsageError."""
    import numpy as np

    what = {None: "numbers", 1: "a number", 3: "three numbers"}[count]
    array = as_array(values, name, what).ravel()
    if array.dtype.kind not in "fiu" or (count is not None and array.size != count):
        raise UsageError(f"`{name}` takes {what}, not {shown(values)}")
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
