//! The height of a point of a ridge or canyon line on the smooth surface.

use glam::DVec2;

use crate::spline::WorkingGrids;

/// The height of an axis point on the smooth surface. `before` is its height in the triangulation. The grid does not
/// know the ground between its nodes. So a point near a contour keeps more of its height before.
pub fn smooth_height(working: &WorkingGrids, place: DVec2, before: f64, contour_distance: f64) -> f64 {
    let Some(working) = working.around(place) else { return before };
    let smooth = f64::from(working.at(place));
    let share = (contour_distance / working.grid.cell.max_element()).min(1.0);
    if smooth.is_nan() { before } else { before + share * (smooth - before) }
}
