//! The streams of a height map as lines: where enough ground drains through a cell, with their Strahler order.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::directions::FlowDirections;
use crate::base::Grid;
use crate::base::error::{Error, Result};
use crate::drain::{STEPS, neighbours};
use crate::raster::{Dem, GroundScale};

/// A stream from its source or a confluence to the next confluence or to where it leaves the height map.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowLine {
    /// The centres of its cells, downstream, map units. Heights are those of the ground, metres; in a pit, the height at which
    /// water leaves it. So they never rise.
    pub points: Vec<DVec3>,
    /// The line that begins where this one ends, if there is one.
    pub into: Option<usize>,
    /// Its Strahler order: 1 from a source on; where two streams of the highest order meet, one more.
    pub strahler: u32,
    /// Its length on the map, metres.
    pub length: f64,
    /// The area that drains through it at its lower end, before the confluence, square metres.
    pub area: f64,
}

impl FlowLine {
    /// The height of its upper end above the lower one, metres.
    pub fn fall(&self) -> f64 {
        self.points.first().zip(self.points.last()).map_or(0.0, |(first, last)| first.z - last.z)
    }
}

/// The cells of streams, and where their lines begin.
struct Network<'a> {
    directions: &'a FlowDirections,
    areas: &'a Dem,
    threshold: f64,
}

impl Network<'_> {
    /// Whether enough ground drains through a cell.
    fn is_stream(&self, cell: usize) -> bool {
        f64::from(self.areas.values[cell]) >= self.threshold
    }

    /// The number of streams that drain to a cell from the cells around it.
    fn inflows(&self, cell: usize) -> usize {
        let Grid { cols, rows, .. } = self.areas.grid;
        let drains_here = |near: usize| self.is_stream(near) && self.directions.downstream(near) == Some(cell);
        neighbours(cell, cols, rows).flatten().filter(|&(_, near)| drains_here(near)).count()
    }

    /// The cells of the line that begins at a cell, with the confluence at its end.
    fn line(&self, start: usize) -> Vec<usize> {
        let mut cells = vec![start];
        let mut at = start;
        while let Some(down) = self.directions.downstream(at) {
            cells.push(down);
            at = down;
            if self.inflows(at) > 1 {
                break;
            }
        }
        cells
    }
}

/// Finds the streams: the cells through which at least `threshold` square metres drain, as lines from each source or
/// confluence to the next confluence or outlet. A stream of a single cell is no line. `areas` are those of
/// [`flow_accumulation`](super::flow_accumulation), square metres. The lines are in the order of their first cells, row by row
/// from the north-west.
///
/// The time is in proportion to the number of cells. The memory grows with the streams only.
///
/// # Errors
/// [`Error::OutOfRange`] if the threshold is not above 0.
pub fn flow_lines(
    dem: &Dem,
    directions: &FlowDirections,
    areas: &Dem,
    scale: &GroundScale,
    threshold: f64,
) -> Result<Vec<FlowLine>> {
    check_threshold(threshold)?;
    let network = Network { directions, areas, threshold };
    let grid @ Grid { cols, .. } = areas.grid;
    let begins = |cell: &usize| network.is_stream(*cell) && network.inflows(*cell) != 1;
    let starts = (0..grid.len()).filter(begins);
    let lines: Vec<Vec<usize>> = starts.map(|start| network.line(start)).filter(|cells| cells.len() > 1).collect();
    let by_start: BTreeMap<usize, usize> = lines.iter().enumerate().map(|(k, cells)| (cells[0], k)).collect();
    let into: Vec<Option<usize>> =
        lines.iter().map(|cells| cells.last().and_then(|end| by_start.get(end)).copied()).collect();
    let order = downstream_order(&into);
    let orders = strahler(&into, &order);
    // Upstream, heights are at least those below them, as water in pits rises to the rim.
    let mut heights: Vec<Vec<f64>> = vec![Vec::new(); lines.len()];
    for &k in order.iter().rev() {
        let below = into[k].and_then(|next| heights[next].first().copied());
        let mut level = below.unwrap_or(f64::NEG_INFINITY);
        let up = lines[k].iter().rev().map(|&cell| {
            level = level.max(f64::from(dem.values[cell]));
            level
        });
        heights[k] = up.collect();
        heights[k].reverse();
    }
    let line = |(k, cells): (usize, &Vec<usize>)| {
        let place = |(&cell, &z): (&usize, &f64)| grid.center(cell % cols, cell / cols).extend(z);
        let lowest =
            if into[k].is_some() || ends_in_confluence(&network, cells) { cells.len() - 2 } else { cells.len() - 1 };
        FlowLine {
            points: cells.iter().zip(&heights[k]).map(place).collect(),
            into: into[k],
            strahler: orders[k],
            length: cells.windows(2).map(|pair| distance(pair, &grid, scale)).sum(),
            area: f64::from(areas.values[cells[lowest]]),
        }
    };
    Ok(lines.iter().enumerate().map(line).collect())
}

/// Refuses a threshold that makes every cell a stream.
pub(super) fn check_threshold(threshold: f64) -> Result<()> {
    match threshold > 0.0 && threshold.is_finite() {
        true => Ok(()),
        false => Err(Error::OutOfRange { name: "threshold", value: threshold, unit: " m²", must: "more than 0" }),
    }
}

/// Whether another line ends at the same cell, which is an outlet.
fn ends_in_confluence(network: &Network<'_>, cells: &[usize]) -> bool {
    cells.last().is_some_and(|&end| network.inflows(end) > 1)
}

/// The distance between two neighbours on the ground, metres.
fn distance(pair: &[usize], grid: &Grid, scale: &GroundScale) -> f64 {
    let [from, to] = [pair[0], pair[1]];
    let size = grid.cell * scale.row(from / grid.cols);
    let step =
        STEPS.iter().find(|(right, down)| from.checked_add_signed(down * grid.cols as isize + right) == Some(to));
    step.map_or(0.0, |&(right, down)| (DVec2::new(right as f64, down as f64) * size).length())
}

/// The lines in an order in which each one comes after those that run into it.
fn downstream_order(into: &[Option<usize>]) -> Vec<usize> {
    let mut waiting = vec![0_usize; into.len()];
    into.iter().flatten().for_each(|&next| waiting[next] += 1);
    let mut order: Vec<usize> = (0..into.len()).filter(|&k| waiting[k] == 0).collect();
    let mut at = 0;
    while let Some(&k) = order.get(at) {
        at += 1;
        if let Some(next) = into[k] {
            waiting[next] -= 1;
            if waiting[next] == 0 {
                order.push(next);
            }
        }
    }
    order
}

/// The Strahler order of each line.
fn strahler(into: &[Option<usize>], order: &[usize]) -> Vec<u32> {
    // The highest order that runs into each line, and whether several do.
    let mut highest = vec![(0_u32, false); into.len()];
    let mut orders = vec![0; into.len()];
    for &k in order {
        let (most, is_met) = highest[k];
        orders[k] = if most == 0 || is_met { most + 1 } else { most };
        if let Some(next) = into[k] {
            let (most, _) = highest[next];
            match orders[k].cmp(&most) {
                std::cmp::Ordering::Greater => highest[next] = (orders[k], false),
                std::cmp::Ordering::Equal => highest[next].1 = true,
                std::cmp::Ordering::Less => {}
            }
        }
    }
    orders
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::dem::derive::flow::{Accumulated, flow_accumulation, flow_directions};

    const METRES: GroundScale = GroundScale::Uniform(DVec2::ONE);

    fn lines(cols: usize, heights: &[f32], threshold: f64) -> (Vec<FlowLine>, Dem, Dem) {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols, rows: heights.len() / cols };
        let dem = Dem { grid, values: heights.to_vec(), crs: None };
        let directions = flow_directions(&dem, &METRES, None).unwrap();
        let areas = flow_accumulation(&directions, Accumulated::SquareMetres(&METRES));
        (flow_lines(&dem, &directions, &areas, &METRES, threshold).unwrap(), dem, areas)
    }

    #[test]
    fn two_brooks_make_a_stream_of_the_second_order() {
        // Two valleys in columns 1 and 5 that meet in column 3 and leave at the south.
        let rows = [
            [9., 8.0, 9., 9.5, 9., 8.0, 9.],
            [9., 7.0, 9., 9.5, 9., 7.0, 9.],
            [9., 6.0, 9., 9.5, 9., 6.0, 9.],
            [9., 9.0, 5., 9.5, 5., 9.0, 9.],
            [9., 9.0, 9., 4.0, 9., 9.0, 9.],
            [9., 9.0, 9., 4.5, 9., 9.0, 9.],
            [9., 9.0, 9., 3.0, 9., 9.0, 9.],
        ];
        let (found, _, areas) = lines(7, &rows.concat(), 4.0);
        let [west, east, lower] = &found[..] else { panic!("{found:?}") };
        assert_eq!([west.strahler, east.strahler, lower.strahler], [1, 1, 2]);
        assert_eq!([west.into, east.into, lower.into], [Some(2), Some(2), None]);
        assert_eq!(west.points.last(), lower.points.first());
        // The confluence is a pit: its water leaves over 4.5.
        assert_eq!(lower.points.iter().map(|p| p.z).collect::<Vec<_>>(), [4.5, 4.5, 3.0]);
        assert_eq!((lower.length, lower.fall()), (2.0, 1.5));
        assert_eq!(lower.area, f64::from(areas.values[6 * 7 + 3]));
        assert_eq!(west.area, f64::from(areas.values[3 * 7 + 2]));
        assert!(flow_lines_refuse(0.0) && flow_lines_refuse(-5.0) && flow_lines_refuse(f64::NAN));
    }

    fn flow_lines_refuse(threshold: f64) -> bool {
        check_threshold(threshold).is_err()
    }

    proptest! {
        #[test]
        fn lines_hold_each_cell_of_a_stream_once_and_never_rise(
            heights in proptest::collection::vec(0_u8..40, 143), threshold in 1_u8..20,
        ) {
            let heights: Vec<f32> = heights.into_iter().map(f32::from).collect();
            let (found, dem, areas) = lines(11, &heights, f64::from(threshold));
            let mut held = vec![0_u32; dem.values.len()];
            for line in &found {
                prop_assert!(line.points.len() > 1);
                prop_assert!(line.points.windows(2).all(|w| w[1].z <= w[0].z && w[0].distance(w[1]) < 99.0));
                let cell = |p: &DVec3| {
                    let at = dem.grid.place(p.truncate());
                    at.y as usize * 11 + at.x as usize
                };
                prop_assert!(line.points.iter().all(|p| p.z >= f64::from(dem.values[cell(p)])));
                line.points[..line.points.len() - 1].iter().for_each(|p| held[cell(p)] += 1);
                let above = found.iter().filter(|other| other.into.is_some_and(|into| std::ptr::eq(&found[into], line)));
                let orders: Vec<u32> = above.map(|other| other.strahler).collect();
                let most = orders.iter().copied().max().unwrap_or(0);
                let is_met = orders.iter().filter(|order| **order == most).count() != 1;
                prop_assert_eq!(line.strahler, most + u32::from(is_met));
                if let Some(into) = line.into {
                    prop_assert_eq!(line.points.last(), found[into].points.first());
                }
            }
            // Every cell of a stream that drains to another one begins one step.
            let directions = flow_directions(&dem, &METRES, None).unwrap();
            for (cell, &held) in held.iter().enumerate() {
                let goes_on = areas.values[cell] >= f32::from(threshold) && directions.downstream(cell).is_some();
                prop_assert_eq!(held, u32::from(goes_on), "{}", cell);
            }
        }
    }
}
