//! Elevations that are not real: 0, or the numbers that programs write for no data, far from all other levels.

use crate::base::error::{Finding, FindingKind};
use crate::check::placeholders::{lines, middle};
use crate::contour::{Contour, ContourMap};

/// One finding per line of such a level.
pub(super) fn find(map: &ContourMap) -> Vec<Finding> {
    let found = lines(map).into_iter().map(|placeholder| {
        let line = &map.contours[placeholder.line];
        let Contour { elevation, feature, .. } = line;
        let message = format!("the contour {elevation} m (feature {feature}): {}", placeholder.why);
        Finding::new(FindingKind::ZeroElevation, middle(line), message).about(*feature, *elevation)
    });
    found.collect()
}
