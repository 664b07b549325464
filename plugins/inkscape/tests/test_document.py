"""What becomes of the rest of the document."""

import subprocess
from collections import Counter

import inkex
import numpy
import pytest
from conftest import BINARY, agreement, data_uri, document, points, rendered, shapes
from PIL import Image, ImageDraw

IMAGE = 'width="80" height="60" preserveAspectRatio="none"'


def body(picture):
    """A document with ids and rules that could get in the way, and images at several places."""
    href = picture.as_uri()
    return f'''<style>path, circle, rect, line {{ fill: red; stroke: none; stroke-width: 30 }}</style>
        <defs><clipPath id="crop1"><rect width="80" height="55"/></clipPath>
            <symbol id="symbol"><image id="unseen" {IMAGE} xlink:href="{href}"/></symbol></defs>
        <g id="layer1" inkscape:groupmode="layer" inkscape:label="Drawings" transform="rotate(0.123456789)">
            <image id="first" {IMAGE} xlink:href="{href}" transform="translate(3.123456789,2)" clip-path="url(#crop1)"/>
            <circle id="trace1" r="9" style="stroke:blue"/><path id="pen1" d="M 1,1 2,2"/>
        </g>
        <g id="group" style="fill-opacity:0.1;stroke-opacity:0;stroke-dasharray:1,3;stroke-dashoffset:2">
            <g><image id="second" {IMAGE} x="100" xlink:href="{data_uri(picture)}"/></g>
        </g>
        <image id="hidden" {IMAGE} style="display:none" xlink:href="{href}"/>
        <g display="none"><image id="in-hidden" {IMAGE} xlink:href="{href}"/></g>
        <image id="third" inkscape:label="The third" {IMAGE} y="70" xlink:href="{href}"/>'''


def by_id(root):
    return {e.get("id"): e for e in root.iter() if e.get("id")}


def attributes(element):
    """An element's attributes, raw; those that mean nothing here left out."""
    return dict(element.attrib)


@pytest.mark.parametrize("image", ["keep", "hide", "remove"])
def test_all_that_are_seen_are_traced_and_the_rest_stays(drive, picture, tmp_path, image):
    path = document(tmp_path, body(picture))
    before = inkex.load_svg(path.read_bytes()).getroot()
    result = drive(path, image=image)
    root = result.root
    counts = Counter(e.get("id") for e in root.iter() if e.get("id"))
    assert max(counts.values()) == 1
    assert [g.get("inkscape:label") for g in result.traces()] == [
        "Trace of small drawing.png", "Trace of second", "Trace of The third"]
    traced, now = ["first", "second", "third"], by_id(root)
    for name, element in by_id(before).items():
        if name in traced and image == "remove":
            assert name not in now
            continue
        assert now[name].tag == element.tag
        shown = attributes(now[name])
        if name in traced:
            hidden = "display:none" in shown.get("style", "").replace(" ", "")
            assert hidden == (image == "hide")
            shown.pop("style", None)
        # Inkscape writes links and numbers in its own way; the Python file leaves them alone.
        for key, value in attributes(element).items():
            if not key.endswith("href"):
                assert key in shown
                assert shown[key] == value or "inkscape" in str(type(drive)).lower()


def test_layers_are_as_the_trace_had_them(drive_directly, picture, tmp_path):
    result = drive_directly(document(tmp_path, body(picture)))
    first, second, third = result.traces()
    for group in (first, second, third):
        assert [g.get("inkscape:label") for g in group] == ["Pen #000000"]
        assert all(s.style["stroke"] == "#000000" and s.style["fill"] == "none" for s in shapes(group))
    # In a layer, layers; in a plain group, groups.
    modes = [[g.get("inkscape:groupmode") for g in (group, *group)] for group in (first, second, third)]
    assert modes == [["layer", "layer"], [None, None], ["layer", "layer"]]
    # Right above the image.
    assert [g.getprevious().get("id") for g in (first, second, third)] == ["first", "second", "third"]
    assert not [c for c in result.root.iter() if not isinstance(c.tag, str)]


def test_pens_keep_their_layers_and_paint(drive_directly, tmp_path):
    """Two pens, a solid and an outline: labels and paint are those of the plain trace."""
    image = Image.new("RGB", (640, 480), "white")
    draw = ImageDraw.Draw(image)
    draw.line([(40, 60), (600, 90)], fill="#c00000", width=16)
    draw.ellipse([100, 150, 300, 350], outline="#0000a0", width=16)
    draw.rectangle([400, 200, 560, 400], fill="#0000a0")
    path = tmp_path / "pens.png"
    image.resize((160, 120), Image.LANCZOS).save(path)
    for width in ("measured", "outline"):
        plain = inkex.load_svg(subprocess.run([BINARY, path, "-o", "-", f"--width={width}"], capture_output=True,
                                              check=True).stdout).getroot()
        layers = [g for g in plain if isinstance(g, inkex.Group)]
        group = drive_directly(document(tmp_path, f'<image {IMAGE} xlink:href="pens.png"/>'), width=width).traces()[0]
        assert len(group) == len(layers) >= 2
        for mine, true in zip(group, layers):
            assert mine.get("inkscape:label") == true.get("inkscape:label")
            for shape, wanted in zip(mine, true, strict=True):
                for name in ("fill", "stroke", "stroke-width", "fill-rule", "stroke-linecap"):
                    assert shape.style.get(name) == (wanted.get(name) or true.get(name))


@pytest.mark.parametrize("select, traced", [
    (["first"], 1), (["first", "third"], 2), (["group"], 1), (["layer1", "first"], 1),
    (["layer1", "group", "third"], 3), (["hidden"], 1), (["trace1", "second"], 1),
])
def test_selected_images_alone(inkex_driver, picture, tmp_path, select, traced):
    result = inkex_driver(document(tmp_path, body(picture)), select)
    assert len(result.traces()) == traced


def test_selected_in_inkscape(inkscape, picture, tmp_path):
    result = inkscape(document(tmp_path, body(picture)), ["third", "group"])
    assert len(result.traces()) == 2


def test_embedded_and_linked_are_the_same(drive, picture, tmp_path):
    """However a picture is named, its strokes are the same."""
    (tmp_path / "a folder").mkdir()
    (tmp_path / "a folder" / "ä #1.png").write_bytes(picture.read_bytes())
    wrapped = data_uri(picture).replace("A", "A&#10; ").replace("+", "%2B")
    names = [picture.as_uri(), data_uri(picture), wrapped, "a%20folder/%C3%A4%20%231.png"]
    images = "".join(f'<image {IMAGE} x="{90 * i}" xlink:href="{name}"/>' for i, name in enumerate(names))
    images += f'<image {IMAGE} y="90" href="{picture.as_uri()}"/>'
    traces = drive(document(tmp_path, images)).traces()
    assert len(traces) == 5
    drawn = [[points(s, numpy.eye(3)).round(3).tolist() for s in shapes(g)] for g in traces]
    assert all(one == drawn[0] for one in drawn)




def test_nothing_around_changes_how_strokes_look(inkscape, inkex_driver, picture, tmp_path):
    """Rules of the document and styles of groups do not reach the strokes, drawn by Inkscape."""
    text = body(picture).replace('id="trace1" r="9"', 'id="trace1" r="0"').replace("M 1,1 2,2", "M 1,1")
    image, strokes = rendered(inkscape, inkex_driver, document(tmp_path, text))
    assert agreement(image, strokes) > 0.995
