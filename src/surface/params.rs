//! What a surface is asked to be.

use crate::spline::SplineParams;
use crate::subdivision::Water;
use crate::subdomains::Frame;
use crate::tuning::Tuning;

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
/// [`mesh`](fn@crate::mesh::mesh) work on; [`heights`](super::heights) asks the working grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Triangles {
    /// Those of the contours and of the ridge and canyon lines, with the heights of [`SurfaceKind::Skeleton`]: enough
    /// for a height map, and quicker.
    Reference,
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
    /// It is learnt from hidden levels: [`Surface::errors`](super::Surface::errors).
    Learnt,
}

impl SurfaceKind {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Skeleton => "skeleton",
            Self::Spline => "spline",
        }
    }
}

/// Parameters of [`build`](super::build).
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
    /// Memory that may be taken, bytes: a surface that needs more is refused. No limit if `None`.
    pub memory: Option<u64>,
    /// The tuned numbers; only to try other values.
    pub tuning: Tuning,
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
            memory: None,
            tuning: Tuning::default(),
        }
    }
}
