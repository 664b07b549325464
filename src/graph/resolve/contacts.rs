//! Where the ends of lines meet other lines.

use crate::clean::LineImage;
use crate::graph::lines::{End, EndState, Lines, Place, end_id};
use crate::graph::point_index::PointIndex;
use crate::streamline::STEP;
use kurbo::{Line as Segment, Point, Vec2};
use rayon::prelude::*;

/// An end sticks out of a line rather than ending at it when it goes further than the line's edge by this
/// share of a line width, and of so many pixels at least. Empirical, guarded by `junctions.rs`.
const PROTRUSION: f64 = 0.42;
const THIN: f64 = 2.0;
/// Parts of one line are taken for different lines when they are this many line widths apart along it.
const OWN: f64 = 4.0;
/// A line that ends within this many line widths of where it is met ends there.
const AT_END: f64 = 0.8;
/// Two ends that run along each other for at most this many line widths are one line.
const OVERLAP: f64 = 10.0;
/// Lines run along each other within this cosine's angle (53 degrees).
const ALONG_COS: f64 = 0.6;
/// An end is drawn out through ink by this many line widths and pixels at most: a good half, for the walk stops before the
/// ink does; and more where it ran into another line, at a small angle.
const DRAWN_OUT: f64 = 0.6;
const DRAWN_OUT_RAN_IN: f64 = 3.0;
const DRAWN_OUT_PIXELS: f64 = 0.5;
/// An end meets a line beside it within this many line widths, of so many pixels at least. Where it ran in, the line is known
/// to be there and is nearer.
const BESIDE: f64 = 0.9;
const BESIDE_RAN_IN: f64 = 0.75;
const THINNEST: f64 = 1.5;
/// Two inks are one for the longer the smaller the angle, down to this sine's (25 degrees): at less, lines run into one another.
const SHARED_SINE: f64 = 0.42;
/// A line's edge is the further away the smaller the angle, down to this sine's (30 degrees).
const EDGE_SINE: f64 = 0.5;
/// How far apart, in line widths, the walks along the arms of a blunt corner may end; where no grain can pass for ink,
/// their ends may be further apart.
const BLUNT: f64 = 1.2;
const BLUNT_ON_CLEAN: f64 = 3.0;
/// A line has a blunt corner with itself when it is this many times as long as the corner is wide.
const LONG: f64 = 3.0;

/// What an end meets.
#[derive(Clone, Copy, Debug)]
pub(super) enum Touch {
    /// Another end (its number).
    End(usize),
    /// The body of a line.
    Body(Place),
}

/// An end that stops at a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Number of the end.
    pub end: usize,
    pub touch: Touch,
    pub point: Point,
    /// How far the place lies from what the end's own edge tells, in pixels; the smaller the more plausible.
    pub misfit: f64,
}

/// What each end stops at; an end without a contact is free.
pub(super) fn contacts(image: &LineImage, lines: &Lines) -> Vec<Contact> {
    let finder = Finder { image, lines, ends: lines.ends(image) };
    let of_end = |end: &Option<End>| end.iter().flat_map(|end| finder.of_end(end)).collect::<Vec<_>>();
    let mut contacts: Vec<Contact> = finder.ends.par_iter().flat_map_iter(of_end).collect();
    finder.join_overlaps(&mut contacts);
    contacts.extend(finder.blunt_corners(&contacts));
    contacts
}

struct Finder<'a> {
    image: &'a LineImage,
    lines: &'a Lines,
    ends: &'a [Option<End>],
}

impl Finder<'_> {
    fn of_end(&self, end: &End) -> Vec<Contact> {
        match end.state {
            EndState::CutOff | EndState::Lifted => Vec::new(),
            EndState::Led => self.led(end).into_iter().collect(),
            EndState::Open | EndState::RanIn | EndState::Parted => {
                let crossed = self.crossed(end);
                if crossed.is_empty() { self.beside(end).into_iter().collect() } else { crossed }
            }
        }
    }

    /// The line on which an end lies.
    fn led(&self, end: &End) -> Option<Contact> {
        let near = self.lines.near(end.point, STEP);
        let (place, point, misfit) = near.into_iter().find(|(place, ..)| place.line != end.line)?;
        let touch = self.touch(end, place, AT_END * self.image.line_width);
        Some(Contact { end: end.id(), touch, point, misfit })
    }

    /// Lines that the end's last stretch, or its straight continuation through ink, crosses.
    fn crossed(&self, end: &End) -> Vec<Contact> {
        let mut contacts = Vec::new();
        let extension = self.extension(end);
        let stretch = self.stretch(end, extension);
        let total: f64 = stretch.windows(2).map(|w| (w[1] - w[0]).hypot()).sum::<f64>() - extension;
        let mut walked = 0.0;
        for pair in stretch.windows(2) {
            let piece = Segment::new(pair[0], pair[1]);
            let length = (pair[1] - pair[0]).hypot();
            for (place, point, t) in self.lines.crossings(piece) {
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
        let tip = line.inwards(end.side, end.tip);
        let count = (tip + (end.width / STEP) as usize + 1).min(line.points.len() - 1);
        let mut stretch: Vec<Point> = (0..=count).rev().map(|k| line.at_end(end.side, k)).collect();
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
        let most = if end.state == EndState::RanIn { DRAWN_OUT_RAN_IN } else { DRAWN_OUT };
        let most = most * self.image.line_width + DRAWN_OUT_PIXELS;
        let line = &self.lines[end.line];
        if line.points.len() < 2 {
            return 0.0;
        }
        let heading = (end.point - line.at_end(end.side, 1)).normalize();
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
        let from_tip = if end.side == 0 { place.at - end.tip as f64 } else { end.tip as f64 - place.at };
        from_tip * STEP < OWN * end.width
    }

    /// Whether an end stops at the line that it crosses `beyond` pixels before its last point.
    fn judge(&self, end: &End, place: Place, point: Point, heading: Vec2, beyond: f64) -> Option<Contact> {
        let along = self.lines.direction(place);
        let sine = heading.normalize().cross(along).abs();
        let shared = 0.5 * end.width / sine.max(SHARED_SINE);
        let edge = 0.5 * self.lines.width(place, self.image.line_width) / sine.max(EDGE_SINE);
        let slack = PROTRUSION * self.image.line_width.max(THIN);
        if beyond > edge + slack && end.state != EndState::RanIn {
            return None;
        }
        let touch = self.touch(end, place, shared + slack);
        Some(Contact { end: end.id(), touch, point, misfit: (beyond - edge).abs() })
    }

    /// What an end meets at a place: the line's own end, if that is within `reach` pixels along it, or else its body.
    fn touch(&self, end: &End, place: Place, reach: f64) -> Touch {
        let other = self.end_near(place, reach).filter(|&other| other != end.id());
        other.map_or(Touch::Body(place), Touch::End)
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
        let merged = self.ends[other].is_some_and(|e| e.state == EndState::RanIn);
        let reach = if merged { reach + self.image.line_width } else { reach };
        (distance * STEP <= reach).then_some(other)
    }

    /// A line beside the end that its last stretch does not cross, joined to it by ink.
    fn beside(&self, end: &End) -> Option<Contact> {
        let reach = if end.state == EndState::RanIn { BESIDE_RAN_IN } else { BESIDE };
        let reach = reach * self.image.line_width.max(THINNEST);
        let from = end.point;
        for (place, foot, distance) in self.lines.near(from, reach) {
            if self.is_own_neighbourhood(end, place) {
                continue;
            }
            // What a walk merged with is one with its ink, even if a light spot lies between.
            if end.state != EndState::RanIn && !self.image.is_inked(from, foot, end.core) {
                continue;
            }
            let touch = self.touch(end, place, AT_END * self.image.line_width);
            return Some(Contact { end: end.id(), touch, point: foot, misfit: distance });
        }
        None
    }

    /// Ends that met nothing but have another such end beside them, with ink between: the arms of a corner that is
    /// blunt, or of a hairpin.
    fn blunt_corners(&self, contacts: &[Contact]) -> Vec<Contact> {
        let mut met = vec![false; self.ends.len()];
        contacts.iter().for_each(|c| met[c.end] = true);
        let free = self.ends.iter().flatten().filter(|e| e.state == EndState::Open && !met[e.id()]);
        let free: Vec<&End> = free.collect();
        let index = PointIndex::new(free.iter().map(|e| e.point).enumerate());
        let nearest = |end: &End| {
            let widths = self.image.noise.at(end.point).between(BLUNT_ON_CLEAN, BLUNT);
            let reach = widths * self.image.line_width.max(THINNEST);
            let others = index.by_distance(end.point).map(|near| free[near]);
            let mut others = others.take_while(|o| (o.point - end.point).hypot() <= reach);
            // A short line's own ends are not one another's.
            let long = self.lines[end.line].points.len() as f64 * STEP > LONG * reach;
            others.find(|o| o.line != end.line || (o.side != end.side && long))
        };
        let corner = |end: &&End| {
            let other = nearest(end)?;
            let mutual = nearest(other).is_some_and(|back| (back.line, back.side) == (end.line, end.side));
            let point = end.point.midpoint(other.point);
            (mutual && self.image.is_inked(end.point, other.point, end.core)).then(|| Contact {
                end: end.id(),
                touch: Touch::End(other.id()),
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
        let parallel = self.lines.direction(on_a).dot(self.lines.direction(on_b)).abs() > ALONG_COS;
        if overlap_a.max(overlap_b) >= OVERLAP * self.image.line_width || !parallel {
            return None;
        }
        let towards_end = if b.end.is_multiple_of(2) { -1.0 } else { 1.0 };
        Some(self.lines.point(Place { at: on_b.at + towards_end * 0.5 * overlap_b / STEP, ..on_b }))
    }

    /// Length of a line from a place to one of its ends, in pixels.
    fn to_end(&self, place: Place, end: usize) -> f64 {
        let last = (self.lines[place.line].points.len() - 1) as f64;
        STEP * if end.is_multiple_of(2) { place.at } else { last - place.at }
    }
}
