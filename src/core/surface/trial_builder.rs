//! Builds the surfaces of trials with hidden levels in the same way as the surface of the whole map.

use super::conditions::conditions;
use super::skeleton_lines::{finer, with_skeleton};
use crate::base::Grid;
use crate::skeleton::{SkeletonLine, skeleton};
use crate::spline::Conditions;
use crate::subdivision::Subdivision;
use crate::tin::TinInput;
use crate::tuning::SkeletonTuning;
use crate::validate::SurfaceBuilder;

/// Builds surfaces with ridge and canyon lines of this resolution, or without any.
pub struct TrialBuilder<'t> {
    /// The paper's resolution parameter w. `None`: no ridge and canyon lines.
    pub resolution: Option<f64>,
    /// The tuned numbers of the ridge and canyon lines.
    pub tuning: &'t SkeletonTuning,
}

impl SurfaceBuilder for TrialBuilder<'_> {
    fn with_lines(&self, mut subdivision: Subdivision) -> Option<(Subdivision, Vec<SkeletonLine>)> {
        let Some(resolution) = self.resolution else { return Some((subdivision, Vec::new())) };
        subdivision.input = TinInput::default();
        let skeleton = skeleton(&subdivision.tin, &subdivision.regions, resolution, self.tuning);
        let finer = finer(&subdivision, TinInput::default(), skeleton, &[], &[], self.tuning).ok()?;
        let (subdivision, skeleton_lines, _) = with_skeleton(subdivision, finer);
        Some((subdivision, skeleton_lines))
    }

    fn conditions<'a>(
        &self,
        subdivision: &'a Subdivision,
        skeleton_lines: &[SkeletonLine],
        grid: &Grid,
    ) -> Conditions<'a> {
        conditions(subdivision, skeleton_lines, &[], grid, (&[], 0.0))
    }
}
