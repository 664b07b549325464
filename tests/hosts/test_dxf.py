"""DXF, read by ezdxf."""

import itertools
from collections import Counter

import ezdxf
import numpy
import pytest
import shapely
from conftest import ALL, BINARY, BOAT, KETTLE, LEGEND, PLAN, ROUNDING, TOLERANCE, call, named
from ezdxf import path as paths
from ezdxf import recover
from geometry import apart, distances, sampled
from PIL import Image, ImageDraw

WEIGHTS = [0, 5, 9, 13, 15, 18, 20, 25, 30, 35, 40, 50, 53, 60, 70, 80, 90, 100, 106, 120, 140, 158, 200, 211]


def flat(entity, step):
    """The points of an entity, and of the corners of curves no further than `step` from it."""
    if entity.dxftype() == "POINT":
        return numpy.array([tuple(entity.dxf.location)[:2]])
    return numpy.array([tuple(p)[:2] for p in paths.make_path(entity).flattening(step)])


def strokes(document):
    return [e for e in document.modelspace() if e.dxftype() != "HATCH"]


def to_file(drawing, picture, points):
    """From pixels with y down to the file's lengths with y up."""
    return numpy.array([0, picture.height * drawing.unit]) + drawing.unit * points * [1, -1]


def pairs(path):
    """Group codes and values."""
    lines = iter(path.read_text("ascii").splitlines())
    return [(int(code), value) for code, value in zip(lines, lines)]


@named(ALL)
@pytest.mark.parametrize("curves", [None, "bezier", "lines"])
def test_nothing_needs_repair(trace, drawing, curves):
    path = trace(drawing, "dxf", *([f"--curves={curves}"] if curves else []))
    for document, found in [(d := ezdxf.readfile(path), d.audit()), recover.readfile(path)]:
        assert document.dxfversion == "AC1018"
        assert not found.errors and not found.fixes, [e.message for e in found.errors + found.fixes]


@named(ALL)
def test_handles_are_unique_and_below_the_next(trace, drawing):
    tags = pairs(trace(drawing, "dxf"))
    assert tags[0][0] == 999 and tags[-1] == (0, "EOF")
    # An arrowhead of a DIMSTYLE has code 5 too; the handle of that table's records is 105.
    first = next(k for k, tag in enumerate(tags) if tag == (2, "TABLES"))
    handles = [int(value, 16) for code, value in tags[first:] if code in (5, 105)]
    assert len(set(handles)) == len(handles)
    seed = tags.index((9, "$HANDSEED"))
    assert max(handles) < int(tags[seed + 1][1], 16)
    owners = {int(value, 16) for code, value in tags[first:] if code == 330}
    assert owners <= {0, *handles}


@named(ALL)
def test_header_tells_unit_and_size(trace, drawing, picture):
    header = ezdxf.readfile(trace(drawing, "dxf")).header
    assert header["$INSUNITS"] == (4 if drawing.dpi else 0)
    assert header["$MEASUREMENT"] == 1
    svg = picture(drawing)
    size = numpy.array([svg.width, svg.height]) * drawing.unit
    assert numpy.allclose(header["$EXTMIN"][:2], 0) and numpy.allclose(header["$EXTMAX"][:2], size, atol=1e-5)
    if drawing.dpi:
        assert numpy.allclose(size, svg.millimetres, atol=1e-3)


@pytest.mark.parametrize("curves", [None, "bezier", "lines"])
@named(ALL)
def test_points_lie_on_the_strokes_of_the_svg(trace, drawing, picture, curves):
    document = ezdxf.readfile(trace(drawing, "dxf", *([f"--curves={curves}"] if curves else [])))
    svg = picture(drawing)
    here = [flat(e, 0.01 * drawing.unit) for e in strokes(document)]
    there = [to_file(drawing, svg, line) for line in svg.lines]
    assert len(here) == len(there)
    limit = (ROUNDING + (0 if curves == "bezier" else TOLERANCE)) * drawing.unit
    assert apart(here, there, drawing.unit) < limit + 0.01 * drawing.unit
    size = numpy.array([svg.width, svg.height]) * drawing.unit
    every = numpy.concatenate(here)
    assert (every >= 0).all() and (every <= size).all()


@named(ALL)
def test_each_stroke_is_an_entity_of_its_own_kind(trace, drawing, picture):
    """Lines, arcs and circles of the SVG stay such, one by one and in the same order."""
    document = ezdxf.readfile(trace(drawing, "dxf"))
    svg = picture(drawing)
    for entity, stroke in zip(strokes(document), svg.strokes, strict=True):
        kind = entity.dxftype()
        assert (kind == "POINT") == stroke.is_dot
        assert (kind == "CIRCLE") == (stroke.tag == "circle")
        assert kind == "LINE" or stroke.tag != "line"
        assert kind == "LWPOLYLINE" or stroke.tag != "rect"
        assert entity.dxf.layer == stroke.layer
        away = distances(sampled([flat(entity, 0.01 * drawing.unit)], drawing.unit),
                         [to_file(drawing, svg, stroke.points)])
        assert away.max() < (ROUNDING + TOLERANCE + 0.01) * drawing.unit
        if kind == "LINE":
            assert (entity.dxf.end - entity.dxf.start).magnitude > 0.01 * drawing.unit


COUNTS = {
    PLAN: {"LINE": 14, "LWPOLYLINE": 12, "CIRCLE": 1},
    KETTLE: {"LINE": 3, "LWPOLYLINE": 7, "ARC": 1},
    BOAT: {"LINE": 8, "LWPOLYLINE": 11, "CIRCLE": 1},
    LEGEND: {"LINE": 4, "LWPOLYLINE": 1, "CIRCLE": 1, "POINT": 3, "HATCH": 2},
}


@named(ALL)
def test_kinds(trace, drawing, picture):
    def kinds(*options):
        return Counter(e.dxftype() for e in ezdxf.readfile(trace(drawing, "dxf", *options)).modelspace())

    plain, bezier, lines = kinds(), kinds("--curves=bezier"), kinds("--curves=lines")
    assert plain == COUNTS[drawing]
    assert "SPLINE" not in plain
    # What is made of lines and arcs stays so.
    assert bezier["SPLINE"] == {PLAN: 0, KETTLE: 7, BOAT: 11, LEGEND: 0}[drawing]
    assert set(lines) <= {"LINE", "LWPOLYLINE", "POINT", "HATCH"}
    assert plain.total() == bezier.total() == lines.total() == len(picture(drawing).strokes + picture(drawing).fills)


def test_edges_of_the_plan_are_lines_and_arcs(trace):
    document = ezdxf.readfile(trace(PLAN, "dxf"))
    bulges = Counter()
    for e in document.query("LWPOLYLINE"):
        bulges.update(abs(round(bulge, 2)) for *_, bulge in e.get_points("xyb"))
    # Two doors, each with a quarter of a circle.
    assert sum(n for bulge, n in bulges.items() if bulge > 0) <= 4
    sides = [e for e in document.query("LWPOLYLINE") if e.closed and len(e) == 4]
    assert len(sides) >= 6
    for e in sides:
        for (x0, y0), (x1, y1) in itertools.pairwise([p[:2] for p in e.get_points("xy")]):
            assert min(abs(x1 - x0), abs(y1 - y0)) < 0.02


@named(ALL)
def test_layers_have_names_and_true_colours(trace, drawing, picture):
    document = ezdxf.readfile(trace(drawing, "dxf"))
    layers = {l.dxf.name: l for l in document.layers if l.dxf.name not in ("0", "Defpoints")}
    wanted = picture(drawing).layers
    assert list(layers) == list(wanted)
    for number, (name, color) in enumerate(wanted.items(), 1):
        assert name == f"{number} Pen {color}"
        assert "#%02x%02x%02x" % tuple(layers[name].rgb) == color
        assert layers[name].is_on() and not layers[name].is_locked()
    assert {e.dxf.layer for e in document.modelspace()} == set(wanted)


@named(ALL)
def test_line_weights_are_the_nearest(trace, drawing, picture):
    document = ezdxf.readfile(trace(drawing, "dxf"))
    for entity, stroke in zip(strokes(document), picture(drawing).strokes, strict=True):
        if not drawing.dpi:
            assert not entity.dxf.hasattr("lineweight")
            continue
        width = 100 * stroke.width * drawing.unit
        away = abs(entity.dxf.lineweight - width)
        assert away <= min(abs(w - width) for w in WEIGHTS) + 1


def test_dashes_are_line_types(trace, picture):
    document = ezdxf.readfile(trace(LEGEND, "dxf"))
    assert document.header["$LTSCALE"] == 1
    dashed = 0
    for entity, stroke in zip(strokes(document), picture(LEGEND).strokes, strict=True):
        assert (entity.dxf.linetype == "BYLAYER") == (not stroke.dashes)
        if stroke.dashes:
            dashed += 1
            tags = document.linetypes.get(entity.dxf.linetype).pattern_tags.tags
            lengths = [value for code, value in tags if code == 49]
            wanted = numpy.array(stroke.dashes) * LEGEND.unit * [1, -1]
            assert numpy.allclose(lengths, wanted, atol=0.006)
            total = next(value for code, value in tags if code == 40)
            assert abs(total - numpy.abs(lengths).sum()) < 1e-6
            assert next(value for code, value in tags if code == 73) == 2
    assert dashed == 2


def test_dashes_do_not_drift(trace, picture):
    """The last dash of a line of twenty lies where it was drawn."""
    document = ezdxf.readfile(trace(LEGEND, "dxf"))
    for entity, stroke in zip(strokes(document), picture(LEGEND).strokes, strict=True):
        if stroke.dashes:
            period = sum(stroke.dashes) * LEGEND.unit
            tags = document.linetypes.get(entity.dxf.linetype).pattern_tags.tags
            here = next(value for code, value in tags if code == 40)
            repeats = stroke.length / sum(stroke.dashes)
            assert abs(here - period) * repeats < 0.02


def test_solids_are_hatches(trace, picture):
    document = ezdxf.readfile(trace(LEGEND, "dxf"))
    hatches = list(document.query("HATCH"))
    fills = picture(LEGEND).fills
    assert len(hatches) == len(fills) == 2
    for hatch, fill in zip(hatches, fills):
        assert hatch.dxf.solid_fill == 1 and hatch.dxf.pattern_name == "SOLID"
        assert hatch.dxf.layer == fill.layer
        area = shapely.Polygon()
        for ring in hatch.paths:
            area = area.symmetric_difference(shapely.Polygon([v[:2] for v in ring.vertices]))
        wanted = shapely.transform(fill.area, lambda p: to_file(LEGEND, picture(LEGEND), p))
        limit = (TOLERANCE + ROUNDING) * LEGEND.unit
        assert area.buffer(limit).contains(wanted) and wanted.buffer(limit).contains(area)
        assert abs(area.area / wanted.area - 1) < 3e-3
    assert [len(h.paths) for h in hatches] == [1, 2]


def test_no_line_is_without_length(tmp_path):
    times = 4
    page = Image.new("RGB", (400 * times, 300 * times), "white")
    pen = ImageDraw.Draw(page)

    def line(*corners, color="black"):
        pen.line([v * times for v in corners], fill=color, width=3 * times)

    def disc(x, y, radius, **how):
        pen.ellipse([v * times for v in (x - radius, y - radius, x + radius, y + radius)], **how)

    for x in range(40, 360, 20):
        line(x, 60, x + 12, 60)
        line(x, 100, x + 12, 100, color="#c00000")
    line(40, 140, 360, 140, color="#0000c0")
    disc(100, 220, 40, fill="black")
    disc(100, 220, 15, fill="white")
    pen.rectangle([v * times for v in (200, 180, 260, 260)], fill="#c00000")
    disc(320, 220, 20, outline="black", width=3 * times)
    for y in (185, 255):
        disc(320, y, 2, fill="black")
    page.resize((400, 300), Image.Resampling.LANCZOS).save(tmp_path / "page.png")
    call(BINARY, "-q", tmp_path / "page.png", "--dpi=150", "--dashes=join", "-o", tmp_path / "page.dxf")
    lines = ezdxf.readfile(tmp_path / "page.dxf").query("LINE")
    assert lines and min((e.dxf.end - e.dxf.start).magnitude for e in lines) > 0
