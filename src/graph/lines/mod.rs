//! The lines of a drawing while they are repaired.

pub(in crate::graph) mod course;
pub(in crate::graph) mod end;
