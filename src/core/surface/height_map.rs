//! The height map of a surface: the same steps for cells on its plane and for cells in other coordinates.

use super::along_streams::follow_streams;
use super::built::Surface;
use super::drained::drain_heights;
use super::places::InOther;
use super::sample::{heights, heights_on};
use crate::base::Grid;
use crate::base::progress::Progress;
use crate::crs::Crs;
use crate::raster::Dem;

/// The height map of a surface on a grid: heights read off the surface, brought into agreement with its streams, and drained as
/// the surface asks for. `other` has the conversion and `crs` the system of a grid that is not on the plane of the surface.
pub fn height_map(
    surface: &Surface,
    grid: &Grid,
    crs: Option<&Crs>,
    other: Option<InOther<'_>>,
    progress: &dyn Progress,
) -> Dem {
    let mut dem = match other {
        None => heights(surface, grid, progress),
        Some(other) => {
            let values = heights_on(surface, grid, &other.to_surface, progress);
            let mut dem = Dem { grid: *grid, values, crs: None };
            follow_streams(surface, &mut dem, other);
            dem
        }
    };
    drain_heights(surface, &mut dem, other);
    Dem { crs: crs.cloned(), ..dem }
}
