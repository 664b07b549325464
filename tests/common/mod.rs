//! Shared by the integration tests: drawings that are known, their rasters, and how far a trace is from the truth.

#![allow(dead_code)] // every test program uses its own part of it

pub mod compare;
pub mod draw;
pub mod figures;
pub mod sheet;
pub mod sweep;

#[path = "../../samples/paper.rs"]
pub mod paper;
