"""Traces the scans of a folder on all cores of a machine or a cluster: `python ray_batch.py FOLDER OUTPUT`.

Drawings and errors are written to OUTPUT as Parquet files of one row for each scan. Needs `fieldtrace[ray]`.
"""

import sys

import ray

import fieldtrace.ray


def main(folder: str, output: str) -> None:
    """Reads, traces, writes."""
    scans = ray.data.read_binary_files(folder, include_paths=True)
    drawings = fieldtrace.ray.trace(scans, timeout=120).materialize()
    drawings.write_parquet(output)
    bad = drawings.filter(lambda row: row["error"] != "").take_all()
    print(f"{drawings.count() - len(bad)} drawings with {drawings.sum('strokes')} strokes")
    for row in bad:
        print(f"{row['path']}: {row['error']}")


if __name__ == "__main__":
    main(*sys.argv[1:3])
