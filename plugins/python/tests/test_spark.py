"""The example for Spark, run by a local Spark; a minute, `-m cluster`."""

import os
import subprocess
import sys
from pathlib import Path

import icons
import pytest

pytest.importorskip("pyspark")
pyarrow = pytest.importorskip("pyarrow")
from pyarrow import parquet

pytestmark = pytest.mark.cluster
EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "spark_batch.py"


def run(archive, output):
    here = {
        "PYSPARK_PYTHON": sys.executable,
        "PYSPARK_SUBMIT_ARGS": "--master local[2] --conf spark.ui.enabled=false pyspark-shell",
        "SPARK_LOCAL_IP": "127.0.0.1",
    }
    command = [sys.executable, EXAMPLE, archive, output]
    return subprocess.run(command, env={**os.environ, **here}, check=True, stdout=subprocess.PIPE, text=True).stdout


def test_an_archive(tmp_path):
    archive, output = tmp_path / "archive", tmp_path / "drawings"
    for name in ("sheets 1", "sheets 1/more", "done"):
        (archive / name).mkdir(parents=True)
    paths = icons.write(archive / "sheets 1", 300)
    for path in map(Path, paths[200:]):
        path.rename(archive / "sheets 1" / "more" / path.name)

    # A folder that was finished before, and one where Spark was stopped.
    (archive / "done" / "old.png").write_bytes(icons.icon(0))
    old = pyarrow.table({"path": ["old.png"], "drawing": [b"<svg/>"], "error": [""]})
    for folder in ("folder=done", "folder=sheets%201%2Fmore"):
        (output / folder).mkdir(parents=True)
        parquet.write_table(old, output / folder / "part-0.parquet")
    (output / "folder=done" / "_SUCCESS").touch()

    told = run(archive, output)
    rows = [row for file in output.glob("*/*.parquet") for row in parquet.read_table(file, partitioning=None).to_pylist()]
    made = {Path(row["path"]).name: (row["drawing"], row["error"]) for row in rows}
    assert len(rows) == len(made) == 301 and made.pop("old.png") == (b"<svg/>", "")
    assert [made[Path(path).name] for path in paths] == icons.expected(300)
    assert "298 drawings\n" in told and told.count("InputError: ") == 3
