//! Which ends meet, where, and which of them are one stroke.
//!
//! ```text
//!  contacts       what each end stops at: a body, another end, or nothing
//!  node           ends that meet are one node, whose place its arms tell
//!  free end       an end that meets nothing is half a line width short of its ink
//!  pairing        at each node, the arms that go on in each other are one stroke
//! ```

mod contacts;
mod free_end;
mod node;
mod pairing;

pub(in crate::graph) use free_end::free_end;
pub(in crate::graph) use node::Node;
pub(in crate::graph) use pairing::two_corners;

use super::lines::Lines;
use crate::clean::LineImage;

/// The nodes at which lines end. Every end is in one of them.
pub(in crate::graph) fn resolve(image: &LineImage, lines: &Lines) -> Vec<Node> {
    node::nodes(image, lines, &contacts::contacts(image, lines))
}
