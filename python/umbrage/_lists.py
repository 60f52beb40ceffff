"""What there is: looks, effects, devices and parameters."""
from __future__ import annotations

from ctypes import byref, c_char_p, sizeof
from typing import Dict, NamedTuple, Optional, Tuple

from . import _native as native


def _list(number: int) -> Dict[str, str]:
    entries: Dict[str, str] = {}
    name, summary = c_char_p(), c_char_p()
    while native.lib.umbGetListEntry(number, len(entries), byref(name), byref(summary)) == 0:
        entries[(name.value or b"").decode()] = (summary.value or b"").decode("utf-8", "replace")
    native.lib.umbGetError(None)  # that there are no more
    return entries


def looks() -> Dict[str, str]:
    """Recipes of pictures: names, each with one line about it."""
    return _list(1)


def effects() -> Dict[str, str]:
    """Effects: names, each with one line about it."""
    return _list(2)


def occlusions() -> Dict[str, str]:
    """Values of the parameter `occlusion`: names, each with one line about it."""
    return _list(3)


def devices() -> Dict[str, str]:
    """Usable devices: names, each with one line about it. This asks the driver."""
    return _list(4)


def scenes() -> Dict[str, str]:
    """Built-in scenes, which stand in place of a model's path: names, each with one line about it."""
    return _list(5)


def file_formats() -> Dict[str, str]:
    """Endings of files that are read or written, each with one line about it."""
    return _list(6)


class Parameter(NamedTuple):
    """What is known of a parameter."""

    name: str
    type: str
    """"bool", "int", "float", "float3", "float4", "float9", "string", "length" or "choice"."""
    help: str
    unit: str
    initial: str
    """What holds where it is not set, in words."""
    choices: Tuple[str, ...]
    range: Optional[Tuple[float, float]]


def parameters(owner: str) -> Dict[str, Parameter]:
    """The parameters of "render", "shade", "scene" or an effect, by name. Errors: UsageError."""
    rows: Dict[str, Parameter] = {}
    row = native.Parameter(size=sizeof(native.Parameter))
    while True:
        code = native.lib.umbGetParameter(native.bytes_of(owner), len(rows), byref(row))
        if code and not rows:
            native.check(code)
        if code:
            native.lib.umbGetError(None)
            return rows
        name, kind, about, unit, initial, choices = (
            (text or b"").decode("utf-8", "replace")
            for text in (row.name, row.type, row.help, row.unit, row.initial, row.choices)
        )
        limits = None if row.min == 0 and row.max == 0 else (row.min, row.max)
        rows[name] = Parameter(name, kind, about, unit, initial, tuple(choices.split()), limits)
