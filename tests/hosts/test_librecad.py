"""DXF, opened and printed by LibreCAD."""

import shutil

import numpy
import pytest
import shapely
from conftest import ALL, LEGEND, call, colors, common, ink, named
from geometry import box, distances, sampled

A4 = numpy.array([210, 297])
DPI = 254
PER_MM = DPI / 25.4


@pytest.fixture
def printed(trace, home, tmp_path):
    """Prints a drawing in the middle of a sheet at a scale, and gives the sheet with ten pixels to a millimetre."""
    def run(drawing, scale):
        # The PDF is written beside the DXF, wherever the command is told to write it.
        shutil.copy(trace(drawing, "dxf"), tmp_path / "drawing.dxf")
        call("librecad", "dxf2pdf", "-c", "-s", scale, "drawing.dxf", env=home, cwd=tmp_path)
        call("pdftoppm", "-r", DPI, "-png", "-singlefile", "drawing.pdf", "sheet", cwd=tmp_path)
        return colors(tmp_path / "sheet.png")

    return run


def on_sheet(svg, unit, scale):
    """Where points of the SVG lie on the sheet, in millimetres from its upper left corner."""
    rings = [numpy.array(ring.coords) for fill in svg.fills for ring in [fill.area.exterior]]
    left, top, right, bottom = box(numpy.concatenate([*svg.lines, *rings]))
    middle = numpy.array([left + right, top + bottom]) / 2
    return lambda points: (points - middle) * unit * scale + A4 / 2


@named(ALL)
def test_ink_is_where_the_svg_has_it(printed, picture, drawing):
    scale = 1 if drawing.dpi else 0.5
    svg = picture(drawing)
    sheet = ink(printed(drawing, scale))
    place = on_sheet(svg, drawing.unit, scale)
    reach = 0.2  # millimetres: two pixels of the sheet
    solid = [s for s in svg.strokes if not s.dashes]
    grown = numpy.zeros_like(sheet)
    for y, x in numpy.ndindex(5, 5):
        grown |= numpy.roll(sheet, (y - 2, x - 2), (0, 1))
    x, y = (place(sampled([s.points for s in solid], 0.5)) * PER_MM).astype(int).T
    assert grown[y, x].mean() > 0.999
    rows, columns = numpy.nonzero(sheet)
    pixels = (numpy.stack([columns, rows], axis=1) + 0.5) / PER_MM
    # Nothing is drawn but strokes of their width, or hairlines where the size is not known, and solid regions.
    away = distances(pixels, [place(s.points) for s in svg.strokes])
    widest = max(s.width for s in svg.strokes) * drawing.unit * scale
    stray = pixels[away > widest / 2 + reach]
    if svg.fills:
        regions = shapely.union_all([shapely.transform(f.area, place) for f in svg.fills]).buffer(reach)
        stray = stray[~shapely.contains_xy(regions, stray)]
    assert len(stray) == 0


def test_pens_have_their_colours(printed, picture):
    pens = picture(LEGEND).layers.values()
    assert common(printed(LEGEND, 1), 1 + len(pens)) == {"#ffffff", *pens}


@pytest.mark.xfail(strict=True, reason="LibreCAD knows line types by its own names alone, and draws others without gaps")
def test_dashes_have_gaps(printed, picture):
    sheet = ink(printed(LEGEND, 1))
    svg = picture(LEGEND)
    place = on_sheet(svg, LEGEND.unit, 1)
    for stroke in (s for s in svg.strokes if s.dashes):
        x, y = (place(sampled([stroke.points], 0.5)) * PER_MM).astype(int).T
        assert 0.4 < sheet[y, x].mean() < 0.9
