"""GeoJSON, read by GDAL."""

import json
import shutil

import numpy
import pyogrio
import pytest
import shapely
import tifffile
from conftest import BINARY, BOAT, KETTLE, LEGEND, PLAN, ROUNDING, TOLERANCE, call
from geometry import apart
from PIL import Image

LIMIT = TOLERANCE + ROUNDING


def loaded(path):
    """What GDAL says of a file, and its features: shapes and columns by name."""
    info = pyogrio.read_info(path)
    meta, _, shapes, columns = pyogrio.raw.read(path)
    return info, shapely.from_wkb(shapes), dict(zip(meta["fields"], columns))


def lines(shapes):
    return [shapely.get_coordinates(s) for s in shapes if s.geom_type in ("LineString", "Point")]


def check(path, svg, to_world):
    """The features are the SVG's strokes and regions, moved to the world."""
    info, shapes, columns = loaded(path)
    assert info["driver"] == "GeoJSON"
    assert info["features"] == len(shapes) == len(svg.strokes) + len(svg.fills)
    assert shapely.is_valid(shapes).all()
    kinds = [s.geom_type for s in shapes]
    assert kinds.count("Polygon") == len(svg.fills)
    assert kinds.count("Point") == sum(s.is_dot for s in svg.strokes)
    unit = numpy.sqrt(abs(numpy.linalg.det(to_world[:, :2])))
    move = lambda points: points @ to_world[:, :2].T + to_world[:, 2]
    assert apart(lines(shapes), [move(line) for line in svg.lines], unit) < LIMIT * unit
    lengths = [s.length for s in svg.strokes]
    assert abs(shapely.length(shapes[len(svg.fills):]).sum() / unit / sum(lengths) - 1) < 0.002
    for shape, fill in zip(shapes, svg.fills):
        wanted = shapely.transform(fill.area, move)
        assert shape.buffer(LIMIT * unit).contains(wanted) and wanted.buffer(LIMIT * unit).contains(shape)
        assert len(shape.interiors) == len(fill.area.interiors)
    strokes = slice(len(svg.fills), None)
    assert list(columns["stroke"][strokes]) == list(range(len(svg.strokes)))
    assert numpy.allclose(columns["width"][strokes].astype(float) / unit, [s.width for s in svg.strokes], atol=0.01)
    assert list(columns["color"]) == [f.color for f in svg.fills] + [s.color for s in svg.strokes]
    return info


def upright(svg):
    return numpy.array([[1, 0, 0], [0, -1, svg.height]])


@pytest.mark.parametrize("drawing", [PLAN, KETTLE, BOAT, LEGEND], ids=lambda d: d.name)
def test_features_are_strokes_and_regions(trace, picture, drawing):
    check(trace(drawing, "geojson"), picture(drawing), upright(picture(drawing)))


def test_members_are_those_of_the_standard(trace):
    top = json.loads(trace(LEGEND, "geojson").read_text())
    assert top["type"] == "FeatureCollection"
    for feature in top["features"]:
        assert set(feature) == {"type", "geometry", "properties"} and feature["type"] == "Feature"
        for k, ring in enumerate(feature["geometry"]["coordinates"] if feature["geometry"]["type"] == "Polygon" else []):
            assert ring[0] == ring[-1] and len(ring) >= 4
            assert shapely.LinearRing(ring).is_ccw == (k == 0)


# Coordinates that are no degrees have a `crs` of null, which GDAL reads as if it was not there.
taken_for_degrees = pytest.mark.xfail(strict=True, reason="GDAL knows no crs of null")


@taken_for_degrees
def test_pixels_are_no_degrees(trace):
    assert loaded(trace(PLAN, "geojson"))[0]["crs"] is None


WORLD = {
    "upright": [2.0, 0.0, 0.0, -2.0, 450001.0, 5499999.0],
    "turned": [0.3, 0.1, 0.1, -0.3, 450001.0, 5499999.0],
}


@pytest.fixture(params=WORLD)
def placed(request, source, tmp_path):
    """A drawing with a world file beside it: the trace, and the map from pixels."""
    image = tmp_path / "map.png"
    shutil.copy(source(PLAN), image)
    a, d, b, e, c, f = WORLD[request.param]
    image.with_suffix(".pgw").write_text("".join(f"{v}\n" for v in (a, d, b, e, c, f)))
    call(BINARY, "-q", image, "--dpi=300", "-o", tmp_path / "map.geojson")
    # A world file tells where the first pixel's middle is.
    linear = numpy.array([[a, b], [d, e]])
    return tmp_path / "map.geojson", numpy.column_stack([linear, numpy.array([c, f]) - linear @ [0.5, 0.5]])


def test_a_world_file_places_the_strokes(placed, picture):
    check(placed[0], picture(PLAN), placed[1])


@taken_for_degrees
def test_a_world_file_tells_no_system(placed):
    assert loaded(placed[0])[0]["crs"] is None


@pytest.mark.parametrize("epsg, key, corner, unit", [(25832, 3072, (450000, 5500000), 0.5), (4326, 2048, (9, 49.5), 1e-5)])
def test_a_geotiff_places_the_strokes(source, picture, tmp_path, epsg, key, corner, unit):
    image = tmp_path / "map.tif"
    kind = 1 if key == 3072 else 2
    keys = [1, 1, 0, 3, 1024, 0, 1, kind, 1025, 0, 1, 1, key, 0, 1, epsg]
    tags = [(33550, "d", 3, (unit, unit, 0.0), True),
            (33922, "d", 6, (0.0, 0.0, 0.0, *map(float, corner), 0.0), True),
            (34735, "H", len(keys), tuple(keys), True)]
    grey = numpy.asarray(Image.open(source(PLAN)).convert("L"))
    tifffile.imwrite(image, grey, photometric="minisblack", extratags=tags)
    call(BINARY, "-q", image, "--dpi=300", "-o", tmp_path / "map.geojson")
    to_world = numpy.array([[unit, 0, corner[0]], [0, -unit, corner[1]]])
    info = check(tmp_path / "map.geojson", picture(PLAN), to_world)
    assert info["crs"] == f"EPSG:{epsg}"
