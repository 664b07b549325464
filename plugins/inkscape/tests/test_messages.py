"""What a person is told, and that the document is then as it was."""

import os
import shutil
import stat

import pytest
from conftest import BINARY, FOLDER, SAMPLES, close_dialog, document, drawing, shapes
from PIL import Image

IMAGE = 'width="80" height="60"'


def refused(result, *words):
    """Checks that nothing was done, and that these words were said."""
    assert result.root is None
    for word in words:
        assert word in result.said
    return True


def test_no_image(drive_directly, tmp_path, picture):
    path = document(tmp_path, '<rect id="r" width="9" height="9"/>')
    assert refused(drive_directly(path), "There is no image to trace")
    path = document(tmp_path, f'<rect id="r" width="9" height="9"/><image {IMAGE} xlink:href="{picture.as_uri()}"/>')
    assert refused(drive_directly(path, ["r"]), "None of the selected objects is an image")


BAD = {
    'xlink:href="not there.png"': "not there.png is missing",
    'xlink:href="file:///nowhere/a%20b.png"': "/nowhere/a b.png is missing",
    'xlink:href="https://example.org/a.png"': "is on the network",
    'xlink:href="file://[no"': "is missing",
    'xlink:href="//[no%00%ff"': "is missing",
    "": "it names no file",
    'xlink:href="data:image/png;base64,iVBOR"': "embedded image is damaged",
    'xlink:href="data:image/png;base64,AAAA"': "not an image in a known format",
    'xlink:href="data:,"': "the file is empty",
    'xlink:href="HERE/cut.png"': "cannot be traced: unexpected end of file",
    'xlink:href="HERE"': "missing",
    'xlink:href="GOOD" width="wide"': "the image has no size",
    'xlink:href="GOOD" width="x%"': "x% is no width",
    'xlink:href="GOOD" height="0"': "the image has no size",
    'xlink:href="GOOD" width="-3"': "the image has no size",
    'xlink:href="HERE/blank.png"': "no ink was found",
    'xlink:href="GOOD" clip-path="url(#far)"': "all ink is outside of what the image is cropped to",
}


@pytest.fixture
def bad(picture, tmp_path):
    """The images that cannot be traced."""
    (tmp_path / "cut.png").write_bytes(picture.read_bytes()[:300])
    Image.new("L", (80, 60), 255).save(tmp_path / "blank.png")
    images = []
    for number, attributes in enumerate(BAD):
        own = attributes.replace("HERE", tmp_path.as_uri()).replace("GOOD", picture.as_uri())
        own = " ".join([own, *(part for part in IMAGE.split() if part.split("=")[0] not in own)])
        images.append(f'<image id="bad{number}" inkscape:label="bad {number}" {own}/>')
    return '<clipPath id="far"><rect x="500" width="9" height="9"/></clipPath>' + "".join(images)


def test_images_that_cannot_be_traced(drive_directly, bad, picture, tmp_path):
    """Each is told of; nothing is done if there are no others, and the others are traced."""
    good = f'<image id="good" {IMAGE} xlink:href="{picture.as_uri()}"/>'
    alone = drive_directly(document(tmp_path, bad))
    assert alone.root is None
    beside = drive_directly(document(tmp_path, bad + good), image="remove")
    assert len(beside.traces()) == 1
    assert [i.get("id") for i in beside.root.iter("{*}image")] == [f"bad{number}" for number in range(len(BAD))]
    for number, words in enumerate(BAD.values()):
        for result in (alone, beside):
            told = [line for line in result.said.splitlines() if line.startswith(f"bad {number}: ")]
            assert len(told) == 1 and words in told[0]


def test_odd_transforms_are_no_error(drive_directly, picture, tmp_path):
    body = '<clipPath id="crop"><path d="M0 0h80v60z"/><path d="nonsense"/></clipPath><clipPath id="empty"/>'
    for transform in ("scale(0)", "matrix(1 2 2 4 0 0)", "scale(nan)", "rotate(", "hello"):
        for crop in ("gone", "empty"):
            body += (f'<g clip-path="url(#crop)"><image {IMAGE} clip-path="url(#{crop})" transform="{transform}" '
                     f'xlink:href="{picture.as_uri()}"/></g>')
    drive_directly(document(tmp_path, body))


def test_the_command_speaks(drive_directly, picture, tmp_path):
    """What the command says about its options, and its warnings, are passed on."""
    path = document(tmp_path, f'<image {IMAGE} xlink:href="{picture.as_uri()}"/>')
    assert refused(drive_directly(path, only="rod"), "rod", "not a colour such as")
    assert refused(drive_directly(path, detail="-1"), "detail")
    doubting = script(tmp_path / "doubting", f'"{BINARY}" "$@" && echo "trace: -: warning: looks odd" >&2')
    result = drive_directly(path, env={"FIELDTRACE": str(doubting)})
    assert result.said == "small drawing.png: looks odd\n" and len(result.traces()) == 1
    crashing = script(tmp_path / "crashing", f'[ "$1" = --version ] && exec "{BINARY}" "$1"; kill -9 $$')
    assert refused(drive_directly(path, env={"FIELDTRACE": str(crashing)}), "cannot be traced: code")


def script(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def test_where_the_program_is_looked_for(drive_directly, picture, tmp_path):
    """Beside the extension, then FIELDTRACE, then the PATH; other programs of the name are passed over."""
    home = tmp_path / "extensions"
    home.mkdir()
    mine = home / "fieldtrace.py"
    shutil.copy(FOLDER / "fieldtrace.py", mine)
    path = document(tmp_path, f'<image {IMAGE} xlink:href="{picture.as_uri()}"/>')
    base = "/usr/bin:/bin"

    def run(env):
        return drive_directly(path, script=mine, env={"PATH": base, **env})

    assert refused(run({}), "The program fieldtrace was not found", str(home), "FIELDTRACE", "PATH")
    assert refused(run({"FIELDTRACE": "/nowhere/trace"}), "/nowhere/trace does not run: No such file")
    other = script(tmp_path / "other" / "trace", "echo 'usage: trace [-cmd]'; exit 1")
    assert refused(run({"PATH": f"{other.parent}:{base}"}), f"{other} is another program")
    foreign = tmp_path / "foreign" / "trace"
    foreign.parent.mkdir()
    foreign.write_bytes(b"\x7fELF no program at all")
    foreign.chmod(0o755)
    assert refused(run({"FIELDTRACE": str(foreign)}), f"{foreign} does not run")
    named = tmp_path / "named" / "my trace"
    named.parent.mkdir()
    shutil.copy(BINARY, named)
    assert run({"FIELDTRACE": str(named)}).root is not None
    real = tmp_path / "real" / "fieldtrace"
    real.parent.mkdir()
    shutil.copy(BINARY, real)
    assert run({"PATH": f"{other.parent}:{real.parent}:{base}"}).root is not None
    # Beside goes first: this one leaves a mark and does the same.
    mark = tmp_path / "mark"
    script(home / "trace", f'touch "{mark}"; exec "{BINARY}" "$@"')
    assert run({"FIELDTRACE": str(named)}).root is not None and mark.exists()
    # One that is there and may not be run is told of.
    os.remove(home / "trace")
    shutil.copy(BINARY, home / "trace")
    (home / "trace").chmod(0o644)
    assert refused(run({}), f"{home / 'trace'} does not run: Permission denied")


def test_inkscape_shows_the_message_and_keeps_the_document(display, inkscape, tmp_path):
    """A window with the message is there to be closed, and the document is exported without a change."""
    path = document(tmp_path, f'<image id="bad" {IMAGE} xlink:href="a name that is nowhere else.png"/>')
    runs = {}
    for name, action in (("with", "select-by-id:bad;org.fieldtrace.trace.noprefs"), ("without", "select-by-id:bad")):
        output = tmp_path / f"{name}.svg"
        run = inkscape.start(path, output, action)
        assert close_dialog(display, run) == (name == "with")
        runs[name] = drawing(output)
    assert runs["with"] == runs["without"]


def test_samples_are_traced(inkex_driver, tmp_path):
    """Each sample gives strokes and no word of trouble."""
    for sample in ("kettle.png", "plan.png", "boat.png", "leaf.jpg"):
        path = document(tmp_path, f'<image {IMAGE} xlink:href="{(SAMPLES / sample).as_uri()}"/>')
        result = inkex_driver(path)
        assert result.said == "" and len(shapes(result.traces()[0])) > 5
