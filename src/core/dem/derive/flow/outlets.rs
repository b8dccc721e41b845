//! Outlets: places whose catchments are asked for, moved to the stream beside them.

use std::collections::BTreeMap;

use glam::DVec2;

use super::catchments::Catchments;
use super::directions::FlowDirections;
use crate::base::Grid;
use crate::dem::derive::outline::OUTSIDE;
use crate::drain::{neighbours, ways_end};
use crate::raster::{Dem, GroundScale};

/// An outlet at a cell of a height map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlet {
    /// The cell.
    pub cell: usize,
    /// The centre of the cell, map units.
    pub place: DVec2,
    /// The distance from the place that was asked for, metres.
    pub moved: f64,
    /// The area that drains through the cell, square metres.
    pub area: f64,
}

/// The outlet for a place: of the cells whose centres lie within `distance` metres of it, that with the largest area above it,
/// and of several such cells the nearest one. The cell that holds the place always counts. `None` if none of these cells has a
/// height.
///
/// `areas` are those of [`flow_accumulation`](super::flow_accumulation), square metres.
pub fn snapped_outlet(areas: &Dem, scale: &GroundScale, place: DVec2, distance: f64) -> Option<Outlet> {
    let grid @ Grid { cols, rows, .. } = areas.grid;
    let at = grid.place(place);
    let own = at.round();
    let is_on = |p: DVec2| p.cmpge(DVec2::ZERO).all() && p.x < cols as f64 && p.y < rows as f64;
    let own = is_on(own).then(|| own.y as usize * cols + own.x as usize);
    // Cells are shorter in some rows than in others, but hardly within the distance.
    let row = at.y.clamp(0.0, rows.saturating_sub(1) as f64) as usize;
    let size = grid.cell * scale.row(row);
    let reach = (DVec2::splat(distance) / size).min(DVec2::new(cols as f64, rows as f64));
    let range = |at: f64, reach: f64, count: usize| {
        let (first, end) = ((at - reach).ceil().max(0.0), (at + reach).floor().min(count as f64 - 1.0) + 1.0);
        first as usize..end.max(0.0) as usize
    };
    let within = range(at.y, reach.y, rows).flat_map(|row| range(at.x, reach.x, cols).map(move |col| (col, row)));
    let away = |col: usize, row: usize| ((DVec2::new(col as f64, row as f64) - at) * size).length();
    let near = within.map(|(col, row)| (row * cols + col, away(col, row))).filter(|&(_, away)| away <= distance);
    let own = own.map(|cell| (cell, away(cell % cols, cell / cols)));
    let best = near.chain(own).filter(|&(cell, _)| !areas.values[cell].is_nan()).max_by(|a, b| {
        let of = |cell: usize| areas.values[cell];
        of(a.0).total_cmp(&of(b.0)).then(b.1.total_cmp(&a.1)).then(b.0.cmp(&a.0))
    });
    best.map(|(cell, moved)| Outlet {
        cell,
        place: grid.center(cell % cols, cell / cols),
        moved,
        area: f64::from(areas.values[cell]),
    })
}

/// Finds the catchments above outlets: each cell belongs to the first outlet on its way downstream. So the catchment of an
/// outlet that lies above another one is not a part of that one's. Catchments are numbered in the order of the outlets. Of
/// outlets at one cell, the first has the catchment, and the others have none. Cells that drain to no outlet belong to none.
///
/// The time is in proportion to the number of cells.
pub fn catchments_above(directions: &FlowDirections, outlets: &[Outlet]) -> Catchments {
    let cells = directions.grid().len();
    let mut numbers = BTreeMap::new();
    for (number, outlet) in (0..).zip(outlets) {
        numbers.entry(outlet.cell as u32).or_insert(number);
    }
    let next = |cell: u32| match directions.downstream(cell as usize) {
        Some(down) if !numbers.contains_key(&cell) => down as u32,
        _ => cell,
    };
    let mut labels = ways_end((0..cells as u32).map(next).collect());
    labels.iter_mut().for_each(|end| *end = numbers.get(end).copied().unwrap_or(OUTSIDE));
    Catchments::new(directions, labels, outlets.iter().map(|outlet| outlet.cell).collect())
}

/// For each catchment above outlets, the number of its cells at the border of the height map or beside cells without data,
/// besides the outlet. Where there are such cells, more ground may drain to the outlet than the height map shows.
pub fn cells_at_edge(directions: &FlowDirections, catchments: &Catchments) -> Vec<usize> {
    let Grid { cols, rows, .. } = *directions.grid();
    let mut counts = vec![0; catchments.count()];
    for (cell, &label) in catchments.labels().iter().enumerate() {
        let Some(count) = counts.get_mut(label as usize) else { continue };
        let is_missing = |near: Option<(usize, usize)>| near.is_none_or(|(_, near)| !directions.has_data(near));
        let is_at_edge = neighbours(cell, cols, rows).any(is_missing);
        *count += usize::from(is_at_edge && catchments.outlets()[label as usize] != cell);
    }
    counts
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::dem::derive::flow::{Accumulated, catchment_parts, flow_accumulation, flow_directions};

    const METRES: GroundScale = GroundScale::Uniform(DVec2::ONE);

    /// Heights at the centres of cells of 2 m; y is to the south.
    fn ground(cols: usize, rows: usize, height: impl Fn(DVec2) -> f64) -> Dem {
        let grid = Grid { corner: DVec2::new(100.0, 900.0), cell: DVec2::splat(2.0), cols, rows };
        let place = |i: usize| DVec2::new((i % cols) as f64, (i / cols) as f64);
        Dem { grid, values: (0..cols * rows).map(|i| height(place(i)) as f32).collect(), crs: None }
    }

    /// A valley along the middle row that falls to the west, and its directions and areas.
    fn valley() -> (FlowDirections, Dem) {
        let dem = ground(9, 5, |p| 10.0 * (p.y - 2.0).abs() + p.x);
        let directions = flow_directions(&dem, &METRES, None).unwrap();
        let areas = flow_accumulation(&directions, Accumulated::SquareMetres(&METRES));
        (directions, areas)
    }

    #[test]
    fn outlets_move_to_the_largest_stream_within_the_distance() {
        let (_, areas) = valley();
        let place = areas.grid.center(4, 1) + 0.5;
        let snapped = |distance| snapped_outlet(&areas, &METRES, place, distance).unwrap();
        assert_eq!(snapped(0.0).cell, 9 + 4);
        // South by a row; then also west along the valley, as far as the distance allows.
        let near = snapped(2.6);
        assert_eq!((near.cell, near.place), (2 * 9 + 4, areas.grid.center(4, 2)));
        assert!((near.moved - 0.5_f64.hypot(2.5)).abs() < 1e-12);
        assert_eq!(snapped(4.0).cell, 2 * 9 + 3);
        assert_eq!(snapped(100.0).cell, 2 * 9);
        assert_eq!(snapped(100.0).area, 9.0 * 5.0 * 4.0);
        // Places beside the map come onto it within the distance.
        let outside = DVec2::new(96.5, 895.0);
        assert_eq!(snapped_outlet(&areas, &METRES, outside, 4.0), None);
        assert_eq!(snapped_outlet(&areas, &METRES, outside, 4.6).unwrap().cell, 2 * 9);
        assert_eq!(snapped_outlet(&areas, &METRES, DVec2::NAN, 9.0), None);
    }

    #[test]
    fn a_catchment_is_what_drains_to_its_outlet_and_to_no_other_above_it() {
        let (directions, areas) = valley();
        let at = |col, row| snapped_outlet(&areas, &METRES, areas.grid.center(col, row), 0.0).unwrap();
        let outlets = [at(2, 2), at(6, 2), at(2, 2)];
        let found = catchments_above(&directions, &outlets);
        let numbers = found.raster().unwrap().values;
        assert_eq!(numbers[2 * 9..3 * 9].iter().map(|v| v.is_nan()).collect::<Vec<_>>()[..3], [true, true, false]);
        assert_eq!(numbers[2 * 9 + 2..3 * 9], [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        let parts = catchment_parts(&found, &METRES);
        let area = |number| parts.iter().filter(|part| part.catchment == number).map(|part| part.area).sum::<f64>();
        assert_eq!([area(1), area(2), area(3)], [outlets[0].area - outlets[1].area, outlets[1].area, 0.0]);
        // Both ends of each column, and all of the last one.
        let at_edge = cells_at_edge(&directions, &found);
        assert_eq!(
            at_edge.iter().sum::<usize>(),
            numbers
                .iter()
                .enumerate()
                .filter(|(cell, v)| { !v.is_nan() && (cell / 9 == 0 || cell / 9 == 4 || cell % 9 == 8) })
                .count()
        );
    }

    proptest! {
        #[test]
        fn the_catchment_is_as_large_as_the_accumulation_says(
            heights in proptest::collection::vec(0_u8..30, 99), cell in 0_usize..99, other in 0_usize..99,
        ) {
            let dem = ground(11, 9, |p| f64::from(heights[p.y as usize * 11 + p.x as usize]));
            let directions = flow_directions(&dem, &METRES, None).unwrap();
            let areas = flow_accumulation(&directions, Accumulated::SquareMetres(&METRES));
            let at = |cell| snapped_outlet(&areas, &METRES, areas.grid.center(cell % 11, cell / 11), 0.0).unwrap();
            let of = |outlets: &[Outlet]| {
                let numbers = catchments_above(&directions, outlets).raster().unwrap().values;
                4.0 * numbers.iter().filter(|v| !v.is_nan()).count() as f64
            };
            prop_assert_eq!(of(&[at(cell)]), at(cell).area);
            // Together they are the union: one lies in the other, or they have nothing in common.
            let both = of(&[at(cell), at(other)]);
            let sum = at(cell).area + at(other).area;
            prop_assert!(both == sum || both == at(cell).area.max(at(other).area));
        }
    }
}
