//! How dense the vertices are to be.

use crate::base::error::{Error, Result};

/// How dense the vertices are to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleParams {
    /// Largest distance from a vertex to its neighbours on the line, divided by the distance to the nearest other
    /// contour: more than 0, less than 1. The paper's s.
    pub ratio: f64,
    /// No segment is split into pieces shorter than this, map units. `None`: a sixteenth of `ratio` times the median
    /// distance from the map's vertices to other contours.
    pub least: Option<f64>,
    /// Largest number of added points. More are refused.
    pub most: usize,
}

impl Default for SampleParams {
    fn default() -> Self {
        Self { ratio: 0.5, least: None, most: 100_000_000 }
    }
}

impl SampleParams {
    pub(in crate::resample) fn check(&self) -> Result<()> {
        if !(self.ratio > 0.0 && self.ratio < 1.0) {
            return Err(Error::out_of_range("sampling ratio", self.ratio, "more than 0 and less than 1"));
        }
        match self.least {
            Some(least) if !(least.is_finite() && least > 0.0) => {
                Err(Error::out_of_range("shortest sampled piece", least, "more than 0"))
            }
            _ => Ok(()),
        }
    }
}
