//! The surface over a map: a triangulation with heights everywhere inside the frame.
//!
//! [`SurfaceKind::Linear`] is the constrained Delaunay triangulation of the contours as it stands: flat triangles on
//! ridges, in valleys and on tops. [`SurfaceKind::Skeleton`] is the paper's: ridge and canyon lines go into the
//! triangulation, so that no triangle with three corners on one level is left where the ground is not level.
//! [`SurfaceKind::Spline`] is smooth: a minimum-curvature surface on a working grid ([`spline`](crate::spline)).

mod build;
mod nodes;
mod parted;
mod sample;

pub use build::build;
pub(crate) use build::{finer, with_skeleton};
pub use sample::{heights, heights_on};

use glam::DVec2;

use crate::contour::{ContourMap, Interval};
use crate::skeleton::BreakLine;
use crate::spline::{SplineParams, WorkingGrid};
use crate::subdivision::Water;
use crate::subdomains::{Frame, FrameRing, Regions};
use crate::tin::Tin;
use crate::validate::{Chosen, ErrorField};

/// How heights between contours are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SurfaceKind {
    /// Linear on the triangulated contours.
    Linear,
    /// The triangulation with ridge and canyon lines.
    Skeleton,
    /// Smooth, of minimum curvature between the contours.
    #[default]
    Spline,
}

/// Which triangles a surface of [`SurfaceKind::Spline`] has. They are what [`slice`](fn@crate::slice::slice) and
/// [`mesh`](fn@crate::mesh::mesh) work on; [`heights`] asks the working grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Triangles {
    /// Those of the contours and of the ridge and canyon lines, with the heights of [`SurfaceKind::Skeleton`]: enough
    /// for a height map, and quicker.
    Guide,
    /// Of the smooth surface itself: with nodes of the working grid between the lines.
    #[default]
    Smooth,
}

/// Whether the expected error of the surface is found too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Uncertainty {
    /// It is not.
    #[default]
    Unknown,
    /// It is learnt from hidden levels: [`Surface::errors`].
    Learnt,
}

/// Parameters of [`build`].
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceParams {
    /// How heights between contours are found.
    pub kind: SurfaceKind,
    /// The outermost border.
    pub frame: Frame,
    /// The paper's resolution parameter w: more of it, fewer ridge and canyon lines.
    pub resolution: f64,
    /// Lakes and the sea.
    pub water: Water,
    /// How the smooth surface is drawn; for [`SurfaceKind::Spline`].
    pub spline: SplineParams,
    /// Which triangles are needed; for [`SurfaceKind::Spline`].
    pub triangles: Triangles,
    /// Whether the expected error is found.
    pub uncertainty: Uncertainty,
}

impl Default for SurfaceParams {
    fn default() -> Self {
        Self {
            kind: SurfaceKind::default(),
            frame: Frame::default(),
            resolution: 1.0,
            water: Water::default(),
            spline: SplineParams::default(),
            triangles: Triangles::default(),
            uncertainty: Uncertainty::default(),
        }
    }
}

/// Heights everywhere inside the frame.
#[derive(Debug, Clone)]
pub struct Surface {
    /// The map that the surface was built from, cut to the frame.
    pub map: ContourMap,
    /// The triangulation, contours among its edges, every vertex with a height.
    pub tin: Tin,
    /// The sub-domains of its triangles.
    pub regions: Regions,
    /// Pieces across gaps in contours: level and ends, higher ground on the right.
    pub bridges: Vec<(f64, [DVec2; 2])>,
    /// Ridge and canyon lines; empty for [`SurfaceKind::Linear`].
    pub break_lines: Vec<BreakLine>,
    /// The frame's outline.
    pub frame: FrameRing,
    /// The input's vertical interval.
    pub interval: Interval,
    /// The smooth surface; only for [`SurfaceKind::Spline`].
    pub working: Option<WorkingGrid>,
    /// How the smooth surface was drawn, and how far it may be off; only for [`SurfaceKind::Spline`].
    pub chosen: Option<Chosen>,
    /// The expected error, if it was asked for.
    pub errors: Option<ErrorField>,
}
