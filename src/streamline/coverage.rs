//! Which ink is explained, and in which direction.

use crate::clean::LineImage;
use crate::raster::{Mask, Raster, floor};
use kurbo::{Point, Vec2};
use std::ops::Range;

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
pub(super) struct Coverage<'a> {
    /// Column and row of the first cell.
    corner: (i64, i64),
    cells: Raster<u32>,
    marks: Vec<(Mark, u32)>,
    /// From the first cell's corner on.
    painted: Mask,
    image: &'a LineImage,
    /// Number of ink pixels in all.
    pub ink_pixels: usize,
}

const NONE: u32 = u32::MAX;

impl<'a> Coverage<'a> {
    /// Nothing is covered yet of a part of the image: its left, top, right and bottom.
    pub fn new(image: &'a LineImage, [left, top, right, bottom]: [usize; 4], ink_pixels: usize) -> Self {
        let first = |from: usize| from / CELL as usize;
        let cells = |from: usize, to: usize, n: usize| to.min(n).div_ceil(CELL as usize) + 1 - first(from);
        let (columns, rows) = (cells(left, right, image.mask.width()), cells(top, bottom, image.mask.height()));
        Self {
            corner: (first(left) as i64, first(top) as i64),
            cells: Raster::filled(columns, rows, NONE),
            marks: Vec::new(),
            painted: Mask::filled(columns * CELL as usize, rows * CELL as usize, false),
            image,
            ink_pixels,
        }
    }

    /// Column and row of the cell around a point.
    fn cell(&self, p: Point) -> (i64, i64) {
        (floor(p.x / CELL) - self.corner.0, floor(p.y / CELL) - self.corner.1)
    }

    /// Adds a point of a streamline.
    pub fn add(&mut self, mark: Mark) {
        let (x, y) = self.cell(mark.point);
        if self.cells.get(x, y).is_some() {
            let cell = &mut self.cells[(x as usize, y as usize)];
            self.marks.push((mark, *cell));
            *cell = self.marks.len() as u32 - 1;
        }
    }

    /// Adds a line as a whole, and paints its ink; `heading` is that of a point.
    pub fn lay(&mut self, streamline: u32, points: &[Point], widths: &[f64], heading: impl Fn(Point) -> Vec2) {
        for (index, &point) in (0..).zip(points) {
            self.add(Mark { point, heading: heading(point), streamline, index });
        }
        self.paint(points, widths);
    }

    /// Gives the points `marks` to another streamline, in this order or, if `backwards`, the other; the first of them is its
    /// point `index`, and `sign` says whether it counts up or down.
    pub fn hand_over(&mut self, marks: Range<usize>, backwards: bool, streamline: u32, index: i32, sign: i32) {
        let last = marks.len() as i32 - 1;
        for (k, (mark, _)) in self.marks[marks].iter_mut().enumerate() {
            let k = if backwards { last - k as i32 } else { k as i32 };
            // Headings are those of the walk from the seed's side.
            let turned = backwards != (sign < 0);
            let heading = if turned { -mark.heading } else { mark.heading };
            *mark = Mark { streamline, index: index + sign * k, heading, ..*mark };
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
                let (x, y) = self.cell(mark.point);
                self.cells[(x as usize, y as usize)] = link;
            }
        }
    }

    /// The nearest point within `radius` that runs in about the direction `heading`, among those that `counts`.
    pub fn nearest(&self, p: Point, heading: Vec2, radius: f64, counts: impl Fn(&Mark) -> bool) -> Option<Mark> {
        let reach = Vec2::new(radius, radius);
        let ((left, top), (right, bottom)) = (self.cell(p - reach), self.cell(p + reach));
        let mut best: Option<(f64, Mark)> = None;
        for y in top..=bottom {
            for x in left..=right {
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

    /// A pixel's place in [`Self::painted`].
    fn in_bounds(&self, x: i64, y: i64) -> (i64, i64) {
        (x - self.corner.0 * CELL as i64, y - self.corner.1 * CELL as i64)
    }

    /// Whether the pixel at a point lies under a streamline already.
    pub fn is_painted(&self, p: Point) -> bool {
        let (x, y) = self.in_bounds(floor(p.x), floor(p.y));
        self.painted.get(x, y).unwrap_or(true)
    }

    /// Paints a streamline's ink and returns how many mask pixels it is the first to paint.
    pub fn paint(&mut self, points: &[Point], widths: &[f64]) -> usize {
        let mut fresh = 0;
        for (p, width) in points.iter().zip(widths) {
            let width = if width.is_finite() { *width } else { self.image.line_width };
            let radius = 0.5 * width + 0.75;
            let reach = radius.ceil() as i64;
            let (cx, cy) = (floor(p.x), floor(p.y));
            for y in cy - reach..=cy + reach {
                for x in cx - reach..=cx + reach {
                    let d = Point::new(x as f64 + 0.5, y as f64 + 0.5) - *p;
                    let (u, v) = self.in_bounds(x, y);
                    if d.hypot2() <= radius * radius && self.painted.get(u, v) == Some(false) {
                        self.painted[(u as usize, v as usize)] = true;
                        fresh += usize::from(self.image.mask.get(x, y) == Some(true));
                    }
                }
            }
        }
        fresh
    }
}
