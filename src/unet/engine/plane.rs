//! Feature maps with a border, and which of their pixels are computed.

/// Channels are stored in groups of this many.
pub(super) const BLOCK: usize = 16;

/// A feature map, row by row, the channels of a pixel side by side, with a border of one pixel that stays zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Plane {
    pub width: usize,
    pub height: usize,
    /// Channels, a multiple of [`BLOCK`] unless it is the network's input.
    pub channels: usize,
    data: Vec<f32>,
}

impl Plane {
    pub fn new(width: usize, height: usize, channels: usize) -> Self {
        Self { width, height, channels, data: vec![0.0; (width + 2) * (height + 2) * channels] }
    }

    fn start(&self, x: usize, y: usize) -> usize {
        (y * (self.width + 2) + x) * self.channels
    }

    /// The channels of pixels `[x, x + n)` of row `y`; -1 is the border, so coordinates are shifted by one.
    pub fn bordered(&self, x: usize, y: usize, n: usize) -> &[f32] {
        let start = self.start(x, y);
        &self.data[start..start + n * self.channels]
    }

    /// Writes what the first pixel holds everywhere, to the border and beyond.
    pub fn spread(&mut self) {
        let pixel = self.pixels(0, 0, 1).to_vec();
        self.data.chunks_exact_mut(pixel.len()).for_each(|to| to.copy_from_slice(&pixel));
    }

    /// The channels of pixels `[x, x + n)` of row `y`.
    pub fn pixels(&self, x: usize, y: usize, n: usize) -> &[f32] {
        self.bordered(x + 1, y + 1, n)
    }

    /// The same to be written.
    pub fn pixels_mut(&mut self, x: usize, y: usize, n: usize) -> &mut [f32] {
        let start = self.start(x + 1, y + 1);
        &mut self.data[start..start + n * self.channels]
    }
}

/// Which cells of a tile are computed, one cell being a pixel of the lowest level.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    pub columns: usize,
    pub rows: usize,
    active: Vec<bool>,
    /// Cells that are not computed and touch one that is.
    rim: Vec<bool>,
}

impl Cells {
    pub fn new(columns: usize, rows: usize, active: Vec<bool>) -> Self {
        let near = |i: usize| {
            let (x, y) = (i % columns, i / columns);
            let span = |p: usize, n: usize| p.saturating_sub(1)..(p + 2).min(n);
            span(y, rows).any(|v| span(x, columns).any(|u| active[v * columns + u]))
        };
        let rim = (0..active.len()).map(|i| !active[i] && near(i)).collect();
        Self { columns, rows, active, rim }
    }

    /// 1 for each cell that is computed and 0 for the others, row by row.
    #[cfg(feature = "train")]
    pub fn shares(&self) -> Vec<f32> {
        self.active.iter().map(|&a| if a { 1.0 } else { 0.0 }).collect()
    }

    /// Calls `f(x, y, n)` for each horizontal run of computed pixels at a level whose cells are `side` pixels wide.
    pub fn runs(&self, side: usize, f: impl FnMut(usize, usize, usize)) {
        self.runs_of(&self.active, side, f);
    }

    /// The same pixel by pixel; tiles are far smaller than the type's range.
    pub fn places(&self, side: usize) -> Vec<(u16, u16)> {
        let mut places = Vec::new();
        self.runs(side, |x, y, n| places.extend((x..x + n).map(|x| (x as u16, y as u16))));
        places
    }

    /// The top left corners of the squares of 2x2 pixels that make up cells of an even side.
    pub fn squares(&self, side: usize) -> Vec<(u16, u16)> {
        let mut squares = Vec::new();
        self.runs(side / 2, |x, y, n| squares.extend((x..x + n).map(|x| (2 * x as u16, 2 * y as u16))));
        squares
    }

    /// The same for the pixels of rim cells.
    pub fn rim_runs(&self, side: usize, f: impl FnMut(usize, usize, usize)) {
        self.runs_of(&self.rim, side, f);
    }

    fn runs_of(&self, cells: &[bool], side: usize, mut f: impl FnMut(usize, usize, usize)) {
        for row in 0..self.rows {
            let cells = &cells[row * self.columns..(row + 1) * self.columns];
            let mut x = 0;
            while x < self.columns {
                let n = cells[x..].iter().take_while(|c| **c == cells[x]).count();
                if cells[x] {
                    (row * side..(row + 1) * side).for_each(|y| f(x * side, y, n * side));
                }
                x += n;
            }
        }
    }
}
