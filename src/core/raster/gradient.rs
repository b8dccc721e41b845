//! The gradient of heights over 3 x 3 cells, that of Horn (1981).

use glam::DVec2;

/// Calls `each` with the column, the gradient (metres per metre, east and north), and whether all eight neighbours have a
/// height, for every cell of a row that has a height.
///
/// `lines` are the heights of the row above, of the row itself, and of the row below. `cell` is the size of a cell, metres.
/// Where neighbours have no height, heights are extrapolated linearly.
pub(crate) fn gradients(lines: [Option<&[f32]>; 3], cell: DVec2, mut each: impl FnMut(usize, DVec2, bool)) {
    let [above, Some(line), below] = lines else { return };
    let step = cell * 8.0;
    let by_some = |col: usize| rise_by_some(lines, col);
    let mut tell = |col: usize, rise: Option<DVec2>, is_whole: bool| {
        if let Some(rise) = rise {
            each(col, rise / step, is_whole);
        }
    };
    let (Some(above), Some(below)) = (above, below) else {
        (0..line.len()).for_each(|col| tell(col, by_some(col), false));
        return;
    };
    tell(0, by_some(0), false);
    let cells = above.windows(3).zip(line.windows(3)).zip(below.windows(3));
    for (col, ((above, line), below)) in (1..).zip(cells) {
        match rise_by_all([above, line, below]) {
            Some(rise) => tell(col, Some(rise), true),
            None => tell(col, by_some(col), false),
        }
    }
    let last = line.len().saturating_sub(1);
    if last > 0 {
        tell(last, by_some(last), false);
    }
}

/// The gradient of one cell, as by [`gradients`]. `None` if it has no height.
pub(crate) fn gradient_at(lines: [Option<&[f32]>; 3], cell: DVec2, col: usize) -> Option<DVec2> {
    Some(rise_by_some(lines, col)? / (cell * 8.0))
}

/// Eight times the rise per cell, if all nine cells have heights.
fn rise_by_all(near: [&[f32]; 3]) -> Option<DVec2> {
    let at = |row: usize, col: usize| f64::from(near[row][col]);
    let (east, north) = (at(1, 2) - at(1, 0), at(0, 1) - at(2, 1));
    let (north_east, south_east) = (at(0, 2) - at(2, 0), at(2, 2) - at(0, 0));
    let rise = DVec2::new(2.0 * east + north_east + south_east, 2.0 * north + north_east - south_east);
    // A sum of single precision numbers is finite in double precision if all of them are.
    (rise.x + rise.y + at(1, 1)).is_finite().then_some(rise)
}

/// Eight times the rise per cell, if the cell has a height. Missing neighbours are extrapolated.
fn rise_by_some(lines: [Option<&[f32]>; 3], col: usize) -> Option<DVec2> {
    let height = |down: isize, right: isize| -> Option<f64> {
        let line = lines[(down + 1) as usize]?;
        let height = line.get(col.checked_add_signed(right)?)?;
        Some(f64::from(*height)).filter(|height| height.is_finite())
    };
    let center = height(0, 0)?;
    let neighbour = |right: isize, down: isize| height(down, right);
    // A missing neighbour across an edge is extrapolated from the opposite one.
    let across = |right: isize, down: isize| {
        let opposite = || neighbour(-right, -down).map(|height| 2.0 * center - height);
        neighbour(right, down).or_else(opposite)
    };
    let [east, north, west, south] = [across(1, 0), across(0, -1), across(-1, 0), across(0, 1)];
    // A missing corner is extrapolated from two cells in its column or in its row. Otherwise the other corners
    // give it, as on a plane.
    let corner = |right: isize, down: isize| {
        let along = |near: Option<f64>, far: Option<f64>| near.zip(far).map(|(near, far)| 2.0 * near - far);
        let column = || along(neighbour(right, 0), neighbour(right, -down));
        let row = || along(neighbour(0, down), neighbour(-right, down));
        let both = || match (column(), row()) {
            (Some(a), Some(b)) => Some((a + b) / 2.0),
            (a, b) => a.or(b),
        };
        neighbour(right, down).or_else(both)
    };
    let diagonal = |right: isize, down: isize| match (corner(right, down), corner(-right, -down)) {
        (Some(a), Some(b)) => Some(a - b),
        (Some(a), None) => Some(2.0 * (a - center)),
        (None, Some(b)) => Some(2.0 * (center - b)),
        (None, None) => None,
    };
    let (north_east, south_east) = (diagonal(1, -1), diagonal(1, 1));
    let diagonals = north_east.zip(south_east);
    let straight = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a - b);
    let east = straight(east, west).or(diagonals.map(|(ne, se)| (ne + se) / 2.0)).unwrap_or(0.0);
    let north = straight(north, south).or(diagonals.map(|(ne, se)| (ne - se) / 2.0)).unwrap_or(0.0);
    let (north_east, south_east) = (north_east.unwrap_or(east + north), south_east.unwrap_or(east - north));
    Some(DVec2::new(2.0 * east + north_east + south_east, 2.0 * north + north_east - south_east))
}
