//! How the lines are prepared: [`Preparation`].

use tokosen_core::base::error::{Error, Result};
use tokosen_core::clean::CleanParams;
use tokosen_core::resample::SampleParams;

/// How far a map is repaired.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Repair {
    /// Not at all: lines that must be cut or joined are an error.
    None,
    /// Only what cannot change the meaning: repeated points, duplicates, ends within the snap distance, crossing parts
    /// of lines.
    #[default]
    Safe,
    /// Also elevations, gaps and stray vertices, as the findings propose.
    All,
}

/// How the lines are prepared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preparation {
    /// Line ends of one elevation are joined up to this distance, units of the working coordinate reference system.
    pub snap: f64,
    /// How far the lines are repaired.
    pub repair: Repair,
    /// Whether an error or a warning about the input makes the preparation fail.
    pub strict: bool,
    /// Tolerance of a fit with smooth curves, units of the working coordinate reference system; no fit if `None`.
    pub fit: Option<f64>,
    /// Vertices are added until the distance between neighbours on a line is at most this many times the distance to
    /// the nearest other contour; none are added if `None`.
    pub sample: Option<f64>,
}

impl Default for Preparation {
    fn default() -> Self {
        Self { snap: 0.01, repair: Repair::Safe, strict: false, fit: None, sample: None }
    }
}

impl Preparation {
    /// Checks the parameters. Each step does so too; this is for callers that check before they read files.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the first parameter that is out of its range.
    pub fn check(&self) -> Result<()> {
        if !(self.snap.is_finite() && self.snap >= 0.0) {
            return Err(Error::out_of_range("snap distance", self.snap, "0 or more"));
        }
        if let Some(tolerance) = self.fit.filter(|t| !(t.is_finite() && *t > 0.0)) {
            return Err(Error::out_of_range("fitting tolerance", tolerance, "more than 0"));
        }
        if let Some(ratio) = self.sample.filter(|r| !(*r > 0.0 && *r < 1.0)) {
            return Err(Error::out_of_range("sampling ratio", ratio, "more than 0 and less than 1"));
        }
        Ok(())
    }

    pub(super) fn near(&self) -> CleanParams {
        CleanParams { snap: self.snap, ..CleanParams::default() }
    }

    pub(super) fn sampling(&self) -> Option<SampleParams> {
        self.sample.map(|ratio| SampleParams { ratio, ..SampleParams::default() })
    }
}
