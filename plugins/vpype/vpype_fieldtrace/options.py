"""Options of a trace, by the names that fieldtrace's own command has for them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click
from vpype_cli import FloatType, IntRangeType, TextType

#: Whole numbers of any option are below this.
_MANY = 2**31
_COUNT = IntRangeType(0, _MANY - 1)

#: Name, type, what stands for the value (where that is not one of some words), and what it does.
_OPTIONS: list[tuple[str, click.ParamType, str | None, str]] = [
    ("preset", click.Choice(("sketch", "plan", "icon")), None, "Options that suit a kind of drawing."),
    ("page", _COUNT, "N", "Read page N alone, from 1 on, of a TIFF, PDF, GIF or WebP."),
    ("crop", TextType(), "X,Y,W,H", "Read a part alone: W x H pixels from X, Y on of the upright image."),
    ("dpi", TextType(), "DPI|X,Y", "Dots per inch, or those across and those down, in place of the file's."),
    ("size", _COUNT, "PX", "Pixels along the longer side of the rendering of an SVG or a PDF."),
    ("max-pixels", _COUNT, "N", "Refuse images of more pixels than this.  [default: 64000000]"),
    ("ink", click.Choice(("auto", "learned", "threshold")), None, "How ink is told from all else.  [default: auto]"),
    ("threshold", TextType(), "T", "Darkness from which a pixel is ink: 'auto', or 0 to 1.  [default: auto]"),
    ("invert", click.Choice(("auto", "yes", "no")), None, "Whether lines are lighter than the ground.  [default: auto]"),
    ("despeckle", _COUNT, "N", "Remove specks of at most this many pixels.  [default: decided from the image]"),
    ("detail", FloatType(), "W", "How far curves may leave the ink's centre, in line widths.  [default: 0.1]"),
    ("min-length", FloatType(), "W", "Drop strokes of fewer line widths, unless they are dots.  [default: 0.5]"),
    ("width", TextType(), "WIDTH", "Widths of strokes: 'pens' as used, 'uniform', or pixels of the image.  [default: pens]"),
    ("gap", TextType(), "W", "Bridge breaks of at most this many line widths, or 'auto'.  [default: auto]"),
    ("only", TextType(), "COLOR", "Draw only this colour, such as '#c00000' or red; may be repeated."),
    ("ignore", TextType(), "COLOR", "Leave out this colour; may be repeated."),
    ("color-tolerance", FloatType(), "D", "How far colours may be from these; black is 1 from white.  [default: 0.15]"),
]
_REPEATED = ("only", "ignore")


def trace_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Gives a command the options of a trace."""
    for name, kind, value, text in reversed(_OPTIONS):
        command = click.option("--" + name, type=kind, metavar=value, multiple=name in _REPEATED, help=text)(command)
    return command


def parsed(given: dict[str, Any]) -> dict[str, Any]:
    """The options of `fieldtrace.trace` that were given; those that were not are left to it.

    Raises `click.BadParameter` for one that is not of its form.
    """
    options = {}
    for name, value in given.items():
        if value in (None, ()):
            continue
        try:
            options[name] = _READERS[name](value) if name in _READERS else value
        except ValueError as error:
            raise click.BadParameter(f"{value!r} is not {_FORMS[name]}", param_hint="--" + name) from error
    return options


def _word_or_number(*words: str) -> Callable[[str], str | float]:
    return lambda text: text if text in words else float(text)


def _rectangle(text: str) -> tuple[int, ...]:
    numbers = tuple(int(number) for number in text.split(","))
    if len(numbers) != 4 or not all(0 <= number < _MANY for number in numbers):
        raise ValueError
    return numbers


def _resolution(text: str) -> float | tuple[float, float]:
    x, comma, y = text.partition(",")
    return (float(x), float(y)) if comma else float(x)


#: How texts are read, and what is said where they cannot be.
_READERS: dict[str, Callable[[str], Any]] = {
    "crop": _rectangle,
    "dpi": _resolution,
    "threshold": _word_or_number("auto"),
    "width": _word_or_number("pens", "uniform"),
    "gap": _word_or_number("auto"),
}
_FORMS = {
    "crop": "four whole numbers, such as 100,50,640,480",
    "dpi": "a number, or two, such as 204,98",
    "threshold": "'auto' or a number",
    "width": "'pens', 'uniform' or a number",
    "gap": "'auto' or a number",
}
