"""Options mean what they mean to fieldtrace, and what is wrong is told."""

import click
import fieldtrace
import pytest
import vpype as vp
from conftest import SAMPLES, all_lines, trace
from PIL import Image
from vpype_fieldtrace.command import trace as command
from vpype_fieldtrace.pens import drawn

def same(document, drawing):
    """Checks that a document is of a drawing."""
    expected = drawn(drawing, vp.convert_length("0.01mm"), "drop")
    assert document.page_size == pytest.approx(expected.page_size)
    assert {n: layer.metadata for n, layer in document.layers.items()} == {
        n: layer.metadata for n, layer in expected.layers.items()
    }
    assert all((one == other).all() for one, other in zip(all_lines(document), all_lines(expected), strict=True))


def test_options_have_the_names_of_fieldtrace():
    own = {"file", "layer", "tolerance", "solids", "help"}
    assert {option.name for option in command.params} - own <= set(fieldtrace.Options.__annotations__)


@pytest.mark.parametrize(
    "words, options",
    [
        ("", {}),
        ("--preset sketch", {"preset": "sketch"}),
        ("--preset icon --width pens", {"preset": "icon", "width": "pens"}),
        ("--preset plan --detail 0.3", {"preset": "plan", "detail": 0.3}),
        ("--crop 20,10,200,150", {"crop": (20, 10, 200, 150)}),
        ("--dpi 200", {"dpi": 200.0}),
        ("--dpi 200,100", {"dpi": (200.0, 100.0)}),
        ("--page 1 --max-pixels 1000000", {"page": 1, "max_pixels": 1000000}),
        ("--ink threshold --threshold 0.4", {"ink": "threshold", "threshold": 0.4}),
        ("--ink learned --threshold auto", {"ink": "learned", "threshold": "auto"}),
        ("--invert yes", {"invert": "yes"}),
        ("--despeckle 200", {"despeckle": 200}),
        ("--min-length 40", {"min_length": 40}),
        ("--width uniform", {"width": "uniform"}),
        ("--width 2.5", {"width": 2.5}),
        ("--gap 4", {"gap": 4.0}),
        ("--gap auto", {"gap": "auto"}),
        ("--only '#c00000' --only blue", {"only": ("#c00000", "blue")}),
        ("--ignore black --color-tolerance 0.3", {"ignore": ("black",), "color_tolerance": 0.3}),
    ],
)
def test_options_are_those_of_fieldtrace(traced, page, words, options):
    words = [word.strip("'") for word in words.split()]
    same(traced(*words, page), trace(page, **options))


def test_the_size_of_a_rendering(traced):
    same(traced("--size", 300, SAMPLES / "kettle.svg"), trace(SAMPLES / "kettle.svg", size=300))


@pytest.mark.parametrize(
    "words, named",
    [
        ("--detail 5", "--detail"),
        ("--min-length -1", "--min-length"),
        ("--threshold 2", "--threshold"),
        ("--threshold dark", "--threshold"),
        ("--width outline", "--width"),
        ("--width 0", "--width"),
        ("--gap -3", "--gap"),
        ("--dpi 0", "--dpi"),
        ("--dpi 1,2,3", "--dpi"),
        ("--crop 1,2,3", "--crop"),
        ("--crop 1,2,3,-4", "--crop"),
        ("--crop 0,0,99999999999,4", "--crop"),
        ("--size 0", "--size"),
        ("--only reddish", "--only"),
        ("--color-tolerance 2", "--color-tolerance"),
        ("--tolerance 0", "--tolerance"),
        ("--tolerance -1mm", "--tolerance"),
        ("--detail much", "much"),
        ("--page x", "x"),
        ("--size 99999999999", "99999999999"),
        ("--despeckle -1", "-1"),
        ("--tolerance wide", "wide"),
        ("--preset photo", "photo"),
        ("--solids fill", "fill"),
        ("--layer 0", "0"),
        ("--layer all", "all"),
        ("--detial 1", "--detial"),
    ],
)
def test_wrong_options_are_named(execute, page, words, named):
    with pytest.raises(click.UsageError) as caught:
        execute("trace", *words.split(), page)
    # What click knows itself it says when it shows the error.
    error = caught.value
    assert named in f"{error.format_message()} {getattr(error, 'param_hint', '')}"


@pytest.mark.parametrize(
    "name, content, words, reason",
    [
        ("none.png", None, (), "cannot be read"),
        ("text.png", b"no image", (), "not an image"),
        ("broken.png", b"\x89PNG\r\n\x1a\n and no more", (), ""),
        (None, None, ("--page", "7"), "page 7"),
        (None, None, ("--max-pixels", "10"), "limit of 10"),
        (None, None, ("--crop", "0,0,9000,10"), "not within the image"),
    ],
)
def test_files_that_cannot_be_traced_are_named(vpype, page, tmp_path, name, content, words, reason):
    path = tmp_path / name if name else page
    if content:
        path.write_bytes(content)
    done = vpype("trace", *words, path, "write", tmp_path / "out.svg")
    said = done.stderr.decode()
    assert done.returncode == 1 and f"Error: {path}: " in said and reason in said
    assert "Traceback" not in said and not (tmp_path / "out.svg").exists()


def test_a_folder_is_no_file(vpype, tmp_path):
    done = vpype("trace", tmp_path)
    assert done.returncode == 2 and b"is a directory" in done.stderr and b"Traceback" not in done.stderr


def test_an_empty_page_is_an_empty_document(traced, tmp_path):
    Image.new("L", (120, 80), 255).save(tmp_path / "blank.png", dpi=(96, 96))
    document = traced(tmp_path / "blank.png")
    assert not document.layers and document.page_size == pytest.approx((120, 80), rel=1e-3)
    assert list(traced("-l", 4, tmp_path / "blank.png").layers) == [4]
