//! Many drawings in one go: what is planned, what is written and said, and what happens when something breaks.

#[path = "../common/mod.rs"]
mod common;
mod desk;
#[cfg(unix)]
mod faults;
mod inputs;
#[cfg(unix)]
mod interrupts;
mod library;
mod output;
mod threads;
