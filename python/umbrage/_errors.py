"""Exceptions for errors of the library. Each has `code`, the exit code that the command line would return."""
from __future__ import annotations

from typing import Dict, Type


class UmbrageError(Exception):
    """Any error of Umbrage. `code` is the exit code of the command line; the text is one sentence for display."""

    code: int = 1


class InternalError(UmbrageError):
    """A defect of Umbrage."""


class UsageError(UmbrageError, ValueError):
    """An invalid name, value, array or call."""

    code = 2


class FileError(UmbrageError, OSError):
    """A file that cannot be read, used or written."""

    code = 3


class DeviceError(UmbrageError, RuntimeError):
    """A missing or insufficient device, or too little memory."""

    code = 4


class Cancelled(UmbrageError):
    """The progress callback returned False."""

    code = 130


class UmbrageWarning(UserWarning):
    """A warning of the library, such as a missing texture."""


_BY_CODE: Dict[int, Type[UmbrageError]] = {
    kind.code: kind for kind in (InternalError, UsageError, FileError, DeviceError, Cancelled)
}


# Messages for errors whose own message is not available.
_PLAIN = {
    1: "a defect of Umbrage",
    2: "an invalid name, value, array or call",
    3: "a file that cannot be read, used or written",
    4: "a missing or insufficient device, or too little memory",
    130: "the progress callback returned False",
}


def error_of(code: int, message: str = "") -> UmbrageError:
    """Returns the exception for an error code of the C interface."""
    return _BY_CODE.get(code, InternalError)(message or _PLAIN.get(code, _PLAIN[1]))
