"""What is said of a wrong name or value."""
from __future__ import annotations

from typing import Any, Iterable

_SLIPS = 2  # letters; more, or two in a word of up to four letters, is another word
_LONGEST = 60  # characters of a value that a message shows


def shown(value: Any) -> str:
    """A value for a message, cut where it is long."""
    try:
        if hasattr(value, "shape") and hasattr(value, "dtype"):
            return f"an array of the shape {tuple(value.shape)}"
        text = " ".join(repr(value).split())
    except Exception:  # whatever a caller's object does there
        text = f"a {type(value).__name__}"
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def _distance(a: str, b: str) -> int:
    """Letters inserted, deleted, changed or swapped with their neighbour between two words."""
    before, last = [0] * (len(b) + 1), list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        row = [i]
        for j, y in enumerate(b, 1):
            row.append(min(last[j - 1] + (x != y), last[j] + 1, row[j - 1] + 1))
            if i > 1 and j > 1 and x == b[j - 2] and a[i - 2] == y:
                row[j] = min(row[j], before[j - 2] + 1)
        before, last = last, row
    return last[-1]


def suggestion(word: str, names: Iterable[str]) -> str:
    """" (did you mean 'x'?)" for the nearest of the names if it is near, else " (available: a, b)": the library's rule,
    for names that it does not know."""
    listed = list(dict.fromkeys(names))
    best, nearest = _SLIPS + 1, ""
    for name in listed:
        distance = _distance(word, name)
        if distance < best and distance <= max(1, (len(name) - 1) // 2):
            best, nearest = distance, name
    if nearest:
        return f" (did you mean '{nearest}'?)"
    return f" (available: {', '.join(listed) or 'none'})"
