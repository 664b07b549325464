#!/usr/bin/env python3
"""Traces the images of an Inkscape document into centreline strokes, by the program `fieldtrace`."""

import base64
import binascii
import math
import os
import re
import shutil
import subprocess
import sys
from collections import namedtuple
from urllib.parse import unquote, unquote_to_bytes
from urllib.request import url2pathname

import inkex

NAMES = ("fieldtrace", "trace")

# What the trace sets on a layer for the strokes in it. Each stroke gets it as its own style, as Inkscape
# writes its own shapes, so that rules of the document such as `path {...}` do not change it.
PAINT = ("fill", "fill-rule", "stroke", "stroke-width", "stroke-linecap", "stroke-linejoin", "stroke-dasharray",
         "stroke-dashoffset")

# What strokes would otherwise inherit from a group that the image is in.
PLAIN = {"fill-opacity": "1", "stroke-opacity": "1", "stroke-dasharray": "none", "stroke-dashoffset": "0",
         "marker": "none"}

# What is in these is drawn elsewhere, or not at all.
UNSEEN = "self::svg:defs or self::svg:symbol or self::svg:pattern or self::svg:mask or self::svg:clipPath or " \
         "self::svg:marker"

# Where a picture is: `box` in the image's own coordinates, the `matrix` that takes pixels there, and the `frame`, the
# part of the picture in pixels that the box shows; None where it shows all of it.
Place = namedtuple("Place", "box matrix frame")


class Trace(inkex.EffectExtension):
    """Puts the strokes of each image right above it."""

    def add_arguments(self, pars):
        """The parameters of the dialog."""
        for name, default in (("tab", ""), ("image", "keep"), ("preset", "any"), ("ink", "auto"),
                              ("width", "measured"), ("gap", "auto"), ("dashes", "keep"), ("only", ""),
                              ("ignore", ""), ("invert", "auto")):
            pars.add_argument(f"--{name}", default=default)
        for name, default in (("detail", 0.1), ("min_length", 0.5), ("fixed_width", 1.0), ("gap_length", 3.0),
                              ("color_tolerance", 0.15)):
            pars.add_argument(f"--{name}", type=float, default=default)

    def effect(self):
        """Traces every image; those that cannot be traced are told of and left as they are."""
        images = self.images()
        binary = find_binary()
        messages, traced = [], 0
        for image in images:
            try:
                warnings = self.trace(image, binary)
                traced += 1
            except inkex.AbortExtension as error:
                warnings = [str(error)]
            messages += [f"{name_of(image)}: {warning}" for warning in warnings]
        if not traced:
            raise inkex.AbortExtension("\n".join(messages))
        for message in messages:
            inkex.errormsg(message)

    def images(self):
        """The selected images and those in selected groups; all that are seen if nothing is selected."""
        if len(self.svg.selection):
            found = [i for e in self.svg.selection for i in e.xpath("descendant-or-self::svg:image")]
            found = list({id(image): image for image in found}.values())
            lack = "None of the selected objects is an image. Select images, or nothing to trace all that are seen."
        else:
            found = self.svg.xpath(f"//svg:image[not(ancestor::*[{UNSEEN}])]")
            found = [image for image in found if is_seen(image)]
            lack = "There is no image to trace. Import a picture first."
        if not found:
            raise inkex.AbortExtension(lack)
        return found

    def trace(self, image, binary):
        """Traces one image and returns the warnings."""
        drawing, warnings = run(binary, self.arguments(), self.content(image))
        _, _, width, height = drawing.get_viewbox()
        place = self.place(image, width, height)
        clips = clip_polygons(image, place)
        layers = [layer for layer in drawing if isinstance(layer, inkex.Group)]
        if not layers:
            raise inkex.AbortExtension(warnings[0] if warnings else "no ink was found")
        for shape in [shape for layer in layers for shape in layer]:
            if any(not meets(shape, clip) for clip in clips):
                shape.delete()
        layers = [layer for layer in layers if len(layer)]
        if not layers:
            raise inkex.AbortExtension("all ink is outside of what the image is cropped to")
        self.put(image, layers, place)
        return warnings

    def arguments(self):
        """The options of the command. Those at their default are left to the preset."""
        given = self.options
        wanted = {
            "preset": (given.preset, "any"),
            "ink": (given.ink, "auto"),
            "detail": (given.detail, 0.1),
            "min-length": (given.min_length, 0.5),
            "width": (given.fixed_width if given.width == "fixed" else given.width, "measured"),
            "gap": ({"never": 0, "upto": given.gap_length}.get(given.gap, "auto"), "auto"),
            "dashes": (given.dashes, "keep"),
            "color-tolerance": (given.color_tolerance, 0.15),
            "invert": (given.invert, "auto"),
        }
        arguments = [f"--{name}={value}" for name, (value, default) in wanted.items() if value != default]
        # A comma or a space parts colours, but not within rgb(1, 2, 3).
        for name in ("only", "ignore"):
            colors = re.findall(r"[^\s,;(]+(?:\([^)]*\))?", getattr(given, name) or "")
            arguments += [f"--{name}={color}" for color in colors]
        return arguments

    def content(self, image):
        """The bytes of the image's file or data."""
        href = image.get("xlink:href") or image.get("href") or ""
        if href.startswith("data:"):
            header, _, data = href.partition(",")
            try:
                data = unquote_to_bytes(data)
                return base64.b64decode(data) if header.rstrip().endswith(";base64") else data
            except binascii.Error:
                raise inkex.AbortExtension("the embedded image is damaged") from None
        if not href:
            raise inkex.AbortExtension("the image is empty: it names no file")
        if re.match(r"(https?|ftp):", href):
            raise inkex.AbortExtension(f"{href} is on the network: embed the image, or link a file")
        if href.startswith("file:"):
            paths = [url2pathname(re.sub(r"^file:(//[^/]*)?", "", href))]
        else:
            # Inkscape hands a copy of the document over, and 1.2 rewrites links so that they hold from there.
            copy = os.path.dirname(str(self.options.input_file))
            folders = (self.svg_path() or "", copy)
            paths = [os.path.join(folder, name) for name in (unquote(href), href) for folder in folders]
        # Inkscape also notes where the file was when it was linked.
        paths.append(image.get("sodipodi:absref") or "")
        path = next((path for path in paths if os.path.isfile(path)), None)
        if path is None:
            raise inkex.AbortExtension(f"the linked file {unquote(href)} is missing")
        try:
            with open(path, "rb") as file:
                return file.read()
        except OSError as error:
            raise inkex.AbortExtension(f"the linked file {path} cannot be read: {error.strerror}") from None

    def place(self, image, width, height):
        """Where a picture of this size in pixels is."""
        _, _, view_width, view_height = self.svg.get_viewbox()
        x, y = length(image, "x", 0, view_width), length(image, "y", 0, view_height)
        box_width = length(image, "width", width, view_width)
        box_height = length(image, "height", height, view_height)
        if min(width, height, box_width, box_height) <= 0:
            raise inkex.AbortExtension("the image has no size")
        box = (x, y, box_width, box_height)
        aspect = (image.get("preserveAspectRatio") or "xMidYMid").split()
        align = next((word for word in aspect if word not in ("defer", "meet", "slice")), "xMidYMid")
        scale_x, scale_y = box_width / width, box_height / height
        if align == "none":
            return Place(box, inkex.Transform((scale_x, 0, 0, scale_y, x, y)), None)
        scale = max(scale_x, scale_y) if "slice" in aspect else min(scale_x, scale_y)
        share = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
        left = (box_width - width * scale) * share.get(align[1:4], 0.5)
        top = (box_height - height * scale) * share.get(align[5:8], 0.5)
        frame = (-left / scale, -top / scale, box_width / scale, box_height / scale) if "slice" in aspect else None
        return Place(box, inkex.Transform((scale, 0, 0, scale, x + left, y + top)), frame)

    def put(self, image, layers, place):
        """Puts the strokes right above the image and does with the image what is wanted.

        Two levels: the outer one has the image's transform, clip and mask, so that these hold for the strokes
        as they did for the image. The inner ones, one for each pen, take pixels to the image's box. Strokes
        keep their coordinates and are not baked: a pen stretched unevenly, as the picture is, has no single
        width, and circles stay circles. To ungroup bakes.
        """
        parent = image.getparent()
        # A layer within a plain group would be hidden in Inkscape's list of layers.
        in_layer = parent is self.svg or parent.get("inkscape:groupmode") == "layer"
        kind = inkex.Layer if in_layer else inkex.Group
        outer = kind.new(f"Trace of {name_of(image)}")
        outer.set("id", self.svg.get_unique_id("trace"))
        outer.style = inkex.Style(PLAIN)
        if "transform" in image.attrib:
            outer.attrib["transform"] = image.attrib["transform"]
        for name in ("clip-path", "mask"):
            if referenced(image, name) is not None:
                outer.set(name, image.cascaded_style().get(name))
        clip = referenced(image, "clip-path")
        if clip is not None and clip.get("clipPathUnits") == "objectBoundingBox":
            # The strokes have another bounding box than the image.
            shapes = inkex.Group()
            shapes.extend(shape.copy() for shape in clip)
            for shape in shapes:
                shape.attrib["transform"] = matrix_text(clip_matrix(clip, place.box) @ transform_of(shape))
            outer.set("clip-path", self.new_clip(list(shapes)))
        parent.insert(parent.index(image) + 1, outer)
        frame = place.frame and self.new_clip([inkex.Rectangle.new(*place.frame)])
        for layer in layers:
            inner = kind.new(layer.get("inkscape:label"))
            outer.append(inner)
            inner.set("id", self.svg.get_unique_id("pen"))
            inner.attrib["transform"] = matrix_text(place.matrix)
            if frame:
                inner.set("clip-path", frame)
            for shape in list(layer):
                shape.style = {name: shape.get(name) or layer.get(name) for name in PAINT
                               if shape.get(name) or layer.get(name)}
                for name in (*PAINT, "id"):
                    shape.attrib.pop(name, None)
                inner.append(shape)
        if self.options.image == "hide":
            image.style["display"] = "none"
        elif self.options.image == "remove":
            image.delete()

    def new_clip(self, shapes):
        """Adds a clip of these shapes to the document; how it is referred to."""
        clip = inkex.ClipPath()
        for shape in shapes:
            shape.attrib.pop("id", None)
            clip.append(shape)
        self.svg.defs.append(clip)
        clip.set("id", self.svg.get_unique_id("crop"))
        return f"url(#{clip.get('id')})"


def find_binary():
    """The program: beside this file, then what FIELDTRACE names, then on the PATH."""
    here = os.path.dirname(os.path.abspath(__file__))
    suffix = ".exe" if sys.platform == "win32" else ""
    named = os.environ.get("FIELDTRACE")
    places = [os.path.join(here, name + suffix) for name in NAMES]
    places = [path for path in places if os.path.isfile(path)]
    places += [named] * bool(named) + [path for path in map(shutil.which, NAMES) if path]
    refused = []
    for path in places:
        try:
            said = start([path, "--version"], b"", timeout=20).stdout.decode("utf-8", "replace").strip()
        except (OSError, subprocess.SubprocessError) as error:
            refused.append(f"{path} does not run: {getattr(error, 'strerror', None) or error}")
            continue
        # macOS has a program `trace` of its own.
        if re.match(r"(field)?trace \d+\.\d+", said):
            return path
        refused.append(f"{path} is another program")
    raise inkex.AbortExtension("\n".join([
        "The program fieldtrace was not found. Put it beside this extension, in the folder", here,
        "or name it by the environment variable FIELDTRACE, or put it on the PATH.", *refused]))


def start(command, data, timeout=None):
    """Runs a command to its end, without a window of its own on Windows."""
    flags = getattr(subprocess, "CREATE_NO_WINDOW", 0)
    return subprocess.run(command, input=data, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=timeout,
                          creationflags=flags, check=False)


def run(binary, arguments, data):
    """The drawing that the program makes of an image's bytes, and its warnings."""
    try:
        done = start([binary, "-", "-o", "-", *arguments], data)
    except OSError as error:
        raise inkex.AbortExtension(f"{binary} does not run: {error.strerror or error}") from None
    said = done.stderr.decode("utf-8", "replace").splitlines()
    said = [re.sub(r"^(trace|error): (-: )?(warning: )?", "", line) for line in said if line.strip()]
    said = [line for line in said if "--help" not in line]
    if done.returncode:
        raise inkex.AbortExtension(f"cannot be traced: {' '.join(said) or f'code {done.returncode}'}")
    return inkex.load_svg(done.stdout).getroot(), said


def name_of(image):
    """What a person knows the image by."""
    href = image.get("xlink:href") or image.get("href") or "data:"
    file = "" if href.startswith("data:") else unquote(href.rsplit("/", 1)[-1])
    return image.get("inkscape:label") or file or image.get("id") or "image"


def is_seen(element):
    """Whether neither an element nor what it is in is hidden."""
    return all(e.cascaded_style().get("display") != "none"
               for e in (element, *element.iterancestors()) if isinstance(e, inkex.BaseElement))


def length(image, name, natural, whole):
    """A length of an image in its own coordinates; percents are of the document's."""
    text = (image.get(name) or "auto").strip()
    if text == "auto":
        return natural
    try:
        return float(text[:-1]) / 100 * whole if text.endswith("%") else float(image.to_dimensionless(text))
    except ValueError:
        raise inkex.AbortExtension(f"{text} is no {name} of an image") from None


def referenced(element, name):
    """The clip or mask of an element, or None."""
    found = re.match(r"url\([\"']?#([^\"')]+)", element.cascaded_style().get(name) or "")
    return element.root.getElementById(found.group(1)) if found else None


def clip_matrix(clip, box):
    """What takes the shapes of a clip to the coordinates of the element that has this bounding box."""
    in_box = clip.get("clipPathUnits") == "objectBoundingBox"
    unit = inkex.Transform((box[2], 0, 0, box[3], box[0], box[1]) if in_box else None)
    return unit @ transform_of(clip)


def clip_polygons(image, place):
    """For each clip that the image is under, its polygons in pixels of the picture.

    A clip that is not known as polygons, such as one of text, is left out here: it only hides.
    """
    clips, to_here = [], place.matrix
    if place.frame is not None:
        clips.append(polygons(inkex.Rectangle.new(*place.frame).path))
    for element in (image, *image.iterancestors()):
        if element.TAG == "svg":
            break
        clip = referenced(element, "clip-path")
        shapes = [] if clip is None else list(clip)
        plain = all(hasattr(s, "path") and not isinstance(s, (inkex.Use, inkex.TextElement)) for s in shapes)
        flat = abs(to_here.a * to_here.d - to_here.b * to_here.c) < 1e-12
        if shapes and plain and not flat and (element is image or clip.get("clipPathUnits") != "objectBoundingBox"):
            to_pixels = -to_here @ clip_matrix(clip, place.box)
            paths = [inkex.Path(s.path).transform(to_pixels @ transform_of(s)) for s in shapes]
            clips.append([polygon for path in paths for polygon in polygons(path)])
        to_here = transform_of(element) @ to_here
    return clips


def transform_of(element):
    """An element's transform; none where it is malformed, as Inkscape has it.

    Its property `transform` would round what the document says to six digits.
    """
    try:
        return inkex.Transform(element.attrib.get("transform"))
    except (TypeError, ValueError):
        return inkex.Transform()


def matrix_text(transform):
    """A transform as the document has it, in full precision."""
    return f"matrix({' '.join(f'{v:.10g}' for v in transform.to_hexad())})"


def polygons(path):
    """A path as polygons of points, a fraction of a pixel from it."""
    found = []
    for curve in inkex.Path(path).to_superpath():
        points = [tuple(node[1]) for node in curve[:1]]
        for (_, a, b), (c, d, _) in zip(curve, curve[1:]):
            is_line = list(a) == list(b) and list(c) == list(d)
            steps = 1 if is_line else 1 + int(2 * math.sqrt(math.dist(a, b) + math.dist(b, c) + math.dist(c, d)))
            for step in range(1, steps + 1):
                t = step / steps
                u = 1 - t
                wa, wb, wc, wd = u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t
                points.append(tuple(wa * a[k] + wb * b[k] + wc * c[k] + wd * d[k] for k in (0, 1)))
        if points:
            found.append(points)
    return found


def meets(shape, clip):
    """Whether any of a shape's ink may be inside a clip."""
    reach = float(shape.get("stroke-width") or 0) / 2
    is_solid = shape.get("stroke") == "none"
    return any(winding(line[0], polygon) or (is_solid and winding(polygon[0], line)) or are_near(line, polygon, reach)
               for line in polygons(shape.path) for polygon in clip)


def are_near(line, polygon, reach):
    """Whether a line crosses a polygon's edge or comes as near."""
    left, right = (pick(p[0] for p in line) for pick in (min, max))
    top, bottom = (pick(p[1] for p in line) for pick in (min, max))
    edges = [(c, d) for c, d in zip(polygon, polygon[1:] + polygon[:1])
             if max(c[0], d[0]) >= left - reach and min(c[0], d[0]) <= right + reach
             and max(c[1], d[1]) >= top - reach and min(c[1], d[1]) <= bottom + reach]
    return any(side(a, b, c) * side(a, b, d) < 0 > side(c, d, a) * side(c, d, b)
               or min(distance(a, c, d), distance(b, c, d), distance(c, a, b)) < reach
               for a, b in zip(line, line[1:]) for c, d in edges)


def side(a, b, p):
    """On which side of the line through a and b a point is."""
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def distance(p, a, b):
    """How far a point is from a segment."""
    x, y = b[0] - a[0], b[1] - a[1]
    squared = x * x + y * y
    share = ((p[0] - a[0]) * x + (p[1] - a[1]) * y) / squared if squared else 0
    share = min(max(share, 0), 1)
    return math.hypot(p[0] - a[0] - share * x, p[1] - a[1] - share * y)


def winding(point, polygon):
    """How often a polygon goes around a point."""
    turns = 0
    for a, b in zip(polygon, polygon[1:] + polygon[:1]):
        if (a[1] <= point[1]) != (b[1] <= point[1]):
            if (side(a, b, point) > 0) == (b[1] > a[1]):
                turns += 1 if b[1] > a[1] else -1
    return turns


if __name__ == "__main__":
    Trace().run()
