"""Lists of looks, effects, devices, scenes, file formats and parameters."""
from __future__ import annotations

from ctypes import byref, c_char_p, sizeof
from inspect import signature
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Tuple

from . import _native as native
from ._errors import UsageError
from ._native import KEYWORDS
from ._suggest import shown, suggestion


def _list(number: int) -> Dict[str, str]:
    entries: Dict[str, str] = {}
    name, summary = c_char_p(), c_char_p()
    while native.lib.umbGetListEntry(number, len(entries), byref(name), byref(summary)) == 0:
        entries[(name.value or b"").decode()] = (summary.value or b"").decode("utf-8", "replace")
    native.lib.umbGetError(None)  # discards the error of the last call
    return entries


def looks() -> Dict[str, str]:
    """Returns the names of looks, each with a summary of one line."""
    return _list(1)


def effects() -> Dict[str, str]:
    """Returns the names of effects, each with a summary of one line."""
    return _list(2)


def occlusions() -> Dict[str, str]:
    """Returns the values of the parameter `occlusion`, each with a summary of one line."""
    return _list(3)


def devices() -> Dict[str, str]:
    """Returns the names of usable devices, each with a summary of one line. Queries the graphics driver."""
    return _list(4)


def scenes() -> Dict[str, str]:
    """Returns the names of built-in scenes, which can replace a model's path, each with a summary of one line."""
    return _list(5)


def file_formats() -> Dict[str, str]:
    """Returns the extensions of files that can be read or written, each with a summary of one line."""
    return _list(6)


class Parameter(NamedTuple):
    """The description of a parameter."""

    name: str
    type: str
    """"bool", "int", "float", "float2", "float3", "float4", "float9", "string", "length" or "choice"."""
    help: str
    unit: str
    initial: str
    """The default, as text."""
    choices: Tuple[str, ...]
    range: Optional[Tuple[float, float]]

    @property
    def default(self) -> Any:
        """The default, as a Python value; None if it is chosen when the picture is made."""
        if self.type == "bool":
            return {"on": True, "true": True, "off": False, "false": False}.get(self.initial)
        if self.type in ("int", "float", "float2", "float3", "float4", "float9"):
            try:
                numbers = [int(n) if self.type == "int" else float(n) for n in self.initial.split(",")]
            except ValueError:
                return None
            return tuple(numbers) if len(numbers) > 1 else numbers[0]
        if self.type == "length":
            return self.initial if self.initial[:1].isdigit() else None
        if self.type == "choice":
            return self.initial if self.initial in self.choices else None
        return self.initial if self.initial and " " not in self.initial and "'" not in self.initial else None

    def check(self, value: Any) -> None:
        """Checks the type of a value if the library's own message would be less clear. Errors: UsageError."""
        if self.type == "bool" and not isinstance(value, (bool, str)):
            raise UsageError(f"`{self.name}` takes True or False, not {shown(value)}")
        is_text = isinstance(value, str) or (isinstance(value, (list, tuple)) and all(isinstance(v, str) for v in value))
        if self.type in ("string", "choice") and not is_text:
            what = f"one of {', '.join(self.choices)}" if self.choices else "a string"
            raise UsageError(f"`{self.name}` takes {what}, not {shown(value)}")
        if self.type not in ("bool", "string", "choice") and isinstance(value, (bool, bytes)):
            raise UsageError(f"`{self.name}` takes {self.values}, not {shown(value)}")

    @property
    def values(self) -> str:
        """The kind of values that are accepted, as text."""
        words = {"int": "an integer", "length": "a number, or a relative length such as '5%'", "bool": "True or False"}
        several = {"float2": "two numbers", "float3": "three numbers", "float4": "four numbers", "float9": "nine numbers"}
        return {**words, **several, "string": "a string", "choice": "a string"}.get(self.type, "a number")


def parameters(owner: str) -> Dict[str, Parameter]:
    """Returns the parameters of "render", "shade", "scene" or an effect; keys are names. Errors: UsageError."""
    rows: Dict[str, Parameter] = {}
    row = native.Parameter(size=sizeof(native.Parameter))
    while native.lib.umbGetParameter(native.bytes_of(owner, "owner"), len(rows), byref(row)) == 0:
        name, kind, about, unit, initial, choices = (
            (text or b"").decode("utf-8", "replace")
            for text in (row.name, row.type, row.help, row.unit, row.initial, row.choices)
        )
        limits = None if row.min == 0 and row.max == 0 else (row.min, row.max)
        rows[name] = Parameter(name, kind, about, unit, initial, tuple(choices.split()), limits)
    native.lib.umbGetError(None)  # discards the error of the last call
    if not rows and owner not in effects():
        owners = ("render", "shade", "scene", *effects())
        raise UsageError(f"'{owner}' has no parameters{suggestion(owner, owners)}")
    return rows


_KNOWN: Dict[str, Dict[str, Parameter]] = {}


def known_parameters(owner: str) -> Dict[str, Parameter]:
    """Returns the parameters of "render", "shade" or "scene"; queries the library once."""
    if owner not in _KNOWN:
        _KNOWN[owner] = parameters(owner)
    return _KNOWN[owner]


def keywords_of(function: Callable[..., Any]) -> List[str]:
    """Returns the keywords that the signature of a function names."""
    named = signature(function).parameters.values()
    return [each.name for each in named if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY)]


def check_keywords(given: Iterable[str], owner: str, arguments: Iterable[str]) -> None:
    """Checks that keywords are parameters of the owner. `arguments`: other names to suggest. Errors: UsageError."""
    for name in given:
        known = known_parameters(owner)
        if name not in known and name not in KEYWORDS and "." not in name:  # the library checks those of effects
            names = [*arguments, *(each for each in known if "." not in each and each not in KEYWORDS)]
            raise UsageError(f"there is no parameter '{name}'{suggestion(name, names)}")
