//! A plain row-major grid of samples.
//!
//! Pixel `(x, y)` covers `[x, x + 1) x [y, y + 1)`, so the centre of the first pixel is `(0.5, 0.5)`.

use bytemuck::{Zeroable, zeroed_vec};
use image::{GrayImage, ImageBuffer, Luma, Pixel, RgbImage};
use kurbo::Point;
use rayon::prelude::*;
use std::ops::Range;

/// A `width x height` grid, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster<T> {
    width: usize,
    height: usize,
    data: Vec<T>,
}

/// Ink (`true`) or paper (`false`) per pixel.
pub type Mask = Raster<bool>;

impl<T: Copy> Raster<T> {
    /// A grid of one value.
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self { width, height, data: vec![value; width * height] }
    }

    /// A grid computed from each pixel's column and row.
    pub fn from_fn(width: usize, height: usize, mut f: impl FnMut(usize, usize) -> T) -> Self {
        let mut data = Vec::with_capacity(width * height);
        for y in 0..height {
            data.extend((0..width).map(|x| f(x, y)));
        }
        Self { width, height, data }
    }

    /// A grid whose rows are computed on all cores: `fill(y, row)` writes a row that holds `blank`.
    pub(crate) fn from_rows(width: usize, height: usize, blank: T, fill: impl Fn(usize, &mut [T]) + Sync) -> Self
    where
        T: Send,
    {
        let mut data = vec![blank; width * height];
        data.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, row)| fill(y, row));
        Self { width, height, data }
    }

    /// A grid over existing row-major samples; `None` unless there are `width * height` of them.
    pub fn from_vec(width: usize, height: usize, data: Vec<T>) -> Option<Self> {
        (data.len() == width * height).then_some(Self { width, height, data })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// All samples, row by row.
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// All samples, row by row, to be changed in place.
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// The samples of one row.
    pub fn row(&self, y: usize) -> &[T] {
        &self.data[y * self.width..(y + 1) * self.width]
    }

    /// A grid of zeros, whose memory is not touched before something is written to it.
    pub(crate) fn zeroed(width: usize, height: usize) -> Self
    where
        T: Zeroable,
    {
        Self { width, height, data: zeroed_vec(width * height) }
    }

    /// The sample at a pixel, or `None` outside the grid.
    pub fn get(&self, x: i64, y: i64) -> Option<T> {
        let inside = x >= 0 && y >= 0 && (x as usize) < self.width && (y as usize) < self.height;
        inside.then(|| self.data[y as usize * self.width + x as usize])
    }

    /// The sample of the pixel that contains a point, or `None` outside the grid.
    pub fn at(&self, p: Point) -> Option<T> {
        self.get(floor(p.x), floor(p.y))
    }

    /// A grid of the same size with each sample mapped.
    pub fn map<U: Copy>(&self, f: impl FnMut(T) -> U) -> Raster<U> {
        Raster { width: self.width, height: self.height, data: self.data.iter().copied().map(f).collect() }
    }

    /// The same on all cores, over samples that hold `blank` at first.
    pub(crate) fn mapped<U: Copy + Send>(&self, blank: U, f: impl Fn(T) -> U + Sync) -> Raster<U>
    where
        T: Sync,
    {
        Raster::from_rows(self.width, self.height, blank, |y, row| {
            row.iter_mut().zip(self.row(y)).for_each(|(to, &from)| *to = f(from));
        })
    }
}

impl<T> std::ops::Index<(usize, usize)> for Raster<T> {
    type Output = T;
    fn index(&self, (x, y): (usize, usize)) -> &T {
        debug_assert!(x < self.width);
        &self.data[y * self.width + x]
    }
}

impl<T> std::ops::IndexMut<(usize, usize)> for Raster<T> {
    fn index_mut(&mut self, (x, y): (usize, usize)) -> &mut T {
        debug_assert!(x < self.width);
        &mut self.data[y * self.width + x]
    }
}

impl<T> Raster<T>
where
    Luma<T>: Pixel<Subpixel = T>,
{
    /// The grid as an `image` buffer, without copying.
    pub fn into_image(self) -> ImageBuffer<Luma<T>, Vec<T>> {
        ImageBuffer::from_raw(self.width as u32, self.height as u32, self.data).expect("length is width * height")
    }
}

impl Raster<f32> {
    /// Bilinear interpolation between pixel centres; samples outside the grid count as 0.
    pub fn sample(&self, p: Point) -> f32 {
        let (fx, fy) = (p.x - 0.5, p.y - 0.5);
        // Nearly all samples lie inside, where cutting off is rounding down, at a fraction of the time.
        if fx >= 0.0 && fy >= 0.0 && fx < self.width as f64 - 1.0 && fy < self.height as f64 - 1.0 {
            let (x, y) = (fx as i64, fy as i64);
            let (tx, ty) = ((fx - x as f64) as f32, (fy - y as f64) as f32);
            let i = y as usize * self.width + x as usize;
            let (a, b) = (self.data[i], self.data[i + 1]);
            let (c, d) = (self.data[i + self.width], self.data[i + self.width + 1]);
            let top = a + (b - a) * tx;
            return top + (c + (d - c) * tx - top) * ty;
        }
        let (x, y) = (floor(fx), floor(fy));
        let (tx, ty) = ((fx - x as f64) as f32, (fy - y as f64) as f32);
        let v = |x, y| self.get(x, y).unwrap_or(0.0);
        let top = v(x, y) * (1.0 - tx) + v(x + 1, y) * tx;
        top * (1.0 - ty) + (v(x, y + 1) * (1.0 - tx) + v(x + 1, y + 1) * tx) * ty
    }

    /// An `image` buffer as a grid, without copying.
    pub fn from_image(image: ImageBuffer<Luma<f32>, Vec<f32>>) -> Self {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self { width, height, data: image.into_raw() }
    }
}

impl Raster<[u8; 3]> {
    /// The colours as an `image` buffer, without copying.
    pub(crate) fn into_rgb_image(self) -> RgbImage {
        let (width, height) = (self.width as u32, self.height as u32);
        RgbImage::from_raw(width, height, self.data.into_flattened()).expect("length is 3 * width * height")
    }
}

impl Mask {
    /// The mask as a grey image: ink 255, paper 0.
    pub fn to_gray_image(&self) -> GrayImage {
        self.mapped(0, |ink| if ink { 255 } else { 0 }).into_image()
    }

    /// Number of ink pixels.
    pub fn count(&self) -> usize {
        self.data.iter().filter(|&&ink| ink).count()
    }
}

/// The cells before and after a pixel's centre, of `count` cells of so many pixels a side, and how far it lies between their
/// centres.
pub(crate) fn between(pixel: usize, cell: usize, count: usize) -> (usize, usize, f32) {
    let place = ((pixel as f32 + 0.5) / cell as f32 - 0.5).clamp(0.0, (count - 1) as f32);
    let before = place as usize;
    (before, (before + 1).min(count - 1), place - before as f32)
}

/// The greatest whole number that is not above; without the call that rounding down costs where the processor is not
/// known to have an instruction for it.
pub(crate) fn floor(v: f64) -> i64 {
    let cut = v as i64;
    cut.saturating_sub(i64::from(v < cut as f64))
}

/// The runs of set pixels in a row, from left to right.
pub(crate) fn runs(row: &[bool]) -> impl Iterator<Item = Range<usize>> {
    let mut x = 0;
    std::iter::from_fn(move || {
        let start = x + row[x..].iter().position(|&set| set)?;
        x = row[start..].iter().position(|&set| !set).map_or(row.len(), |n| start + n);
        Some(start..x)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bilinear_sampling_is_exact_on_a_plane() {
        let r = Raster::from_fn(7, 5, |x, y| 2.0 * (x as f32 + 0.5) - 3.0 * (y as f32 + 0.5));
        for (x, y) in [(0.5, 0.5), (1.25, 3.75), (6.4, 4.4), (3.0, 2.0)] {
            assert!((f64::from(r.sample(Point::new(x, y))) - (2.0 * x - 3.0 * y)).abs() < 1e-5);
        }
    }

    #[test]
    fn outside_is_paper() {
        let r = Raster::filled(3, 3, 1.0f32);
        assert_eq!(r.sample(Point::new(-2.0, 1.0)), 0.0);
        assert_eq!(r.sample(Point::new(0.0, 1.5)), 0.5);
        assert_eq!(r.sample(Point::new(1.5, 1.5)), 1.0);
        assert_eq!(r.get(3, 0), None);
    }
}
