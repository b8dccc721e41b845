//! Makes the contours of a layer those of a map.

use super::ground::Ground;
use super::kinds::Kinds;
use super::supplementary::{OfInput, SupplementaryCount, keep_supplementary};
use crate::contour::ContourLayer;

/// Supplementary contours are drawn where the others are farther apart than this, metres for each metre of the interval: 375 m for
/// contours every 10 m. On a map of 1:25 000, which has these in Japan, that is 15 mm. (Our own choice; no specification that
/// we know states a distance.)
const APART: f64 = 37.5;

/// What a map shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapParams {
    /// The levels and their kinds.
    pub kinds: Kinds,
    /// Supplementary contours are drawn where the others are at least so far apart, metres. If `None`, 37.5 times the interval.
    pub apart: Option<f64>,
}

impl MapParams {
    /// The distance from which on supplementary contours are drawn, metres.
    pub fn apart(&self) -> f64 {
        self.apart.unwrap_or_else(|| APART * self.kinds.unit.metres(self.kinds.interval.step))
    }
}

/// What became of the lines.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MapCount {
    /// Of supplementary contours.
    pub supplementary: SupplementaryCount,
}

/// Makes the contours of a layer, which are those of all levels of [`Kinds::levels`], those of a map: each has its kind, and
/// supplementary contours are drawn where the ground needs them ([`keep_supplementary`]).
pub fn for_map(layer: &mut ContourLayer, params: &MapParams, input: OfInput, ground: &Ground) -> MapCount {
    params.kinds.mark(layer, input);
    MapCount { supplementary: keep_supplementary(layer, params.apart(), input, ground) }
}
