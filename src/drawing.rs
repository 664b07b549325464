//! The result: strokes and filled shapes in pixel coordinates.

use kurbo::{
    Affine, Arc, BezPath, Circle, CubicBez, Line, ParamCurve, PathEl, PathSeg, Point, Rect, RoundedRect, Shape, Vec2,
};
use std::fmt;
use std::str::FromStr;

/// Colour of a stroke or fill, sRGB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Color(pub [u8; 3]);

impl Color {
    /// Black, the colour of ink where the input is grey.
    pub const BLACK: Self = Self([0, 0, 0]);

    /// How far two colours are apart in Oklab: black and white 1.
    pub fn distance(self, other: Self) -> f64 {
        let (a, b) = (self.oklab(), other.oklab());
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    /// Lightness from 0 to 1 and the two opponents of Oklab (Ottosson, *A perceptual color space for image
    /// processing*, 2020).
    pub(crate) fn oklab(self) -> [f64; 3] {
        let [r, g, b] = self.0.map(|v| {
            let v = f64::from(v) / 255.0;
            if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        });
        let l = (0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b).cbrt();
        let m = (0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b).cbrt();
        let s = (0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b).cbrt();
        [
            0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
            1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s,
        ]
    }
}

/// As `#rrggbb`.
impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// From `#rrggbb`.
impl FromStr for Color {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let digits = text.strip_prefix('#').filter(|d| d.len() == 6 && d.bytes().all(|b| b.is_ascii_hexdigit()));
        let value = digits.and_then(|d| u32::from_str_radix(d, 16).ok());
        let [_, r, g, b] = value.ok_or_else(|| format!("\"{text}\" is not a colour such as #12ab9f"))?.to_be_bytes();
        Ok(Self([r, g, b]))
    }
}

impl serde::Serialize for Color {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> serde::Deserialize<'de> for Color {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = <std::borrow::Cow<str>>::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

/// One piece of a stroke. Arcs are circular (`radii.x == radii.y`, no rotation).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Segment {
    /// A straight piece.
    Line(Line),
    /// A circular arc.
    Arc(Arc),
    /// A cubic Bezier piece.
    Cubic(CubicBez),
}

impl Segment {
    /// First point.
    pub fn start(&self) -> Point {
        match self {
            Self::Line(l) => l.p0,
            Self::Arc(a) => arc_point(a, 0.0),
            Self::Cubic(c) => c.p0,
        }
    }

    /// Last point.
    pub fn end(&self) -> Point {
        match self {
            Self::Line(l) => l.p1,
            Self::Arc(a) => arc_point(a, 1.0),
            Self::Cubic(c) => c.p3,
        }
    }

    /// Point at parameter `t` in `[0, 1]`.
    pub fn eval(&self, t: f64) -> Point {
        match self {
            Self::Line(l) => l.eval(t),
            Self::Arc(a) => arc_point(a, t),
            Self::Cubic(c) => c.eval(t),
        }
    }

    /// Appends the piece to a path whose current point is its start; arcs become cubics.
    pub fn append_to(&self, path: &mut BezPath) {
        match self {
            Self::Line(l) => path.line_to(l.p1),
            Self::Arc(a) => path.extend(a.append_iter(1e-3)),
            Self::Cubic(c) => path.curve_to(c.p1, c.p2, c.p3),
        }
    }
}

fn arc_point(a: &Arc, t: f64) -> Point {
    a.center + a.radii.x * Vec2::from_angle(a.start_angle + a.sweep_angle * t)
}

/// The centreline of a stroke.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Centreline {
    /// A chain of pieces, each starting where the one before ends; `closed` chains end where they start.
    Path {
        /// The pieces in drawing order; never empty.
        segments: Vec<Segment>,
        /// Whether the last piece ends at the start of the first.
        closed: bool,
    },
    /// A full circle.
    Circle(Circle),
    /// A dot: a blob as long as it is wide, drawn by a round cap alone.
    Dot(Point),
}

impl Centreline {
    /// The centreline as a Bezier path. A dot becomes a move and a line to the same point.
    pub fn to_path(&self) -> BezPath {
        match self {
            Self::Path { segments, closed } => {
                let mut path = BezPath::new();
                path.move_to(segments[0].start());
                segments.iter().for_each(|s| s.append_to(&mut path));
                if *closed {
                    path.close_path();
                }
                path
            }
            Self::Circle(c) => c.to_path(1e-3),
            Self::Dot(p) => BezPath::from_vec(vec![PathEl::MoveTo(*p), PathEl::LineTo(*p)]),
        }
    }

    /// The centreline as cubic Bezier pieces, each starting where the one before ends; those of straight pieces have their
    /// handles at the thirds. A dot is one piece of no length.
    pub fn cubics(&self) -> Vec<CubicBez> {
        if let Self::Dot(p) = self {
            return vec![CubicBez::new(*p, *p, *p, *p)];
        }
        let cubic = |piece: PathSeg| match piece {
            PathSeg::Line(l) => CubicBez::new(l.p0, l.eval(1.0 / 3.0), l.eval(2.0 / 3.0), l.p1),
            curve => curve.to_cubic(),
        };
        let mut path = self.to_path();
        // The last piece of a closed chain leads home by itself.
        if matches!(self, Self::Path { .. }) && self.is_closed() {
            path.pop();
        }
        path.segments().map(cubic).collect()
    }

    /// First point of the centreline.
    pub fn start(&self) -> Point {
        match self {
            Self::Path { segments, .. } => segments[0].start(),
            Self::Circle(c) => c.center + Vec2::new(c.radius, 0.0),
            Self::Dot(p) => *p,
        }
    }

    /// Last point of the centreline.
    pub fn end(&self) -> Point {
        match self {
            Self::Path { segments, .. } => segments[segments.len() - 1].end(),
            _ => self.start(),
        }
    }

    /// Whether the end is the start.
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Path { closed, .. } => *closed,
            Self::Circle(_) => true,
            Self::Dot(_) => false,
        }
    }

    /// The upright rectangle, its corners sharp or rounded alike, that a closed chain of lines and arcs follows to
    /// within a distance, once around. `None` if there is none.
    pub fn as_rounded_rect(&self, within: f64) -> Option<RoundedRect> {
        let Self::Path { segments, closed: true } = self else { return None };
        let mut radii = Vec::new();
        for segment in segments {
            match segment {
                Segment::Line(l) if (l.p1.x - l.p0.x).abs().min((l.p1.y - l.p0.y).abs()) <= within => {}
                Segment::Arc(a) => radii.push(a.radii.x),
                _ => return None,
            }
        }
        // The sides, and where arcs of a quarter or a half touch them.
        let touching = || segments.iter().flat_map(|s| [0.0, 0.5].map(|t| s.eval(t)));
        let start = segments.first()?.start();
        let bounds = touching().fold(Rect::from_points(start, start), |bounds, p| bounds.union_pt(p));
        let shorter = bounds.width().min(bounds.height());
        let radius = radii.iter().sum::<f64>() / radii.len().max(1) as f64;
        // Two half circles leave nothing between them.
        let radius = if (0.5 * shorter - radius).abs() <= within { 0.5 * shorter } else { radius };
        let follows = touching().all(|p| outside_rounded(bounds, radius, p).0.abs() <= within);
        let rect = RoundedRect::from_rect(bounds, radius);
        let around = (rect.perimeter(1e-3) - self.to_path().perimeter(1e-3)).abs() <= 16.0 * within + 1e-2;
        (follows && around && radius <= 0.5 * shorter && shorter > 8.0 * within).then_some(rect)
    }

    /// The same line walked from its end to its start.
    pub fn reversed(&self) -> Self {
        let Self::Path { segments, closed } = self else { return self.clone() };
        let flip = |s: &Segment| match s {
            Segment::Line(l) => Segment::Line(Line::new(l.p1, l.p0)),
            Segment::Arc(a) => Segment::Arc(a.reversed()),
            Segment::Cubic(c) => Segment::Cubic(CubicBez::new(c.p3, c.p2, c.p1, c.p0)),
        };
        Self::Path { segments: segments.iter().rev().map(flip).collect(), closed: *closed }
    }

    /// The same line under a uniform scaling followed by a shift.
    pub fn transformed(&self, scale: f64, shift: Vec2) -> Self {
        let map = Affine::translate(shift) * Affine::scale(scale);
        let segment = |s: &Segment| match s {
            Segment::Line(l) => Segment::Line(map * *l),
            Segment::Arc(a) => Segment::Arc(Arc { center: map * a.center, radii: a.radii * scale, ..*a }),
            Segment::Cubic(c) => Segment::Cubic(map * *c),
        };
        match self {
            Self::Path { segments, closed } => {
                Self::Path { segments: segments.iter().map(segment).collect(), closed: *closed }
            }
            Self::Circle(c) => Self::Circle(Circle::new(map * c.center, c.radius * scale)),
            Self::Dot(p) => Self::Dot(map * *p),
        }
    }
}

/// How far a point lies outside a rectangle with corners of a radius, and the unit vector that leads outwards from there.
pub(crate) fn outside_rounded(rect: Rect, radius: f64, p: Point) -> (f64, Vec2) {
    let d = p - rect.center();
    let out = Vec2::new(d.x.abs() - 0.5 * rect.width() + radius, d.y.abs() - 0.5 * rect.height() + radius);
    let (distance, normal) = match (out.x > 0.0, out.y > 0.0) {
        (true, true) => (out.hypot(), out.normalize()),
        _ if out.x > out.y => (out.x, Vec2::new(1.0, 0.0)),
        _ => (out.y, Vec2::new(0.0, 1.0)),
    };
    (distance - radius, Vec2::new(normal.x.copysign(d.x), normal.y.copysign(d.y)))
}

/// The pattern of a dashed line, in pixels along the pen's path; round caps reach half a width beyond each dash.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dashes {
    /// Length of a dash.
    pub dash: f64,
    /// From the end of a dash to the start of the next.
    pub gap: f64,
    /// How far into the pattern the line starts.
    pub offset: f64,
}

impl Dashes {
    /// The same pattern, `scale` times as long.
    pub fn scaled(self, scale: f64) -> Self {
        Self { dash: self.dash * scale, gap: self.gap * scale, offset: self.offset * scale }
    }

    /// The pattern of a line of some length seen from its end.
    pub fn reversed(self, length: f64) -> Self {
        Self { offset: (self.dash - self.offset - length).rem_euclid(self.dash + self.gap), ..self }
    }
}

/// A line of the drawing with its pen.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stroke {
    /// Where the pen's centre went.
    pub centreline: Centreline,
    /// Pen width in pixels.
    pub width: f64,
    /// Ink colour.
    pub color: Color,
    /// The pattern of a dashed line.
    pub dashes: Option<Dashes>,
    /// Widths at even distances along the centreline, from its start to its end, where they were asked for
    /// ([`crate::options::StrokeWidth::Profile`]); empty where `width` is that of the whole stroke.
    pub profile: Vec<f64>,
}

impl Stroke {
    /// A black line of one width.
    pub fn new(centreline: Centreline, width: f64) -> Self {
        Self { centreline, width, color: Color::BLACK, dashes: None, profile: Vec::new() }
    }

    /// The width at a share of the length, 0 to 1.
    pub fn width_at(&self, share: f64) -> f64 {
        let Some(last) = self.profile.len().checked_sub(1) else { return self.width };
        let at = share.clamp(0.0, 1.0) * last as f64;
        let before = (at as usize).min(last.saturating_sub(1));
        let after = (before + 1).min(last);
        self.profile[before] + (at - before as f64) * (self.profile[after] - self.profile[before])
    }

    /// The same line walked from its end to its start, its pattern where it was.
    pub fn reversed(&self) -> Self {
        let dashes = match &self.centreline {
            Centreline::Path { .. } => self.dashes.map(|d| d.reversed(self.centreline.to_path().perimeter(1e-3))),
            // Walked as before.
            Centreline::Circle(_) | Centreline::Dot(_) => self.dashes,
        };
        let profile = self.profile.iter().rev().copied().collect();
        Self { centreline: self.centreline.reversed(), dashes, profile, ..*self }
    }
}

/// A solid region, too wide to be a line; even-odd outline.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fill {
    /// The outline, closed subpaths.
    pub outline: BezPath,
    /// Ink colour.
    pub color: Color,
}

impl Fill {
    /// The corners of the outline's closed polygons, where it is made of straight pieces; of curves, their ends.
    pub(crate) fn rings(&self) -> Vec<Vec<Point>> {
        let mut rings: Vec<Vec<Point>> = Vec::new();
        for el in self.outline.elements() {
            match (*el, el.end_point()) {
                (PathEl::MoveTo(p), _) => rings.push(vec![p]),
                (PathEl::ClosePath, _) | (_, None) => {}
                (_, Some(p)) => rings.last_mut().into_iter().for_each(|r| r.push(p)),
            }
        }
        rings.retain(|r| r.len() > 2);
        rings
    }
}

/// A vector line drawing over a canvas of `width x height` pixels.
#[derive(Clone, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Drawing {
    /// Canvas width in pixels.
    pub width: f64,
    /// Canvas height in pixels.
    pub height: f64,
    /// Dots per inch, where known.
    pub dpi: Option<f64>,
    /// Solid regions, painted first.
    pub fills: Vec<Fill>,
    /// Lines.
    pub strokes: Vec<Stroke>,
}

impl Drawing {
    /// An empty drawing on a canvas.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, ..Self::default() }
    }

    /// Number of pieces over all strokes; circles and dots count one.
    pub fn segment_count(&self) -> usize {
        let pieces = |s: &Stroke| match &s.centreline {
            Centreline::Path { segments, .. } => segments.len(),
            _ => 1,
        };
        self.strokes.iter().map(pieces).sum()
    }

    /// Sum of centreline lengths in pixels.
    pub fn length(&self) -> f64 {
        self.strokes.iter().map(|s| s.centreline.to_path().perimeter(1e-3)).sum()
    }

    /// The same drawing elsewhere on its canvas.
    pub(crate) fn shifted(mut self, by: Vec2) -> Self {
        self.strokes.iter_mut().for_each(|s| s.centreline = s.centreline.transformed(1.0, by));
        self.fills.iter_mut().for_each(|f| f.outline.apply_affine(Affine::translate(by)));
        self
    }

    /// The same drawing on a canvas `scale` times as large.
    pub fn scaled(&self, scale: f64) -> Self {
        let stroke = |s: &Stroke| Stroke {
            centreline: s.centreline.transformed(scale, Vec2::ZERO),
            width: s.width * scale,
            color: s.color,
            dashes: s.dashes.map(|d| d.scaled(scale)),
            profile: s.profile.iter().map(|w| w * scale).collect(),
        };
        let fill = |f: &Fill| Fill { outline: Affine::scale(scale) * f.outline.clone(), color: f.color };
        Self {
            width: self.width * scale,
            height: self.height * scale,
            dpi: self.dpi.map(|d| d * scale),
            fills: self.fills.iter().map(fill).collect(),
            strokes: self.strokes.iter().map(stroke).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn reversing_swaps_the_ends_and_keeps_the_length() {
        let arc = Arc::new((10.0, 10.0), (5.0, 5.0), 0.0, PI, 0.0);
        let line = Line::new((0.0, 0.0), arc_point(&arc, 0.0));
        let c = Centreline::Path { segments: vec![Segment::Line(line), Segment::Arc(arc)], closed: false };
        let r = c.reversed();
        assert!((r.start() - c.end()).hypot() < 1e-9 && (r.end() - c.start()).hypot() < 1e-9);
        assert!((r.to_path().perimeter(1e-6) - c.to_path().perimeter(1e-6)).abs() < 1e-6);
    }

    #[test]
    fn scaling_scales_lengths_and_widths() {
        let mut d = Drawing::new(20.0, 10.0);
        let centreline = Centreline::Circle(Circle::new((5.0, 5.0), 3.0));
        d.strokes.push(Stroke::new(centreline, 1.5));
        let big = d.scaled(2.0);
        assert!((big.length() - 2.0 * d.length()).abs() < 1e-2);
        assert_eq!((big.width, big.height, big.strokes[0].width), (40.0, 20.0, 3.0));
    }
}
