"""Ray Data datasets, where Ray is installed."""

import os

import numpy as np
import pytest
from PIL import Image

ray = pytest.importorskip("ray")
pytest.importorskip("ray.data")
parquet = pytest.importorskip("pyarrow.parquet")

import fieldtrace
import fieldtrace.ray


@pytest.fixture(scope="module", autouse=True)
def cluster():
    ray.init(num_cpus=2, object_store_memory=500_000_000, include_dashboard=False, log_to_driver=False, configure_logging=False)
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


def test_a_batch_goes_on_where_it_was(folder, tmp_path):
    output = tmp_path / "drawings #1 100%"
    scans = sorted(folder.glob("*.png"))
    run = lambda names, **options: fieldtrace.ray.batch(names, output, rows=2, **options)
    read = lambda: [row for file in sorted(output.glob("*.parquet")) for row in parquet.read_table(file).to_pylist()]

    assert run(scans[:3] + scans[:1]) == 3
    first = read()
    (output / "_draft-of-a-run-that-was-stopped").write_bytes(b"PAR1")
    assert run(scans) == 3 and run(scans, ink=None) == 0
    check(read(), folder)
    assert all(row in read() for row in first)
    assert sorted(file.name for file in output.iterdir() if file.suffix != ".parquet") == ["_made_with.json"]
    names, lost = set(os.listdir(output)), min(output.glob("*.parquet"))
    rows = len(parquet.read_table(lost))
    lost.unlink()
    assert run(scans) == rows and set(os.listdir(output)) == names, "the same rows have another name"
    assert {row["path"] for row in ray.data.read_parquet(str(output)).take_all()} == set(map(str, scans))


def test_rows_of_other_options_are_not_mixed(folder, tmp_path):
    output = tmp_path / "drawings"
    assert fieldtrace.ray.batch(folder / "0.png", output, detail=0.2) == 1
    for other in ({}, {"detail": 0.3}, {"detail": 0.2, "format": "json"}):
        with pytest.raises(fieldtrace.OptionError, match="made with"):
            fieldtrace.ray.batch(folder / "1.png", output, **other)
    (output / "_made_with.json").unlink()
    with pytest.raises(fieldtrace.OptionError, match="nothing says"):
        fieldtrace.ray.batch(folder / "1.png", output, detail=0.2)


def test_addresses(folder, tmp_path):
    output = tmp_path / "drawings"
    scans = [*((folder / name).as_uri() for name in ("0.png", "none.png")), "nowhere://0.png"]
    assert fieldtrace.ray.batch(scans, output.as_uri()) == 3
    rows = {row["path"]: row for file in output.glob("*.parquet") for row in parquet.read_table(file).to_pylist()}
    assert rows[scans[0]]["drawing"] == fieldtrace.trace(folder / "0.png").encode("svg")
    assert rows[scans[1]]["error"].startswith("FileNotFoundError: ") and rows[scans[1]]["drawing"] == b""
    assert "nowhere" in rows[scans[2]]["error"]
