"""Converts arrays of any library to images and buffers of the C interface, without a copy where possible."""
from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Dict, Iterator, Mapping, Optional, Tuple

from ._errors import UsageError
from ._native import Image
from ._suggest import shown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_TYPES = {"float32": 1, "float16": 2, "uint8": 3, "uint16": 4, "uint32": 5}
_MAX_INT32 = 2**31 - 1  # max of the C interface's type; the library's own limit is lower
_MAX_TEXTURE_SIDE = 16384  # max side of a texture, pixels
_ONE_CHANNEL = frozenset(("depth", "specular", "shininess", "shadow", "object_id", "material_id", "ao"))


def type_number(dtype: np.dtype[Any]) -> int:
    """Returns the UmbType of a type that the library has."""
    return _TYPES[dtype.name]


def is_id(name: str) -> bool:
    """Returns whether a pass contains ids."""
    return name.rsplit(".", 1)[-1] in ("object_id", "material_id")


def as_array(values: Any, name: str, what: str = "an array") -> NDArray[Any]:
    """Converts any array to NumPy's, sharing its memory if possible: NumPy arrays, objects with `__array_interface__`
    or the buffer protocol, CPU tensors by `__array__` or DLPack. Errors: UsageError."""
    import numpy as np

    if type(values) is np.ndarray:
        return values
    where = getattr(values, "__dlpack_device__", None)
    if where is not None and not isinstance(values, np.ndarray) and int(where()[0]) not in (1, 3):  # CPU, pinned
        raise UsageError(f"`{name}` is in the memory of another device: move it to the CPU first, for example with x.cpu()")
    mask = getattr(values, "mask", None)
    if mask is not None and hasattr(values, "filled"):  # a masked array: masked pixels have no surface
        values = values.filled(np.inf if values.dtype.kind == "f" else 0)
    try:
        if (
            hasattr(values, "__dlpack__")
            and not hasattr(values, "__array__")
            and not hasattr(values, "__array_interface__")
            and hasattr(np, "from_dlpack")
        ):
            return np.asarray(np.from_dlpack(values))
        array = np.asarray(values)
    except (TypeError, ValueError, RuntimeError, BufferError) as error:
        raise UsageError(f"`{name}` cannot be read as an array: {error}") from error
    if array.ndim == 0 and array.dtype.kind not in "biufc":
        raise UsageError(f"`{name}` takes {what}, not {shown(values)}")
    return array


def _is_usable(array: NDArray[Any]) -> bool:
    """Returns whether the library can read the array. A stride of 0 means packed to the library."""
    return array.dtype.isnative and all(s != 0 or n == 1 for s, n in zip(array.strides, array.shape))


def image_array(values: Any, name: str, shape: Optional[Tuple[int, int]] = None) -> NDArray[Any]:
    """Converts an input to an array (height, width) or (height, width, channels) of a type that the library reads. If
    `shape`, (height, width), is given, a colour or a number is repeated for all pixels. Errors: UsageError."""
    import numpy as np

    array = as_array(values, name)
    if shape is not None and array.ndim < 2:
        number = array.astype(np.float32) if array.dtype.kind in "iu" and not is_id(name) else array
        array = np.broadcast_to(number, shape + array.shape)
    if array.ndim not in (2, 3):
        hint = "; numpy.squeeze removes axes of length 1" if 1 in array.shape else ""
        raise UsageError(f"`{name}` has the shape {array.shape}: it takes (height, width) or (height, width, channels){hint}")
    channels = 1 if array.ndim == 2 else array.shape[2]
    if channels != 1 and name.rsplit(".", 1)[-1] in _ONE_CHANNEL:
        raise UsageError(f"`{name}` has the shape {array.shape}: it has one channel, (height, width)")
    if channels > 4 and array.shape[0] in (1, 3, 4):
        raise UsageError(f"`{name}` has the shape {array.shape}, channels first: convert it with numpy.moveaxis(x, 0, -1)")
    kind = array.dtype.kind
    if is_id(name):
        array = _ids(array, name)
    elif array.dtype.name == "uint32" or (kind in "iu" and array.dtype.name not in _TYPES):
        raise UsageError(
            f"`{name}` has the dtype {array.dtype.name}: it takes float32, float16, uint8 or uint16, for example "
            "x.astype('float32')"
        )
    elif kind == "b" or (kind == "f" and array.dtype.itemsize not in (2, 4)):
        array = array.astype(np.float32)
    elif kind not in "fu":
        raise UsageError(f"`{name}` has the dtype {array.dtype.name}: it takes float32, float16, uint8 or uint16")
    return array if _is_usable(array) else np.array(array, dtype=array.dtype.newbyteorder("="), order="C")


def masked(depth: NDArray[Any], mask: Any) -> NDArray[Any]:
    """Returns a depth of image_array that is infinite, no surface, where the mask is 0. Errors: UsageError."""
    import numpy as np

    keep = as_array(mask, "mask")
    if keep.shape not in (depth.shape[:2], depth.shape[:2] + (1,)):
        raise UsageError(f"`mask` has the shape {keep.shape}: the depth has {depth.shape[:2]}")
    one = np.iinfo(depth.dtype).max if depth.dtype.kind == "u" else 1
    return np.where(keep.reshape(depth.shape) != 0, depth.astype(np.float32) / np.float32(one), np.float32(np.inf))


@contextmanager
def array_file(images: Mapping[str, Any], mask: Any) -> Iterator[str]:
    """Writes the arrays of a G-buffer with positions to a temporary file, whose camera the library recognises. Errors:
    UsageError."""
    import numpy as np

    shape = image_array(images["position"], "position").shape
    arrays = {name: image_array(values, name, shape[:2]) for name, values in images.items()}
    arrays.update({} if mask is None else {"mask": image_array(mask, "mask")})
    for name, array in arrays.items():
        if array.shape[:2] != shape[:2] or (name == "position" and shape[2:] != (3,)):
            raise UsageError(f"`{name}` has the shape {array.shape}: `position` has {shape}, and takes (height, width, 3)")
        if array.dtype.kind == "u" and not is_id(name):
            arrays[name] = array / np.float32(np.iinfo(array.dtype).max)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "arrays.npz")
        np.savez(path, **arrays)
        yield path


def texture_array(values: Any, name: str) -> NDArray[Any]:
    """Converts a texture, an array or an image of Pillow, to (height, width, 3 or 4) uint8. Errors: UsageError."""
    import numpy as np

    if hasattr(values, "convert") and isinstance(getattr(values, "mode", None), str):  # Pillow
        has_alpha = "A" in values.mode or "a" in values.mode or "transparency" in getattr(values, "info", {})
        values = values.convert("RGBA" if has_alpha else "RGB")
    array = as_array(values, name)
    if array.dtype != np.uint8:
        raise UsageError(f"`{name}` has the dtype {array.dtype.name}: it takes uint8, from 0 to 255")
    if array.ndim == 2 or (array.ndim == 3 and array.shape[2] == 1):
        array = np.repeat(array.reshape(array.shape[:2] + (1,)), 3, axis=2)
    if array.ndim != 3 or array.shape[2] not in (3, 4):
        raise UsageError(f"`{name}` has the shape {array.shape}: it takes (height, width), or that and 3 or 4 channels")
    if not all(0 < side <= _MAX_TEXTURE_SIDE for side in array.shape[:2]):
        raise UsageError(f"`{name}` has the shape {array.shape}: it takes 1 to {_MAX_TEXTURE_SIDE} pixels per side")
    return np.ascontiguousarray(array)


def _ids(array: NDArray[Any], name: str) -> NDArray[Any]:
    """Converts ids to unsigned integers or float32. Errors: UsageError."""
    import numpy as np

    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind == "f":
        return array.astype(np.float32, copy=False)
    if kind == "b":
        return array.view(np.uint8)
    if kind not in "iu":
        raise UsageError(f"`{name}` has the dtype {array.dtype.name}: ids are integers")
    if kind == "u" and size <= 4:
        return array
    if kind == "i" and size == 4 and array.dtype.isnative:
        return array.view(np.uint32)  # -1 has all bits set
    if array.size and (int(array.min()) < -1 or int(array.max()) >= 2**32):
        raise UsageError(f"`{name}` holds {int(array.min())} to {int(array.max())}: ids have 32 bits")
    return array.astype(np.uint32)


def output_array(values: Any, name: str) -> NDArray[Any]:
    """Returns the caller's array for an output. Errors: UsageError if it is read-only or would have to be copied."""
    if isinstance(values, (list, tuple, int, float, str, bytes)):
        raise UsageError(f"the output `{name}` takes an array, not {shown(values)}")
    array = as_array(values, name)
    if array.ndim not in (2, 3):
        raise UsageError(f"the output `{name}` has the shape {array.shape}: it takes (height, width, channels)")
    if array.dtype.name not in _TYPES:
        raise UsageError(f"the output `{name}` has the dtype {array.dtype.name}: it takes {', '.join(_TYPES)}")
    if not array.flags.writeable:
        raise UsageError(f"the output `{name}` is read-only: it takes an array that can be written")
    if array.size and not _is_usable(array):
        raise UsageError(
            f"the output `{name}` has pixels that share memory, or bytes in another order: it takes an array of its own"
        )
    if _overlaps_itself(array):
        raise UsageError(f"the output `{name}` has pixels that share memory: it takes an array of its own")
    return array


def _overlaps_itself(array: NDArray[Any]) -> bool:
    """Returns whether elements may share bytes: sorted by stride, each axis must step beyond all smaller axes."""
    reach = array.dtype.itemsize
    for stride, count in sorted((abs(s), n) for s, n in zip(array.strides, array.shape) if n > 1):
        if stride < reach:
            return True
        reach += stride * (count - 1)
    return False


def share_memory(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """Returns whether two arrays share a byte. Returns True if the exact test would take too long."""
    import numpy as np

    tries = 100000  # a few milliseconds
    try:
        return np.may_share_memory(a, b) and np.shares_memory(a, b, max_work=tries)
    except RuntimeError:  # numpy.TooHardError, whose module depends on the version
        return True


def image_of(array: NDArray[Any]) -> Image:
    """Describes an array of image_array or output_array for the library. The array must outlive the image."""
    strides = [s if n > 1 else array.dtype.itemsize for s, n in zip(array.strides, array.shape)]
    height, width = (min(n, _MAX_INT32) for n in array.shape[:2])
    has_channels = array.ndim == 3
    return Image(
        array.ctypes.data if array.size else None,
        _TYPES[array.dtype.name],
        width,
        height,
        min(array.shape[2], _MAX_INT32) if has_channels else 1,
        strides[2] if has_channels else array.dtype.itemsize,
        strides[1],
        strides[0],
    )


def copied_image(image: Image) -> NDArray[Any]:
    """Copies an output in the library's memory to (height, width), or (height, width, channels) if there are
    several."""
    import ctypes

    import numpy as np

    names: Dict[int, str] = {number: name for name, number in _TYPES.items()}
    dtype = np.dtype(names[image.type])
    shape: Tuple[int, ...] = (image.height, image.width)
    if image.channels > 1:
        shape += (image.channels,)
    copy = np.empty(shape, dtype)
    ctypes.memmove(copy.ctypes.data, image.data, copy.nbytes)
    return copy
