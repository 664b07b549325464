"""Solid regions are dropped, outlined or hatched."""

from collections import defaultdict
from functools import reduce

import numpy as np
import pytest
import shapely
from conftest import PIXELS, all_lines, apart, pixel, points, trace
from vpype_fieldtrace.pens import drawn
from vpype_fieldtrace.solids import hatching, lines


def region(rings):
    """What lies within rings by the even-odd rule."""
    areas = [shapely.make_valid(shapely.Polygon(ring)) for ring in rings]
    return reduce(shapely.symmetric_difference, areas)


def star(random, count):
    """A ring about the origin."""
    turns = np.sort(random.uniform(0, 2 * np.pi, count))
    ring = random.uniform(20, 100, (count, 1)) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return np.concatenate([ring, ring[:1]])


@pytest.mark.parametrize("seed", range(40))
def test_hatching_covers_a_region_and_no_more(seed):
    random = np.random.default_rng(seed)
    rings = [star(random, random.integers(3, 30)) for _ in range(random.integers(1, 4))]
    width = random.uniform(0.5, 8)
    area = region(rings)
    strokes = shapely.multilinestrings([shapely.linestrings(line) for line in lines(rings, width, "hatch")])
    assert area.difference(strokes.buffer(width / 2)).area < 0.05 * area.area
    # What is left blank is narrower than the pen.
    assert area.difference(strokes.buffer(1.01 * width)).area < 1e-6
    # A pen that goes along the outline is half beyond it; the hatching is not.
    beyond = area.buffer(1e-6)
    for line in hatching(rings, width):
        assert beyond.contains(shapely.LineString(line).buffer(0.49 * width))
        assert np.ptp(line @ [1, 1]) < 1e-6 or np.ptp(line @ [1, -1]) < 1e-6


def test_what_is_too_thin_for_hatching_is_outlined():
    there_and_back = np.array([[0, 0], [10, 0], [0, 0]], float)
    thin = np.array([[0, 0], [10, 0], [10, 1], [0, 1], [0, 0]], float)
    for ring in (there_and_back, thin):
        assert hatching([ring], 2) == [] and len(lines([ring], 2, "hatch")) == 1


def test_they_are_dropped_unless_asked_for(traced, page):
    drawing = trace(page)
    assert len(drawing.solids) == 2
    for words in ((), ("--solids", "drop")):
        assert sum(len(layer) for layer in traced(*words, page).layers.values()) == len(drawing)


def test_outlines_are_those_of_the_regions(traced, page):
    drawing = trace(page)
    rings = [ring * pixel(drawing) for solid in drawing.solids for ring in solid.rings(0.01)]
    dropped, outlined = traced(page), traced("--solids", "outline", page)
    added = [line for number, layer in outlined.layers.items() for line in layer.lines[len(dropped.layers[number]) :]]
    assert len(added) == len(rings) == 3
    assert all(line[0] == line[-1] for line in added)
    assert apart([points(line) for line in added], rings) < 0.01 * PIXELS / 25.4 + 0.01


def test_hatching_is_within_the_outlines(traced, page):
    outlined, hatched = (traced("--solids", how, page) for how in ("outline", "hatch"))
    drawing = trace(page)
    areas = {solid.color: region([ring * pixel(drawing) for ring in solid.rings()]) for solid in drawing.solids}
    found = set()
    for number, layer in hatched.layers.items():
        color = layer.property("vp_color").as_rgb_hex()
        hatches = [points(line) for line in layer.lines[len(outlined.layers[number]) :]]
        if hatches:
            found.add(color)
            assert areas[color].contains(shapely.multilinestrings(hatches))
    assert found == set(areas) == {"#c00000", "#000000"}


def test_a_pen_of_their_colour_draws_them(traced, page):
    dropped, outlined = (traced("--solids", how, page) for how in ("drop", "outline"))
    more = defaultdict(int)
    for number, layer in outlined.layers.items():
        assert layer.metadata == dropped.layers[number].metadata
        more[layer.property("vp_color").as_rgb_hex()] += len(layer) - len(dropped.layers[number])
    assert {color: count for color, count in more.items() if count} == {"#c00000": 1, "#000000": 2}


def test_solids_of_other_colours_have_pens_of_their_own(page):
    drawing = trace(page)
    blue = [stroke for stroke in drawing.strokes if stroke.color not in ("#c00000", "#000000")]
    for strokes, width in ((blue, blue[0].width), ([], 1)):
        document = drawn(drawing.with_strokes(strokes), 0.1, "hatch")
        new = [layer for layer in document.layers.values() if len(layer) > 1]
        assert {layer.property("vp_color").as_rgb_hex() for layer in new} == {"#c00000", "#000000"}
        assert {layer.property("vp_pen_width") for layer in new} == {width * pixel(drawing)}


def test_a_coarse_tolerance_is_no_error(traced, page):
    assert all_lines(traced("--solids", "hatch", "--tolerance", "100mm", page))
