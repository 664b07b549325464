//! Where a drawing lies: in the view box of the SVG that it came from, or on earth.

use kurbo::{Affine, Point};

/// How an SVG says its size: `width`, `height` and `viewBox` as they stood in the input.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The attribute `width`, where there was one.
    pub width: Option<String>,
    /// The attribute `height`, where there was one.
    pub height: Option<String>,
    /// Left, top, width and height of the view box.
    pub view_box: [f64; 4],
}

/// Where on earth a scan lies: from pixels of the input (its upper left corner the origin) to world coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Georeference {
    /// The map.
    pub to_world: Affine,
    /// The EPSG code of the world's coordinate system, where it is known.
    pub epsg: Option<u32>,
}

impl Georeference {
    /// The map of a scan that nobody placed: pixels with y up, so that a program for maps shows it upright.
    pub fn upright(height: f64) -> Self {
        Self { to_world: Affine::new([1.0, 0.0, 0.0, -1.0, 0.0, height]), epsg: None }
    }

    /// A point of the input in the world.
    pub fn place(&self, p: Point) -> Point {
        self.to_world * p
    }
}
