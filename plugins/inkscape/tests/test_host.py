"""Inkscape itself: the dialog's options, undo, and what it makes of the strokes afterwards."""

import subprocess

import inkex
import pytest
from conftest import BINARY, FOLDER, SAMPLES, agreement, document, drawing, rendered, shapes
from lxml import etree

INX = "{http://www.inkscape.org/namespace/inkscape/extension}"
IMAGE = 'width="80" height="60" preserveAspectRatio="none"'


def parameters():
    """The parameters of the dialog with their values to choose from, and their defaults."""
    for param in etree.parse(str(FOLDER / "fieldtrace.inx")).iter(f"{INX}param"):
        values = [option.get("value") for option in param.iter(f"{INX}option")]
        if param.get("type") != "notebook":
            yield param.get("name"), values, values[0] if values else (param.text or "").strip()


@pytest.fixture
def told(drive_directly, picture, tmp_path):
    """Runs the extension with a program that notes its options and then traces."""
    program, note = tmp_path / "noting trace", tmp_path / "note"
    program.write_text(f'#!/bin/sh\n[ "$1" = --version ] || printf "%s\\n" "$@" > "{note}"\nexec "{BINARY}" "$@"\n')
    program.chmod(0o755)
    path = document(tmp_path, f'<image {IMAGE} xlink:href="{picture.as_uri()}"/>')

    def run(**options):
        result = drive_directly(path, env={"FIELDTRACE": str(program)}, **options)
        words = note.read_text().splitlines()
        assert words[:3] == ["-", "-o", "-"]
        return words[3:], result

    return run


def test_defaults_are_left_to_the_command(told):
    """What the dialog says before anything is changed, and what the Python file has without a dialog."""
    assert told()[0] == []
    assert told(**{name: default for name, _, default in parameters()}, tab="trace")[0] == []


def test_options_reach_the_command(told):
    words, result = told(preset="plan", ink="threshold", detail="0.3", min_length="2.50", width="fixed",
                         fixed_width="2.5", gap="upto", gap_length="4", dashes="join", invert="no",
                         color_tolerance="0.30", only="#000 black, rgb(1, 2,3)", ignore=" red;#0f0 ")
    assert set(words) == {
        "--preset=plan", "--ink=threshold", "--detail=0.3", "--min-length=2.5", "--width=2.5", "--gap=4.0",
        "--dashes=join", "--invert=no", "--color-tolerance=0.3", "--only=#000", "--only=black", "--only=rgb(1, 2,3)",
        "--ignore=red", "--ignore=#0f0"}
    assert {s.style["stroke-width"] for s in shapes(result.traces()[0])} == {"2.5"}
    assert told(gap="never")[0] == ["--gap=0"]


def test_each_choice_is_understood(inkex_driver, picture, tmp_path):
    """The command takes each value that the dialog offers."""
    path = document(tmp_path, f'<image {IMAGE} xlink:href="{picture.as_uri()}"/>')
    offered = {name: values for name, values, _ in parameters() if values}
    for number in range(1, max(map(len, offered.values()))):
        options = {name: values[min(number, len(values) - 1)] for name, values in offered.items()}
        result = inkex_driver(path, **options)
        # Inverted, the page is the ink, and the trace may have its doubts.
        assert result.root is not None and (result.said == "" or options["invert"] == "yes"), (options, result.said)


def test_dialog_options_and_one_step_of_undo(inkscape, picture, tmp_path):
    """Options come as the dialog keeps them; one undo takes all back, one redo brings all again."""
    path = document(tmp_path, f'<g transform="rotate(7)"><image id="a" {IMAGE} xlink:href="{picture.as_uri()}"/></g>'
                              f'<image id="b" {IMAGE} y="70" xlink:href="{picture.as_uri()}"/>')
    options = {"image": "remove", "width": "fixed", "fixed_width": "3.5"}
    back, again = (inkscape(path, after=after, **options) for after in (";undo", ";undo;redo"))
    assert len(again.traces()) == 2 and not list(again.root.iter("{*}image"))
    assert {s.style["stroke-width"] for g in again.traces() for s in shapes(g)} == {"3.5"}
    untouched, undone = tmp_path / "untouched.svg", tmp_path / "undone.svg"
    undone.write_bytes(etree.tostring(back.root))
    assert inkscape.start(path, untouched, "select-by-id:a").wait(60) == 0
    assert drawing(undone) == drawing(untouched)


def test_strokes_agree_with_the_picture(inkscape, tmp_path):
    """Samples, turned and cropped, traced and drawn by Inkscape."""
    body = '<defs><clipPath id="crop"><circle cx="40" cy="30" r="29"/></clipPath></defs>'
    crop = 'clip-path="url(#crop)"'
    for number, sample in enumerate(["kettle.png", "plan.png", "boat.png"]):
        body += (f'<image id="s{number}" width="80" height="60" xlink:href="{(SAMPLES / sample).as_uri()}" '
                 f'transform="translate({100 * (number % 2) + 20} {70 * (number // 2)}) rotate({10 * number}) '
                 f'skewX({5 * number})" {crop if number == 0 else ""}/>')
    image, strokes = rendered(inkscape, inkscape, document(tmp_path, body))
    assert agreement(image, strokes) > 0.98


def test_dxf_of_the_strokes(inkscape, inkex_driver, tmp_path):
    """Inkscape's own DXF export takes what the extension made."""
    kettle = (SAMPLES / "kettle.png").as_uri()
    path = document(tmp_path, f'<image {IMAGE} transform="rotate(9)" xlink:href="{kettle}"/>')
    result = inkex_driver(path, image="remove")
    traced, output = tmp_path / "traced.svg", tmp_path / "traced.dxf"
    traced.write_bytes(etree.tostring(result.root))
    command = ["inkscape", str(traced), "-o", str(output), "--export-extension=org.ekips.output.dxf_outlines"]
    done = subprocess.run(command, env=inkscape.env(), capture_output=True, text=True, timeout=60)
    assert "Traceback" not in done.stderr
    entities = output.read_text().split("ENTITIES")[1].split()
    assert entities.count("SPLINE") + entities.count("LINE") + entities.count("LWPOLYLINE") > 10
