//! Unites levels that differ only by rounding.
//!
//! Computed elevations, for example from feet, can differ in their last digits although one level is meant. Between two
//! such levels there is no room: lines traced there would lie on the contours themselves.

use std::collections::HashMap;

use crate::contour::{Contour, distinct_levels};

/// Elevations that differ by no more than this are one level. In metres up to 1 m, above that as a share of the
/// elevation.
const SAME_LEVEL: f64 = 1e-9;

/// Gives one elevation to lines whose elevations differ only by rounding. It is the one written with the fewest digits,
/// which is the one that was meant.
pub(super) fn unite(lines: &mut [Contour]) {
    let levels = distinct_levels(lines);
    let is_same = |low: f64, high: f64| high - low <= SAME_LEVEL * high.abs().max(1.0);
    let mut meant: HashMap<u64, f64> = HashMap::new();
    let mut rest = &levels[..];
    while let Some(&lowest) = rest.first() {
        let (group, others) = rest.split_at(rest.partition_point(|&level| is_same(lowest, level)));
        rest = others;
        if group.len() < 2 {
            continue;
        }
        let shortest = group.iter().copied().min_by_key(|level| level.to_string().len()).unwrap_or(lowest);
        meant.extend(group.iter().map(|level| (level.to_bits(), shortest)));
    }
    if meant.is_empty() {
        return;
    }
    for line in lines {
        line.elevation = meant.get(&line.elevation.to_bits()).copied().unwrap_or(line.elevation);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn united(levels: &[f64]) -> Vec<f64> {
        let line = |&elevation: &f64| Contour { elevation, points: vec![DVec2::ZERO, DVec2::X], feature: 0.into() };
        let mut lines: Vec<Contour> = levels.iter().map(line).collect();
        unite(&mut lines);
        lines.iter().map(|line| line.elevation).collect()
    }

    #[test]
    fn what_differs_by_rounding_becomes_what_was_meant() {
        assert_eq!(united(&[304.8f64.next_up(), 30.0, 304.8]), [304.8, 30.0, 304.8]);
        assert_eq!(united(&[2.5e-222, 0.0, -1e-12]), [0.0; 3]);
    }

    #[test]
    fn what_differs_by_more_stays() {
        let levels = [0.0, 1e-6, 304.8, 304.800_001, -0.1, -0.2];
        assert_eq!(united(&levels), levels);
    }
}
