"""Estimators and observers of the caller's own."""

import threading

import numpy as np
import pytest

import fieldtrace


class Refused(Exception):
    pass


def tensor(darkness, mask):
    """Directions across the gradient, and across each other."""
    gy, gx = np.gradient(darkness)
    blur = lambda a: sum(np.roll(np.roll(a, i, 0), j, 1) for i in range(-2, 3) for j in range(-2, 3))
    angle = 0.5 * np.arctan2(2 * blur(gx * gy), blur(gx * gx) - blur(gy * gy)) + np.pi / 2
    u = np.dstack([np.cos(angle), np.sin(angle)])
    return u, np.dstack([-u[..., 1], u[..., 0]])


def test_ink_is_asked_of_a_function(grey, rgb):
    seen = []

    def left_half(page):
        seen.append((page.dtype, page.shape))
        darkness = 1 - (page if page.ndim == 2 else page.mean(2) / 255)
        darkness[:, 60:] = 0
        return darkness

    drawing = fieldtrace.trace(grey, ink_estimator=left_half)
    assert len(drawing) == 2 or len(drawing) == 4
    assert all((stroke.points()[:, 0] < 64).all() for stroke in drawing)
    fieldtrace.trace(rgb, ink_estimator=left_half)
    assert seen == [(np.float32, grey.shape), (np.uint8, rgb.shape)]
    darkness = 1 - grey / 255
    forms = [darkness, darkness.astype(np.float16), darkness[..., None], 255 - grey]
    drawings = [fieldtrace.trace(grey, ink_estimator=lambda page, form=form: form) for form in forms]
    assert all(len(drawing) == len(drawings[0]) > 2 for drawing in drawings)
    assert drawings[0] == drawings[2] == drawings[3]
    assert len(fieldtrace.trace(grey, ink_estimator=lambda page: page < 0.5)) >= 3
    assert len(fieldtrace.trace(grey, ink_estimator=lambda page: np.zeros(page.shape))) == 0


def test_directions_are_asked_of_a_function(grey):
    seen = []

    def field(darkness, mask):
        seen.append((darkness.dtype, mask.dtype, darkness.shape == mask.shape, bool(mask.any()), float(darkness.min())))
        return tensor(darkness, mask)

    drawing = fieldtrace.trace(grey, field_estimator=field)
    assert seen == [(np.float32, np.bool_, True, True, 0.0)]
    assert abs(len(drawing) - len(fieldtrace.trace(grey))) <= 2

    def coefficients(darkness, mask):
        u, v = ((d[..., 0] + 1j * d[..., 1]) ** 2 for d in tensor(darkness, mask))
        return u * v, -(u + v)

    assert len(fieldtrace.trace(grey, field_estimator=coefficients)) == len(drawing)

    def flipped(darkness, mask):
        u, v = tensor(darkness, mask)
        return -3 * v, 0.5 * u, mask

    assert len(fieldtrace.trace(grey, field_estimator=flipped)) == len(drawing)
    undefined = lambda darkness, mask: (np.zeros((*mask.shape, 2)), np.full((*mask.shape, 2), np.nan))
    assert len(fieldtrace.trace(grey, field_estimator=undefined)) == 0


def test_the_libraries_own_ink_and_field(tracer, grey):
    ink = tracer.ink(grey)
    assert ink.dtype == np.float32 and ink.shape == grey.shape and ink[grey < 64].mean() > 0.7 and ink[0, 0] < 0.1
    c0, c2, confidence = tracer.field(grey)
    assert c0.dtype == c2.dtype == np.complex64 and c0.shape == c2.shape == confidence.shape == grey.shape
    assert (confidence[grey < 64] > 0).mean() > 0.9


def test_observers_see_every_stage(grey):
    stages, seen = [], {}
    drawing = fieldtrace.trace(
        grey,
        ink="learned",
        on_stage=stages.append,
        on_ink=lambda ink: seen.update(ink=ink),
        on_graph=lambda graph: seen.update(graph=graph),
        on_drawing=lambda drawing: seen.update(drawing=drawing),
    )
    assert stages == ["ink", "directions", "strokes", "curves"]
    assert seen["ink"].shape == grey.shape and seen["ink"].dtype == np.float32
    assert seen["graph"] == drawing.graph() and seen["drawing"] == drawing


def test_observers_change_what_passes(grey):
    whole = fieldtrace.trace(grey)

    def without_ring(ink):
        ink[:, 60:] = 0
        return ink

    assert len(fieldtrace.trace(grey, ink="learned", on_ink=without_ring)) < len(whole)
    first = lambda drawing: drawing.with_strokes(drawing.strokes[:1])
    assert fieldtrace.trace(grey, on_drawing=first).strokes == whole.strokes[:1]

    def shorter(graph):
        return {**graph, "strokes": graph["strokes"][:2]}

    assert len(fieldtrace.trace(grey, on_graph=shorter)) == 2


@pytest.mark.parametrize("name", ["ink_estimator", "field_estimator", "on_stage", "on_ink", "on_graph", "on_drawing"])
def test_exceptions_come_out_as_they_are(grey, name):
    def refuse(*_):
        try:
            {}["key"]
        except KeyError as cause:
            raise Refused(name) from cause

    with pytest.raises(Refused, match=name) as caught:
        fieldtrace.trace(grey, ink="learned", **{name: refuse})
    assert isinstance(caught.value.__cause__, KeyError)
    assert caught.traceback[-1].name == "refuse"
    (result,) = fieldtrace.batch([grey], ink="learned", **{name: refuse})
    assert isinstance(result.error, Refused)


@pytest.mark.parametrize(
    "name, wrong, kind",
    [
        ("ink_estimator", lambda page: page[:5], fieldtrace.Error),
        ("ink_estimator", lambda page: None, TypeError),
        ("ink_estimator", lambda page: page.astype(np.int32), TypeError),
        ("on_ink", lambda ink: ink[1:], fieldtrace.Error),
        ("field_estimator", lambda darkness, mask: mask, ValueError),
        ("field_estimator", lambda darkness, mask: (darkness, darkness), ValueError),
        ("field_estimator", lambda darkness, mask: 3, TypeError),
        ("on_graph", lambda graph: {}, fieldtrace.Error),
        ("on_graph", lambda graph: 3, TypeError),
        ("on_drawing", lambda drawing: 3, TypeError),
        ("on_stage", lambda: None, TypeError),
    ],
)
def test_wrong_results_are_errors(grey, name, wrong, kind):
    with pytest.raises((kind, ValueError) if kind is TypeError else kind):
        fieldtrace.trace(grey, ink="learned", **{name: wrong})


def test_functions_run_on_the_thread_that_traces(grey):
    threads = set()
    fieldtrace.trace(grey, on_stage=lambda _: threads.add(threading.get_ident()))
    assert threads == {threading.get_ident()}


def test_a_function_may_trace(grey):
    inner = []
    fieldtrace.trace(grey, on_drawing=lambda _: inner.append(len(fieldtrace.trace(grey))))
    assert inner == [len(fieldtrace.trace(grey))]
