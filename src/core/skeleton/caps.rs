//! Tops and bottoms: heights where only one level is known.

use glam::DVec2;

use crate::subdomains::{Band, Side};

/// A rounded top above (or hollow below) the last contour.
///
/// The slope outside the contour continues inwards and decreases to level ground at the widest point. At distance d
/// from the contour the rise is `g d (1 - d / 2D)`, with g the slope outside and D the largest distance. So the top is
/// never flat. A smooth bound keeps it inside the band: `r (1 - exp(-rise / r))`, with r a share of the band. Spot
/// heights inside scale the profile, which passes through them.
pub struct Cap {
    band: Band,
    side: Side,
    widest: f64,
    slope: f64,
    /// The rise that the profile stays below, metres.
    reach: f64,
    /// Position of each spot height, and the factor by which the profile must be scaled there.
    factors: Vec<(DVec2, f64)>,
}

impl Cap {
    /// The profile beyond one level of a sub-domain. `band` is the level and the next one on `side`, `widest` the
    /// largest distance to the contour, `slope` the slope outside. `share` is the share of the band that the profile
    /// does not exceed without spot heights. `spots` are position, height and distance to the contour.
    pub fn new(band: Band, side: Side, widest: f64, slope: f64, share: f64, spots: Vec<(DVec2, f64, f64)>) -> Self {
        let reach = share * (band.hi - band.lo);
        let mut cap = Self { band, side, widest, slope, reach, factors: Vec::new() };
        cap.factors = spots
            .into_iter()
            .filter_map(|(at, height, distance)| {
                let rise = cap.rise(distance);
                let wanted = if side == Side::Below { band.hi - height } else { height - band.lo };
                (rise > 0.0 && wanted > 0.0).then(|| (at, wanted / rise))
            })
            .collect();
        cap
    }

    /// Rise above the contour at a distance from it, before spot heights.
    fn rise(&self, distance: f64) -> f64 {
        let d = distance.min(self.widest);
        let free = self.slope * d * (1.0 - d / (2.0 * self.widest.max(f64::MIN_POSITIVE)));
        self.reach * (1.0 - (-free / self.reach).exp())
    }

    /// Height at a position whose distance to the contour is known; strictly inside the band.
    pub fn height(&self, at: DVec2, distance: f64) -> f64 {
        let (mut weights, mut sum) = (0.0, 0.0);
        for &(spot, factor) in &self.factors {
            let w = 1.0 / at.distance_squared(spot).max(1e-12);
            weights += w;
            sum += w * factor;
        }
        let factor = if weights > 0.0 { sum / weights } else { 1.0 };
        let rise = factor * self.rise(distance);
        let height = if self.side == Side::Below { self.band.hi - rise } else { self.band.lo + rise };
        self.band.strictly_inside(height)
    }
}
