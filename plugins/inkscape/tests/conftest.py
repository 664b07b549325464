"""Drives the extension in three ways: by inkex of the virtual environment, by Inkscape's own inkex, by Inkscape."""

import base64
import os
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy
import pytest
from lxml import etree
from PIL import Image, ImageDraw

import inkex

FOLDER = Path(__file__).resolve().parent.parent
SAMPLES = FOLDER.parent.parent / "samples"
BINARY = Path(os.environ.get("FIELDTRACE_BINARY", "")).resolve()
DRIVERS = ["inkex", "inkex-of-inkscape", "inkscape"]
HEAD = ('<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
        'xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd" ')


@dataclass
class Result:
    """What the extension made of a document; `root` is None where it left it alone."""

    root: object
    said: str

    def traces(self):
        """The groups that were added, in the document's order."""
        return [g for g in self.root.iter("{*}g") if (g.get("inkscape:label") or "").startswith("Trace of")]


def environment(**more):
    """The environment of Inkscape: its own Python comes first."""
    given = {k: v for k, v in os.environ.items() if k not in ("FIELDTRACE", "PYTHONPATH", "VIRTUAL_ENV")}
    return {**given, "PATH": "/usr/bin:/bin", **more}


def arguments(select, options):
    """The command line as Inkscape writes it."""
    return [f"--id={i}" for i in select] + [f"--{name}={value}" for name, value in options.items()]


class Direct:
    """Runs the Python file by itself."""

    def __init__(self, python, **more):
        self.python, self.more = python, more

    def __call__(self, path, select=(), script=FOLDER / "fieldtrace.py", env=None, **options):
        output = path.with_suffix(".out.svg")
        output.unlink(missing_ok=True)
        env = {"FIELDTRACE": str(BINARY), **self.more} if env is None else {**self.more, **env}
        command = [self.python, str(script), str(path), f"--output={output}", *arguments(select, options)]
        done = subprocess.run(command, env=environment(**env), capture_output=True, text=True, timeout=120)
        assert "Traceback" not in done.stderr, done.stderr
        assert (done.returncode == 0) == output.exists(), done.stderr
        return Result(inkex.load_svg(output.read_bytes()).getroot() if output.exists() else None, done.stderr)


class Inkscape:
    """Runs Inkscape with its window on a display that nobody sees."""

    def __init__(self, display, profile):
        self.display, self.profile = display, profile
        extensions = profile / "extensions"
        extensions.mkdir(parents=True)
        for file in ("fieldtrace.py", "fieldtrace.inx"):
            shutil.copy(FOLDER / file, extensions)
        shutil.copy(BINARY, extensions / "trace")

    def env(self):
        return environment(DISPLAY=self.display, INKSCAPE_PROFILE_DIR=str(self.profile), GTK_USE_PORTAL="0")

    def start(self, path, output, actions, **options):
        """Starts a run of actions; the extension's options come from the preferences, as a dialog leaves them."""
        kept = " ".join(f'org.fieldtrace.trace.{name}="{value}"' for name, value in options.items())
        (self.profile / "preferences.xml").write_text(
            f'<inkscape version="1"><group id="extensions" {kept}/></inkscape>')
        output.unlink(missing_ok=True)
        actions = f"{actions};export-filename:{output};export-plain-svg:false;export-do"
        command = ["inkscape", "--batch-process", f"--actions={actions}", str(path)]
        return subprocess.Popen(command, env=self.env(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def __call__(self, path, select=(), after="", **options):
        output = path.with_suffix(".out.svg")
        chosen = f"select-by-id:{','.join(select)};" if select else ""
        run = self.start(path, output, f"{chosen}org.fieldtrace.trace.noprefs{after}", **options)
        said = run.communicate(timeout=60)[0]
        return Result(inkex.load_svg(output.read_bytes()).getroot() if output.exists() else None, said)

    def png(self, path, width=600):
        """The document as Inkscape draws it, white where nothing is: lightness from 0 to 255."""
        output = path.with_suffix(".png")
        subprocess.run(["inkscape", str(path), "-o", str(output), "-w", str(width), "-b", "white", "-y", "1"],
                       env=self.env(), check=True, capture_output=True, timeout=60)
        return numpy.asarray(Image.open(output).convert("L"))


@pytest.fixture(scope="session")
def display():
    """A display of its own, ended with the session."""
    reader, writer = os.pipe()
    command = ["Xvfb", "-displayfd", str(writer), "-screen", "0", "1280x900x24", "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=[writer], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(writer)
    with os.fdopen(reader) as number:
        name = f":{number.readline().strip()}"
    yield name
    server.terminate()
    server.wait()


@pytest.fixture(scope="session")
def inkscape(display, tmp_path_factory):
    return Inkscape(display, tmp_path_factory.mktemp("profile") / "inkscape")


@pytest.fixture(scope="session")
def inkex_driver():
    return Direct(sys.executable)


@pytest.fixture(params=DRIVERS)
def drive(request):
    """The extension, run in each of the three ways."""
    return driver(request, request.param)


@pytest.fixture(params=DRIVERS[:2])
def drive_directly(request):
    """The Python file, run with each of the two inkex."""
    return driver(request, request.param)


def driver(request, name):
    if name == "inkscape":
        return request.getfixturevalue("inkscape")
    if name == "inkex":
        return request.getfixturevalue("inkex_driver")
    system = subprocess.run(["inkscape", "--system-data-directory"], capture_output=True, text=True, check=True)
    return Direct("/usr/bin/python3", PYTHONPATH=f"{system.stdout.strip()}/extensions")


@pytest.fixture(scope="session")
def picture(tmp_path_factory):
    """A small clean drawing: a circle, a rectangle, a curve and a line."""
    path = tmp_path_factory.mktemp("picture") / "small drawing.png"
    scale = 4
    image = Image.new("L", (160 * scale, 120 * scale), 255)
    draw = ImageDraw.Draw(image)
    at = lambda *numbers: [n * scale for n in numbers]
    draw.line(at(20, 100, 140, 90), fill=0, width=4 * scale)
    draw.ellipse(at(30, 20, 80, 70), outline=0, width=4 * scale)
    draw.arc(at(90, 20, 150, 110), 180, 350, fill=0, width=4 * scale)
    draw.rectangle(at(100, 60, 130, 80), outline=0, width=4 * scale)
    image.resize((160, 120), Image.LANCZOS).save(path)
    return path


@pytest.fixture(scope="session")
def plain(picture):
    """The shapes of the plain trace of the small drawing."""
    return trace(picture)


def trace(path):
    """The shapes that the command draws, each with the width of its stroke."""
    done = subprocess.run([BINARY, path, "-o", "-"], capture_output=True, check=True)
    return shapes(inkex.load_svg(done.stdout).getroot())


def shapes(element):
    """All that is drawn in an element."""
    return [e for e in element.iter() if isinstance(e, inkex.ShapeElement) and not isinstance(e, inkex.Group)]


def data_uri(path):
    kind = "jpeg" if path.suffix == ".jpg" else "png"
    return f"data:image/{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"


def points(shape, matrix):
    """The nodes and handles of a shape under a 3x3 matrix."""
    nodes = [p for curve in inkex.Path(shape.path).to_superpath() for node in curve for p in node]
    return (matrix @ numpy.column_stack([numpy.array(nodes), numpy.ones(len(nodes))]).T)[:2].T


def document(folder, body, head='width="200mm" height="150mm" viewBox="0 0 200 150"', name="document.svg"):
    """Writes a document, of millimetres if nothing else is said."""
    path = folder / name
    path.write_text(f"{HEAD} {head}>{body}</svg>")
    return path


def rendered(inkscape, drive, path):
    """The image, and the strokes in its place, as Inkscape draws them."""
    result = drive(path, image="remove")
    other = path.with_suffix(".strokes.svg")
    other.write_bytes(etree.tostring(result.root))
    return inkscape.png(path), inkscape.png(other)


def drawing(path):
    """What a document draws, as text: without what Inkscape notes about its window."""
    root = etree.parse(str(path)).getroot()
    return [etree.tostring(child, method="c14n") for child in root if not str(child.tag).endswith("namedview")]


def matrix_of(element, top):
    """The product of the transforms from an element up to and with `top`, as they stand in the document."""
    product = numpy.eye(3)
    while True:
        own = inkex.Transform(element.attrib.get("transform"))
        product = numpy.vstack([numpy.array(own.matrix), [0, 0, 1]]) @ product
        if element is top or element.getparent() is None:
            return product
        element = element.getparent()


def close_dialog(display, run, seconds=40):
    """Closes the dialogs of a run until it ends; whether there was one."""
    answered = False
    end = time.time() + seconds
    while run.poll() is None and time.time() < end:
        time.sleep(1)
        env = environment(DISPLAY=display)
        found = subprocess.run(["xdotool", "search", "--onlyvisible", "--class", "inkscape"], env=env,
                               capture_output=True, text=True).stdout.split()
        for window in found:
            size = subprocess.run(["xdotool", "getwindowgeometry", "--shell", window], env=env, capture_output=True,
                                  text=True).stdout
            # Inkscape's own window is wider than any of its dialogs.
            if "WIDTH=1280" not in size and "WIDTH=1\n" not in size and size:
                subprocess.run(["xdotool", "windowfocus", window, "key", "Escape"], env=env, capture_output=True)
                answered = True
    if run.poll() is None:
        run.kill()
        raise AssertionError("Inkscape did not end")
    return answered


def random_transform(rng):
    """A transform as text and as the matrix it stands for, uneven and mirrored ones too."""
    text, product = "", numpy.eye(3)
    for kind in rng.sample(["rotate", "scale", "translate", "skewX", "matrix", "around"], 3):
        a, b = rng.uniform(-60, 60), rng.uniform(-60, 60)
        turn = numpy.radians(a)
        cos, sin = numpy.cos(turn), numpy.sin(turn)
        rotation = numpy.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
        shift = numpy.array([[1, 0, 50], [0, 1, b], [0, 0, 1]])
        sx, sy = rng.uniform(0.5, 2) * rng.choice([1, -1]), rng.uniform(0.5, 2)
        word, matrix = {
            "rotate": (f"rotate({a})", rotation),
            "scale": (f"scale({sx},{sy})", numpy.diag([sx, sy, 1])),
            "translate": (f"translate({a} {b})", numpy.array([[1, 0, a], [0, 1, b], [0, 0, 1]])),
            "skewX": (f"skewX({a})", numpy.array([[1, numpy.tan(turn), 0], [0, 1, 0], [0, 0, 1]])),
            "matrix": (f"matrix(1 0.2 {b / 60} 1.1 1234.5678 {a})",
                       numpy.array([[1, b / 60, 1234.5678], [0.2, 1.1, a], [0, 0, 1]])),
            "around": (f"rotate({a},50,{b})", shift @ rotation @ numpy.linalg.inv(shift)),
        }[kind]
        text, product = f"{text} {word}", product @ matrix
    return text.strip(), product


def agreement(a, b, reach=2):
    """The smaller of the shares of either picture's ink that is within `reach` pixels of the other's."""
    ink = [picture < 128 for picture in (a, b)]
    assert all(part.any() for part in ink)

    def near(part):
        padded = numpy.pad(part, reach)
        steps = range(2 * reach + 1)
        height, width = part.shape
        return numpy.any([padded[y:y + height, x:x + width] for y in steps for x in steps], axis=0)

    return min((ink[0] & near(ink[1])).sum() / ink[0].sum(), (ink[1] & near(ink[0])).sum() / ink[1].sum())
