"""Texts for messages about invalid names and values."""
from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Iterable, List

_MAX_EDIT_DISTANCE = 2  # max edit distance, in letters; for names of up to 4 letters it is 1
_MAX_SHOWN = 60  # max number of characters of a value in a message


def shown(value: Any) -> str:
    """Formats a value for a message; long texts are truncated."""
    try:
        if hasattr(value, "shape") and hasattr(value, "dtype"):
            return f"an array of the shape {tuple(value.shape)}"
        text = " ".join(repr(value).split())
    except Exception:  # `value` may raise any exception
        text = f"a {type(value).__name__}"
    return text if len(text) <= _MAX_SHOWN else text[: _MAX_SHOWN - 3] + "..."


def _distance(a: str, b: str) -> int:
    """Returns the edit distance of two words: letters to insert, delete, change or swap with a neighbour."""
    before, last = [0] * (len(b) + 1), list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        row = [i]
        for j, y in enumerate(b, 1):
            row.append(min(last[j - 1] + (x != y), last[j] + 1, row[j - 1] + 1))
            if i > 1 and j > 1 and x == b[j - 2] and a[i - 2] == y:
                row[j] = min(row[j], before[j - 2] + 1)
        before, last = last, row
    return last[-1]


# What other programs call a parameter, and a name that it may have here: the table of core/suggest.h.
_OTHER_NAMES = re.findall(r'"(.+)", "(.+)"', (Path(__file__).parent / "other_names.inc").read_text("utf-8"))


def _nearest(word: str, names: List[str]) -> str:
    """Returns the name that is meant by a word, or "": the nearest by edit distance, one of _OTHER_NAMES, or the
    shortest name of which the word is a part between dashes, underscores or dots."""
    best, nearest = _MAX_EDIT_DISTANCE + 1, ""
    for name in names:
        distance = _distance(word, name)
        if distance < best and distance <= max(1, (len(name) - 1) // 2):
            best, nearest = distance, name
    if nearest:
        return nearest
    word = word.replace("_", "-")
    for other, own in _OTHER_NAMES:
        if other == word and own in names:
            return own
    parts = [name for name in names if word in re.split(r"[-_.]", name)]
    return min(parts, key=len, default="")


def suggestion(word: str, names: Iterable[str]) -> str:
    """Returns " (did you mean 'x'?)" for the name that is meant, if one is, else " (available: a, b)". Defined as in
    core/suggest.h. Used for names that only the Python package knows."""
    listed = list(dict.fromkeys(names))
    nearest = _nearest(word, listed)
    if nearest:
        return f" (did you mean '{nearest}'?)"
    return f" (available: {', '.join(listed) or 'none'})"
