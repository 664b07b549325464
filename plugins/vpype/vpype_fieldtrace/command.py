"""The command `trace`."""

from __future__ import annotations

import logging
import sys
from typing import Any

import click
import fieldtrace
import vpype as vp
import vpype_cli

from .options import parsed, trace_options
from .pens import drawn
from .solids import TREATMENTS


@click.command()
@click.argument("file", type=vpype_cli.PathType(dir_okay=False, allow_dash=True))
@click.option(
    "-l",
    "--layer",
    type=vpype_cli.LayerType(accept_new=True),
    help="Layer for the strokes of all pens, or 'new'.  [default: a layer for each pen]",
)
@click.option(
    "-t",
    "--tolerance",
    type=vpype_cli.LengthType(),
    default="0.01mm",
    show_default=True,
    help="How far polylines may leave the curves that they are made of.",
)
@click.option(
    "--solids",
    type=click.Choice(TREATMENTS),
    default="drop",
    show_default=True,
    help="Solid regions: left out, drawn along their outlines, or hatched within these too, a pen's width apart.",
)
@trace_options
@vpype_cli.global_processor
def trace(
    document: vp.Document, file: str, layer: int | None, tolerance: float, solids: str, **given: Any
) -> vp.Document:
    """Trace the centrelines of a raster line drawing.

    FILE is a drawing: PNG, JPEG, TIFF, PDF, WebP, BMP, GIF or another format of fieldtrace; or a dash (-) for the
    standard input.

    By default each pen, which is a colour and a width of lines, has a layer of its own, from 1 on and from the lightest
    colour to the darkest, with the pen's colour, width and name as its properties. Strokes are added to what those
    layers hold already. With `--layer`, all strokes go into a single layer.

    A drawing has its true size where its resolution is known, from the file or by `--dpi`. Otherwise its pixels are
    those of vpype, of which 96 are an inch. The page size is set to that of the drawing, or extended to it.

    Examples:

        A scan, for the plotter:

            vpype trace scan.png linemerge linesort write out.svg

        A plan of 300 dots per inch, its solid regions hatched, in the middle of a sheet:

            vpype trace --preset plan --dpi 300 --solids hatch plan.jpg layout a4 write out.svg
    """
    if not tolerance > 0:
        raise click.BadParameter("it is to be above 0", param_hint="--tolerance")
    drawing = _drawing(file, parsed(given))
    logging.info(f"trace: {drawing!r}")
    traced = drawn(drawing, tolerance, solids)
    if file != "-":
        traced.add_to_sources(file)
    if layer is not None:
        traced = _in_one(traced, vpype_cli.single_to_layer_id(layer, document))
    document.extend(traced)
    return document


trace.help_group = "Input"


def _drawing(file: str, options: dict[str, Any]) -> fieldtrace.Drawing:
    """The trace of a file, or of the standard input.

    Raises `click.BadParameter` for an option out of its range and `click.ClickException` for a file that cannot be
    traced.
    """
    try:
        return fieldtrace.trace(sys.stdin.buffer.read() if file == "-" else file, **options)
    except fieldtrace.OptionError as error:
        name, _, reason = str(error).partition(": ")
        raise click.BadParameter(reason, param_hint="--" + name.replace("_", "-")) from error
    except fieldtrace.Error as error:
        raise click.ClickException(str(error)) from error


def _in_one(traced: vp.Document, number: int) -> vp.Document:
    """The same document with its layers as one, which has the colour and pen width that they have in common.

    As by `read`, the source is then the layer's.
    """
    one = vp.Document(page_size=traced.page_size)
    one.sources = traced.sources
    layers = list(traced.layers.values())
    lines = vp.LineCollection([line for layer in layers for line in layer])
    for name in (vp.METADATA_FIELD_COLOR, vp.METADATA_FIELD_PEN_WIDTH):
        values = {layer.property(name) for layer in layers}
        lines.set_property(name, values.pop() if len(values) == 1 else None)
    lines.set_property(vp.METADATA_FIELD_SOURCE, traced.property(vp.METADATA_FIELD_SOURCE))
    one.add(lines, number, with_metadata=True)
    return one
