"""Tracing on a Ray cluster; `pip install "fieldtrace[ray]"`.

A dataset of Ray Data, as a step among others::

    import fieldtrace.ray, ray

    scans = ray.data.read_binary_files("scans", include_paths=True)
    fieldtrace.ray.trace(scans, preset="sketch").write_parquet("drawings")

Files, in runs that may be stopped at any time::

    fieldtrace.ray.batch(glob.glob("scans/*.tif"), "drawings", preset="sketch")
"""

from __future__ import annotations

import hashlib
import json
import os
import uuid
from typing import TYPE_CHECKING, Any, Dict, Iterable, Optional, Sequence, Set, Tuple, Type, Union

import numpy as np

from .errors import OptionError
from .vectorizer import Vectorizer

if TYPE_CHECKING:
    from ray.data import Dataset
    from typing_extensions import Unpack

    from .vectorizer import Options

#: Where an image is looked for, in this order.
COLUMNS = ("image", "bytes", "path")

#: Names of files that are being written begin so. Readers of Parquet pass over names with an underscore before.
_DRAFT = "_draft-"

#: Tells what the drawings of a folder were made with.
_MADE_WITH = "_made_with.json"


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
    # What is wrong with the options is said here, not by every worker.
    Vectorizer(**options)
    arguments = (dict(options), column, format, write or {}, keep, cpus, timeout)
    return _mapped(dataset, _Worker, arguments, workers, cpus, batch_size)


def batch(
    files: "Union[str, os.PathLike[str], Iterable[Union[str, os.PathLike[str]]]]",
    output: "Union[str, os.PathLike[str]]",
    *,
    format: str = "svg",
    write: Optional[Dict[str, Any]] = None,
    workers: Union[int, Tuple[int, int], None] = None,
    cpus: int = 1,
    rows: int = 64,
    timeout: Optional[float] = None,
    **options: "Unpack[Options]",
) -> int:
    """Traces files into a folder of Parquet files; called again after a stop, it goes on where it was.

    `files` and `output` are paths that all machines see, or addresses that pyarrow knows, such as 's3://archive/drawings'. The
    folder gets a Parquet file for each `rows` files, with the columns 'path' (absolute), 'drawing', 'strokes', 'error' and
    'seconds': see `trace`, which has the other arguments too.

    A file with a row in `output` is done, be it an error, and is not traced again; the number of those that were traced now is
    returned. Parquet files are there whole or not at all: a stop, even a kill of the driver, loses no more than the `rows`
    files that each worker had in hand, which the next run traces. One run at a time may write to a folder.

    A folder with rows that were made with other options is an `OptionError`. Names that are no UTF-8 cannot be in Parquet files
    and are a `UnicodeEncodeError`.
    """
    import pyarrow
    import ray

    Vectorizer(**options)
    folder, given = _address(output), dict(options)
    paths = [files] if isinstance(files, (str, os.PathLike)) else files
    done = _done(folder, _made_with(format, write or {}, given))
    left = [path for path in dict.fromkeys(map(_address, paths)) if path not in done]
    if not left:
        return 0
    # Ray hands a worker a block at a time. Those of the same files are the same blocks in each run, so that a worker that
    # outlives its run for a moment writes the file that the next run writes as well.
    blocks = [pyarrow.table({"path": left[i : i + rows]}) for i in range(0, len(left), rows)]
    arguments = (folder, given, "path", format, write or {}, ["path"], cpus, timeout)
    return _mapped(ray.data.from_arrow(blocks), _Saver, arguments, workers, cpus, rows).materialize().count()


def _mapped(
    dataset: "Dataset",
    worker: "Type[_Worker]",
    arguments: Tuple[Any, ...],
    workers: Union[int, Tuple[int, int], None],
    cpus: int,
    batch_size: int,
) -> "Dataset":
    """What processes that hold a worker each make of the batches of a dataset."""
    import ray

    least, most = workers if isinstance(workers, tuple) else (1, workers)
    if most is None:
        most = max(1, int(ray.cluster_resources().get("CPU", os.cpu_count() or 1)) // cpus)
    return dataset.map_batches(
        worker,
        fn_constructor_args=arguments,
        compute=ray.data.ActorPoolStrategy(min_size=least, max_size=most),
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


class _Saver(_Worker):
    """Traces batches of rows and writes each as a Parquet file."""

    def __init__(self, folder: str, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.folder = folder

    def __call__(self, rows: Dict[str, np.ndarray]) -> Dict[str, Any]:
        import pyarrow
        from pyarrow import parquet

        content = pyarrow.BufferOutputStream()
        parquet.write_table(pyarrow.table(super().__call__(rows), schema=_schema()), content)
        # The name is that of the paths: where Ray traces a batch again, its file is written again and not a second one.
        name = hashlib.sha256("\n".join(rows["path"]).encode()).hexdigest()[:32]
        _put(self.folder, f"{name}.parquet", content.getvalue())
        return {"path": rows["path"]}


def _schema() -> Any:
    """The columns of the files. They are given since a file without any drawing or error would have others."""
    import pyarrow as pa

    return pa.schema(
        {"path": pa.string(), "drawing": pa.binary(), "strokes": pa.int64(), "error": pa.string(), "seconds": pa.float64()}
    )


def _done(folder: str, made_with: str) -> Set[str]:
    """The paths that have a row in a folder, which is made where it is missing; what stopped runs left half-written goes."""
    from pyarrow import dataset, fs

    store, root = fs.FileSystem.from_uri(folder)
    store.create_dir(root, recursive=True)
    found = {file.base_name: file.path for file in store.get_file_info(fs.FileSelector(root))}
    for name in [name for name in found if name.startswith(_DRAFT)]:
        store.delete_file(found.pop(name))
    whole = [path for name, path in found.items() if name.endswith(".parquet")]
    if _MADE_WITH in found:
        with store.open_input_stream(found[_MADE_WITH]) as file:
            before = file.read().decode()
        if before != made_with:
            raise OptionError(f"{folder}: its drawings were made with {before}, not {made_with}")
    elif whole:
        raise OptionError(f"{folder}: nothing says what its drawings were made with")
    else:
        _put(folder, _MADE_WITH, made_with.encode())
    return set(dataset.dataset(whole, filesystem=store).to_table(["path"])["path"].to_pylist()) if whole else set()


def _made_with(format: str, write: Dict[str, Any], options: Dict[str, Any]) -> str:
    """What drawings depend on, as JSON; functions are told by their names."""
    given = {name: value for name, value in options.items() if value is not None}
    name = lambda value: getattr(value, "__qualname__", str(value))
    return json.dumps({"format": format, "write": write, "options": given}, sort_keys=True, default=name)


def _put(folder: str, name: str, content: Any) -> None:
    """Writes a file that is there whole or not at all."""
    from pyarrow import fs

    store, root = fs.FileSystem.from_uri(folder)
    draft = f"{root}/{_DRAFT}{uuid.uuid4().hex}"
    with store.open_output_stream(draft) as file:
        file.write(content)
    store.move(draft, f"{root}/{name}")


def _address(path: "Union[str, os.PathLike[str]]") -> str:
    """A path that means the same on every machine."""
    path = os.fspath(path)
    return path if "://" in path else os.path.abspath(path)


def _content(image: Any) -> Any:
    """Files as their bytes: of a row, a name is never a folder or a pattern. What cannot be read is the error."""
    if not isinstance(image, str):
        return image
    try:
        with _stored(image) if "://" in image else open(image, "rb") as file:
            return file.read()
    except (OSError, ValueError) as error:
        return error


def _stored(address: str) -> Any:
    """A file of a store, opened."""
    from pyarrow import fs

    store, path = fs.FileSystem.from_uri(address)
    return store.open_input_stream(path)
