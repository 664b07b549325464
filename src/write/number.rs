//! Numbers as short text.

use kurbo::Point;

/// Rounds to a number of decimals and prints without trailing zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rounding {
    decimals: usize,
}

impl Rounding {
    /// Rounding to `decimals` places; more than ten say nothing in pixels and are taken as ten.
    pub(crate) fn new(decimals: usize) -> Self {
        Self { decimals: decimals.min(10) }
    }

    /// Rounding to `extra` more places.
    pub(crate) fn finer(self, extra: usize) -> Self {
        Self { decimals: (self.decimals + extra).min(15) }
    }

    /// The distance between two neighbouring rounded numbers.
    pub(crate) fn step(self) -> f64 {
        0.1f64.powi(self.decimals as i32)
    }

    /// The nearest number that prints exactly; never a negative zero.
    pub(crate) fn round(self, value: f64) -> f64 {
        let unit = 10f64.powi(self.decimals as i32);
        (value * unit).round() / unit + 0.0
    }

    /// Both coordinates rounded.
    pub(crate) fn point(self, p: Point) -> Point {
        Point::new(self.round(p.x), self.round(p.y))
    }

    /// The number as text; what is not finite prints as 0.
    pub(crate) fn text(self, value: f64) -> String {
        if !value.is_finite() {
            return "0".into();
        }
        let mut text = format!("{:.*}", self.decimals, value);
        if text.contains('.') {
            text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
        }
        if text == "-0" { "0".into() } else { text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let two = Rounding::new(2);
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (-0.004, "0"),
            (0.005, "0.01"),
            (12.5, "12.5"),
            (100.0, "100"),
            (-3.999, "-4"),
            (f64::NAN, "0"),
            (f64::INFINITY, "0"),
        ];
        for (value, text) in cases {
            assert_eq!(two.text(two.round(value)), text);
        }
        assert_eq!(Rounding::new(0).text(120.0), "120");
    }
}
