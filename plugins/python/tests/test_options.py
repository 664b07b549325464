"""Options and errors."""

import errno

import numpy as np
import pytest

import fieldtrace


def test_options_are_those_of_the_command(grey):
    few = fieldtrace.trace(grey, min_length=1000)
    assert len(few) < len(fieldtrace.trace(grey))
    assert {s.width for s in fieldtrace.trace(grey, width=2.5)} == {2.5}
    assert len({s.width for s in fieldtrace.trace(grey, width="uniform")}) == 1
    assert len({s.width for s in fieldtrace.trace(grey, preset="icon")}) == 1
    assert fieldtrace.trace(grey, preset="icon", width=2) == fieldtrace.trace(grey, width=2, preset="icon")
    inverted = fieldtrace.trace(255 - grey)
    assert fieldtrace.trace(255 - grey, invert=True) == fieldtrace.trace(255 - grey, invert="yes") == inverted
    assert fieldtrace.trace(grey, detail=None, width=None, ink_estimator=None) == fieldtrace.trace(grey)
    for options in ({"estimator": "tensor"}, {"ink": "learned"}, {"ink": "threshold"}, {"threshold": 0.5}, {"gap": 0},
                    {"gap": "auto"}, {"dashes": "join"}, {"despeckle": 3}, {"device": "cpu"}):
        assert len(fieldtrace.trace(grey, **options)) >= 3, options


def test_colours_are_chosen(rgb):
    all_of_them = fieldtrace.trace(rgb)
    red = fieldtrace.trace(rgb, only="#c00000")
    assert 0 < len(red) < len(all_of_them)
    rest = fieldtrace.trace(rgb, ignore=["#c00000"], color_tolerance=0.15)
    assert len(red) + len(rest) == len(all_of_them)
    with pytest.raises(fieldtrace.OptionError, match="not a colour"):
        fieldtrace.trace(rgb, only="reddish")


def test_an_unknown_option_is_a_type_error(grey):
    for name, meant in (("detial", "detail"), ("min-length", "min_length"), ("whatever", None)):
        with pytest.raises(TypeError, match=f"did you mean '{meant}'" if meant else "no option 'whatever'"):
            fieldtrace.trace(grey, **{name: 1})
    with pytest.raises(TypeError, match="no option"):
        fieldtrace.Vectorizer(nothing=None)


@pytest.mark.parametrize(
    "name, value, kind",
    [
        ("detail", 5, ValueError),
        ("detail", "much", TypeError),
        ("detail", True, TypeError),
        ("min_length", -1, ValueError),
        ("width", "thick", ValueError),
        ("width", -2, ValueError),
        ("width", [], TypeError),
        ("ink", "guessed", ValueError),
        ("ink", 3, TypeError),
        ("threshold", 2.0, ValueError),
        ("despeckle", -1, ValueError),
        ("despeckle", 1.5, TypeError),
        ("preset", "photo", ValueError),
        ("estimator", "magic", ValueError),
        ("device", "abacus", ValueError),
        ("without", "nothing of the kind", ValueError),
        ("dpi", 0, ValueError),
        ("page", 0, ValueError),
        ("crop", (1, 2), TypeError),
        ("crop", (1, 2, 0, 4), ValueError),
        ("color_tolerance", float("nan"), ValueError),
        ("on_stage", 3, TypeError),
        ("ink_estimator", "me", TypeError),
    ],
)
def test_wrong_options_are_named(name, value, kind):
    with pytest.raises(kind, match=name) as caught:
        fieldtrace.Vectorizer(**{name: value})
    assert isinstance(caught.value, fieldtrace.Error) == (kind is ValueError)


def test_errors_are_the_librarys(tmp_path, tracer):
    missing = tmp_path / "none.png"
    with pytest.raises(FileNotFoundError, match="none.png: cannot be read: ") as caught:
        tracer.trace(missing)
    assert isinstance(caught.value, fieldtrace.Error) and caught.value.errno == errno.ENOENT
    with pytest.raises(OSError, match="folder"):
        tracer.trace(tmp_path)
    broken = tmp_path / "broken.png"
    broken.write_bytes(b"\x89PNG\r\n\x1a\n and no more")
    for image in (broken, broken.read_bytes(), b"no image"):
        with pytest.raises(fieldtrace.InputError):
            tracer.trace(image)
    with pytest.raises(fieldtrace.InputError, match="weights|Weights|bytes|read|file"):
        fieldtrace.Vectorizer(weights=broken)
    drawing = tracer.trace(np.full((8, 8), 255, np.uint8))
    with pytest.raises(fieldtrace.OptionError, match="svg, "):
        drawing.save(tmp_path / "drawing.doc")
    with pytest.raises(fieldtrace.FileError, match="cannot be written"):
        drawing.save(tmp_path / "no folder" / "drawing.svg")
    for kind in ("OptionError", "InputError", "FileError", "MissingFileError", "TimedOut", "Cancelled"):
        assert issubclass(getattr(fieldtrace, kind), fieldtrace.Error)
