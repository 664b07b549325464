//! A little drawing with the lines on it, and what passes make of them.

use crate::common::draw::scan;
use fieldtrace::cancel::Cancel;
use fieldtrace::clean::{LineImage, clean};
use fieldtrace::drawing::Drawing;
use fieldtrace::estimate::{FieldEstimator, StructureTensor};
use fieldtrace::field::FrameField;
use fieldtrace::graph::{EndState, Line, Passes, Ran, StrokeGraph, Work, passes};
use fieldtrace::load::Scan;
use fieldtrace::options::Options;
use fieldtrace::streamline::{Stop, Streamline, trace};
use kurbo::{Point, Vec2};

/// Distance between the points of a line, in pixels.
const STEP: f64 = 0.5;

/// An image with walks along its lines.
pub struct Figure {
    image: LineImage,
    walks: Vec<Streamline>,
    options: Options,
}

/// What a pass did to lines, in pixels of the scan.
pub struct Done {
    /// How much it changed.
    pub changes: usize,
    /// The lines before it and after it.
    pub before: Vec<Line>,
    pub after: Vec<Line>,
}

impl Figure {
    /// A scan with the walks that a trace takes.
    pub fn walked(scan: &Scan, options: Options) -> Self {
        let image = clean(scan, &options);
        let field = StructureTensor::default().estimate(&image).expect("a field for any image");
        let walks = trace(&image, &FrameField::new(field), &Cancel::default()).expect("nobody cancels");
        Self { image, walks, options }
    }

    /// A clean drawing with walks by hand.
    pub fn by_hand(drawing: &Drawing, walks: Vec<Streamline>) -> Self {
        let options = Options::default();
        let image = clean(&scan(drawing), &options);
        let walks = walks.into_iter().map(|walk| {
            let points = walk.points.iter().map(|p| scaled(*p, image.scale)).collect();
            Streamline { points, widths: walk.widths.iter().map(|w| w * image.scale).collect(), ..walk }
        });
        Self { walks: walks.collect(), image, options }
    }

    /// What a repair does without any other; `None` where it is not due.
    pub fn alone(&self, pass: &str) -> Option<Done> {
        self.done(pass, passes().map(|p| p.name).filter(|name| *name != pass))
    }

    /// What a repair does after all that come before it; `None` where it is not due.
    pub fn in_turn(&self, pass: &str) -> Option<Done> {
        self.done(pass, [].into_iter())
    }

    fn done(&self, pass: &str, without: impl Iterator<Item = &'static str>) -> Option<Done> {
        let in_scan = |line: &Line| {
            let points = line.points.iter().map(|p| scaled(*p, 1.0 / self.image.scale)).collect();
            Line { points, ..line.clone() }
        };
        let mut before: Vec<Line> = self.walks.iter().map(|walk| in_scan(&Line::from(walk))).collect();
        let mut done = None;
        self.run(without, &mut |ran, work| {
            let Work::Lines(lines) = work else { return };
            let after: Vec<Line> = lines.iter().map(in_scan).collect();
            let last = std::mem::replace(&mut before, after.clone());
            if ran.pass.name == pass {
                done = Some(Done { changes: ran.changes, before: last, after });
            }
        });
        done
    }

    /// How much a pass changes in its turn; `None` where it is not due.
    pub fn changes(&self, pass: &str) -> Option<usize> {
        let mut changes = None;
        self.run([].into_iter(), &mut |ran, _| {
            if ran.pass.name == pass {
                changes = Some(ran.changes);
            }
        });
        changes
    }

    /// The names of the passes that run without some of them.
    pub fn ran(&self, without: &[&'static str]) -> Vec<&'static str> {
        let mut names = Vec::new();
        self.run(without.iter().copied(), &mut |ran, _| names.push(ran.pass.name));
        names
    }

    /// The graph without some passes, in pixels of the scan.
    pub fn graph(&self, without: &[&'static str]) -> StrokeGraph {
        let mut graph = self.run(without.iter().copied(), &mut |_, _| ());
        let edges = graph.graph.edge_weights_mut();
        edges.flat_map(|edge| &mut edge.points).for_each(|p| *p = scaled(*p, 1.0 / self.image.scale));
        graph
    }

    fn run(&self, without: impl Iterator<Item = &'static str>, watch: &mut dyn FnMut(&Ran, Work)) -> StrokeGraph {
        let some = without.fold(Passes::default(), |passes, name| passes.without(name).expect("the name of a pass"));
        let mut watch = |ran: &Ran, work: Work| {
            watch(ran, work);
            Ok(())
        };
        some.build(&self.image, &self.walks, &self.options, &Cancel::default(), &mut watch).expect("nobody cancels")
    }
}

impl Done {
    /// The ends of open lines after it that are in a state.
    pub fn ends(&self, state: EndState) -> Vec<Point> {
        let open = self.after.iter().filter(|line| !line.closed);
        let both = open.flat_map(|line| [(line.ends[0], line.points.first()), (line.ends[1], line.points.last())]);
        both.filter_map(|(of, point)| point.copied().filter(|_| of == state)).collect()
    }
}

fn scaled(p: Point, factor: f64) -> Point {
    (p.to_vec2() * factor).to_point()
}

/// A walk along a chain of points, of a width but for where it is not alone.
pub fn walk(chain: &[Point], width: f64, stops: [Stop; 2], is_shared: impl Fn(Point) -> bool) -> Streamline {
    let mut points = vec![chain[0]];
    for pair in chain.windows(2) {
        let count = ((pair[1] - pair[0]).hypot() / STEP).ceil() as usize;
        points.extend((1..=count).map(|k| pair[0].lerp(pair[1], k as f64 / count as f64)));
    }
    let widths = points.iter().map(|p| if is_shared(*p) { f64::NAN } else { width }).collect();
    Streamline { points, widths, closed: false, stops }
}

/// Points half a pixel apart along a circle, from an angle in radians over another.
pub fn round(center: Point, radius: f64, from: f64, over: f64) -> Vec<Point> {
    let count = (radius * over.abs() / STEP).ceil() as usize;
    (0..=count).map(|k| center + Vec2::from_angle(from + over * k as f64 / count as f64) * radius).collect()
}

/// How far the points of a line are from a straight line, at most.
pub fn off_line(line: &Line, through: Point, angle: f64) -> f64 {
    let along = Vec2::from_angle(angle);
    line.points.iter().map(|p| (*p - through).cross(along).abs()).fold(0.0, f64::max)
}

/// How far the points of a line are from a circle, at most.
pub fn off_circle(line: &Line, center: Point, radius: f64) -> f64 {
    line.points.iter().map(|p| ((*p - center).hypot() - radius).abs()).fold(0.0, f64::max)
}

/// How far a place is from the nearest of some points.
pub fn nearest(p: Point, points: &[Point]) -> f64 {
    points.iter().map(|q| (*q - p).hypot()).fold(f64::INFINITY, f64::min)
}
