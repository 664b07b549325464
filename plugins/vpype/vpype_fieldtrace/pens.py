"""A drawing as layers of vpype, one for each pen."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from statistics import median_low

import fieldtrace
import numpy as np
import vpype as vp

from . import solids

#: Pixels of vpype, which are those of CSS, in an inch.
DPI = 96.0
#: Length of a dot in pixels of the image, as in an SVG of fieldtrace: vpype has no lines of one point.
DOT = 0.01


@dataclass
class Pen:
    """A colour, as '#rrggbb', a width, and the polylines drawn with it, of shape (n, 2), all in pixels of the image."""

    color: str
    width: float
    lines: list[np.ndarray]


def drawn(drawing: fieldtrace.Drawing, tolerance: float, treatment: str) -> vp.Document:
    """A document of the drawing's size with a layer for each pen, lighter colours first, then thinner pens.

    `tolerance` is in pixels of vpype, `treatment` is what becomes of solid regions, one of `solids.TREATMENTS`.
    """
    pixel = DPI / drawing.dpi if drawing.dpi else 1.0
    document = vp.Document(page_size=(drawing.width * pixel, drawing.height * pixel))
    for number, pen in enumerate(_pens(drawing, tolerance / pixel, treatment), 1):
        layer = vp.LineCollection(line @ (1, 1j) * pixel for line in pen.lines)
        width = pen.width * pixel
        # Programs for plotters take the number that a name begins with for the layer's.
        layer.set_property(vp.METADATA_FIELD_NAME, f"{number} Pen {pen.color} {width / vp.UNITS['mm']:.2f} mm")
        layer.set_property(vp.METADATA_FIELD_COLOR, vp.Color(pen.color))
        layer.set_property(vp.METADATA_FIELD_PEN_WIDTH, width)
        document.add(layer, number, with_metadata=True)
    return document


def _pens(drawing: fieldtrace.Drawing, tolerance: float, treatment: str) -> list[Pen]:
    """The pens of a drawing in the order of their layers; `tolerance` is in pixels of the image."""
    alike = defaultdict(list)
    for stroke in drawing.strokes:
        # No image tells pens apart that differ by less than a tenth of a pixel.
        alike[stroke.color, round(stroke.width, 1)].append(stroke)
    pens = [
        Pen(color, median_low(stroke.width for stroke in strokes), [_polyline(stroke, tolerance) for stroke in strokes])
        for (color, _), strokes in alike.items()
    ]
    for solid in drawing.solids if treatment != "drop" else ():
        pen = _pen_for(solid.color, pens)
        pen.lines += solids.lines(solid.rings(tolerance), pen.width, treatment)
    return sorted(pens, key=lambda pen: (-int(pen.color[1:], 16), pen.width))


def _polyline(stroke: fieldtrace.Stroke, tolerance: float) -> np.ndarray:
    points = stroke.points(tolerance)
    return points + [[0, 0], [DOT, 0]] if stroke.kind == "dot" else points


def _pen_for(color: str, pens: list[Pen]) -> Pen:
    """The pen that draws most lines of a colour; a new one, as wide as the busiest or a pixel, where there is none."""
    busiest = max(pens, key=lambda pen: (pen.color == color, len(pen.lines)), default=Pen("", 1.0, []))
    if busiest.color == color:
        return busiest
    pens.append(Pen(color, busiest.width, []))
    return pens[-1]
