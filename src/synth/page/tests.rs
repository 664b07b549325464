use super::*;
use crate::render::render;
use crate::synth::drawing;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

fn sample(kind: Kind, seed: u64) -> Page {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (first, other) = (drawing(&mut rng, 96), drawing(&mut rng, 96));
    page(&mut rng, kind, first, &other)
}

#[test]
fn the_same_seed_gives_the_same_page() {
    for kind in Kind::ALL {
        let (a, b) = (sample(kind, 3), sample(kind, 3));
        assert_eq!((a.color, a.ink), (b.color, b.ink), "{}", kind.name());
    }
}

#[test]
fn pages_are_of_one_size_and_within_bounds() {
    for (kind, seed) in Kind::ALL.into_iter().flat_map(|kind| (0..8).map(move |seed| (kind, seed))) {
        let page = sample(kind, seed);
        for plane in page.color.iter().chain([&page.ink]) {
            assert_eq!(plane.size(), (96, 96));
            assert!(plane.data().iter().all(|v| (0.0..=1.0).contains(v)), "{} {seed}", kind.name());
        }
    }
}

/// How well the marks of a page, moved by so many pixels, tell what is dark.
fn agreement(page: &Page, (dx, dy): (i64, i64)) -> f64 {
    let mut sums = [0.0; 5];
    for y in 4..92i64 {
        for x in 4..92i64 {
            let ink = f64::from(page.ink[((x + dx) as usize, (y + dy) as usize)]);
            let seen = f64::from(page.color[1][(x as usize, y as usize)]);
            let terms = [ink, seen, ink * ink, seen * seen, ink * seen];
            sums.iter_mut().zip(terms).for_each(|(s, t)| *s += t / 7744.0);
        }
    }
    let [a, b, aa, bb, ab] = sums;
    (ab - a * b).powi(2) / ((aa - a * a) * (bb - b * b)).max(1e-9)
}

#[test]
fn truth_lies_where_the_marks_are() {
    for kind in Kind::ALL {
        let mut best = std::collections::BTreeMap::new();
        for seed in 0..24 {
            let page = sample(kind, seed);
            for shift in (-2..3).flat_map(|dx| (-2..3).map(move |dy| (dx, dy))) {
                *best.entry(shift).or_insert(0.0) += agreement(&page, shift);
            }
        }
        let found = best.iter().max_by(|a, b| a.1.total_cmp(b.1)).expect("some shift");
        assert_eq!(*found.0, (0, 0), "{}: {best:?}", kind.name());
    }
}

#[test]
fn a_clean_page_shows_its_drawing() {
    let mut line = Drawing::new(64.0, 64.0);
    let segment = crate::drawing::Segment::Line(kurbo::Line::new((8.0, 32.0), (56.0, 32.0)));
    line.strokes.push(crate::drawing::Stroke::new(
        crate::drawing::Centreline::Path { segments: vec![segment], closed: false },
        4.0,
    ));
    let ink = render(&line);
    let shown = (0..20).filter(|seed| {
        let mut rng = ChaCha8Rng::seed_from_u64(*seed);
        let page = page(&mut rng, Kind::Clean, line.clone(), &line);
        let covered = ink.data().iter().zip(page.ink.data()).all(|(a, b)| b + 0.02 >= *a);
        covered && page.ink[(32, 31)] > 0.9
    });
    // The others were left blank.
    assert!(shown.count() >= 14);
}
