//! Outlines of sets of cells: polygons along cell edges.
//!
//! Each cell has the number of its set, or is [`OUTSIDE`] of all.
//!
//! Cells that meet only at a corner belong to different polygons. So every polygon is simple, as the vector formats
//! require: its rings do not cross or touch themselves, and its interior is connected.

use std::collections::HashMap;

use glam::DVec2;

use crate::base::{Grid, parallel};
use crate::raster::{Dem, GroundScale};

/// The set of a cell that belongs to none.
pub(super) const OUTSIDE: u32 = u32::MAX;

/// A corner of cells: columns from the west edge, rows from the north edge.
pub(super) type Corner = (u32, u32);

/// Cells that are joined along edges, and their outline.
pub(super) struct Part {
    /// One of its cells.
    pub cell: usize,
    /// Number of its cells.
    pub cells: usize,
    /// The outer ring, counter-clockwise with north up, then the holes, clockwise. Each ring ends where it begins. It
    /// has only the corners where it turns.
    pub rings: Vec<Vec<Corner>>,
}

/// The number of the piece that each cell belongs to, and the number of pieces. A piece is neighbours of one set. Pieces are
/// numbered from 0 in the order of their first cells. Cells outside of all sets have no piece: [`OUTSIDE`].
///
/// `joined` says which cells are neighbours.
pub(super) fn pieces(cols: usize, sets: &[u32], joined: Joined) -> (Vec<u32>, usize) {
    let rows = sets.len() / cols.max(1);
    let mut labels = vec![OUTSIDE; sets.len()];
    let (mut count, mut open) = (0, Vec::new());
    for start in 0..sets.len() {
        let set = sets[start];
        if set == OUTSIDE || labels[start] != OUTSIDE {
            continue;
        }
        labels[start] = count;
        open.push(start);
        while let Some(cell) = open.pop() {
            let (col, row) = (cell % cols, cell / cols);
            for near_row in row.saturating_sub(1)..(row + 2).min(rows) {
                for near_col in col.saturating_sub(1)..(col + 2).min(cols) {
                    let near = near_row * cols + near_col;
                    let shares_edge = near_row == row || near_col == col;
                    if sets[near] == set && labels[near] == OUTSIDE && (shares_edge || joined == Joined::AtCorners) {
                        labels[near] = count;
                        open.push(near);
                    }
                }
            }
        }
        count += 1;
    }
    (labels, count as usize)
}

/// What makes cells neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Joined {
    /// A common edge.
    AlongEdges,
    /// A common edge or corner.
    AtCorners,
}

/// The outlines of the pieces of sets that are joined along edges.
pub(super) fn outlines(cols: usize, sets: &[u32]) -> Vec<Part> {
    let (labels, count) = pieces(cols, sets, Joined::AlongEdges);
    let mut parts: Vec<Part> = (0..count).map(|_| Part { cell: 0, cells: 0, rings: Vec::new() }).collect();
    for (cell, &label) in labels.iter().enumerate().rev() {
        if let Some(part) = parts.get_mut(label as usize) {
            part.cell = cell;
            part.cells += 1;
        }
    }
    // Every ring has an edge on the north side of a cell. So the search starts at these edges.
    let mut seen = vec![false; sets.len()];
    for cell in 0..sets.len() {
        let is_north_edge = sets[cell] != OUTSIDE && (cell < cols || sets[cell - cols] != sets[cell]);
        if is_north_edge && !seen[cell] {
            let ring = trace(cols, sets, cell, &mut seen);
            let part = &mut parts[labels[cell] as usize];
            for ring in split(ring) {
                // The outer ring is the counter-clockwise one.
                if turns_left(&ring) { part.rings.insert(0, ring) } else { part.rings.push(ring) }
            }
        }
    }
    parts
}

/// The ring that runs along the north edge of a cell, with the cell's set on its left. It has only the corners where it turns,
/// and is not closed.
///
/// At some corners only two diagonally opposite cells are inside. There, the ring stays with the cell that it follows.
fn trace(cols: usize, sets: &[u32], start: usize, seen: &mut [bool]) -> Vec<Corner> {
    let rows = sets.len() / cols;
    let is_inside = |col: i64, row: i64| {
        let within = col >= 0 && row >= 0 && (col as usize) < cols && (row as usize) < rows;
        within && sets[row as usize * cols + col as usize] == sets[start]
    };
    let (first_col, first_row) = ((start % cols) as i64, (start / cols) as i64);
    // West along the north edge of the first cell; y counts southwards.
    let (mut at, mut step) = ((first_col + 1, first_row), (-1_i64, 0_i64));
    let first = (at, step);
    let mut ring = Vec::new();
    loop {
        if step == (-1, 0) {
            // The cell south of the current edge.
            seen[at.1 as usize * cols + (at.0 - 1) as usize] = true;
        }
        at = (at.0 + step.0, at.1 + step.1);
        let left = (step.1, -step.0);
        // The cells ahead, on the left and on the right.
        let ahead = |side: (i64, i64)| {
            let towards = (step.0 + side.0, step.1 + side.1);
            is_inside(at.0 + (towards.0 - 1) / 2, at.1 + (towards.1 - 1) / 2)
        };
        let right = (-left.0, -left.1);
        let turn = if !ahead(left) {
            left
        } else if !ahead(right) {
            step
        } else {
            right
        };
        if turn != step {
            ring.push((at.0 as u32, at.1 as u32));
        }
        step = turn;
        if (at, step) == first {
            return ring;
        }
    }
}

/// Divides a ring where it touches itself. Each part passes a corner once and is closed.
fn split(ring: Vec<Corner>) -> Vec<Vec<Corner>> {
    let (mut rings, mut path): (Vec<Vec<Corner>>, Vec<Corner>) = (Vec::new(), Vec::new());
    let mut place: HashMap<Corner, usize> = HashMap::new();
    for corner in ring {
        if let Some(&from) = place.get(&corner) {
            let mut piece: Vec<Corner> = path.drain(from..).collect();
            piece.iter().for_each(|passed| {
                place.remove(passed);
            });
            piece.push(corner);
            rings.push(piece);
        }
        place.insert(corner, path.len());
        path.push(corner);
    }
    if let Some(&corner) = path.first() {
        path.push(corner);
        rings.push(path);
    }
    rings
}

/// Whether a closed ring is counter-clockwise on a map with north up. Its rows count southwards.
fn turns_left(ring: &[Corner]) -> bool {
    let cross = |w: &[Corner]| i128::from(w[0].0) * i128::from(w[1].1) - i128::from(w[1].0) * i128::from(w[0].1);
    ring.windows(2).map(cross).sum::<i128>() < 0
}

/// The outlines of the squares between four cell centres with heights: for each polygon the outer ring, then the holes, in map
/// units. Polygons meet at corners only.
pub fn square_outlines(dem: &Dem) -> Vec<Vec<Vec<DVec2>>> {
    let Grid { cols, rows, cell, .. } = dem.grid;
    let grid = Grid { corner: dem.grid.center(0, 0), cell, cols: cols.saturating_sub(1), rows: rows.saturating_sub(1) };
    let sets = parallel::values(grid.len(), |square| {
        let first = square / grid.cols * cols + square % grid.cols;
        let has_heights =
            [first, first + 1, first + cols, first + cols + 1].iter().all(|&cell| !dem.values[cell].is_nan());
        if has_heights { 0 } else { OUTSIDE }
    });
    outlines(grid.cols, &sets).iter().map(|part| on_map(&part.rings, &grid)).collect()
}

/// Rings on the map.
pub(super) fn on_map(rings: &[Vec<Corner>], grid: &Grid) -> Vec<Vec<DVec2>> {
    let place = |&(col, row): &Corner| grid.corner + DVec2::new(f64::from(col), -f64::from(row)) * grid.cell;
    rings.iter().map(|ring| ring.iter().map(place).collect()).collect()
}

/// Area within the rings, square metres. The scale of each row gives the size of its cells.
pub(super) fn area(rings: &[Vec<Corner>], grid: &Grid, scale: &GroundScale) -> f64 {
    let cell = grid.cell;
    if let GroundScale::Uniform(scale) = scale {
        let cross = |w: &[Corner]| {
            let [a, b] = [w[0], w[1]].map(|p| (f64::from(p.0), f64::from(p.1)));
            b.0 * a.1 - a.0 * b.1
        };
        let cells: f64 = rings.iter().flat_map(|ring| ring.windows(2).map(cross)).sum::<f64>() / 2.0;
        return cells * (cell * *scale).element_product();
    }
    // An edge that runs south has the area on its east side, one that runs north on its west side.
    let column_to = |w: &[Corner]| {
        let (top, bottom, sign) = if w[0].1 < w[1].1 { (w[0].1, w[1].1, -1.0) } else { (w[1].1, w[0].1, 1.0) };
        let height = |row: u32| (cell * scale.row(row as usize)).element_product();
        sign * f64::from(w[0].0) * (top..bottom).map(height).sum::<f64>()
    };
    rings.iter().flat_map(|ring| ring.windows(2).filter(|w| w[0].0 == w[1].0).map(column_to)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(text: &[&str]) -> (usize, Vec<u32>) {
        let number = |b: u8| if b == b'.' { OUTSIDE } else { u32::from(b) };
        (text[0].len(), text.iter().flat_map(|row| row.bytes().map(number)).collect())
    }

    /// Twice the area of the rings, without the holes.
    fn doubled_area(part: &Part) -> i64 {
        let cross = |w: &[Corner]| i64::from(w[1].0) * i64::from(w[0].1) - i64::from(w[0].0) * i64::from(w[1].1);
        part.rings.iter().flat_map(|ring| ring.windows(2).map(cross)).sum()
    }

    fn check(cols: usize, inside: &[u32]) -> Vec<Part> {
        let parts = outlines(cols, inside);
        for part in &parts {
            assert_eq!(doubled_area(part), 2 * part.cells as i64);
            assert!(turns_left(&part.rings[0]) && part.rings[1..].iter().all(|ring| !turns_left(ring)));
            for ring in &part.rings {
                assert_eq!(ring.first(), ring.last());
                let mut corners = ring[1..].to_vec();
                corners.sort_unstable();
                corners.dedup();
                assert_eq!(corners.len(), ring.len() - 1, "a ring touches itself: {ring:?}");
                for w in ring.windows(2) {
                    assert!((w[0].0 == w[1].0) != (w[0].1 == w[1].1), "{ring:?}");
                }
            }
        }
        assert_eq!(
            parts.iter().map(|part| part.cells).sum::<usize>(),
            inside.iter().filter(|set| **set != OUTSIDE).count()
        );
        parts
    }

    #[test]
    fn a_cell_is_a_square_that_turns_left() {
        let (cols, inside) = set(&["...", ".#.", "..."]);
        let parts = check(cols, &inside);
        assert_eq!(parts[0].rings, [vec![(1, 1), (1, 2), (2, 2), (2, 1), (1, 1)]]);
    }

    #[test]
    fn corners_part_and_holes_are_rings() {
        let (cols, inside) = set(&["##..", "##..", "..##", "..##"]);
        assert_eq!(check(cols, &inside).len(), 2);
        let (cols, inside) = set(&["#####", "#.#.#", "#####"]);
        assert_eq!(check(cols, &inside)[0].rings.len(), 3);
        // Two holes that meet at a corner, and a hole that meets the outside at one.
        let (cols, inside) = set(&["####", "#.##", "##.#", "####"]);
        assert_eq!(check(cols, &inside)[0].rings.len(), 3);
        let (cols, inside) = set(&["####", "#.##", "##.#", "#.##"]);
        let parts = check(cols, &inside);
        assert_eq!(parts.len(), 1);
    }

    #[test]
    fn sets_side_by_side_have_outlines_of_their_own() {
        let (cols, sets) = set(&["aab", "cab", "caa"]);
        let parts = check(cols, &sets);
        assert_eq!(parts.iter().map(|part| part.cells).collect::<Vec<_>>(), [5, 2, 2]);
        assert_eq!(parts[1].rings, [vec![(2, 0), (2, 2), (3, 2), (3, 0), (2, 0)]]);
    }

    #[test]
    fn neighbours_at_corners_are_one_piece_if_asked() {
        let (cols, inside) = set(&["#.#", ".#.", "#.."]);
        assert_eq!(pieces(cols, &inside, Joined::AtCorners).1, 1);
        assert_eq!(pieces(cols, &inside, Joined::AlongEdges).1, 4);
    }

    #[test]
    fn random_sets_have_sound_outlines() {
        let mut state = 7_u64;
        for share in [2, 3, 5, 7, 8] {
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let number = (state >> 33) % 10;
                if number < share { (number % 3) as u32 } else { OUTSIDE }
            };
            let sets: Vec<u32> = (0..40 * 30).map(|_| next()).collect();
            check(40, &sets);
            // One set instead of three.
            check(40, &sets.iter().map(|set| if *set == OUTSIDE { OUTSIDE } else { 0 }).collect::<Vec<_>>());
        }
    }
}
