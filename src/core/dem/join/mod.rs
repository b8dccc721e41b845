//! Fills the cells of a height map that have no height from another height map, without a step between the two.
//!
//! The difference between both is known along the border of the heights. It is carried outwards and added to the other
//! height map, as in the delta surface fill of Grohman, Kroenung and Strebeck ("Filling SRTM voids", Photogrammetric
//! Engineering and Remote Sensing 72, 2006). There the void has heights all around. Here the ground is open on one side,
//! so the difference fades with distance.
//!
//! The correction c solves ∇²c = c / L². At the border it is the difference; L is a third of the distance at which a
//! twentieth is left.

mod border;
mod carry;

use glam::DVec2;
use rayon::prelude::*;

use crate::raster::Dem;
use border::differences;
use carry::carry;

/// How two height maps fit each other along the border where they were joined.
#[derive(Debug, Clone, PartialEq)]
pub struct Join {
    /// Cells that have their height from the base.
    pub filled: usize,
    /// Cells at the border that have a height in both.
    pub border: usize,
    /// Median of the differences at the border, heights minus base, metres. NaN if there is no such cell.
    pub median: f64,
    /// The difference that is furthest from 0, metres. NaN if there is no such cell.
    pub largest: f64,
    /// Where that is: the centre of the cell.
    pub place: Option<DVec2>,
    /// Whether the base is likely to be in feet while the heights are in metres: then the differences are small.
    pub looks_like_feet: bool,
}

/// Fills the cells without a height from `base`, the heights of another height map at the same cells (NaN where it has
/// none). Cells with a height keep it.
///
/// `fade` is the distance, in cells in x and y, at which a twentieth of the difference at the border is left. With 0 the
/// base is not changed.
pub fn join(dem: &mut Dem, base: &[f32], fade: DVec2) -> Join {
    let known = differences(dem, base);
    let correction = (fade.min_element() > 0.0).then(|| carry(&dem.values, &known, dem.grid.cols, fade));
    let filled = dem.values.par_iter_mut().zip(base).enumerate().filter(|(_, (height, _))| height.is_nan());
    let filled = filled.map(|(k, (height, base))| {
        *height = correction.as_ref().map_or(*base, |correction| base + correction[k]);
        usize::from(!height.is_nan())
    });
    let filled = filled.sum();
    border::figures(dem, base, &known, filled)
}

#[cfg(test)]
mod tests;
