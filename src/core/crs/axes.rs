//! Whether x and y of a map look swapped.

use geo::{Distance, Geodesic, Point};
use glam::DVec2;

use super::system::Crs;
use super::transform::Transform;

/// A plane fits the ground where its scale differs from 1 by at most this. National systems do so in their countries.
const FITS: f64 = 0.005;
/// A plane whose scale differs from 1 by more than this was not made for the place.
const MISFITS: f64 = 0.015;
/// Length over which scale is measured, metres.
const LENGTH: f64 = 100.0;

/// Whether a place fits its system with x and y the other way round, and not as it is. x is east or longitude.
///
/// Degrees do so if the latitude lies beyond the pole. On a plane it is the scale that tells: it is near 1 in the country
/// that the plane was made for. Small planes, whose x and y are both small numbers, show nothing.
pub fn look_swapped(crs: &Crs, place: DVec2) -> bool {
    let swapped = DVec2::new(place.y, place.x);
    if crs.is_geographic() {
        return !crs.is_in_other_angles() && place.y.abs() > 90.0 && place.y.abs() <= 180.0 && swapped.y.abs() <= 90.0;
    }
    let Some(way) = crs.geographic().and_then(|degrees| Transform::between(crs, &degrees).ok()) else { return false };
    let unit = crs.length_unit().map_or(1.0, |unit| unit.metres);
    let misfit = |p: DVec2| misfit(&way, unit, p).unwrap_or(f64::INFINITY);
    misfit(place) > MISFITS && misfit(swapped) < FITS
}

/// The largest difference from 1 of a plane's scale at a place, along its two axes. `None` if the place does not exist.
fn misfit(way: &Transform, unit: f64, place: DVec2) -> Option<f64> {
    let from = way.forward(place)?;
    let scale = |axis: DVec2| {
        let to = way.forward(place + axis * LENGTH / unit)?;
        Some(LENGTH / Geodesic.distance(Point::new(from.x, from.y), Point::new(to.x, to.y)))
    };
    Some((scale(DVec2::X)? - 1.0).abs().max((scale(DVec2::Y)? - 1.0).abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swapped_places_of_many_systems_are_known() {
        // Places of New Zealand, Germany (UTM and a national zone), France, the state plane of Oregon in feet, Norway far from
        // the meridian of its zone, and degrees.
        for (code, x, y) in [
            (2193, 1_927_000.0, 5_584_000.0),
            (25832, 480_000.0, 5_400_000.0),
            (31467, 3_500_000.0, 5_600_000.0),
            (2154, 700_000.0, 6_600_000.0),
            (25833, 1_050_000.0, 7_850_000.0),
            (2269, 7_640_000.0, 680_000.0),
            (4326, 139.7, 35.6),
        ] {
            let (crs, place) = (Crs::from_epsg(code), DVec2::new(x, y));
            assert!(!look_swapped(&crs, place), "EPSG:{code}");
            assert!(look_swapped(&crs, DVec2::new(y, x)), "EPSG:{code}");
        }
    }

    #[test]
    fn planes_that_are_not_true_to_scale_or_small_show_nothing() {
        for (code, x, y) in
            [(3857, 15_500_000.0, 4_250_000.0), (3035, 4_321_000.0, 3_210_000.0), (6677, -12_000.0, -35_000.0)]
        {
            for place in [DVec2::new(x, y), DVec2::new(y, x)] {
                assert!(!look_swapped(&Crs::from_epsg(code), place), "EPSG:{code}");
            }
        }
        assert!(!look_swapped(&Crs::from_wkt("LOCAL_CS[\"site\"]"), DVec2::new(1.0, 5e6)));
    }
}
