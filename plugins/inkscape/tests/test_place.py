"""Strokes lie where the image does."""

import random

import inkex
import numpy
import pytest
from conftest import agreement, data_uri, document, matrix_of, points, random_transform, rendered, shapes
from PIL import Image


@pytest.mark.parametrize("seed", range(2))
def test_strokes_lie_where_the_image_does(drive, picture, plain, tmp_path, seed):
    rng = random.Random(seed)
    body, wanted = "", []
    for number in range(6):
        texts, matrices = zip(*(random_transform(rng) for _ in range(3)))
        unit, size = rng.choice([("", 1.0), ("mm", 96 / 25.4), ("px", 1.0), ("pt", 96 / 72)])
        x, y, width, height = (rng.uniform(low, 90) for low in (-90, -90, 20, 20))
        box = numpy.array([[width * size / 160, 0, x * size], [0, height * size / 120, y * size], [0, 0, 1]])
        wanted.append(matrices[0] @ matrices[1] @ matrices[2] @ box)
        href = data_uri(picture) if rng.random() < 0.5 else picture.as_uri()
        layer = 'inkscape:groupmode="layer"' if rng.random() < 0.5 else ""
        body += (f'<g transform="{texts[0]}" {layer}><g transform="{texts[1]}"><image id="i{number}" x="{x}{unit}" '
                 f'y="{y}{unit}" width="{width}{unit}" height="{height}{unit}" transform="{texts[2]}" '
                 f'preserveAspectRatio="none" xlink:href="{href}"/></g></g>')
    path = document(tmp_path, body)
    pixel = 25.4 / 96  # of CSS, in the document's millimetres
    traced = drive(path).traces()
    assert len(traced) == len(wanted)
    for group, matrix in zip(traced, wanted):
        drawn = shapes(group)
        assert len(drawn) == len(plain)
        for shape, true in zip(drawn, plain):
            here = matrix_of(shape, group.getroottree().getroot())
            assert type(shape) is type(true)
            assert numpy.abs(points(shape, here) - points(true, matrix)).max() < 0.1 * pixel
            # The pen is stretched as the picture is.
            pen = float(shape.style["stroke-width"]) * here[:2, :2]
            assert numpy.allclose(pen, float(true.get("stroke-width")) * matrix[:2, :2], rtol=1e-4, atol=1e-4)


ASPECTS = ["none", "xMidYMid", "xMinYMax meet", "xMaxYMin slice", "xMidYMid slice", "xMinYMin slice", None]
CROPS = {
    "a rectangle": '<clipPath id="crop"><rect x="20" y="20" width="60" height="50"/></clipPath>',
    "a turned ellipse": '<clipPath id="crop"><ellipse cx="50" cy="50" rx="40" ry="20" transform="rotate(30 50 50)"/>'
                        '</clipPath>',
    "two paths": '<clipPath id="crop" transform="translate(5 0)"><path d="M0 0h40l10 60z"/><path d="M60 90 90 20V90z"/>'
                 '</clipPath>',
    "a part of the box": '<clipPath id="crop" clipPathUnits="objectBoundingBox"><rect x=".1" y=".2" width=".5" '
                         'height=".6"/></clipPath>',
    "a use": '<path id="shape" d="M10 10H70V90z"/><clipPath id="crop"><use xlink:href="#shape"/></clipPath>',
}


def test_fitted_images_are_drawn_over(inkscape, inkex_driver, picture, tmp_path):
    """Each way to fit a picture into its box, in boxes broad and high, drawn by Inkscape."""
    href, body = data_uri(picture), ""
    for column, aspect in enumerate(ASPECTS):
        for row, (width, height) in enumerate([(90, 50), (50, 90)]):
            fit = f'preserveAspectRatio="{aspect}"' if aspect else ""
            body += (f'<image x="{column * 100 + 5}" y="{row * 100 + 5}" width="{width}" height="{height}" {fit} '
                     f'xlink:href="{href}"/>')
    # A photograph that its file says is to be turned, and one without a size.
    turned = tmp_path / "turned.jpg"
    note = Image.Exif()
    note[0x112] = 6
    Image.open(picture).save(turned, exif=note, quality=95)
    body += f'<image x="210" y="210" width="60" height="80" xlink:href="{turned.as_uri()}"/>'
    body += f'<g transform="translate(0 200) scale(.5)"><image x="10" y="10" xlink:href="{href}"/></g>'
    path = document(tmp_path, body, 'width="350mm" height="150mm" viewBox="0 0 700 300"')
    image, strokes = rendered(inkscape, inkex_driver, path)
    assert agreement(image, strokes) > 0.995


def test_cropped_images_are_drawn_over(inkscape, inkex_driver, picture, tmp_path):
    """Each kind of crop, of the image, of a group it is in, and by a mask, drawn by Inkscape."""
    href, body, definitions = data_uri(picture), "", ""
    image = f'width="100" height="90" preserveAspectRatio="none" xlink:href="{href}"'
    for column, (name, crop) in enumerate(CROPS.items()):
        own = crop.replace('"crop"', f'"crop{column}"').replace("shape", f"shape{column}")
        definitions += own
        body += (f'<g transform="translate({column * 110} 10)"><image {image} clip-path="url(#crop{column})"/></g>'
                 f'<image {image} transform="translate({column * 110} 210) rotate(-40 50 50)" '
                 f'style="clip-path:url(#crop{column})"/>')
        if "a part" not in name:
            body += (f'<g transform="translate({column * 110} 110)" clip-path="url(#crop{column})"><g>'
                     f'<image {image} transform="scale(1 .9)"/></g></g>')
    definitions += '<mask id="mask"><rect width="50" height="90" fill="white"/></mask>'
    body += f'<image {image} transform="translate(550 10)" mask="url(#mask)"/>'
    path = document(tmp_path, f"<defs>{definitions}</defs>{body}", 'viewBox="0 0 660 320"')
    image, strokes = rendered(inkscape, inkex_driver, path)
    assert agreement(image, strokes) > 0.995


@pytest.mark.parametrize("seed", range(3))
def test_strokes_outside_of_the_crop_are_left_out(drive_directly, picture, plain, tmp_path, seed):
    """A stroke stays where its ink is inside somewhere: told by many points on it."""
    rng = random.Random(seed)
    text, matrix = random_transform(rng)
    back = numpy.linalg.inv(matrix)
    x, y, radius = rng.uniform(20, 140), rng.uniform(20, 100), rng.uniform(8, 40)
    kinds = {
        f'<circle cx="{x}" cy="{y}" r="{radius}"': lambda p: numpy.hypot(p[:, 0] - x, p[:, 1] - y) - radius,
        f'<rect x="{x}" y="{y}" width="{radius}" height="50"':
            lambda p: numpy.maximum(numpy.abs(p[:, 0] - x - radius / 2) - radius / 2, numpy.abs(p[:, 1] - y - 25) - 25),
    }
    for shape, outside in kinds.items():
        # The crop is set around the transform, and takes it back, so that it is known in pixels.
        hexad = " ".join(str(v) for v in back[:2].T.ravel())
        body = (f'<defs><clipPath id="crop">{shape}/></clipPath></defs><g clip-path="url(#crop)">'
                f'<g transform="matrix({hexad})"><image id="i" width="160" height="120" transform="{text}" '
                f'preserveAspectRatio="none" xlink:href="{picture.as_uri()}"/></g></g>')
        far = [samples_outside(true, outside).min() - float(true.get("stroke-width")) / 2 for true in plain]
        if any(abs(distance) < 0.3 for distance in far):
            continue
        result = drive_directly(document(tmp_path, body))
        if all(distance > 0 for distance in far):
            assert result.root is None and "cropped" in result.said
            continue
        kept = [numpy.round(points(s, numpy.eye(3)), 2).tolist() for s in shapes(result.traces()[0])]
        true = [numpy.round(points(s, numpy.eye(3)), 2).tolist() for s, d in zip(plain, far) if d < 0]
        assert kept == true


def samples_outside(shape, outside):
    """How far outside many points of a shape are."""
    found = []
    for curve in inkex.Path(shape.path).to_superpath():
        for a, b in zip(curve, curve[1:]):
            a1, a2, b0, b1 = (numpy.array(p) for p in (a[1], a[2], b[0], b[1]))
            t = numpy.linspace(0, 1, 400)[:, None]
            found.append((1 - t)**3 * a1 + 3 * (1 - t)**2 * t * a2 + 3 * (1 - t) * t**2 * b0 + t**3 * b1)
    return outside(numpy.vstack(found))
