"""Tracing under one set of options."""

from __future__ import annotations

import functools
import os
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, Optional, Sequence, Tuple, TypedDict, Union

from . import _native
from ._native import Drawing
from .batch import Batch, Result

if TYPE_CHECKING:
    import numpy as np
    from PIL.Image import Image as Picture
    from typing_extensions import Unpack

#: What can be traced: the path of a file, its bytes, an array, or a picture of Pillow.
Image = Union[str, "os.PathLike[str]", bytes, bytearray, memoryview, "np.ndarray", "Picture"]

#: Options that are functions.
_FUNCTIONS = ("ink_estimator", "field_estimator", "on_stage", "on_ink", "on_graph", "on_drawing")


class Options(TypedDict, total=False):
    """The options of a trace, named as those of the command `trace`. `None` is as if not given."""

    preset: Optional[str]
    """'sketch', 'plan' or 'icon': options that suit a kind of drawing; those given beside it override it."""
    ink: Optional[str]
    """How ink is told from what else is on the page: 'auto', 'learned' or 'threshold'."""
    threshold: Union[str, float, None]
    """Darkness from which a pixel is ink: 'auto', or between 0 (paper) and 1 (black)."""
    invert: Union[str, bool, None]
    """Whether the lines are lighter than the ground: 'auto', 'yes', 'no', True or False."""
    despeckle: Optional[int]
    """Remove specks of at most this many pixels."""
    detail: Optional[float]
    """How far a curve may leave the ink's centre, in line widths; less follows closer, with more pieces. 0.1 by default."""
    min_length: Optional[float]
    """Drop strokes shorter than this many line widths, unless they are dots. 0.5 by default."""
    width: Union[str, float, None]
    """Stroke widths: 'pens', 'measured', 'uniform', 'outline' (strokes become solids that keep their taper), 'profile'
    (`Stroke.widths`), or a number of pixels."""
    gap: Union[str, float, None]
    """Bridge breaks of at most this many line widths; 'auto' does so for a pencil's on a scan."""
    dashes: Optional[str]
    """Dashes at even distances: 'keep' each as a stroke, or 'join' them into a dashed one."""
    only: Union[str, Sequence[str], None]
    """Draw only strokes and solids of these colours, such as '#c00000' or 'red'."""
    ignore: Union[str, Sequence[str], None]
    """Leave out strokes and solids of these colours."""
    color_tolerance: Optional[float]
    """How far from a colour of `only` or `ignore` ink may be; black and white are 1 apart. 0.15 by default."""
    without: Union[str, Sequence[str], None]
    """Passes between streamlines and graph that are left out, by their names."""
    estimator: Optional[str]
    """What gives the directions: 'unet', the network, or 'tensor', the structure tensor of the ink."""
    weights: Union[str, "os.PathLike[str]", None]
    """A file with weights of the network in place of its own."""
    device: Optional[str]
    """What runs the network: 'auto' or 'cpu'."""
    page: Optional[int]
    """Read this page alone, counted from 1."""
    crop: Optional[Tuple[int, int, int, int]]
    """Read a part alone: x, y, width and height in pixels of the upright image."""
    dpi: Union[float, Tuple[float, float], None]
    """Dots per inch, or those across and those down, in place of what the input says."""
    size: Optional[int]
    """Pixels along the longer side of the rendering of an SVG or a PDF."""
    max_pixels: Optional[int]
    """Refuse inputs of more pixels than this. 64,000,000 by default."""
    ink_estimator: Optional[Callable[[np.ndarray], Any]]
    """A function that tells ink in place of the network: see `Vectorizer`."""
    field_estimator: Optional[Callable[[np.ndarray, np.ndarray], Any]]
    """A function that gives directions in place of the network: see `Vectorizer`."""
    on_stage: Optional[Callable[[str], Any]]
    """Told of each stage as it begins: see `Vectorizer`."""
    on_ink: Optional[Callable[[np.ndarray], Any]]
    """Sees the ink: see `Vectorizer`."""
    on_graph: Optional[Callable[[Dict[str, Any]], Any]]
    """Sees the stroke graph: see `Vectorizer`."""
    on_drawing: Optional[Callable[[Drawing], Any]]
    """Sees the drawing: see `Vectorizer`."""


class Vectorizer:
    """Traces images under one set of options (`fieldtrace.Options`) from any number of threads; the networks are read once.

    Functions of your own:

    ``ink_estimator(page) -> coverage``
        The share of each pixel that is covered by ink, (H, W): floats in 0..1, bool, or uint8 up to 255. `page` is uint8
        (H, W, 3), RGB, where the image has colours, else float32 (H, W), 0 black to 1 white. It is asked for every page.
        A large scan of broad lines may be reduced before.
    ``field_estimator(darkness, mask) -> (u, v)`` or ``(c0, c2)``
        Two directions for each pixel of the ink. `darkness` is float32 (H, W), 0 on paper and 1 in the middle of a typical
        line, at the size that the strokes are followed at, which need not be the input's; `mask` is bool (H, W), the ink. The
        result is either two real arrays (H, W, 2) of directions, x to the right and y down, whose lengths, signs and order do
        not matter and which are 0 or NaN where there is none; or the complex arrays (H, W) c0 = u^2 v^2 and
        c2 = -(u^2 + v^2), u and v as complex numbers. A confidence in 0..1, (H, W), may follow as a third. Where lines are too
        broad to be traced beside others it is asked twice.
    ``on_stage(name)``
        As a stage begins: 'ink', 'directions', 'strokes', 'curves'.
    ``on_ink(coverage)``
        Sees the coverage by ink, float32 (H, W), where an estimator was asked for it; may give another.
    ``on_graph(graph)``
        Sees the stroke graph, a dict; may give a changed one.
    ``on_drawing(drawing)``
        Sees the drawing; may give another, as of `Drawing.with_strokes`.

    An exception in one of them ends the trace and comes out as it was raised. They run on the thread that asked for the
    trace; in a batch, on threads of its own.
    """

    def __init__(self, **options: "Unpack[Options]") -> None:
        self._functions = {name: options.get(name) for name in _FUNCTIONS if name in options}
        self._options = {name: value for name, value in options.items() if name not in _FUNCTIONS}
        self._tracer = _native.Tracer(self._options, self._functions)

    @property
    def options(self) -> "Dict[str, Any]":
        """The options as they were given."""
        return {**self._options, **self._functions}

    def trace(self, image: Image) -> Drawing:
        """Traces an image: a path, the bytes of a file, an array or a `PIL.Image`.

        Arrays are (H, W), (H, W, 1), (H, W, 2) grey and alpha, (H, W, 3) RGB or (H, W, 4) RGBA, of bool (True is white),
        uint8, uint16, or floats in 0..1, in any layout of memory. OpenCV's BGR is `image[..., ::-1]`.

        A `PIL.Image` is turned upright as its Exif data say, and its `info["dpi"]` is its resolution.
        """
        return self._tracer.trace(image)

    def draw(self, graph: "Dict[str, Any] | str") -> Drawing:
        """The drawing of a stroke graph, such as `Drawing.graph()` gives it: a dict, or its JSON."""
        return self._tracer.draw(graph)

    def ink(self, image: Image) -> np.ndarray:
        """The share of each pixel that is covered by ink, float32 (H, W) in 0..1, as the estimator of ink tells it."""
        return self._tracer.ink(image)

    def field(self, image: Image) -> "Tuple[np.ndarray, np.ndarray, np.ndarray]":
        """The field of directions at the image's size: c0 and c2, complex64 (H, W), and the confidence, float32 (H, W), which
        is 0 where there is no ink."""
        return self._tracer.field(image)

    def batch(
        self,
        inputs: "Image | Iterable[Image]",
        output: "str | os.PathLike[str] | None" = None,
        *,
        jobs: Optional[int] = None,
        recursive: bool = False,
        timeout: Optional[float] = None,
        format: str = "svg",
        force: bool = False,
        write: Optional[Dict[str, Any]] = None,
        on_result: Optional[Callable[[Result], Any]] = None,
    ) -> Batch:
        """Traces many images: see `fieldtrace.batch`."""
        several = _several(inputs)
        number = 0 if jobs is None else jobs
        if number < 0 or number > 1024:
            raise ValueError(f"jobs: {jobs} is not between 0 and 1024")
        if output is None:
            if write or force:
                raise TypeError("write and force are for a batch with an output")
            native = _native.Batch.in_memory(self._tracer, several, recursive, number, timeout)
        else:
            for name in several:
                if not isinstance(name, (str, os.PathLike)):
                    raise TypeError(f"a batch with an output takes paths, not {type(name).__name__}")
            native = _native.Batch.to_files(
                self._options, self._functions, several, output, format, force, recursive, number, timeout, write or {}
            )
        return Batch(native, on_result)

    def __reduce__(self) -> "Tuple[Any, ...]":
        return _vectorizer, (self.options,)

    def __repr__(self) -> str:
        return f"Vectorizer({', '.join(f'{name}={value!r}' for name, value in self.options.items())})"


def _vectorizer(options: "Dict[str, Any]") -> Vectorizer:
    return Vectorizer(**options)


#: Of the options that were used last: reading the networks takes longer than tracing an icon.
_kept = functools.lru_cache(maxsize=4, typed=True)(Vectorizer)


def _shared(options: "Dict[str, Any]") -> Vectorizer:
    """A kept one where the options can be compared."""
    try:
        hash(tuple(options.values()))
    except TypeError:
        return Vectorizer(**options)
    return _kept(**options)


def _several(inputs: Any) -> "list[Any]":
    """One image is a batch of one."""
    single = isinstance(inputs, (str, os.PathLike, bytes, bytearray, memoryview)) or hasattr(inputs, "__array_interface__")
    return [inputs] if single else list(inputs)


def trace(image: Image, **options: "Unpack[Options]") -> Drawing:
    """Traces an image: a path, the bytes of a file, an array or a `PIL.Image` (`Vectorizer.trace`).

    Options are those of `fieldtrace.Options`, named as the command's::

        drawing = fieldtrace.trace("scan.png", preset="sketch", detail=0.2)
        drawing.save("scan.dxf")
    """
    return _shared(dict(options)).trace(image)


def batch(
    inputs: "Image | Iterable[Image]",
    output: "str | os.PathLike[str] | None" = None,
    *,
    jobs: Optional[int] = None,
    recursive: bool = False,
    timeout: Optional[float] = None,
    format: str = "svg",
    force: bool = False,
    write: Optional[Dict[str, Any]] = None,
    on_result: Optional[Callable[[Result], Any]] = None,
    **options: "Unpack[Options]",
) -> Batch:
    """Traces many images, an image at a time on each of `jobs` threads (one for each core), and gives results as they come.

    `inputs` are images as `trace` takes them, or folders and patterns (`'scans/*.tif'`) of files; `recursive` enters folders in
    folders. Without `output`, results have drawings, one for each page. With it, a folder, drawings are written there in a
    `format`, `write` being the options of `Drawing.encode`; a file that is there already, no older than its input and made
    under the same options, is left as it is, and one that this package did not write is an error of its input, unless `force`
    says so.

    What cannot be traced, or takes longer than `timeout` seconds, is a result with an error. `on_result` is called with each
    result before it is given. Nothing is traced before the first result is asked for::

        for result in fieldtrace.batch("scans", "drawings", preset="sketch"):
            print(result.index, result.input, result.error or result.outputs)
    """
    return _shared(dict(options)).batch(
        inputs,
        output,
        jobs=jobs,
        recursive=recursive,
        timeout=timeout,
        format=format,
        force=force,
        write=write,
        on_result=on_result,
    )
