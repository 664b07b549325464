//! How long each stage takes for a megapixel of lines: `cargo bench --bench stages`, or with a stage's name after it.

mod clean;
#[path = "../common/mod.rs"]
mod common;
mod decode;
mod fit;
mod graph;
mod network;
mod page;
mod streamlines;
mod whole;
mod write;

fn main() {
    divan::main();
}
