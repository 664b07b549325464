"""Drawings, what they are traced to, and vpype."""

import functools
import os
import shlex
import subprocess
import sys
from pathlib import Path

import fieldtrace
import numpy as np
import pytest
import shapely
import vpype_cli
from PIL import Image, ImageDraw

SAMPLES = Path(__file__).resolve().parents[3] / "samples"
#: Pixels of vpype in an inch, and of the image.
PIXELS, DPI = 96, 300


def draw(path, **saved):
    """A page of 300 x 200 pixels: lines of three colours and widths, a ring, dots, a disc with a hole and a square."""
    page = Image.new("RGB", (1200, 800), "white")
    pen = ImageDraw.Draw(page)
    pen.line([(60, 80), (1140, 120)], fill="#c00000", width=12)
    pen.line([(60, 180), (1140, 160)], fill="black", width=12)
    pen.line([(60, 240), (600, 270)], fill="black", width=20)
    pen.ellipse([80, 340, 420, 680], outline="#0000c0", width=16)
    pen.ellipse([500, 340, 800, 640], fill="black")
    pen.ellipse([580, 420, 680, 520], fill="white")
    pen.rectangle([900, 340, 1100, 540], fill="#c00000")
    for x in (600, 700, 800):
        pen.ellipse([x - 12, 708, x + 12, 732], fill="black")
    page.resize((300, 200), Image.Resampling.LANCZOS).save(path, **saved)


@pytest.fixture(scope="session")
def page(tmp_path_factory):
    """The path of that page, with a resolution of 300 dots per inch."""
    path = tmp_path_factory.mktemp("pages") / "page.png"
    draw(path, dpi=(DPI, DPI))
    return path


@pytest.fixture(scope="session", params=["page", "plan.png", "kettle.png"])
def any_page(request, page):
    """That page, and samples with a resolution and without."""
    return page if request.param == "page" else SAMPLES / request.param


@pytest.fixture(scope="session")
def execute():
    """Runs a pipeline in this process, and gives the document that it ends with."""
    return lambda *words: vpype_cli.execute(shlex.join(map(str, words)))


@pytest.fixture(scope="session")
def traced(execute):
    """The document of `trace WORDS`, made once."""
    return functools.lru_cache(maxsize=None)(lambda *words: execute("trace", *words))


@pytest.fixture(scope="session")
def vpype(tmp_path_factory):
    """Runs the program: `vpype WORDS`."""
    program = Path(sys.executable).parent / "vpype"
    folder = tmp_path_factory.mktemp("work")

    def run(*words, **how):
        return subprocess.run([program, *map(str, words)], capture_output=True, cwd=folder, timeout=120, **how)

    return run


def pen(stroke):
    """What tells the pens of strokes apart."""
    return stroke.color, round(stroke.width, 1)


def pixel(drawing):
    """Pixels of vpype in one of a drawing's."""
    return PIXELS / drawing.dpi if drawing.dpi else 1.0


def points(line):
    """An array of shape (n, 2) of one of complex numbers."""
    return np.stack([line.real, line.imag], axis=1)


def curves(drawing, count=200):
    """The strokes of a drawing as dense polylines, in pixels of vpype; dots are left out."""
    t = np.linspace(0, 1, count)[:, None, None]
    weights = (1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3
    for stroke in drawing.strokes:
        if stroke.kind != "dot":
            pieces = sum(w * stroke.beziers[None, :, k] for k, w in enumerate(weights))
            yield pieces.transpose(1, 0, 2).reshape(-1, 2) * pixel(drawing)


def all_lines(document):
    return [points(line) for layer in document.layers.values() for line in layer]


def apart(one, other, step=0.2):
    """The furthest that either of two sets of polylines leaves the other."""
    one, other = (shapely.multilinestrings([shapely.linestrings(line) for line in lines]) for lines in (one, other))

    def leaves(a, b):
        shapely.prepare(b)
        return shapely.distance(shapely.points(shapely.get_coordinates(shapely.segmentize(a, step))), b).max()

    return max(leaves(one, other), leaves(other, one))


@functools.lru_cache(maxsize=None)
def trace(path, **options):
    """The drawing that fieldtrace makes of a file."""
    return fieldtrace.trace(os.fspath(path), **options)
