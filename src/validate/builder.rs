//! How the trials get their surfaces: whoever asks for a trial hands down what builds them.

use crate::base::Grid;
use crate::skeleton::BreakLine;
use crate::spline::{Conditions, Wanted};
use crate::subdivision::Subdivision;
use crate::subdomains::Frame;
use crate::tuning::Tuning;

/// Builds the surfaces of trials, in the same way as that of the whole map.
pub trait SurfaceBuilder: Sync {
    /// Adds what the surface has beside the contours: ridge and canyon lines, if it has any. `None` if they cannot be
    /// triangulated.
    fn with_lines(&self, subdivision: Subdivision) -> Option<(Subdivision, Vec<BreakLine>)>;

    /// What the smooth surface has to meet at the nodes of `grid`, which lie in `triangles`.
    fn conditions<'a>(
        &self,
        subdivision: &'a Subdivision,
        break_lines: &[BreakLine],
        grid: &Grid,
        triangles: &[u32],
    ) -> Conditions<'a>;
}

/// What trials know of the surface that is asked for.
#[derive(Clone, Copy)]
pub struct TrialParams<'a> {
    /// The frame of the whole map.
    pub frame: &'a Frame,
    /// Where heights are wanted.
    pub wanted: Option<Wanted>,
    /// What builds the surfaces.
    pub builder: &'a dyn SurfaceBuilder,
    /// The tuned numbers, those of the whole map's surface.
    pub tuning: &'a Tuning,
}
