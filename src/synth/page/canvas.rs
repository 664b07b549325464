//! A page under construction: three planes of brightness, and ways to lay something over them.

use super::super::noise::blur;
use crate::raster::Raster;

/// A colour as brightness of red, green and blue, 0 to 1.
pub(super) type Rgb = [f32; 3];

/// The brightness of a colour.
pub(super) fn brightness(color: Rgb) -> f32 {
    0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2]
}

/// The largest difference of two colours in a channel.
pub(super) fn apart(a: Rgb, b: Rgb) -> f32 {
    [0, 1, 2].map(|c| (a[c] - b[c]).abs()).into_iter().fold(0.0, f32::max)
}

/// An image in colour, 0 to 1 a channel unless an effect goes beyond for a while.
#[derive(Clone, Debug)]
pub(super) struct Canvas {
    /// Red, green and blue, all of one size.
    pub planes: [Raster<f32>; 3],
}

impl Canvas {
    pub fn filled((width, height): (usize, usize), color: Rgb) -> Self {
        Self { planes: color.map(|c| Raster::filled(width, height, c)) }
    }

    pub fn size(&self) -> (usize, usize) {
        self.planes[0].size()
    }

    /// Covers with an opaque colour where `alpha`, times `strength`, says so.
    pub fn cover(&mut self, alpha: &Raster<f32>, color: Rgb, strength: f32) {
        for (plane, c) in self.planes.iter_mut().zip(color) {
            for (v, a) in plane.data_mut().iter_mut().zip(alpha.data()) {
                *v += (c - *v) * (a * strength);
            }
        }
    }

    /// Lays a transparent colour over: what is below shines through and its darker parts stay darker.
    pub fn stain(&mut self, alpha: &Raster<f32>, color: Rgb, strength: f32) {
        for (plane, c) in self.planes.iter_mut().zip(color) {
            for (v, a) in plane.data_mut().iter_mut().zip(alpha.data()) {
                *v *= 1.0 - (1.0 - c) * (a * strength).clamp(0.0, 1.0);
            }
        }
    }

    /// Multiplies every channel by what `light` says, which is 1 where nothing changes.
    pub fn shade(&mut self, light: &Raster<f32>) {
        for plane in &mut self.planes {
            plane.data_mut().iter_mut().zip(light.data()).for_each(|(v, l)| *v *= l.max(0.0));
        }
    }

    /// Adds a texture to every channel, times an amount for each.
    pub fn add(&mut self, texture: &Raster<f32>, amount: Rgb) {
        for (plane, amount) in self.planes.iter_mut().zip(amount) {
            plane.data_mut().iter_mut().zip(texture.data()).for_each(|(v, t)| *v += amount * t);
        }
    }

    /// Changes every number by itself.
    pub fn map(&mut self, f: impl Fn(f32) -> f32) {
        self.planes.iter_mut().for_each(|plane| plane.data_mut().iter_mut().for_each(|v| *v = f(*v)));
    }

    /// Changes every plane as a whole.
    pub fn each(&mut self, mut f: impl FnMut(&Raster<f32>) -> Raster<f32>) {
        self.planes.iter_mut().for_each(|plane| *plane = f(plane));
    }

    pub fn blur(&mut self, sigma: f64) {
        self.each(|plane| blur(plane, sigma));
    }

    /// The brightness of each pixel.
    pub fn gray(&self) -> Raster<f32> {
        let (width, height) = self.size();
        let [r, g, b] = [0, 1, 2].map(|c| self.planes[c].data());
        let gray = r.iter().zip(g).zip(b).map(|((r, g), b)| brightness([*r, *g, *b])).collect();
        Raster::from_vec(width, height, gray).expect("planes of one size")
    }

    /// The brightness that a share of the pixels, 0 to 1, stays below.
    pub fn quantile(&self, share: f64) -> f32 {
        let mut values = self.gray().data().to_vec();
        let at = ((values.len() - 1) as f64 * share) as usize;
        *values.select_nth_unstable_by(at, f32::total_cmp).1
    }

    /// Takes the colour away, wholly or in part.
    pub fn fade(&mut self, amount: f32) {
        let gray = self.gray();
        for plane in &mut self.planes {
            plane.data_mut().iter_mut().zip(gray.data()).for_each(|(v, g)| *v += (g - *v) * amount);
        }
    }
}
