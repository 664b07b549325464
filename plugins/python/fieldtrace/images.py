"""From arrays and pictures to samples that the native half reads, and from what functions give to grids."""

from __future__ import annotations

import sys
from typing import Any, Optional

import numpy as np

#: Floats beyond this are not meant to be in 0..1.
_LARGEST = 2.0
#: Dots per inch that can be meant.
_DPI = (1.0, 100_000.0)


def samples(image: Any) -> "bytes | tuple[np.ndarray, Optional[tuple[float, float]]]":
    """The bytes of a file, or contiguous samples (height, width, channels) of uint8, uint16 or float32, and dots per inch."""
    if isinstance(image, (bytearray, memoryview)):
        return bytes(image)
    pillow = sys.modules.get("PIL.Image")
    if pillow is not None and isinstance(image, pillow.Image):
        return _of_picture(image)
    if not (hasattr(image, "__array__") or hasattr(image, "__array_interface__")):
        raise TypeError(f"an image is a path, bytes, an array or a PIL.Image, not {type(image).__name__}")
    return _of_array(np.asarray(image)), None


def _of_array(array: np.ndarray) -> np.ndarray:
    if array.ndim == 2:
        array = array[:, :, None]
    if array.ndim != 3 or array.shape[2] not in (1, 2, 3, 4):
        raise ValueError(
            f"an array of shape {array.shape} is no image: (height, width), or (height, width, channels) with 1 (grey), "
            "2 (grey, alpha), 3 (RGB) or 4 (RGBA) channels"
        )
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind == "b":
        return np.ascontiguousarray(array, np.uint8) * np.uint8(255)
    if kind == "u" and size in (1, 2):
        return np.ascontiguousarray(array, array.dtype.newbyteorder("="))
    if kind == "f":
        if array.size and (largest := np.nanmax(array, initial=0.0)) > _LARGEST:
            raise ValueError(f"floats are to be in 0..1 (black..white), and these reach {largest:g}")
        return np.ascontiguousarray(array, np.float32)
    raise TypeError(f"{array.dtype} has no known range: an image has bool, uint8, uint16, or floats in 0..1")


def _of_picture(image: Any) -> "tuple[np.ndarray, Optional[tuple[float, float]]]":
    """Of a picture of any mode, upright."""
    dpi = _dpi(image.info.get("dpi"))
    if image.getexif().get(0x0112, 1) != 1:
        from PIL import ImageOps

        upright = ImageOps.exif_transpose(image)
        if dpi is not None and upright.size != image.size:
            dpi = dpi[::-1]
        image = upright
    mode = image.mode
    if mode in ("P", "PA", "1", "L", "RGB") and "transparency" in image.info or mode == "PA":
        image = image.convert("RGBA")
    elif mode == "La":
        image = image.convert("LA")
    elif mode == "RGBa":
        image = image.convert("RGBA")
    elif mode == "I":
        return _of_array(np.asarray(image).clip(0, 65535).astype(np.uint16)), dpi
    elif mode == "F":
        return _of_array((np.asarray(image) / np.float32(255)).clip(0, 1)), dpi
    elif mode not in ("1", "L", "LA", "RGB", "RGBA") and not mode.startswith("I;16"):
        image = image.convert("RGB")
    return _of_array(np.asarray(image)), dpi


def _dpi(given: Any) -> "Optional[tuple[float, float]]":
    """What a picture says of its resolution, where that can be meant."""
    try:
        x, y = (_whole(float(dpi)) for dpi in given)
    except (TypeError, ValueError):
        return None
    low, high = _DPI
    return (x, y) if all(low <= dpi <= high for dpi in (x, y)) and max(x, y) <= 10 * min(x, y) else None


def _whole(dpi: float) -> float:
    """What was meant where a file counts in metres."""
    return float(round(dpi)) if np.isfinite(dpi) and abs(dpi - round(dpi)) <= 0.0127 else dpi


def coverage(given: Any) -> np.ndarray:
    """Coverage by ink as float32 (height, width) in 0..1: of floats, bool (ink or not) or uint8 (255 is all of a pixel)."""
    array = np.asarray(given)
    if array.ndim == 3 and array.shape[2] == 1:
        array = array[:, :, 0]
    if array.ndim != 2:
        raise ValueError(f"coverage is to be an array (height, width), not of shape {array.shape}")
    if array.dtype == np.uint8:
        return np.divide(array, 255, dtype=np.float32)
    if array.dtype.kind not in "bf":
        raise TypeError(f"coverage is to be of floats in 0..1, bool or uint8, not {array.dtype}")
    return np.nan_to_num(array.astype(np.float32)).clip(0, 1)


def field(given: Any, shape: "tuple[int, int]") -> "tuple[np.ndarray, np.ndarray, np.ndarray]":
    """The coefficients c0, c2 (complex64) and the confidence (float32) of a field, each of a shape."""
    parts = tuple(given)
    if len(parts) not in (2, 3):
        raise ValueError(f"a field is (c0, c2) or (u, v), and perhaps a confidence, not {len(parts)} arrays")
    first, second = (np.asarray(part) for part in parts[:2])
    if first.dtype.kind == "c":
        c0, c2 = first, second
        defined = np.isfinite(c0) & np.isfinite(c2) & ((c0 != 0) | (c2 != 0))
    else:
        c0, c2, defined = _coefficients(_direction("u", first, shape), _direction("v", second, shape))
    confidence = np.asarray(parts[2], np.float32) if len(parts) == 3 else np.float32(1)
    for name, part in (("c0", c0), ("c2", c2), ("the confidence", np.broadcast_to(confidence, shape))):
        if part.shape != tuple(shape):
            raise ValueError(f"{name} is to be an array of shape {tuple(shape)}, not {part.shape}")
    return c0.astype(np.complex64), c2.astype(np.complex64), (confidence * defined).astype(np.float32)


def _direction(name: str, given: np.ndarray, shape: "tuple[int, int]") -> np.ndarray:
    """Unit directions as complex numbers; NaN where there is none."""
    if given.shape != (*shape, 2):
        raise ValueError(f"{name} is to be an array of shape {(*shape, 2)}, x and y of directions, not {given.shape}")
    with np.errstate(divide="ignore", invalid="ignore"):
        direction = given[..., 0].astype(np.float64) + 1j * given[..., 1]
        return direction / np.abs(direction)


def _coefficients(u: np.ndarray, v: np.ndarray) -> "tuple[np.ndarray, np.ndarray, np.ndarray]":
    """The coefficients of two directions; where there is but one, it stands for both."""
    u, v = np.where(np.isnan(u), v, u), np.where(np.isnan(v), u, v)
    uu, vv = u * u, v * v
    defined = np.isfinite(uu)
    return np.where(defined, uu * vv, 0), np.where(defined, -(uu + vv), 0), defined
