//! The passes from lines to strokes, in the order in which they run, and why in that order.
//!
//! A pass is a row of [`REPAIRS`], which work on lines, or of [`FINISHES`], which work on the graph. Between the two, ends
//! are resolved and the graph is assembled; that is no pass, for nothing comes out without it.
//!
//! # What each is worth
//!
//! By how much the mean figures of forty drawings change when it is left out, in thousandths, as clean renders, as scans, and
//! as scans on white paper (`cargo bench --bench passes`); in how many of them it did something; and the share of the cases of a
//! sweep that keep its rule, with it, at least, and without.
//!
//! | pass | drawings | junction_f1 | integrity | purity | sweep |
//! |---|---|---|---|---|---|
//! | dot | 0, 0, 0 | | | | dots 1.000 to 0 |
//! | overlap | 10, 16, 13 | -5.0, -3.8, +2.1 | 0, -3.0, +2.5 | 0, +6.1, +0.9 | openings of corners 0.933 to 0.929 |
//! | gap before a body | 0, 16, 16 | 0, -30.0, -34.8 | 0, +0.6, +0.1 | 0, -1.1, -0.8 | gaps on pencil scans 0.986 to 0.456 |
//! | tangency | 0, 0, 0 | | | | shallow crossings 0.867 to 0.822 |
//! | cusp | 0, 1, 0 | 0, 0, 0 | 0, 0, 0 | 0, 0, 0 | humps of a coil 0.711 to 0.022 |
//! | fork | 3, 5, 4 | -11.1, -4.7, -0.5 | -2.4, +0.5, +0.1 | +1.5, -0.4, -0.3 | twin arcs from a line 0.583 to 0.417 |
//! | colour change | 0, 0, 0 | | | | lines that go on in another colour 0.928 to 0 |
//! | tangent end | 7, 6, 5 | -12.0, -10.3, -13.1 | -1.4, -0.3, -0.6 | +0.1, 0, -5.7 | tangential merges 0.900 to 0.883 |
//! | swapped arms | 0, 0, 0 | | | | three through a point 0.973 to 0.867 |
//! | wrong arm | 3, 6, 8 | -2.8, -0.2, -0.5 | 0, -3.2, -1.0 | -10.0, -12.5, -4.3 | corners that share their vertex 0.944 to 0.009 |
//! | colour | 0, 0, 0 | | | | crossings of two colours 0.919 to 0 |
//! | taper | 0, 0, 0 | | | | tapers 0.989 to 0.615 |
//! | gap | 0, 0, 3 | 0, 0, 0 | 0, 0, 0 | 0, 0, +0.2 | broken pencil lines 1.000 to 0; endpoint_f1 0, 0, -34.7 |
//! | confidence | 19, 21, 20 | | | | none: it tells of junctions and changes no line |

use super::lines::Lines;
use super::pens::Pens;
use super::repair::{cusp, fork, gap_before_body, overlap, swapped_arms, tangency, tangent_end, wrong_arm};
use super::resolve::{Node, resolve};
use super::{Dot, StrokeGraph, dots, finish};
use crate::clean::LineImage;
use crate::error::{Error, Result};
use crate::options::{Options, StrokeWidth};
use std::fmt;

/// A step from lines to strokes.
pub struct Pass {
    /// What is looked for.
    pub name: &'static str,
    /// When it runs.
    pub when: When,
    /// Why it runs at its place in the order.
    pub why: &'static str,
    /// The test that fails without it: the program's name and the test's.
    pub guarded_by: &'static str,
    /// Does it, and returns how much it changed.
    pub(super) run: fn(&mut Draft) -> usize,
}

impl fmt::Debug for Pass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// When a pass runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// On every page.
    Always,
    /// On a page with unsure ink.
    Unsure,
    /// On a page in colour.
    Colored,
    /// Where strokes are to be outlines.
    Outlines,
}

impl When {
    pub(super) fn holds(self, draft: &Draft) -> bool {
        match self {
            Self::Always => true,
            Self::Unsure => !draft.image.noise.is_sure(),
            Self::Colored => draft.image.colors.is_some(),
            Self::Outlines => draft.options.width == StrokeWidth::Outline,
        }
    }
}

/// A drawing between its streamlines and its graph.
pub(super) struct Draft<'a> {
    pub image: &'a LineImage,
    pub options: &'a Options,
    /// The lines, until they are assembled.
    pub lines: Lines,
    /// The nodes of the lines, where a pass has resolved them and nothing was changed since.
    pub nodes: Option<Vec<Node>>,
    pub dots: Vec<Dot>,
    /// The pens, once they are told apart.
    pub pens: Option<Pens<'a>>,
    /// The graph, once it is assembled.
    pub graph: StrokeGraph,
}

/// What is done to lines before their ends are resolved.
pub static REPAIRS: [Pass; 10] = [
    Pass {
        name: "dot",
        when: When::Always,
        why: "first: a dot has no course, and every other pass asks lines for theirs",
        guarded_by: "junctions::dots_stay_dots",
        run: |draft| {
            draft.dots = dots::take_out(draft.image, &mut draft.lines);
            draft.dots.len()
        },
    },
    Pass {
        name: "overlap",
        when: When::Always,
        why: "before all that look at ends: where two walks lie on each other, neither tells where its line was going",
        guarded_by: "passes::what_an_end_shares_with_another_line_is_cut_off",
        run: |draft| overlap::cut_off(draft.image, &mut draft.lines),
    },
    Pass {
        name: "gap before a body",
        when: When::Unsure,
        why: "before all that join: what was drawn apart must not be taken for the arm of a junction",
        guarded_by: "junctions::a_pencil_stem_that_stops_short_stays_apart",
        run: |draft| gap_before_body::take_back(draft.image, &mut draft.lines),
    },
    Pass {
        name: "tangency",
        when: When::Always,
        why: "while lines are still as they were walked: it compares their arms on both sides of shared ink",
        guarded_by: "encounters::shallow_crossings_are_two_straight_strokes",
        run: |draft| tangency::part(draft.image, &mut draft.lines),
    },
    Pass {
        name: "cusp",
        when: When::Always,
        why: "before fork: two lines that run into one and end there look like a fork, of which one line would be the stem",
        guarded_by: "encounters::humps_of_a_coil_meet_at_the_tip_between_them",
        run: |draft| cusp::sharpen(draft.image, &mut draft.lines),
    },
    Pass {
        name: "fork",
        when: When::Always,
        why: "before tangent end, which leads the arm that leaves, and has to know which one that is",
        guarded_by: "encounters::two_arcs_that_leave_a_line_at_one_point_leave_it_whole",
        run: |draft| fork::straighten(draft.image, &mut draft.lines),
    },
    Pass {
        name: "colour change",
        when: When::Colored,
        why: "after all that join lines into longer ones, and before ends are led: those of its cuts are led as well",
        guarded_by: "color::a_stroke_ends_where_its_colour_does",
        run: |draft| {
            draft.pens = Pens::of(draft.image, &draft.lines, &draft.dots);
            let changes = draft.pens.as_ref().map_or(Vec::new(), |pens| pens.changes(&draft.lines));
            draft.lines.cut(&changes)
        },
    },
    Pass {
        name: "tangent end",
        when: When::Always,
        why: "after fork has told which arms end; before swapped arms, which looks at lines over all of the ink they share",
        guarded_by: "passes::an_arc_is_led_to_where_it_leaves_a_line",
        run: |draft| tangent_end::lead(draft.image, &mut draft.lines),
    },
    Pass {
        name: "swapped arms",
        when: When::Always,
        why: "once every line reaches to where it ends: only then is it seen which lines share ink, and how long",
        guarded_by: "encounters::three_lines_through_one_point_are_three_straight_strokes",
        run: |draft| {
            let cuts = swapped_arms::cuts(draft.image, &draft.lines);
            draft.lines.cut(&cuts)
        },
    },
    Pass {
        name: "wrong arm",
        when: When::Always,
        why: "last: it compares arms at nodes, and those are known once all ends are where they belong",
        guarded_by: "encounters::corners_that_share_their_vertex_stay_two",
        run: |draft| {
            let nodes = resolve(draft.image, &draft.lines);
            let cuts = wrong_arm::cuts(draft.image, &draft.lines, &nodes);
            draft.nodes = cuts.is_empty().then_some(nodes);
            draft.lines.cut(&cuts)
        },
    },
];

/// What is done to the graph once it is assembled.
pub static FINISHES: [Pass; 4] = [
    Pass {
        name: "colour",
        when: When::Colored,
        why: "before gaps: ends of two pens are not one line",
        guarded_by: "color::crossing_lines_keep_their_colours",
        run: |draft| draft.pens.as_ref().map_or(0, |pens| pens.paint(&mut draft.graph)),
    },
    Pass {
        name: "taper",
        when: When::Outlines,
        why: "before gaps: it moves the ends of tapering strokes",
        guarded_by: "outline::a_taper_is_kept_with_few_pieces",
        run: |draft| finish::taper::measure(draft.image, &mut draft.graph),
    },
    Pass {
        name: "gap",
        when: When::Always,
        why: "after all that move ends or tell them apart",
        guarded_by: "gaps::a_pencil_line_goes_on_behind_a_short_break",
        run: |draft| finish::gaps::bridge(draft.image, &mut draft.graph, draft.options),
    },
    Pass {
        name: "confidence",
        when: When::Always,
        why: "last: it tells how sure what has become of the junctions is",
        guarded_by: "passes::what_is_as_good_another_way_is_doubtful",
        run: |draft| finish::confidence::rate(&mut draft.graph),
    },
];

/// Which passes run: all, but for some.
#[derive(Clone, Debug, Default)]
pub struct Passes {
    without: Vec<String>,
}

impl Passes {
    /// The same without one more, by its name.
    ///
    /// # Errors
    /// [`Error::Option`] when no pass has the name.
    pub fn without(mut self, name: &str) -> Result<Self> {
        let names: Vec<&str> = all().map(|pass| pass.name).collect();
        if !names.contains(&name) {
            let reason = format!("{name:?} is none of {}", names.join(", "));
            return Err(Error::Option { option: "without", reason });
        }
        self.without.push(name.into());
        Ok(self)
    }

    pub(super) fn has(&self, pass: &Pass) -> bool {
        self.without.iter().all(|name| name != pass.name)
    }
}

/// All passes in their order.
pub fn all() -> impl Iterator<Item = &'static Pass> {
    REPAIRS.iter().chain(&FINISHES)
}
