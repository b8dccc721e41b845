//! All triangles between the centres of the cells of a height map.

use super::outline::middle;
use crate::base::{Grid, parallel};
use crate::raster::Dem;
use crate::tin::{NONE, Tin};

/// The triangulation of the squares between four neighbouring cells with heights: two triangles for each. The common edge runs
/// between the two opposite corners whose heights differ less, so it follows ridges and valleys.
pub(super) fn of_cells(dem: &Dem) -> Tin {
    let Grid { cols, rows, .. } = dem.grid;
    let origin = middle(dem);
    let squares = Squares::of(dem);
    let mut vertices = vec![NONE; dem.values.len()];
    let mut tin = Tin { origin, ..Tin::default() };
    for row in 0..rows.saturating_sub(1) {
        for col in 0..cols - 1 {
            if squares.number(Some(col), Some(row)) == NONE {
                continue;
            }
            let [north, south] = [row, row + 1].map(|row| row * cols + col);
            let mut vertex = |cell: usize| {
                if vertices[cell] == NONE {
                    vertices[cell] = tin.positions.len() as u32;
                    tin.positions.push(dem.grid.center(cell % cols, cell / cols) - origin);
                    tin.heights.push(f64::from(dem.values[cell]));
                }
                vertices[cell]
            };
            let [nw, sw, se, ne] = [north, south, south + 1, north + 1].map(&mut vertex);
            let [west, second] = [0, 1].map(|k| 2 * squares.number(Some(col), Some(row)) + k);
            let beyond_west = squares.triangle(col.checked_sub(1), Some(row), |_| 1);
            let beyond_east = squares.triangle(Some(col + 1), Some(row), |_| 0);
            // The triangles of other squares at their southern and northern sides.
            let beyond_south = squares.triangle(Some(col), Some(row + 1), u32::from);
            let beyond_north = squares.triangle(Some(col), row.checked_sub(1), |falls| u32::from(!falls));
            if squares.falls(col, row) {
                tin.triangles.extend([[nw, sw, se], [nw, se, ne]]);
                tin.neighbours.extend([[beyond_west, beyond_south, second], [west, beyond_east, beyond_north]]);
            } else {
                tin.triangles.extend([[nw, sw, ne], [sw, se, ne]]);
                tin.neighbours.extend([[beyond_west, second, beyond_north], [beyond_south, beyond_east, west]]);
            }
        }
    }
    tin.inside = vec![true; tin.triangles.len()];
    tin.edges = vec![0; tin.triangles.len()];
    tin
}

/// The squares between four cells.
struct Squares<'a> {
    dem: &'a Dem,
    /// Those with heights are numbered, row by row; the others have [`NONE`].
    numbers: Vec<u32>,
}

impl<'a> Squares<'a> {
    fn of(dem: &'a Dem) -> Self {
        let [cols, rows] = [dem.grid.cols, dem.grid.rows].map(|cells| cells.saturating_sub(1));
        let has_heights = |col: usize, row: usize| {
            let first = row * dem.grid.cols + col;
            let corners = [first, first + 1, first + dem.grid.cols, first + dem.grid.cols + 1];
            if corners.iter().all(|&cell| dem.values[cell].is_finite()) { 0 } else { NONE }
        };
        let mut numbers = parallel::cells(cols, rows, has_heights);
        let known = numbers.iter_mut().filter(|number| **number != NONE);
        (0..).zip(known).for_each(|(number, square)| *square = number);
        Self { dem, numbers }
    }

    /// The number of a square. Beyond the height map there is none.
    fn number(&self, col: Option<usize>, row: Option<usize>) -> u32 {
        let cols = self.dem.grid.cols - 1;
        let square = col.filter(|col| *col < cols).zip(row).map(|(col, row)| row * cols + col);
        square.and_then(|square| self.numbers.get(square)).copied().unwrap_or(NONE)
    }

    /// One of the two triangles of a square: the first has its western side, the second its eastern one. Which one it is may depend
    /// on whether the common edge falls to the east.
    fn triangle(&self, col: Option<usize>, row: Option<usize>, which: impl Fn(bool) -> u32) -> u32 {
        match (self.number(col, row), col, row) {
            (number, Some(col), Some(row)) if number != NONE => 2 * number + which(self.falls(col, row)),
            _ => NONE,
        }
    }

    /// Whether the common edge of the two triangles runs from north-west to south-east.
    fn falls(&self, col: usize, row: usize) -> bool {
        let height = |col: usize, row: usize| self.dem.values[row * self.dem.grid.cols + col];
        let falling = (height(col, row) - height(col + 1, row + 1)).abs();
        falling <= (height(col + 1, row) - height(col, row + 1)).abs()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::dem::derive::square_outlines;

    #[test]
    fn neighbours_know_each_other_and_the_area_is_that_of_the_outlines() {
        let grid = Grid { corner: DVec2::new(500_000.0, 4_000_000.0), cell: DVec2::new(5.0, 8.0), cols: 17, rows: 13 };
        let height = |k: usize| if k % 23 == 5 || k == 0 { f32::NAN } else { ((k * k) % 31) as f32 };
        let dem = Dem { grid, values: (0..grid.len()).map(height).collect(), crs: None };
        let tin = of_cells(&dem);
        let mut doubled = 0.0;
        for t in 0..tin.len() as u32 {
            let [a, b, c] = tin.corners(t);
            doubled += (b - a).perp_dot(c - a);
            for i in 0..3 {
                let [u, v] = tin.edge(t, i);
                if let Some(n) = tin.inner_neighbour(t, i) {
                    let j = tin.edge_towards(n, t).expect("it knows its neighbour");
                    assert_eq!(tin.edge(n, j), [v, u]);
                }
            }
        }
        let cross = |w: &[DVec2]| (w[0] - grid.corner).perp_dot(w[1] - grid.corner);
        let outlines: f64 = square_outlines(&dem).iter().flatten().flat_map(|ring| ring.windows(2).map(cross)).sum();
        assert!((doubled - outlines).abs() < 1e-3 && doubled > 0.0, "{doubled} {outlines}");
    }
}
