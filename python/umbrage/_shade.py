"""The function shade and the class Shader, which shades several pictures."""
from __future__ import annotations

import math
import os
from ctypes import byref
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from . import _native as native
from ._arrays import array_file, as_array, image_array, image_of, masked, share_memory, type_number
from ._errors import UsageError
from ._job import Job, checked_dtype, requested_outputs
from ._lists import check_keywords, keywords_of
from ._native import KEYWORDS
from ._picture import Picture
from ._progress import Progress, check_progress
from ._suggest import shown

# The parameter of the library for each input that can be a file.
_FILE_PARAMETERS = {keyword: name for name, keyword in KEYWORDS.items() if name.endswith("_file")}
Path = Union[str, "os.PathLike[str]"]


class FileInfo(NamedTuple):
    """What is known about the files of a G-buffer."""

    facts: Tuple[str, ...]
    """What was recognised and how, one line each; empty if the files hold no G-buffer."""
    layers: Tuple[str, ...]
    """Every layer with its channels, such as "ViewLayer.Depth (Z)"."""


def _is_path(value: Any) -> bool:
    return isinstance(value, (str, bytes, os.PathLike))


def _inputs(
    source: Any, given: Mapping[str, Any], images: Optional[Mapping[str, Any]]
) -> Tuple[Dict[str, Any], Dict[str, Any]]:
    """Returns the files, by parameter of the library, and the arrays, by name. Errors: UsageError."""
    arrays = native.mapping(images, "images", "a dict of arrays by name")
    inputs = {name: value for name, value in given.items() if value is not None}
    files = {}
    if _is_path(source):
        files["file"] = os.fsdecode(source)
    elif source is not None:
        if "depth" in inputs:
            raise UsageError("there are two images 'depth': the first argument, and the argument `depth`")
        inputs["depth"] = source
    for name, value in inputs.items():
        if name in arrays:
            raise UsageError(f"there are two images '{name}': `images` has it, and the argument `{name}`")
        if _is_path(value):
            files[_FILE_PARAMETERS[name]] = os.fsdecode(value)
        else:
            arrays[name] = value
    if files and arrays:
        array, file = next(iter(arrays)), next(iter(files))
        name = next((name for name, parameter in _FILE_PARAMETERS.items() if parameter == file), None)
        raise UsageError(
            f"`{array}` is an array and {f'`{name}`' if name else 'the first argument'} a path: give files for all, or "
            "arrays for all"
        )
    if not files and "depth" not in arrays and "position" not in arrays:
        raise UsageError("`depth` takes an array or a path, not None; `position` (height, width, 3) gives a depth, too")
    return files, arrays


def _focal_lengths(intrinsics: Any) -> Tuple[float, ...]:
    """Returns fx, fy, cx, cy of a matrix of intrinsics. Errors: UsageError."""
    matrix = as_array(intrinsics, "intrinsics", "a 3 x 3 matrix")
    if matrix.shape[-2:] not in ((3, 3), (4, 4)) or matrix.size not in (9, 16):
        raise UsageError(f"`intrinsics` has the shape {matrix.shape}: it takes a 3 x 3 matrix")
    matrix = matrix.reshape(matrix.shape[-2:])
    numbers = tuple(float(matrix[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2)))
    if not all(0.0 < number < math.inf for number in numbers):
        other = "; a projection matrix of OpenGL is another one: give `fov` or `window`" if len(matrix) == 4 else ""
        raise UsageError(
            "`intrinsics` has fx {:g}, fy {:g}, cx {:g} and cy {:g}: it takes [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], all above "
            "0{}".format(*numbers, other)
        )
    return numbers


class Shader(Job):
    """Shades any number of G-buffers on one device. Memory is reused.

    ::

        shader = umbrage.Shader(fov=60, look="studio")
        for depth in frames:
            show(shader.shade(depth).picture)

    `shade` may be called any number of times, with arrays of any size. Memory is reused, and after an error further
    calls are allowed. A returned picture is not changed by later calls. One thread at a time uses the shader; others
    wait.
    """

    _kind = "Shader"

    def __init__(
        self,
        *,
        fov: Optional[float] = None,
        window: Optional[Sequence[float]] = None,
        intrinsics: Any = None,
        orthographic: bool = False,
        depth_kind: str = "auto",
        near: Optional[float] = None,
        far: Optional[float] = None,
        look: Optional[str] = None,
        effects: Union[None, str, Sequence[str]] = None,
        passes: Union[str, Sequence[str]] = (),
        quality: Optional[str] = None,
        settings: Optional[Mapping[str, Any]] = None,
        dtype: Any = "uint8",
        device: str = "auto",
        threads: int = 0,
        progress: Progress = None,
        **parameters: Any,
    ) -> None:
        """Arguments and errors are those of umbrage.shade."""
        if "file" in parameters:
            raise UsageError("`file` cannot be set: it is the first argument of shade")
        for name in parameters:
            if name in KEYWORDS and name not in ("width", "height"):
                raise UsageError(f"there is no parameter '{name}' (did you mean '{KEYWORDS[name]}'?)")
        check_keywords(parameters, "shade", keywords_of(shade))
        check_progress(progress)
        super().__init__(device, threads, None)
        if fov is not None and window is not None:
            raise UsageError("`fov` and `window` exclude each other: give one of them")
        focal = _focal_lengths(intrinsics) if intrinsics is not None else parameters.pop("focal_length_px", None)
        if "focal_length_px" in parameters:
            raise UsageError("`intrinsics` and `focal_length_px` exclude each other: give one of them")
        if focal is not None and (fov is not None or window is not None):
            name = "focal_length_px" if intrinsics is None else "intrinsics"
            raise UsageError(f"`{name}` excludes `fov` and `window`: give one of them")
        if native.is_true(orthographic, "orthographic") and window is None:
            raise UsageError("an orthographic camera takes `window`: left, right, bottom and top, in scene units")
        self._fov = None if fov is None else native.number(fov, "fov")
        if self._fov is not None and not 0.0 < self._fov < 180.0:
            raise UsageError(f"`fov` cannot be {self._fov:g}: it takes degrees, above 0 and below 180")
        self._window = window
        self._effects = native.words(effects, "effects")
        self._passes, self._dtype, self._progress = passes, dtype, progress
        if near is not None and not math.isfinite(native.number(near, "near")):
            raise UsageError(f"`near` cannot be {near}: it takes a finite distance")
        far = None if far is None or native.number(far, "far") == math.inf else far
        self._set_all(
            settings,
            look=look,
            quality=quality,
            effects=self._effects or None,
            depth_kind=depth_kind,
            near_plane=near,
            far_plane=far,
            orthographic=orthographic,
            window=window,
            focal_length_px=focal,
            **parameters,
        )

    def shade(
        self,
        source: Any = None,
        /,
        normal: Any = None,
        albedo: Any = None,
        *,
        depth: Any = None,
        beauty: Any = None,
        position: Any = None,
        object_id: Any = None,
        mask: Any = None,
        images: Optional[Mapping[str, Any]] = None,
        out: Any = None,
        progress: Progress = None,
    ) -> Picture:
        """Shades arrays or files: see umbrage.shade. Errors: UsageError, FileError, DeviceError, exceptions of
        `progress`; the outputs are then unchanged."""
        check_progress(progress)
        given = dict(depth=depth, normal=normal, albedo=albedo, beauty=beauty, position=position, object_id=object_id)
        files, inputs = _inputs(source, given, images)
        with self._exclusive():
            progress = self._progress if progress is None else progress
            if files and mask is not None:
                raise UsageError("`mask` is an array: give arrays for all; a file has its own, as the array 'mask' of an NPZ")
            if "position" in inputs:
                with array_file(inputs, mask) as file:
                    return self._shade_files({"file": file}, out, progress)
            return self._shade_files(files, out, progress) if files else self._shade_arrays(inputs, mask, out, progress)

    @property
    def _has_color(self) -> bool:
        return not self._effects or "output" in self._effects

    def _shade_files(self, files: Mapping[str, Any], out: Any, progress: Progress) -> Picture:
        if not native.has("umbGetJobFact"):
            raise UsageError("the library of Umbrage is too old to shade files: install the version of this package")
        color_type = type_number(checked_dtype(self._dtype))
        wanted = requested_outputs((0, 0), self._dtype, self._passes, out, self._has_color)
        color = wanted.get("color")
        if color is not None and color.size == 0:
            wanted["color"] = None  # the library allocates it, since the size of the files is not known yet
        try:
            self._set_all(None, **files)
            self._set("window", self._window)
            self._set("fov_deg", self._fov)
            return self._make((0, 0), wanted, progress, color_type)
        finally:
            for name in (*files, "fov_deg"):
                self._set(name, None)

    def _shade_arrays(self, inputs: Mapping[str, Any], mask: Any, out: Any, progress: Progress) -> Picture:
        lib, job = native.lib, self._job
        first = image_array(inputs["depth"], "depth")
        height, width = first.shape[:2]
        arrays = {name: image_array(values, name, (height, width)) for name, values in inputs.items()}
        if mask is not None:
            arrays["depth"] = masked(arrays["depth"], mask)
        wanted = requested_outputs((width, height), self._dtype, self._passes, out, self._has_color)
        for output, memory in wanted.items():
            for name, array in arrays.items():
                if memory is not None and memory.size and share_memory(memory, array):
                    raise UsageError(f"the output `{output}` and the input `{name}` share memory that is still read")
        if self._window is None and height > 0:
            top = math.tan(math.radians(self._fov or 0.0) / 2)
            right = top * width / height
            self._set("window", (-right, right, -top, top) if self._fov else None)
        is_set: List[bytes] = []
        try:
            for name, array in arrays.items():
                key = native.bytes_of(name, "images")
                job.check(lib.umbSetJobImage(job.pointer, key, byref(image_of(array))))
                is_set.append(key)
            return self._make((width, height), wanted, progress)
        finally:
            for key in is_set:
                lib.umbSetJobImage(job.pointer, key, None)

    def info(
        self,
        source: Optional[Path] = None,
        /,
        *,
        depth: Optional[Path] = None,
        normal: Optional[Path] = None,
        albedo: Optional[Path] = None,
        beauty: Optional[Path] = None,
        position: Optional[Path] = None,
        object_id: Optional[Path] = None,
    ) -> FileInfo:
        """Returns what is known about files, with the parameters of this object: see umbrage.info."""
        given = dict(depth=depth, normal=normal, albedo=albedo, beauty=beauty, position=position, object_id=object_id)
        for name, value in {"the first argument": source, **given}.items():
            if value is not None and not _is_path(value):
                raise UsageError(f"`{name}` takes a path, not {shown(value)}")
        files, _ = _inputs(source, given, None)
        lib, job = native.lib, self._job
        with self._exclusive():
            try:
                self._set_all(None, **files)
                self._call(lib.umbPrepareJob, None)
                facts, layers = (
                    tuple(native.names_of(each, job.pointer)) for each in (lib.umbGetJobFact, lib.umbGetJobFileLayer)
                )
                return FileInfo(facts, layers)
            finally:
                for name in files:
                    self._set(name, None)


def shade(
    source: Any = None,
    /,
    normal: Any = None,
    albedo: Any = None,
    *,
    depth: Any = None,
    beauty: Any = None,
    position: Any = None,
    object_id: Any = None,
    mask: Any = None,
    images: Optional[Mapping[str, Any]] = None,
    fov: Optional[float] = None,
    window: Optional[Sequence[float]] = None,
    intrinsics: Any = None,
    orthographic: bool = False,
    depth_kind: str = "auto",
    near: Optional[float] = None,
    far: Optional[float] = None,
    look: Optional[str] = None,
    effects: Union[None, str, Sequence[str]] = None,
    passes: Union[str, Sequence[str]] = (),
    quality: Optional[str] = None,
    settings: Optional[Mapping[str, Any]] = None,
    dtype: Any = "uint8",
    out: Any = None,
    device: str = "auto",
    threads: int = 0,
    progress: Progress = None,
    **parameters: Any,
) -> Picture:
    """Shades the G-buffer of another renderer.

    ::

        picture = umbrage.shade(depth, fov=60).picture                                  # the look "studio"
        ao = umbrage.shade(depth, normal, effects=("bitmask", "denoise"), passes="ao")["ao"]
        umbrage.shade("render.exr").save("shaded.png")                                  # as `umbrage shade` does
        umbrage.shade(depth="depth.tif", normal="passes.exr:N", fov=40)

    source: the depth, or the path of a file whose layers are recognised. The inputs depth, normal, albedo, beauty,
    position and object_id are arrays, or paths, which may end in ":" and the name of a layer. `facts` of the returned
    picture says how files were understood.
    depth: (H, W). `depth_kind`: "planar": distance along the view axis, any unit; "distance": from the camera along
    the pixel's ray; "window": 0 at the plane `near`, 1 at `far`, as in a depth buffer; "reversed": the opposite. NaN
    and infinity, and for "planar" and "distance" 0, 1e10, 65504 and the largest float, mean that there is no surface.
    normal: (H, W, 3), view space, +x right, +y up, +z towards the camera; default: computed from depth. The parameter
    `view_from_normal`, a 3 x 3 rotation, converts normals of another space; a warning states it if it can be found.
    `normal_encoding`: "signed", or "unsigned" for components from 0 to 1, 255 or 65535; "auto": unsigned ones are
    recognised by their lengths, and decoded with a warning.
    albedo: (H, W, 3), linear, 0 to 1 (a warning says if it is above), or one colour. Alpha, a fourth channel, is not
    read.
    position: (H, W, 3), such as a point map, in the space of any camera: gives depth and camera, so that no depth is
    needed. The arrays are then understood as those of a file.
    object_id: (H, W) of integers. mask: (H, W), 0 where there is no surface. images: other planes by name, such as "emission", "direct" or "layer1.depth".
    Arrays: NumPy, torch (CPU), or any object with the buffer protocol, `__array_interface__` or DLPack; float32,
    float16, uint8 or uint16, whose 255 and 65535 mean 1. Arrays of these types are not copied, whatever their strides
    are.
    fov: vertical field of view, degrees; default: 55; of files: as the file says, else fitted, else 55.
    intrinsics: used instead of `fov`: the 3 x 3 matrix of a pinhole camera, in pixels of these arrays (a warning says
    if its centre is far from their middle), or in widths and heights of the picture; or `focal_length_px`, one number
    or (fx, fy, cx, cy).
    window: used instead of `fov`: (left, right, bottom, top) at distance 1, or in scene units for `orthographic`.
    look: a name of umbrage.looks(); default: "studio", and "comp" for files with a beauty. effects: effects that run,
    in this order, instead of the look.
    passes: passes to return besides the picture. If empty and `effects` is set: the passes that the last effect makes.
    out: an array (H, W, 4 or 3) for the picture, or a dict of arrays by pass, which are written.
    Other arguments and errors are those of render. Other keywords are names of umbrage.parameters("shade").
    """
    with Shader(
        fov=fov,
        window=window,
        intrinsics=intrinsics,
        orthographic=orthographic,
        depth_kind=depth_kind,
        near=near,
        far=far,
        look=look,
        effects=effects,
        passes=passes,
        quality=quality,
        settings=settings,
        dtype=dtype,
        device=device,
        threads=threads,
        progress=progress,
        **parameters,
    ) as shader:
        return shader.shade(
            source,
            normal,
            albedo,
            depth=depth,
            beauty=beauty,
            position=position,
            object_id=object_id,
            mask=mask,
            images=images,
            out=out,
        )


def info(
    source: Optional[Path] = None,
    /,
    *,
    depth: Optional[Path] = None,
    normal: Optional[Path] = None,
    albedo: Optional[Path] = None,
    beauty: Optional[Path] = None,
    position: Optional[Path] = None,
    object_id: Optional[Path] = None,
    **parameters: Any,
) -> FileInfo:
    """Returns what umbrage.shade would read from files, as `umbrage info` does.

    ::

        for line in umbrage.info("render.exr").facts:
            print(line)

    Also for files that hold no G-buffer. Arguments are those of shade. Errors: UsageError; FileError.
    """
    with Shader(device="cpu", **parameters) as shader:
        return shader.info(
            source,
            depth=depth,
            normal=normal,
            albedo=albedo,
            beauty=beauty,
            position=position,
            object_id=object_id,
        )
