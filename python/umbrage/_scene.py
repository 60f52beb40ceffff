"""Scene: meshes and point clouds from files, arrays and objects of other libraries."""
from __future__ import annotations

import ctypes
import os
import threading
import warnings
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Optional, Sequence, Type, Union

from . import _native as native
from ._arrays import as_array
from ._errors import UmbrageWarning, UsageError
from ._foreign import is_model, meshes_of
from ._lists import keywords_of, known_parameters
from ._mesh import Mesh, fill_mesh, mesh_of, new_mesh, remove_mesh
from ._progress import Progress, Watch, check_progress
from ._suggest import shown, suggestion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._picture import Picture


def issue_warnings(texts: List[bytes], depth: int = 4) -> None:
    """Issues the library's warnings as Python warnings."""
    while texts:
        warnings.warn(native.text_of(texts.pop(0)), UmbrageWarning, stacklevel=depth)


def _are_paths(thing: Any) -> bool:
    return isinstance(thing, (list, tuple)) and bool(thing) and all(isinstance(each, (str, os.PathLike)) for each in thing)


class Scene:
    """Meshes and points, with colours and materials. World space, right-handed; any unit.

    ::

        scene = umbrage.Scene(vertices, faces, colors=colors)     # from arrays
        scene = umbrage.Scene.load("bunny.obj")                   # from a file
        scene = umbrage.Scene.of(trimesh.load("bunny.obj"))       # from another library
        scene.render(size=(800, 600), look="studio").save("bunny.png")

    Different threads may render one scene at the same time; changing it at that time is a UsageError.
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
        """Creates an empty scene, or a scene of one mesh: see add_mesh for `colors`, `normals`, `uv` and more
        arguments. `vertices` alone may be a model: see add.

        `up`: up direction of the world, "+Z" or three numbers; default: +Y. Other parameters of
        umbrage.parameters("scene"), such as `crease_angle_deg`, apply to models and meshes that are added afterwards.
        Errors: UsageError.
        """
        mesh = dict(parameters, faces=faces, colors=colors, normals=normals, uv=uv)
        of_scene = known_parameters("scene")
        known = ("vertices", "faces", "up", *of_scene, *keywords_of(self.add_mesh))
        for name in mesh:
            if name not in known:
                raise UsageError(f"a Scene has no argument '{name}'{suggestion(name, known)}")
        self._device = native.new_device("cpu", 1)  # for errors and warnings only; computes nothing
        self._handle = native.Handle(native.lib.umbNewScene(self._device.pointer), "Scene")
        self._lock = threading.Lock()
        self._readers = 0
        self._is_changing = False
        self._is_empty = True
        self._field: Optional[str] = None  # of values that are taken over from models
        self.set("up", up)
        for name in of_scene:
            if mesh.get(name) is not None:
                self.set(name, mesh[name])
        given = {name: value for name, value in mesh.items() if value is not None and name not in of_scene}
        if isinstance(vertices, (str, os.PathLike)) or is_model(vertices):
            if given:
                raise UsageError(f"`{next(iter(given))}` is for arrays: {shown(vertices)} is a complete model")
            self.add(vertices)
        elif vertices is not None:
            self.add_mesh(vertices, **given)
        elif given:
            raise UsageError(f"`{next(iter(given))}` is for a mesh, which needs `vertices`")

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"], *more: Any, progress: Progress = None, **parameters: Any) -> Scene:
        """Loads one or several models, placed as in their files: OBJ, PLY, STL, glTF/GLB, ..., or the built-in
        "scene:NAME?detail=N". Keywords are those of umbrage.parameters("scene").

        Errors: UsageError; FileError; exceptions of `progress`.
        """
        scene = cls(**_of_scenes(parameters))
        for each in (path,) + more:
            scene.add(each, progress=progress)
        return scene

    @classmethod
    def of(cls, thing: Any, **parameters: Any) -> Scene:
        """Creates a scene of a model, as for add, or of several paths."""
        if _are_paths(thing):
            return cls.load(*thing, **_of_scenes(parameters))
        return thing if isinstance(thing, Scene) and not parameters else cls(**_of_scenes(parameters)).add(thing)

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter of umbrage.parameters("scene"); None restores the default. Errors: UsageError."""
        if value is not None and not isinstance(value, str):
            array = as_array(value, name, "a string or numbers")
            if array.dtype.kind not in "iuf" or array.size == 0:
                raise UsageError(f"`{name}` takes a string or numbers, not {shown(value)}")
            flat = array.ravel().tolist()
            value = ",".join(format(v, ".9g") if isinstance(v, float) else str(v) for v in flat)
        text = None if value is None else native.bytes_of(value, name)
        if name == "color_by":
            self._field = value
        with self._changing():
            self._handle.check(native.lib.umbSetSceneParameter(self._handle.pointer, native.bytes_of(name, "name"), text))

    def add(self, thing: Any, *, progress: Progress = None) -> Scene:
        """Adds a model and returns the scene. `thing`: a path; a pair (vertices, faces); a mesh, scene or point cloud
        of trimesh; a mesh or point cloud of Open3D; a surface, grid or point cloud of PyVista; or an object with the
        same attributes. Colours of vertices and faces are taken over, and so are textures of trimesh and Open3D, and the
        values whose name is the parameter `color_by` of the scene.

        Errors: UsageError; FileError; exceptions of `progress`. The scene is then unchanged.
        """
        check_progress(progress)
        if isinstance(thing, (str, os.PathLike)):
            with self._changing(), Watch(progress, is_before=True) as watch:
                self._load(native.bytes_of(os.fspath(thing), "path"), watch)
                self._is_empty = False
            return self
        if _are_paths(thing):
            raise UsageError("Scene.add takes one model: call it once for each, or use Scene.load")
        if isinstance(thing, Scene):
            raise UsageError("a Scene cannot be added to another Scene: add its models instead")
        self._put([mesh_of(**mesh) for mesh in meshes_of(thing, self._field)])  # all or none
        return self

    def _load(self, model: bytes, watch: Watch) -> None:
        lib, handle = native.lib, self._handle
        messages: List[bytes] = []
        try:
            lib.umbSetDeviceLogCallback(self._device.pointer, native.append_to_list, messages)
            lib.umbSetSceneProgressCallback(handle.pointer, native.send_to_generator, watch.generator)
            handle.check(lib.umbLoadModel(handle.pointer, model))
        finally:
            lib.umbSetSceneProgressCallback(handle.pointer, native.no_progress, None)
            lib.umbSetDeviceLogCallback(self._device.pointer, native.no_log, None)
            issue_warnings(messages)

    def add_mesh(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        colors: Any = None,
        normals: Any = None,
        uv: Any = None,
        radii: Any = None,
        values: Any = None,
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
        """Adds a mesh, or, without `faces`, a point cloud. Returns its number. All data are copied.

        vertices: (N, 3), scene units. faces: (M, 3) indices from 0, or (M, K) convex polygons.
        colors: (N, 3) or (N, 4), or one colour for all vertices; uint8 and uint16 are sRGB, floats linear, 0 to 1.
        normals: (N, 3). uv: (N, 2), (0, 0) is the texture's lower left corner. radii: (N,), of points, scene units, >
        0.
        values: numbers such as a pressure, which render(color_by=NAME) shows as colours: a dict of arrays by name, or one
        array, whose name is "values". (N,) or (N, components) of vertices or (M,) or (M, components) of faces; NaN: none.
        albedo, emission: three linear numbers. Colours and textures multiply the albedo, whose default is 0.8, or 1 if
        there are colours or a texture. The default emission is 0.
        specular: peak of the highlight, 0 to 1. shininess: Blinn-Phong exponent.
        texture, emission_texture: factors of albedo and emission; (H, W), (H, W, 3) or (H, W, 4) uint8, sRGB, or an
        image of Pillow. alpha_cutoff: parts of the texture with a smaller alpha are cut out.
        instances: (K, 3, 4) or (K, 4, 4), matrices from mesh space to world space.
        Errors: UsageError, also for numbers that are not finite and indices beyond the vertices. The scene is then
        unchanged.
        """
        mesh = mesh_of(
            vertices,
            faces,
            colors=colors,
            normals=normals,
            uv=uv,
            radii=radii,
            values=values,
            name=name,
            albedo=albedo,
            emission=emission,
            specular=specular,
            shininess=shininess,
            texture=texture,
            emission_texture=emission_texture,
            alpha_cutoff=alpha_cutoff,
            instances=instances,
        )
        return self._put([mesh])[0]

    def _put(self, meshes: Sequence[Mesh]) -> List[int]:
        """Adds all meshes, or none. Returns their numbers."""
        numbers: List[int] = []
        with self._changing():
            try:
                for mesh in meshes:
                    numbers.append(new_mesh(self._handle, mesh))
                    fill_mesh(self._handle, numbers[-1], mesh)
            except BaseException:  # such as too little memory
                for number in numbers:
                    remove_mesh(self._handle, number)
                raise
            self._is_empty = self._is_empty and not meshes
        return numbers

    @property
    def bounds(self) -> NDArray[Any]:
        """Axis-aligned bounding box of the scene: (2, 3) float64, lower and upper corner, in the coordinates of
        the files. Errors: UsageError if
        empty."""
        import numpy as np

        box = np.empty((2, 3), np.float64)
        corners = [corner.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for corner in box]
        with self.reading():
            self.check_filled()
            self._handle.check(native.lib.umbGetSceneBounds(self._handle.pointer, *corners))
        return box

    @property
    def camera_count(self) -> int:
        """Number of cameras that camera={"index": N} can select; the first one is 0."""
        with self.reading():
            return int(native.lib.umbGetSceneCameraCount(self._handle.pointer))

    def render(self, **arguments: Any) -> Picture:
        """Renders the scene. Keywords are those of umbrage.render."""
        from ._render import render

        return render(self, **arguments)

    def close(self) -> None:
        """Frees the scene now. Renderers of the scene cannot be used afterwards."""
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
        """Errors: UsageError for an empty scene."""
        if self._is_empty:
            raise UsageError("the scene is empty: `add` or `add_mesh` must be called first")

    @property
    def handle(self) -> native.Handle:
        """The library's scene."""
        return self._handle

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Prevents changes of the scene while a caller uses it. Errors: UsageError while the scene is being changed."""
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
        """Errors: UsageError if the scene was closed; DeviceError in a forked process."""
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
    """Checks that all names are parameters of a scene. Errors: UsageError."""
    for name in parameters:
        if name not in known_parameters("scene"):
            raise UsageError(f"a scene has no parameter '{name}'{suggestion(name, known_parameters('scene'))}")
    return parameters
