//! Technical drawings at random: parts, plans, circuits and boxes as one draws them with ruler and compasses.

use fieldtrace::drawing::{Centreline, Drawing, Segment, Stroke};
use kurbo::{Affine, Arc, Circle, CubicBez, Line, Point, Vec2};
use rand::Rng;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Longer side of a drawing in pixels.
const SIZE: f64 = 512.0;

/// The kinds of drawings, in turn.
type Draw = fn(&mut Sheet, &mut dyn rand::RngCore);

/// Names and how they are drawn.
pub const KINDS: [(&str, Draw); 6] = [
    ("flange", flange),
    ("plate", plate),
    ("plan", plan),
    ("stairs", stairs),
    ("circuit", circuit),
    ("box", isometric_box),
];

/// A drawing of a kind.
pub fn drawing(draw: Draw, rng: &mut dyn rand::RngCore) -> Drawing {
    let width = rng.random_range(1.6..4.5);
    let mut sheet = Sheet { drawing: Drawing::new(SIZE, SIZE), width };
    draw(&mut sheet, rng);
    sheet.drawing
}

/// A drawing under construction, with its pen.
pub struct Sheet {
    drawing: Drawing,
    width: f64,
}

impl Sheet {
    fn add(&mut self, centreline: Centreline) {
        self.drawing.strokes.push(Stroke::new(centreline, self.width));
    }

    fn path(&mut self, segments: Vec<Segment>, closed: bool) {
        self.add(Centreline::Path { segments, closed });
    }

    fn line(&mut self, a: Point, b: Point) {
        self.path(vec![Segment::Line(Line::new(a, b))], false);
    }

    fn polyline(&mut self, points: &[Point], closed: bool) {
        let mut segments: Vec<_> = points.windows(2).map(|p| Segment::Line(Line::new(p[0], p[1]))).collect();
        if closed {
            segments.push(Segment::Line(Line::new(points[points.len() - 1], points[0])));
        }
        self.path(segments, closed);
    }

    fn circle(&mut self, centre: Point, radius: f64) {
        self.add(Centreline::Circle(Circle::new(centre, radius)));
    }

    fn arc(&mut self, centre: Point, radius: f64, from: f64, sweep: f64) {
        self.path(vec![arc(centre, radius, from, sweep)], false);
    }

    /// A rectangle whose corners are rounded.
    fn rounded(&mut self, (x0, y0): (f64, f64), (x1, y1): (f64, f64), radius: f64) {
        let centres = [
            (x1 - radius, y0 + radius),
            (x1 - radius, y1 - radius),
            (x0 + radius, y1 - radius),
            (x0 + radius, y0 + radius),
        ];
        let corner = |i: usize| arc(Point::from(centres[i]), radius, (i as f64 - 1.0) * FRAC_PI_2, FRAC_PI_2);
        let corners: Vec<_> = (0..4).map(corner).collect();
        let sides =
            (0..4).flat_map(|i| [corners[i], Segment::Line(Line::new(corners[i].end(), corners[(i + 1) % 4].start()))]);
        self.path(sides.collect(), true);
    }

    /// A line with an arrow at each end, `apart` beside the line from `a` to `b` that it measures, and the lines that lead
    /// to it.
    fn dimension(&mut self, a: Point, b: Point, apart: f64) {
        let along = (b - a).normalize();
        let beside = Vec2::new(-along.y, along.x) * apart;
        for p in [a, b] {
            self.line(p + beside * 0.25, p + beside * 1.25);
        }
        let (a, b) = (a + beside, b + beside);
        self.line(a, b);
        for (tip, back) in [(a, along), (b, -along)] {
            let side = Vec2::new(-back.y, back.x);
            self.polyline(&[tip + back * 16.0 + side * 6.0, tip, tip + back * 16.0 - side * 6.0], false);
        }
    }
}

fn arc(center: Point, radius: f64, start_angle: f64, sweep_angle: f64) -> Segment {
    Segment::Arc(Arc { center, radii: Vec2::new(radius, radius), start_angle, sweep_angle, x_rotation: 0.0 })
}

fn polar(centre: Point, radius: f64, angle: f64) -> Point {
    centre + radius * Vec2::from_angle(angle)
}

/// Circles about one centre, holes around them, a keyway, lines through the centre.
fn flange(sheet: &mut Sheet, rng: &mut dyn rand::RngCore) {
    let centre = Point::new(SIZE / 2.0, SIZE / 2.0);
    let outer = rng.random_range(170.0..215.0);
    let bore = outer * rng.random_range(0.2..0.3);
    let pitch = outer * rng.random_range(0.62..0.74);
    sheet.circle(centre, outer);
    let half = rng.random_range(0.2..0.35);
    sheet.arc(centre, bore, half - FRAC_PI_2, TAU - 2.0 * half);
    let [left, right] = [-FRAC_PI_2 - half, half - FRAC_PI_2].map(|angle| polar(centre, bore, angle));
    let up = Vec2::new(0.0, -0.3 * bore);
    sheet.polyline(&[left, left + up, right + up, right], false);
    let holes = rng.random_range(3..9);
    let turn = rng.random_range(0.0..TAU);
    for i in 0..holes {
        sheet.circle(polar(centre, pitch, turn + TAU * f64::from(i) / f64::from(holes)), outer * 0.09);
    }
    for direction in [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)] {
        let reach = direction * (outer + 20.0);
        sheet.line(centre - reach, centre + reach);
    }
}

/// A rounded plate with holes, a slot and its dimensions.
fn plate(sheet: &mut Sheet, rng: &mut dyn rand::RngCore) {
    let (x0, y0) = (rng.random_range(40.0..70.0), rng.random_range(90.0..130.0));
    let (x1, y1) = (SIZE - rng.random_range(40.0..70.0), SIZE - rng.random_range(100.0..140.0));
    let radius = rng.random_range(18.0..45.0);
    sheet.rounded((x0, y0), (x1, y1), radius);
    for (x, y) in [(x0, y0), (x1, y0), (x1, y1), (x0, y1)] {
        let inwards = Vec2::new((SIZE / 2.0 - x).signum(), (SIZE / 2.0 - y).signum()) * (radius + 12.0);
        sheet.circle(Point::new(x, y) + inwards, rng.random_range(9.0..16.0));
    }
    let (half, end) = (rng.random_range(40.0..80.0), rng.random_range(18.0..30.0));
    let middle = Point::new(SIZE / 2.0, (y0 + y1) / 2.0);
    sheet.rounded((middle.x - half - end, middle.y - end), (middle.x + half + end, middle.y + end), end);
    sheet.dimension(Point::new(x0, y1), Point::new(x1, y1), rng.random_range(35.0..55.0));
    sheet.dimension(Point::new(middle.x - half, y0), Point::new(middle.x + half, y0), -rng.random_range(30.0..50.0));
}

/// Walls, doors with their swings, and windows of a floor.
fn plan(sheet: &mut Sheet, rng: &mut dyn rand::RngCore) {
    let (low, high) = (48.0, SIZE - 48.0);
    let (x, y) = (rng.random_range(190.0..330.0), rng.random_range(190.0..330.0));
    let door = rng.random_range(45.0..70.0);
    let corners = [(low, low), (high, low), (high, high), (low, high)].map(Point::from);
    sheet.polyline(&corners, true);
    // One wall goes through, with a door in each half; another meets it and has none.
    let (first, second) = (low + 20.0, x + 40.0);
    for (from, to) in [(low, first), (first + door, second), (second + door, high)] {
        sheet.line(Point::new(from, y), Point::new(to, y));
    }
    for hinge in [first, second] {
        let hinge = Point::new(hinge, y);
        sheet.line(hinge, hinge - Vec2::new(0.0, door));
        sheet.arc(hinge, door, -FRAC_PI_2, FRAC_PI_2);
    }
    sheet.line(Point::new(x, y), Point::new(x, if rng.random_bool(0.5) { low } else { high }));
    for _ in 0..rng.random_range(1..3) {
        let at = rng.random_range(low + 30.0..high - 130.0);
        let window = [(at, high - 9.0), (at, high + 9.0), (at + 90.0, high + 9.0), (at + 90.0, high - 9.0)];
        sheet.polyline(&window.map(Point::from), true);
    }
    sheet.circle(Point::new(low + 55.0, high - 60.0), rng.random_range(16.0..28.0));
}

/// Stairs from the side and from above, with the arrow that says where up is.
fn stairs(sheet: &mut Sheet, rng: &mut dyn rand::RngCore) {
    let steps = rng.random_range(6..11);
    let run = (SIZE - 110.0) / f64::from(steps);
    let rise = rng.random_range(0.35..0.6) * run;
    let foot = Point::new(55.0, 270.0);
    let mut side = vec![foot];
    for i in 0..steps {
        let from = foot + Vec2::new(f64::from(i) * run, -f64::from(i) * rise);
        side.extend([from - Vec2::new(0.0, rise), from + Vec2::new(run, -rise)]);
    }
    sheet.polyline(&side, false);
    let rail = Vec2::new(0.0, -rng.random_range(60.0..75.0));
    sheet.line(side[1] + rail, side[side.len() - 1] + rail);
    let (top, bottom) = (320.0, rng.random_range(400.0..460.0));
    let right = foot.x + f64::from(steps) * run;
    sheet.polyline(&[(foot.x, top), (right, top), (right, bottom), (foot.x, bottom)].map(Point::from), true);
    for i in 1..steps {
        let x = foot.x + f64::from(i) * run;
        sheet.line(Point::new(x, top), Point::new(x, bottom));
    }
    let (middle, tip) = ((top + bottom) / 2.0, right - 0.5 * run);
    sheet.line(Point::new(foot.x + 0.5 * run, middle), Point::new(tip, middle));
    sheet.polyline(&[(tip - 16.0, middle - 10.0), (tip, middle), (tip - 16.0, middle + 10.0)].map(Point::from), false);
}

/// A ladder of a circuit: resistors, capacitors and coils between two wires, and a source.
fn circuit(sheet: &mut Sheet, rng: &mut dyn rand::RngCore) {
    let (left, right) = (80.0, SIZE - 70.0);
    let (top, bottom) = (rng.random_range(110.0..150.0), rng.random_range(350.0..400.0));
    let middle = (top + bottom) / 2.0;
    let source = rng.random_range(26.0..38.0);
    sheet.circle(Point::new(left, middle), source);
    let above = [(left, middle - source), (left, top), (right, top)];
    let below = [(left, middle + source), (left, bottom), (right, bottom)];
    sheet.polyline(&above.map(Point::from), false);
    sheet.polyline(&below.map(Point::from), false);
    let branches = rng.random_range(2..4);
    for i in 1..=branches {
        let x = left + (right - left) * f64::from(i) / f64::from(branches);
        let (from, to) = (Point::new(x, middle - 45.0), Point::new(x, middle + 45.0));
        match rng.random_range(0..3) {
            0 => resistor(sheet, from, to),
            1 => capacitor(sheet, from, to),
            _ => coil(sheet, from, to),
        }
        sheet.line(Point::new(x, top), from);
        sheet.line(to, Point::new(x, bottom));
    }
}

fn resistor(sheet: &mut Sheet, from: Point, to: Point) {
    let half = Vec2::new(17.0, 0.0);
    sheet.polyline(&[from - half, from + half, to + half, to - half], true);
}

/// The wire goes on to each plate.
fn capacitor(sheet: &mut Sheet, from: Point, to: Point) {
    let (half, gap) = (Vec2::new(26.0, 0.0), Vec2::new(0.0, 9.0));
    let middle = from.midpoint(to);
    for (wire, plate) in [(from, middle - gap), (to, middle + gap)] {
        sheet.line(plate - half, plate + half);
        sheet.line(wire, plate);
    }
}

fn coil(sheet: &mut Sheet, from: Point, to: Point) {
    let turns = 4;
    let radius = (to.y - from.y) / f64::from(2 * turns);
    let bow = |i: i32| arc(from + Vec2::new(0.0, f64::from(2 * i + 1) * radius), radius, -FRAC_PI_2, PI);
    sheet.path((0..turns).map(bow).collect(), false);
}

/// A box seen along a diagonal, with a hole in each face that is to be seen.
fn isometric_box(sheet: &mut Sheet, rng: &mut dyn rand::RngCore) {
    let [a, b, c] =
        [PI / 6.0, PI - PI / 6.0, FRAC_PI_2].map(|angle| Vec2::from_angle(angle) * rng.random_range(130.0..190.0));
    let near = Point::new(SIZE / 2.0, SIZE / 2.0) - (a + b) * 0.5 - c * 0.5;
    let corner = near + a + b;
    // The outline, then the three edges that meet at the corner in front.
    sheet.polyline(&[near, near + a, near + a + c, corner + c, near + b + c, near + b], true);
    for to in [near + a, near + b, corner + c] {
        sheet.line(corner, to);
    }
    for (origin, u, v) in [(near, a, b), (near + b, a, c), (near + a, b, c)] {
        let affine = Affine::new([u.x, u.y, v.x, v.y, origin.x, origin.y]);
        let radius = rng.random_range(0.18..0.32);
        // A quarter of a circle as a cubic: handles of 4/3 tan(pi/8).
        let handle = 0.552_284_75;
        let quarter = |i: usize| {
            let [p, q] = [i, i + 1].map(|i| Vec2::from_angle(i as f64 * FRAC_PI_2));
            let at = |v: Vec2| affine * (Point::new(0.5, 0.5) + radius * v);
            Segment::Cubic(CubicBez::new(at(p), at(p + handle * q), at(q + handle * p), at(q)))
        };
        sheet.path((0..4).map(quarter).collect(), true);
    }
}
