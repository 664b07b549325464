"""The same image in every form gives the same drawing."""

import io
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

import fieldtrace


def png(array, **info):
    file = io.BytesIO()
    Image.fromarray(array).save(file, "png", **info)
    return file.getvalue()


def same_grey(grey):
    """Arrays that all show the same grey picture."""
    yield "uint8", grey
    yield "HxWx1", grey[:, :, None]
    yield "RGB", np.dstack([grey] * 3)
    yield "BGR of OpenCV", cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR)[..., ::-1]
    yield "RGBA", np.dstack([grey, grey, grey, np.full_like(grey, 255)])
    yield "grey and alpha", np.dstack([grey, np.full_like(grey, 255)])
    yield "uint16", grey.astype(np.uint16) * 257
    yield "big-endian uint16", (grey.astype(np.uint16) * 257).astype(">u2")
    for kind in (np.float32, np.float64, ">f4"):
        yield str(kind), (grey / 255).astype(kind)
        yield f"{kind} RGB", np.dstack([(grey / 255).astype(kind)] * 3)
    yield "float with alpha", np.dstack([grey / 255, np.ones(grey.shape)])
    yield "Fortran order", np.asfortranarray(grey)
    yield "reversed twice", grey[::-1, ::-1].copy()[::-1, ::-1]
    yield "strided", np.repeat(np.repeat(grey, 2, 0), 3, 1)[::2, ::3]
    yield "channels first in memory", np.moveaxis(np.ascontiguousarray(np.stack([grey] * 3)), 0, 2)
    frozen = grey.copy()
    frozen.flags.writeable = False
    yield "read-only", frozen


def test_arrays_of_every_kind(tracer, grey):
    wanted = tracer.trace(grey)
    assert len(wanted) >= 3
    for name, array in same_grey(grey):
        assert tracer.trace(array) == wanted, name


def test_alpha_lies_over_white(tracer, grey):
    wanted = tracer.trace(grey)
    for black in (np.dstack([np.zeros_like(grey)] * 3 + [255 - grey]), np.dstack([np.zeros_like(grey), 255 - grey])):
        strokes = tracer.trace(black).strokes
        assert len(strokes) == len(wanted)
        for one, other in zip(strokes, wanted):
            np.testing.assert_allclose(one.points()[[0, -1]], other.points()[[0, -1]], atol=0.01)


def test_files_bytes_and_pictures(tracer, grey, tmp_path):
    wanted = tracer.trace(grey)
    data = png(grey)
    path = tmp_path / "drawing.png"
    path.write_bytes(data)
    for image in (str(path), path, data, bytearray(data), memoryview(data), Image.open(path), cv2.imread(str(path), 0)):
        assert tracer.trace(image) == wanted, type(image)


@pytest.mark.parametrize("mode", ["L", "LA", "La", "P", "PA", "RGB", "RGBA", "RGBa", "RGBX", "I", "I;16", "F"])
def test_pictures_of_every_mode(tracer, grey, mode):
    picture = Image.fromarray(grey)
    if mode in ("La", "PA"):
        picture = picture.convert("LA").convert(mode)
    elif mode == "RGBa":
        picture = picture.convert("RGBA").convert(mode)
    elif mode in ("I", "I;16"):
        picture = Image.fromarray(grey.astype(np.uint16) * 257)
        picture = picture.convert("I") if mode == "I" else picture
    else:
        picture = picture.convert(mode)
    assert picture.mode == mode
    assert tracer.trace(picture) == tracer.trace(grey)


@pytest.mark.parametrize("mode", ["CMYK", "YCbCr", "HSV", "LAB"])
def test_pictures_of_other_colour_spaces_have_the_same_lines(tracer, grey, mode):
    if mode == "LAB":
        from PIL import ImageCms

        rgb, lab = ImageCms.createProfile("sRGB"), ImageCms.createProfile("LAB")
        picture = ImageCms.profileToProfile(Image.fromarray(grey).convert("RGB"), rgb, lab, outputMode="LAB")
    else:
        picture = Image.fromarray(grey).convert("RGB").convert(mode)
    try:
        assert len(tracer.trace(picture)) == len(tracer.trace(grey))
    except ValueError as e:
        # Pillow itself has no way from LAB to anything else without profiles.
        assert mode == "LAB" and "conversion" in str(e)


def test_one_bit_is_black_and_white(tracer, grey):
    bits = grey > 127
    wanted = tracer.trace(bits.astype(np.uint8) * 255)
    assert tracer.trace(bits) == wanted
    assert tracer.trace(Image.fromarray(bits)) == wanted
    assert Image.fromarray(bits).mode == "1"


def test_colours_are_those_of_rgb(tracer, rgb):
    colors = lambda drawing: {tuple(int(c[i : i + 2], 16) > 96 for i in (1, 3, 5)) for c in map(color, drawing.strokes)}
    color = lambda stroke: stroke.color
    assert colors(tracer.trace(rgb)) == {(True, False, False), (False, False, True), (False, True, False)}
    bgr = cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR)
    assert tracer.trace(bgr[..., ::-1]) == tracer.trace(rgb) == tracer.trace(rgb.astype(np.float32) / 255)
    assert tracer.trace(png(rgb)) == tracer.trace(Image.fromarray(rgb)) == tracer.trace(rgb)


def test_options_of_reading_hold_for_arrays_as_for_files(grey, tmp_path):
    path = tmp_path / "drawing.png"
    path.write_bytes(png(grey))
    for options in ({"crop": (8, 4, 50, 60)}, {"dpi": 300}, {"dpi": (200, 100)}, {"page": 1}):
        wanted = fieldtrace.trace(path, **options)
        assert fieldtrace.trace(grey, **options) == wanted, options
        assert fieldtrace.trace(Image.fromarray(grey), **options) == wanted, options
    assert fieldtrace.trace(grey, crop=(8, 4, 50, 60)).width == 50
    for options in ({"page": 2}, {"max_pixels": 10}, {"crop": (90, 0, 50, 50)}):
        for image in (path, grey):
            with pytest.raises(fieldtrace.InputError):
                fieldtrace.trace(image, **options)


def test_a_resolution_and_a_turn_of_a_picture_are_those_of_its_file(tracer, grey, tmp_path):
    path = tmp_path / "turned.png"
    exif = Image.Exif()
    exif[0x0112] = 6
    path.write_bytes(png(grey, dpi=(300, 300), exif=exif))
    drawing = tracer.trace(path)
    assert (drawing.width, drawing.height) == grey.shape and round(drawing.dpi) == 300
    assert tracer.trace(Image.open(path)) == drawing


def test_what_is_no_image_is_refused(tracer, tmp_path):
    for wrong in (None, 3, object(), ["a.png"], {"a": 1}):
        with pytest.raises(TypeError, match="an image is a path"):
            tracer.trace(wrong)
    for shape in ((4,), (4, 4, 5), (2, 3, 4, 3), ()):
        with pytest.raises(ValueError, match="shape"):
            tracer.trace(np.zeros(shape, np.uint8))
    for kind in (np.int32, np.int64, np.complex64, "U3"):
        with pytest.raises(TypeError, match="no known range"):
            tracer.trace(np.zeros((4, 4), kind))
    with pytest.raises(ValueError, match="0..1"):
        tracer.trace(np.full((4, 4), 200.0))
    for empty in (np.zeros((0, 5), np.uint8), np.zeros((5, 0, 3), np.float32), b""):
        with pytest.raises(fieldtrace.InputError):
            tracer.trace(empty)


def test_odd_sizes_are_traced(tracer):
    for shape in ((1, 1), (1, 50), (50, 1), (2, 2, 3)):
        assert len(tracer.trace(np.full(shape, 255, np.uint8))) == 0
    assert len(tracer.trace(np.full((9, 9), np.nan))) == 0


def test_an_svg_and_a_graph_are_inputs_too(tracer, samples, kettle):
    assert len(tracer.trace(samples / "boat.svg")) > 3
    again = tracer.trace(kettle.encode("json"))
    assert len(again) == len(kettle) and isinstance(samples, Path)
