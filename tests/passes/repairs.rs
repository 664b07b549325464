//! The repairs of lines: lines in, lines out.

use crate::common::draw::{SPECKLESS, arc, circle, color_scan, dot, line, on_paper, polar, scan, sheet};
use crate::common::sweep::{pairs, steps};
use crate::figure::{Figure, nearest, off_circle, off_line, round, walk};
use fieldtrace::drawing::{Color, Drawing, Stroke};
use fieldtrace::graph::EndState::{Led, Lifted, Parted, RanIn};
use fieldtrace::options::Options;
use fieldtrace::streamline::{Stop, Streamline};
use kurbo::{Point, Vec2};
use std::f64::consts::{PI, TAU};

const CENTER: Point = Point::new(60.3, 59.8);
const WIDTHS: [f64; 3] = [2.0, 3.0, 4.5];
const OPEN: [Stop; 2] = [Stop::InkEnd; 2];
const MERGED: [Stop; 2] = [Stop::InkEnd, Stop::Merged];

fn page(strokes: Vec<Stroke>) -> Drawing {
    sheet(120, 120, strokes)
}

fn walked(strokes: Vec<Stroke>) -> Figure {
    Figure::walked(&scan(&page(strokes)), Options::default())
}

fn bar(turn: f64, reach: f64, width: f64) -> Stroke {
    line(polar(CENTER, turn, -reach), polar(CENTER, turn, reach), width)
}

/// A walk that is alone all along.
fn plain(chain: &[Point], width: f64, stops: [Stop; 2]) -> Streamline {
    walk(chain, width, stops, |_| false)
}

/// A pass by itself changes nothing on a figure.
#[track_caller]
fn leaves_alone(pass: &str, figure: &Figure) {
    let done = figure.alone(pass).expect("it is due");
    assert_eq!((done.changes, done.after.len()), (0, done.before.len()));
    let same = |(a, b): (&fieldtrace::graph::Line, &fieldtrace::graph::Line)| a.points == b.points && a.ends == b.ends;
    assert!(done.before.iter().zip(&done.after).all(same));
}

#[test]
fn dots_are_taken_out_of_the_lines() {
    for (width, share) in pairs(&WIDTHS, &[1.1, 1.5, 2.0]) {
        let figure = walked(vec![bar(20.0, 40.0, width), dot(polar(CENTER, 110.0, 25.0), share * width)]);
        let done = figure.alone("dot").expect("it is due");
        assert_eq!((done.changes, done.after.len()), (1, done.before.len() - 1), "{width} {share}");
    }
}

#[test]
fn a_short_line_is_no_dot() {
    for (width, length) in pairs(&WIDTHS, &[3.0, 4.0]) {
        let from = polar(CENTER, 110.0, 25.0);
        leaves_alone("dot", &walked(vec![bar(20.0, 40.0, width), line(from, polar(from, 0.0, length * width), width)]));
    }
}

#[test]
fn a_dot_on_a_line_is_no_dot() {
    for (width, beside) in pairs(&WIDTHS, &[0.6, 0.9]) {
        leaves_alone(
            "dot",
            &walked(vec![bar(20.0, 40.0, width), dot(polar(CENTER, 110.0, beside * width), 1.4 * width)]),
        );
    }
}

/// A bar, and a walk that comes to it at 40 degrees and goes on along it.
fn going_along(width: f64, turn: f64, length: f64) -> Figure {
    let (left, right) = (polar(CENTER, turn, -45.0), polar(CENTER, turn, 45.0));
    let from = polar(CENTER, turn - 140.0, 40.0);
    let drawing = page(vec![line(left, right, width), line(from, CENTER, width)]);
    let along = polar(CENTER, turn, length * width);
    Figure::by_hand(&drawing, vec![plain(&[left, right], width, OPEN), plain(&[from, CENTER, along], width, MERGED)])
}

#[test]
fn what_an_end_shares_with_another_line_is_cut_off() {
    for ((width, turn), length) in pairs(&pairs(&WIDTHS, &[0.0, 30.0, 90.0, 200.0]), &[2.0, 4.0, 8.0]) {
        let done = going_along(width, turn, length).alone("overlap").expect("it is due");
        assert_eq!((done.changes, done.after.len()), (1, 2));
        assert_eq!(done.after[0].points, done.before[0].points);
        let last = done.after[1].points[done.after[1].points.len() - 1];
        assert!((last - CENTER).hypot() < 0.5 * width + 1.0, "{width} {turn} {length}: {last:?}");
        assert_eq!(done.after[1].ends[1], RanIn);
    }
}

#[test]
fn an_overlap_of_a_point_or_two_stays() {
    for (width, turn) in pairs(&WIDTHS, &[0.0, 30.0, 200.0]) {
        leaves_alone("overlap", &going_along(width, turn, 0.3));
    }
}

#[test]
fn a_line_with_nothing_of_its_own_is_dropped() {
    for (width, beside) in pairs(&WIDTHS, &[0.0, 0.2, 0.5]) {
        let ends = [-40.0, 40.0].map(|s| polar(CENTER, 0.0, s));
        let inner = [-15.0, 20.0].map(|s| polar(CENTER, 0.0, s) + Vec2::new(0.0, beside));
        let walks = vec![plain(&ends, width, OPEN), plain(&inner, width, OPEN)];
        let done = Figure::by_hand(&page(vec![bar(0.0, 40.0, width)]), walks).alone("overlap").expect("it is due");
        assert_eq!(done.after.len(), 1);
    }
}

#[test]
fn lines_that_cross_do_not_overlap() {
    for (width, between) in pairs(&WIDTHS, &[30.0, 60.0, 90.0]) {
        leaves_alone("overlap", &crossing(width, 10.0, between, false));
    }
}

/// A bar and a stem of pencil, the stem ending so many pixels of paper before the bar.
fn pencil_stem(width: f64, turn: f64, gap: Option<f64>) -> Figure {
    let short = gap.map_or(0.0, |gap| width + gap);
    let stem = line(polar(CENTER, turn + 90.0, short), polar(CENTER, turn + 90.0, 45.0), width);
    Figure::walked(&on_paper(&page(vec![bar(turn, 45.0, width), stem]), SPECKLESS, turn as u64), Options::default())
}

#[test]
fn a_pencil_that_was_lifted_before_a_body_is_known_to_be() {
    let cases = pairs(&pairs(&[2.5, 3.5], &[0.0, 35.0, 90.0, 160.0]), &[1.0, 1.5, 2.0]);
    let mut known = 0;
    for &((width, turn), gap) in &cases {
        let done = pencil_stem(width, turn, Some(gap)).in_turn("gap before a body").expect("it is due");
        let lifted = done.ends(Lifted);
        assert_eq!((done.changes, lifted.len().min(1)), (lifted.len(), lifted.len()), "{width} {turn} {gap}");
        let height = |end: &Point| (*end - CENTER).dot(Vec2::from_angle((turn + 90.0).to_radians()));
        let is_between = |end: &Point| (0.5 * width..1.5 * width + gap).contains(&height(end));
        assert!(lifted.iter().all(is_between), "{width} {turn} {gap}: {lifted:?}");
        known += lifted.len();
    }
    assert!(4 * known >= 3 * cases.len(), "{known} of {}", cases.len());
}

#[test]
fn a_pencil_that_reached_the_body_was_not_lifted() {
    for (width, turn) in pairs(&[2.5, 3.5], &[0.0, 35.0, 90.0, 160.0]) {
        let done = pencil_stem(width, turn, None).in_turn("gap before a body").expect("it is due");
        assert_eq!(done.changes, 0, "{width} {turn}");
    }
}

#[test]
fn on_a_clean_page_paper_is_seen_and_not_asked_for() {
    let stem = line(polar(CENTER, 90.0, 5.0), polar(CENTER, 90.0, 45.0), 3.0);
    let done = walked(vec![bar(0.0, 45.0, 3.0), stem]).alone("gap before a body");
    assert!(done.is_none_or(|done| done.changes == 0));
}

/// A circle on a bar, and half the length over which their inks are one.
struct Touch {
    middle: Point,
    radius: f64,
    turn: f64,
    width: f64,
}

impl Touch {
    fn drawing(&self) -> Drawing {
        page(vec![bar(self.turn, 50.0, self.width), circle(self.middle, self.radius, self.width)])
    }

    fn of(width: f64, radius: f64, turn: f64) -> Self {
        Self { middle: polar(CENTER, turn - 90.0, radius), radius, turn, width }
    }

    fn is_shared(&self, p: Point) -> bool {
        (p - CENTER).hypot() < (2.0 * self.radius * self.width).sqrt()
    }

    /// Once around, from the touch on, the way that the bar goes.
    fn ring(&self) -> Vec<Point> {
        round(self.middle, self.radius, self.turn.to_radians() + 0.5 * PI, -TAU)
    }

    fn walk(&self, chain: &[Point]) -> Streamline {
        walk(chain, self.width, OPEN, |p| self.is_shared(p))
    }
}

#[test]
fn a_walk_that_took_a_circle_along_is_a_bar_and_a_circle() {
    for ((width, radius), turn) in pairs(&pairs(&WIDTHS, &[16.0, 24.0]), &[0.0, 40.0, 130.0]) {
        let touch = Touch::of(width, radius, turn);
        let ends = [-50.0, 50.0].map(|s| polar(CENTER, turn, s));
        let chain = [vec![ends[0]], touch.ring(), vec![ends[1]]].concat();
        let done = Figure::by_hand(&touch.drawing(), vec![touch.walk(&chain)]).alone("tangency").expect("it is due");
        assert_eq!((done.changes, done.after.len()), (1, 2), "{width} {radius} {turn}");
        let (rings, bars): (Vec<_>, Vec<_>) = done.after.iter().partition(|line| line.closed);
        assert!(off_line(bars[0], CENTER, turn.to_radians()) < 0.6, "{width} {radius} {turn}");
        assert!(off_circle(rings[0], touch.middle, radius) < 0.2 * width + 0.5, "{width} {radius} {turn}");
    }
}

#[test]
fn a_bar_that_touches_a_circle_is_left_alone() {
    for ((width, radius), turn) in pairs(&pairs(&WIDTHS, &[16.0, 24.0]), &[0.0, 40.0, 130.0]) {
        let touch = Touch::of(width, radius, turn);
        let bar = touch.walk(&[-50.0, 50.0].map(|s| polar(CENTER, turn, s)));
        let mut ring = touch.walk(&touch.ring());
        ring.points.pop();
        ring.widths.pop();
        leaves_alone("tangency", &Figure::by_hand(&touch.drawing(), vec![bar, Streamline { closed: true, ..ring }]));
    }
}

#[test]
fn an_eight_of_two_circles_that_touch_is_two_circles() {
    for (width, radius) in pairs(&WIDTHS, &[16.0, 22.0]) {
        let middles = [0.0, 180.0].map(|turn| polar(CENTER, turn, radius));
        let drawing = page(middles.map(|middle| circle(middle, radius, width)).to_vec());
        // Down one circle and up the other, as a pen could have drawn it.
        let mut chain = [round(middles[0], radius, PI, -TAU), round(middles[1], radius, 0.0, TAU)].concat();
        chain.pop();
        let shared = |p: Point| (p - CENTER).hypot() < (radius * width).sqrt();
        let eight = Streamline { closed: true, ..walk(&chain, width, OPEN, shared) };
        let done = Figure::by_hand(&drawing, vec![eight]).alone("tangency").expect("it is due");
        assert_eq!((done.changes, done.after.len()), (1, 2), "{width} {radius}");
        assert!(done.after.iter().all(|line| line.closed), "{width} {radius}");
    }
}

/// Two humps that meet at a tip, each walked to where the inks are one.
fn humps(width: f64, radius: f64, turn: f64) -> (Point, Figure) {
    let tip = polar(CENTER, turn, -0.5 * radius);
    let middles = [-1.0, 1.0].map(|side| polar(tip, turn + side * 90.0, radius));
    let strokes = [(0, -60.0), (1, -90.0)]
        .map(|(k, from)| arc(middles[k], radius, f64::to_radians(turn + from), f64::to_radians(150.0), width));
    (tip, walked(strokes.to_vec()))
}

#[test]
fn two_humps_go_on_to_the_tip_between_them() {
    let cases = pairs(&pairs(&WIDTHS, &[16.0, 24.0]), &steps(0.0, 315.0, 45.0));
    let mut led = 0;
    for ((width, radius), turn) in &cases {
        let (tip, figure) = humps(*width, *radius, *turn);
        let done = figure.in_turn("cusp").expect("it is due");
        let ends = done.ends(Led);
        assert_eq!(done.changes, ends.len());
        assert!(ends.iter().all(|end| (*end - tip).hypot() < 0.5 * width + 0.75), "{width} {radius} {turn}: {ends:?}");
        led += usize::from(ends.len() == 2);
    }
    assert!(3 * led >= 2 * cases.len(), "{led} of {}", cases.len());
}

#[test]
fn straight_lines_meet_in_a_corner_and_not_in_a_cusp() {
    for ((width, opening), turn) in pairs(&pairs(&WIDTHS, &[20.0, 40.0, 90.0]), &[0.0, 100.0]) {
        let arms = [-0.5, 0.5].map(|side| line(CENTER, polar(CENTER, turn + side * opening, 45.0), width));
        leaves_alone("cusp", &walked(arms.to_vec()));
    }
}

#[test]
fn humps_that_are_apart_have_no_cusp() {
    for (width, radius) in pairs(&WIDTHS, &[16.0, 24.0]) {
        let hump = |side: f64| {
            let middle = polar(CENTER, side * 90.0, radius + 2.0 * width);
            arc(middle, radius, f64::to_radians(if side < 0.0 { -60.0 } else { -90.0 }), f64::to_radians(150.0), width)
        };
        leaves_alone("cusp", &walked(vec![hump(-1.0), hump(1.0)]));
    }
}

/// A straight line, an arm that leaves it by an angle, and walks: the first from the stem along one or the other, the second
/// along what is left, up to the first's ink.
fn fork(width: f64, turn: f64, angle: f64, is_straight: bool) -> Figure {
    let (stem, ahead) = (polar(CENTER, turn, -50.0), polar(CENTER, turn, 50.0));
    let aside = polar(CENTER, turn + angle, 45.0);
    let drawing = page(vec![line(stem, ahead, width), line(CENTER, aside, width)]);
    let parting = width / angle.to_radians().tan();
    let shared = |p: Point| (p - CENTER).hypot() < parting && (p - CENTER).dot(ahead - CENTER) > 0.0;
    let (first, second) = if is_straight { (ahead, aside) } else { (aside, ahead) };
    let body = walk(&[stem, CENTER, first], width, OPEN, shared);
    let back = CENTER + (second - CENTER) * (parting / (second - CENTER).hypot());
    Figure::by_hand(&drawing, vec![body, plain(&[second, back], width, MERGED)])
}

#[test]
fn the_straighter_arm_of_a_fork_is_the_stems() {
    for ((width, turn), angle) in pairs(&pairs(&WIDTHS, &[0.0, 70.0, 200.0]), &[18.0, 25.0]) {
        let done = fork(width, turn, angle, false).alone("fork").expect("it is due");
        assert_eq!((done.changes, done.after.len()), (1, 2), "{width} {turn} {angle}");
        let off = done.after.iter().map(|line| off_line(line, CENTER, turn.to_radians()));
        assert!(off.fold(f64::INFINITY, f64::min) < 0.5, "{width} {turn} {angle}");
        assert_eq!(done.ends(RanIn).len(), 1);
    }
}

#[test]
fn a_fork_whose_stem_goes_straight_on_is_left_alone() {
    for ((width, turn), angle) in pairs(&pairs(&WIDTHS, &[0.0, 70.0, 200.0]), &[18.0, 25.0]) {
        leaves_alone("fork", &fork(width, turn, angle, true));
    }
}

#[test]
fn a_tee_is_no_fork() {
    for ((width, turn), angle) in pairs(&pairs(&WIDTHS, &[0.0, 70.0]), &[60.0, 90.0]) {
        let stem = line(CENTER, polar(CENTER, turn + angle, 45.0), width);
        leaves_alone("fork", &walked(vec![bar(turn, 45.0, width), stem]));
    }
}

const RED: Color = Color([200, 20, 30]);
const BLUE: Color = Color([30, 60, 200]);

fn inked(stroke: Stroke, color: Color) -> Stroke {
    Stroke { color, ..stroke }
}

fn colored(strokes: Vec<Stroke>) -> Figure {
    Figure::walked(&color_scan(&page(strokes), Color([255; 3])), Options::default())
}

#[test]
fn a_line_is_cut_where_its_colour_changes() {
    for (width, turn) in pairs(&WIDTHS, &[0.0, 25.0, 70.0]) {
        let half = |reach: f64| line(CENTER, polar(CENTER, turn, reach), width);
        let figure = colored(vec![inked(half(-45.0), RED), inked(half(45.0), BLUE)]);
        let done = figure.alone("colour change").expect("it is due");
        assert_eq!((done.changes, done.after.len()), (1, 2), "{width} {turn}");
        assert!(done.ends(Parted).iter().all(|end| (*end - CENTER).hypot() < width + 2.0), "{width} {turn}");
    }
}

#[test]
fn a_line_of_one_pen_stays_whole_under_another() {
    for (width, turn) in pairs(&WIDTHS, &[0.0, 25.0, 70.0]) {
        let figure = colored(vec![inked(bar(turn, 45.0, width), RED), inked(bar(turn + 80.0, 45.0, width), BLUE)]);
        leaves_alone("colour change", &figure);
    }
}

#[test]
fn on_a_grey_page_no_line_changes_its_colour() {
    leaves_alone("colour change", &walked(vec![bar(0.0, 45.0, 3.0)]));
}

/// A bar and an arc that leaves it along its tangent, walked back to where the inks become one.
fn branch(width: f64, radius: f64, turn: f64, stop: Stop) -> Figure {
    let middle = polar(CENTER, turn + 90.0, radius);
    let over = 45.0 / radius;
    let from = (turn - 90.0).to_radians();
    let drawing = page(vec![bar(turn, 50.0, width), arc(middle, radius, from, over, width)]);
    let alone = (1.4 * width / radius).sqrt();
    let mut back = round(middle, radius, from + alone, over - alone);
    back.reverse();
    let ends = [-50.0, 50.0].map(|s| polar(CENTER, turn, s));
    let shared = |p: Point| {
        let along = (p - CENTER).dot(Vec2::from_angle(turn.to_radians()));
        (0.0..(2.0 * radius * width).sqrt()).contains(&along)
    };
    Figure::by_hand(&drawing, vec![walk(&ends, width, OPEN, shared), plain(&back, width, [Stop::InkEnd, stop])])
}

#[test]
fn an_arc_is_led_to_where_it_leaves_a_line() {
    for ((width, radius), turn) in pairs(&pairs(&WIDTHS, &[40.0, 70.0]), &[0.0, 30.0, 110.0]) {
        let done = branch(width, radius, turn, Stop::Merged).alone("tangent end").expect("it is due");
        let led = done.ends(Led);
        assert_eq!((done.changes, led.len()), (1, 1), "{width} {radius} {turn}");
        let off = led[0] - CENTER;
        assert!(off.cross(Vec2::from_angle(turn.to_radians())).abs() < 0.5, "{width} {radius} {turn}: {off:?}");
        assert!(off.hypot() < 0.5 * (2.0 * radius * width).sqrt(), "{width} {radius} {turn}: {off:?}");
    }
}

#[test]
fn a_line_that_goes_on_unseen_is_led_nowhere() {
    for (width, stop) in pairs(&WIDTHS, &[Stop::Border, Stop::Solid]) {
        leaves_alone("tangent end", &branch(width, 40.0, 30.0, stop));
    }
}

#[test]
fn a_tee_meets_its_body_at_no_small_angle() {
    for ((width, turn), angle) in pairs(&pairs(&WIDTHS, &[0.0, 70.0]), &[60.0, 90.0]) {
        let stem = line(CENTER, polar(CENTER, turn + angle, 45.0), width);
        leaves_alone("tangent end", &walked(vec![bar(turn, 45.0, width), stem]));
    }
}

/// Two lines that cross, walked straight or by each other's arm.
fn crossing(width: f64, turn: f64, between: f64, is_swapped: bool) -> Figure {
    let reach = 0.5 * width / (0.5 * between.to_radians()).sin();
    let shared = |p: Point| (p - CENTER).hypot() < reach;
    let at = |turn: f64| polar(CENTER, turn, 50.0);
    let (a, b) = (turn, turn + between);
    let arms = if is_swapped { [[a + 180.0, b], [b + 180.0, a]] } else { [[a + 180.0, a], [b + 180.0, b]] };
    let walks = arms.map(|[from, to]| walk(&[at(from), CENTER, at(to)], width, OPEN, shared));
    Figure::by_hand(&page(vec![bar(a, 50.0, width), bar(b, 50.0, width)]), walks.to_vec())
}

#[test]
fn lines_that_took_each_others_arms_are_cut() {
    for ((width, turn), between) in pairs(&pairs(&WIDTHS, &[0.0, 40.0]), &[20.0, 40.0, 70.0]) {
        let done = crossing(width, turn, between, true).alone("swapped arms").expect("it is due");
        assert_eq!((done.changes, done.after.len()), (2, 4), "{width} {turn} {between}");
        let cuts = done.ends(Parted);
        assert!(cuts.len() == 4 && cuts.iter().all(|p| (*p - CENTER).hypot() < width), "{width} {turn} {between}");
    }
}

#[test]
fn lines_that_cross_straight_are_not_cut() {
    for ((width, turn), between) in pairs(&pairs(&WIDTHS, &[0.0, 40.0]), &[20.0, 40.0, 70.0, 90.0]) {
        leaves_alone("swapped arms", &crossing(width, turn, between, false));
    }
}

#[test]
fn the_parts_of_swapped_lines_become_the_lines_that_cross() {
    for (width, between) in pairs(&WIDTHS, &[30.0, 60.0]) {
        let graph = crossing(width, 10.0, between, true).graph(&[]);
        assert_eq!(graph.trails.len(), 2, "{width} {between}");
        for trail in &graph.trails {
            let points = trail.edges.iter().flat_map(|(edge, _)| &graph.graph[*edge].points);
            let ends: Vec<Point> = points.copied().filter(|p| (*p - CENTER).hypot() > 45.0).collect();
            let turns = [10.0, 10.0 + between].map(|turn| Vec2::from_angle(f64::to_radians(turn)));
            let on = |turn: &Vec2| ends.iter().all(|p| (*p - CENTER).cross(*turn).abs() < 1.0);
            assert!(turns.iter().any(on), "{width} {between}");
        }
    }
}

/// A straight line of which one half was walked with a branch, and the other half by itself.
fn branched(width: f64, turn: f64, angle: f64) -> Figure {
    let (stem, ahead) = (polar(CENTER, turn, -50.0), polar(CENTER, turn, 50.0));
    let aside = polar(CENTER, turn + angle, 45.0);
    let drawing = page(vec![line(stem, ahead, width), line(CENTER, aside, width)]);
    let shared = |p: Point| (p - CENTER).hypot() < 0.8 * width;
    let walks = vec![walk(&[stem, CENTER, aside], width, OPEN, shared), walk(&[ahead, CENTER], width, OPEN, shared)];
    Figure::by_hand(&drawing, walks)
}

#[test]
fn a_body_that_took_a_branch_is_cut_where_the_line_goes_on() {
    for ((width, turn), angle) in pairs(&pairs(&WIDTHS, &[0.0, 70.0, 200.0]), &[35.0, 50.0, 75.0]) {
        let done = branched(width, turn, angle).alone("wrong arm").expect("it is due");
        assert_eq!((done.changes, done.after.len()), (1, 3), "{width} {turn} {angle}");
        assert!(nearest(CENTER, &done.ends(Parted)) < width, "{width} {turn} {angle}");
    }
}

#[test]
fn a_straight_body_is_not_cut() {
    for ((width, turn), angle) in pairs(&pairs(&WIDTHS, &[0.0, 70.0]), &[50.0, 90.0, 130.0]) {
        let stem = line(CENTER, polar(CENTER, turn + angle, 45.0), width);
        leaves_alone("wrong arm", &walked(vec![bar(turn, 45.0, width), stem]));
    }
}

#[test]
fn corners_are_not_cut() {
    for ((width, turn), angle) in pairs(&pairs(&WIDTHS, &[0.0, 70.0]), &[40.0, 90.0, 130.0]) {
        let tips = [0.0, angle].map(|side| polar(CENTER, turn + side, 45.0));
        let shared = |p: Point| (p - CENTER).hypot() < 0.8 * width;
        let walks = tips.map(|tip| walk(&[tip, CENTER], width, OPEN, shared));
        let drawing = page(tips.map(|tip| line(CENTER, tip, width)).to_vec());
        leaves_alone("wrong arm", &Figure::by_hand(&drawing, walks.to_vec()));
    }
}
