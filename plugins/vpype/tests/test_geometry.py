"""Sizes and places of strokes."""

import numpy as np
import pytest
import vpype as vp
from conftest import DPI, PIXELS, all_lines, apart, curves, draw, pixel, trace

MM = PIXELS / 25.4


@pytest.mark.parametrize("tolerance", [0.005, 0.3])
def test_strokes_lie_on_the_curves(traced, any_page, tolerance):
    document = traced("--tolerance", f"{tolerance}mm", any_page)
    drawing = trace(any_page)
    counts = [len(stroke.points(tolerance * MM / pixel(drawing))) - 1 for stroke in drawing.strokes]
    # A dot is a segment.
    assert document.segment_count() == sum(max(count, 1) for count in counts)
    ours = [line for line in all_lines(document) if np.ptp(line, axis=0).max() > 0.01 * pixel(drawing) + 1e-9]
    # Polylines of fieldtrace may leave a curve by half more than their tolerance.
    assert apart(ours, list(curves(drawing))) < 1.6 * tolerance * MM + 0.01


def test_a_greater_tolerance_takes_fewer_segments(traced, any_page):
    counts = [traced("-t", f"{t}mm", any_page).segment_count() for t in (0.001, 0.1, 3)]
    assert counts == sorted(counts, reverse=True) and counts[0] > 2 * counts[-1]


def test_strokes_lie_where_vpype_reads_those_of_the_svg(traced, any_page, tmp_path):
    trace(any_page).save(tmp_path / "page.svg")
    svg = vp.read_multilayer_svg(str(tmp_path / "page.svg"), quantization=0.2)
    # Of filled regions, vpype reads the outlines.
    document = traced("--solids", "outline", any_page)
    assert np.allclose(document.page_size, svg.page_size, rtol=1e-4)
    assert document.length() == pytest.approx(svg.length(), rel=1e-3)
    # The SVG has two decimals of a pixel of the image.
    assert apart(all_lines(document), all_lines(svg)) < 0.01 * MM + 0.02


def test_strokes_lie_on_the_page(traced, any_page):
    document = traced(any_page)
    left, top, right, bottom = document.bounds()
    width, height = document.page_size
    assert 0 <= left < right <= width and 0 <= top < bottom <= height


def test_dots_are_kept(traced, page):
    dots = [stroke.points()[0] * PIXELS / DPI for stroke in trace(page).strokes if stroke.kind == "dot"]
    lines = [line for line in all_lines(traced(page)) if len(line) == 2 and np.ptp(line, axis=0).max() < 0.01]
    assert len(dots) == len(lines) == 3
    assert np.allclose(sorted(map(tuple, dots)), sorted(tuple(line[0]) for line in lines))
    assert all(line[0, 0] < line[1, 0] for line in lines)


@pytest.mark.parametrize("dpi", [72, 300, 1200])
def test_the_page_has_its_true_size(traced, tmp_path, dpi):
    path = tmp_path / "page.png"
    draw(path, dpi=(dpi, dpi))
    millimetres = np.array(traced(path).page_size) / MM
    # A PNG has whole dots per metre.
    assert millimetres == pytest.approx([300 / dpi * 25.4, 200 / dpi * 25.4], rel=1e-3)


def test_without_a_resolution_pixels_are_those_of_vpype(traced, tmp_path):
    path = tmp_path / "page.png"
    draw(path)
    document = traced(path)
    assert document.page_size == (300, 200)
    # The resolution scales what is traced, and no more.
    for dpi in (50, 777):
        scaled = traced("--dpi", dpi, "-t", f"{0.01 * 96 / dpi}mm", path)
        scaled.scale(dpi / 96)
        assert apart(all_lines(document), all_lines(scaled)) < 0.02 * MM
        for one, other in zip(document.layers.values(), scaled.layers.values(), strict=True):
            assert other.property("vp_pen_width") == pytest.approx(one.property("vp_pen_width") * 96 / dpi)


def test_pixels_that_are_no_squares(traced, page):
    document = traced("--dpi", "300,150", page)
    assert np.array(document.page_size) / MM == pytest.approx([25.4, 33.87], abs=0.01)


def test_the_standard_input_is_a_file_like_others(execute, traced, vpype, page, tmp_path):
    out = tmp_path / "out.svg"
    done = vpype("trace", "-", "write", out, input=page.read_bytes())
    assert done.returncode == 0, done.stderr
    assert all_lines(execute("read", out)) and apart(all_lines(execute("read", out)), all_lines(traced(page))) < 1e-3
