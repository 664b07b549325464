//! Kinds of pages, and how likely each effect is on them.

use super::canvas::Rgb;
use super::pen::Medium;
use rand::Rng;
use serde::{Deserialize, Serialize};

/// What a page was, and how it became an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A render without noise.
    Clean,
    /// A gentle scan.
    Scan,
    /// A photocopy.
    Copy,
    /// A fax or a scan in two tones.
    Fax,
    /// A phone's photo under bad light.
    Photo,
    /// Old, stained, folded paper.
    Old,
    /// Pencils, faint ones too.
    Pencil,
    /// Ruled, squared and other printed paper.
    Ruled,
    /// A blueprint or a plan in pale lines.
    Blueprint,
    /// A chalkboard, or pale pens on dark paper.
    Board,
    /// A whiteboard with wiped traces and glare.
    Whiteboard,
    /// Print with screens.
    Screen,
    /// Highlighters and flat tints.
    Tinted,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Clean,
        Self::Scan,
        Self::Copy,
        Self::Fax,
        Self::Photo,
        Self::Old,
        Self::Pencil,
        Self::Ruled,
        Self::Blueprint,
        Self::Board,
        Self::Whiteboard,
        Self::Screen,
        Self::Tinted,
    ];

    /// The name, as in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Scan => "scan",
            Self::Copy => "copy",
            Self::Fax => "fax",
            Self::Photo => "photo",
            Self::Old => "old",
            Self::Pencil => "pencil",
            Self::Ruled => "ruled",
            Self::Blueprint => "blueprint",
            Self::Board => "board",
            Self::Whiteboard => "whiteboard",
            Self::Screen => "screen",
            Self::Tinted => "tinted",
        }
    }

    /// Any kind but those that are held out, common ones more often.
    pub fn draw(rng: &mut impl Rng, held_out: &[Self]) -> Self {
        let open = || Self::ALL.into_iter().filter(|kind| !held_out.contains(kind));
        let mut left = rng.random::<f64>() * open().map(Self::share).sum::<f64>();
        for kind in open() {
            left -= kind.share();
            if left < 0.0 {
                return kind;
            }
        }
        Self::Clean
    }

    /// Share of the pages, relative to others.
    fn share(self) -> f64 {
        match self {
            Self::Clean | Self::Scan | Self::Copy | Self::Old => 10.0,
            Self::Photo | Self::Pencil => 13.0,
            Self::Ruled => 17.0,
            // Pale marks on dark are learned last: a network of 5 in 100 takes them for paper for long.
            Self::Blueprint | Self::Board => 11.0,
            Self::Fax | Self::Tinted => 7.0,
            Self::Whiteboard | Self::Screen => 6.0,
        }
    }
}

/// How likely each effect is, and how strong; shares are 0 to 1, ranges from low to high.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    pub papers: &'static [Rgb],
    pub media: &'static [Medium],
    /// Roughness of the paper.
    pub rough: f64,
    pub ruling: f64,
    pub tints: f64,
    pub highlight: f64,
    pub screen: f64,
    /// Print-through, or what was wiped off.
    pub ghost: f64,
    pub wiped: f64,
    pub stains: f64,
    pub folds: f64,
    pub objects: f64,
    pub edge: f64,
    pub uneven: f64,
    pub shadow: f64,
    pub glare: f64,
    pub copier: f64,
    pub two_tones: f64,
    /// Standard deviation of the lens' blur in pixels.
    pub blur: (f64, f64),
    /// Standard deviation of the sensor's noise.
    pub noise: (f64, f64),
    pub motion: f64,
    pub sharpen: f64,
    pub clip: f64,
    pub gray: f64,
    pub jpeg: f64,
}

const WHITE: &[Rgb] = &[[1.0; 3], [0.97, 0.97, 0.97], [0.98, 0.97, 0.94], [0.92, 0.92, 0.92], [0.95, 0.96, 1.0]];
const PAPERS: &[Rgb] = &[
    [0.97, 0.97, 0.97],
    [0.9, 0.9, 0.88],
    [0.96, 0.93, 0.84],
    [0.82, 0.82, 0.8],
    [0.7, 0.7, 0.7],
    [0.72, 0.58, 0.42],
    [0.98, 0.93, 0.6],
    [0.85, 0.9, 0.82],
    [0.95, 0.82, 0.82],
    [0.8, 0.87, 0.95],
    [0.55, 0.45, 0.33],
];
const OLD: &[Rgb] = &[
    [0.9, 0.82, 0.65],
    [0.82, 0.72, 0.52],
    [0.7, 0.58, 0.4],
    [0.93, 0.89, 0.78],
    [0.6, 0.5, 0.36],
    [0.78, 0.74, 0.66],
];
const BLUES: &[Rgb] = &[
    [0.05, 0.2, 0.5],
    [0.1, 0.3, 0.65],
    [0.15, 0.4, 0.7],
    [0.02, 0.12, 0.3],
    [0.3, 0.45, 0.65],
    [0.2, 0.25, 0.45],
    [0.1, 0.35, 0.4],
    [0.3, 0.12, 0.1],
];
const BOARDS: &[Rgb] = &[
    [0.08, 0.2, 0.14],
    [0.1, 0.28, 0.2],
    [0.12, 0.12, 0.13],
    [0.02, 0.02, 0.02],
    [0.25, 0.25, 0.26],
    [0.2, 0.32, 0.28],
    [0.3, 0.2, 0.15],
];

/// A render: nothing happens to it.
const PLAIN: Recipe = Recipe {
    papers: WHITE,
    media: &[Medium::Ink],
    rough: 0.0,
    ruling: 0.0,
    tints: 0.0,
    highlight: 0.0,
    screen: 0.0,
    ghost: 0.0,
    wiped: 0.0,
    stains: 0.0,
    folds: 0.0,
    objects: 0.0,
    edge: 0.0,
    uneven: 0.0,
    shadow: 0.0,
    glare: 0.0,
    copier: 0.0,
    two_tones: 0.0,
    blur: (0.0, 0.3),
    noise: (0.0, 0.0),
    motion: 0.0,
    sharpen: 0.0,
    clip: 0.0,
    gray: 0.3,
    jpeg: 0.0,
};

/// A scan of a sheet of paper.
const SCANNED: Recipe = Recipe {
    papers: PAPERS,
    media: &[Medium::Ink, Medium::Biro, Medium::Felt, Medium::Pencil],
    rough: 0.8,
    ruling: 0.2,
    tints: 0.05,
    highlight: 0.02,
    ghost: 0.1,
    stains: 0.05,
    folds: 0.05,
    objects: 0.03,
    edge: 0.06,
    uneven: 0.4,
    shadow: 0.03,
    blur: (0.25, 1.0),
    noise: (0.002, 0.03),
    sharpen: 0.15,
    clip: 0.25,
    gray: 0.35,
    jpeg: 0.7,
    ..PLAIN
};

/// A photo of a sheet of paper.
const PHOTO: Recipe = Recipe {
    media: &[Medium::Ink, Medium::Biro, Medium::Biro, Medium::Felt, Medium::Pencil, Medium::Crayon],
    ruling: 0.35,
    ghost: 0.15,
    stains: 0.12,
    folds: 0.2,
    objects: 0.15,
    edge: 0.18,
    uneven: 0.9,
    shadow: 0.7,
    glare: 0.06,
    blur: (0.3, 1.4),
    noise: (0.004, 0.06),
    motion: 0.12,
    sharpen: 0.25,
    clip: 0.1,
    gray: 0.12,
    jpeg: 0.9,
    ..SCANNED
};

impl Kind {
    /// What makes pages of this kind.
    pub(super) fn recipe(self) -> Recipe {
        match self {
            Self::Clean => Recipe { media: &[Medium::Ink, Medium::Ink, Medium::Felt], tints: 0.12, jpeg: 0.2, ..PLAIN },
            Self::Scan => SCANNED,
            Self::Copy => Recipe {
                papers: WHITE,
                media: &[Medium::Ink, Medium::Toner, Medium::Pencil, Medium::Biro],
                copier: 1.0,
                stains: 0.12,
                folds: 0.12,
                uneven: 0.6,
                gray: 1.0,
                noise: (0.005, 0.08),
                ..SCANNED
            },
            Self::Fax => Recipe {
                papers: WHITE,
                media: &[Medium::Ink, Medium::Toner, Medium::Biro],
                ruling: 0.0,
                tints: 0.0,
                ghost: 0.0,
                edge: 0.02,
                objects: 0.0,
                uneven: 0.15,
                shadow: 0.0,
                copier: 0.3,
                two_tones: 1.0,
                ..SCANNED
            },
            Self::Photo => PHOTO,
            Self::Old => Recipe {
                papers: OLD,
                media: &[Medium::Ink, Medium::Ink, Medium::Toner, Medium::Pencil, Medium::Crayon],
                rough: 1.0,
                stains: 0.75,
                folds: 0.6,
                ghost: 0.35,
                uneven: 0.7,
                ..SCANNED
            },
            Self::Pencil => Recipe {
                media: &[Medium::Pencil, Medium::Pencil, Medium::Pencil, Medium::Crayon],
                rough: 0.9,
                ruling: 0.3,
                uneven: 0.6,
                shadow: 0.15,
                gray: 0.4,
                ..SCANNED
            },
            Self::Ruled => Recipe { ruling: 1.0, shadow: 0.2, uneven: 0.6, ..SCANNED },
            Self::Blueprint => Recipe {
                papers: BLUES,
                media: &[Medium::Blueprint],
                ruling: 0.3,
                stains: 0.25,
                folds: 0.35,
                gray: 0.2,
                clip: 0.1,
                shadow: 0.15,
                ..SCANNED
            },
            Self::Board => Recipe {
                papers: BOARDS,
                media: &[Medium::Chalk, Medium::Chalk, Medium::Blueprint],
                rough: 1.0,
                ghost: 0.0,
                wiped: 0.5,
                highlight: 0.0,
                glare: 0.15,
                ..PHOTO
            },
            Self::Whiteboard => Recipe {
                papers: WHITE,
                media: &[Medium::Felt],
                rough: 0.15,
                ruling: 0.08,
                ghost: 0.0,
                wiped: 0.65,
                folds: 0.0,
                glare: 0.5,
                shadow: 0.4,
                ..PHOTO
            },
            Self::Screen => Recipe {
                media: &[Medium::Toner, Medium::Ink, Medium::Felt],
                screen: 1.0,
                ghost: 0.15,
                tints: 0.3,
                ..SCANNED
            },
            Self::Tinted => Recipe { tints: 0.75, highlight: 0.55, uneven: 0.5, shadow: 0.15, ..SCANNED },
        }
    }
}
