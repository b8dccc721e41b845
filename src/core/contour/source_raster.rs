//! The raster from which contours were generated, found from their vertices.
//!
//! Contours generated from a height map have their vertices where a level crosses the straight line between two
//! neighbouring cell centres. So each vertex lies on a row or a column of cell centres. Such contours describe the
//! ground along these rows and columns.

use glam::DVec2;

use super::map::Contour;
use crate::base::{Grid, parallel};

/// Number of vertices from which rows and columns are found.
const SAMPLE: usize = 200_000;
/// Fewest rows, and fewest columns, of a raster.
const FEWEST: usize = 8;
/// Largest distance of a vertex from its row or column, as a share of their spacing: coordinates are rounded.
const OFF: f64 = 1e-3;
/// Least share of the vertices on a row or a column.
const ON_EITHER: f64 = 0.95;
/// Least share of the vertices on a row, and on a column.
const ON_EACH: f64 = 0.1;
/// Largest share of the vertices on both a row and a column. If all coordinates are rounded to a step, there is no
/// raster.
const ON_BOTH: f64 = 0.5;

/// Largest ratio of the two spacings. No raster in use has longer cells.
const LONGEST: f64 = 10.0;

/// Rows and columns of cell centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceRaster {
    /// One of the centres, map coordinates.
    pub centre: DVec2,
    /// Size of a cell, map units.
    pub cell: DVec2,
}

/// The raster from which contours were generated; `None` if they have another origin, were smoothed or rotated.
pub fn source_raster(contours: &[Contour]) -> Option<SourceRaster> {
    // The last vertex of a ring is the first one again.
    let distinct = |c: &Contour| c.points.len() - usize::from(c.is_closed());
    let mut sample: Vec<DVec2> = Vec::new();
    for contour in contours {
        sample.extend(&contour.points[..distinct(contour)]);
        if sample.len() > SAMPLE {
            break;
        }
    }
    let [(x, width), (y, height)] = [lines(sample.iter().map(|p| p.x))?, lines(sample.iter().map(|p| p.y))?];
    if width.max(height) > LONGEST * width.min(height) {
        return None;
    }
    let raster = SourceRaster { centre: DVec2::new(x, y), cell: DVec2::new(width, height) };
    let count = |c: &Contour| {
        c.points.iter().fold([0_u64; 4], |[all, on_x, on_y, both], &p| {
            let [x, y] = raster.lines_at(p).map(u64::from);
            [all + 1, on_x + x, on_y + y, both + x * y]
        })
    };
    let sum = |a: [u64; 4], b: [u64; 4]| std::array::from_fn(|i| a[i] + b[i]);
    let counts = parallel::map_each(contours, count);
    let [all, on_x, on_y, both] = counts.into_iter().fold([0; 4], sum).map(|n| n as f64);
    let is_cut = on_x + on_y - both >= ON_EITHER * all && on_x.min(on_y) >= ON_EACH * all && both <= ON_BOTH * all;
    is_cut.then_some(raster)
}

impl SourceRaster {
    /// Whether the cells of a grid are cells of this one.
    pub fn has_cells_of(&self, grid: &Grid) -> bool {
        let is_as_large =
            ((grid.cell - self.cell) / self.cell).abs().max_element() * grid.cols.max(grid.rows) as f64 <= OFF;
        is_as_large && self.lines_at(grid.center(0, 0)) == [true; 2]
    }

    /// Whether a position lies on a column, and whether it lies on a row.
    fn lines_at(&self, p: DVec2) -> [bool; 2] {
        let at = (p - self.centre) / self.cell;
        ((at - at.round()).abs()).to_array().map(|off| off <= OFF)
    }
}

/// The first of the evenly spaced values among those that occur repeatedly, and their spacing.
fn lines(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let mut repeated: Vec<f64> = values.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    repeated.dedup();
    if repeated.len() < FEWEST {
        return None;
    }
    let mut steps: Vec<f64> = repeated.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable_by(f64::total_cmp);
    let about = steps[steps.len() / 2];
    // Over the whole width, the rounding of single values is negligible.
    let (first, last) = (repeated[0], repeated[repeated.len() - 1]);
    let step = (last - first) / ((last - first) / about).round();
    (step.is_finite() && step > 0.0).then_some((first, step))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: DVec2 = DVec2::new(3.0, 2.0);
    const CENTRE: DVec2 = DVec2::new(100.5, -7.25);

    fn contour(elevation: f64, points: Vec<DVec2>) -> Contour {
        Contour { elevation, points, feature: 0.into() }
    }

    /// Rings around a hill, through the places where they cross rows and columns.
    fn cut() -> Vec<Contour> {
        let top = CENTRE + DVec2::new(0.4, 0.7);
        let ring = |k: u32| {
            let radius = 10.3 + 7.1 * f64::from(k);
            let mut places: Vec<DVec2> = Vec::new();
            for line in (-100..=100).map(|i| CENTRE + f64::from(i) * CELL) {
                let to = line - top;
                for side in [-1.0, 1.0] {
                    places.push(DVec2::new(line.x, top.y + side * (radius * radius - to.x * to.x).sqrt()));
                    places.push(DVec2::new(top.x + side * (radius * radius - to.y * to.y).sqrt(), line.y));
                }
            }
            places.retain(|p| p.is_finite());
            places.sort_by(|a, b| (*a - top).to_angle().total_cmp(&(*b - top).to_angle()));
            places.push(places[0]);
            contour(10.0 * f64::from(k), places)
        };
        (0..6).map(ring).collect()
    }

    #[test]
    fn the_raster_of_cut_contours_is_found() {
        let found = source_raster(&cut()).unwrap();
        assert!((found.cell - CELL).length() < 1e-9, "{found:?}");
        let off = (found.centre - CENTRE) / CELL;
        assert!((off - off.round()).length() < 1e-9, "{found:?}");
    }

    #[test]
    fn contours_off_a_raster_and_rounded_ones_have_none() {
        let turned =
            |c: Contour| contour(c.elevation, c.points.iter().map(|&p| DVec2::from_angle(0.3).rotate(p)).collect());
        assert_eq!(source_raster(&cut().into_iter().map(turned).collect::<Vec<_>>()), None);
        let rounded = |c: Contour| contour(c.elevation, c.points.iter().map(|&p| p.round()).collect());
        assert_eq!(source_raster(&cut().into_iter().map(rounded).collect::<Vec<_>>()), None);
        let moved = |c: Contour| {
            let points = c.points.iter().enumerate();
            contour(c.elevation, points.map(|(i, &p)| p + 0.3 * DVec2::splat((i % 7) as f64)).collect())
        };
        assert_eq!(source_raster(&cut().into_iter().map(moved).collect::<Vec<_>>()), None);
        let narrow = |c: Contour| contour(c.elevation, c.points.iter().map(|&p| p * DVec2::new(1e-6, 1.0)).collect());
        assert_eq!(source_raster(&cut().into_iter().map(narrow).collect::<Vec<_>>()), None, "no raster has such cells");
        assert_eq!(source_raster(&[]), None);
    }
}
