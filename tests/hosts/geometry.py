"""What an SVG draws, as points, and how far points are from it. The ground that all other formats are compared with."""

import gzip
import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass

import numpy
import shapely
import svgelements

SVG = "{http://www.w3.org/2000/svg}"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
# Distance between points of curves, in units of the drawing.
FINE = 0.5


@dataclass
class Stroke:
    """A stroke: its points, dense where it is curved, and its pen."""

    points: numpy.ndarray
    width: float
    color: str
    dashes: tuple
    layer: str
    tag: str

    @property
    def is_dot(self):
        return self.length < 0.02

    @property
    def length(self):
        return float(numpy.hypot(*numpy.diff(self.points, axis=0).T).sum())


@dataclass
class Fill:
    """A solid region."""

    area: object
    color: str
    layer: str


@dataclass
class Picture:
    """An SVG: its view box, its size in millimetres where it says it, its layers with their colours, what is drawn."""

    width: float
    height: float
    millimetres: tuple
    layers: dict
    strokes: list
    fills: list

    @property
    def lines(self):
        return [s.points for s in self.strokes]

    @property
    def length(self):
        return sum(s.length for s in self.strokes)


def read(path):
    """Reads an SVG, compressed or not."""
    text = path.read_bytes()
    root = ET.fromstring(gzip.decompress(text) if path.suffix == ".svgz" else text)
    left, top, width, height = (float(v) for v in root.get("viewBox").split())
    assert (left, top) == (0, 0)
    sides = [root.get("width"), root.get("height")]
    millimetres = tuple(float(s[:-2]) for s in sides) if all(s.endswith("mm") for s in sides) else None
    picture = Picture(width, height, millimetres, {}, [], [])
    for group in root.iter(f"{SVG}g"):
        name = group.get(LABEL)
        for element in group:
            path = outline(element)
            color = element.get("fill") or element.get("stroke")
            if element.get("fill"):
                area = shapely.Polygon()
                for ring in path.as_subpaths():
                    area = area.symmetric_difference(shapely.Polygon(dense(ring)).buffer(0))
                picture.fills.append(Fill(area, color, name))
            else:
                dashes = tuple(float(v) for v in (element.get("stroke-dasharray") or "").split())
                tag = element.tag.removeprefix(SVG)
                width = float(element.get("stroke-width"))
                picture.strokes.append(Stroke(dense(path), width, color, dashes, name, tag))
            picture.layers.setdefault(name, color)
    return picture


def outline(element):
    """The path that an element draws."""
    number = {k: float(v) for k, v in element.attrib.items() if k in "x y x1 y1 x2 y2 cx cy r rx width height".split()}
    match element.tag.removeprefix(SVG):
        case "path":
            return svgelements.Path(element.get("d"))
        case "line":
            return svgelements.Path(svgelements.SimpleLine(**number))
        case "circle":
            return svgelements.Path(svgelements.Circle(**number))
        case "rect":
            radius = number.pop("rx", 0.0)
            return svgelements.Path(svgelements.Rect(rx=radius, ry=radius, **number))
    raise AssertionError(f"unknown element {element.tag}")


def dense(path):
    """Points along a path: the ends of each piece, and places on curves."""
    points = []
    for piece in path:
        if isinstance(piece, svgelements.Move):
            ends = [piece.end]
        elif isinstance(piece, (svgelements.Line, svgelements.Close)):
            ends = [piece.start, piece.end]
        else:
            count = max(math.ceil(piece.length(error=1e-2) / FINE), 4)
            ends = [piece.point(k / count) for k in range(count + 1)]
        points += [(float(p.x), float(p.y)) for p in ends if p is not None]
    return numpy.array(points)


def sampled(lines, step):
    """Points on lines at most `step` apart."""
    out = []
    for line in lines:
        out.append(line[:1])
        for a, b in zip(line, line[1:]):
            count = max(math.ceil(math.hypot(*(b - a)) / step), 1)
            out.append(a + (b - a) * (numpy.arange(1, count + 1) / count)[:, None])
    return numpy.concatenate(out)


def distances(points, lines):
    """How far each point is from the nearest of the lines."""
    pieces = [numpy.stack([line[:-1], line[1:]], axis=1) for line in lines if len(line) > 1]
    pieces += [numpy.stack([line, line], axis=1) for line in lines if len(line) == 1]
    tree = shapely.STRtree(shapely.linestrings(numpy.concatenate(pieces)))
    (which, _), away = tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)
    out = numpy.full(len(points), numpy.inf)
    out[which] = away
    return out


def apart(one, other, step=1.0):
    """The furthest that either of two sets of lines leaves the other."""
    return max(distances(sampled(one, step), other).max(), distances(sampled(other, step), one).max())


def box(points):
    """Left, top, right and bottom."""
    return numpy.concatenate([points.min(axis=0), points.max(axis=0)])
