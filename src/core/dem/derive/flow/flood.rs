//! Ground under water: up to a level, from the edge of the map or from places, or up to a height above the streams.

use glam::DVec2;

use super::directions::FlowDirections;
use super::stream_lines::check_threshold;
use crate::base::error::{Error, Result};
use crate::base::{Grid, memory};
use crate::crs::Crs;
use crate::dem::derive::outline::{Joined, OUTSIDE, area, on_map, outlines, pieces};
use crate::drain::neighbours;
use crate::raster::{Dem, GroundScale, uniform};

/// Bytes of memory per cell: the depth, and the edge of the water in the worst case; later the areas of water.
const BYTES_PER_CELL: f64 = 9.0;

/// Where the water of a flood comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum FloodFrom {
    /// From beyond the border of the height map, and from cells without data.
    Edge,
    /// From these cells.
    Cells(Vec<usize>),
}

/// Ground under water.
#[derive(Debug, Clone, PartialEq)]
pub struct Flood {
    /// The depth of the water in each cell, metres. NaN where the ground is dry or has no height.
    pub depths: Dem,
    /// The number of cells under water.
    pub cells: usize,
    /// Their area on the map, square metres.
    pub area: f64,
    /// The volume of the water, cubic metres.
    pub volume: f64,
    /// The largest depth, metres.
    pub deepest: f64,
}

/// Water of one flood, between two depths, that is joined along the edges of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct FloodPart {
    /// The depth that its water is not less deep than, metres.
    pub from: f64,
    /// The depth that its water is less deep than, metres; `None` for the deepest water.
    pub to: Option<f64>,
    /// The outer ring, then the holes, along cell edges, in map units. Each ring ends where it begins.
    pub rings: Vec<Vec<DVec2>>,
    /// Its area on the map, square metres.
    pub area: f64,
    /// Its volume, cubic metres.
    pub volume: f64,
    /// Its largest depth, metres.
    pub deepest: f64,
}

/// Finds the ground below a level (metres) that water reaches, from cell to cell among the eight around each: from the edge or
/// from some cells. Ground below the level behind higher ground stays dry. A cell of `from` whose ground is not below the level
/// gives no water.
///
/// The time is in proportion to the number of cells. `memory` is what the work may take, bytes; no limit if `None`.
///
/// # Errors
/// [`Error::OutOfMemory`] if it needs more memory.
pub fn flood_to_level(
    dem: &Dem,
    scale: &GroundScale,
    level: f64,
    from: &FloodFrom,
    memory: Option<u64>,
) -> Result<Flood> {
    let Grid { cols, rows, .. } = dem.grid;
    check_memory(dem, memory)?;
    let mut depths = uniform(dem.values.len(), f32::NAN)?;
    let depth = |cell: usize| level - f64::from(dem.values[cell]);
    let is_low = |cell: usize| dem.values[cell].is_finite() && depth(cell) > 0.0;
    let is_at_edge = |cell: usize| {
        neighbours(cell, cols, rows).any(|near| near.is_none_or(|(_, near)| !dem.values[near].is_finite()))
    };
    let starts: Vec<usize> = match from {
        FloodFrom::Edge => (0..dem.values.len()).filter(|&cell| is_low(cell) && is_at_edge(cell)).collect(),
        FloodFrom::Cells(cells) => {
            cells.iter().copied().filter(|&cell| cell < dem.values.len() && is_low(cell)).collect()
        }
    };
    let mut wet: Vec<u32> = Vec::new();
    for start in starts {
        if depths[start].is_nan() {
            depths[start] = depth(start) as f32;
            wet.push(start as u32);
        }
        while let Some(cell) = wet.pop() {
            for (_, near) in neighbours(cell as usize, cols, rows).flatten() {
                if depths[near].is_nan() && is_low(near) {
                    depths[near] = depth(near) as f32;
                    wet.push(near as u32);
                }
            }
        }
    }
    Ok(Flood::of(depths, dem, scale))
}

/// Finds the ground less than `rise` metres above the stream that it drains to. Streams are cells through which at least
/// `threshold` square metres drain (`areas`, from [`flow_accumulation`](super::flow_accumulation)). The water stands `rise`
/// metres above the stream there (height above the nearest drainage: Rennó et al. 2008, Remote Sensing of Environment 112). A
/// stream has the height of its ground; in a pit, the height at which water leaves it. Ground behind a rim that is higher than
/// the water stays dry, and so does ground that drains to no stream.
///
/// # Errors
/// [`Error::OutOfRange`] if the threshold is not above 0, or the rise is not. [`Error::OutOfMemory`] as in [`flood_to_level`].
pub fn flood_along_streams(
    dem: &Dem,
    directions: &FlowDirections,
    areas: &Dem,
    scale: &GroundScale,
    params: StreamFlood,
) -> Result<Flood> {
    let StreamFlood { threshold, rise, memory } = params;
    check_threshold(threshold)?;
    if !(rise > 0.0 && rise.is_finite()) {
        return Err(Error::OutOfRange { name: "rise", value: rise, unit: " m", must: "more than 0" });
    }
    check_memory(dem, memory)?;
    let Grid { cols, rows, .. } = dem.grid;
    let height = |cell: usize| f64::from(dem.values[cell]);
    let is_stream = |cell: usize| f64::from(areas.values[cell]) >= threshold;
    let mut depths = uniform(dem.values.len(), f32::NAN)?;
    // Cells, each with the level of its stream, as high at least as that of the stream below it.
    let mut wet: Vec<(u32, f64)> = Vec::new();
    let is_end = |cell: &usize| is_stream(*cell) && directions.downstream(*cell).is_none();
    for end in (0..dem.values.len()).filter(is_end) {
        wet.push((end as u32, height(end)));
        while let Some((cell, stream)) = wet.pop() {
            let cell = cell as usize;
            depths[cell] = (stream + rise - height(cell)) as f32;
            // Up all ways that lead here, until the ground is as high as the water.
            for (_, near) in neighbours(cell, cols, rows).flatten() {
                if directions.downstream(near) != Some(cell) {
                    continue;
                }
                if is_stream(near) {
                    wet.push((near as u32, stream.max(height(near))));
                } else if height(near) < stream + rise {
                    wet.push((near as u32, stream));
                }
            }
        }
    }
    Ok(Flood::of(depths, dem, scale))
}

/// A flood along streams.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamFlood {
    /// The least area that drains through a cell of a stream, square metres.
    pub threshold: f64,
    /// The height of the water above the streams, metres.
    pub rise: f64,
    /// What the work may take, bytes; no limit if `None`.
    pub memory: Option<u64>,
}

/// Refuses depths that do not part water: they must be more than 0 and increase.
///
/// # Errors
/// [`Error::Parameter`].
pub fn check_depths(depths: &[f64]) -> Result<()> {
    match depths.windows(2).all(|w| w[0] < w[1]) && depths.iter().all(|depth| depth.is_finite() && *depth > 0.0) {
        true => Ok(()),
        false => Err(Error::Parameter("depths of a flood must be more than 0, from small to large: 0.5,1,2".into())),
    }
}

fn check_memory(dem: &Dem, budget: Option<u64>) -> Result<()> {
    let (what, remedy) =
        (format!("a flood over {} cells", dem.values.len()), "clip the height map, or make its cells larger");
    memory::check(BYTES_PER_CELL * dem.values.len() as f64, budget, what, remedy)
}

impl Flood {
    fn of(depths: Vec<f32>, dem: &Dem, scale: &GroundScale) -> Self {
        let Dem { grid, ref crs, .. } = *dem;
        let (mut cells, mut area, mut volume, mut deepest) = (0, 0.0, 0.0, 0.0_f64);
        for (row, line) in depths.chunks(grid.cols.max(1)).enumerate() {
            let cell = (grid.cell * scale.row(row)).element_product();
            for depth in line.iter().filter(|depth| !depth.is_nan()).map(|depth| f64::from(*depth)) {
                cells += 1;
                area += cell;
                volume += depth * cell;
                deepest = deepest.max(depth);
            }
        }
        let crs: Option<Crs> = crs.clone();
        Self { depths: Dem { grid, values: depths, crs }, cells, area, volume, deepest }
    }

    /// The outlines of the water, from the north-west, parted at some depths (see [`check_depths`]). They are a partition of the
    /// cells under water. `scale` gives their areas.
    pub fn parts(&self, scale: &GroundScale, depths: &[f64]) -> Vec<FloodPart> {
        let Dem { grid, values, .. } = &self.depths;
        let band = |depth: f32| depths.partition_point(|limit| *limit <= f64::from(depth));
        let sets: Vec<u32> = values.iter().map(|&d| if d.is_nan() { OUTSIDE } else { band(d) as u32 }).collect();
        let (labels, count) = pieces(grid.cols, &sets, Joined::AlongEdges);
        drop(sets);
        let mut measures = vec![(0.0, 0.0_f64); count];
        for (cell, (&label, &depth)) in labels.iter().zip(values).enumerate() {
            let Some((volume, deepest)) = measures.get_mut(label as usize) else { continue };
            let depth = f64::from(depth);
            *volume += depth * (grid.cell * scale.row(cell / grid.cols)).element_product();
            *deepest = deepest.max(depth);
        }
        let parts = outlines(grid.cols, &labels).into_iter().map(|part| {
            let (volume, deepest) = measures[labels[part.cell] as usize];
            let band = band(values[part.cell]);
            FloodPart {
                from: band.checked_sub(1).map_or(0.0, |below| depths[below]),
                to: depths.get(band).copied(),
                area: area(&part.rings, grid, scale),
                rings: on_map(&part.rings, grid),
                volume,
                deepest,
            }
        });
        parts.collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::dem::derive::flow::{Accumulated, flow_accumulation, flow_directions};

    const METRES: GroundScale = GroundScale::Uniform(DVec2::ONE);

    fn dem(cols: usize, values: Vec<f32>) -> Dem {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::splat(2.0), cols, rows: values.len() / cols };
        Dem { grid, values, crs: None }
    }

    #[test]
    fn ground_behind_a_dam_stays_dry_unless_water_begins_there() {
        let ground = dem(5, vec![9., 9., 9., 9., 9., 1., 5., 2., 3., 9., 9., 9., 9., 9., 9.]);
        let flood = |level, from| flood_to_level(&ground, &METRES, level, &from, None).unwrap();
        let low = flood(4.0, FloodFrom::Edge);
        assert_eq!((low.cells, low.area, low.volume, low.deepest), (1, 4.0, 12.0, 3.0));
        // Over the dam.
        let high = flood(6.0, FloodFrom::Edge);
        assert_eq!((high.cells, high.volume), (4, 4.0 * (5.0 + 1.0 + 4.0 + 3.0)));
        let lake = flood(4.0, FloodFrom::Cells(vec![7, 6]));
        assert_eq!((lake.cells, lake.depths.values[7], lake.depths.values[8]), (2, 2.0, 1.0));
        assert_eq!(flood(0.5, FloodFrom::Edge).cells, 0);
        let parts = lake.parts(&METRES, &[]);
        assert_eq!((parts.len(), parts[0].area, parts[0].volume, parts[0].deepest), (1, 8.0, 12.0, 2.0));
    }

    #[test]
    fn along_a_stream_water_stands_above_its_own_ground() {
        // A valley in the middle row that falls to the west by 1 per cell; its sides rise by 2 per cell.
        let values = (0..7 * 9).map(|i| (i % 7) as f32 + 2.0 * (i / 7_usize).abs_diff(4) as f32).collect();
        let valley = dem(7, values);
        let directions = flow_directions(&valley, &METRES, None).unwrap();
        let areas = flow_accumulation(&directions, Accumulated::SquareMetres(&METRES));
        let flood = |rise, threshold| {
            let params = StreamFlood { threshold, rise, memory: None };
            flood_along_streams(&valley, &directions, &areas, &METRES, params)
        };
        let found = flood(3.5, 30.0).unwrap();
        for (cell, depth) in found.depths.values.iter().enumerate() {
            let (col, off) = (cell % 7, (cell / 7).abs_diff(4));
            if off == 0 && f64::from(areas.values[cell]) >= 30.0 {
                assert_eq!(*depth, 3.5);
            } else if off > 1 {
                assert!(depth.is_nan(), "{col} {off}");
            }
        }
        assert!(found.cells > 6 && found.deepest == 3.5);
        for (rise, threshold) in [(0.0, 30.0), (f64::NAN, 30.0), (1.0, 0.0)] {
            assert!(matches!(flood(rise, threshold), Err(Error::OutOfRange { .. })));
        }
    }

    proptest! {
        #[test]
        fn wet_ground_is_low_and_joined_to_where_water_comes_from(
            heights in proptest::collection::vec(0_u8..12, 99), level in 1_u8..12, start in 0_usize..99,
        ) {
            let ground = dem(11, heights.iter().map(|z| f32::from(*z)).collect());
            let low = |cell: usize| heights[cell] < level;
            for from in [FloodFrom::Edge, FloodFrom::Cells(vec![start])] {
                let is_start = |cell: usize| match &from {
                    FloodFrom::Edge => neighbours(cell, 11, 9).any(|near| near.is_none()),
                    FloodFrom::Cells(cells) => cells.contains(&cell),
                };
                // By the slow way, again and again over all cells.
                let mut wet: Vec<bool> = (0..99).map(|cell| low(cell) && is_start(cell)).collect();
                for _ in 0..99 {
                    for cell in 0..99 {
                        let beside = neighbours(cell, 11, 9).flatten().any(|(_, near)| wet[near]);
                        wet[cell] |= low(cell) && beside;
                    }
                }
                let found = flood_to_level(&ground, &METRES, f64::from(level), &from, None).unwrap();
                let depth = |cell: usize| f32::from(level) - f32::from(heights[cell]);
                for (cell, (&is_wet, &found)) in wet.iter().zip(&found.depths.values).enumerate() {
                    prop_assert!(if is_wet { found == depth(cell) } else { found.is_nan() }, "{}", cell);
                }
                for depths in [&[][..], &[1.0, 2.5, 6.0]] {
                    let parts = found.parts(&METRES, depths);
                    prop_assert!((parts.iter().map(|part| part.volume).sum::<f64>() - found.volume).abs() < 1e-9);
                    prop_assert_eq!(parts.iter().map(|part| part.area).sum::<f64>(), found.area);
                    for part in parts {
                        prop_assert!(part.volume >= part.from * part.area, "{:?}", part);
                        prop_assert!(part.to.is_none_or(|to| part.deepest < to && to - part.from > 0.9), "{:?}", part);
                    }
                }
            }
        }
    }
}
