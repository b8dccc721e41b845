//! Steep places: areas with at least a given slope and a given height, as polygons.
//!
//! The usual values are those of Japanese law for a steep slope that may fail (急傾斜地): 30 degrees and 5 metres. A height
//! map shows only what its source shows. Contours 10 m apart cannot show a slope of 5 m. So the result is no survey.

use glam::DVec2;

use super::outline::{Joined, OUTSIDE, area, on_map, outlines, pieces};
use super::rows::{Derivative, Derived};
use crate::base::error::{Error, Result};
use crate::base::memory;
use crate::raster::{Blocks, GroundScale, RasterRows, each_pair, uniform};

/// Bytes of memory per cell: the areas, the parts of them that are joined along edges, and marks.
const BYTES_PER_CELL: f64 = 12.0;

/// The limits that make a place steep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteepParams {
    /// Least slope of a cell, degrees.
    pub angle: f64,
    /// Least difference in height within an area, metres.
    pub height: f64,
    /// Memory that the work may take, bytes. Work that needs more is an error. No limit if `None`.
    pub memory: Option<u64>,
}

impl Default for SteepParams {
    fn default() -> Self {
        Self { angle: 30.0, height: 5.0, memory: None }
    }
}

/// A part of a steep area. Parts of one area meet at corners of cells only.
#[derive(Debug, Clone, PartialEq)]
pub struct SteepArea {
    /// The number of the area that this part belongs to, from 1.
    pub area_id: u32,
    /// The outer ring, then the holes, along cell edges, in map units. Each ring ends where it begins.
    pub rings: Vec<Vec<DVec2>>,
    /// Area of this part on the map (not along the slope), square metres.
    pub area: f64,
    /// Highest minus lowest height of the whole area and the cells around it, metres.
    pub height: f64,
    /// Mean slope of the cells of the whole area, degrees.
    pub slope_mean: f64,
    /// Largest slope of the cells of the whole area, degrees.
    pub slope_max: f64,
}

/// The steep places of a height map.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Steeps {
    /// The parts of all areas, from the north-west.
    pub parts: Vec<SteepArea>,
    /// Number of areas.
    pub areas: usize,
    /// Number of areas that are steep enough but not high enough. They are left out.
    pub too_low: usize,
}

/// Finds the areas with at least the given slope and height.
///
/// Cells whose slope (Horn 1981, 3 x 3 cells) reaches the angle form an area where they share an edge or a corner. The
/// height of an area is the difference between the highest and the lowest height of its cells and the cells around
/// them. The slopes depend on these cells too.
///
/// # Errors
/// An angle that is not between 0 and 90 degrees, or a height that is negative or not finite. [`Error::OutOfMemory`] if the
/// work needs more memory than it may take. As [`RasterRows::read`].
pub fn steep(heights: &dyn RasterRows, scale: &GroundScale, params: &SteepParams) -> Result<Steeps> {
    if !(params.angle > 0.0 && params.angle < 90.0) {
        return Err(Error::out_of_range("angle", params.angle, "between 0 and 90 degrees"));
    }
    if !(params.height >= 0.0 && params.height.is_finite()) {
        let (name, must) = ("height", "0 or more");
        return Err(Error::OutOfRange { name, value: params.height, unit: " m", must });
    }
    let grid = heights.grid();
    let (what, remedy) =
        (format!("steep places of {} cells", grid.len()), "clip the height map, or make its cells larger");
    memory::check(BYTES_PER_CELL * grid.len() as f64, params.memory, what, remedy)?;
    let slopes = Derived { heights, scale, derivative: Derivative::Slope };
    let (mut areas, count) = pieces(grid.cols, &steep_cells(&slopes, params.angle)?, Joined::AtCorners);
    let measures = measures([heights, &slopes], &areas, count)?;
    let is_high = |measure: &Measure| measure.height() >= params.height;
    let is_left_out = |area: u32| !measures.get(area as usize).is_some_and(is_high);
    areas.iter_mut().filter(|area| is_left_out(**area)).for_each(|area| *area = OUTSIDE);
    // Areas that are high enough are numbered in order.
    let mut number = 0;
    let numbers: Vec<u32> = measures
        .iter()
        .map(|measure| {
            number += u32::from(is_high(measure));
            number
        })
        .collect();

    let parts = outlines(grid.cols, &areas).into_iter().map(|part| {
        let area_of_part = areas[part.cell] as usize;
        let measure = &measures[area_of_part];
        SteepArea {
            area_id: numbers[area_of_part],
            area: area(&part.rings, &grid, scale),
            rings: on_map(&part.rings, &grid),
            height: measure.height(),
            slope_mean: measure.slope_sum / measure.cells,
            slope_max: measure.slope_max,
        }
    });
    let parts: Vec<SteepArea> = parts.collect();
    let high = number as usize;
    Ok(Steeps { parts, areas: high, too_low: count - high })
}

/// The set of the cells that are steep enough.
fn steep_cells(slopes: &Derived<'_>, angle: f64) -> Result<Vec<u32>> {
    let grid = slopes.grid();
    let mut set = uniform(grid.len(), OUTSIDE)?;
    let mut blocks = Blocks::of(slopes);
    while let Some(block) = blocks.next()? {
        let cells = set[block.rows.start * grid.cols..].iter_mut().zip(block.heights());
        cells.filter(|(_, slope)| f64::from(**slope) >= angle).for_each(|(cell, _)| *cell = 0);
    }
    Ok(set)
}

/// Measures areas. `areas` has the number of the area of each cell.
fn measures(heights_and_slopes: [&dyn RasterRows; 2], areas: &[u32], count: usize) -> Result<Vec<Measure>> {
    let cols = heights_and_slopes[0].grid().cols;
    let mut measures = vec![Measure::default(); count];
    each_pair(heights_and_slopes, |heights, slopes| {
        for row in slopes.rows.clone() {
            for (col, (area, slope)) in areas[row * cols..].iter().zip(slopes.row(row)).enumerate() {
                let Some(measure) = measures.get_mut(*area as usize) else { continue };
                let slope = f64::from(*slope);
                measure.cells += 1.0;
                measure.slope_sum += slope;
                measure.slope_max = measure.slope_max.max(slope);
                let near = col.saturating_sub(1)..(col + 2).min(cols);
                // The comparisons ignore NaN.
                for height in heights.around(row).into_iter().flatten().flat_map(|line| &line[near.clone()]) {
                    measure.low = measure.low.min(*height);
                    measure.high = measure.high.max(*height);
                }
            }
        }
    })?;
    Ok(measures)
}

/// Measurements of an area.
#[derive(Debug, Clone)]
struct Measure {
    cells: f64,
    slope_sum: f64,
    slope_max: f64,
    low: f32,
    high: f32,
}

impl Default for Measure {
    fn default() -> Self {
        Self { cells: 0.0, slope_sum: 0.0, slope_max: 0.0, low: f32::INFINITY, high: f32::NEG_INFINITY }
    }
}

impl Measure {
    fn height(&self) -> f64 {
        f64::from(self.high) - f64::from(self.low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;
    use crate::crs::Crs;
    use crate::raster::Dem;

    const METRES: GroundScale = GroundScale::Uniform(DVec2::ONE);

    fn dem(cols: usize, rows: usize, cell: f64, height: impl Fn(DVec2) -> f64) -> Dem {
        let corner = DVec2::new(0.0, rows as f64 * cell);
        let grid = Grid { corner, cell: DVec2::splat(cell), cols, rows };
        let values = (0..grid.len()).map(|i| height(grid.center(i % cols, i / cols)) as f32).collect();
        Dem { grid, values, crs: None }
    }

    #[test]
    fn a_cone_has_a_ring_of_steep_ground() {
        // Flat ground, a flank of 45 degrees from 20 to 60 m from the middle, a flat top.
        let center = DVec2::splat(100.0);
        let dem = dem(200, 200, 1.0, |p| 60.0 - (p - center).length().clamp(20.0, 60.0));
        let found = steep(&dem, &METRES, &SteepParams::default()).unwrap();
        assert_eq!((found.parts.len(), found.areas, found.too_low), (1, 1, 0));
        let part = &found.parts[0];
        assert_eq!(part.rings.len(), 2);
        let expected = std::f64::consts::PI * (60.0_f64.powi(2) - 20.0_f64.powi(2));
        assert!((part.area / expected - 1.0).abs() < 0.02, "{} {expected}", part.area);
        assert!((part.height - 40.0).abs() < 0.2, "{}", part.height);
        assert!((part.slope_max - 45.0).abs() < 0.5 && (part.slope_mean - 45.0).abs() < 1.5, "{part:?}");
    }

    #[test]
    fn steps_below_the_height_are_left_out_and_counted() {
        // Two steps, of 4 and of 6 m, each over one cell's width.
        let step = |p: DVec2| {
            if p.x < 20.0 {
                0.0
            } else if p.x < 60.0 {
                4.0
            } else {
                10.0
            }
        };
        let dem = dem(40, 10, 2.0, step);
        let found = steep(&dem, &METRES, &SteepParams::default()).unwrap();
        assert_eq!((found.areas, found.too_low), (1, 1));
        let part = &found.parts[0];
        assert_eq!((part.height, part.area_id), (6.0, 1));
        // Both sides of the step are steep: 6 m over 4 m.
        assert!((part.slope_max - 1.5_f64.atan().to_degrees()).abs() < 1e-4);
        assert_eq!(part.rings[0].iter().map(|p| p.x).fold(f64::INFINITY, f64::min), 58.0);
        let low = steep(&dem, &METRES, &SteepParams { height: 3.0, ..SteepParams::default() }).unwrap();
        assert_eq!(low.areas, 2);
    }

    #[test]
    fn areas_in_degrees_have_their_size_on_the_ground() {
        let mut dem = dem(60, 50, 1.0, |p| 60.0 - p.x);
        dem.grid.cell = DVec2::splat(1.0 / 100_000.0);
        dem.grid.corner = DVec2::new(138.0, 36.0);
        dem.crs = Some(Crs::from_epsg(6668));
        dem.values[7 * 60 + 9] = f32::NAN;
        let scale = GroundScale::of(&dem);
        let found = steep(&dem, &scale, &SteepParams::default()).unwrap();
        assert_eq!(found.parts.len(), 1);
        assert_eq!(found.parts[0].rings.len(), 2);
        let cell = |row: usize| (dem.grid.cell * scale.row(row)).element_product();
        let expected: f64 = (0..50).map(|row| cell(row) * if row == 7 { 59.0 } else { 60.0 }).sum();
        assert!((found.parts[0].area / expected - 1.0).abs() < 1e-9, "{} {expected}", found.parts[0].area);
    }

    #[test]
    fn what_needs_more_memory_than_there_is_is_refused() {
        let dem = dem(40, 10, 1.0, |p| p.x);
        let params = |memory| SteepParams { memory: Some(memory), ..SteepParams::default() };
        assert!(matches!(steep(&dem, &METRES, &params(1000)), Err(Error::OutOfMemory { .. })));
        assert_eq!(steep(&dem, &METRES, &params(10_000)).unwrap().areas, 1);
    }

    #[test]
    fn parameters_out_of_range_are_refused() {
        let dem = dem(3, 3, 1.0, |_| 0.0);
        for (angle, height) in [(0.0, 5.0), (90.0, 5.0), (f64::NAN, 5.0), (30.0, -1.0), (30.0, f64::INFINITY)] {
            assert!(matches!(
                steep(&dem, &METRES, &SteepParams { angle, height, memory: None }),
                Err(Error::OutOfRange { .. })
            ));
        }
        assert_eq!(steep(&dem, &METRES, &SteepParams::default()).unwrap(), Steeps::default());
    }
}
