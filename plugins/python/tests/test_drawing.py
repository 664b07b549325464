"""What comes out of a trace."""

import io
import json
import pickle
import re

import numpy as np
import pytest
import svgelements

import fieldtrace


def lines(svg):
    """Points along every path of an SVG."""
    paths = [e for e in svgelements.SVG.parse(io.StringIO(svg)).elements() if isinstance(e, svgelements.Path)]
    t = np.linspace(0, 1, 60)
    piece = lambda piece: np.array([[p.x, p.y] for p in map(piece.point, t)])
    return [np.concatenate([piece(p) for p in path if not isinstance(p, svgelements.Move)]) for path in paths]


def away(points, polylines):
    """How far the points are at most from the nearest of some polylines."""
    starts = np.concatenate([line[:-1] for line in polylines])
    along = np.concatenate([np.diff(line, axis=0) for line in polylines])
    offset = points[:, None] - starts[None]
    share = (offset * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-12)
    return np.linalg.norm(offset - share.clip(0, 1)[..., None] * along, axis=-1).min(1).max()


def test_points_lie_on_the_svg(kettle):
    drawn = [path for path in lines(kettle.to_svg(shapes="path", precision=6)) if len(path)]
    assert len(drawn) == len(kettle) > 5
    for stroke in kettle.strokes:
        assert away(stroke.points(0.01), drawn) < 0.03


def test_points_follow_the_curves_to_the_tolerance(kettle):
    for stroke in kettle.strokes:
        fine, coarse = stroke.points(1e-4), stroke.points(0.5)
        assert fine.dtype == np.float64 and fine.ndim == 2 and fine.shape[1] == 2
        assert len(coarse) <= len(fine)
        assert away(fine, [coarse]) < 0.5
        length = np.linalg.norm(np.diff(fine, axis=0), axis=1).sum()
        assert length == pytest.approx(stroke.length, abs=0.01 + 1e-3 * stroke.length)
        if stroke.closed:
            np.testing.assert_allclose(fine[0], fine[-1])


def test_beziers_are_the_same_line(kettle):
    for stroke in kettle.strokes:
        pieces = stroke.beziers
        assert pieces.dtype == np.float64 and pieces.shape[1:] == (4, 2) and len(pieces) > 0
        np.testing.assert_allclose(pieces[1:, 0], pieces[:-1, 3], atol=1e-9)
        t = np.linspace(0, 1, 100)[None, :, None]
        p = pieces[:, :, None]
        curve = (1 - t) ** 3 * p[:, 0] + 3 * t * (1 - t) ** 2 * p[:, 1] + 3 * t**2 * (1 - t) * p[:, 2] + t**3 * p[:, 3]
        assert away(stroke.points(0.01), list(curve)) < 0.02
        np.testing.assert_allclose(stroke.points()[0], pieces[0, 0], atol=1e-9)


def test_a_circle_and_a_dot(tracer):
    y, x = np.mgrid[:64, :64] + 0.5
    radius = np.hypot(x - 32, y - 32)
    ring = tracer.trace(np.clip(np.abs(radius - 20) - 1, 0, 1)).strokes
    assert [(s.kind, s.closed) for s in ring] == [("circle", True)]
    assert ring[0].length == pytest.approx(2 * np.pi * 20, abs=1) and ring[0].width == pytest.approx(3, abs=0.5)
    np.testing.assert_allclose(np.hypot(*(ring[0].points() - 32).T), 20, atol=0.3)


def test_attributes(kettle):
    assert kettle.width > 0 and kettle.height > 0
    assert len(kettle) == len(kettle.strokes) == len(list(kettle))
    assert re.fullmatch(rf"<Drawing \d+ x \d+ px.*: {len(kettle)} strokes.*>", repr(kettle))
    for stroke in kettle:
        assert re.fullmatch("#[0-9a-f]{6}", stroke.color) and stroke.width > 0 and stroke.widths is None
        assert stroke.kind in repr(stroke) and stroke.dashes is None
    with pytest.raises(ValueError, match="tolerance"):
        kettle.strokes[0].points(0)
    with pytest.raises(AttributeError):
        kettle.width = 3


def test_widths_along_strokes(samples):
    drawing = fieldtrace.trace(samples / "leaf.jpg", width="profile")
    profiles = [stroke.widths for stroke in drawing if stroke.widths is not None]
    assert profiles and all(p.dtype == np.float64 and p.ndim == 1 and (p > 0).all() for p in profiles)


def test_solids_have_rings(tracer):
    image = np.full((200, 200), 255, np.uint8)
    image[60:180, 60:180] = 0
    image[100:130, 100:140] = 255
    for y in range(10, 50, 12):
        image[y : y + 3, 10:190] = 0
    drawing = tracer.trace(image)
    assert len(drawing.solids) == 1
    rings = drawing.solids[0].rings()
    assert len(rings) == 2 and drawing.solids[0].color == "#000000" and "1 solid" in repr(drawing)
    for ring in rings:
        np.testing.assert_array_equal(ring[0], ring[-1])
    x, y = max(rings, key=np.ptp).T
    assert abs(np.dot(x[:-1], y[1:]) - np.dot(y[:-1], x[1:])) / 2 == pytest.approx(120 * 120, rel=0.02)


def test_outlines_are_solids(samples):
    drawing = fieldtrace.trace(samples / "kettle.png", width="outline")
    assert len(drawing.solids) > 0
    assert all(len(ring) > 3 for solid in drawing.solids for ring in solid.rings(0.05))


def test_every_format_is_written(kettle, tmp_path):
    starts = {"svg": b"<", "svgz": b"\x1f\x8b", "pdf": b"%PDF", "geojson": b"{", "json": b"{"}
    assert set(starts) <= set(fieldtrace.formats())
    for name in fieldtrace.formats():
        path = tmp_path / f"drawing.{name}"
        kettle.save(path)
        data = path.read_bytes()
        assert data == kettle.encode(name) and data.startswith(starts.get(name, b"")) and len(data) > 100
        kettle.save(str(tmp_path / "other"), format=name.upper())
        assert (tmp_path / "other").read_bytes() == data
    assert kettle.to_svg() == kettle._repr_svg_() == (tmp_path / "drawing.svg").read_text()
    written = json.loads((tmp_path / "drawing.json").read_text())
    assert written.pop("origin") and written == kettle.graph()


def test_options_of_writing(kettle):
    assert re.search(r"\d\.\d{5}", kettle.to_svg(precision=6)) and not re.search(r'd="[^"]*\d\.\d', kettle.to_svg(precision=0))
    assert "<title>A kettle" in kettle.to_svg(title="A kettle")
    assert "<circle" not in kettle.to_svg(shapes="path")
    assert not re.search(r'd="[^"]*[CA]', kettle.to_svg(shapes="path", curves="lines"))
    assert len(kettle.encode("csv", step=5)) < len(kettle.encode("csv", step=0.5))
    with pytest.raises(TypeError, match="did you mean 'precision'"):
        kettle.to_svg(precison=3)
    for wrong in ({"units": "furlongs"}, {"precision": 9}, {"tolerance": -1}):
        with pytest.raises(fieldtrace.OptionError, match=next(iter(wrong))):
            kettle.to_svg(**wrong)


def test_the_graph_can_be_drawn_again(tracer, kettle):
    graph = kettle.graph()
    assert {"nodes", "edges", "strokes"} <= set(graph)
    again = tracer.draw(graph)
    assert len(again) == len(kettle) and tracer.draw(json.dumps(graph)) == again
    with pytest.raises(fieldtrace.InputError):
        tracer.draw({"nodes": "none"})
    with pytest.raises(TypeError):
        tracer.draw([1])


def test_strokes_can_be_chosen(kettle):
    long = kettle.with_strokes([stroke for stroke in kettle if stroke.length > 100])
    assert 0 < len(long) < len(kettle) and all(stroke in kettle.strokes for stroke in long)
    assert long.to_svg().count("stroke-width") == len(long)
    with pytest.raises(ValueError):
        long.graph()
    with pytest.raises(fieldtrace.OptionError, match="json"):
        long.encode("json")


def test_drawings_are_compared_and_pickled(tracer, kettle, samples):
    again = tracer.trace(samples / "kettle.png")
    assert again == kettle and again.strokes[0] == kettle.strokes[0] and kettle != 3
    assert tracer.trace(samples / "plan.png") != kettle
    copy = pickle.loads(pickle.dumps(kettle))
    assert copy == kettle and copy.graph().keys() == kettle.graph().keys()
    sketch = pickle.loads(pickle.dumps(fieldtrace.Vectorizer(preset="sketch", detail=0.3)))
    assert sketch.options == {"preset": "sketch", "detail": 0.3}
