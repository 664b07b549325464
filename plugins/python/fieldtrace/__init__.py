"""Turns raster line drawings into few, smooth, editable centreline strokes with their true widths.

::

    import fieldtrace

    drawing = fieldtrace.trace("scan.png")
    for stroke in drawing.strokes:
        print(stroke.width, stroke.color, stroke.points())
    drawing.save("scan.dxf")

`trace` traces one image, `Vectorizer` many under one set of `Options`, `batch` many in one go. Lengths are in pixels of the
input, x to the right and y down; the upper left corner of the first pixel is (0, 0).
"""

from ._native import Drawing, Solid, Stroke, formats
from ._native import version as _version
from .batch import Batch, Result
from .errors import (
    Cancelled,
    Error,
    ExistingFileError,
    FileError,
    InputError,
    MissingFileError,
    OptionError,
    TimedOut,
)
from .vectorizer import Image, Options, Vectorizer, batch, trace

__version__ = _version()

__all__ = [
    "Batch",
    "Cancelled",
    "Drawing",
    "Error",
    "ExistingFileError",
    "FileError",
    "Image",
    "InputError",
    "MissingFileError",
    "OptionError",
    "Options",
    "Result",
    "Solid",
    "Stroke",
    "TimedOut",
    "Vectorizer",
    "batch",
    "formats",
    "trace",
]
