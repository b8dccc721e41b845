//! Distance of cells from the nearest contour. Near contours heights are measured, far from them they are interpolated.

use glam::DVec2;
use rstar::primitives::Line;
use rstar::{PointDistance, RTree};

use crate::base::{Grid, parallel};
use crate::contour::Contour;

/// Distance of every cell centre to the nearest contour line, in units of the contours' map. NaN for cells that are not
/// `is_wanted`, and where there is no contour. `to_map` converts a position on the grid to the coordinates of the
/// contours.
///
/// The distance is to the nearest point of the line, not to its nearest vertex.
pub fn contour_distances(
    contours: &[Contour],
    grid: &Grid,
    to_map: &(impl Fn(DVec2) -> Option<DVec2> + Sync),
    is_wanted: impl Fn(usize) -> bool + Sync,
) -> Vec<f64> {
    let origin = contours.iter().flat_map(|c| c.points.first()).next().copied().unwrap_or_default();
    let relative = |p: DVec2| (p - origin).to_array();
    let segments: Vec<Line<[f64; 2]>> = contours
        .iter()
        .flat_map(|c| c.points.windows(2))
        .filter(|s| s[0].is_finite() && s[1].is_finite())
        .map(|s| Line::new(relative(s[0]), relative(s[1])))
        .collect();
    let tree = RTree::bulk_load(segments);
    let distance = |i: usize| {
        let place = if is_wanted(i) { to_map(grid.center(i % grid.cols, i / grid.cols)) } else { None };
        let Some(place) = place.filter(|p| p.is_finite()).map(relative) else { return f64::NAN };
        tree.nearest_neighbor(&place).map_or(f64::NAN, |s| s.distance_2(&place).sqrt())
    };
    parallel::values(grid.len(), distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_to_lines_and_not_to_vertices() {
        let line = |points: &[(f64, f64)]| Contour {
            elevation: 0.0,
            points: points.iter().map(|&p| p.into()).collect(),
            feature: 0.into(),
        };
        let contours = [line(&[(500_000.0, 0.0), (500_100.0, 0.0)]), line(&[(500_000.0, 30.0), (500_000.0, 90.0)])];
        let grid = Grid { corner: DVec2::new(500_045.0, 25.0), cell: DVec2::splat(10.0), cols: 2, rows: 2 };
        let d = contour_distances(&contours, &grid, &Some, |i| i != 1);
        assert!((d[0] - 20.0).abs() < 1e-9 && d[1].is_nan() && (d[2] - 10.0).abs() < 1e-9, "{d:?}");
        let shifted = contour_distances(&contours, &grid, &|p: DVec2| Some(p + DVec2::new(0.0, 5.0)), |_| true);
        assert!((shifted[3] - 15.0).abs() < 1e-9);
        assert!(contour_distances(&[], &grid, &Some, |_| true).iter().all(|d| d.is_nan()));
        assert!(contour_distances(&contours, &grid, &|_| None, |_| true).iter().all(|d| d.is_nan()));
    }
}
