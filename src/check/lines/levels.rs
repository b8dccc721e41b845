//! Elevations that are not real: 0, or the numbers that programs write for no data, far from all other levels.

use std::collections::BTreeMap;

use crate::base::error::{Finding, FindingKind};
use crate::contour::{Contour, ContourMap, ElevationUnit, find_interval};

/// Numbers that stand for no data, in the file's unit, without their sign.
const NO_DATA: &[f64] = &[0.0, 999.0, 9999.0, 99_999.0, 999_999.0, 32_767.0, 32_768.0, 65_535.0];
/// Elevations from here on, above or below zero, are not real, metres.
const HIGHEST: f64 = 100_000.0;
/// Such a level is doubtful if the next one is further away than this many intervals.
const APART: f64 = 3.0;

/// One finding per line of such a level, if these lines are fewer than the others.
pub(super) fn find(map: &ContourMap) -> Vec<Finding> {
    let mut counts: BTreeMap<u64, (f64, usize)> = BTreeMap::new();
    for z in map.contours.iter().map(|c| c.elevation + 0.0).filter(|z| z.is_finite()) {
        counts.entry(z.to_bits()).or_insert((z, 0)).1 += 1;
    }
    let (doubtful, others): (Vec<_>, Vec<_>) = counts.into_values().partition(|(z, _)| is_no_data(*z));
    if doubtful.is_empty() || others.is_empty() {
        return Vec::new();
    }
    let lines = |levels: &[(f64, usize)]| levels.iter().map(|l| l.1).sum::<usize>();
    if lines(&doubtful) >= lines(&others) {
        return Vec::new();
    }
    let plain: Vec<f64> = others.iter().map(|l| l.0).collect();
    // Levels without meaning must not influence the interval.
    let sound: Vec<Contour> =
        map.contours.iter().filter(|c| c.elevation.is_finite() && !is_no_data(c.elevation)).cloned().collect();
    let Some(step) = find_interval(&sound).map(|interval| interval.step) else { return Vec::new() };
    let nearest = |z: f64| plain.iter().copied().min_by(|a, b| (a - z).abs().total_cmp(&(b - z).abs()));
    let mut next: BTreeMap<u64, f64> = BTreeMap::new();
    for (z, _) in doubtful {
        if let Some(other) = nearest(z).filter(|other| (other - z).abs() > APART * step) {
            next.insert(z.to_bits(), other);
        }
    }
    let found = map.contours.iter().filter_map(|line| {
        let other = next.get(&(line.elevation + 0.0).to_bits())?;
        let Contour { elevation, feature, .. } = line;
        let message = format!(
            "the contour {elevation} m (feature {feature}) has no other level within {} m, the nearest is {other} m: it seems \
             to have no elevation",
            APART * step
        );
        let place = line.points.get(line.points.len() / 2).copied().filter(|p| p.is_finite());
        Some(Finding::new(FindingKind::ZeroElevation, place, message).about(*feature, *elevation))
    });
    found.collect()
}

fn is_no_data(z: f64) -> bool {
    let units = [ElevationUnit::Metre, ElevationUnit::Foot, ElevationUnit::UsSurveyFoot];
    z.is_finite() && (z.abs() >= HIGHEST || NO_DATA.iter().any(|n| units.iter().any(|u| u.metres(*n) == z.abs())))
}
