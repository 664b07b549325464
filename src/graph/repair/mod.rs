//! Repairs of lines: a file for each situation that a walk could not see through.
//!
//! Each takes the lines, edits them, and tells how much it changed. In what order they run, and why, is in `passes`.

mod approach;
pub(super) mod cusp;
pub(super) mod fork;
pub(super) mod gap_before_body;
mod leave;
pub(super) mod overlap;
pub(super) mod swapped_arms;
pub(super) mod tangency;
pub(super) mod tangent_end;
pub(super) mod wrong_arm;
