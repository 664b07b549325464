"""SVG, opened by Inkscape and vpype, and drawn by resvg."""

import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import ezdxf
import numpy
import pytest
import vpype
from conftest import ALL, BINARY, KETTLE, LEGEND, SCANS, agreement, call, colors, common, ink
from conftest import named, rendered, same_picture
from geometry import LABEL, SVG, apart, box, read

PIXEL = 96  # dots per inch of CSS
MODE = LABEL.replace("label", "groupmode")


def ways(trace, drawing):
    """The same trace as it may be written."""
    return {
        "plain": trace(drawing, "svg"),
        "paths": trace(drawing, "svg", "--shapes=path"),
        "compressed": trace(drawing, "svgz"),
        "arcs": trace(drawing, "svg", "--curves=arcs"),
    }


@named(ALL)
@pytest.mark.parametrize("way", ["plain", "paths", "compressed"])
def test_inkscape_draws_what_resvg_draws(trace, inkscape, tmp_path, picture, drawing, way):
    svg = ways(trace, drawing)[way]
    width = round(2 * picture(drawing).width)
    inkscape(svg, "--export-type=png", f"--export-filename={tmp_path / 'page.png'}", f"--export-width={width}")
    page = colors(tmp_path / "page.png")
    assert page.shape == (2 * picture(drawing).height, width, 3)
    same_picture(page, rendered(svg, width), picture(drawing).layers.values())


@named(ALL)
def test_each_way_of_writing_draws_the_same_strokes(trace, picture, drawing):
    for way, path in ways(trace, drawing).items():
        other = read(path)
        assert len(other.strokes) == len(picture(drawing).strokes)
        assert [s.width for s in other.strokes] == [s.width for s in picture(drawing).strokes]
        assert apart(other.lines, picture(drawing).lines) < (0.12 if way == "arcs" else 0.02)
        assert way != "paths" or {s.tag for s in other.strokes} == {"path"}


@named([*SCANS, LEGEND])
def test_millimetres_draw_the_same(trace, drawing):
    if drawing.dpi:
        one, other = (rendered(p, 800) for p in (trace(drawing, "svg"), trace(drawing, "svg", "--units=mm")))
        assert agreement(ink(one), ink(other)) > 0.999


@named(ALL)
def test_inkscape_measures_the_same_boxes(trace, inkscape, picture, drawing):
    """Each stroke, its width with it, is where it should be and of the size that the resolution tells."""
    said = [line.split(",") for line in inkscape("--query-all", trace(drawing, "svg")).splitlines()]
    boxes = [(name, numpy.array(numbers, float)) for name, *numbers in said]
    leaves = [b for name, b in boxes if re.match(r"(line|path|circle|rect)\d", name)]
    svg = picture(drawing)
    pixel = PIXEL / drawing.dpi if drawing.dpi else 1
    wanted = []
    for name in svg.layers:
        wanted += [box(numpy.array(f.area.exterior.coords)) for f in svg.fills if f.layer == name]
        for s in (s for s in svg.strokes if s.layer == name):
            # What lies after the last dash is not seen.
            wanted.append(None if s.dashes else box(s.points) + numpy.array([-1, -1, 1, 1]) * s.width / 2)
    assert len(leaves) == len(wanted)
    for (x, y, w, h), there in zip(leaves, wanted):
        # The box of a curve is measured to a part of a pixel.
        assert there is None or numpy.abs(numpy.array([x, y, x + w, y + h]) / pixel - there).max() < 0.1
    assert [name for name, _ in boxes if name.startswith("pen")] == [f"pen{k + 1}" for k in range(len(svg.layers))]


def test_inkscape_knows_each_layer(trace, inkscape, tmp_path, picture):
    """A layer can be drawn alone, and is a layer still in what Inkscape saves."""
    svg = trace(LEGEND, "svg")
    for number, color in enumerate(picture(LEGEND).layers.values(), 1):
        alone = tmp_path / f"{number}.png"
        inkscape(svg, f"--export-id=pen{number}", "--export-id-only", "--export-area-page", "--export-dpi=300",
                 f"--export-filename={alone}")
        assert common(colors(alone), 2) == {"#ffffff", color}
    inkscape(svg, "--export-type=svg", f"--export-filename={tmp_path / 'saved.svg'}")
    groups = list(ET.parse(tmp_path / "saved.svg").iter(f"{SVG}g"))
    assert [g.get(LABEL) for g in groups] == list(picture(LEGEND).layers)
    assert {g.get(MODE) for g in groups} == {"layer"}


@named(SCANS)
def test_what_inkscape_saves_is_read_again(trace, inkscape, tmp_path, picture, drawing):
    """Inkscape keeps the strokes, and a file that it saved is a drawing like any other."""
    saved = tmp_path / "saved.svg"
    inkscape(trace(drawing, "svg"), "--export-type=svg", f"--export-filename={saved}")
    assert agreement(*(ink(rendered(p, 800)) for p in (saved, trace(drawing, "svg")))) > 0.999
    if drawing is KETTLE:
        call(BINARY, "-q", saved, "-o", tmp_path / "again.svg")
        again = read(tmp_path / "again.svg")
        assert abs(again.length * picture(drawing).width / again.width / picture(drawing).length - 1) < 0.02


@named(SCANS)
def test_inkscape_writes_a_dxf_of_paths(trace, inkscape, tmp_path, picture, drawing):
    """Inkscape's own DXF leaves out all but paths, so those are what it is given."""
    inkscape(trace(drawing, "svg", "--shapes=path"), "--export-type=dxf", f"--export-filename={tmp_path / 'out.dxf'}")
    document = ezdxf.readfile(tmp_path / "out.dxf")
    lines = [numpy.array([tuple(e.dxf.start)[:2], tuple(e.dxf.end)[:2]]) for e in document.query("LINE")]
    svg = picture(drawing)
    # Inkscape's unit is the pixel of CSS or the point, by its version: the boxes tell it.
    here, there = (box(numpy.concatenate(sets)) for sets in (lines, svg.lines))
    scale = (here[2] - here[0]) / (there[2] - there[0])
    pixel = PIXEL / drawing.dpi if drawing.dpi else 1
    assert min(abs(scale / (pixel * unit) - 1) for unit in (1, 0.75, 25.4 / 96)) < 0.02
    lines = [(line - [here[0], here[3]]) / scale * [1, -1] + [there[0], there[1]] for line in lines]
    assert apart(lines, svg.lines) < 1.5


@named(ALL)
def test_vpype_has_a_layer_for_each_pen(trace, picture, drawing):
    path = trace(drawing, "svg")
    document = vpype.read_multilayer_svg(str(path), quantization=0.05)
    svg = picture(drawing)
    pixel = PIXEL / drawing.dpi if drawing.dpi else 1
    assert numpy.allclose(document.page_size, [svg.width * pixel, svg.height * pixel], rtol=1e-4)
    assert len(document.layers) == len(svg.layers)
    total = 0
    for name, color in svg.layers.items():
        # The pen's number is what the label begins with.
        layer = document.layers[int(name.split()[0])]
        assert layer.property("vp_name") == name
        mine = [s for s in svg.strokes if s.layer == name]
        widths = {s.width for s in mine}
        fills = [f for f in svg.fills if f.layer == name]
        if not fills:
            assert layer.property("vp_color").as_hex() == color
        if len(widths) == 1 and not fills:
            assert abs(layer.property("vp_pen_width") / pixel - widths.pop()) < 0.01
        # A plotter draws the outlines of solid regions.
        wanted = sum(s.length for s in mine) + sum(f.area.length for f in fills)
        assert abs(layer.length() / pixel / wanted - 1) < 0.01
        total += wanted
        here = [numpy.stack([line.real, line.imag], axis=1) / pixel for line in layer]
        rings = [numpy.array(r.coords) for f in fills for r in [f.area.exterior, *f.area.interiors]]
        assert apart(here, [s.points for s in mine] + rings) < 0.05
    assert abs(document.length() / pixel / total - 1) < 0.01


@pytest.mark.xfail(strict=True, reason="vpype takes from paths what they have in common, and solid regions have no stroke")
def test_vpype_knows_the_colour_of_a_pen_with_solids(trace, picture):
    document = vpype.read_multilayer_svg(str(trace(LEGEND, "svg")), quantization=0.5)
    for number, color in enumerate(picture(LEGEND).layers.values(), 1):
        assert document.layers[number].property("vp_color").as_hex() == color


@named(ALL)
def test_vpype_reads_it_from_its_command_line(trace, tmp_path, picture, drawing):
    said = call(Path(sys.executable).parent / "vpype", "read", trace(drawing, "svg"), "stat", "write", tmp_path / "out.svg")
    assert f"Layer count: {len(picture(drawing).layers)}" in said
    assert (tmp_path / "out.svg").exists()
