"""CSV, read by numpy."""

import numpy
import pytest
from conftest import ALL, ROUNDING, named
from geometry import apart, distances, sampled


def table(path):
    """The numbers, and the colours."""
    numbers = numpy.loadtxt(path, delimiter=",", skiprows=1, usecols=range(4), ndmin=2)
    return numbers, numpy.loadtxt(path, delimiter=",", skiprows=1, usecols=4, dtype=str, comments=None, ndmin=1)


@named(ALL)
@pytest.mark.parametrize("options", [(), ("--step=5",), ("--units=mm",)], ids=["", "steps", "millimetres"])
def test_points_lie_on_the_strokes(trace, picture, drawing, options):
    if "--units=mm" in options and not drawing.dpi:
        pytest.skip("no resolution")
    path = trace(drawing, "csv", *options)
    assert path.read_text().startswith("stroke,x,y,width,color\n")
    numbers, colors = table(path)
    assert len(numbers) == len(colors) and numpy.isfinite(numbers).all()
    unit = drawing.unit if "--units=mm" in options else 1
    step = 5 if "--step=5" in options else 1
    svg = picture(drawing)
    which, points, widths = numbers[:, 0].astype(int), numbers[:, 1:3] / unit, numbers[:, 3] / unit
    assert (numpy.diff(which) >= 0).all() and set(which) == set(range(len(svg.strokes)))
    for number, stroke in enumerate(svg.strokes):
        mine = points[which == number]
        assert distances(mine, [stroke.points]).max() < ROUNDING + 0.001 / unit
        assert numpy.hypot(*numpy.diff(mine, axis=0).T).max(initial=0) < step + ROUNDING
        # A chord of a curve is within it, the less the shorter it is.
        assert distances(sampled([stroke.points], 1), [mine]).max() < (0.1 if step == 1 else 2)
        assert numpy.abs(widths[which == number] - stroke.width).max() < 0.015
        assert set(colors[which == number]) == {stroke.color}
    if step == 1:
        lines = [points[which == k] for k in range(len(svg.strokes))]
        assert apart(lines, svg.lines) < 0.1


@named(ALL)
def test_widths_along_strokes_are_near_their_own(trace, picture, drawing):
    numbers, _ = table(trace(drawing, "csv", "--width=profile"))
    pens = {s.width for s in picture(drawing).strokes}
    assert numpy.median([min(abs(w - p) for p in pens) for w in numbers[:, 3]]) < 0.5
