"""Base of Renderer and Shader: a device and a job of the library, parameters, and outputs."""
from __future__ import annotations

import os
import threading
from contextlib import contextmanager
from ctypes import byref, c_double
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Type, TypeVar, Union

from . import _native as native
from ._arrays import copied_image, image_of, is_id, output_array
from ._errors import UsageError
from ._lists import known_parameters
from ._picture import Picture, strokes_of
from ._progress import Progress, Watch, check_progress
from ._scene import Scene, issue_warnings
from ._suggest import shown, suggestion

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_COUNTERS = ("hierarchies_built", "captures_made", "planes_copied")
_DTYPES = ("uint8", "uint16", "float16", "float32")
# Channels of passes, recorded when a pass is first made. Later the library writes directly to arrays of this package.
channels_of_passes: Dict[str, int] = {}
_Self = TypeVar("_Self", bound="Job")


@dataclass(frozen=True)
class Camera:
    """A camera. Members that are None are chosen automatically: the model's own view, or else a view of the whole model
    from slightly above and to the side. World space, scene units, degrees. A dict of these names can be used
    instead."""

    position: Optional[Sequence[float]] = None
    """Camera position."""
    focal_point: Optional[Sequence[float]] = None
    """Point that the camera looks at."""
    view_up: Optional[Sequence[float]] = None
    """Direction that points up in the picture."""
    direction: Optional[Sequence[float]] = None
    """View direction; not with both position and focal_point."""
    view_angle_deg: Optional[float] = None
    """Vertical field of view, 0.1 to 179."""
    azimuth_deg: Optional[float] = None
    """Rotation around the model, applied last."""
    elevation_deg: Optional[float] = None
    """Elevation above the model, applied last."""
    orbit: Optional[bool] = None
    """Azimuth and elevation move the camera at one distance, as a turntable does: the default of a Renderer. Else the
    camera is fitted to the model after them."""
    zoom: Optional[float] = None
    """> 1: closer."""
    orthographic: Optional[bool] = None
    """Parallel projection."""
    index: Optional[int] = None
    """A camera of the file, from 0; not with position, focal_point or direction."""


Where = Union[None, Camera, Mapping[str, Any]]


class Job:
    """A device and a job of the library. One thread at a time can use it."""

    _kind = "Job"

    def __init__(self, device: str, threads: int, scene: Optional[Scene]) -> None:
        if scene is not None:
            scene.check_open()
        self._device = native.new_device(device, threads)
        self._scene = scene
        made = (
            native.lib.umbNewShadeJob(self._device.pointer)
            if scene is None
            else native.lib.umbNewRenderJob(self._device.pointer, scene.handle.pointer)
        )
        self._job = native.Handle(made, "Job")
        self._lock = threading.Lock()
        self._user: Optional[int] = None
        self._has_strokes = False
        self._values: Dict[str, Any] = {}  # of parameters that were set

    @property
    def device(self) -> str:
        """Description of the device, such as "vulkan:0: NVIDIA ..."."""
        self._check_open()
        return (native.lib.umbGetDeviceDescription(self._device.pointer) or b"").decode("utf-8", "replace")

    @property
    def device_bytes(self) -> int:
        """GPU memory that the device has allocated, bytes; 0 on the CPU."""
        self._check_open()
        return int(native.lib.umbGetDeviceMemory(self._device.pointer))

    def counter(self, name: str) -> int:
        """Returns how often an operation was done so far: "hierarchies_built", "captures_made" or "planes_copied" (of
        inputs). Errors: UsageError."""
        self._check_open()
        count = int(native.lib.umbGetJobCounter(self._job.pointer, native.bytes_of(name, "name")))
        if count < 0:
            raise UsageError(f"there is no counter '{name}'{suggestion(name, _COUNTERS)}")
        return count

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter: one of umbrage.parameters("render") or ("shade"), or of an effect, such as
        "bitmask.radius". None restores the default. Errors: UsageError."""
        native.bytes_of(name, "name")
        with self._exclusive():
            self._set_all({name: value})

    def close(self) -> None:
        """Frees the job and its device now."""
        if self._job.pointer is None or native.is_forked():
            return
        with self._exclusive():
            self._job.close()
            self._device.close()

    def __reduce__(self) -> Any:
        raise TypeError(f"a {self._kind} cannot be pickled or copied: make one in each process")

    def __enter__(self: _Self) -> _Self:
        return self

    def __exit__(
        self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()

    def _set(self, name: str, value: Any) -> None:
        lib, job, key = native.lib, self._job.pointer, native.bytes_of(name, "name")
        if getattr(value, "shape", None) == () and hasattr(value, "item"):  # a scalar of NumPy or torch
            value = value.item()
        if isinstance(value, os.PathLike):
            value = os.fspath(value)
        row = known_parameters("shade" if self._scene is None else "render").get(name)
        if row is not None and value is not None:
            row.check(value)
        if value is None:
            code = lib.umbResetJobParameter(job, key)
        elif isinstance(value, bool):
            code = lib.umbSetJobBool(job, key, value)
        elif isinstance(value, str):
            code = lib.umbSetJobString(job, key, native.bytes_of(value, name))
        elif isinstance(value, int) and (row is None or row.type == "int"):
            code = lib.umbSetJobInt(job, key, native.int32(value, name))
        elif isinstance(value, (int, float)):
            code = lib.umbSetJobFloat(job, key, native.number(value, name))
        else:
            code = self._set_several(key, name, value)
        self._job.check(code)
        self._values[name] = value
        if name == "strokes":
            self._has_strokes = bool(value)

    def _check_passes(self, passes: Any) -> None:
        """Checks the names of passes. Errors: UsageError."""
        for name in map(lambda word: native.bytes_of(word, "passes"), native.words(passes, "passes")):
            self._job.check(native.lib.umbSetJobOutput(self._job.pointer, name, byref(native.Image())))
            native.lib.umbSetJobOutput(self._job.pointer, name, None)

    def _set_several(self, key: bytes, name: str, value: Any) -> int:
        row = known_parameters("shade" if self._scene is None else "render").get(name)
        wrong = UsageError(f"`{name}` takes {row.values if row else 'a number or a string'}, not {shown(value)}")
        numbers: List[Any] = []
        try:
            for each in value.tolist() if hasattr(value, "tolist") else list(value):
                numbers += each if isinstance(each, (list, tuple)) else [each]
        except (TypeError, NotImplementedError):  # not iterable
            raise wrong from None
        if numbers and all(isinstance(word, str) for word in numbers):
            return int(native.lib.umbSetJobString(self._job.pointer, key, native.bytes_of(",".join(numbers), name)))
        try:
            array = (c_double * len(numbers))(*[float(number) for number in numbers])
        except (TypeError, ValueError, OverflowError):
            raise wrong from None
        return int(native.lib.umbSetJobDoubles(self._job.pointer, key, array, len(numbers)))

    def _set_all(self, settings: Optional[Mapping[str, Any]], **parameters: Any) -> None:
        given = {name: value for name, value in parameters.items() if value is not None}
        given.update(native.mapping(settings, "settings"))
        for name, value in given.items():
            if name in ("width", "height"):
                says = "the shape of depth" if self._scene is None else "`size`, (width, height),"
                raise UsageError(f"`{name}` cannot be set: {says} determines it")
            self._set(name, value)

    @contextmanager
    def _rolled_back_on_error(self) -> Iterator[None]:
        """Restores the parameters set within the context if an exception is raised."""
        before = dict(self._values)
        try:
            yield
        except BaseException:
            for name in [name for name, value in self._values.items() if name not in before or before[name] is not value]:
                self._set(name, before.get(name))
            raise

    def _set_camera(self, camera: Where, orbit: bool) -> None:
        """Sets the camera. Errors: UsageError."""
        given = native.mapping(vars(camera) if isinstance(camera, Camera) else camera, "camera", "a Camera or a dict")
        for name in given:
            if name not in Camera.__dataclass_fields__:
                raise UsageError(f"a camera has no parameter '{name}'{suggestion(name, Camera.__dataclass_fields__)}")
        for name in Camera.__dataclass_fields__:
            value = given.pop(name, None)
            self._set("camera." + name, orbit if name == "orbit" and value is None else value)

    @contextmanager
    def _exclusive(self) -> Iterator[None]:
        """Takes exclusive use; other threads wait. Errors: UsageError within the object's own progress callback, and
        once it is closed; DeviceError in a forked process."""
        native.check_process()
        me = threading.get_ident()
        if self._user == me:
            raise UsageError(f"a {self._kind} cannot be used within its own progress callback")
        with self._lock:
            self._check_open()
            self._user = me
            try:
                yield
            finally:
                self._user = None

    def _check_open(self) -> None:
        if self._job.pointer is None:
            raise UsageError(f"the {self._kind} was closed")

    def _call(self, function: Any, progress: Progress, is_before: bool = False) -> None:
        """Runs a long call on the job and reports its progress. Warnings of the library become Python warnings."""
        lib, job, device = native.lib, self._job.pointer, self._device.pointer
        messages: List[bytes] = []
        with Watch(progress, is_before) as watch:
            try:
                lib.umbSetJobProgressCallback(job, native.send_to_generator, watch.generator)
                lib.umbSetDeviceLogCallback(device, native.append_to_list, messages)
                self._job.check(function(job))
            finally:
                lib.umbSetJobProgressCallback(job, native.no_progress, None)
                lib.umbSetDeviceLogCallback(device, native.no_log, None)
        issue_warnings(messages)

    def _make(
        self,
        size: Tuple[int, int],
        wanted: Dict[str, Optional[NDArray[Any]]],
        progress: Progress,
        color_type: int = 1,
    ) -> Picture:
        """Executes the job. `size`: (width, height); (0, 0) for that of files. `wanted`: for each pass the array to
        write, or None for a new array, which for "color" has the type `color_type`. If `wanted` is empty, the library's
        default passes are returned."""
        import numpy as np

        lib, job = native.lib, self._job
        width, height = size
        arrays: Dict[str, NDArray[Any]] = {}
        is_set: List[bytes] = []
        try:
            for name, array in wanted.items():
                channels = 1 if is_id(name) else channels_of_passes.get(name, 0)
                if array is None and width > 0 and height > 0 and channels > 0:
                    shape = (height, width, channels) if channels > 1 else (height, width)
                    array = np.empty(shape, np.uint32 if is_id(name) else np.float32)
                if array is not None:
                    arrays[name] = array
                    image = image_of(array)
                else:
                    image = native.Image(type=color_type if name == "color" else 1, width=width, height=height)
                key = native.bytes_of(name, "name")
                job.check(lib.umbSetJobOutput(job.pointer, key, byref(image)))
                is_set.append(key)
            self._call(lib.umbExecuteJob, progress)
            made = native.names_of(lib.umbGetJobOutputName, job.pointer)
            for name in made:
                if name not in arrays:
                    arrays[name] = self._taken(name)
        finally:
            for key in is_set:
                lib.umbSetJobOutput(job.pointer, key, None)
        color = arrays.get("color")
        passes = {name: arrays[name] for name in made if name != "color"}
        is_from_files = self._scene is None and size == (0, 0)
        view = self._view() if self._scene is not None or is_from_files else None
        facts = tuple(native.names_of(lib.umbGetJobFact, job.pointer)) if is_from_files else ()
        if not self._has_strokes:
            return Picture(color, passes, [], view=view, facts=facts)
        return Picture(color, passes, *strokes_of(job), view=view, facts=facts)

    def _view(self) -> Optional[native.View]:
        """Returns the camera of the last picture; None if the library cannot."""
        if not native.has("umbGetJobView"):
            return None
        view = native.View()
        self._job.check(native.lib.umbGetJobView(self._job.pointer, byref(view)))
        return view

    def _taken(self, name: str) -> NDArray[Any]:
        """Returns a copy of an output in the library's memory."""
        import numpy as np

        image = native.Image()
        self._job.check(native.lib.umbGetJobOutput(self._job.pointer, native.bytes_of(name, "name"), byref(image)))
        channels_of_passes[name] = image.channels
        array = copied_image(image)
        if is_id(name) and array.dtype.kind == "f":
            is_surface = (array >= 0) & (array < 2**32)
            array = np.where(is_surface, array, 0).astype(np.uint32)
            array[~is_surface] = 2**32 - 1
        return array


def checked_dtype(dtype: Any) -> np.dtype[Any]:
    """Returns the dtype of a picture. Errors: UsageError."""
    import numpy as np

    try:
        kind = np.dtype(dtype)
    except TypeError:
        kind = np.dtype(object)
    if kind.name not in _DTYPES:
        raise UsageError(f"`dtype` takes one of {', '.join(_DTYPES)}, not {shown(dtype)}")
    return kind


def requested_outputs(
    size: Tuple[int, int], dtype: Any, passes: Union[str, Sequence[str]], out: Any, has_color: bool
) -> Dict[str, Optional[NDArray[Any]]]:
    """Returns the requested outputs, each with the array to write, or None for a new array."""
    import numpy as np

    given: Dict[str, Any] = native.mapping(out, "out") if out is None or isinstance(out, Mapping) else {"color": out}
    wanted: Dict[str, Optional[NDArray[Any]]] = {}
    if has_color or "color" in given:
        if "color" not in given:
            kind = checked_dtype(dtype)
            width, height = size
            is_possible = 0 < width <= 1 << 14 and 0 < height <= 1 << 14  # otherwise the library reports the error
            wanted["color"] = np.empty((height, width, 4) if is_possible else (0, 0, 4), kind)
    for name in native.words(passes, "passes"):
        if name != "color":
            wanted.setdefault(name)
    for name, values in given.items():
        wanted[name] = output_array(values, name)
    return wanted


@contextmanager
def shared_bar(progress: Progress) -> Iterator[Progress]:
    """Uses one progress bar for all calls within the context."""
    from ._progress import Bar

    check_progress(progress)
    if progress is not True:
        yield progress
        return
    bar = Bar()
    try:
        yield bar
    finally:
        bar.close()
