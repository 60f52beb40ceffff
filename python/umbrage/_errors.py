"""Errors of the library as exceptions. Each has `code`, the exit code that the command line would give."""
from __future__ import annotations

from typing import Dict, Type


class UmbrageError(Exception):
    """Any error of Umbrage. `code` is the exit code of the command line; the text is one sentence for people."""

    code: int = 1


class InternalError(UmbrageError):
    """A defect of Umbrage."""


class UsageError(UmbrageError, ValueError):
    """A name, value, array or call that cannot be."""

    code = 2


class FileError(UmbrageError, OSError):
    """A file that cannot be read, used or written."""

    code = 3


class DeviceError(UmbrageError, RuntimeError):
    """A device that is missing or cannot do it, or too little memory."""

    code = 4


class Cancelled(UmbrageError):
    """The progress callback returned False."""

    code = 130


class UmbrageWarning(UserWarning):
    """What the library warns of, such as a missing texture."""


_BY_CODE: Dict[int, Type[UmbrageError]] = {
    kind.code: kind for kind in (InternalError, UsageError, FileError, DeviceError, Cancelled)
}


# Of errors whose own sentence nobody kept.
_PLAIN = {
    1: "a defect of Umbrage",
    2: "a name, value, array or call that cannot be",
    3: "a file that cannot be read, used or written",
    4: "a device that is missing or cannot do it, or too little memory",
    130: "the progress callback returned False",
}


def error_of(code: int, message: str = "") -> UmbrageError:
    """The exception for a code of the C interface."""
    return _BY_CODE.get(code, InternalError)(message or _PLAIN.get(code, _PLAIN[1]))
