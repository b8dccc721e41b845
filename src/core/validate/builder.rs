//! The builder that trials get their surfaces from. The caller of a trial hands it down.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::base::Grid;
use crate::skeleton::SkeletonLine;
use crate::spline::{Conditions, Wanted};
use crate::subdivision::Subdivision;
use crate::subdomains::Frame;
use crate::tuning::Tuning;

/// Builds the surfaces of trials, in the same way as the surface of the whole map.
pub trait SurfaceBuilder: Sync {
    /// Adds ridge and canyon lines, if the surface has any. `None` if they cannot be triangulated.
    fn with_lines(&self, subdivision: Subdivision) -> Option<(Subdivision, Vec<SkeletonLine>)>;

    /// The conditions of the smooth surface at the nodes of `grid`.
    fn conditions<'a>(
        &self,
        subdivision: &'a Subdivision,
        skeleton_lines: &[SkeletonLine],
        grid: &Grid,
    ) -> Conditions<'a>;
}

/// Parameters of trials that are the same for all of them.
#[derive(Clone, Copy)]
pub struct TrialParams<'a> {
    /// The frame of the whole map.
    pub frame: &'a Frame,
    /// The cells that heights are wanted on.
    pub wanted: Option<Wanted>,
    /// Builds the surfaces.
    pub builder: &'a dyn SurfaceBuilder,
    /// The tuned numbers, which are those of the surface of the whole map.
    pub tuning: &'a Tuning,
    /// Set by another thread as soon as nobody needs the trials any more. Those that have not begun are then left out.
    pub needless: Option<&'a AtomicBool>,
}

impl TrialParams<'_> {
    /// Whether nobody needs the trials any more.
    pub fn are_needless(&self) -> bool {
        self.needless.is_some_and(|needless| needless.load(Ordering::Relaxed))
    }
}
