"""Thousands of images on a local Ray whose processes are killed in the middle; minutes, `-m cluster`."""

import os
import signal
import subprocess
import sys
import threading
import time

import icons
import pytest

ray = pytest.importorskip("ray")
parquet = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("ray.data")

import fieldtrace.ray

pytestmark = pytest.mark.cluster
SMALL = dict(num_cpus=2, object_store_memory=500_000_000, include_dashboard=False)

#: A program of its own, so that it can be killed.
DRIVER = f"""
import sys, pathlib, ray, fieldtrace.ray
ray.init(**{SMALL}, log_to_driver=False)
scans = sorted(pathlib.Path(sys.argv[1]).iterdir())
print("traced", fieldtrace.ray.batch(scans, sys.argv[2], workers=2, rows=16))
"""


@pytest.fixture
def cluster():
    ray.init(**SMALL, log_to_driver=False, configure_logging=False)
    yield
    ray.shutdown()


def files(output):
    return sorted(output.glob("*.parquet"))


def records(output):
    return [row for file in files(output) for row in parquet.read_table(file).to_pylist()]


def check(output, paths):
    """There is one row for each path, and it is what the plain batch makes of the file."""
    rows = {row["path"]: (row["drawing"], row["error"]) for row in records(output)}
    assert sorted(row["path"] for row in records(output)) == sorted(paths)
    for path, wanted in zip(paths, icons.expected(len(paths))):
        assert rows[path] == wanted, path
    assert sum(error.startswith("InputError: ") for _, error in rows.values()) == len(paths) // 100


def wait_for(condition, seconds=300):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.05)


def test_a_killed_worker_loses_and_doubles_nothing(cluster, tmp_path):
    scans, output, workers = tmp_path / "scans", tmp_path / "drawings", tmp_path / "workers"
    scans.mkdir()
    workers.mkdir()
    paths = icons.write(scans, 2000)
    killed = []

    def note(drawing):
        (workers / str(os.getpid())).touch()

    def kill():
        wait_for(lambda: len(files(output)) >= 20 and len(os.listdir(workers)) >= 2)
        worker = int(os.listdir(workers)[0])
        os.kill(worker, signal.SIGKILL)
        killed.append((worker, len(records(output))))

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    assert fieldtrace.ray.batch(paths, output, workers=2, rows=16, on_drawing=note) == 2000
    killer.join()
    [(_, done)] = killed
    assert 320 <= done < 1600, "not in the middle"
    assert len(os.listdir(workers)) >= 3, "no other worker took its place"
    check(output, paths)


def test_a_killed_driver_goes_on_where_it_was(tmp_path):
    scans, output = tmp_path / "scans", tmp_path / "drawings"
    scans.mkdir()
    paths = icons.write(scans, 500)
    start = lambda: subprocess.Popen([sys.executable, "-c", DRIVER, scans, output], stdout=subprocess.PIPE, text=True)

    with start() as driver:
        wait_for(lambda: driver.poll() is not None or len(files(output)) >= 8)
        driver.kill()
    assert driver.returncode == -signal.SIGKILL
    before = {file: file.stat().st_mtime_ns for file in files(output)}
    done = len(records(output))
    assert 0 < done < 400, "not in the middle"

    with start() as driver:
        traced = int(driver.stdout.read().split("traced ")[1])
    assert driver.returncode == 0
    # A worker may end its batch after its driver was killed.
    assert 500 - done - 2 * 16 <= traced <= 500 - done
    assert {file: file.stat().st_mtime_ns for file in before} == before
    check(output, paths)
