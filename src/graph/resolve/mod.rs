//! Which ends meet, where, and which of them are one stroke.

pub(in crate::graph) mod contacts;
pub(in crate::graph) mod node;
