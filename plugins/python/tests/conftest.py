"""Drawings to trace."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

import fieldtrace

SAMPLES = Path(__file__).resolve().parents[3] / "samples"


def drawn(size=(96, 80), scale=4, colors=("black",), width=3):
    """A picture of a cross, a curve and a ring, smoothed."""
    big = Image.new("RGB", (size[0] * scale, size[1] * scale), "white")
    pen = ImageDraw.Draw(big)
    w, h = big.size
    color = lambda i: colors[i % len(colors)]
    pen.line([(0.1 * w, 0.2 * h), (0.6 * w, 0.8 * h)], fill=color(0), width=width * scale)
    pen.line([(0.1 * w, 0.8 * h), (0.6 * w, 0.2 * h)], fill=color(1), width=width * scale)
    pen.ellipse([0.66 * w, 0.3 * h, 0.94 * w, 0.7 * h], outline=color(2), width=width * scale)
    return big.resize(size, Image.Resampling.LANCZOS)


@pytest.fixture(scope="session")
def samples():
    return SAMPLES


@pytest.fixture(scope="session")
def grey():
    """uint8 (H, W)."""
    return np.asarray(drawn().convert("L"))


@pytest.fixture(scope="session")
def rgb():
    """uint8 (H, W, 3), in three colours."""
    return np.asarray(drawn(colors=("#c00000", "#0000c0", "#007000")))


@pytest.fixture(scope="session")
def tracer():
    return fieldtrace.Vectorizer()


@pytest.fixture(scope="session")
def kettle(tracer):
    return tracer.trace(SAMPLES / "kettle.png")
