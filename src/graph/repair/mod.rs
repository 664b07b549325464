//! Repairs of lines, a file for each situation.

mod approach;
pub(in crate::graph) mod cusp;
pub(in crate::graph) mod fork;
pub(in crate::graph) mod gap_before_body;
pub(in crate::graph) mod overlap;
pub(in crate::graph) mod swapped_arms;
pub(in crate::graph) mod tangency;
pub(in crate::graph) mod tangent_end;
pub(in crate::graph) mod wrong_arm;
