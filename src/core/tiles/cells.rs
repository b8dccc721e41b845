//! A grid of square cells that finds what lies near a place.
//!
//! What a cell holds stands in one list for all cells, in the order of the cells: maps have some million vertices, and a list
//! for each cell would take several times the memory.

use std::collections::HashMap;

use glam::DVec2;

use crate::geometry::Bounds;

/// Cells per item, at most. More would be empty.
const MOST_CELLS: f64 = 4.0;

/// Items by the cells that their boxes meet.
pub(super) struct Cells {
    low: DVec2,
    size: f64,
    cols: usize,
    rows: usize,
    /// Where the items of each cell begin, and the end of the last.
    first: Vec<u32>,
    items: Vec<u32>,
    /// Items that came later, by their cell.
    later: HashMap<usize, Vec<u32>>,
}

impl Cells {
    /// Items 0 to `count` − 1 by their boxes; none for items that are left out. Cells are about `size` wide.
    pub fn new(count: usize, size: f64, bounds: impl Fn(usize) -> Option<Bounds>) -> Self {
        let all = (0..count).filter_map(&bounds).reduce(Bounds::union);
        let (low, high) = all.map_or((DVec2::ZERO, DVec2::ZERO), |all| (all.min, all.max));
        let span = high - low;
        let most = MOST_CELLS * count as f64 + 1.0;
        let size = size.max((span.x * span.y / most).sqrt()).max(span.max_element() / most).max(f64::MIN_POSITIVE);
        let cells = |length: f64| (length / size) as usize + 1;
        let (cols, rows) = (cells(span.x), cells(span.y));
        let mut grid =
            Self { low, size, cols, rows, first: vec![0; cols * rows + 1], items: Vec::new(), later: HashMap::new() };
        for item in (0..count).filter_map(&bounds) {
            grid.cells(item).for_each(|cell| grid.first[cell + 1] += 1);
        }
        for cell in 0..cols * rows {
            grid.first[cell + 1] += grid.first[cell];
        }
        grid.items = vec![0; grid.first[cols * rows] as usize];
        let mut free = grid.first.clone();
        for (i, item) in (0..count).filter_map(|i| Some((i, bounds(i)?))) {
            for cell in grid.cells(item) {
                grid.items[free[cell] as usize] = i as u32;
                free[cell] += 1;
            }
        }
        grid
    }

    /// Adds the cells of a box to an item.
    pub fn add(&mut self, item: u32, bounds: Bounds) {
        for cell in self.cells(bounds) {
            self.later.entry(cell).or_default().push(item);
        }
    }

    /// Whether `is_found` holds for an item in the cells of a box. An item may be asked for several times.
    pub fn any(&self, bounds: Bounds, mut is_found: impl FnMut(u32) -> bool) -> bool {
        self.cells(bounds).any(|cell| {
            let own = &self.items[self.first[cell] as usize..self.first[cell + 1] as usize];
            let later =
                if self.later.is_empty() { &[][..] } else { self.later.get(&cell).map_or(&[][..], Vec::as_slice) };
            own.iter().chain(later).any(|item| is_found(*item))
        })
    }

    /// The cells that a box meets. Beyond the edge of the grid, they are those at the edge.
    fn cells(&self, bounds: Bounds) -> impl Iterator<Item = usize> + use<> {
        let [low, high] = [bounds.min, bounds.max].map(|p| (p - self.low) / self.size);
        let (cols, most) = (self.cols, (self.cols - 1, self.rows - 1));
        let (left, right) = ((low.x.max(0.0) as usize).min(most.0), (high.x.max(0.0) as usize).min(most.0));
        let (top, bottom) = ((low.y.max(0.0) as usize).min(most.1), (high.y.max(0.0) as usize).min(most.1));
        (top..=bottom).flat_map(move |row| (left..=right).map(move |col| row * cols + col))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_meets_a_box_is_found() {
        let at = |k: usize| DVec2::new((k * 37 % 101) as f64, (k * 53 % 89) as f64);
        let own = |k: usize| Bounds { min: at(k), max: at(k) + 3.0 };
        let mut cells = Cells::new(200, 5.0, |k| (k != 7).then(|| own(k)));
        let far = Bounds { min: DVec2::splat(-50.0), max: DVec2::splat(-40.0) };
        cells.add(7, far);
        for (k, side) in (0..60).map(|k| (k, (k % 9) as f64)) {
            let asked = Bounds { min: at(k) - 20.0, max: at(k) - 20.0 + side };
            let mut found = Vec::new();
            cells.any(asked, |item| {
                found.push(item as usize);
                false
            });
            for item in (0..200).filter(|item| *item != 7 && own(*item).meets(&asked)) {
                assert!(found.contains(&item), "{item} meets {k}");
            }
        }
        assert!(cells.any(far, |item| item == 7));
        assert!(!Cells::new(0, 1.0, |_| None).any(far, |_| true));
    }
}
