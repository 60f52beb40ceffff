"""ctypes bindings of the C interface, umbrage/umbrage.h: its structs, functions, and self-releasing handles."""
from __future__ import annotations

import ctypes
import os
import re
import types
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_bool,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_int32,
    c_int64,
    c_size_t,
    c_ssize_t,
    c_uint32,
    c_uint64,
    c_void_p,
    py_object,
)
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

from ._errors import DeviceError, UsageError, error_of
from ._suggest import shown

_LIBRARY = "libumbrage.so.1"
# Supported values of UMB_VERSION: from the first on, and below the second.
_VERSIONS = (100, 20000)


class Image(Structure):
    """UmbImage."""

    _fields_ = [
        ("data", c_void_p),
        ("type", c_int32),
        ("width", c_int32),
        ("height", c_int32),
        ("channels", c_int32),
        ("channel_stride", c_ssize_t),
        ("pixel_stride", c_ssize_t),
        ("row_stride", c_ssize_t),
    ]


class View(Structure):
    """UmbView."""

    _fields_ = [
        ("view_from_world", c_double * 12),
        ("left", c_float),
        ("right", c_float),
        ("bottom", c_float),
        ("top", c_float),
        ("orthographic", c_int32),
    ]


class StrokePoint(Structure):
    """UmbStrokePoint."""

    _fields_ = [("x", c_float), ("y", c_float), ("width", c_float)]


class Stroke(Structure):
    """UmbStroke."""

    _fields_ = [
        ("points", POINTER(StrokePoint)),
        ("point_count", c_size_t),
        ("kind", c_int32),
        ("object_id", c_uint32),
        ("closed", c_int32),
    ]


class Parameter(Structure):
    """UmbParameter."""

    _fields_ = [
        ("size", c_size_t),
        ("name", c_char_p),
        ("type", c_char_p),
        ("help", c_char_p),
        ("unit", c_char_p),
        ("initial", c_char_p),
        ("choices", c_char_p),
        ("min", c_double),
        ("max", c_double),
    ]


# Callbacks are not Python functions: a signal that arrives on entry to a Python function would raise an exception where
# it cannot be caught, and it would be lost. `user` is a generator, which waits inside a `try`, or a list.
ProgressCallback = CFUNCTYPE(c_bool, py_object, c_double)
LogCallback = CFUNCTYPE(None, py_object, c_char_p)
send_to_generator = ProgressCallback(types.GeneratorType.send)
append_to_list = LogCallback(list.append)
no_progress: Any = ProgressCallback()  # type: ignore[call-overload]  # NULL
no_log: Any = LogCallback()  # type: ignore[call-overload]

_FUNCTIONS: Tuple[Tuple[Any, ...], ...] = (  # name, result, arguments
    ("umbGetVersion", c_int),
    ("umbGetError", c_int, POINTER(c_char_p)),
    ("umbNewDevice", c_void_p, c_char_p, c_int),
    ("umbReleaseDevice", None, c_void_p),
    ("umbGetDeviceDescription", c_char_p, c_void_p),
    ("umbGetDeviceMemory", c_uint64, c_void_p),
    ("umbSetDeviceLogCallback", c_int, c_void_p, LogCallback, py_object),
    ("umbGetDeviceError", c_int, c_void_p, POINTER(c_char_p)),
    ("umbNewScene", c_void_p, c_void_p),
    ("umbReleaseScene", None, c_void_p),
    ("umbGetSceneError", c_int, c_void_p, POINTER(c_char_p)),
    ("umbSetSceneProgressCallback", c_int, c_void_p, ProgressCallback, py_object),
    ("umbSetSceneParameter", c_int, c_void_p, c_char_p, c_char_p),
    ("umbLoadModel", c_int, c_void_p, c_char_p),
    ("umbAddMesh", c_int, c_void_p, c_char_p, c_size_t, c_size_t),
    ("umbSetMeshBuffer", c_int, c_void_p, c_int, c_char_p, c_void_p, c_int, c_int, c_ssize_t),
    ("umbSetMeshValues", c_int, c_void_p, c_int, c_char_p, c_bool, c_void_p, c_int, c_int, c_ssize_t),
    ("umbSetMeshFloats", c_int, c_void_p, c_int, c_char_p, POINTER(c_float), c_int),
    ("umbSetMeshTexture", c_int, c_void_p, c_int, c_char_p, POINTER(Image)),
    ("umbAddMeshInstance", c_int, c_void_p, c_int, POINTER(c_float)),
    ("umbGetSceneBounds", c_int, c_void_p, POINTER(c_double), POINTER(c_double)),
    ("umbGetSceneCameraCount", c_int, c_void_p),
    ("umbNewRenderJob", c_void_p, c_void_p, c_void_p),
    ("umbNewShadeJob", c_void_p, c_void_p),
    ("umbReleaseJob", None, c_void_p),
    ("umbGetJobError", c_int, c_void_p, POINTER(c_char_p)),
    ("umbSetJobProgressCallback", c_int, c_void_p, ProgressCallback, py_object),
    ("umbSetJobString", c_int, c_void_p, c_char_p, c_char_p),
    ("umbSetJobBool", c_int, c_void_p, c_char_p, c_bool),
    ("umbSetJobInt", c_int, c_void_p, c_char_p, c_int),
    ("umbSetJobFloat", c_int, c_void_p, c_char_p, c_float),
    ("umbSetJobFloats", c_int, c_void_p, c_char_p, POINTER(c_float), c_int),
    ("umbSetJobDoubles", c_int, c_void_p, c_char_p, POINTER(c_double), c_int),
    ("umbResetJobParameter", c_int, c_void_p, c_char_p),
    ("umbSetJobImage", c_int, c_void_p, c_char_p, POINTER(Image)),
    ("umbSetJobOutput", c_int, c_void_p, c_char_p, POINTER(Image)),
    ("umbPrepareJob", c_int, c_void_p),
    ("umbExecuteJob", c_int, c_void_p),
    ("umbGetJobOutput", c_int, c_void_p, c_char_p, POINTER(Image)),
    ("umbGetJobOutputName", c_char_p, c_void_p, c_int),
    ("umbGetJobStrokeCount", c_size_t, c_void_p),
    ("umbGetJobStroke", c_int, c_void_p, c_size_t, POINTER(Stroke)),
    ("umbGetJobStrokeColor", c_int, c_void_p, POINTER(c_float), POINTER(c_float)),
    ("umbCheckJob", c_int, c_void_p),
    ("umbGetJobCounter", c_int64, c_void_p, c_char_p),
    ("umbWriteImages", c_int, c_char_p, POINTER(c_char_p), POINTER(Image), c_int, c_int, c_bool),
    ("umbWriteStrokes", c_int, c_char_p, c_int, c_int, POINTER(Stroke), c_size_t, POINTER(c_float), c_float),
    ("umbGetListEntry", c_int, c_int, c_int, POINTER(c_char_p), POINTER(c_char_p)),
    ("umbGetParameter", c_int, c_char_p, c_int, POINTER(Parameter)),
)
# Functions that only later versions of the library have.
_LATER_FUNCTIONS: Tuple[Tuple[Any, ...], ...] = (
    ("umbRemoveMesh", c_int, c_void_p, c_int),
    ("umbGetJobView", c_int, c_void_p, POINTER(View)),
    ("umbGetJobFact", c_char_p, c_void_p, c_int),
    ("umbGetJobFileLayer", c_char_p, c_void_p, c_int),
    (
        "umbWriteImagesOfView",
        c_int,
        c_char_p,
        POINTER(c_char_p),
        POINTER(Image),
        c_int,
        c_int,
        c_bool,
        POINTER(View),
    ),
)


def _opened() -> ctypes.CDLL:
    """Loads the library: the file named by UMBRAGE_LIBRARY, else the one next to this package, else the loader's."""
    named = os.environ.get("UMBRAGE_LIBRARY")
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), _LIBRARY)
    where = named or (beside if os.path.exists(beside) else _LIBRARY)
    try:
        library = ctypes.CDLL(where)
    except OSError as error:
        advice = "Install the library (libumbrage1), or set UMBRAGE_LIBRARY to its path"
        raise ImportError(f"the library of Umbrage cannot be loaded: {error}. {advice}") from error
    try:
        version = int(library.umbGetVersion())
        if not _VERSIONS[0] <= version < _VERSIONS[1]:
            raise ImportError(
                f"the library '{where}' has version {version_text(version)}: this package needs "
                f"{version_text(_VERSIONS[0])} or later, but below {version_text(_VERSIONS[1])}"
            )
        later = tuple(row for row in _LATER_FUNCTIONS if hasattr(library, row[0]))
        for name, result, *arguments in _FUNCTIONS + later:
            function = getattr(library, name)
            function.restype = result
            function.argtypes = arguments
    except AttributeError as error:
        raise ImportError(f"the library '{where}' is too old for this package, or is not Umbrage's: {error}") from error
    return library


def version_text(version: int) -> str:
    """Formats a UMB_VERSION as "0.2.0"."""
    return f"{version // 10000}.{version // 100 % 100}.{version % 100}"


lib: Any = _opened()


def has(function: str) -> bool:
    """Returns whether the library has a function of _LATER_FUNCTIONS."""
    return hasattr(lib, function)


# Threads of the library do not exist in a process that was forked after the first use of the library: calls would wait
# for them forever.
_used = False
_forked = False


def _after_fork() -> None:
    global _forked
    _forked = _used


os.register_at_fork(after_in_child=_after_fork)


# The keyword of each parameter of the library that has another name in this package; `file` is the first argument.
KEYWORDS: Dict[str, str] = {
    "width": "size",
    "height": "size",
    "file": "",
    "depth_file": "depth",
    "normal_file": "normal",
    "albedo_file": "albedo",
    "beauty_file": "beauty",
    "position_file": "position",
    "id_file": "object_id",
    "near_plane": "near",
    "far_plane": "far",
    "fov_deg": "fov",
}


def text_of(message: Optional[bytes]) -> str:
    """Decodes a text of the library, with keywords of this package in place of its parameters in backquotes, except
    `width` and `height`, the two numbers of `size`."""
    text = (message or b"").decode("utf-8", "replace")
    names = {name: keyword for name, keyword in KEYWORDS.items() if keyword not in ("", "size")}
    return re.sub(r"`(\w+)`", lambda found: f"`{names.get(found[1], found[1])}`", text)


def bytes_of(text: Any, name: str) -> bytes:
    """Encodes a string for the library. Errors: UsageError, which uses `name`, for a value that is not a string, and
    for a null character, which would end the string."""
    if not isinstance(text, (str, bytes)):
        raise UsageError(f"`{name}` takes a string, not {shown(text)}")
    encoded = text if isinstance(text, bytes) else os.fsencode(text)
    if b"\0" in encoded:
        raise UsageError(f"`{name}` cannot be {shown(text)}: it contains a null character")
    return encoded


def check(code: int) -> None:
    """Raises the thread's error if `code` is not 0."""
    if code:
        raise _taken(code, lib.umbGetError)


def _taken(code: int, take: Callable[..., int], *handle: Optional[int]) -> Exception:
    """Returns the error of a call that returned `code`; 0: of a call that returns no code. The error that `take` reads
    may be an older one; a call that was refused because another thread uses the object stores its error with the
    thread."""
    message = c_char_p()
    taken = take(*handle, ctypes.byref(message))
    if taken == 0 or code not in (0, taken):
        taken = lib.umbGetError(ctypes.byref(message))
    if taken == 0 or code not in (0, taken):
        return error_of(code)
    return error_of(taken, text_of(message.value))


class Handle:
    """A reference to an object of the library, which is released when this object is deleted."""

    __slots__ = ("pointer", "_release", "_take", "__weakref__")

    def __init__(self, pointer: Optional[int], kind: str) -> None:
        self._release: Callable[[Optional[int]], None] = getattr(lib, "umbRelease" + kind)
        self._take: Callable[..., int] = getattr(lib, f"umbGet{kind}Error")
        self.pointer = pointer
        if pointer is None:
            raise _taken(0, lib.umbGetError)

    def check(self, code: int) -> None:
        """Raises the object's error if `code` is not 0."""
        if code:
            raise _taken(code, self._take, self.pointer)

    def fail(self) -> None:
        """Raises the object's error after a call that returns no code."""
        raise _taken(0, self._take, self.pointer)

    def close(self) -> None:
        pointer, self.pointer = self.pointer, None
        if pointer is not None and not _forked:  # release would wait for threads that do not exist here
            self._release(pointer)

    def __del__(self) -> None:
        try:
            self.close()
        except AttributeError:  # the object was never created
            pass


def is_forked() -> bool:
    """Returns whether the library's objects belong to the parent process."""
    return _forked


def check_process() -> None:
    """Checks the process. Errors: DeviceError in a process that was forked from one that had used Umbrage."""
    if _forked:
        raise DeviceError(
            "this process was forked from one that had used Umbrage, and lacks its threads: start processes with "
            'multiprocessing.get_context("spawn")'
        )


def new_device(name: str, threads: int) -> Handle:
    """Opens a device. Errors: UsageError, DeviceError."""
    global _used
    check_process()
    _used = True
    return Handle(lib.umbNewDevice(bytes_of(name, "device"), int32(threads, "threads")), "Device")


def int32(number: Any, name: str) -> int:
    """Converts an integer and clamps it to 32 bits. Errors: UsageError."""
    try:
        if isinstance(number, bool):
            raise TypeError
        whole = number.__index__()
    except (AttributeError, TypeError):
        raise UsageError(f"`{name}` takes an integer, not {shown(number)}") from None
    return max(-(2**31), min(2**31 - 1, int(whole)))


def number(value: Any, name: str) -> float:
    """Converts a number to float. Errors: UsageError."""
    try:
        if isinstance(value, bool):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(f"`{name}` takes a number, not {shown(value)}") from None


def is_true(value: Any, name: str) -> bool:
    """Converts a bool. Errors: UsageError."""
    if getattr(value, "shape", None) == () and hasattr(value, "item"):  # a NumPy scalar
        value = value.item()
    if not isinstance(value, bool):
        raise UsageError(f"`{name}` takes True or False, not {shown(value)}")
    return value


def mapping(value: Any, name: str, what: str = "a dict by name") -> Dict[str, Any]:
    """Copies a caller's dict; None is empty. Errors: UsageError."""
    if value is None:
        return {}
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise UsageError(f"`{name}` takes {what}, not {shown(value)}")
    return dict(value)


def words(names: Any, name: str) -> List[str]:
    """Returns names, given as a list or separated by commas or spaces. Errors: UsageError."""
    if names is None:
        return []
    try:
        parted: List[Any] = names.replace(",", " ").split() if isinstance(names, str) else list(names)
    except TypeError:
        parted = [None]
    if not all(isinstance(word, str) for word in parted):
        raise UsageError(f"`{name}` takes names, not {shown(names)}")
    return parted


def names_of(function: Callable[[Optional[int], int], Optional[bytes]], pointer: Optional[int]) -> List[str]:
    """Returns the names that `function` returns for 0, 1, ..., up to the first missing one."""
    names: List[str] = []
    while True:
        name = function(pointer, len(names))
        if name is None:
            return names
        names.append(text_of(name))
