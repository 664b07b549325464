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
use canvas::{Canvas, Rgb, brightness};
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
}

/// A page of a kind that shows one drawing, and traces of another.
pub fn page(rng: &mut impl Rng, kind: Kind, drawing: Drawing, other: &Drawing) -> Page {
    let mut recipe = kind.recipe();
    mixed(rng, &mut recipe);
    let mut content = Content::draw(rng, drawing);
    let size = content.ink.size();
    let ground = like(rng, recipe.papers, 0.04);
    let inverted = kind == Kind::Clean && rng.random_bool(0.12);
    let pens: Vec<Pen> = content.pens.iter().map(|_| Pen::draw(rng, recipe.media, ground)).collect();
    let contrast = pens.iter().map(|p| p.contrast(ground)).fold(1.0, f32::min);
    let mut canvas = paper::sheet(rng, size, ground, recipe.rough);
    below(rng, &mut canvas, &recipe, (ground, contrast), other);
    draw(rng, &mut canvas, &recipe, &content, &pens);
    above(rng, &mut canvas, &recipe, &mut content);
    lit(rng, &mut canvas, &recipe);
    reproduced(rng, &mut canvas, &recipe, contrast);
    if inverted {
        canvas.map(|v| 1.0 - v);
    }
    canvas.map(|v| v.clamp(0.0, 1.0));
    Page { color: canvas.planes, ink: content.ink }
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
fn below(rng: &mut impl Rng, canvas: &mut Canvas, recipe: &Recipe, (ground, contrast): (Rgb, f32), other: &Drawing) {
    let dark = brightness(ground) < 0.4;
    if rng.random_bool(recipe.tints) {
        print::tints(rng, canvas, if dark { DEEP } else { TINTS });
    }
    if rng.random_bool(recipe.ruling) {
        rule(rng, canvas, dark, contrast);
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
fn rule(rng: &mut impl Rng, canvas: &mut Canvas, dark: bool, contrast: f32) {
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
        _ => (like(rng, RULES, 0.06), 1.0),
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

/// What comes to lie over the marks.
fn above(rng: &mut impl Rng, canvas: &mut Canvas, recipe: &Recipe, content: &mut Content) {
    if rng.random_bool(recipe.highlight) {
        print::highlight(rng, canvas);
    }
    worn(rng, canvas, recipe, 0.6);
    if rng.random_bool(recipe.objects) {
        content.keep(&objects::object(rng, canvas));
    }
    if rng.random_bool(recipe.edge) {
        content.keep(&objects::edge(rng, canvas));
    }
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
    let noise = amount(rng, recipe.noise) * (3.0 * contrast).min(1.0);
    if rng.random_bool(recipe.copier) {
        copier::copied(rng, canvas);
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
        camera::clip(rng, canvas);
    }
    if rng.random_bool(recipe.gray) {
        canvas.fade(1.0);
    }
    if rng.random_bool(recipe.jpeg) {
        let quality = rng.random_range(25..96);
        camera::jpeg(rng, canvas, quality);
    }
}
