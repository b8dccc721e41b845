//! Water on a grid: the edge of a flood that rises (priority-flood: Barnes, Lehman and Mulla 2014, Computers & Geosciences 62),
//! and where the ways of running water end.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The neighbours of a cell as steps of columns and rows, from the east clockwise.
pub(crate) const STEPS: [(isize, isize); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The neighbours of a cell with their index in [`STEPS`]; `None` beyond the border.
pub(crate) fn neighbours(cell: usize, cols: usize, rows: usize) -> impl Iterator<Item = Option<(usize, usize)>> {
    let (col, row) = (cell % cols, cell / cols);
    STEPS.iter().enumerate().map(move |(k, step)| {
        let col = col.checked_add_signed(step.0).filter(|col| *col < cols)?;
        let row = row.checked_add_signed(step.1).filter(|row| *row < rows)?;
        Some((k, row * cols + col))
    })
}

/// Where the ways from each cell to its next one end: at a cell that is its own next one, or at a number that is no cell.
pub(crate) fn ways_end(mut next: Vec<u32>) -> Vec<u32> {
    for first in 0..next.len() {
        let mut end = first as u32;
        while let Some(&after) = next.get(end as usize)
            && after != end
        {
            end = after;
        }
        // Later ways that come to these cells are short.
        let mut cell = first as u32;
        while cell != end {
            cell = std::mem::replace(&mut next[cell as usize], end);
        }
    }
    next
}

/// The cells at the flood's edge. The one with the lowest key is next. Of cells with one key, the first is next, so that
/// level ground is flooded evenly from its edge.
pub(crate) struct Flood<K> {
    /// The key, the cell's turn, the cell.
    edge: BinaryHeap<Reverse<(K, u32, u32)>>,
    turn: u32,
}

impl<K: Ord> Flood<K> {
    /// A flood that has not begun.
    pub fn new() -> Self {
        Self { edge: BinaryHeap::new(), turn: 0 }
    }

    /// Adds a cell that the flood reaches. There are no more cells than 32 bits count, and each is added once.
    pub fn push(&mut self, cell: usize, key: K) {
        self.edge.push(Reverse((key, self.turn, cell as u32)));
        self.turn += 1;
    }

    /// The next cell and its key.
    pub fn pop(&mut self) -> Option<(usize, K)> {
        let Reverse((key, _, cell)) = self.edge.pop()?;
        Some((cell as usize, key))
    }
}

/// A number with the order of a height. Both zeros have the same.
pub(crate) fn sortable(height: f32) -> u32 {
    let bits = (height + 0.0).to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// The height of a sortable number.
pub(crate) fn unsorted(number: u32) -> f32 {
    f32::from_bits(if number >> 31 == 1 { number & !(1 << 31) } else { !number })
}
