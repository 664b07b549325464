//! Pages as people have them, with the ink that is true on them.

mod camera;
mod canvas;
mod content;
mod copier;
mod kind;
mod light;
mod objects;
mod paper;
mod pen;
mod print;
mod random;
mod ruling;
#[cfg(test)]
mod tests;

pub use kind::Kind;

use super::shapes::within;
use crate::drawing::Drawing;
use crate::raster::Raster;
use canvas::{Canvas, Rgb, apart, brightness};
use content::Content;
use kind::Recipe;
use pen::Pen;
use rand::Rng;
use random::{amount, like, near, spread};

/// A page with what is true on it.
#[derive(Clone, Debug)]
pub struct Page {
    /// Red, green and blue, 0 to 1, all of one size.
    pub color: [Raster<f32>; 3],
    /// How much of each pixel the marks cover that were drawn, 0 to 1, whatever is to be seen of them.
    pub ink: Raster<f32>,
    /// The marks.
    pub drawing: Drawing,
}

/// A page of a kind that shows one drawing, and traces of another of its size.
pub fn page(rng: &mut impl Rng, kind: Kind, drawing: Drawing, other: &Drawing) -> Page {
    let mut recipe = kind.recipe();
    mixed(rng, &mut recipe);
    // Images are brought to a size that the network knows, from a larger or a smaller one.
    let pixel = if rng.random_bool(0.25) { spread(rng, 0.5, 2.0) } else { 1.0 };
    let content = Content::draw(rng, drawing, pixel);
    let ground = like(rng, recipe.papers, 0.04);
    let inverted = kind == Kind::Clean && rng.random_bool(0.2);
    let pens: Vec<Pen> = content.pens.iter().map(|_| Pen::draw(rng, recipe.media, ground)).collect();
    let contrast = faintest(&pens, ground);
    // Nobody would see a faint mark on a sheet as rough as a bold one's.
    let rough = (3.0 * contrast).min(1.0);
    let mut canvas = paper::sheet(rng, content.pens[0].size(), ground, (recipe.rough, rough));
    below(rng, &mut canvas, &recipe, (ground, &pens), &other.scaled(1.0 / pixel));
    draw(rng, &mut canvas, &recipe, &content, &pens);
    let kept = above(rng, &mut canvas, &recipe);
    lit(rng, &mut canvas, &recipe);
    reproduced(rng, &mut canvas, &recipe, contrast);
    if inverted {
        canvas.map(|v| 1.0 - v);
    }
    canvas.map(|v| v.clamp(0.0, 1.0));
    let size = content.ink.size();
    let brought = |plane: Raster<f32>| if pixel == 1.0 { plane } else { resampled(&plane, size, pixel) };
    let (mut ink, kept) = (content.ink, brought(kept));
    ink.data_mut().iter_mut().zip(kept.data()).for_each(|(i, k)| *i *= k);
    Page { color: canvas.planes.map(brought), ink, drawing: content.marks }
}

/// The contrast of the pen that is seen least.
fn faintest(pens: &[Pen], ground: Rgb) -> f32 {
    pens.iter().map(|pen| pen.contrast(ground)).fold(1.0, f32::min)
}

/// An image at another resolution: a pixel of it is `pixel` of the result's wide.
fn resampled(image: &Raster<f32>, (width, height): (usize, usize), pixel: f64) -> Raster<f32> {
    // Where pixels become larger they are means of all that they cover.
    let samples = (1.0 / pixel).ceil() as usize;
    let spots: Vec<f64> = (0..samples).map(|i| (i as f64 + 0.5) / samples as f64).collect();
    let inside = |v: f64, n: usize| (v / pixel).clamp(0.5, n as f64 - 0.5);
    Raster::from_fn(width, height, |x, y| {
        let at = |dx: &f64, dy: &f64| {
            let (x, y) = (inside(x as f64 + dx, image.width()), inside(y as f64 + dy, image.height()));
            image.sample(kurbo::Point::new(x, y))
        };
        let sum: f32 = spots.iter().flat_map(|dy| spots.iter().map(move |dx| at(dx, dy))).sum();
        sum / (samples * samples) as f32
    })
}

/// Now and then a page has what is usual on others.
fn mixed(rng: &mut impl Rng, recipe: &mut Recipe) {
    if recipe.rough > 0.0 && rng.random_bool(0.2) {
        let more = [
            &mut recipe.ruling,
            &mut recipe.stains,
            &mut recipe.folds,
            &mut recipe.shadow,
            &mut recipe.tints,
            &mut recipe.edge,
            &mut recipe.ghost,
        ];
        // What a two-tone page would turn into ink stays away from it.
        if recipe.two_tones == 0.0 {
            more.into_iter().for_each(|chance| *chance = (*chance + 0.25).min(1.0));
        }
    }
}

/// What is on the sheet before anything is drawn.
fn below(rng: &mut impl Rng, canvas: &mut Canvas, recipe: &Recipe, (ground, pens): (Rgb, &[Pen]), other: &Drawing) {
    let (dark, contrast) = (brightness(ground) < 0.4, faintest(pens, ground));
    if rng.random_bool(recipe.tints) {
        print::tints(rng, canvas, if dark { DEEP } else { TINTS }, contrast);
    }
    if rng.random_bool(recipe.ruling) {
        rule(rng, canvas, (dark, contrast), pens);
    }
    let (ghost, wiped) = (rng.random_bool(recipe.ghost), rng.random_bool(recipe.wiped));
    if ghost || wiped {
        let traces = crate::render::render(other);
        let color = if dark { [0.85; 3] } else { like(rng, GHOSTS, 0.05) };
        // Weaker than the marks themselves, or nobody could tell.
        let strength = amount(rng, (0.08, 0.45)) * contrast.min(0.8);
        if ghost {
            paper::ghost(rng, canvas, &traces, color, strength);
        } else {
            paper::wiped(rng, canvas, &traces, color, strength.max(0.04));
        }
    }
    worn(rng, canvas, recipe, 0.5);
}

const TINTS: &[Rgb] = &[
    [0.95, 0.85, 0.5],
    [0.6, 0.8, 0.95],
    [0.95, 0.65, 0.6],
    [0.65, 0.88, 0.6],
    [0.8, 0.7, 0.92],
    [0.75, 0.75, 0.75],
    [0.55, 0.55, 0.6],
    [0.9, 0.6, 0.3],
    [0.3, 0.55, 0.8],
];
const DEEP: &[Rgb] = &[[0.5; 3], [0.4, 0.6, 0.8], [0.8, 0.5, 0.4]];
const GHOSTS: &[Rgb] = &[[0.1; 3], [0.3, 0.3, 0.35], [0.15, 0.25, 0.6], [0.7, 0.2, 0.2], [0.2, 0.5, 0.3]];

/// Rules the sheet in a colour of its own, or in that of a pen but weaker.
fn rule(rng: &mut impl Rng, canvas: &mut Canvas, (dark, contrast): (bool, f32), pens: &[Pen]) {
    const RULES: &[Rgb] = &[
        [0.35, 0.55, 0.85],
        [0.45, 0.65, 0.9],
        [0.2, 0.4, 0.75],
        [0.85, 0.4, 0.4],
        [0.4, 0.7, 0.45],
        [0.6, 0.45, 0.75],
        [0.9, 0.6, 0.3],
        [0.3, 0.65, 0.7],
    ];
    let lines = ruling::ruling(rng, canvas.size());
    let gray = dark || rng.random_bool(0.3);
    let (color, most) = match (dark, gray) {
        (true, _) => ([0.9; 3], 0.6 * f64::from(contrast)),
        (_, true) => ([0.3; 3], 0.6 * f64::from(contrast)),
        _ => {
            let color = like(rng, RULES, 0.06);
            let alike = pens.iter().any(|pen| apart(pen.color(), color) < 0.4);
            (color, if alike { 0.6 * f64::from(contrast) } else { 1.0 })
        }
    };
    let strength = spread(rng, 0.06, 1.0) * most;
    canvas.cover(&lines, color, strength as f32);
    if !gray && rng.random_bool(0.3) {
        let margin = ruling::margin(rng, canvas.size());
        canvas.cover(&margin, near(rng, [0.85, 0.3, 0.3], 0.08), amount(rng, (0.2, 0.9)));
    }
}

/// Age and use; each at most with a share of its chance.
fn worn(rng: &mut impl Rng, canvas: &mut Canvas, recipe: &Recipe, share: f64) {
    if rng.random_bool(share * recipe.stains) {
        match rng.random_range(0..5) {
            0 => paper::foxing(rng, canvas),
            1 => paper::ring(rng, canvas),
            _ => paper::stain(rng, canvas),
        }
    }
    if rng.random_bool(share * recipe.folds) {
        if rng.random_bool(0.3) {
            paper::crumple(rng, canvas);
        }
        for _ in 0..rng.random_range(0..3) {
            paper::fold(rng, canvas);
        }
    }
}

/// The marks of every pen.
fn draw(rng: &mut impl Rng, canvas: &mut Canvas, recipe: &Recipe, content: &Content, pens: &[Pen]) {
    for (marks, pen) in content.pens.iter().zip(pens) {
        if rng.random_bool(recipe.screen) && rng.random_bool(0.6) {
            let tone = marks.map(|m| m * 0.85);
            let dots = print::screened(rng, &tone);
            canvas.cover(&dots, pen.color(), amount(rng, (0.6, 1.0)));
        } else {
            pen.apply(rng, canvas, marks);
        }
    }
    if rng.random_bool(recipe.screen) && rng.random_bool(0.6) {
        // The paper's tone, or a picture below, comes as dots too.
        let (width, height) = canvas.size();
        let cell = within(rng, 20.0, 120.0);
        let level = amount(rng, (0.0, 0.3));
        let tone = super::noise::smooth(rng, width, height, cell).map(|v| (level + 0.3 * v).clamp(0.0, 0.55));
        let dots = print::screened(rng, &tone);
        canvas.stain(&dots, near(rng, [0.3; 3], 0.2), amount(rng, (0.3, 0.9)));
    }
}

/// What comes to lie over the marks; gives how much of each pixel still shows them.
fn above(rng: &mut impl Rng, canvas: &mut Canvas, recipe: &Recipe) -> Raster<f32> {
    if rng.random_bool(recipe.highlight) {
        print::highlight(rng, canvas);
    }
    worn(rng, canvas, recipe, 0.6);
    let (width, height) = canvas.size();
    let mut kept = Raster::filled(width, height, 1.0);
    let mut keep = |part: Raster<f32>| kept.data_mut().iter_mut().zip(part.data()).for_each(|(k, p)| *k *= p);
    if rng.random_bool(recipe.objects) {
        keep(objects::object(rng, canvas));
    }
    if rng.random_bool(recipe.edge) {
        keep(objects::edge(rng, canvas));
    }
    kept
}

fn lit(rng: &mut impl Rng, canvas: &mut Canvas, recipe: &Recipe) {
    if rng.random_bool(recipe.uneven) {
        light::uneven(rng, canvas);
    }
    if rng.random_bool(0.2 * recipe.uneven) {
        light::vignette(rng, canvas);
    }
    for chance in [1.0, 0.5, 0.3] {
        if rng.random_bool(chance * recipe.shadow) {
            light::shadow(rng, canvas);
        }
    }
    if rng.random_bool(recipe.glare) {
        light::glare(rng, canvas);
    }
}

/// From what lies there to an image; faint marks get the less noise.
fn reproduced(rng: &mut impl Rng, canvas: &mut Canvas, recipe: &Recipe, contrast: f32) {
    let noise = if recipe.noise.0 > 0.0 { spread(rng, recipe.noise.0, recipe.noise.1) as f32 } else { 0.0 };
    let noise = noise * (3.0 * contrast).min(1.0);
    if rng.random_bool(recipe.copier) {
        copier::copied(rng, canvas, contrast);
    }
    canvas.blur(within(rng, recipe.blur.0, recipe.blur.1));
    if rng.random_bool(recipe.motion) {
        camera::motion(rng, canvas);
    }
    if noise > 0.0 && rng.random_bool(0.85) {
        camera::noise(rng, canvas, noise);
    }
    if rng.random_bool(recipe.sharpen) {
        camera::sharpen(rng, canvas);
    }
    if recipe.rough > 0.0 && rng.random_bool(0.3) {
        camera::gamma(rng, canvas);
    }
    if rng.random_bool(recipe.two_tones) {
        copier::two_tones(rng, canvas);
        return;
    }
    if rng.random_bool(recipe.clip) {
        camera::clip(rng, canvas, contrast);
    }
    if rng.random_bool(recipe.gray) {
        canvas.fade(1.0);
    }
    if rng.random_bool(recipe.jpeg) {
        let quality = rng.random_range(25..96);
        camera::jpeg(rng, canvas, quality);
    }
}
