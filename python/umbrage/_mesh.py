"""Meshes and point clouds: converts the arguments of Scene.add_mesh to those of the library. All of them are checked
before a scene is changed."""
from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Sequence, Tuple

from . import _native as native
from ._arrays import _TYPES, as_array, image_of, texture_array
from ._errors import UmbrageError, UsageError
from ._suggest import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MAX_VERTICES = 2**31 - 1
VALUES = "values"  # name of values that are given as one array
_MATERIAL = ("albedo", "emission", "specular", "shininess", "alpha_cutoff")


@dataclass
class Mesh:
    """The data of a mesh, under the names that the library uses."""

    name: bytes
    vertex_count: int
    triangle_count: int
    buffers: List[Tuple[str, NDArray[Any]]]
    floats: Dict[str, NDArray[Any]]
    textures: List[Tuple[str, NDArray[Any]]]
    places: Sequence[NDArray[Any]]
    values: List[Tuple[bytes, bool, NDArray[Any]]]  # name, whether they are of triangles, and (N, components)


def mesh_of(vertices: Any, faces: Any = None, **given: Any) -> Mesh:
    """Converts and checks a mesh. Arguments and errors are those of Scene.add_mesh."""
    import numpy as np

    colors, uv, radii, texture = (given.get(each) for each in ("colors", "uv", "radii", "texture"))
    points = _rows(vertices, "vertices", (3,), np.float32)
    count = len(points)
    if not 0 < count <= _MAX_VERTICES:
        raise UsageError(f"`vertices` has {count} rows: it takes 1 to {_MAX_VERTICES}")
    if not np.isfinite(points).all():
        at = int(np.nonzero(~np.isfinite(points).all(axis=1))[0][0])
        raise UsageError(f"`vertices` holds a number that is not finite, in row {at}")
    buffers: List[Tuple[str, NDArray[Any]]] = [("position", points)]
    triangles = None if faces is None else _triangles(faces, count)
    if triangles is not None:
        buffers.append(("index", triangles))
    for each, argument, values, sides in (
        ("normal", "normals", given.get("normals"), (3,)),
        ("uv", "uv", uv, (2,)),
        ("radius", "radii", radii, (1,)),
    ):
        if values is not None:
            buffers.append((each, _rows(values, argument, sides, np.float32, count)))
    if radii is not None:
        _check_radii(buffers[-1][1], triangles is not None)
    if colors is not None:
        buffers.append(("color", _colors(colors, count)))
    is_colored = colors is not None or texture is not None  # they multiply the albedo; its default is a grey of 0.8
    if given.get("albedo") is None and is_colored:
        given["albedo"] = (1.0, 1.0, 1.0)
    floats = {each: _material(given[each], each) for each in _MATERIAL if given.get(each) is not None}
    textures = [
        (of, texture_array(given[argument], argument))
        for of, argument in (("albedo", "texture"), ("emission", "emission_texture"))
        if given.get(argument) is not None
    ]
    if textures and uv is None:
        raise UsageError(f"`{'emission_texture' if texture is None else 'texture'}` needs `uv`, the texture coordinates")
    places: Any = () if given.get("instances") is None else _places(given["instances"])
    named = native.bytes_of(given.get("name", ""), "name")
    values = [] if given.get("values") is None else _values(given["values"], count, faces, triangles)
    return Mesh(named, count, 0 if triangles is None else len(triangles), buffers, floats, textures, places, values)


def new_mesh(scene: native.Handle, mesh: Mesh) -> int:
    """Adds an empty mesh to the scene and returns its number."""
    number = int(native.lib.umbAddMesh(scene.pointer, mesh.name, mesh.vertex_count, mesh.triangle_count))
    if number < 0:
        scene.fail()
    return number


def fill_mesh(scene: native.Handle, number: int, mesh: Mesh) -> None:
    """Copies the data of the mesh to the scene."""
    lib = native.lib
    for each, array in mesh.buffers:
        kind, channels = _TYPES[array.dtype.name], array.shape[1]
        data = array.ctypes.data
        scene.check(
            lib.umbSetMeshBuffer(scene.pointer, number, each.encode(), data, kind, channels, array.strides[0])
        )
    for named, of_triangles, array in mesh.values:
        data, components = array.ctypes.data, array.shape[1]
        scene.check(
            lib.umbSetMeshValues(
                scene.pointer, number, named, of_triangles, data, _TYPES["float32"], components, array.strides[0]
            )
        )
    for each, numbers in mesh.floats.items():
        scene.check(lib.umbSetMeshFloats(scene.pointer, number, each.encode(), _pointer(numbers), len(numbers)))
    for of, skin in mesh.textures:
        scene.check(lib.umbSetMeshTexture(scene.pointer, number, of.encode(), ctypes.byref(image_of(skin))))
    for place in mesh.places:
        scene.check(lib.umbAddMeshInstance(scene.pointer, number, _pointer(place)))


def remove_mesh(scene: native.Handle, number: int) -> None:
    """Removes the mesh from the scene if the library has umbRemoveMesh."""
    if native.has("umbRemoveMesh"):
        try:
            scene.check(native.lib.umbRemoveMesh(scene.pointer, number))
        except UmbrageError:  # the first error is reported
            pass


def _pointer(floats: NDArray[Any]) -> Any:
    return floats.ctypes.data_as(ctypes.POINTER(ctypes.c_float))


def _check_radii(radii: NDArray[Any], has_faces: bool) -> None:
    """Checks the radii of points. Errors: UsageError."""
    import numpy as np

    if has_faces:
        raise UsageError("`radii` is for point clouds: the mesh has faces")
    wrong = np.nonzero(~((radii > 0) & np.isfinite(radii)).ravel())[0]
    if len(wrong):
        raise UsageError(f"`radii` holds {radii[wrong[0], 0]:g}, in row {wrong[0]}: it takes finite numbers above 0")


def _material(value: Any, name: str) -> NDArray[Any]:
    """Converts a material parameter. Errors: UsageError."""
    import numpy as np

    numbers = _floats(value, name, 3 if name in ("albedo", "emission") else 1)
    if not ((numbers >= 0) & np.isfinite(numbers)).all():
        raise UsageError(f"`{name}` cannot be {shown(value)}: it takes a finite number, 0 or more")
    return numbers


def _floats(values: Any, name: str, count: Optional[int] = None) -> NDArray[Any]:
    """Converts `count` numbers to float32. Errors: UsageError."""
    import numpy as np

    what = {None: "numbers", 1: "a number", 3: "three numbers"}[count]
    array = as_array(values, name, what).ravel()
    if array.dtype.kind not in "fiu" or (count is not None and array.size != count):
        raise UsageError(f"`{name}` takes {what}, not {shown(values)}")
    with np.errstate(over="ignore"):  # values that are too large become infinity
        return array.astype(np.float32)


def _rows(
    values: Any, name: str, sides: Tuple[int, ...], dtype: Any, count: Optional[int] = None
) -> NDArray[Any]:
    """Converts values of vertices to (count, side) with packed rows. Errors: UsageError."""
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
            raise UsageError(f"`{name}` has the dtype {array.dtype.name}: it takes numbers")
        array = array.astype(dtype, copy=False)
    is_row_packed = array.shape[1] == 1 or array.strides[1] == array.dtype.itemsize
    if array.dtype.isnative and is_row_packed and (array.strides[0] != 0 or len(array) < 2):
        return array
    return np.array(array, dtype=array.dtype.newbyteorder("="), order="C")


def _triangles(faces: Any, vertex_count: int) -> NDArray[Any]:
    """Converts faces to triangles: (M, 3) unsigned integers. Errors: UsageError."""
    import numpy as np

    array = as_array(faces, "faces")
    if array.size and array.dtype.kind not in "iu":
        raise UsageError(f"`faces` has the dtype {array.dtype.name}: it takes integers")
    if array.ndim == 1 and array.size:
        array = _padded_faces(array)
    if array.ndim != 2 or array.shape[1] < 3:
        raise UsageError(f"`faces` has the shape {array.shape}: it takes (M, 3), or (M, K) of polygons")
    if not len(array):
        raise UsageError("`faces` is empty: omit it for a point cloud")
    least, most = int(array.min()), int(array.max())
    if least < 0 or most >= vertex_count:
        at = int(np.nonzero((array < 0).any(axis=1) | (array >= vertex_count).any(axis=1))[0][0])
        raise UsageError(f"`faces` refers to vertices {array[at].tolist()} in row {at}: the mesh has {vertex_count}")
    if array.shape[1] > 3:
        fans = [array[:, (0, k, k + 1)] for k in range(1, array.shape[1] - 1)]
        array = np.stack(fans, axis=1).reshape(-1, 3)
    if array.dtype.kind == "i" or array.dtype.itemsize > 4:
        array = array.astype(np.uint32)
    return _rows(array, "faces", (3,), None)


def _padded_faces(array: NDArray[Any]) -> NDArray[Any]:
    """Converts faces in VTK's layout, where the number of corners precedes each face, to triangles."""
    import numpy as np

    corners = int(array[0])
    if corners >= 3 and array.size % (corners + 1) == 0 and (array[:: corners + 1] == corners).all():
        return array.reshape(-1, corners + 1)[:, 1:]
    triangles: List[List[int]] = []
    at, numbers = 0, array.tolist()
    while at < len(numbers):
        face = numbers[at + 1 : at + 1 + int(numbers[at])]
        if len(face) < 3:
            raise UsageError(f"`faces` holds a face of {len(face)} vertices, at index {at}: at least 3 are required")
        triangles += [[face[0], face[k], face[k + 1]] for k in range(1, len(face) - 1)]
        at += 1 + len(face)
    return np.array(triangles)


def _colors(colors: Any, count: int) -> NDArray[Any]:
    """Converts colours of vertices to (count, 3 or 4). Errors: UsageError."""
    import numpy as np

    array = as_array(colors, "colors")
    if array.ndim == 1 and array.size in (3, 4):
        array = np.broadcast_to(array, (count, array.size))
    if array.dtype.name not in ("uint8", "uint16"):
        if array.dtype.kind != "f":
            raise UsageError(f"`colors` has the dtype {array.dtype.name}: it takes floats from 0 to 1, uint8 or uint16")
        array = array.astype(np.float32, copy=False)
        if not np.isfinite(array).all():
            raise UsageError("`colors` holds a number that is not finite")
    return _rows(array, "colors", (3, 4), None, count)


def _values(values: Any, count: int, faces: Any, triangles: Any) -> List[Tuple[bytes, bool, NDArray[Any]]]:
    """Converts values of vertices or faces: an array, or a dict of arrays. Errors: UsageError."""
    import numpy as np

    made: List[Tuple[bytes, bool, NDArray[Any]]] = []
    for name, given in (values if isinstance(values, Mapping) else {VALUES: values}).items():
        array = as_array(given, "values")
        array = array[:, np.newaxis] if array.ndim == 1 else array
        per_face = _triangles_per_face(faces, triangles)
        if array.ndim != 2 or array.dtype.kind not in "fiub" or len(array) not in (count, len(per_face)):
            of = f"({count},) for vertices" + (f" or ({len(per_face)},) for faces" if len(per_face) else "")
            raise UsageError(f"`values` has the shape {array.shape} of {array.dtype.name}: it takes numbers, {of}")
        of_faces = len(array) != count
        array = np.ascontiguousarray(np.repeat(array, per_face, axis=0) if of_faces else array, np.float32)
        made.append((native.bytes_of(name, "values"), of_faces, array))
    return made


def _triangles_per_face(faces: Any, triangles: Any) -> NDArray[Any]:
    """Returns into how many triangles each face is split."""
    import numpy as np

    if triangles is None:
        return np.zeros(0, np.int64)
    array = as_array(faces, "faces")
    if array.ndim == 2:
        return np.full(len(array), array.shape[1] - 2)
    corners, at, numbers = [], 0, array.tolist()  # VTK's layout
    while at < len(numbers):
        corners.append(numbers[at])
        at += 1 + numbers[at]
    return np.array(corners) - 2


def _places(instances: Any) -> NDArray[Any]:
    import numpy as np

    array = as_array(instances, "instances")
    if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)):
        raise UsageError(f"`instances` has the shape {array.shape}: it takes (K, 3, 4) or (K, 4, 4)")
    if array.shape[1] == 4 and not (array[:, 3] == (0, 0, 0, 1)).all():
        raise UsageError("`instances` has matrices whose last row is not 0, 0, 0, 1: they map mesh space to world space, row by row")
    places = _floats(array[:, :3, :], "instances").reshape(-1, 12)
    if not np.isfinite(places).all():
        raise UsageError("`instances` holds a number that is not finite")
    return places
