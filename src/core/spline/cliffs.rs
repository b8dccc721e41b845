//! Cliffs: lines across which the surface may jump.
//!
//! Bending and tension do not act across them, and a contour does not act across them either. Beside a cliff, the reference
//! surface slopes from its top to its foot, and bands reach from the contours above it to those below. So neither tells
//! anything there: the surface goes on as it comes from the contours on its own side.

use glam::DVec2;

use super::lattice::Lattice;
use crate::base::{Grid, parallel};

/// Heights are interpolated from as many nodes on either side.
const INTERPOLATED: usize = 3;

/// Whether each node of a grid is at most `reach` (map units) away from a cliff; empty without cliffs.
pub(crate) fn beside(cliffs: &[Vec<DVec2>], grid: &Grid, reach: f64) -> Vec<bool> {
    let nodes = (reach / (grid.cell.x * grid.cell.y).sqrt()).round() as usize;
    Walls::new(cliffs, &Lattice::of_grid(grid)).map_or(Vec::new(), |walls| walls.beside(nodes))
}

/// The edges of a lattice that cliffs cross.
pub struct Walls {
    east: Vec<bool>,
    south: Vec<bool>,
    cols: usize,
}

impl Walls {
    /// Finds the edges. `None` if there are no cliffs.
    pub fn new(cliffs: &[Vec<DVec2>], lattice: &Lattice) -> Option<Self> {
        if cliffs.is_empty() {
            return None;
        }
        let (mut east, mut south) = (vec![false; lattice.len()], vec![false; lattice.len()]);
        for line in cliffs {
            lattice.cross(line, |c| east[c.node as usize] = true, |c| south[c.node as usize] = true);
        }
        Some(Self { east, south, cols: lattice.cols })
    }

    /// Whether a cliff lies between a node and its eastern (side 0) or southern (side 1) neighbour.
    pub fn is_between(&self, side: usize, n: usize) -> bool {
        if side == 0 { self.east[n] } else { self.south[n] }
    }

    /// Whether a cliff lies among the nodes of a second difference: eastwards (kind 0), southwards (1) or mixed (2).
    pub fn is_among(&self, kind: usize, n: usize) -> bool {
        let Self { east, south, cols } = self;
        match kind {
            0 => east[n - 1] || east[n],
            1 => south[n - cols] || south[n],
            _ => east[n] || south[n] || south[n + 1] || east[n + cols],
        }
    }

    /// Replaces heights that were interpolated from every second row and column, across cliffs or near them, by means of
    /// those heights on the same side.
    pub fn mend(&self, z: &mut [f64]) {
        let cols = self.cols;
        let (east, south) = (|n: usize| !self.east[n], |n: usize| !self.south[n]);
        let beside = self.beside(INTERPOLATED);
        let of_others = |n: usize| -> Option<f64> {
            let (i, j) = (n % cols, n / cols);
            let (has_east, has_south) = (i + 1 < cols, n + cols < self.east.len());
            let mut reached = Vec::with_capacity(4);
            match (i % 2 == 0, j % 2 == 0) {
                (true, true) => return None,
                (false, true) => {
                    reached.extend(east(n - 1).then(|| n - 1));
                    reached.extend((has_east && east(n)).then(|| n + 1));
                }
                (true, false) => {
                    reached.extend(south(n - cols).then(|| n - cols));
                    reached.extend((has_south && south(n)).then(|| n + cols));
                }
                (false, false) => {
                    // To each corner there are two ways.
                    let west = |n: usize| east(n - 1);
                    let north = |n: usize| south(n - cols);
                    reached.extend(((west(n) && north(n - 1)) || (north(n) && west(n - cols))).then(|| n - cols - 1));
                    if has_east {
                        let way = (east(n) && north(n + 1)) || (north(n) && east(n - cols));
                        reached.extend(way.then(|| n - cols + 1));
                    }
                    if has_south {
                        let way = (west(n) && south(n - 1)) || (south(n) && west(n + cols));
                        reached.extend(way.then(|| n + cols - 1));
                    }
                    if has_east && has_south {
                        let way = (east(n) && south(n + 1)) || (south(n) && east(n + cols));
                        reached.extend(way.then(|| n + cols + 1));
                    }
                }
            }
            let sum: f64 = reached.iter().map(|&m| z[m]).sum();
            (!reached.is_empty()).then(|| sum / reached.len() as f64)
        };
        let height = |n: usize| if beside[n] { Some((n, of_others(n)?)) } else { None };
        let mended: Vec<(usize, f64)> = parallel::flat_map(z.len(), height);
        mended.into_iter().for_each(|(n, height)| z[n] = height);
    }

    /// The nodes that are at most `reach` nodes away from a cliff, along rows and columns.
    pub fn beside(&self, reach: usize) -> Vec<bool> {
        let (cols, count) = (self.cols, self.east.len());
        let at = |n: usize| {
            let before = |walls: &[bool], by: usize| n.checked_sub(by).is_some_and(|m| walls[m]);
            self.east[n] || self.south[n] || before(&self.east, 1) || before(&self.south, cols)
        };
        let near: Vec<bool> = parallel::values(count, at);
        let spread = |near: &[bool], step: usize, place: &(dyn Fn(usize) -> (usize, usize) + Sync)| -> Vec<bool> {
            let value = |n: usize| {
                let (k, last) = place(n);
                (k.saturating_sub(reach)..=(k + reach).min(last)).any(|m| near[n + m * step - k * step])
            };
            parallel::values(count, value)
        };
        let rows = count / cols;
        let along_rows = spread(&near, 1, &|n| (n % cols, cols - 1));
        spread(&along_rows, cols, &|n| (n / cols, rows - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_near_a_cliff_come_from_their_own_side() {
        let lattice = Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols: 9, rows: 5 };
        let cliff = vec![DVec2::new(4.5, 1.0), DVec2::new(4.5, -9.0)];
        let walls = Walls::new(&[cliff], &lattice).unwrap();
        // Only the heights in every second row and column are right.
        let is_known = |n: usize| (n % 9).is_multiple_of(2) && (n / 9).is_multiple_of(2);
        let truth = |n: usize| if n % 9 < 5 { 100.0 } else { 20.0 };
        let mut z: Vec<f64> = (0..45).map(|n| if is_known(n) { truth(n) } else { 60.0 }).collect();
        walls.mend(&mut z);
        assert!((0..45).all(|n| n % 9 == 0 || z[n] == truth(n)), "{z:?}");
    }

    #[test]
    fn edges_and_nodes_beside_a_cliff_are_found() {
        let lattice = Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols: 9, rows: 5 };
        // From north to south between the columns 4 and 5.
        let cliff = vec![DVec2::new(4.5, 1.0), DVec2::new(4.5, -9.0)];
        assert!(Walls::new(&[], &lattice).is_none());
        let walls = Walls::new(&[cliff], &lattice).unwrap();
        let between: Vec<usize> = (0..45).filter(|&n| walls.is_between(0, n)).collect();
        assert_eq!(between, [4, 13, 22, 31, 40]);
        assert!((0..45).all(|n| !walls.is_between(1, n)));
        assert!(walls.is_among(0, 13) && walls.is_among(0, 14) && !walls.is_among(0, 15));
        assert!(walls.is_among(2, 13) && !walls.is_among(2, 14) && !walls.is_among(1, 13));
        let beside = walls.beside(1);
        let of_row: Vec<usize> = (9..18).filter(|&n| beside[n]).map(|n| n - 9).collect();
        assert_eq!(of_row, [3, 4, 5, 6]);
    }
}
