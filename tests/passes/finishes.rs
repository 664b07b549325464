//! The finishes of the graph.

use crate::common::draw::{SPECKLESS, color_scan, line, on_paper, polar, polyline, scan, sheet};
use crate::common::sweep::pairs;
use crate::figure::Figure;
use fieldtrace::drawing::{Color, Drawing, Fill, Stroke};
use fieldtrace::graph::{JunctionKind, StrokeGraph};
use fieldtrace::options::{Options, StrokeWidth};
use fieldtrace::render::render;
use kurbo::{BezPath, Point, Vec2};

const CENTER: Point = Point::new(60.3, 59.8);
const WIDTHS: [f64; 3] = [2.0, 3.0, 4.5];

fn page(strokes: Vec<Stroke>) -> Drawing {
    sheet(120, 120, strokes)
}

fn bar(turn: f64, reach: f64, width: f64) -> Stroke {
    line(polar(CENTER, turn, -reach), polar(CENTER, turn, reach), width)
}

fn walked(strokes: Vec<Stroke>) -> Figure {
    Figure::walked(&scan(&page(strokes)), Options::default())
}

/// A red bar across a blue one.
fn two_pens(width: f64) -> Figure {
    let inked = |stroke: Stroke, color| Stroke { color, ..stroke };
    let strokes =
        vec![inked(bar(10.0, 45.0, width), Color([200, 20, 30])), inked(bar(95.0, 45.0, width), Color([30, 60, 200]))];
    Figure::walked(&color_scan(&page(strokes), Color([255; 3])), Options::default())
}

#[test]
fn strokes_have_the_colours_of_their_pens() {
    for width in WIDTHS {
        let colors: Vec<Color> = two_pens(width).graph(&[]).trails.iter().map(|trail| trail.color).collect();
        let is = |color: &Color, channel: usize| color.0.iter().max() == Some(&color.0[channel]);
        assert!(colors.len() == 2 && [0, 2].iter().all(|&c| colors.iter().any(|color| is(color, c))), "{colors:?}");
        assert_eq!(two_pens(width).changes("colour"), Some(2));
    }
}

#[test]
fn without_its_pass_all_ink_is_black() {
    assert!(two_pens(3.0).graph(&["colour"]).trails.iter().all(|trail| trail.color == Color::BLACK));
}

#[test]
fn on_a_grey_page_nothing_is_coloured() {
    assert_eq!(walked(vec![bar(10.0, 45.0, 3.0)]).changes("colour"), Some(0));
}

/// A brush stroke that swells from a point to a width, under some kind of widths.
fn swelling(widest: f64, turn: f64, width: StrokeWidth) -> Figure {
    let along = Vec2::from_angle(turn.to_radians());
    let side = |sign: f64, k: i32| {
        let s = f64::from(k) / 40.0;
        CENTER + along * (90.0 * s - 45.0) + along.turn_90() * (0.5 * sign * (1.0 + (widest - 1.0) * s))
    };
    let points: Vec<Point> = (0..=40).map(|k| side(1.0, k)).chain((0..=40).rev().map(|k| side(-1.0, k))).collect();
    let mut outline = BezPath::new();
    outline.move_to(points[0]);
    points[1..].iter().for_each(|p| outline.line_to(*p));
    outline.close_path();
    let brush =
        Drawing { fills: vec![Fill { outline, color: Color::BLACK }], ..page(vec![bar(turn + 90.0, 20.0, 2.0)]) };
    let gray = render(&brush).map(|ink| 1.0 - ink);
    Figure::walked(&crate::common::draw::scan_of(gray), Options::default().with(|o| o.width = width))
}

fn measured(graph: &StrokeGraph) -> usize {
    graph.graph.edge_weights().flat_map(|edge| &edge.widths).filter(|w| w.is_finite()).count()
}

#[test]
fn widths_that_a_walk_lost_are_measured_for_outlines() {
    let mut more = 0;
    for (widest, turn) in pairs(&[5.0, 7.0, 9.0], &[0.0, 30.0, 75.0]) {
        let figure = swelling(widest, turn, StrokeWidth::Outline);
        let (with, without) = (measured(&figure.graph(&[])), measured(&figure.graph(&["taper"])));
        assert!(with >= without, "{widest} {turn}: {with} and {without}");
        assert_eq!(with > without, figure.changes("taper") > Some(0), "{widest} {turn}");
        more += usize::from(with > without);
    }
    assert!(more > 0);
}

#[test]
fn widths_are_measured_again_for_outlines_only() {
    assert_eq!(swelling(7.0, 30.0, StrokeWidth::Measured).changes("taper"), None);
}

#[test]
fn an_even_stroke_has_lost_no_widths() {
    for (width, turn) in pairs(&WIDTHS, &[0.0, 30.0, 75.0]) {
        let outlines = Options::default().with(|o| o.width = StrokeWidth::Outline);
        let figure = Figure::walked(&scan(&page(vec![bar(turn, 45.0, width)])), outlines);
        assert_eq!(figure.changes("taper"), Some(0), "{width} {turn}");
    }
}

/// A line in two parts with so many pixels of paper between them.
fn broken(width: f64, turn: f64, paper: f64) -> Drawing {
    let half = 0.5 * (paper + width);
    page(
        [-1.0, 1.0]
            .map(|side| line(polar(CENTER, turn, side * half), polar(CENTER, turn, side * 50.0), width))
            .to_vec(),
    )
}

#[test]
fn a_pencil_line_goes_on_behind_a_short_gap() {
    for (width, turn) in pairs(&[3.0, 4.5], &[0.0, 30.0, 75.0, 120.0]) {
        let figure =
            Figure::walked(&on_paper(&broken(width, turn, 1.2 * width), SPECKLESS, turn as u64), Options::default());
        let graph = figure.graph(&[]);
        assert_eq!((figure.changes("gap"), graph.trails.len()), (Some(1), 1), "{width} {turn}");
        assert_eq!(graph.graph.node_weights().filter(|node| node.kind == JunctionKind::Gap).count(), 2);
    }
}

#[test]
fn on_a_clean_page_every_gap_was_meant() {
    for (width, turn) in pairs(&WIDTHS[1..], &[0.0, 30.0, 75.0]) {
        let figure = Figure::walked(&scan(&broken(width, turn, 1.2 * width)), Options::default());
        assert_eq!((figure.changes("gap"), figure.graph(&[]).trails.len()), (Some(0), 2), "{width} {turn}");
    }
}

#[test]
fn as_wide_a_gap_is_bridged_as_is_asked_for() {
    for (width, paper) in pairs(&WIDTHS[1..], &[1.0, 2.0, 3.0]) {
        for (gap, bridged) in [(paper - 0.5, 0), (paper + 0.5, 1)] {
            let options = Options::default().with(|o| o.gap = Some(gap));
            let figure = Figure::walked(&scan(&broken(width, 20.0, paper * width)), options);
            assert_eq!(figure.changes("gap"), Some(bridged), "{width} {paper} {gap}");
        }
    }
}

#[test]
fn what_is_as_good_another_way_is_doubtful() {
    for width in WIDTHS {
        let arms = [0.0, 120.0, 240.0].map(|turn| line(CENTER, polar(CENTER, turn + 10.0, 45.0), width));
        let figure = walked(arms.to_vec());
        let doubtful = |graph: &StrokeGraph| graph.graph.node_weights().filter(|node| node.confidence < 0.5).count();
        assert_eq!(figure.changes("confidence"), Some(doubtful(&figure.graph(&[]))));
        assert_eq!(doubtful(&figure.graph(&[])), 1, "{width}");
        assert_eq!(doubtful(&figure.graph(&["confidence"])), 0);
    }
}

#[test]
fn a_line_alone_and_a_corner_are_sure() {
    for (width, angle) in pairs(&WIDTHS, &[50.0, 90.0, 140.0]) {
        let tip = polar(CENTER, angle, 45.0);
        let figure = walked(vec![polyline(&[polar(CENTER, 0.0, 45.0), CENTER, tip], false, width)]);
        assert_eq!(figure.changes("confidence"), Some(0), "{width} {angle}");
    }
}

#[test]
fn an_end_that_all_but_touches_a_line_is_doubtful() {
    for (width, turn) in pairs(&[3.0, 4.5], &[0.0, 40.0]) {
        let stem = |gap: f64| line(polar(CENTER, turn + 90.0, width + gap), polar(CENTER, turn + 90.0, 45.0), width);
        let [near, far] = [0.4 * width, 2.0 * width].map(|gap| walked(vec![bar(turn, 45.0, width), stem(gap)]));
        assert_eq!((near.changes("confidence"), far.changes("confidence")), (Some(1), Some(0)), "{width} {turn}");
    }
}
