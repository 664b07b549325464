"""Solid regions as lines, for machines that hold a pen."""

from __future__ import annotations

import math
from functools import reduce

import numpy as np
import shapely
from shapely.affinity import rotate

#: What may become of solid regions.
TREATMENTS = ("drop", "outline", "hatch")
#: Of the lines of a hatching, in degrees.
ANGLE = 45.0


def lines(rings: list[np.ndarray], width: float, treatment: str) -> list[np.ndarray]:
    """What a pen of a width draws of the region within rings, by the even-odd rule: arrays of shape (n, 2)."""
    if treatment == "drop":
        return []
    return rings + hatching(rings, width) if treatment == "hatch" else rings


def hatching(rings: list[np.ndarray], width: float) -> list[np.ndarray]:
    """Parallel lines at most a pen's width apart, where a pen that went along the rings has left the region blank."""
    # A ring of three points goes there and back.
    areas = [shapely.make_valid(shapely.Polygon(ring)) for ring in rings if len(ring) > 3]
    region = reduce(shapely.symmetric_difference, areas, shapely.Polygon())
    inside = rotate(region.buffer(-width / 2), -ANGLE, origin=(0, 0))
    if inside.is_empty:
        return []
    left, top, right, bottom = inside.bounds
    count = math.ceil((bottom - top) / width)
    heights = top + (np.arange(count) + 0.5) * (bottom - top) / count
    rows = shapely.multilinestrings([[(left - width, y), (right + width, y)] for y in heights])
    pieces = rotate(shapely.intersection(rows, inside), ANGLE, origin=(0, 0))
    return [np.array(piece.coords) for piece in shapely.get_parts(pieces) if piece.length > 0]
