//! Each pass between streamlines and graph on little drawings of its situation: what it must do, and what it must leave.

#[path = "../common/mod.rs"]
mod common;
mod figure;
mod finishes;
mod order;
mod repairs;
