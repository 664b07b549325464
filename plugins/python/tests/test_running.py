"""Threads, processes, signals and the command."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import fieldtrace

posix = pytest.mark.skipif(os.name != "posix", reason="signals and forks are POSIX")

SLOW = """
import sys, time
import numpy as np
import fieldtrace
noise = np.random.default_rng(1).random((3000, 3000))
print("begun", flush=True)
try:
    {work}
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(7)
print("done", flush=True)
"""


def test_threads_trace_the_same_at_once(tracer, samples):
    names = ["kettle.png", "boat.png", "leaf.jpg", "plan.png"]
    one_by_one = [tracer.trace(samples / name) for name in names]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(tracer.trace, [samples / name for name in names])) == one_by_one
        assert list(pool.map(lambda _: fieldtrace.trace(samples / "kettle.png"), range(4))) == one_by_one[:1] * 4
    assert [r.drawing for r in tracer.batch([samples / name for name in names], jobs=4).wait()] == one_by_one


def test_other_threads_run_meanwhile(tracer, samples):
    turns, over = [], threading.Event()

    def count():
        while not over.wait(0.002):
            turns.append(time.monotonic())

    thread = threading.Thread(target=count)
    thread.start()
    begin = time.monotonic()
    tracer.trace(samples / "plan.png")
    end = time.monotonic()
    over.set()
    thread.join()
    assert np.diff([begin, *(t for t in turns if begin < t < end), end]).max() < 0.5 * max(0.2, end - begin)


@posix
@pytest.mark.parametrize(
    "work",
    [
        "fieldtrace.trace(noise)",
        "fieldtrace.Vectorizer(ink='threshold').trace(noise)",
        "list(fieldtrace.batch([noise] * 4, jobs=2))",
        "fieldtrace.trace(noise[:64, :64], ink_estimator=lambda page: time.sleep(60))",
    ],
)
def test_ctrl_c_ends_it(work):
    process = subprocess.Popen([sys.executable, "-c", SLOW.format(work=work)], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(1)
    process.send_signal(signal.SIGINT)
    sent = time.monotonic()
    output, _ = process.communicate(timeout=30)
    assert process.returncode == 7 and output == "interrupted\n"
    # A second or so; more where other programs take the cores.
    assert time.monotonic() - sent < 5


@posix
def test_a_forked_process_traces_too(tracer, grey):
    wanted = tracer.trace(grey)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(tracer.trace, [grey] * 4).get(timeout=60) == [wanted] * 4


def test_a_batch_may_be_left_open_at_exit(samples):
    code = f"import fieldtrace; b = fieldtrace.batch([{str(samples / 'plan.png')!r}] * 100, jobs=2); next(b); print(b)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stdout == "<Batch: 1 of 100 done>\n" and done.stderr == ""


def command(*arguments, **options):
    trace = Path(sys.executable).with_name("trace")
    return subprocess.run([trace, *map(str, arguments)], capture_output=True, text=True, timeout=60, **options)


def test_the_command(samples, tmp_path, kettle):
    out = tmp_path / "kettle.svg"
    assert command(samples / "kettle.png", "-o", out).returncode == 0
    paths = lambda svg: [line for line in svg.splitlines() if "stroke-width" in line]
    assert paths(out.read_text()) == paths(kettle.to_svg())
    assert "trace" in command("--version").stdout and command("--help").returncode == 0
    missing = command("none.png")
    assert missing.returncode == 1 and "none.png" in missing.stderr
    assert command("--nonsense").returncode == 2
    module = subprocess.run([sys.executable, "-m", "fieldtrace", "--version"], capture_output=True, text=True)
    assert module.stdout == command("--version").stdout


def test_the_package_is_typed():
    folder = Path(fieldtrace.__file__).parent
    assert (folder / "py.typed").exists() and (folder / "_native.pyi").exists()
    assert fieldtrace.__version__ and all(hasattr(fieldtrace, name) for name in fieldtrace.__all__)
    public = [fieldtrace.trace, fieldtrace.batch, *vars(fieldtrace.Drawing).values(), *vars(fieldtrace.Stroke).values()]
    for thing in public:
        name = getattr(thing, "__name__", "_")
        assert name.startswith("_") or getattr(thing, "__doc__", None), name
