"""Ray Data datasets, where Ray is installed."""

import numpy as np
import pytest
from PIL import Image

ray = pytest.importorskip("ray")
pytest.importorskip("ray.data")

import fieldtrace
import fieldtrace.ray


@pytest.fixture(scope="module", autouse=True)
def cluster():
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, configure_logging=False)
    yield
    ray.shutdown()


@pytest.fixture
def folder(grey, tmp_path):
    for i in range(5):
        Image.fromarray(np.roll(grey, i, 1)).save(tmp_path / f"{i}.png")
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\n and no more")
    return tmp_path


def by_name(rows):
    return {row["path"].rsplit("/", 1)[-1]: row for row in rows}


def check(rows, folder):
    rows = by_name(rows)
    assert len(rows) == 6
    for name, row in rows.items():
        if name == "broken.png":
            assert row["error"].startswith("InputError: ") and row["drawing"] == b"" and row["strokes"] == 0
        else:
            drawing = fieldtrace.trace(folder / name)
            assert row["error"] == "" and row["drawing"] == drawing.encode("svg") and row["strokes"] == len(drawing)


def test_files_as_bytes(folder):
    scans = ray.data.read_binary_files(str(folder), include_paths=True)
    traced = fieldtrace.ray.trace(scans, workers=2, batch_size=2)
    check(traced.take_all(), folder)


def test_names_of_files(folder):
    names = [str(path) for path in folder.iterdir()]
    traced = fieldtrace.ray.trace(ray.data.from_items([{"path": name} for name in names]))
    rows = traced.take_all()
    check(rows, folder)
    assert set(rows[0]) == {"path", "drawing", "strokes", "error", "seconds"}
    bad = ray.data.from_items([{"path": name} for name in (str(folder), str(folder / "none*.png"), names[0])])
    errors = {row["path"]: row["error"] for row in fieldtrace.ray.trace(bad).take_all()}
    assert "IsADirectoryError" in errors[str(folder)] and "FileNotFoundError" in errors[str(folder / "none*.png")]
    assert len(errors) == 3


def test_arrays_of_several_sizes(grey):
    items = [{"image": grey, "name": "whole"}, {"image": grey[:60], "name": "part"}]
    traced = fieldtrace.ray.trace(ray.data.from_items(items), format="json", keep=["name"], width=2)
    rows = {row["name"]: row for row in traced.take_all()}
    assert rows["whole"]["strokes"] == len(fieldtrace.trace(grey)) and rows["part"]["drawing"].startswith(b"{")


def test_wrong_use_is_told_at_once(folder):
    scans = ray.data.from_items([{"path": "a.png"}])
    with pytest.raises(TypeError, match="detail"):
        fieldtrace.ray.trace(scans, detial=1)
    with pytest.raises(fieldtrace.OptionError):
        fieldtrace.ray.trace(scans, detail=99)
