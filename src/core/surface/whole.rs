//! What the surface of a part takes from the whole map, so that it is the whole map's surface there.

use glam::DVec2;

use crate::base::Grid;
use crate::contour::Interval;
use crate::spline::part_of_grid;
use crate::validate::Chosen;

/// Figures of a whole map that the surface of each of its parts needs.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Whole {
    /// The vertical interval.
    pub interval: Interval,
    /// Mean spacing of the contours, map units.
    pub spacing: f64,
    /// The working grid of the smooth surface.
    pub grid: Grid,
    /// The hyper-parameters of the smooth surface; `None` for the other kinds.
    pub chosen: Option<Chosen>,
}

impl Whole {
    /// The working grid of the part in a box.
    pub(super) fn grid_of(&self, [lo, hi]: [DVec2; 2]) -> Grid {
        part_of_grid(&self.grid, lo, hi)
    }
}
