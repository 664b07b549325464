"""Traces the scans of a folder on all cores of a machine or a cluster: `python ray_batch.py FOLDER OUTPUT`.

Drawings and errors are written to OUTPUT as Parquet files of one row for each scan. Where it was stopped, the same command
goes on. On a cluster both folders are ones that all machines see. Needs `fieldtrace[ray]`.
"""

import sys
from pathlib import Path

import ray

import fieldtrace.ray


def main(folder: str, output: str) -> None:
    """Traces what is left, and tells what there is."""
    scans = sorted(path for path in Path(folder).rglob("*") if path.is_file())
    traced = fieldtrace.ray.batch(scans, output, timeout=120)
    print(f"{traced} traced now, {len(scans) - traced} before")
    records = ray.data.read_parquet(output, columns=["path", "strokes", "error"])
    bad = records.filter(lambda row: row["error"] != "").take_all()
    print(f"{records.count() - len(bad)} drawings with {records.sum('strokes')} strokes")
    for row in bad:
        print(f"{row['path']}: {row['error']}")


if __name__ == "__main__":
    main(*sys.argv[1:3])
