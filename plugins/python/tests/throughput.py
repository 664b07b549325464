"""Images in a second, by the plain batch and by Ray on the same cores: `python throughput.py [NUMBER]`.

Both trace the same files to files, one after the other, twice, since other work may share the machine. Ray's time is given
with and without the start of its workers, which is told by its first files.
"""

import os
import sys
import tempfile
import threading
import time
from pathlib import Path

import icons
import ray

import fieldtrace
import fieldtrace.ray


def plain(paths, output):
    """Seconds."""
    start = time.perf_counter()
    results = fieldtrace.batch(paths, output).wait()
    assert len(results) == len(paths)
    return time.perf_counter() - start


def by_ray(paths, output):
    """Seconds, and those until the first files were written."""
    start, first = time.perf_counter(), []

    def watch():
        while not any(output.glob("*.parquet")):
            time.sleep(0.05)
        first.append(time.perf_counter() - start)

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    assert fieldtrace.ray.batch(paths, output) == len(paths)
    watcher.join()
    return time.perf_counter() - start, first[0]


def main(number=2000):
    """Measures and tells."""
    ray.init(object_store_memory=500_000_000, include_dashboard=False, log_to_driver=False)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scans").mkdir()
        paths = icons.write(folder / "scans", number)
        for turn in range(2):
            seconds = plain(paths, folder / f"plain{turn}")
            print(f"plain batch: {seconds:.1f} s, {number / seconds:.0f} images/s")
            seconds, first = by_ray(paths, folder / f"ray{turn}")
            print(f"Ray: {seconds:.1f} s, {number / seconds:.0f} images/s, first files after {first:.1f} s")
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
