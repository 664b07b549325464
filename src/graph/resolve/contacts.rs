//! Where the ends of lines meet other lines.

use crate::clean::LineImage;
use crate::graph::lines::end::{End, end_id};
use crate::graph::point_index::PointIndex;
use crate::streamline::{STEP, Stop, Streamline};
use kurbo::{Line, Point, Vec2};
use rayon::prelude::*;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

/// An end sticks out of a line rather than ending at it when it goes further than the line's edge by this
/// share of a line width.
const PROTRUSION: f64 = 0.42;
/// Parts of one line are taken for different lines when they are this many line widths apart along it.
const OWN: f64 = 4.0;

/// Two ends that run along each other for at most this many line widths are one line.
const OVERLAP: f64 = 10.0;

/// A line's place: index of the line and a fractional index of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::graph) struct Place {
    pub line: usize,
    pub at: f64,
}

/// How far apart, in line widths, the walks along the arms of a blunt corner may end; where no grain can pass for ink,
/// their ends may be further apart.
const BLUNT: f64 = 1.2;
const BLUNT_ON_CLEAN: f64 = 3.0;

/// What an end meets.
#[derive(Clone, Copy, Debug)]
pub(in crate::graph) enum Touch {
    /// Another end (its number).
    End(usize),
    /// The body of a line.
    Body(Place),
}

/// An end that stops at a line.
#[derive(Clone, Copy, Debug)]
pub(in crate::graph) struct Contact {
    /// Number of the end.
    pub end: usize,
    pub touch: Touch,
    pub point: Point,
    /// How far the place lies from what the end's own edge tells, in pixels; the smaller the more plausible.
    pub misfit: f64,
}

type Piece = GeomWithData<rstar::primitives::Line<[f64; 2]>, (usize, usize)>;

/// All pieces of all lines, findable by place.
pub(in crate::graph) struct LineIndex<'a> {
    lines: &'a [Streamline],
    tree: RTree<Piece>,
}

impl<'a> LineIndex<'a> {
    pub fn new(lines: &'a [Streamline]) -> Self {
        let mut pieces = Vec::new();
        for (i, line) in lines.iter().enumerate() {
            for k in 0..piece_count(line) {
                let piece = piece(line, k);
                let ends = rstar::primitives::Line::new([piece.p0.x, piece.p0.y], [piece.p1.x, piece.p1.y]);
                pieces.push(GeomWithData::new(ends, (i, k)));
            }
        }
        Self { lines, tree: RTree::bulk_load(pieces) }
    }

    /// Crossings of a short segment with all lines: place, point, fraction along the segment. In a stable order.
    pub fn crossings(&self, segment: Line) -> Vec<(Place, Point, f64)> {
        let envelope = AABB::from_corners([segment.p0.x, segment.p0.y], [segment.p1.x, segment.p1.y]);
        let mut found: Vec<_> = self
            .tree
            .locate_in_envelope_intersecting(&envelope)
            .filter_map(|p| {
                let (line, k) = p.data;
                let (t, s) = intersect(segment, piece(&self.lines[line], k))?;
                Some((Place { line, at: k as f64 + s }, segment.p0.lerp(segment.p1, t), t))
            })
            .collect();
        found.sort_by(|a, b| (a.0.line, a.0.at).partial_cmp(&(b.0.line, b.0.at)).expect("finite"));
        found
    }

    /// Places of lines within `radius` of a point: the nearest one per line and pass, with its distance.
    pub fn near(&self, p: Point, radius: f64) -> Vec<(Place, Point, f64)> {
        let mut found: Vec<_> = self
            .tree
            .locate_within_distance([p.x, p.y], radius * radius)
            .map(|candidate| {
                let (line, k) = candidate.data;
                let piece = piece(&self.lines[line], k);
                let along = piece.p1 - piece.p0;
                let t = ((p - piece.p0).dot(along) / along.hypot2().max(1e-12)).clamp(0.0, 1.0);
                let foot = piece.p0 + along * t;
                (Place { line, at: k as f64 + t }, foot, (foot - p).hypot())
            })
            .collect();
        found.sort_by(|a, b| (a.2, a.0.line, a.0.at).partial_cmp(&(b.2, b.0.line, b.0.at)).expect("finite"));
        found
    }
}

/// Number of straight pieces of a line; a closed line has one more that leads back.
pub(in crate::graph) fn piece_count(line: &Streamline) -> usize {
    if line.closed { line.points.len() } else { line.points.len().saturating_sub(1) }
}

pub(in crate::graph) fn piece(line: &Streamline, k: usize) -> Line {
    Line::new(line.points[k], line.points[(k + 1) % line.points.len()])
}

/// Parameters at which two segments cross.
fn intersect(a: Line, b: Line) -> Option<(f64, f64)> {
    let (da, db) = (a.p1 - a.p0, b.p1 - b.p0);
    let det = da.cross(db);
    if det.abs() < 1e-12 {
        return None;
    }
    let d = b.p0 - a.p0;
    let (t, s) = (d.cross(db) / det, d.cross(da) / det);
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some((t, s))
}

/// The point of a line at a fractional index.
pub(in crate::graph) fn point_at(line: &Streamline, at: f64) -> Point {
    let n = line.points.len();
    let k = at.floor() as usize;
    line.points[k % n].lerp(line.points[(k + 1).min(if line.closed { k + 1 } else { n - 1 }) % n], at - at.floor())
}

/// Indices of the points within `reach` pixels along a line from a fractional index.
pub(in crate::graph) fn around(line: &Streamline, at: f64, reach: f64) -> impl Iterator<Item = usize> {
    let (n, closed) = (line.points.len() as i64, line.closed);
    let (at, span) = (at.round() as i64, (reach / STEP) as i64);
    let indices = (at - span..=at + span).map(move |k| if closed { k.rem_euclid(n) } else { k });
    indices.filter(move |k| (0..n).contains(k)).map(|k| k as usize)
}

/// Direction of a line at a place.
pub(in crate::graph) fn direction(lines: &[Streamline], place: Place) -> Vec2 {
    direction_at(&lines[place.line], place.at as usize)
}

/// Direction of a line from one of its points on.
pub(in crate::graph) fn direction_at(line: &Streamline, k: usize) -> Vec2 {
    let n = line.points.len();
    let k = k.min(piece_count(line).saturating_sub(1));
    let (a, b) = if line.closed {
        (line.points[(k + n - 2) % n], line.points[(k + 3) % n])
    } else {
        (line.points[k.saturating_sub(2)], line.points[(k + 3).min(n - 1)])
    };
    let d = b - a;
    if d.hypot() > 1e-9 { d.normalize() } else { Vec2::new(1.0, 0.0) }
}

/// Mean width of a line around a place; the typical one where it cannot be measured.
pub(in crate::graph) fn width_at(lines: &[Streamline], place: Place, typical: f64) -> f64 {
    let widths = &lines[place.line].widths;
    let k = (place.at as usize).min(widths.len() - 1);
    let around = &widths[k.saturating_sub(20)..(k + 20).min(widths.len())];
    let finite: Vec<f64> = around.iter().copied().filter(|w| w.is_finite()).collect();
    if finite.is_empty() { typical } else { finite.iter().sum::<f64>() / finite.len() as f64 }
}

/// What each end stops at; an end without a contact is free.
pub(in crate::graph) fn contacts(image: &LineImage, lines: &[Streamline], ends: &[Option<End>]) -> Vec<Contact> {
    let index = LineIndex::new(lines);
    let finder = Finder { image, lines, ends, index };
    let of_end = |end: &Option<End>| end.iter().flat_map(|end| finder.of_end(end)).collect::<Vec<_>>();
    let mut contacts: Vec<Contact> = ends.par_iter().flat_map_iter(of_end).collect();
    finder.join_overlaps(&mut contacts);
    contacts.extend(finder.blunt_corners(&contacts));
    contacts
}

struct Finder<'a> {
    image: &'a LineImage,
    lines: &'a [Streamline],
    ends: &'a [Option<End>],
    index: LineIndex<'a>,
}

impl Finder<'_> {
    fn of_end(&self, end: &End) -> Vec<Contact> {
        if end.stop.is_cut_off() || end.stop == Stop::Settled {
            return Vec::new();
        }
        if end.stop == Stop::Joined {
            return self.joined(end).into_iter().collect();
        }
        let mut contacts = self.crossed(end);
        if contacts.is_empty() {
            contacts.extend(self.beside(end));
        }
        contacts
    }

    /// The line on which an end lies.
    fn joined(&self, end: &End) -> Option<Contact> {
        let near = self.index.near(end.point, STEP);
        let (place, point, misfit) = near.into_iter().find(|(place, ..)| place.line != end.line)?;
        let touch = match self.end_near(place, 0.8 * self.image.line_width) {
            Some(other) => Touch::End(other),
            None => Touch::Body(place),
        };
        Some(Contact { end: end_id(end.line, end.side), touch, point, misfit })
    }

    /// Lines that the end's last stretch, or its straight continuation through ink, crosses.
    fn crossed(&self, end: &End) -> Vec<Contact> {
        let mut contacts = Vec::new();
        let extension = self.extension(end);
        let stretch = self.stretch(end, extension);
        let total: f64 = stretch.windows(2).map(|w| (w[1] - w[0]).hypot()).sum::<f64>() - extension;
        let mut walked = 0.0;
        for pair in stretch.windows(2) {
            let piece = Line::new(pair[0], pair[1]);
            let length = (pair[1] - pair[0]).hypot();
            for (place, point, t) in self.index.crossings(piece) {
                if self.is_own_neighbourhood(end, place) {
                    continue;
                }
                let beyond = total - (walked + t * length);
                contacts.extend(self.judge(end, place, point, pair[1] - pair[0], beyond));
            }
            walked += length;
        }
        contacts
    }

    /// The last part of the line towards this end, outwards, and so much of its continuation.
    fn stretch(&self, end: &End, extension: f64) -> Vec<Point> {
        let line = &self.lines[end.line];
        let n = line.points.len();
        let index = |k: usize| if end.side == 0 { k } else { n - 1 - k };
        let tip = if end.side == 0 { end.tip } else { n - 1 - end.tip };
        let count = (tip + (1.0 * end.width / STEP) as usize + 1).min(n - 1);
        let mut stretch: Vec<Point> = (0..=count).rev().map(|k| line.points[index(k)]).collect();
        if extension > 0.0
            && let [.., before, last] = stretch[..]
        {
            let d = last - before;
            stretch.push(last + d * (extension / d.hypot().max(1e-9)));
        }
        stretch
    }

    /// How far the end may be drawn out: as long as there is ink, at most a good half of a line width, or three
    /// where it ran into another line at a small angle.
    fn extension(&self, end: &End) -> f64 {
        let most = if end.stop == Stop::Merged { 3.0 } else { 0.6 } * self.image.line_width + 0.5;
        let n = self.lines[end.line].points.len();
        if n < 2 {
            return 0.0;
        }
        let (last, before) = if end.side == 0 { (0, 1) } else { (n - 1, n - 2) };
        let points = &self.lines[end.line].points;
        let heading = (points[last] - points[before]).normalize();
        let mut length = 0.0;
        while length < most && self.image.is_inked(end.point, end.point + heading * (length + 0.25), end.core) {
            length += 0.25;
        }
        length
    }

    fn is_own_neighbourhood(&self, end: &End, place: Place) -> bool {
        if place.line != end.line {
            return false;
        }
        let last = (self.lines[end.line].points.len() - 1) as f64;
        let (from_end, tip) = match end.side {
            0 => (place.at, end.tip as f64),
            _ => (last - place.at, last - end.tip as f64),
        };
        (from_end - tip) * STEP < OWN * end.width
    }

    /// Whether an end stops at the line that it crosses `beyond` pixels before its last point.
    fn judge(&self, end: &End, place: Place, point: Point, heading: Vec2, beyond: f64) -> Option<Contact> {
        let along = direction(self.lines, place);
        let sine = heading.normalize().cross(along).abs();
        // The smaller the angle, the longer are the inks one; at less than 25 degrees lines merge.
        let shared = 0.5 * end.width / sine.max(0.42);
        let sine = sine.max(0.5);
        let other_width = width_at(self.lines, place, self.image.line_width);
        let edge = 0.5 * other_width / sine;
        let slack = PROTRUSION * self.image.line_width.max(2.0);
        if beyond > edge + slack && end.stop != Stop::Merged {
            return None;
        }
        let touch = match self.end_near(place, shared + slack) {
            Some(other) if other != end_id(end.line, end.side) => Touch::End(other),
            _ => Touch::Body(place),
        };
        Some(Contact { end: end_id(end.line, end.side), touch, point, misfit: (beyond - edge).abs() })
    }

    /// The end of a line within `reach` pixels along it from a place.
    fn end_near(&self, place: Place, reach: f64) -> Option<usize> {
        let line = &self.lines[place.line];
        if line.closed {
            return None;
        }
        let to_last = (line.points.len() - 1) as f64 - place.at;
        let (side, distance) = if place.at <= to_last { (0, place.at) } else { (1, to_last) };
        let other = end_id(place.line, side);
        let merged = self.ends[other].is_some_and(|e| e.stop == Stop::Merged);
        let reach = if merged { reach + self.image.line_width } else { reach };
        (distance * STEP <= reach).then_some(other)
    }

    /// A line beside the end that its last stretch does not cross, joined to it by ink.
    fn beside(&self, end: &End) -> Option<Contact> {
        let reach = if end.stop == Stop::Merged { 0.75 } else { 0.9 } * self.image.line_width.max(1.5);
        let from = end.point;
        for (place, foot, distance) in self.index.near(from, reach) {
            if self.is_own_neighbourhood(end, place) {
                continue;
            }
            // What a walk merged with is one with its ink, even if a light spot lies between.
            if end.stop != Stop::Merged && !self.image.is_inked(from, foot, end.core) {
                continue;
            }
            let touch = match self.end_near(place, 0.8 * self.image.line_width) {
                Some(other) if other != end_id(end.line, end.side) => Touch::End(other),
                _ => Touch::Body(place),
            };
            return Some(Contact { end: end_id(end.line, end.side), touch, point: foot, misfit: distance });
        }
        None
    }

    /// Ends that met nothing but have another such end beside them, with ink between: the arms of a corner that is
    /// blunt, or of a hairpin.
    fn blunt_corners(&self, contacts: &[Contact]) -> Vec<Contact> {
        let mut met = vec![false; self.ends.len()];
        contacts.iter().for_each(|c| met[c.end] = true);
        let free = self.ends.iter().flatten().filter(|e| e.stop == Stop::InkEnd && !met[end_id(e.line, e.side)]);
        let free: Vec<&End> = free.collect();
        let index = PointIndex::new(free.iter().map(|e| e.point).enumerate());
        let widths = if self.image.noise > 0.0 { BLUNT } else { BLUNT_ON_CLEAN };
        let reach = widths * self.image.line_width.max(1.5);
        let nearest = |end: &End| {
            let others = index.by_distance(end.point).map(|near| free[near]);
            let mut others = others.take_while(|o| (o.point - end.point).hypot() <= reach);
            // A short line's own ends are not one another's.
            let long = self.lines[end.line].points.len() as f64 * STEP > 3.0 * reach;
            others.find(|o| o.line != end.line || (o.side != end.side && long))
        };
        let corner = |end: &&End| {
            let other = nearest(end)?;
            let mutual = nearest(other).is_some_and(|back| (back.line, back.side) == (end.line, end.side));
            let point = end.point.midpoint(other.point);
            (mutual && self.image.is_inked(end.point, other.point, end.core)).then(|| Contact {
                end: end_id(end.line, end.side),
                touch: Touch::End(end_id(other.line, other.side)),
                point,
                misfit: (point - end.point).hypot(),
            })
        };
        free.iter().filter_map(corner).collect()
    }

    /// Two walks from opposite sides that ran into each other's ink, each stopping on the other's body, are one
    /// line: their ends meet in the middle of the stretch that both have covered.
    fn join_overlaps(&self, contacts: &mut [Contact]) {
        let mut of_end = vec![Vec::new(); self.ends.len()];
        contacts.iter().enumerate().for_each(|(i, c)| of_end[c.end].push(i));
        for i in 0..contacts.len() {
            let Touch::Body(on_b) = contacts[i].touch else { continue };
            let others = [0, 1].into_iter().flat_map(|side| &of_end[end_id(on_b.line, side)]);
            for &j in others.filter(|&&j| j < i) {
                let (a, b) = (contacts[i], contacts[j]);
                let (Touch::Body(on_b), Touch::Body(on_a)) = (a.touch, b.touch) else { continue };
                if on_a.line != a.end / 2 || on_a.line == on_b.line {
                    continue;
                }
                if let Some(point) = self.middle_of_overlap(&a, on_a, &b, on_b) {
                    contacts[i] = Contact { touch: Touch::End(b.end), point, ..a };
                    contacts[j] = Contact { touch: Touch::End(a.end), point, ..b };
                }
            }
        }
    }

    /// The middle of the stretch that two ends have both covered, if they run along each other.
    fn middle_of_overlap(&self, a: &Contact, on_a: Place, b: &Contact, on_b: Place) -> Option<Point> {
        let (overlap_a, overlap_b) = (self.to_end(on_a, a.end), self.to_end(on_b, b.end));
        let parallel = direction(self.lines, on_a).dot(direction(self.lines, on_b)).abs() > 0.6;
        if overlap_a.max(overlap_b) >= OVERLAP * self.image.line_width || !parallel {
            return None;
        }
        let towards_end = if b.end.is_multiple_of(2) { -1.0 } else { 1.0 };
        Some(point_at(&self.lines[on_b.line], on_b.at + towards_end * 0.5 * overlap_b / STEP))
    }

    /// Length of a line from a place to one of its ends, in pixels.
    fn to_end(&self, place: Place, end: usize) -> f64 {
        let last = (self.lines[place.line].points.len() - 1) as f64;
        STEP * if end.is_multiple_of(2) { place.at } else { last - place.at }
    }
}
