//! Elevations that no ground on land has. They come from a unit, a sign or a placeholder that nothing else shows.

use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::contour::{Contour, ContourMap, distinct_levels, find_interval};

/// The ground is nowhere higher, metres.
const HIGHEST: f64 = 9000.0;
/// Land is nowhere lower, metres.
const LOWEST: f64 = -500.0;
/// Contours of the sea bed go on from level to level: the next one above is no further away than this many intervals.
const NEXT: f64 = 3.0;
/// Most features that a finding names.
const NAMED: usize = 20;

/// What is to be said about the elevations of a map. Contours below the lowest land are those of a sea bed if contours go
/// on down to them from above.
pub(super) fn findings(map: &ContourMap) -> Vec<Finding> {
    let spots = || map.spots.iter().map(|spot| spot.z).chain(map.soft_spots.iter().map(|spot| spot.place.z));
    let levels = distinct_levels(&map.contours);
    let mut findings = Vec::new();
    let high = |z: f64| z.is_finite() && z > HIGHEST;
    if let Some(top) = levels.last().copied().into_iter().chain(spots()).filter(|z| high(*z)).reduce(f64::max) {
        let what = format!("above {HIGHEST} m, up to {top} m; no ground is so high");
        findings.push(about(map, &high, spots().filter(|z| high(*z)).count(), &what));
    }
    let low = |z: f64| z.is_finite() && z < LOWEST;
    let split = levels.partition_point(|z| low(*z));
    let goes_on = match (levels[..split].last(), levels.get(split)) {
        (Some(below), Some(above)) => {
            find_interval(&map.contours).is_some_and(|interval| above - below <= NEXT * interval.step)
        }
        (Some(_), None) => false,
        (None, _) => spots().filter(|z| low(*z)).count() == 0,
    };
    if let Some(bottom) = levels.first().copied().into_iter().chain(spots()).filter(|z| low(*z)).reduce(f64::min)
        && !goes_on
    {
        let what = format!("below {LOWEST} m, down to {bottom} m; no land is so low");
        findings.push(about(map, &low, spots().filter(|z| low(*z)).count(), &what));
    }
    findings
}

fn about(map: &ContourMap, is_meant: &dyn Fn(f64) -> bool, spots: usize, what: &str) -> Finding {
    let lines: Vec<&Contour> = map.contours.iter().filter(|line| is_meant(line.elevation)).collect();
    let message = format!(
        "{} contours and {spots} spot heights lie {what}: check their unit, or whether they are depths",
        lines.len()
    );
    let place = lines.first().and_then(|line| line.points.get(line.points.len() / 2)).copied();
    let finding = Finding::new(FindingKind::ImplausibleElevation, place, message);
    lines.iter().take(NAMED).fold(finding, |finding, line| finding.about(line.feature, line.elevation))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn told(levels: &[f64], spots: &[f64]) -> usize {
        let line = |&z: &f64| Contour { elevation: z, points: vec![glam::DVec2::ZERO; 2], feature: 0.into() };
        let spots = spots.iter().map(|z| DVec3::new(0.0, 0.0, *z)).collect();
        findings(&ContourMap { contours: levels.iter().map(line).collect(), spots, ..ContourMap::default() }).len()
    }

    #[test]
    fn heights_of_no_ground_are_told() {
        assert_eq!(told(&[8000.0, 8500.0, 8848.0], &[8849.0]), 0);
        assert_eq!(told(&[9500.0, 9540.0, 9580.0], &[]), 1);
        assert_eq!(told(&[100.0, 120.0], &[102_000.0]), 1);
        // In millimetres.
        assert_eq!(told(&[97_500.0, 100_000.0, 102_500.0], &[]), 1);
    }

    #[test]
    fn a_sea_bed_goes_on_from_level_to_level() {
        let steps: Vec<f64> = (-40..=4).map(|k| 100.0 * f64::from(k)).collect();
        assert_eq!(told(&steps, &[-4010.0]), 0);
        assert_eq!(told(&[-1200.0, 100.0, 120.0, 140.0], &[]), 1);
        assert_eq!(told(&[-1200.0, -1180.0], &[]), 1);
        assert_eq!(told(&[-430.0, -420.0], &[]), 0);
        assert_eq!(told(&[100.0, 120.0], &[-2000.0]), 1);
        assert_eq!(told(&[9500.0, 9600.0], &[-2000.0]), 2);
        assert_eq!(told(&[], &[]), 0);
    }
}
