//! The same bytes on any number of threads.

use crate::desk::{Desk, large};
use image::{GrayImage, Luma};
use std::fs;
use std::path::Path;

/// `--jobs` and `RAYON_NUM_THREADS`.
type Threads = (Option<&'static str>, Option<&'static str>);

/// Traces the folder `in` once for each number of threads and requires the same of all.
fn same_for_all(desk: &Desk, all: &[Threads]) -> Vec<(String, String)> {
    let traced = |k: usize, (jobs, threads): Threads| {
        let out = format!("out{k}");
        let mut command = desk.command(&["in", "-o", &out]);
        command.args(jobs.into_iter().flat_map(|jobs| ["--jobs", jobs]));
        command.envs(threads.map(|threads| ("RAYON_NUM_THREADS", threads)));
        assert!(command.status().unwrap().success());
        desk.contents(&out)
    };
    let first = traced(0, all[0]);
    for (k, &threads) in all.iter().enumerate().skip(1) {
        let other = traced(k, threads);
        assert_eq!(other.len(), first.len());
        for ((name, svg), (_, expected)) in other.iter().zip(&first) {
            assert!(svg == expected, "{name} is another on {threads:?} than on {:?}", all[0]);
        }
    }
    first
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let desk = Desk::with_many(9);
    desk.picture("in/net.png", &large());
    let all = [
        (Some("1"), None),
        (Some("2"), None),
        (Some("7"), None),
        (Some("1"), Some("3")),
        (None, Some("1")),
        (None, Some("5")),
        (None, None),
    ];
    let first = same_for_all(&desk, &all);
    assert_eq!(first.len(), 10);
    // And so does each file on its own.
    for (name, svg) in &first {
        let input = format!("in/{}", name.replace("svg", "png"));
        desk.trace(&[&input, "-o", "alone.svg"]).done();
        assert_eq!(&desk.read("alone.svg"), svg, "{name}");
    }
}

/// A number that looks random.
fn dice(x: u32, y: u32) -> u32 {
    (x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77)).wrapping_mul(0x2C1B_3C6D) >> 16
}

#[test]
fn samples_and_textures_give_the_same_bytes_too() {
    let desk = Desk::new();
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    for name in ["kettle.png", "leaf.jpg", "boat.png", "plan.png"] {
        desk.put(&format!("in/{name}"), fs::read(samples.join(name)).unwrap());
    }
    type Texture = fn(u32, u32) -> u32;
    let textures: [(&str, Texture); 6] = [
        ("checkerboard", |x, y| 255 * ((x + y) % 2)),
        ("hatching", |x, y| if x % 7 < 2 || (x + 2 * y) % 11 < 2 { 0 } else { 255 }),
        ("salt", |x, y| if dice(x, y).is_multiple_of(8) { 0 } else { 255 }),
        ("grain", |x, y| dice(x, y) % 256),
        ("blobs", |x, y| if x % 6 < 3 && y % 6 < 3 { 0 } else { 255 }),
        ("steps", |x, y| if (x / 9 + y / 5) % 3 == 0 { 20 * (x % 9) } else { 255 }),
    ];
    for (name, texture) in textures {
        let image = GrayImage::from_fn(160, 120, |x, y| Luma([texture(x, y) as u8]));
        image.save(desk.path(&format!("in/{name}.png"))).unwrap();
    }
    let first = same_for_all(&desk, &[(Some("1"), None), (Some("3"), None), (None, Some("4"))]);
    assert_eq!(first.len(), 10);
}
