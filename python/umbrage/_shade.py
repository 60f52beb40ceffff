"""The function shade and the class Shader, which shades several pictures."""
from __future__ import annotations

import math
from ctypes import byref
from typing import Any, List, Mapping, Optional, Sequence, Union

from . import _native as native
from ._arrays import image_array, image_of, share_memory
from ._errors import UsageError
from ._job import Job, requested_outputs
from ._lists import check_keywords
from ._picture import Picture
from ._progress import Progress, check_progress

_ARGUMENTS = ("depth", "normal", "albedo", "object_id", "images", "fov", "window", "orthographic", "depth_kind", "near",
              "far", "look", "effects", "passes", "quality", "settings", "dtype", "out", "device", "threads", "progress")
_OTHER_NAMES = {"near_plane": "near", "far_plane": "far"}


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
        orthographic: bool = False,
        depth_kind: str = "view",
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
        for name in parameters:
            if name in _OTHER_NAMES:
                raise UsageError(f"there is no parameter '{name}' (did you mean '{_OTHER_NAMES[name]}'?)")
        check_keywords(parameters, "shade", _ARGUMENTS)
        check_progress(progress)
        super().__init__(device, threads, None)
        if fov is not None and window is not None:
            raise UsageError("`fov` and `window` exclude each other: give one of them")
        if native.is_true(orthographic, "orthographic") and window is None:
            raise UsageError("an orthographic camera takes `window`: left, right, bottom and top, in scene units")
        self._fov = 40.0 if fov is None else native.number(fov, "fov")
        if not 0.0 < self._fov < 180.0:
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
            **parameters,
        )

    def shade(
        self,
        depth: Any,
        normal: Any = None,
        albedo: Any = None,
        *,
        object_id: Any = None,
        images: Optional[Mapping[str, Any]] = None,
        out: Any = None,
        progress: Progress = None,
    ) -> Picture:
        """Shades arrays: see umbrage.shade. Errors: UsageError, DeviceError, exceptions of `progress`; the outputs are
        then unchanged."""
        lib, job = native.lib, self._job
        check_progress(progress)
        inputs = native.mapping(images, "images", "a dict of arrays by name")
        if depth is None:
            raise UsageError("`depth` takes an array, not None")
        for name, values in (("depth", depth), ("normal", normal), ("albedo", albedo), ("object_id", object_id)):
            if values is not None:
                if name in inputs:
                    raise UsageError(f"there are two images '{name}': `images` has it, and the argument `{name}`")
                inputs[name] = values
        with self._exclusive():
            first = image_array(depth, "depth")
            height, width = first.shape[:2]
            arrays = {name: image_array(values, name, (height, width)) for name, values in inputs.items()}
            has_color = not self._effects or "output" in self._effects
            wanted = requested_outputs((width, height), self._dtype, self._passes, out, has_color)
            for output, memory in wanted.items():
                for name, array in arrays.items():
                    if memory is not None and memory.size and share_memory(memory, array):
                        raise UsageError(f"the output `{output}` and the input `{name}` share memory that is still read")
            if self._window is None and height > 0:
                top = math.tan(math.radians(self._fov) / 2)
                right = top * width / height
                self._set("window", (-right, right, -top, top))
            is_set: List[bytes] = []
            try:
                for name, array in arrays.items():
                    key = native.bytes_of(name, "images")
                    job.check(lib.umbSetJobImage(job.pointer, key, byref(image_of(array))))
                    is_set.append(key)
                return self._make((width, height), wanted, self._progress if progress is None else progress)
            finally:
                for key in is_set:
                    lib.umbSetJobImage(job.pointer, key, None)


def shade(
    depth: Any,
    normal: Any = None,
    albedo: Any = None,
    *,
    object_id: Any = None,
    images: Optional[Mapping[str, Any]] = None,
    fov: Optional[float] = None,
    window: Optional[Sequence[float]] = None,
    orthographic: bool = False,
    depth_kind: str = "view",
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

    depth: (H, W). `depth_kind`: "view": distance along the view axis, any unit; "ray": distance from the camera along
    the pixel's ray; "window": 0 at the plane `near`, 1 at `far`, as in a depth buffer; "reversed": the opposite. NaN
    and infinity, and for "view" and "ray" 0, 1e10, 65504 and the largest float, mean that there is no surface.
    normal: (H, W, 3), view space, +x right, +y up, +z towards the camera; default: computed from depth. The parameter
    `view_from_normal`, a 3 x 3 rotation, converts normals of another space.
    albedo: (H, W, 3), linear, 0 to 1, or one colour. Alpha, a fourth channel, is not read.
    object_id: (H, W) of integers. images: other planes by name, such as "emission", "direct" or "layer1.depth".
    Arrays: NumPy, torch (CPU), or any object with the buffer protocol, `__array_interface__` or DLPack; float32,
    float16, uint8 or uint16, whose 255 and 65535 mean 1. Arrays of these types are not copied, whatever their strides
    are.
    fov: vertical field of view, degrees; default: 40. window: used instead of `fov`: (left, right, bottom, top) at
    distance 1, or in scene units for `orthographic`.
    look: a name of umbrage.looks(); default: "studio". effects: effects that run, in this order, instead of the look.
    passes: passes to return besides the picture. If empty and `effects` is set: the passes that the last effect makes.
    out: an array (H, W, 4 or 3) for the picture, or a dict of arrays by pass, which are written.
    Other arguments and errors are those of render. Other keywords are names of umbrage.parameters("shade").
    """
    with Shader(
        fov=fov,
        window=window,
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
        return shader.shade(depth, normal, albedo, object_id=object_id, images=images, out=out)
