"""Pens are layers, with what vpype keeps of them."""

import vpype as vp
from conftest import PIXELS, pen, pixel, trace


def pens(drawing):
    return {pen(stroke) for stroke in drawing.strokes}


def test_each_pen_is_a_layer(traced, any_page):
    drawing = trace(any_page)
    document = traced(any_page)
    assert list(document.layers) == list(range(1, len(pens(drawing)) + 1))
    found = set()
    for number, layer in document.layers.items():
        color, width = layer.property("vp_color"), layer.property("vp_pen_width")
        assert isinstance(color, vp.Color)
        mine = (color.as_rgb_hex(), round(width / pixel(drawing), 1))
        found.add(mine)
        assert layer.property("vp_name") == f"{number} Pen {mine[0]} {width / PIXELS * 25.4:.2f} mm"
        assert len(layer) == sum(pen(stroke) == mine for stroke in drawing.strokes)
    assert found == pens(drawing)


def test_layers_go_from_light_to_dark_as_in_an_svg(traced, page, tmp_path):
    layers = list(traced(page).layers.values())
    trace(page).save(tmp_path / "page.svg")
    svg = vp.read_multilayer_svg(str(tmp_path / "page.svg"), quantization=0.1)
    colors = [layer.property("vp_name").split()[2] for layer in layers]
    assert list(dict.fromkeys(colors)) == [layer.property("vp_name").split()[-1] for layer in svg.layers.values()]
    for one, next in zip(layers, layers[1:]):
        assert one.property("vp_color") != next.property("vp_color") or (
            one.property("vp_pen_width") < next.property("vp_pen_width")
        )


def test_one_width_is_a_layer_for_each_colour(traced, page):
    for width in ("uniform", "3.5"):
        document = traced("--width", width, page)
        widths = {layer.property("vp_pen_width") for layer in document.layers.values()}
        assert len(widths) == 1 and len(document.layers) == len({s.color for s in trace(page).strokes}) == 3
        assert width == "uniform" or abs(widths.pop() - 3.5 * PIXELS / 300) < 1e-9


def test_all_strokes_go_into_one_layer(traced, page):
    document = traced("--layer", 5, page)
    assert list(document.layers) == [5]
    assert len(document.layers[5]) == len(trace(page))
    # The strokes differ in colour and in width.
    assert document.layers[5].metadata == {"vp_source": page}
    red = traced("--only", "#c00000", "-l", 2, page).layers[2]
    assert red.property("vp_color") == vp.Color("#c00000") and red.property("vp_pen_width") > 0
    black = traced("--only", "black", "--width", "uniform", "-l", "new", page).layers[1]
    assert black.property("vp_color") == vp.Color("black") and black.property("vp_pen_width") > 0


def test_a_new_layer_is_one_that_is_free(execute, page):
    document = execute("line", "-l", 1, 0, 0, 10, 10, "line", "-l", 2, 0, 0, 10, 10, "trace", "-l", "new", page)
    assert sorted(document.layers) == [1, 2, 3] and len(document.layers[3]) == len(trace(page))


def test_what_is_there_is_kept(execute, traced, page):
    once, twice = traced(page), execute("trace", page, "trace", page)
    for number, layer in once.layers.items():
        assert len(twice.layers[number]) == 2 * len(layer) and twice.layers[number].metadata == layer.metadata
    document = execute("pagesize", "20x1000", "line", "-l", 1, 0, 0, 10, 10, "trace", page)
    assert len(document.layers[1]) == len(once.layers[1]) + 1
    assert document.page_size == (once.page_size[0], 1000)


def test_sources_are_kept_as_by_read(execute, page, tmp_path):
    other = tmp_path / "other.png"
    other.write_bytes(page.read_bytes())
    document = execute("trace", page, "trace", other)
    assert document.sources == {page, other} and document.property("vp_source") == other
    document = execute("trace", "-l", 1, page, "trace", "-l", 2, other)
    assert document.sources == {page, other}
    assert [layer.property("vp_source") for layer in document.layers.values()] == [page, other]
