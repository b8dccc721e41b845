//! Carries differences at a border outwards.
//!
//! The correction c solves ∇²c = c / L² on the cells without heights. At the border it is the difference. The grid's edge
//! lets nothing through. Beside a straight border with one difference, c = difference · exp(−distance / L). Short waves
//! along the border fade faster than long ones. Noise at the border so stays near it, and there are no rays and no seams,
//! which nearest-neighbour and inverse-distance weights make.
//!
//! The equation is solved from coarse grids to fine ones (cascadic multigrid: Bornemann and Deuflhard, Numerische
//! Mathematik 75, 1996). Each grid has half of the columns and rows of the finer one, down to cells of length L. Sweeps on
//! each grid improve what the coarser one gives. Cells are relaxed in two colours like a chessboard. The result does not
//! depend on the number of threads, and the work is proportional to the number of cells.

use glam::DVec2;

use crate::base::parallel;

/// L as a share of the distance at which a twentieth is left: exp(−3) is 0.05.
const LENGTH: f64 = 1.0 / 3.0;
/// Sweeps on each grid. With 24, corrections are within 2 % of the largest difference of those of the solved equation, and
/// with 12 within 4 %. At the border they are exact.
const SWEEPS: usize = 24;

/// What a cell is for the equation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cell {
    /// Its correction is looked for.
    Free,
    /// Its correction is known.
    Fixed,
    /// It has a height and is not at the border.
    Outside,
}

/// One grid.
struct Level {
    cols: usize,
    cells: Vec<Cell>,
    /// The known corrections; 0 elsewhere.
    known: Vec<f32>,
    /// L in cells.
    length: DVec2,
}

/// The correction of every cell without a height; 0 in cells with one that are not at the border. `known` are the
/// differences at the border, by cell; `fade` is the distance, in cells, at which a twentieth of a difference is left.
pub(super) fn carry(heights: &[f32], known: &[(usize, f32)], cols: usize, fade: DVec2) -> Vec<f32> {
    let mut levels = vec![Level::finest(heights, known, cols, fade * LENGTH)];
    while let Some(coarser) = levels.last().and_then(Level::coarser) {
        levels.push(coarser);
    }
    let mut found: Option<(Vec<f32>, usize)> = None;
    for level in levels.iter().rev() {
        let start = match &found {
            Some((coarse, cols)) => level.begun_from(coarse, *cols),
            None => level.known.clone(),
        };
        found = Some((level.relaxed(start), level.cols));
    }
    found.map(|(correction, _)| correction).unwrap_or_default()
}

impl Level {
    fn finest(heights: &[f32], differences: &[(usize, f32)], cols: usize, length: DVec2) -> Self {
        let kind = |height: &f32| if height.is_nan() { Cell::Free } else { Cell::Outside };
        let mut cells: Vec<Cell> = parallel::map_each(heights, kind);
        let mut known = vec![0.0; cells.len()];
        for &(k, difference) in differences {
            cells[k] = Cell::Fixed;
            known[k] = difference;
        }
        Self { cols, cells, known, length }
    }

    fn rows(&self) -> usize {
        self.cells.len() / self.cols.max(1)
    }

    /// The grid with cells of twice the size; `None` where they would be longer than L, or this one has one cell only.
    fn coarser(&self) -> Option<Self> {
        let (cols, rows) = (self.cols.div_ceil(2), self.rows().div_ceil(2));
        let length = self.length / 2.0;
        if length.min_element() < 1.0 || self.cells.len() <= 1 {
            return None;
        }
        let merged = |k: usize| {
            let (mut sum, mut count, mut is_free) = (0.0, 0.0, false);
            for fine in self.parts(k % cols, k / cols) {
                match self.cells[fine] {
                    Cell::Free => is_free = true,
                    Cell::Outside => {}
                    Cell::Fixed => (sum, count) = (sum + self.known[fine], count + 1.0),
                }
            }
            match (count > 0.0, is_free) {
                (true, _) => (Cell::Fixed, sum / count),
                (false, true) => (Cell::Free, 0.0),
                (false, false) => (Cell::Outside, 0.0),
            }
        };
        let (cells, known) = parallel::map(cols * rows, merged).into_iter().unzip();
        Some(Self { cols, cells, known, length })
    }

    /// The cells that a coarser cell consists of.
    fn parts(&self, col: usize, row: usize) -> impl Iterator<Item = usize> {
        let (cols, rows) = (self.cols, self.rows());
        let places = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| (2 * col + i, 2 * row + j));
        places.into_iter().filter(move |&(col, row)| col < cols && row < rows).map(move |(col, row)| row * cols + col)
    }

    /// A start from the corrections on the coarser grid, and the known ones.
    fn begun_from(&self, coarse: &[f32], coarse_cols: usize) -> Vec<f32> {
        let start = |k: usize| match self.cells[k] {
            Cell::Free => coarse[(k / self.cols / 2) * coarse_cols + (k % self.cols) / 2],
            _ => self.known[k],
        };
        parallel::values(self.cells.len(), start)
    }

    /// The corrections after the sweeps.
    fn relaxed(&self, start: Vec<f32>) -> Vec<f32> {
        if self.cells.is_empty() {
            return start;
        }
        // Each colour is read while the other one is written.
        let mut colours = [start.clone(), start];
        for _ in 0..SWEEPS {
            for colour in [0, 1] {
                let [first, second] = &mut colours;
                let (written, read) = if colour == 0 { (first, &*second) } else { (second, &*first) };
                parallel::chunks(written, self.cols, |row, values| {
                    for (col, value) in values.iter_mut().enumerate().skip((row + colour) % 2).step_by(2) {
                        *value = self.balanced(read, col, row).unwrap_or(*value);
                    }
                });
            }
        }
        let [first, second] = colours;
        let pick = |k: usize| if (k % self.cols + k / self.cols).is_multiple_of(2) { first[k] } else { second[k] };
        parallel::values(self.cells.len(), pick)
    }

    /// The correction of a free cell that fits the cells beside it.
    fn balanced(&self, values: &[f32], col: usize, row: usize) -> Option<f32> {
        let k = row * self.cols + col;
        if self.cells[k] != Cell::Free {
            return None;
        }
        let along = self.length * self.length;
        let sides = [
            (col > 0).then(|| (k - 1, along.x)),
            (col + 1 < self.cols).then(|| (k + 1, along.x)),
            (row > 0).then(|| (k - self.cols, along.y)),
            (k + self.cols < self.cells.len()).then(|| (k + self.cols, along.y)),
        ];
        let open = sides.into_iter().flatten().filter(|(n, _)| self.cells[*n] != Cell::Outside);
        let (sum, weight) =
            open.fold((0.0, 1.0), |(sum, weight), (n, share)| (sum + share * f64::from(values[n]), weight + share));
        Some((sum / weight) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights on the left third of a grid, none elsewhere.
    fn half_plane(cols: usize, rows: usize, edge: usize) -> Vec<f32> {
        (0..cols * rows).map(|k| if k % cols < edge { 100.0 } else { f32::NAN }).collect()
    }

    #[test]
    fn beside_a_straight_border_a_twentieth_is_left_at_the_distance() {
        let (cols, rows, edge, fade) = (240, 40, 20, 90.0);
        let known: Vec<(usize, f32)> = (0..rows).map(|row| (row * cols + edge - 1, 8.0)).collect();
        let found = carry(&half_plane(cols, rows, edge), &known, cols, DVec2::splat(fade));
        for row in [0, 17, rows - 1] {
            for distance in [0_usize, 1, 5, 30, 60, 90, 150] {
                let expected = 8.0 * (-3.0 * distance as f64 / fade).exp();
                let value = f64::from(found[row * cols + edge - 1 + distance]);
                assert!((value - expected).abs() < 0.1, "{distance}: {value} is not {expected}");
            }
        }
    }

    #[test]
    fn few_sweeps_on_every_grid_do_what_many_do_on_one() {
        // A disc of heights with waves of several lengths along its border.
        let (cols, rows) = (150, 110);
        let from_centre = |k: usize| DVec2::new((k % cols) as f64 - 70.3, (k / cols) as f64 - 52.1);
        let heights: Vec<f32> =
            (0..cols * rows).map(|k| if from_centre(k).length() < 25.0 { 0.0 } else { f32::NAN }).collect();
        let is_border = |k: usize| [k - 1, k + 1, k - cols, k + cols].iter().any(|n| heights[*n].is_nan());
        let wave = |p: DVec2| (5.0 + 3.0 * (3.0 * p.to_angle()).sin() + (11.0 * p.to_angle()).sin()) as f32;
        let known: Vec<(usize, f32)> = (0..heights.len())
            .filter(|&k| !heights[k].is_nan() && is_border(k))
            .map(|k| (k, wave(from_centre(k))))
            .collect();
        let fade = DVec2::new(60.0, 80.0);
        let found = carry(&heights, &known, cols, fade);
        let level = Level::finest(&heights, &known, cols, fade * LENGTH);
        let solved = (0..100).fold(found.clone(), |values, _| level.relaxed(values));
        let worst = found.iter().zip(&solved).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // The largest difference is about 9.
        assert!(worst < 0.25, "{worst}");
    }

    #[test]
    fn nothing_is_carried_where_nothing_is_known() {
        assert_eq!(carry(&half_plane(9, 5, 3), &[], 9, DVec2::splat(20.0)), [0.0; 45]);
        assert!(carry(&[], &[], 0, DVec2::splat(20.0)).is_empty());
        assert_eq!(carry(&[f32::NAN], &[], 1, DVec2::splat(20.0)), [0.0]);
    }
}
