"""Conversion of models of trimesh, Open3D and PyVista, recognized by their attributes. None of them is imported.

Texture coordinates: as in Umbrage, trimesh's v increases upwards in an image whose row 0 is the top row. The textures
of Open3D's TriangleMesh have their rows in reverse order; those of its tensor meshes do not.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Iterator, Optional

from ._arrays import as_array
from ._errors import UsageError
from ._suggest import shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

Mesh = Dict[str, Any]  # arguments of Scene.add_mesh

_CUTOFF = 0.5  # glTF's default for the alpha mode MASK


def _has(thing: Any, *names: str) -> bool:
    return all(hasattr(thing, name) for name in names)


def is_model(thing: Any) -> bool:
    """Returns whether `thing` is an object of another library rather than an array."""
    return not _has(thing, "__array_interface__") and (
        _has(thing, "geometry", "dump")
        or _has(thing, "vertex", "triangle")
        or _has(thing, "point", "to_legacy")
        or _has(thing, "vertices")
        or _has(thing, "points")
        or _has(thing, "n_blocks", "keys")
    )


def meshes_of(thing: Any, field: Optional[str] = None) -> Iterator[Mesh]:
    """Yields the arguments of add_mesh for each mesh or point cloud of `thing`, with the values of that name. Errors:
    UsageError."""
    if field is None or isinstance(thing, (tuple, list)) or _has(thing, "n_blocks", "keys"):
        yield from _meshes_of(thing, field)
        return
    if not _has(thing, "faces") and _has(thing, "extract_surface") and getattr(thing, "n_cells", None):
        thing = thing.extract_surface()
    values = _values_of(thing, field)
    if values is not None and getattr(getattr(thing, "visual", None), "kind", None) not in (None, "vertex"):
        thing = (thing.vertices, thing.faces)  # textures and colours of faces would split its vertices
    if values is not None and getattr(thing, "n_strips", 0):
        thing, values = thing.triangulate(), _values_of(thing.triangulate(), field)
    for made in _meshes_of(thing, None):
        yield made if values is None else dict(made, colors=None, values={field: values})


def active_values(thing: Any) -> Optional[str]:
    """Returns the name of the values that a model of PyVista shows, or of the first ones of a model of trimesh; None if
    it has none."""
    if isinstance(getattr(thing, "active_scalars_name", None), str):
        return str(thing.active_scalars_name)
    for where in ("vertex_attributes", "face_attributes"):
        for name in getattr(thing, where, None) or ():
            return str(name)
    return None


def _values_of(thing: Any, field: str) -> Any:
    """Returns the values of that name of vertices or faces: data of PyVista, attributes of trimesh, tensors of Open3D."""
    for where in ("point_data", "cell_data", "vertex_attributes", "face_attributes", "vertex", "point", "triangle"):
        data = getattr(thing, where, None)
        if data is not None and field in data:
            return _numbers(data[field], field)
    return None


def _meshes_of(thing: Any, field: Optional[str]) -> Iterator[Mesh]:
    kind = type(thing).__name__
    if isinstance(thing, (tuple, list)) and thing and all(is_model(each) for each in thing):
        for each in thing:
            yield from meshes_of(each, field)
    elif isinstance(thing, (tuple, list)) and len(thing) == 2:  # (vertices, faces)
        yield {"vertices": thing[0], "faces": thing[1]}
    elif not is_model(thing):
        raise UsageError(
            f"{shown(thing)} is not a model: use a path, (vertices, faces), an umbrage.Scene, or an object of trimesh, "
            "Open3D or PyVista"
        )
    elif _has(thing, "geometry", "dump"):  # trimesh.Scene: its meshes, transformed
        for mesh in thing.dump():
            if not _has(mesh, "entities"):  # paths have no surface
                yield from meshes_of(mesh, field)
    elif _has(thing, "n_blocks", "keys"):  # pyvista.MultiBlock
        for block in thing:
            if block is not None:
                yield from meshes_of(block, field)
    elif _has(thing, "vertex", "triangle"):  # open3d.t.geometry.TriangleMesh
        yield _tensor_mesh(thing)
    elif _has(thing, "point", "to_legacy"):  # open3d.t.geometry: PointCloud, LineSet
        if _has(thing, "line"):
            raise UsageError(f"a {kind} has lines but no surface")
        yield _with_colors(thing.point, {"vertices": _numbers(thing.point["positions"], "points")})
    elif _has(thing, "entities"):  # trimesh.path.Path3D
        raise UsageError(f"a {kind} has lines but no surface")
    elif _has(thing, "vertices", "faces"):  # trimesh.Trimesh; its `triangles` are positions of corners
        yield from _trimesh(thing)
    elif _has(thing, "vertices", "triangles"):  # open3d.geometry.TriangleMesh
        yield from _open3d(thing)
    elif _has(thing, "points", "faces"):  # pyvista.PolyData
        yield _polydata(thing)
    elif _has(thing, "points", "extract_surface") and getattr(thing, "n_cells", None):  # pyvista: all kinds of grids
        yield from meshes_of(thing.extract_surface())
    elif _has(thing, "points"):  # open3d.geometry.PointCloud, pyvista.PointSet
        for cells in ("cells", "polys", "lines"):
            if _has(thing, cells):
                raise UsageError(f"a {kind} has `{cells}`, which Umbrage does not support: give (points, triangles)")
        colors = _screen_colors(getattr(thing, "colors", None))
        if colors is None:
            colors = _vtk_colors(thing, "point_data", len(thing.points))
        yield {"vertices": thing.points, "colors": colors, "normals": _non_empty(getattr(thing, "normals", None))}
    elif _has(thing, "tetras"):  # open3d.geometry.TetraMesh
        raise UsageError(f"a {kind} has `tetras`, which Umbrage does not support: give (points, triangles)")
    else:  # trimesh.PointCloud
        colors = _non_empty(getattr(thing, "colors", None))
        yield {"vertices": thing.vertices, "colors": None if colors is None or colors.ndim != 2 else colors}


# ---- trimesh ----


def _trimesh(mesh: Any) -> Iterator[Mesh]:
    import numpy as np

    skin = getattr(mesh, "visual", None)
    kind = getattr(skin, "kind", None)
    vertices, faces = as_array(mesh.vertices, "vertices"), as_array(mesh.faces, "faces")
    made: Mesh = {"vertices": vertices, "faces": faces}
    if kind == "vertex" and skin is not None:
        yield dict(made, colors=skin.vertex_colors)
    elif kind == "face" and skin is not None:
        yield _split(made, face_colors=np.asarray(skin.face_colors))
    elif kind == "texture" and skin is not None:
        uv = _non_empty(getattr(skin, "uv", None))
        material = getattr(skin, "material", None)
        several = getattr(material, "materials", None)  # trimesh.visual.material.MultiMaterial
        of_faces = _non_empty(getattr(skin, "face_materials", None))
        if several and of_faces is not None:
            for index in np.unique(of_faces):
                yield dict(_part(made, of_faces == index, uv), **_material(several[int(index)], uv is not None))
        else:
            yield dict(made, uv=uv, **_material(several[0] if several else material, uv is not None))
    else:
        yield made


def _material(material: Any, has_uv: bool) -> Mesh:
    """Converts a SimpleMaterial or PBRMaterial of trimesh."""
    made: Mesh = {}
    if material is None:
        return made
    image = getattr(material, "image", None)
    if image is None:
        image = getattr(material, "baseColorTexture", None)
    if image is not None and has_uv:
        made["texture"] = image
    is_simple = hasattr(material, "diffuse")  # its default is grey, which is not a factor of an image
    factor = getattr(material, "diffuse" if is_simple else "baseColorFactor", None)
    if factor is not None and not (is_simple and "texture" in made):
        made["albedo"] = _factor(factor, is_screen=is_simple)
    glow = getattr(material, "emissiveFactor", None)
    glowing = getattr(material, "emissiveTexture", None)
    if glowing is not None and has_uv:
        made["emission_texture"] = glowing
        glow = (1.0, 1.0, 1.0) if glow is None else glow
    if glow is not None:
        made["emission"] = _factor(glow, is_screen=False)
    if getattr(material, "alphaMode", None) == "MASK":
        cutoff = getattr(material, "alphaCutoff", None)
        made["alpha_cutoff"] = _CUTOFF if cutoff is None else cutoff
    return made


def _factor(values: Any, is_screen: bool) -> NDArray[Any]:
    """Converts a colour factor to three linear numbers. `is_screen`: integers are sRGB."""
    import numpy as np

    array = np.asarray(values).ravel()[:3]
    if array.dtype.kind not in "iu":
        return array
    share = array / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4) if is_screen else share


# ---- Open3D ----


def _open3d(mesh: Any) -> Iterator[Mesh]:
    import numpy as np

    faces = np.asarray(mesh.triangles)
    made: Mesh = {
        "vertices": np.asarray(mesh.vertices),
        "faces": faces if len(faces) else None,
        "colors": _screen_colors(getattr(mesh, "vertex_colors", None)),
        "normals": _non_empty(getattr(mesh, "vertex_normals", None)),
    }
    uv = _non_empty(getattr(mesh, "triangle_uvs", None))
    images = [np.asarray(image) for image in getattr(mesh, "textures", None) or []]
    images = [image for image in images if image.size]
    if uv is None or not images or len(uv) != 3 * len(faces):
        yield made
        return
    of_faces = _non_empty(getattr(mesh, "triangle_material_ids", None))
    if len(images) == 1 or of_faces is None or len(of_faces) != len(faces):
        yield dict(_split(made, corner_uv=uv), texture=images[0][::-1])
        return
    for index in np.unique(of_faces):
        is_there = of_faces == index
        part = _split(dict(made, faces=faces[is_there]), corner_uv=uv.reshape(-1, 3, 2)[is_there].reshape(-1, 2))
        if 0 <= index < len(images):
            part["texture"] = images[int(index)][::-1]
        yield part


def _tensor_mesh(mesh: Any) -> Mesh:
    corners = mesh.triangle
    faces = _numbers(corners["indices"], "triangles") if "indices" in corners else None
    vertices = _numbers(mesh.vertex["positions"], "vertices")
    made = _with_colors(mesh.vertex, {"vertices": vertices, "faces": faces})
    images = getattr(getattr(mesh, "material", None), "texture_maps", None)
    if faces is None or images is None or "albedo" not in images or "texture_uvs" not in corners:
        return made
    image = images["albedo"]
    uv = _numbers(corners["texture_uvs"], "texture_uvs").reshape(-1, 2)
    pixels = _numbers(image.as_tensor() if hasattr(image, "as_tensor") else image, "texture")
    return dict(_split(made, corner_uv=uv), texture=pixels)


def _with_colors(attributes: Any, made: Mesh) -> Mesh:
    """Adds the colours and normals of an Open3D TensorMap."""
    if "colors" in attributes:
        made["colors"] = _screen_colors(_numbers(attributes["colors"], "colors"))
    if "normals" in attributes:
        made["normals"] = _numbers(attributes["normals"], "normals")
    return made


def _numbers(tensor: Any, name: str) -> NDArray[Any]:
    """Converts a tensor of Open3D on any device."""
    if hasattr(tensor, "cpu"):
        tensor = tensor.cpu()
    return as_array(tensor.numpy() if hasattr(tensor, "numpy") else tensor, name)


def _screen_colors(values: Any) -> Any:
    """Converts floats in sRGB to integers, which Umbrage reads as sRGB; Umbrage's floats are linear."""
    import numpy as np

    array = _non_empty(values)
    if array is None or array.dtype.kind != "f":
        return array
    return np.rint(np.clip(np.nan_to_num(array), 0, 1) * 65535).astype(np.uint16)


# ---- PyVista ----


def _polydata(surface: Any) -> Mesh:
    import numpy as np

    if getattr(surface, "n_strips", 0):
        surface = surface.triangulate()
    faces = np.asarray(surface.faces)
    if faces.size == 0 and np.size(getattr(surface, "lines", ())):
        raise UsageError(f"a {type(surface).__name__} has lines but no surface: pass the result of its `tube()`")
    points = surface.points
    made: Mesh = {"vertices": points, "colors": _vtk_colors(surface, "point_data", len(points))}
    if faces.size == 0:
        return made
    made["faces"] = faces
    if made["colors"] is not None or _vtk_colors(surface, "cell_data", surface.n_cells) is None:
        return made
    if not _is_regular(faces):
        surface = surface.triangulate()
        faces = np.asarray(surface.faces)
    made["faces"] = faces.reshape(-1, int(faces[0]) + 1)[:, 1:]
    of_faces = _vtk_colors(surface, "cell_data", len(made["faces"]))
    return made if of_faces is None else _split(made, face_colors=of_faces)


def _is_regular(padded: NDArray[Any]) -> bool:
    """Returns whether all faces have the same number of corners."""
    step = int(padded[0]) + 1
    return padded.size % step == 0 and bool((padded[::step] == padded[0]).all())


def _vtk_colors(surface: Any, where: str, count: int) -> Optional[NDArray[Any]]:
    """Returns the 8-bit colours of points or cells; those of the active scalars take precedence."""
    import numpy as np

    data = getattr(surface, where, None)
    if data is None:
        return None
    shown_first = getattr(surface, "active_scalars_name", None)
    names = sorted(data.keys(), key=lambda name: bool(name != shown_first))
    for name in names:
        array = np.asarray(data[name])
        if array.dtype == np.uint8 and array.ndim == 2 and array.shape[1] in (3, 4) and len(array) == count:
            return array
    return None


# ---- Common functions ----


def _non_empty(values: Any) -> Any:
    """Returns the array, or None if it is empty."""
    import numpy as np

    return None if values is None or len(values) == 0 else np.asarray(values)


def _split(mesh: Mesh, corner_uv: Any = None, face_colors: Any = None) -> Mesh:
    """Returns a mesh whose faces share no vertices, so that each corner has its own texture coordinates, or each face
    its own colour."""
    import numpy as np

    faces = np.asarray(mesh["faces"])
    made = dict(mesh)
    for name in ("vertices", "colors", "normals"):
        if mesh.get(name) is not None:
            made[name] = as_array(mesh[name], name)[faces.ravel()]
    if face_colors is not None:
        made["colors"] = np.repeat(face_colors, faces.shape[1], axis=0)
    made["faces"] = np.arange(faces.size).reshape(faces.shape)
    if corner_uv is not None:
        made["uv"] = corner_uv
    return made


def _part(mesh: Mesh, is_there: NDArray[Any], uv: Any) -> Mesh:
    """Returns some of the faces with their vertices."""
    import numpy as np

    faces = mesh["faces"][is_there]
    used, numbers = np.unique(faces, return_inverse=True)
    return {
        "vertices": mesh["vertices"][used],
        "faces": numbers.reshape(faces.shape),
        "uv": None if uv is None else uv[used],
    }
