"""Drawings, their traces in every format, and the programs that open them."""

import io
import os
import subprocess
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy
import pytest
import resvg_py
from PIL import Image, ImageDraw, ImageFilter

import geometry

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
BINARY = Path(os.environ.get("FIELDTRACE_BINARY", "")).resolve()
INCH = 25.4
# How far lines and arcs may leave curves by default, and what the decimals of an SVG cost, in pixels.
TOLERANCE = 0.1
ROUNDING = 0.02


@dataclass(frozen=True)
class Drawing:
    """A drawing to trace, with its options."""

    name: str
    dpi: float | None = None
    options: tuple = ()

    @property
    def unit(self):
        """Length of a pixel in a DXF: millimetres, or pixels where no resolution is known."""
        return INCH / self.dpi if self.dpi else 1.0


PLAN, KETTLE, BOAT = Drawing("plan", 300), Drawing("kettle"), Drawing("boat")
# Pens of three colours, dashes, dots and solid regions, one with a hole.
LEGEND = Drawing("legend", 300, ("--dashes=join",))
SCANS = [PLAN, KETTLE, BOAT]
ALL = [*SCANS, LEGEND]


def named(drawings):
    return pytest.mark.parametrize("drawing", drawings, ids=lambda d: d.name)


def draw_legend(path):
    """Draws LEGEND, four times as large at first for smooth edges."""
    times = 4
    page = Image.new("RGB", (560 * times, 400 * times), "white")
    pen = ImageDraw.Draw(page)

    def line(x0, y0, x1, y1, color):
        pen.line([v * times for v in (x0, y0, x1, y1)], fill=color, width=4 * times)

    def disc(x, y, radius, **how):
        pen.ellipse([v * times for v in (x - radius, y - radius, x + radius, y + radius)], **how)

    for x in range(40, 520, 36):
        line(x, 40, x + 22, 40, "black")
        line(x, 80, x + 22, 80, "#c00000")
    line(40, 120, 520, 120, "#0000c0")
    line(40, 150, 520, 190, "#c00000")
    line(40, 370, 520, 370, "black")
    disc(110, 275, 60, fill="black")
    pen.polygon([(x * times, y * times) for x, y in [(90, 255), (135, 262), (120, 300)]], fill="white")
    pen.rectangle([v * times for v in (220, 225, 320, 325)], fill="#c00000")
    disc(440, 260, 35, outline="black", width=4 * times)
    for x in (390, 440, 490):
        disc(x, 330, 4, fill="black")
    page.resize((560, 400), Image.Resampling.LANCZOS).save(path)


def call(*command, **how):
    """Runs a program and gives what it printed."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=120, **how)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("traces")


@pytest.fixture(scope="session")
def source(folder):
    """The picture of a drawing."""
    def find(drawing):
        if drawing is not LEGEND:
            return SAMPLES / f"{drawing.name}.png"
        path = folder / "legend.png"
        if not path.exists():
            draw_legend(path)
        return path

    return find


@pytest.fixture(scope="session")
def trace(folder, source):
    """Traces a drawing into a file of a kind, once for each set of options."""
    known = {}

    def run(drawing, kind, *options):
        key = (drawing, kind, options)
        if key not in known:
            path = folder / f"{drawing.name}-{len(known)}.{kind}"
            resolution = [f"--dpi={drawing.dpi}"] if drawing.dpi else []
            call(BINARY, "-q", source(drawing), "-o", path, *resolution, *drawing.options, *options)
            known[key] = path
        return known[key]

    return run


@pytest.fixture(scope="session")
def picture(trace):
    """What the SVG of a drawing holds."""
    known = {}

    def run(drawing):
        if drawing not in known:
            known[drawing] = geometry.read(trace(drawing, "svg"))
        return known[drawing]

    return run


@pytest.fixture(scope="session")
def home(tmp_path_factory):
    """The environment of a program with windows that has no display and no settings."""
    folder = tmp_path_factory.mktemp("home")
    folder.chmod(0o700)
    own = {"HOME": str(folder), "XDG_RUNTIME_DIR": str(folder), "XDG_CONFIG_HOME": str(folder / "config")}
    return {**{k: v for k, v in os.environ.items() if k != "DISPLAY"}, **own, "QT_QPA_PLATFORM": "offscreen"}


@pytest.fixture
def inkscape(home, tmp_path):
    """Runs Inkscape."""
    return lambda *words: call("inkscape", *words, env=home, cwd=tmp_path)


def rendered(svg, width):
    """An SVG as drawn by resvg on white, as an array of colours."""
    text = geometry.gzip.decompress(svg.read_bytes()) if svg.suffix == ".svgz" else svg.read_bytes()
    root = ET.fromstring(text)
    # resvg rounds the size to whole pixels before it scales.
    _, _, across, down = (float(v) for v in root.get("viewBox").split())
    root.set("width", str(width))
    root.set("height", str(round(width * down / across)))
    png = resvg_py.svg_to_bytes(svg_string=ET.tostring(root, encoding="unicode"), background="#ffffff")
    return colors(io.BytesIO(bytes(png)))


def colors(path):
    """A picture on white as an array of colours."""
    image = Image.open(path).convert("RGBA")
    page = Image.new("RGBA", image.size, "white")
    return numpy.asarray(Image.alpha_composite(page, image).convert("RGB"))


def common(array, count):
    """The colours that most pixels have, so many, as text."""
    codes = array.reshape(-1, 3).astype(int) @ [65536, 256, 1]
    seen, counts = numpy.unique(codes, return_counts=True)
    return {f"#{seen[k]:06x}" for k in numpy.argsort(-counts)[:count]}


def ink(array):
    """Where a picture is dark or coloured."""
    return array.min(axis=2) < 128


def agreement(one, other, reach=1):
    """The lesser share of either ink that lies within `reach` pixels of the other."""
    assert one.shape == other.shape
    wide = [numpy.asarray(Image.fromarray(a).convert("L").filter(ImageFilter.MaxFilter(2 * reach + 1))) > 0
            for a in (one, other)]
    assert one.any() and other.any()
    return min((one & wide[1]).sum() / one.sum(), (other & wide[0]).sum() / other.sum())


def same_picture(one, other, pens):
    """Checks that two pictures have the same ink in the colours of the pens; edges are as each program smooths them."""
    assert agreement(ink(one), ink(other)) > 0.998
    assert numpy.abs(one.astype(int) - other).mean() < 4
    for pen in pens:
        color = [int(pen[k:k + 2], 16) for k in (1, 3, 5)]
        counts = [(numpy.abs(picture.astype(int) - color).max(axis=2) < 16).sum() for picture in (one, other)]
        assert min(counts) > 0.8 * max(counts) > 0, pen
