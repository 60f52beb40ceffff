"""The C interface, umbrage/umbrage.h, by ctypes: its structs, its functions, and handles that release themselves."""
from __future__ import annotations

import ctypes
import os
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
# Versions of the C interface that this package speaks: UMB_VERSION from the first on, and below the second.
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


# Callbacks run no Python of their own: a signal that arrives on the way into a Python function would raise where nobody
# can catch it, and be lost. `user` is a generator, which waits within a `try`, or a list.
ProgressCallback = CFUNCTYPE(c_bool, py_object, c_double)
LogCallback = CFUNCTYPE(None, py_object, c_char_p)
tell_generator = ProgressCallback(types.GeneratorType.send)
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
    ("umbSetMeshFloats", c_int, c_void_p, c_int, c_char_p, POINTER(c_float), c_int),
    ("umbSetMeshTexture", c_int, c_void_p, c_int, c_char_p, POINTER(Image)),
    ("umbAddMeshInstance", c_int, c_void_p, c_int, POINTER(c_float)),
    ("umbGetSceneBounds", c_int, c_void_p, POINTER(c_float), POINTER(c_float)),
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
# That later versions of the library have.
_LATER_FUNCTIONS: Tuple[Tuple[Any, ...], ...] = (("umbRemoveMesh", c_int, c_void_p, c_int),)


def _opened() -> ctypes.CDLL:
    """The library: where UMBRAGE_LIBRARY says, else beside this package, else where the loader looks."""
    named = os.environ.get("UMBRAGE_LIBRARY")
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), _LIBRARY)
    where = named or (beside if os.path.exists(beside) else _LIBRARY)
    try:
        library = ctypes.CDLL(where)
    except OSError as error:
        advice = "Install libumbrage1, or have the environment's UMBRAGE_LIBRARY name the file"
        needs = os.path.join(os.path.dirname(beside), "NEEDS")  # of a wheel
        if where == beside and os.path.exists(needs):
            with open(needs) as names:
                advice = f"It needs what these packages of Debian 12 hold: {names.read().strip()}"
        raise ImportError(f"the library of Umbrage cannot be loaded: {error}. {advice}") from error
    try:
        version = int(library.umbGetVersion())
        if not _VERSIONS[0] <= version < _VERSIONS[1]:
            raise ImportError(
                f"the library '{where}' has version {version_text(version)}: this package needs "
                f"{version_text(_VERSIONS[0])} or later, below {version_text(_VERSIONS[1])}"
            )
        later = tuple(row for row in _LATER_FUNCTIONS if hasattr(library, row[0]))
        for name, result, *arguments in _FUNCTIONS + later:
            function = getattr(library, name)
            function.restype = result
            function.argtypes = arguments
    except AttributeError as error:
        raise ImportError(f"the library '{where}' is too old for this package, or is none of Umbrage: {error}") from error
    return library


def version_text(version: int) -> str:
    """UMB_VERSION as "0.2.0"."""
    return f"{version // 10000}.{version // 100 % 100}.{version % 100}"


lib: Any = _opened()


def has(function: str) -> bool:
    """Whether the library has one of the later functions."""
    return hasattr(lib, function)


# Threads of the library do not live on in a process that was forked after its first use: work would wait for them
# forever.
_used = False
_forked = False


def _after_fork() -> None:
    global _forked
    _forked = _used


os.register_at_fork(after_in_child=_after_fork)


def _text(message: Optional[bytes]) -> str:
    return (message or b"").decode("utf-8", "replace")


def bytes_of(text: Any, name: str) -> bytes:
    """A string for the library. Errors: UsageError, which calls it by that name, for what is none, and for a null
    character, which would end it."""
    if not isinstance(text, (str, bytes)):
        raise UsageError(f"`{name}` takes a string, not {shown(text)}")
    encoded = text if isinstance(text, bytes) else os.fsencode(text)
    if b"\0" in encoded:
        raise UsageError(f"`{name}` cannot be {shown(text)}, which holds a null character")
    return encoded


def check(code: int) -> None:
    """Raises the thread's error."""
    if code:
        raise _taken(code, lib.umbGetError)


def _taken(code: int, take: Callable[..., int], *handle: Optional[int]) -> Exception:
    """The error of a call that returned the code; 0: of one that returns none. What `take` has may be an older error;
    that another thread is at work on an object is noted with the thread."""
    message = c_char_p()
    taken = take(*handle, ctypes.byref(message))
    if taken == 0 or code not in (0, taken):
        taken = lib.umbGetError(ctypes.byref(message))
    if taken == 0 or code not in (0, taken):
        return error_of(code)
    return error_of(taken, _text(message.value))


class Handle:
    """An object of the library, which is released with this one."""

    __slots__ = ("pointer", "_release", "_take", "__weakref__")

    def __init__(self, pointer: Optional[int], kind: str) -> None:
        self._release: Callable[[Optional[int]], None] = getattr(lib, "umbRelease" + kind)
        self._take: Callable[..., int] = getattr(lib, f"umbGet{kind}Error")
        self.pointer = pointer
        if pointer is None:
            raise _taken(0, lib.umbGetError)

    def check(self, code: int) -> None:
        """Raises the object's error."""
        if code:
            raise _taken(code, self._take, self.pointer)

    def fail(self) -> None:
        """Raises the object's error, of a call that returns no code."""
        raise _taken(0, self._take, self.pointer)

    def close(self) -> None:
        pointer, self.pointer = self.pointer, None
        if pointer is not None and not _forked:  # the threads that it would wait for are not in a forked process
            self._release(pointer)

    def __del__(self) -> None:
        try:
            self.close()
        except AttributeError:  # it was never made
            pass


def is_forked() -> bool:
    """Whether objects of the library are another process's."""
    return _forked


def check_process() -> None:
    """Errors: DeviceError in a process that was forked from one that had used Umbrage."""
    if _forked:
        raise DeviceError(
            "this process was forked from one that had used Umbrage, whose threads it lacks: start processes with "
            'multiprocessing.get_context("spawn")'
        )


def new_device(name: str, threads: int) -> Handle:
    """Errors: UsageError, DeviceError."""
    global _used
    check_process()
    _used = True
    return Handle(lib.umbNewDevice(bytes_of(name, "device"), int32(threads, "threads")), "Device")


def int32(number: Any, name: str) -> int:
    """A whole number that fits. Errors: UsageError."""
    try:
        if isinstance(number, bool):
            raise TypeError
        whole = number.__index__()
    except (AttributeError, TypeError):
        raise UsageError(f"`{name}` takes a whole number, not {shown(number)}") from None
    return max(-(2**31), min(2**31 - 1, int(whole)))


def number(value: Any, name: str) -> float:
    """Errors: UsageError."""
    try:
        if isinstance(value, bool):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(f"`{name}` takes a number, not {shown(value)}") from None


def is_true(value: Any, name: str) -> bool:
    """Errors: UsageError."""
    if getattr(value, "shape", None) == () and hasattr(value, "item"):  # of NumPy
        value = value.item()
    if not isinstance(value, bool):
        raise UsageError(f"`{name}` takes True or False, not {shown(value)}")
    return value


def mapping(value: Any, name: str, what: str = "a dict by name") -> Dict[str, Any]:
    """A caller's dict, copied; None is empty. Errors: UsageError."""
    if value is None:
        return {}
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise UsageError(f"`{name}` takes {what}, not {shown(value)}")
    return dict(value)


def words(names: Any, name: str) -> List[str]:
    """Names, of a list or parted by commas or spaces. Errors: UsageError."""
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
    """Names that are asked for by number, up to the first that is not there."""
    names: List[str] = []
    while True:
        name = function(pointer, len(names))
        if name is None:
            return names
        names.append(_text(name))
