//! Which ink is explained, and in which direction.

use crate::raster::{Mask, Raster};
use kurbo::{Point, Vec2};

/// Side of a grid cell in pixels.
const CELL: f64 = 4.0;
/// Directions within this angle (25 degrees) are the same line.
const SAME_DIRECTION_COS: f64 = 0.906;

/// A point of a streamline with its direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    pub point: Point,
    pub heading: Vec2,
    pub streamline: u32,
    /// Steps from the seed, negative for the walk against the seed's direction.
    pub index: i32,
}

/// The streamlines drawn so far.
pub(super) struct Coverage {
    cells: Raster<u32>,
    marks: Vec<(Mark, u32)>,
    painted: Mask,
    mask: Mask,
    line_width: f64,
    /// Number of ink pixels in all.
    pub ink_pixels: usize,
}

const NONE: u32 = u32::MAX;

impl Coverage {
    /// Nothing is covered yet.
    pub fn new(mask: &Mask, line_width: f64) -> Self {
        let cells = |n: usize| (n as f64 / CELL).ceil() as usize + 1;
        Self {
            cells: Raster::filled(cells(mask.width()), cells(mask.height()), NONE),
            marks: Vec::new(),
            painted: mask.map(|_| false),
            mask: mask.clone(),
            line_width,
            ink_pixels: mask.count(),
        }
    }

    /// Adds a point of a streamline.
    pub fn add(&mut self, mark: Mark) {
        let (x, y) = ((mark.point.x / CELL).floor() as i64, (mark.point.y / CELL).floor() as i64);
        if self.cells.get(x, y).is_some() {
            let cell = &mut self.cells[(x as usize, y as usize)];
            self.marks.push((mark, *cell));
            *cell = self.marks.len() as u32 - 1;
        }
    }

    /// How many points there are so far.
    pub fn len(&self) -> usize {
        self.marks.len()
    }

    /// Takes back all points but the first `len`.
    pub fn truncate(&mut self, len: usize) {
        while self.marks.len() > len {
            if let Some((mark, link)) = self.marks.pop() {
                let cell = ((mark.point.x / CELL).floor() as usize, (mark.point.y / CELL).floor() as usize);
                self.cells[cell] = link;
            }
        }
    }

    /// The nearest point within `radius` that runs in about the direction `heading`, among those that `counts`.
    pub fn nearest(&self, p: Point, heading: Vec2, radius: f64, counts: impl Fn(&Mark) -> bool) -> Option<Mark> {
        let cell = |v: f64| (v / CELL).floor() as i64;
        let mut best: Option<(f64, Mark)> = None;
        for y in cell(p.y - radius)..=cell(p.y + radius) {
            for x in cell(p.x - radius)..=cell(p.x + radius) {
                let mut next = self.cells.get(x, y).unwrap_or(NONE);
                while next != NONE {
                    let (mark, link) = &self.marks[next as usize];
                    let distance = (mark.point - p).hypot();
                    if distance <= best.map_or(radius, |(d, _)| d)
                        && mark.heading.dot(heading).abs() >= SAME_DIRECTION_COS
                        && counts(mark)
                    {
                        best = Some((distance, *mark));
                    }
                    next = *link;
                }
            }
        }
        best.map(|(_, mark)| mark)
    }

    /// Whether the pixel at a point lies under a streamline already.
    pub fn is_painted(&self, p: Point) -> bool {
        self.painted.at(p).unwrap_or(true)
    }

    /// Paints a streamline's ink and returns how many mask pixels it is the first to paint.
    pub fn paint(&mut self, points: &[Point], widths: &[f64]) -> usize {
        let mut fresh = 0;
        for (p, width) in points.iter().zip(widths) {
            let width = if width.is_finite() { *width } else { self.line_width };
            let radius = 0.5 * width + 0.75;
            let reach = radius.ceil() as i64;
            let (cx, cy) = (p.x.floor() as i64, p.y.floor() as i64);
            for y in cy - reach..=cy + reach {
                for x in cx - reach..=cx + reach {
                    let d = Point::new(x as f64 + 0.5, y as f64 + 0.5) - *p;
                    if d.hypot2() <= radius * radius && self.painted.get(x, y) == Some(false) {
                        self.painted[(x as usize, y as usize)] = true;
                        fresh += usize::from(self.mask[(x as usize, y as usize)]);
                    }
                }
            }
        }
        fresh
    }
}
