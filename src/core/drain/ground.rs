//! What is known about the ground at the cells of a grid, and the depressions in it.

use super::flood::neighbours;

/// Limits of heights at the cells of a grid, row by row.
pub(crate) struct Ground<'a> {
    pub cols: usize,
    pub rows: usize,
    /// Lowest height of each cell by its contours, metres.
    pub lo: &'a [f32],
    /// Highest height of each cell by its contours, metres.
    pub hi: &'a [f32],
    /// Where water may stay. These heights are never changed.
    pub stays: &'a [bool],
}

impl Ground<'_> {
    /// The cells around a cell.
    pub fn around(&self, cell: usize) -> impl Iterator<Item = usize> {
        neighbours(cell, self.cols, self.rows).flatten().map(|(_, near)| near)
    }

    /// Whether water leaves the grid at a cell with a height: at the border, and beside cells without height.
    pub fn is_outlet(&self, heights: &[f32], cell: usize) -> bool {
        self.around(cell).filter(|&near| heights[near].is_finite()).count() < 8
    }
}

/// A connected part of the grid under water of one level.
pub(crate) struct Pond {
    /// Its cells, from the first one in the order of rows.
    pub cells: Vec<u32>,
    /// The level, metres.
    pub level: f32,
}

/// The parts where `levels` are above the heights, in the order of their first cells.
pub(crate) fn ponds(heights: &[f32], levels: &[f32], ground: &Ground<'_>) -> Vec<Pond> {
    let mut is_seen = vec![false; heights.len()];
    let mut found = Vec::new();
    for first in 0..heights.len() {
        if is_seen[first] || !is_under(heights, levels, first) {
            continue;
        }
        let level = levels[first];
        is_seen[first] = true;
        let mut cells = vec![first as u32];
        let mut next = 0;
        while let Some(&cell) = cells.get(next) {
            next += 1;
            for near in ground.around(cell as usize) {
                if !is_seen[near] && levels[near] == level && is_under(heights, levels, near) {
                    is_seen[near] = true;
                    cells.push(near as u32);
                }
            }
        }
        found.push(Pond { cells, level });
    }
    found
}

/// A comparison with NaN is false, so nothing is under water outside the frame.
fn is_under(heights: &[f32], levels: &[f32], cell: usize) -> bool {
    levels[cell] > heights[cell]
}

impl Pond {
    /// The deepest cell.
    pub fn bottom(&self, heights: &[f32]) -> usize {
        let deepest =
            self.cells.iter().min_by(|&&a, &&b| heights[a as usize].total_cmp(&heights[b as usize]).then(a.cmp(&b)));
        deepest.map_or(0, |&cell| cell as usize)
    }
}
