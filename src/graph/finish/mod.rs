//! What is done to the graph once it is assembled.

pub(in crate::graph) mod confidence;
pub(in crate::graph) mod gaps;
pub(crate) mod layers;
pub(in crate::graph) mod taper;
