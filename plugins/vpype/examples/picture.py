"""Draws a page beside what a plotter does with it: `python picture.py IMAGE [PICTURE]`. Needs Matplotlib and Pillow."""

import shlex
import sys

import matplotlib.pyplot as plt
import vpype as vp
import vpype_cli
from PIL import Image


def show(name: str, picture: "str | None" = None) -> None:
    """The layers in vpype's colours, and the ways of the lifted pen."""
    document = vpype_cli.execute(f"trace {shlex.quote(name)} linemerge linesort")
    width, height = document.page_size
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
    left.imshow(Image.open(name).convert("RGB"), extent=(0, width, height, 0))
    title = name.rsplit("/", 1)[-1]
    left.set_title(title)
    for layer, color in zip(document.layers.values(), vp.METADATA_DEFAULT_COLOR_SCHEME):
        label = layer.property(vp.METADATA_FIELD_NAME)
        for line in layer:
            right.plot(line.real, line.imag, color=color.as_floats(), linewidth=1.5, label=label)
            label = None
        for line in layer.pen_up_trajectories():
            right.plot(line.real, line.imag, color="0.7", linewidth=0.7, zorder=0)
    right.set_title(f"vpype trace {title} linemerge linesort")
    right.legend(loc="upper left", fontsize="small")
    for axes in (left, right):
        axes.set(xlim=(0, width), ylim=(height, 0), aspect="equal", xticks=(), yticks=())
    if picture:
        figure.savefig(picture, dpi=100)
        Image.open(picture).convert("RGB").quantize(256).save(picture, optimize=True)
    else:
        plt.show()


if __name__ == "__main__":
    show(*sys.argv[1:3])
