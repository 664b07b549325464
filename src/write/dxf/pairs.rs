//! Group codes and values, two lines each.

use crate::write::Rounding;
use kurbo::Point;
use std::fmt::Write;

/// Decimals of lengths: a thousandth of a micrometre.
const DECIMALS: usize = 6;

/// A sequence of group codes and values.
pub(super) struct Pairs {
    text: String,
    rounding: Rounding,
}

impl Pairs {
    pub fn new() -> Self {
        Self { text: String::new(), rounding: Rounding::new(DECIMALS) }
    }

    /// Text without line breaks; characters beyond ASCII as `\U+XXXX`.
    pub fn text(&mut self, code: u16, value: &str) {
        let _ = writeln!(self.text, "{code}");
        for c in value.chars().filter(|c| !c.is_control()) {
            if c.is_ascii() {
                self.text.push(c);
            } else {
                let mut units = [0; 2];
                c.encode_utf16(&mut units).iter().for_each(|unit| _ = write!(self.text, "\\U+{unit:04X}"));
            }
        }
        self.text.push('\n');
    }

    pub fn int(&mut self, code: u16, value: i64) {
        let _ = writeln!(self.text, "{code}\n{value}");
    }

    pub fn real(&mut self, code: u16, value: f64) {
        let value = self.rounding.text(value);
        // Readers tell whole numbers from others by the point.
        let point = if value.contains('.') { "" } else { ".0" };
        let _ = writeln!(self.text, "{code}\n{value}{point}");
    }

    pub fn handle(&mut self, code: u16, value: u64) {
        let _ = writeln!(self.text, "{code}\n{value:X}");
    }

    /// A point under codes `first`, `first + 10` and `first + 20`.
    pub fn point(&mut self, first: u16, p: Point) {
        self.flat_point(first, p);
        self.real(first + 20, 0.0);
    }

    /// A point in the plane.
    pub fn flat_point(&mut self, first: u16, p: Point) {
        self.real(first, p.x);
        self.real(first + 10, p.y);
    }

    /// The direction in which an entity is extruded: towards the eye.
    pub fn upwards(&mut self) {
        [(210, 0.0), (220, 0.0), (230, 1.0)].iter().for_each(|&(code, value)| self.real(code, value));
    }

    pub fn append(&mut self, other: Self) {
        self.text.push_str(&other.text);
    }

    pub fn into_bytes(self) -> Vec<u8> {
        self.text.into_bytes()
    }
}
