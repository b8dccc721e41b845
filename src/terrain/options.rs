//! How a terrain is made: [`Options`].

use super::grid::{Cells, GridSpec};
use super::preparation::Preparation;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Reprojection;
use tokosen_core::drain::Drain;
use tokosen_core::surface::{SurfaceKind, Triangles, Uncertainty};
use tokosen_core::tuning::Tuning;

/// How the lines are prepared and the surface is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// What is done to the lines first.
    pub preparation: Preparation,
    /// How heights between contours are found.
    pub kind: SurfaceKind,
    /// The method's resolution parameter w: larger values give fewer ridge and canyon lines.
    pub resolution: f64,
    /// Tension of the smooth surface, chosen from the contours if `None`; see [`SplineParams`](tokosen_core::spline::SplineParams).
    pub tension: Option<f64>,
    /// Noise of the contours, 0 to 1, chosen from the contours if `None`; see [`SplineParams`](tokosen_core::spline::SplineParams).
    pub noise: Option<f64>,
    /// The level of the sea, metres. Ground that reaches down only to contours of this level is the sea.
    pub sea: Option<f64>,
    /// How far a stream is moved to agree with the contours, map units; see [`SurfaceParams::stream_tolerance`](tokosen_core::surface::SurfaceParams::stream_tolerance).
    pub stream_tolerance: Option<f64>,
    /// Distance from the surface at which a twentieth of its difference from the base is left, map units. If `None`: a
    /// multiple of the mean spacing of the contours. With 0 the base is not changed. See [`Input::set_base`](super::Input::set_base).
    pub base_fade: Option<f64>,
    /// Which pits get a way out. Sinks are given by [`Input::add`](super::Input::add).
    pub drain: Drain,
    /// The cells of the height map that will be asked for. If possible, the smooth surface has its nodes at their
    /// centres.
    pub grid: Option<GridSpec>,
    /// Which triangles the smooth surface gets: [`Triangles::Reference`] is enough for height maps, and quicker.
    pub triangles: Triangles,
    /// Whether standard errors are estimated, for [`Terrain::errors`](super::Terrain::errors) and for contours.
    pub uncertainty: Uncertainty,
    /// Memory that each step may take, bytes. A step that needs more fails. No limit if `None`.
    pub memory: Option<u64>,
    /// The tuned numbers; only to try other values.
    pub tuning: Tuning,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            preparation: Preparation::default(),
            kind: SurfaceKind::default(),
            resolution: 1.0,
            tension: None,
            noise: None,
            sea: None,
            stream_tolerance: None,
            base_fade: None,
            drain: Drain::default(),
            grid: None,
            triangles: Triangles::default(),
            uncertainty: Uncertainty::default(),
            memory: None,
            tuning: Tuning::default(),
        }
    }
}

impl Options {
    /// Checks what no step checks.
    pub(super) fn check(&self) -> Result<()> {
        match self.base_fade.filter(|fade| !(fade.is_finite() && *fade >= 0.0)) {
            Some(fade) => Err(Error::out_of_range("distance of the base's fade", fade, "0 or more")),
            None => Ok(()),
        }
    }

    /// The cells that are wanted, over contours with this reprojection.
    pub(super) fn cells(&self, reprojection: &Reprojection) -> Result<Option<Cells>> {
        self.grid.as_ref().map(|grid| grid.over(reprojection)).transpose()
    }
}
