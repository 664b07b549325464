"""Many images in one go."""

import gc
import shutil
import time

import numpy as np
import pytest
from PIL import Image

import fieldtrace


@pytest.fixture
def folder(grey, tmp_path):
    scans = tmp_path / "scans"
    (scans / "deep").mkdir(parents=True)
    for i in range(4):
        Image.fromarray(np.roll(grey, i, 1)).save(scans / f"{i}.png")
    shutil.copy(scans / "0.png", scans / "deep" / "4.png")
    (scans / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\n and no more")
    (scans / "notes.txt").write_text("not an image")
    return scans


def test_drawings_in_memory(grey, tmp_path, tracer):
    path = tmp_path / "a.png"
    Image.fromarray(grey).save(path)
    inputs = [grey, path, str(path), path.read_bytes(), Image.open(path), "none.png", None, b"junk"]
    seen = []
    batch = fieldtrace.batch(inputs, jobs=2, on_result=seen.append)
    assert len(batch) == 8 and batch.done == 0
    results = list(batch)
    assert results == seen and batch.done == 8 and sorted(r.index for r in results) == list(range(8))
    wanted = tracer.trace(grey)
    for result in results:
        assert result.input is inputs[result.index] and not result.outputs and not result.skipped
        if result.index < 5:
            assert result.ok and result.drawing == wanted and result.strokes == len(wanted) and result.seconds > 0
        else:
            kind = {5: FileNotFoundError, 6: TypeError, 7: fieldtrace.InputError}[result.index]
            assert not result.ok and isinstance(result.error, kind) and not result.drawings
            with pytest.raises(kind):
                result.drawing


def test_folders_and_patterns(folder):
    results = fieldtrace.batch(folder).wait()
    assert [r.input.rsplit("/", 1)[-1] for r in results] == ["0.png", "1.png", "2.png", "3.png", "broken.png"]
    assert [r.ok for r in results] == [True] * 4 + [False]
    assert len(fieldtrace.batch(folder, recursive=True).wait()) == 6
    assert len(fieldtrace.batch([f"{folder}/[01].png", folder / "deep"]).wait()) == 3
    with pytest.raises(fieldtrace.OptionError):
        fieldtrace.batch(str(folder / "*.jpg"))


def test_files(folder, tmp_path):
    out = tmp_path / "drawings"
    batch = fieldtrace.batch(folder, out, recursive=True, format="dxf", write={"precision": 3}, detail=0.2)
    assert batch.others == 1
    results = batch.wait()
    assert [r.ok for r in results].count(True) == 5 and all(not r.drawings for r in results)
    written = [path for r in results for path in r.outputs]
    assert all(path.exists() for path in written) and out / "deep" / "4.dxf" in written
    again = fieldtrace.batch(folder, out, recursive=True, format="dxf", write={"precision": 3}, detail=0.2).wait()
    assert [r.skipped for r in again].count(True) == 5
    other = fieldtrace.batch(folder, out, recursive=True, format="dxf", detail=0.3).wait()
    assert not any(r.skipped for r in other)
    (out / "0.dxf").write_text("mine")
    mine = fieldtrace.batch(folder / "0.png", out, format="dxf").wait()[0]
    assert isinstance(mine.error, FileExistsError) and (out / "0.dxf").read_text() == "mine"
    assert fieldtrace.batch(folder / "0.png", out, format="dxf", force=True).wait()[0].ok


def test_pages(tmp_path, grey):
    path = tmp_path / "pages.tif"
    pages = [Image.fromarray(grey), Image.fromarray(grey[::-1])]
    pages[0].save(path, save_all=True, append_images=pages[1:])
    (result,) = fieldtrace.batch(path)
    assert len(result.drawings) == 2
    with pytest.raises(ValueError, match="2 drawings"):
        result.drawing
    with pytest.raises(fieldtrace.InputError, match=r"2 pages \(name one with page\)"):
        fieldtrace.trace(path)
    (result,) = fieldtrace.batch(path, page=2)
    assert result.drawing == fieldtrace.trace(path, page=2) == fieldtrace.trace(pages[1])
    (result,) = fieldtrace.batch(path, tmp_path / "out")
    assert [p.name for p in result.outputs] == ["pages-1.svg", "pages-2.svg"]


def test_wrong_use(grey, folder):
    for wrong in ({"jobs": -1}, {"timeout": 0}, {"detail": 5}):
        with pytest.raises(ValueError):
            fieldtrace.batch([grey], **wrong)
    for wrong in ({"force": True}, {"nothing": 1}, {"output": "out"}):
        with pytest.raises(TypeError):
            fieldtrace.batch([grey], **wrong)
    with pytest.raises(TypeError, match="on_graph"):
        fieldtrace.batch(folder, "out", on_graph=print)
    with pytest.raises(fieldtrace.OptionError, match="format"):
        fieldtrace.batch(folder, "out", format="doc")


def test_an_image_that_takes_too_long(grey):
    slow = lambda page: time.sleep(0.2) or 1 - page
    (result,) = fieldtrace.batch([grey], ink_estimator=slow, timeout=0.1)
    assert isinstance(result.error, TimeoutError)


def test_leaving_early_stops_the_rest(samples):
    begun = []
    with fieldtrace.batch([samples / "plan.png"] * 200, jobs=2, on_stage=begun.append) as batch:
        next(batch)
    started = time.monotonic()
    assert begun.count("ink") < 100 and batch.done == 1
    assert list(batch) == [] and time.monotonic() - started < 1
    batch = fieldtrace.batch([samples / "plan.png"] * 200, jobs=2)
    next(batch)
    del batch
    gc.collect()


def test_a_batch_that_is_never_asked_warns(grey):
    with pytest.warns(RuntimeWarning, match="nothing was traced"):
        fieldtrace.batch([grey])
        gc.collect()


def test_an_exception_of_on_result_comes_out(grey):
    def refuse(result):
        raise KeyError(result.index)

    with pytest.raises(KeyError):
        list(fieldtrace.batch([grey] * 50, on_result=refuse))
