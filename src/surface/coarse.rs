//! The error of a smooth surface whose nodes are further apart than the contours ask for.

use super::groups::Groups;
use super::params::SurfaceParams;
use crate::base::error::{Finding, FindingKind};
use crate::spline::{WorkingGrids, coarser_than_asked};
use crate::subdivision::Subdivision;
use crate::subdomains::MapExtent;
use crate::validate::{Accuracy, Chosen};

/// Most vertices of contours at which the surface is compared with them.
const PLACES: usize = 100_000;
/// 90 % of normally distributed errors are within this many standard errors.
const WITHIN_90: f64 = 1.645;

/// Reports a surface whose nodes are too far apart, and adds its misfit at the contours to the expected error.
pub(super) fn account_for_coarse_nodes(
    subdivision: &Subdivision,
    groups: &Groups,
    working: &WorkingGrids,
    params: &SurfaceParams,
    chosen: Option<&mut Chosen>,
) -> Option<Finding> {
    let coarser = |extent: &MapExtent<'_>| coarser_than_asked(extent, params.spline.wanted, &params.tuning.spline.grid);
    let of_groups = groups.extents(subdivision, coarser).into_iter().flatten();
    let [asked, least] = of_groups.max_by(|[a, b], [c, d]| (b / a).total_cmp(&(d / c)))?;
    let misfit = misfit(subdivision, working);
    if let Some(implied) = chosen.and_then(|chosen| chosen.implied.as_mut()) {
        let Accuracy { rmse, le90, .. } = *implied;
        *implied = Accuracy { rmse: rmse.hypot(misfit), le90: le90.hypot(WITHIN_90 * misfit), ..*implied };
    }
    let message = format!(
        "the nodes of the smooth surface are {least:.1} m apart, and the contours ask for {asked:.1} m: the map is too wide for \
         its number of vertices. The surface misses the contours by {misfit:.2} m (RMS). Set the border of the map with \
         --frame, or make parts of it with --extent"
    );
    Some(Finding::general(FindingKind::CoarseNodes, message))
}

/// The root mean square of the differences between the surface and the contours, metres.
fn misfit(subdivision: &Subdivision, working: &WorkingGrids) -> f64 {
    let contours = &subdivision.map.contours;
    let step = subdivision.map.vertex_count().div_ceil(PLACES).max(1);
    let places = contours.iter().flat_map(|line| line.points.iter().map(|p| (*p, line.elevation))).step_by(step);
    let squares =
        places.map(|(p, level)| (f64::from(working.at(p)) - level).powi(2)).filter(|square| square.is_finite());
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}
