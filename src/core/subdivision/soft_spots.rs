//! Spot heights with a standard error, against the contours around them.

use super::subdivide::Subdivision;
use crate::base::error::{Finding, FindingKind};
use crate::clean::is_place;
use crate::contour::SoftSpot;
use crate::tin::NONE;

/// A height further outside its band than this many standard errors contradicts the contours.
const MOST_SIGMAS: f64 = 3.0;

impl Subdivision {
    /// The spot heights with a standard error that agree with the contours around them, in an order that does not depend
    /// on that of the input. The others are findings.
    pub(crate) fn agreeing_soft_spots(&self) -> (Vec<SoftSpot>, Vec<Finding>) {
        let key = |spot: &SoftSpot| [spot.place.x, spot.place.y, spot.place.z, spot.sigma];
        let mut spots = self.map.soft_spots.clone();
        spots.sort_by(|a, b| {
            key(a)
                .iter()
                .zip(key(b))
                .map(|(a, b)| a.total_cmp(&b))
                .find(|o| o.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let (mut used, mut findings) = (Vec::new(), Vec::new());
        let mut outside = 0;
        let mut near = 0;
        for spot in spots {
            let position = spot.place.truncate() - self.tin.origin;
            let triangle =
                if is_place(spot.place.truncate()) { self.tin.walk(near, position).unwrap_or(NONE) } else { NONE };
            let region = if triangle == NONE { None } else { self.regions.region(triangle) };
            let Some(region) = region else {
                outside += 1;
                continue;
            };
            near = triangle;
            let (band, z, sigma) = (region.band, spot.place.z, spot.sigma);
            let off = (band.lo - z).max(z - band.hi).max(0.0);
            if off > MOST_SIGMAS * sigma {
                let (lo, hi) = (band.lo, band.hi);
                let message = match region.water {
                    Some(level) => format!("spot height {z} m ± {sigma} m lies in water of {level} m; it is left out"),
                    None => {
                        format!(
                            "spot height {z} m ± {sigma} m lies between the levels {lo} m and {hi} m; it is left out"
                        )
                    }
                };
                let finding = Finding::at(FindingKind::SpotOutsideBand, spot.place.truncate(), message);
                findings.push(finding.of_elevations([z]));
            } else {
                used.push(spot);
            }
        }
        if outside > 0 {
            let message = format!("{outside} spot heights lie outside the frame");
            findings.push(Finding::general(FindingKind::SkippedFeature, message));
        }
        (used, findings)
    }
}
