"""PDF, drawn by Poppler and read by pypdf."""

import re
import subprocess

import numpy
import pypdf
from conftest import ALL, call, colors, named, rendered, same_picture

POINTS = 72


def resolution(drawing):
    return drawing.dpi or 96


@named(ALL)
def test_the_page_has_the_drawings_size(trace, picture, drawing):
    said = call("pdfinfo", trace(drawing, "pdf"))
    assert "Pages:           1\n" in said and "Encrypted:       no\n" in said
    size = [float(v) for v in re.search(r"Page size: +([\d.]+) x ([\d.]+) pts", said).groups()]
    svg = picture(drawing)
    assert numpy.allclose(size, numpy.array([svg.width, svg.height]) * POINTS / resolution(drawing), atol=0.01)


@named(ALL)
def test_poppler_draws_what_the_svg_shows(trace, tmp_path, picture, drawing):
    call("pdftoppm", "-r", 2 * resolution(drawing), "-png", "-singlefile", trace(drawing, "pdf"), tmp_path / "page")
    page = colors(tmp_path / "page.png")
    there = rendered(trace(drawing, "svg"), round(2 * picture(drawing).width))
    assert page.shape == there.shape
    same_picture(page, there, picture(drawing).layers.values())


@named(ALL)
def test_poppler_warns_of_nothing(trace, tmp_path, drawing):
    done = subprocess.run(["pdftocairo", "-svg", trace(drawing, "pdf"), tmp_path / "page.svg"], capture_output=True)
    assert done.returncode == 0 and not done.stderr


@named(ALL)
def test_pens_are_layers(trace, picture, drawing):
    reader = pypdf.PdfReader(trace(drawing, "pdf"), strict=True)
    layers = reader.trailer["/Root"]["/OCProperties"]
    groups = layers["/OCGs"]
    names = list(picture(drawing).layers)
    assert [g.get_object()["/Name"] for g in groups] == names
    assert {g.get_object()["/Type"] for g in groups} == {"/OCG"}
    assert [g.get_object()["/Name"] for g in layers["/D"]["/Order"]] == names
    page = reader.pages[0]
    marked = re.findall(rb"/OC +/(\w+) +BDC", page.get_contents().get_data())
    properties = page["/Resources"]["/Properties"]
    assert [properties[f"/{m.decode()}"]["/Name"] for m in marked] == names
    assert reader.metadata.title == f"{drawing.name}.png"
