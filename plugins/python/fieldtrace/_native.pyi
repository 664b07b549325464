import os
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

class Stroke:
    """A line of a drawing: its centreline, and the pen that drew it. Lengths are in pixels of the input, y points down."""

    def points(self, tolerance: float = 0.1) -> NDArray[np.float64]:
        """Points on the centreline, shape (n, 2), x before y: no point of the line is further from the polyline than
        `tolerance` pixels. A closed stroke ends with its first point; a dot has one point."""
    @property
    def beziers(self) -> NDArray[np.float64]:
        """The centreline as cubic Bezier curves, shape (k, 4, 2): start, two control points and end of each."""
    @property
    def width(self) -> float:
        """Width of the pen."""
    @property
    def widths(self) -> Optional[NDArray[np.float64]]:
        """Widths at even distances along the centreline, shape (m,), where the trace was asked for width='profile'."""
    @property
    def color(self) -> str:
        """Colour of the ink as '#rrggbb'."""
    @property
    def closed(self) -> bool:
        """Whether the line ends where it starts."""
    @property
    def kind(self) -> str:
        """'path', 'circle' or 'dot'."""
    @property
    def length(self) -> float:
        """Length of the centreline."""
    @property
    def dashes(self) -> Optional[Tuple[float, float, float]]:
        """Of a dashed line, the lengths of a dash and of a gap, and how far into the pattern the line starts."""

class Solid:
    """A solid region of a drawing, too wide to be a line; inside by the even-odd rule."""

    def rings(self, tolerance: float = 0.1) -> List[NDArray[np.float64]]:
        """The outlines, of the region and of the holes in it, each of shape (n, 2), its last point its first."""
    @property
    def color(self) -> str:
        """Colour of the ink as '#rrggbb'."""

class Drawing:
    """A drawing: lines and solid regions, in pixels of the input."""

    @property
    def width(self) -> float:
        """Width of the canvas in pixels."""
    @property
    def height(self) -> float:
        """Height of the canvas in pixels."""
    @property
    def dpi(self) -> Optional[float]:
        """Dots per inch, where the input told."""
    @property
    def strokes(self) -> List[Stroke]:
        """The lines."""
    @property
    def solids(self) -> List[Solid]:
        """The solid regions, painted before the lines."""
    def graph(self) -> Dict[str, Any]:
        """The stroke graph: what the format json holds, and `Vectorizer.draw` takes."""
    def with_strokes(self, strokes: Sequence[Stroke]) -> Drawing:
        """The same drawing with other strokes, such as some of its own. It has no graph."""
    def to_svg(
        self,
        *,
        units: Optional[str] = None,
        precision: Optional[int] = None,
        shapes: Optional[str] = None,
        curves: Optional[str] = None,
        tolerance: Optional[float] = None,
        title: Optional[str] = None,
    ) -> str:
        """SVG text. `units` are 'px' or 'mm', `precision` decimals, `shapes` 'plain' or 'path', `curves` 'bezier', 'arcs' or
        'lines', `tolerance` pixels, for arcs and lines."""
    def encode(
        self,
        format: str,
        *,
        units: Optional[str] = None,
        precision: Optional[int] = None,
        shapes: Optional[str] = None,
        curves: Optional[str] = None,
        tolerance: Optional[float] = None,
        step: Optional[float] = None,
        title: Optional[str] = None,
    ) -> bytes:
        """The bytes of a file in a format, one of `fieldtrace.formats()`. `step` is for CSV: pixels between points."""
    def save(
        self,
        path: Union[str, "os.PathLike[str]"],
        format: Optional[str] = None,
        *,
        units: Optional[str] = None,
        precision: Optional[int] = None,
        shapes: Optional[str] = None,
        curves: Optional[str] = None,
        tolerance: Optional[float] = None,
        step: Optional[float] = None,
        title: Optional[str] = None,
    ) -> None:
        """Writes a file, whole or not at all: in the format of its extension, or that of a name."""
    def _repr_svg_(self) -> str: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Stroke]: ...

class Tracer:
    def __new__(cls, options: Dict[str, Any], functions: Dict[str, Any]) -> Tracer: ...
    def trace(self, image: Any) -> Drawing: ...
    def draw(self, graph: Union[Dict[str, Any], str]) -> Drawing: ...
    def ink(self, image: Any) -> NDArray[np.float32]: ...
    def field(
        self, image: Any
    ) -> Tuple[NDArray[np.complex64], NDArray[np.complex64], NDArray[np.float32]]: ...

class Batch:
    @staticmethod
    def in_memory(
        tracer: Tracer, inputs: List[Any], recursive: bool, jobs: int, timeout: Optional[float]
    ) -> Batch: ...
    @staticmethod
    def to_files(
        options: Dict[str, Any],
        functions: Dict[str, Any],
        inputs: List[Any],
        folder: Any,
        format: str,
        force: bool,
        recursive: bool,
        jobs: int,
        timeout: Optional[float],
        write: Dict[str, Any],
    ) -> Batch: ...
    def next(self) -> Optional[Tuple[Any, ...]]: ...
    def close(self) -> None: ...
    @property
    def total(self) -> int: ...
    @property
    def others(self) -> int: ...

def formats() -> List[str]:
    """The names of the formats that drawings are written in."""

def version() -> str:
    """The version of the package."""

def main(args: List[str]) -> int:
    """Runs the command on arguments, of which the first is the program's name, and gives its exit code."""
