"""Picture: what was made, as arrays, and how it becomes a file."""
from __future__ import annotations

import ctypes
import os
import warnings
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, NamedTuple, Optional, Tuple, Union

from . import _native as native
from ._arrays import image_of
from ._errors import UmbrageWarning, UsageError
from ._suggest import shown, suggestion

if TYPE_CHECKING:
    from numpy.typing import NDArray

_STROKE_KINDS = ("outline", "fold", "crease")


class Stroke(NamedTuple):
    """A line of the picture as a curve: a polyline with round ends and joins."""

    points: NDArray[Any]
    """(N, 3) float32: x, y and width, in pixels from the picture's upper left corner."""
    kind: str
    """"outline": an object ends; "fold": it hides a part of itself; "crease": two faces meet."""
    object_id: int
    """Of the nearer surface."""
    closed: bool
    """The last point is the first one again."""


class Picture:
    """A picture and its passes. `picture["ao"]` is a pass; a notebook shows the picture.

    Arrays are (height, width) or (height, width, channels), row 0 at the top. Passes are float32, ids uint32.
    """

    def __init__(
        self,
        color: Optional[NDArray[Any]],
        passes: Dict[str, NDArray[Any]],
        strokes: List[Stroke],
        stroke_color: Tuple[float, float, float] = (0.0, 0.0, 0.0),
        stroke_opacity: float = 0.0,
    ) -> None:
        self._color = color
        self.passes = passes
        """The passes by name: "depth" (scene units, infinity where there is no surface), "normal" (view space), ..."""
        self.strokes = strokes
        """Lines as curves, where `strokes=True` asked for them and the look has some."""
        self.stroke_color = stroke_color
        """Red, green and blue of the strokes, sRGB, 0 to 1."""
        self.stroke_opacity = stroke_opacity
        """Of all strokes together."""

    @property
    def picture(self) -> NDArray[Any]:
        """(height, width, 4): red, green, blue, sRGB, and alpha, which is not multiplied in. uint8 unless `dtype` said
        something else; floats are 0 to 1. Errors: UsageError where effects have made no colour."""
        if self._color is None:
            raise UsageError(f"there is no picture, but passes: {', '.join(self.passes) or 'none'}")
        return self._color

    @property
    def _any(self) -> NDArray[Any]:
        return self._color if self._color is not None else next(iter(self.passes.values()))

    @property
    def width(self) -> int:
        """In pixels."""
        return int(self._any.shape[1])

    @property
    def height(self) -> int:
        """In pixels."""
        return int(self._any.shape[0])

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name == "color" and self._color is not None:
            return self._color
        if name not in self.passes:
            raise KeyError(f"no pass '{name}' was made{suggestion(str(name), self.keys())}")
        return self.passes[name]

    def __contains__(self, name: object) -> bool:
        return name in self.keys()

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def keys(self) -> List[str]:
        """"color" and the names of the passes."""
        return (["color"] if self._color is not None else []) + list(self.passes)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> NDArray[Any]:
        import numpy as np

        return np.array(self.picture, dtype=dtype) if copy else np.asarray(self.picture, dtype=dtype)

    def __repr__(self) -> str:
        return f"<umbrage.Picture {self.width} x {self.height}: {', '.join(self.keys())}>"

    def save(self, path: Union[str, "os.PathLike[str]"], *, bits: int = 8, half: bool = False) -> None:
        """Writes a file, whole or not at all: .png or .pfm (the picture, or else the only pass), .exr (picture and
        passes) or .svg (the strokes).

        `bits`: 8 or 16, of .png. `half`: 16-bit floats in .exr where they suffice. A picture of 8 bits becomes no better
        by either: ask for dtype="float32" when you render. Errors: UsageError; FileError.
        """
        try:
            file = native.bytes_of(os.fspath(path), "path")
        except TypeError:
            raise UsageError(f"`path` takes a string or a path, not {shown(path)}") from None
        native.is_true(half, "half")
        ending = file.lower()
        if ending.endswith(b".svg"):
            self._save_strokes(file)
            return
        has_color = self._color is not None
        is_deep = ending.endswith((b".exr", b".pfm")) or bits == 16
        if has_color and is_deep and self.picture.dtype == "uint8":
            warnings.warn(
                f'"{os.fsdecode(file)}" gets a picture of 8 bits: render with dtype="float32" for all of them',
                UmbrageWarning,
                stacklevel=2,
            )
        arrays: List[Tuple[str, NDArray[Any]]] = [("color", self.picture)] if has_color else []
        if not has_color or ending.endswith(b".exr"):
            arrays += self.passes.items()
        count = len(arrays)
        names = (ctypes.c_char_p * count)(*[native.bytes_of(name, "passes") for name, _ in arrays])
        images = (native.Image * count)(*[image_of(array) for _, array in arrays])
        native.check(native.lib.umbWriteImages(file, names, images, count, native.int32(bits, "bits"), half))

    def _save_strokes(self, file: bytes) -> None:
        import numpy as np

        points = [np.ascontiguousarray(stroke.points, dtype=np.float32) for stroke in self.strokes]
        strokes = (native.Stroke * len(points))()
        for each, stroke, array in zip(strokes, self.strokes, points):
            each.points = array.ctypes.data_as(ctypes.POINTER(native.StrokePoint))
            each.point_count, each.kind = len(array), _STROKE_KINDS.index(stroke.kind)
            each.object_id, each.closed = stroke.object_id, stroke.closed
        rgb = (ctypes.c_float * 3)(*self.stroke_color)
        native.check(
            native.lib.umbWriteStrokes(file, self.width, self.height, strokes, len(points), rgb, self.stroke_opacity)
        )

    def _repr_png_(self) -> Optional[bytes]:
        if self._color is None:
            return None
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "picture.png")
            Picture(self._color, {}, []).save(file)
            with open(file, "rb") as png:
                return png.read()


def strokes_of(job: native.Handle) -> Tuple[List[Stroke], Tuple[float, float, float], float]:
    """Strokes of a job's last execution, their colour and opacity."""
    import numpy as np

    lib = native.lib
    strokes: List[Stroke] = []
    for index in range(lib.umbGetJobStrokeCount(job.pointer)):
        stroke = native.Stroke()
        job.check(lib.umbGetJobStroke(job.pointer, index, ctypes.byref(stroke)))
        points = np.empty((stroke.point_count, 3), np.float32)
        ctypes.memmove(points.ctypes.data, stroke.points, points.nbytes)
        strokes.append(Stroke(points, _STROKE_KINDS[stroke.kind], stroke.object_id, bool(stroke.closed)))
    rgb, opacity = (ctypes.c_float * 3)(), ctypes.c_float()
    job.check(lib.umbGetJobStrokeColor(job.pointer, rgb, ctypes.byref(opacity)))
    return strokes, (rgb[0], rgb[1], rgb[2]), opacity.value
