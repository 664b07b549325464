"""What vpype does before and after a trace."""

import re

import numpy as np
import pytest
from conftest import all_lines, apart, pen, trace


def test_strokes_are_sorted_and_merged(execute, traced, any_page):
    plain = traced(any_page)
    ordered = execute("trace", any_page, "linesort")
    assert ordered.pen_up_length() <= plain.pen_up_length()
    assert ordered.length() == pytest.approx(plain.length())
    merged = execute("trace", any_page, "linemerge", "-t", "0.5mm", "linesort")
    assert sum(map(len, merged.layers.values())) <= sum(map(len, plain.layers.values()))
    assert apart(all_lines(merged), all_lines(plain)) < 0.5 * 96 / 25.4


def test_what_is_written_is_read_again(execute, page, tmp_path):
    out = tmp_path / "out.svg"
    document = execute("trace", "--solids", "hatch", page, "write", out)
    again = execute("read", out)
    assert np.allclose(again.page_size, document.page_size, rtol=1e-6)
    assert list(again.layers) == list(document.layers)
    for number, layer in document.layers.items():
        other = again.layers[number]
        assert len(other) == len(layer)
        for name in ("vp_name", "vp_color"):
            assert other.property(name) == layer.property(name)
        assert other.property("vp_pen_width") == pytest.approx(layer.property("vp_pen_width"), rel=1e-4)
    assert apart(all_lines(again), all_lines(document)) < 1e-3


def test_plotters_get_their_language(execute, traced, page, tmp_path):
    out = tmp_path / "out.hpgl"
    execute("trace", page, "layout", "a4", "write", "--device", "hp7475a", "--page-size", "a4", out)
    assert set(re.findall(r"SP(\d+);", out.read_text())) >= {str(n) for n in traced(page).layers}


def test_the_program_traces(vpype, page, tmp_path):
    out = tmp_path / "out.svg"
    done = vpype("trace", page, "linesort", "stat", "write", out)
    assert done.returncode == 0, done.stderr
    said = done.stdout.decode()
    layers = {pen(stroke) for stroke in trace(page).strokes}
    assert f"Layer count: {len(layers)}" in said and f"Path count: {len(trace(page))}" in said
    assert out.read_text().count("<g ") == len(layers)


def test_the_program_knows_the_command(vpype):
    assert re.search(r"Input:(\n    .*)*\n    trace +Trace the centrelines", vpype("--help").stdout.decode())
    said = vpype("trace", "--help").stdout.decode()
    assert "--solids [drop|outline|hatch]" in said and "--tolerance LENGTH" in said


def test_blocks_trace_many_files(vpype, page, tmp_path):
    for name in ("one", "two", "three"):
        (tmp_path / f"{name}.png").write_bytes(page.read_bytes())
    done = vpype("forfile", f"{tmp_path}/*.png", "trace", "%_path%", "write", f"{tmp_path}/%_path.stem%.svg", "end")
    assert done.returncode == 0, done.stderr
    done = vpype("forfile", f"{tmp_path}/*.png", "trace", "-l", "%_i+1%", "%_path%", "end", "stat")
    assert done.returncode == 0 and b"Layer count: 3" in done.stdout, done.stderr
    assert {path.stem for path in tmp_path.glob("*.svg")} == {"one", "two", "three"}


def test_options_take_properties(execute, traced, page):
    one = execute("eval", "inches=1", "trace", "--dpi", "%300/inches%", "--detail", "%0.1*2%", page)
    other = traced("--detail", "0.2", page)
    assert one.page_size == pytest.approx(other.page_size, rel=1e-4)
    assert apart(all_lines(one), all_lines(other)) < 0.01
