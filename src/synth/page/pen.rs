//! How marks look that different pens leave on paper.

use super::super::noise::{blur, smooth, white};
use super::super::shapes::within;
use super::canvas::{Canvas, Rgb, apart, brightness};
use super::random::{amount, like, pick, spread};
use crate::raster::Raster;
use rand::Rng;

/// What a mark is made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Medium {
    /// Even dark ink, or the pixels of a render.
    Ink,
    /// Printer's toner or ink: black with small holes.
    Toner,
    /// Ball-point: blue, black, red or green, thinner in places, with skips.
    Biro,
    /// Felt pens of any colour.
    Felt,
    /// From 9H, hardly to be seen, to soft.
    Pencil,
    /// Coloured pencils and crayons.
    Crayon,
    /// Chalk, white pencil and gel pens on a dark ground.
    Chalk,
    /// The even pale lines of a blueprint.
    Blueprint,
}

/// One pen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    medium: Medium,
    color: Rgb,
    /// How much of the ground it covers at most.
    strength: f32,
}

const DARK: [Rgb; 4] = [[0.02, 0.02, 0.02], [0.1, 0.1, 0.12], [0.2, 0.18, 0.17], [0.08, 0.1, 0.25]];
const BIRO: [Rgb; 6] =
    [[0.1, 0.15, 0.6], [0.1, 0.15, 0.6], [0.15, 0.25, 0.75], [0.08, 0.08, 0.1], [0.75, 0.1, 0.12], [0.05, 0.5, 0.2]];
const BRIGHT: [Rgb; 12] = [
    [0.05, 0.05, 0.05],
    [0.85, 0.1, 0.1],
    [0.1, 0.3, 0.85],
    [0.0, 0.55, 0.25],
    [0.95, 0.5, 0.05],
    [0.55, 0.15, 0.65],
    [0.45, 0.25, 0.1],
    [0.9, 0.25, 0.55],
    [0.05, 0.6, 0.7],
    [0.6, 0.75, 0.1],
    [0.5, 0.5, 0.5],
    [0.9, 0.72, 0.05],
];
const PALE: [Rgb; 6] = [
    [0.95, 0.95, 0.92],
    [0.95, 0.95, 0.92],
    [0.85, 0.88, 0.9],
    [0.95, 0.88, 0.5],
    [0.6, 0.85, 0.95],
    [0.98, 0.65, 0.7],
];

/// Least difference from the ground of faint marks, such as those of hard pencils, and of any others, of 1.
const FAINT: f32 = 0.1;
const VISIBLE: f32 = 0.22;

impl Pen {
    /// A pen of one of some media, which can be seen on a ground.
    pub fn draw(rng: &mut impl Rng, media: &[Medium], ground: Rgb) -> Self {
        let medium = *pick(rng, media);
        let (palette, strength): (&[Rgb], _) = match medium {
            Medium::Ink => (&DARK, (0.75, 1.0)),
            Medium::Toner => (&DARK[..3], (0.7, 1.0)),
            Medium::Biro => (&BIRO, (0.5, 0.95)),
            Medium::Felt => (&BRIGHT, (0.55, 1.0)),
            Medium::Pencil => (&[[0.2, 0.2, 0.22]], (0.0, 1.0)),
            Medium::Crayon => (&BRIGHT, (0.3, 0.9)),
            Medium::Chalk => (&PALE, (0.35, 1.0)),
            Medium::Blueprint => (&PALE[..3], (0.35, 0.95)),
        };
        let color = like(rng, palette, 0.05);
        let strength = match medium {
            Medium::Pencil => spread(rng, 0.13, 0.85) as f32,
            _ => amount(rng, strength),
        };
        let mut pen = Self { medium, color, strength };
        let least = if matches!(medium, Medium::Pencil | Medium::Crayon) { FAINT } else { VISIBLE };
        if pen.contrast(ground) < least {
            // Darker, or paler on a dark ground, and as strong as it takes.
            pen.color = if brightness(ground) > 0.4 { [0.1; 3] } else { [0.95; 3] };
            pen.strength = pen.strength.max(2.0 * least);
        }
        pen
    }

    /// How far full marks are from a ground, at most 1.
    pub fn contrast(&self, ground: Rgb) -> f32 {
        self.strength * (0.5 * apart(self.color, ground) + 0.5 * (brightness(self.color) - brightness(ground)).abs())
    }

    pub fn color(&self) -> Rgb {
        self.color
    }

    /// Lays marks on a page. What the texture leaves out is a mark all the same.
    pub fn apply(&self, rng: &mut impl Rng, canvas: &mut Canvas, marks: &Raster<f32>) {
        let texture = self.texture(rng, marks.size());
        let marks = match texture {
            Some(texture) => product(marks, &texture),
            None => marks.clone(),
        };
        let opaque = matches!(self.medium, Medium::Chalk | Medium::Blueprint | Medium::Ink | Medium::Toner);
        if opaque || rng.random_bool(0.3) {
            canvas.cover(&marks, self.color, self.strength);
        } else {
            canvas.stain(&marks, self.color, self.strength);
        }
    }

    /// How much of the pen's strength arrives at each pixel; `None` where all of it does.
    fn texture(&self, rng: &mut impl Rng, size: (usize, usize)) -> Option<Raster<f32>> {
        let texture = match self.medium {
            Medium::Ink | Medium::Blueprint if rng.random_bool(0.6) => return None,
            Medium::Ink | Medium::Blueprint => pressure(rng, size, (0.1, 0.4)),
            Medium::Toner => holes(rng, size),
            Medium::Biro => product(&pressure(rng, size, (0.1, 0.5)), &skips(rng, size)),
            Medium::Felt => pressure(rng, size, (0.05, 0.35)),
            Medium::Pencil | Medium::Crayon => product(&pressure(rng, size, (0.1, 0.55)), &tooth(rng, size, 0.75)),
            Medium::Chalk => product(&pressure(rng, size, (0.05, 0.5)), &tooth(rng, size, 0.9)),
        };
        Some(texture)
    }
}

fn product(a: &Raster<f32>, b: &Raster<f32>) -> Raster<f32> {
    let data = a.data().iter().zip(b.data()).map(|(a, b)| a * b).collect();
    Raster::from_vec(a.width(), a.height(), data).expect("rasters of one size")
}

/// Pressure that changes along a line.
fn pressure(rng: &mut impl Rng, (width, height): (usize, usize), depth: (f64, f64)) -> Raster<f32> {
    let (depth, cell) = (amount(rng, depth), within(rng, 6.0, 30.0));
    smooth(rng, width, height, cell).map(|v| 1.0 - depth * (0.5 + 0.5 * v))
}

/// The paper's grain, of which only the tops take colour; `most` is the largest share that is left out.
fn tooth(rng: &mut impl Rng, (width, height): (usize, usize), most: f64) -> Raster<f32> {
    let grain = blur(&white(rng, width, height), within(rng, 0.35, 1.1));
    let deviation = (grain.data().iter().map(|v| v * v).sum::<f32>() / grain.data().len() as f32).sqrt();
    let (depth, level) = (amount(rng, (0.1, most)), amount(rng, (-0.5, 1.0)));
    grain.map(|v| 1.0 - depth * (0.5 + 0.8 * (v / deviation.max(1e-3) - level)).clamp(0.0, 1.0))
}

/// Small places that took no toner.
fn holes(rng: &mut impl Rng, (width, height): (usize, usize)) -> Raster<f32> {
    let (share, depth) = (amount(rng, (0.0, 0.2)), amount(rng, (0.2, 0.9)));
    Raster::from_fn(width, height, |_, _| if rng.random::<f32>() < share { 1.0 - depth } else { 1.0 })
}

/// Places, longer than wide, where the ball did not roll.
fn skips(rng: &mut impl Rng, (width, height): (usize, usize)) -> Raster<f32> {
    if rng.random_bool(0.4) {
        return Raster::filled(width, height, 1.0);
    }
    let cell = within(rng, 2.5, 7.0);
    let (level, depth) = (amount(rng, (0.35, 0.75)), amount(rng, (0.4, 0.95)));
    smooth(rng, width, height, cell).map(|v| 1.0 - depth * ((v - level) * 5.0).clamp(0.0, 1.0))
}
