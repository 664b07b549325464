"""Draws the strokes of an image beside it: `python show.py IMAGE [PICTURE]`. Needs Matplotlib and Pillow."""

import sys

import matplotlib.pyplot as plt
from PIL import Image

import fieldtrace


def show(name: str, picture: "str | None" = None) -> None:
    """Each stroke in a colour of its own, with the ends of its pieces."""
    image = Image.open(name)
    drawing = fieldtrace.trace(image)
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 5), sharex=True, sharey=True, layout="constrained")
    left.imshow(image.convert("RGB"))
    left.set_title(name.rsplit("/", 1)[-1])
    for stroke in drawing.strokes:
        (line,) = right.plot(*stroke.points().T, linewidth=1.5)
        ends = stroke.beziers[:, 0]
        right.plot(*ends.T, ".", color=line.get_color(), markersize=4)
    for solid in drawing.solids:
        for ring in solid.rings():
            right.plot(*ring.T, "k:")
    right.set_title(repr(drawing))
    right.set_aspect("equal")
    if picture:
        figure.savefig(picture, dpi=100)
    else:
        plt.show()


if __name__ == "__main__":
    show(*sys.argv[1:3])
