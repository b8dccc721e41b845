//! Parameters of a surface.

use super::whole::Whole;
use crate::base::error::{Error, Result};
use crate::drain::Drain;
use crate::spline::SplineParams;
use crate::subdomains::Frame;
use crate::tuning::Tuning;

/// How heights between contours are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
pub enum SurfaceKind {
    /// Linear on the triangles between contours.
    Linear,
    /// Linear on the triangles between contours, ridge lines and canyon lines.
    Skeleton,
    /// Smooth: minimum curvature between the contours.
    #[default]
    Spline,
}

/// The triangles of a surface of [`SurfaceKind::Spline`]. [`slice`](fn@crate::slice::slice) and
/// [`mesh`](fn@crate::mesh::mesh) work on them; [`heights`](super::heights) uses the working grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Triangles {
    /// Triangles between contours, ridge lines and canyon lines, with the heights of [`SurfaceKind::Skeleton`]. They
    /// are enough for a height map, and quicker.
    Reference,
    /// Triangles of the smooth surface itself, with nodes of the working grid between the lines.
    #[default]
    Smooth,
}

/// Whether the expected error of the surface is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Uncertainty {
    /// No expected error.
    #[default]
    Unknown,
    /// The expected error is estimated from hidden levels: [`Surface::errors`](super::Surface::errors).
    Learnt,
}

impl SurfaceKind {
    /// The name of the kind: `linear`, `skeleton` or `spline`.
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
    /// The outer border of the surface.
    pub frame: Frame,
    /// The paper's resolution parameter w. A larger value gives fewer ridge and canyon lines.
    pub resolution: f64,
    /// How far a stream is moved to agree with the contours, map units. If `None`: a share of the mean spacing of the contours
    /// ([`StreamTuning::tolerance`](crate::tuning::StreamTuning::tolerance)).
    pub stream_tolerance: Option<f64>,
    /// Which pits get a way out. Only for [`SurfaceKind::Spline`].
    pub drain: Drain,
    /// Parameters of the smooth surface. Only for [`SurfaceKind::Spline`].
    pub spline: SplineParams,
    /// Figures of the whole map, if the map that is built is a part of one.
    pub whole: Option<Whole>,
    /// Which triangles are needed. Only for [`SurfaceKind::Spline`].
    pub triangles: Triangles,
    /// Whether the expected error is estimated.
    pub uncertainty: Uncertainty,
    /// Memory that the surface may take, bytes. A surface that needs more is an error. No limit if `None`.
    pub memory: Option<u64>,
    /// The tuned numbers. Change them only to try other values.
    pub tuning: Tuning,
}

impl Default for SurfaceParams {
    fn default() -> Self {
        Self {
            kind: SurfaceKind::default(),
            frame: Frame::default(),
            resolution: 1.0,
            stream_tolerance: None,
            drain: Drain::default(),
            spline: SplineParams::default(),
            whole: None,
            triangles: Triangles::default(),
            uncertainty: Uncertainty::default(),
            memory: None,
            tuning: Tuning::default(),
        }
    }
}

impl SurfaceParams {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for the first number that is out of its range, [`Error::Parameter`] for a tuned number.
    pub fn check(&self) -> Result<()> {
        if !self.resolution.is_finite() || self.resolution < 0.0 {
            return Err(Error::out_of_range("resolution parameter w", self.resolution, "0 or more"));
        }
        let numbers = [
            ("tension", self.spline.tension),
            ("noise of the contours", self.spline.noise),
            ("tolerance of streams", self.stream_tolerance),
        ];
        for (name, value) in numbers {
            if let Some(value) = value.filter(|v| !v.is_finite() || *v < 0.0) {
                return Err(Error::out_of_range(name, value, "0 or more"));
            }
        }
        self.tuning.validate().map_err(|e| Error::Parameter(e.to_string()))
    }
}
