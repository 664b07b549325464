//! From streamlines to the stroke graph.
//!
//! A streamline runs straight through crossings and, at its ends, over the middle of whatever stopped it up to
//! the far edge of the ink. Passes repair what the walks could not see ([`REPAIRS`]); each end is resolved, against the
//! body of another line as a tee, against other ends as a corner or a branch, in the open as a free end half a width short
//! of the edge; arms are paired into strokes; and passes finish the graph ([`FINISHES`]).
//!
//! # Where to find what
//!
//! | question | answer |
//! |---|---|
//! | Why does a pass run where it does? | `passes`: the table, with a reason for each place |
//! | Where do two ends become one stroke? | `resolve/pairing`, at a node; `finish/gaps`, over paper; `repair/tangency` and `repair/fork`, in shared ink |
//! | How is a kind of junction added? | a variant of [`JunctionKind`], set in `assemble`; what meets there is told in `resolve/node`; its mark is in `inspect` and its name in the graph's JSON format |
//! | How is a situation repaired? | a file in `repair`, which takes lines and edits them, and a row in `passes` |
//! | What is known of an end? | [`EndState`]: who sets it, and who reads it |
//! | Why did a drawing lose a stroke? | `--debug-dir` has a picture after each pass that changed something |
//!
//! # Words
//!
//! ```text
//!   streamline   what a walk along the field gives: points half a pixel apart
//!   line         a streamline while it is repaired; it may be cut, led on and joined
//!   end          the first or the last point of an open line, and what is known of it
//!   tip          the last point before an end at which the line is alone in its ink, so that its width is known
//!   course       where a line is heading: place, direction and curvature, from what lies before its tip
//!   arm          a line as it comes to a place at which others are
//!   body         a line that passes where another ends
//!
//!         ___        body         a stem that        stem ____.--- arm
//!        /   \     ---------      meets a body:     -------'-----  arm
//!   ____/_____\__      | stem     a tee
//!      touch           |                             fork: a line leaves another at a small angle
//!
//!   touch        two lines whose inks are one for a while, each going on as it came
//!   fork         two arms that run into one stem; the straighter one is the stem's line
//!   cusp         two lines that run into one and end there together, as the humps of a coil: \_/\_/
//!   passage      a fine line that goes under a broad one and comes out on its other side
//!   node         a place at which lines end or cross
//!   edge         a line between two nodes
//!   trail        edges in a row: one stroke of the pen
//!   stroke       a trail once it is fitted
//! ```
//!
//! # Constants
//!
//! Each lies beside what it decides. Lengths are in widths of the page's line, since all that is decided here scales with the
//! pen; what is in pixels, for the raster's sake, says so. Angles are in radians; `_COS` is the cosine of one, and directions
//! within that angle pass. What gives no reason for its value was found by trying, and is guarded by the sweep that the row
//! of its pass names; of contacts, nodes and pairing by `tests/junctions.rs` and `tests/encounters.rs`.
//!
//! # The order of the modules
//!
//! `model`, `point_index`, `lines`, `dots`, `pens`, `resolve`, `repair`, `assemble`, `finish`, `passes`, `build`: each uses
//! only those before it.

mod assemble;
mod build;
mod dots;
mod finish;
mod lines;
mod model;
mod passes;
mod pens;
mod point_index;
mod repair;
mod resolve;

pub use build::{Ran, Watch, Work, build};
pub use finish::DOUBTFUL;
pub(crate) use finish::join_layers;
pub use lines::{EndState, Line};
pub(crate) use model::TrailPoint;
pub use model::{Dot, Edge, Junction, JunctionKind, Page, StrokeGraph, Trail};
pub use passes::{FINISHES, Pass, Passes, REPAIRS, When, all as passes};
