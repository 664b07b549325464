//! The connected pieces of the ink.

use fieldtrace::raster::Mask;

/// Marks a missing neighbour.
pub(crate) const NONE: u32 = u32::MAX;

/// One 4-connected piece of ink; its pixels are numbered row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Component {
    /// Column and row of each pixel.
    pub(crate) pixels: Vec<(u32, u32)>,
    /// The numbers of the left and the upper neighbour, or [`NONE`]; both are smaller than the pixel's own.
    pub(crate) before: Vec<[u32; 2]>,
}

/// The 4-connected pieces of a mask, in the order of their first pixels.
pub(crate) fn components(mask: &Mask) -> Vec<Component> {
    let roots = roots(mask);
    let width = mask.width();
    // Of each pixel: the piece, and its number in there.
    let mut places = vec![(NONE, NONE); roots.len()];
    let mut pieces: Vec<Component> = Vec::new();
    for (i, &root) in roots.iter().enumerate().filter(|(_, root)| **root != NONE) {
        // A piece's root is its first pixel.
        if root as usize == i {
            places[i].0 = pieces.len() as u32;
            pieces.push(Component::default());
        }
        let id = places[root as usize].0;
        let piece = &mut pieces[id as usize];
        places[i] = (id, piece.pixels.len() as u32);
        let (x, y) = (i % width, i / width);
        let left = if x > 0 { places[i - 1].1 } else { NONE };
        let above = if y > 0 { places[i - width].1 } else { NONE };
        piece.pixels.push((x as u32, y as u32));
        piece.before.push([left, above]);
    }
    pieces
}

/// The first pixel of the piece that each pixel belongs to; [`NONE`] on paper.
fn roots(mask: &Mask) -> Vec<u32> {
    let width = mask.width();
    let mut parents: Vec<u32> = vec![NONE; mask.data().len()];
    for (i, _) in mask.data().iter().enumerate().filter(|(_, ink)| **ink) {
        parents[i] = i as u32;
        let left = (i % width > 0).then(|| i - 1);
        let above = i.checked_sub(width);
        for j in [left, above].into_iter().flatten().filter(|&j| mask.data()[j]) {
            let (a, b) = (find(&mut parents, i as u32), find(&mut parents, j as u32));
            parents[a.max(b) as usize] = a.min(b);
        }
    }
    // Parents come before their children, so one pass in order leaves every pixel at its root.
    for i in 0..parents.len() {
        if parents[i] != NONE {
            parents[i] = parents[parents[i] as usize];
        }
    }
    parents
}

/// The root of a pixel; halves the path to it on the way.
fn find(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        parents[i as usize] = parents[parents[i as usize] as usize];
        i = parents[i as usize];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(rows: &[&str]) -> Mask {
        Mask::from_fn(rows[0].len(), rows.len(), |x, y| rows[y].as_bytes()[x] == b'#')
    }

    #[test]
    fn pieces_are_told_apart_and_ordered() {
        let pieces = components(&mask(&["#..#", "#.##", ".#..", "...."]));
        let pixels: Vec<_> = pieces.iter().map(|p| p.pixels.clone()).collect();
        assert_eq!(pixels, [vec![(0, 0), (0, 1)], vec![(3, 0), (2, 1), (3, 1)], vec![(1, 2)]]);
        assert_eq!(pieces[1].before, [[NONE, NONE], [NONE, NONE], [1, 0]]);
    }

    #[test]
    fn arms_that_meet_late_are_one_piece() {
        let pieces = components(&mask(&["#.#.#", "#.#.#", "#####"]));
        assert_eq!(pieces.len(), 1);
        assert_eq!(pieces[0].pixels.len(), 11);
        for (i, before) in pieces[0].before.iter().enumerate() {
            assert!(before.iter().all(|&b| b == NONE || (b as usize) < i));
        }
    }

    #[test]
    fn nothing_has_no_pieces() {
        assert!(components(&Mask::filled(3, 2, false)).is_empty());
        assert!(components(&Mask::filled(0, 0, false)).is_empty());
    }
}
