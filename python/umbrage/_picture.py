"""Picture: the result of rendering or shading as arrays, and how it is written to a file."""
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

_STROKE_KINDS = ("outline", "fold", "crease", "hatch", "cross-hatch", "hidden")


class Stroke(NamedTuple):
    """A line of the picture as a curve: a polyline with round caps and joins."""

    points: NDArray[Any]
    """(N, 3) float32: x, y and width, in pixels; x and y from the picture's upper left corner."""
    kind: str
    """"outline": border of an object; "fold": an object occludes a part of itself; "crease": two faces meet;
    "hatch", "cross-hatch": hatching along a surface, and hatching that crosses it; "hidden": a dash of an edge behind the
    visible surface."""
    object_id: int
    """Id of the nearer surface."""
    closed: bool
    """Whether the last point coincides with the first."""


class Picture:
    """A picture and its passes. `picture["ao"]` returns a pass; a notebook displays the picture.

    Arrays are (height, width) or (height, width, channels), row 0 at the top. Passes are float32, ids uint32.
    """

    def __init__(
        self,
        color: Optional[NDArray[Any]],
        passes: Dict[str, NDArray[Any]],
        strokes: List[Stroke],
        stroke_color: Tuple[float, float, float] = (0.0, 0.0, 0.0),
        stroke_opacity: float = 0.0,
        view: Optional[native.View] = None,
        facts: Tuple[str, ...] = (),
    ) -> None:
        self._color = color
        self._view = view
        self.facts = facts
        """What was found about the files of a shaded G-buffer, one line each."""
        self.passes = passes
        """The passes by name: "depth" (scene units, infinity where there is no surface), "normal" (view space), ..."""
        self.strokes = strokes
        """Lines as curves, if `strokes=True` was set and the look draws lines."""
        self.stroke_color = stroke_color
        """Colour of the strokes: red, green and blue, sRGB, 0 to 1."""
        self.stroke_opacity = stroke_opacity
        """Opacity of all strokes together, 0 to 1."""

    @property
    def picture(self) -> NDArray[Any]:
        """(height, width, 4): red, green, blue, sRGB, and alpha, not premultiplied. uint8 unless `dtype` was set;
        floats are 0 to 1. Errors: UsageError if no colour was made."""
        if self._color is None:
            raise UsageError(f"there is no picture, only passes: {', '.join(self.passes) or 'none'}")
        return self._color

    @property
    def _any(self) -> NDArray[Any]:
        return self._color if self._color is not None else next(iter(self.passes.values()))

    @property
    def width(self) -> int:
        """Width of the picture, pixels."""
        return int(self._any.shape[1])

    @property
    def height(self) -> int:
        """Height of the picture, pixels."""
        return int(self._any.shape[0])

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name == "color" and self._color is not None:
            return self._color
        if name not in self.passes:
            raise KeyError(f"there is no pass '{name}'{suggestion(str(name), self.keys())}")
        return self.passes[name]

    def __contains__(self, name: object) -> bool:
        return name in self.keys()

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def keys(self) -> List[str]:
        """Returns the names of the passes, preceded by "color" if there is a picture."""
        return (["color"] if self._color is not None else []) + list(self.passes)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> NDArray[Any]:
        import numpy as np

        return np.array(self.picture, dtype=dtype) if copy else np.asarray(self.picture, dtype=dtype)

    def __repr__(self) -> str:
        return f"<umbrage.Picture {self.width} x {self.height}: {', '.join(self.keys())}>"

    def save(self, path: Union[str, "os.PathLike[str]"], *, bits: int = 8, half: bool = False) -> None:
        """Writes a file, completely or not at all: .png, .jpg, .webp or .pfm (the picture, or else the only pass), .exr
        (picture, passes and camera) or .svg (strokes).

        Colours of .exr are scene-linear and premultiplied: the pass "beauty", or else, with a warning, the picture
        without its sRGB encoding, whose tone curve remains. `bits`: 8 or 16, for .png. `half`: .exr stores 16-bit
        floats where they suffice. Neither improves a picture of 8 bits: render it with dtype="float32". Errors:
        UsageError; FileError.
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
        is_exr = ending.endswith(b".exr")
        is_deep = ending.endswith(b".pfm") or bits == 16
        if has_color and is_exr and "beauty" not in self.passes:
            warnings.warn(
                f'"{os.fsdecode(file)}" holds display values without their sRGB encoding: '
                'render with passes="beauty" for scene-linear light',
                UmbrageWarning,
                stacklevel=2,
            )
        if has_color and is_deep and self.picture.dtype == "uint8":
            warnings.warn(
                f'"{os.fsdecode(file)}" is written from a picture of 8 bits: render with dtype="float32" for full precision',
                UmbrageWarning,
                stacklevel=2,
            )
        arrays: List[Tuple[str, NDArray[Any]]] = [("color", self.picture)] if has_color else []
        if not has_color or is_exr:
            arrays += self.passes.items()
        count = len(arrays)
        names = (ctypes.c_char_p * count)(*[native.bytes_of(name, "passes") for name, _ in arrays])
        images = (native.Image * count)(*[image_of(array) for _, array in arrays])
        arguments = file, names, images, count, native.int32(bits, "bits"), half
        if self._view is not None and native.has("umbWriteImagesOfView"):
            native.check(native.lib.umbWriteImagesOfView(*arguments, ctypes.byref(self._view)))
        else:
            native.check(native.lib.umbWriteImages(*arguments))

    def _save_strokes(self, file: bytes) -> None:
        import numpy as np

        if not self.strokes:
            raise UsageError("the picture has no strokes: draw a look with lines, such as technical, with strokes=True")
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
    """Returns the strokes of a job's last execution, their colour and opacity."""
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
