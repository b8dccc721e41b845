//! What lies beside the contours of a map, for each of its tiles.

use std::collections::BTreeSet;

use geo::MultiPolygon;
use tokosen_core::base::FeatureId;
use tokosen_core::base::error::Finding;
use tokosen_core::features::Features;

use super::input::{drop_expected, explain_by_cliffs};

/// What a map has besides contours and spot heights, on the working plane.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Beside {
    /// Lakes, streams, and so on. The contours of coasts are among those of the map, and excluded parts are left out already.
    pub features: Features,
    /// The parts of the map that were left out. They may overlap.
    pub excluded: Vec<MultiPolygon<f64>>,
    /// The features of contours that end beside a cliff.
    pub at_cliffs: BTreeSet<FeatureId>,
}

impl Beside {
    /// Leaves out findings about ground that was left out, and explains those at cliffs, which reach so far, map units.
    pub fn explain(&self, findings: &mut Vec<Finding>, cliff_reach: f64) {
        drop_expected(findings, &self.excluded);
        explain_by_cliffs(findings, &self.features.cliffs, cliff_reach, &self.at_cliffs);
    }
}
