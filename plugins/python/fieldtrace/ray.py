"""Tracing Ray Data datasets; `pip install "fieldtrace[ray]"`.

::

    import fieldtrace.ray, ray

    scans = ray.data.read_binary_files("scans", include_paths=True)
    fieldtrace.ray.trace(scans, preset="sketch").write_parquet("drawings")
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Dict, Optional, Sequence, Tuple, Union

import numpy as np

from .vectorizer import Vectorizer

if TYPE_CHECKING:
    from ray.data import Dataset
    from typing_extensions import Unpack

    from .vectorizer import Options

#: Where an image is looked for, in this order.
COLUMNS = ("image", "bytes", "path")


def trace(
    dataset: "Dataset",
    *,
    column: Optional[str] = None,
    format: str = "svg",
    write: Optional[Dict[str, Any]] = None,
    keep: Optional[Sequence[str]] = None,
    workers: Union[int, Tuple[int, int], None] = None,
    cpus: int = 1,
    batch_size: int = 16,
    timeout: Optional[float] = None,
    **options: "Unpack[Options]",
) -> "Dataset":
    """Traces every row of a dataset.

    The images are in `column`, by default the first there is of 'image' (arrays, as of `ray.data.read_images`), 'bytes' (files, as
    of `ray.data.read_binary_files`) and 'path' (names of files, which the workers read). Each worker reads the networks once
    and traces on `cpus` threads; there are as many as there is work for, up to `workers`, by default as the cluster has room
    for. Two numbers are the least and the most: the least must leave room for the tasks that read the dataset.

    Rows keep the columns `keep`, by default all but images and bytes, and get

    - 'drawing': the bytes of a file in a `format`, `write` being the options of `Drawing.encode`; empty where there is none
    - 'strokes': their number
    - 'error': why there is no drawing, empty where there is one
    - 'seconds': how long it took

    An input of several pages is an error unless `page` names one. A row that cannot be traced stops nothing.
    """
    import ray

    # What is wrong with the options is said here, not by every worker.
    Vectorizer(**options)
    least, most = workers if isinstance(workers, tuple) else (1, workers)
    if most is None:
        most = max(1, int(ray.cluster_resources().get("CPU", os.cpu_count() or 1)) // cpus)
    pool = ray.data.ActorPoolStrategy(min_size=least, max_size=most)
    return dataset.map_batches(
        _Worker,
        fn_constructor_args=(dict(options), column, format, write or {}, keep, cpus, timeout),
        compute=pool,
        num_cpus=cpus,
        batch_size=batch_size,
        batch_format="numpy",
        zero_copy_batch=True,
    )


class _Worker:
    """Traces batches of rows under one set of options."""

    def __init__(
        self,
        options: Dict[str, Any],
        column: Optional[str],
        format: str,
        write: Dict[str, Any],
        keep: Optional[Sequence[str]],
        cpus: int,
        timeout: Optional[float],
    ) -> None:
        self.vectorizer = Vectorizer(**options)
        self.column, self.format, self.write = column, format, write
        self.keep, self.cpus, self.timeout = keep, cpus, timeout

    def __call__(self, rows: Dict[str, np.ndarray]) -> Dict[str, Any]:
        column = self.column or next((name for name in COLUMNS if name in rows), None)
        if column not in rows:
            raise KeyError(f"no column of images: {column or ', '.join(COLUMNS)} is not among {', '.join(rows)}")
        keep = [name for name in rows if name not in ("image", "bytes")] if self.keep is None else self.keep
        images = [_content(image) for image in rows[column]]
        batch = self.vectorizer.batch(images, jobs=self.cpus, timeout=self.timeout)
        made = [self._record(result) for result in batch.wait()]
        return {
            **{name: rows[name] for name in keep},
            "drawing": np.array([drawing for drawing, *_ in made], dtype=object),
            "strokes": np.array([strokes for _, strokes, *_ in made], dtype=np.int64),
            "error": np.array([error for *_, error, _ in made], dtype=object),
            "seconds": np.array([seconds for *_, seconds in made]),
        }

    def _record(self, result: Any) -> Tuple[bytes, int, str, float]:
        try:
            if isinstance(result.input, Exception):
                raise result.input
            drawing = result.drawing
            return drawing.encode(self.format, **self.write), len(drawing), "", result.seconds
        except Exception as error:
            return b"", 0, f"{type(error).__name__}: {error}", result.seconds


def _content(image: Any) -> Any:
    """Files as their bytes: of a row, a name is never a folder or a pattern. What cannot be read is the error."""
    if not isinstance(image, str):
        return image
    try:
        with open(image, "rb") as file:
            return file.read()
    except OSError as error:
        return error
