//! Compares depression marks of the input with the contours around.

use crate::base::error::{Finding, FindingKind};
use crate::contour::ContourMap;
use crate::subdomains::{Regions, ascends_right, signed_area};
use crate::tin::Tin;

/// Closed contours whose depression mark is wrong: marked with higher ground inside, or not marked with lower ground
/// inside. The marks have no other use. `tin` holds the map's contours before all other points.
pub(crate) fn contradicted_marks(map: &ContourMap, tin: &Tin, regions: &Regions) -> Vec<Finding> {
    if map.depressions.is_empty() {
        return Vec::new();
    }
    let right = ascends_right(map, tin, regions);
    let closed = map.contours.iter().zip(right).filter(|(contour, _)| contour.is_closed());
    closed
        .filter_map(|(contour, ascends_right)| {
            let is_marked = *map.depressions.get(&contour.feature)?;
            // A ring that runs counter-clockwise has its outside on the right.
            let is_lower_inside = (signed_area(&contour.points) > 0.0) == ascends_right;
            let (mark, ground) = match (is_marked, is_lower_inside) {
                (true, false) => ("is marked as a depression", "higher"),
                (false, true) => ("is not marked as a depression", "lower"),
                _ => return None,
            };
            let message = format!(
                "contour {} m (feature {}) {mark}, but the contours around it show {ground} ground inside",
                contour.elevation, contour.feature
            );
            let finding = Finding::at(FindingKind::DepressionMark, *contour.points.first()?, message);
            Some(finding.about(contour.feature, contour.elevation))
        })
        .collect()
}
