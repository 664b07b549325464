"""Many small drawings, as an archive has them, and what the plain batch makes of them."""

import random
from io import BytesIO

from PIL import Image, ImageDraw

import fieldtrace

#: Different drawings; files beyond them are copies.
DRAWINGS = 250


def icon(seed):
    """The bytes of a PNG of 48 x 48 pixels with two lines."""
    place = random.Random(seed)
    image = Image.new("L", (48, 48), 255)
    pen = ImageDraw.Draw(image)
    for _ in range(2):
        pen.line([place.randrange(4, 44) for _ in range(4)], fill=0, width=2)
    file = BytesIO()
    image.save(file, "PNG")
    return file.getvalue()


def contents(number):
    """The bytes of that many files, of which each hundredth is cut off in the middle."""
    icons = [icon(seed) for seed in range(DRAWINGS)]
    broken = icons[0][: len(icons[0]) // 2]
    return [broken if i % 100 == 50 else icons[i % DRAWINGS] for i in range(number)]


def write(folder, number):
    """That many files in a folder: their paths."""
    paths = [folder / f"{i:04}.png" for i in range(number)]
    for path, content in zip(paths, contents(number)):
        path.write_bytes(content)
    return list(map(str, paths))


def expected(number):
    """The drawing and the error of each file, by the plain batch."""
    files = contents(number)
    distinct = list(dict.fromkeys(files))
    made = {}
    for file, result in zip(distinct, fieldtrace.batch(distinct, jobs=2).wait()):
        error = f"{type(result.error).__name__}: {result.error}" if result.error else ""
        made[file] = (b"" if error else result.drawing.encode("svg"), error)
    return [made[file] for file in files]
