//! Lines of almost no length or area: the rest of a digitising error or of a cut, too small to show ground.

use std::collections::HashSet;

use super::ends::At;
use super::shape::Shape;
use crate::base::error::{Finding, FindingKind};
use crate::base::{FeatureId, parallel};
use crate::contour::{Contour, ContourMap};

/// A line that extends no further than this share of the median distance between vertices is too short. Contours traced
/// on height maps have rings of three thousandths of that distance.
const SHORT: f64 = 1e-3;
/// A ring whose area is a smaller share of the square of its length has almost no area: it is a strip that is a million
/// times as long as wide.
const FLAT: f64 = 1e-6;

/// Finds these lines. Features in `reported` have another finding already.
pub(super) fn find(map: &ContourMap, shape: &Shape, ends: &[At], reported: &HashSet<FeatureId>) -> Vec<Finding> {
    parallel::flat_map(map.contours.len(), |i| {
        let line = &map.contours[i];
        let length = shape.lengths[i];
        // Lines without any length are left to cleaning. Pieces that others continue are parts of a line.
        let is_alone = ends[2 * i] == At::Nothing && ends[2 * i + 1] == At::Nothing;
        if reported.contains(&line.feature) || !(length > 0.0 && line.elevation.is_finite() && is_alone) {
            return None;
        }
        let name = format!("the contour {} m (feature {})", line.elevation, line.feature);
        let reach = shape.boxes[i].diagonal();
        let message = if reach < SHORT * shape.spacing {
            format!(
                "{name} is {length:.2e} map units long; the median distance between vertices is {:.3} map units",
                shape.spacing
            )
        } else if is_flat(line, length, shape.spacing) {
            format!("{name} is a ring of {length:.3} map units with almost no area")
        } else {
            return None;
        };
        let place = line
            .points
            .iter()
            .copied()
            .filter(|p| p.is_finite())
            .min_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        Some(Finding::new(FindingKind::ShortLine, place, message).about(line.feature, line.elevation))
    })
}

/// Whether a ring has almost no area. One that runs back on the same way has none at all, and is left to cleaning.
fn is_flat(line: &Contour, length: f64, spacing: f64) -> bool {
    if !line.is_closed() {
        return false;
    }
    let origin = line.points[0];
    let twice: f64 = line.points.windows(2).map(|w| (w[0] - origin).perp_dot(w[1] - origin)).sum();
    let area = 0.5 * twice.abs();
    area != 0.0 && area < FLAT * length * length && area < SHORT * spacing * length
}
