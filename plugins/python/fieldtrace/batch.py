"""Results of many traces as they come."""

from __future__ import annotations

import atexit
import warnings
import weakref
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, List, Optional

if TYPE_CHECKING:
    from ._native import Drawing


@dataclass(frozen=True)
class Result:
    """What became of one input of a batch."""

    index: int
    """Its place among the inputs, folders and patterns being the files that they stand for."""
    input: Any = field(repr=False)
    """The input."""
    drawings: "List[Drawing]" = field(default_factory=list)
    """A drawing for each page, where there is no output."""
    outputs: List[Path] = field(default_factory=list)
    """The files that were written, one for each page."""
    strokes: Optional[int] = None
    """Number of strokes on all pages."""
    skipped: bool = False
    """Whether there was an output already."""
    error: Optional[BaseException] = None
    """Why there is no drawing."""
    seconds: float = 0.0
    """How long it took."""

    @property
    def ok(self) -> bool:
        """Whether there is no error."""
        return self.error is None

    @property
    def drawing(self) -> "Drawing":
        """The drawing of an input of one page; raises the error where there is none."""
        if self.error is not None:
            raise self.error
        if len(self.drawings) != 1:
            raise ValueError(f"there are {len(self.drawings)} drawings, not one")
        return self.drawings[0]


class Batch:
    """The results of `fieldtrace.batch`, an iterator. `len` is the number of inputs, so that progress bars know it.

    Leaving a loop early is followed by `close`, which a `with` does by itself.
    """

    def __init__(self, native: Any, on_result: "Optional[Callable[[Result], Any]]") -> None:
        self._native, self._on_result = native, on_result
        self._begun = False
        self.done = 0
        """Number of results that were given."""

    @property
    def others(self) -> int:
        """Number of files of folders that are left out because they are of no kind that is read."""
        return self._native.others

    def __len__(self) -> int:
        return self._native.total

    def __iter__(self) -> "Batch":
        return self

    def __next__(self) -> Result:
        if not self._begun:
            self._begun = True
            _running.add(self)
        record = self._native.next()
        if record is None:
            _running.discard(self)
            raise StopIteration
        result = Result(*record)
        self.done += 1
        if self._on_result is not None:
            self._on_result(result)
        return result

    def wait(self) -> List[Result]:
        """All results that are left, in the order of the inputs."""
        return sorted(self, key=lambda result: result.index)

    def close(self) -> None:
        """Stops the batch: what is being traced is given up, and nothing else is begun."""
        self._begun = True
        self._native.close()
        _running.discard(self)

    def __enter__(self) -> "Batch":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        native = getattr(self, "_native", None)
        if native is None:
            return
        if not self._begun:
            warnings.warn("nothing was traced: no result of the batch was asked for", RuntimeWarning, stacklevel=2)
        native.close()

    def __repr__(self) -> str:
        return f"<Batch: {self.done} of {len(self)} done>"


_running: "weakref.WeakSet[Batch]" = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    """Threads must not outlive the interpreter."""
    for batch in list(_running):
        batch.close()
