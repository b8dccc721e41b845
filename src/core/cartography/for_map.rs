//! Makes the contours of a layer those of a map.

use super::generalise::generalise;
use super::ground::Ground;
use super::kinds::Kinds;
use super::rules::{APART, MapScale};
use super::steep::thin;
use super::supplementary::{OfInput, SupplementaryCount, keep_supplementary};
use crate::contour::ContourLayer;

/// Without a scale, that of Japan's map with this interval is taken: 1:25 000 for contours every 10 m.
const SCALE_OF_METRE: f64 = 2500.0;

/// What a map shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapParams {
    /// The levels and their kinds.
    pub kinds: Kinds,
    /// Supplementary contours are drawn where the others are at least so far apart, metres. If `None`, 15 mm on the map, or 37.5
    /// times the interval without a scale.
    pub apart: Option<f64>,
    /// The scale of the map, if lines are to be simplified for one.
    pub scale: Option<MapScale>,
    /// What becomes of intermediate contours on steep slopes. Without a scale, all stay.
    pub steep: Steep,
}

/// What becomes of intermediate contours where lines would run together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steep {
    /// They stay.
    Keep,
    /// They are left out there.
    Thin,
}

impl MapParams {
    /// The distance from which on supplementary contours are drawn, metres.
    pub fn apart(&self) -> f64 {
        let usual = || APART / 1000.0 * SCALE_OF_METRE * self.kinds.unit.metres(self.kinds.interval.step);
        self.apart.unwrap_or_else(|| self.scale.map_or_else(usual, |scale| scale.metres(APART)))
    }
}

/// What became of the lines.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MapCount {
    /// Of supplementary contours.
    pub supplementary: SupplementaryCount,
    /// Number of rings that are too small for the scale.
    pub small_rings: usize,
    /// Length of the intermediate contours that were left out on steep slopes, metres.
    pub steep: f64,
}

/// Makes the contours of a layer, which are those of all levels of [`Kinds::levels`], those of a map:
///
/// 1. Each has its kind ([`Kinds::mark`]).
/// 2. For a scale, all lines are simplified together, also contours of the input, and small rings are left out.
/// 3. Intermediate contours are left out on steep slopes, if that is asked for.
/// 4. Supplementary contours are drawn where the ground needs them ([`keep_supplementary`]).
///
/// Vertices are left out and lines are cut at vertices; none moves. So lines that did not touch do not touch then.
pub fn for_map(layer: &mut ContourLayer, params: &MapParams, input: OfInput, ground: &Ground) -> MapCount {
    params.kinds.mark(layer, input);
    let mut count = MapCount::default();
    if let Some(scale) = params.scale {
        count.small_rings = generalise(&mut layer.lines, scale, ground);
        if params.steep == Steep::Thin {
            count.steep = thin(&mut layer.lines, scale, ground);
        }
    }
    count.supplementary = keep_supplementary(layer, params.apart(), input, ground);
    count
}
