//! Levels that differ by less than a millimetre: rounding made several of one.

use super::levels::distinct_levels;
use super::map::ContourMap;
use crate::base::ElevationUnit;
use crate::base::decimal::shortest_between;
use crate::base::error::{Finding, FindingKind};

/// Levels that differ by no more are one, metres. A micrometre more for rounding.
const SAME: f64 = 1.001e-3;
/// They are one only if all others are further away than this many times their difference.
const APART: f64 = 100.0;

/// Gives levels that differ by less than a millimetre the one elevation among them that has the fewest decimals in `unit`,
/// the unit that they had. The levels are in metres. What was done is a finding.
///
/// Levels of a map whose interval is as small are left as they are.
pub fn unite_levels(map: &mut ContourMap, unit: ElevationUnit) -> Option<Finding> {
    let levels = distinct_levels(&map.contours);
    let groups = groups(&levels);
    if groups.is_empty() {
        return None;
    }
    let united: Vec<([f64; 2], f64)> = groups
        .into_iter()
        .map(|[low, high]| {
            let level = unit.metres(shortest_between(unit.about(low), unit.about(high)));
            ([low, high], if (low..=high).contains(&level) { level } else { low })
        })
        .collect();
    let mut count = 0;
    let mut widest = 0.0_f64;
    for line in &mut map.contours {
        let k = united.partition_point(|([_, high], _)| *high < line.elevation);
        let Some(([low, high], level)) = united.get(k).filter(|([low, _], _)| *low <= line.elevation) else { continue };
        widest = widest.max(high - low);
        count += usize::from(line.elevation != *level);
        line.elevation = *level;
    }
    let message = format!(
        "{} levels came with elevations that differ by up to {widest:.1e} m; each was taken as one level, for {count} contours",
        united.len()
    );
    Some(Finding::general(FindingKind::SameLevel, message).of_elevations(united.iter().map(|(_, level)| *level)))
}

/// The lowest and highest of levels that are one; ascending.
fn groups(levels: &[f64]) -> Vec<[f64; 2]> {
    let mut groups = Vec::new();
    let mut from = 0;
    while from < levels.len() {
        let to = from + levels[from..].partition_point(|z| z - levels[from] <= SAME);
        let [low, high] = [levels[from], levels[to - 1]];
        let reach = APART * (high - low);
        let is_alone =
            (from == 0 || low - levels[from - 1] >= reach) && levels.get(to).is_none_or(|z| z - high >= reach);
        if high > low && is_alone {
            groups.push([low, high]);
        }
        from = to;
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Contour;

    fn united(levels: &[f64], unit: ElevationUnit) -> (Vec<f64>, bool) {
        let line = |&z: &f64| Contour { elevation: unit.metres(z), points: Vec::new(), feature: 0.into() };
        let mut map = ContourMap { contours: levels.iter().map(line).collect(), ..ContourMap::default() };
        let told = unite_levels(&mut map, unit).is_some();
        (map.contours.iter().map(|line| unit.from_metres(line.elevation)).collect(), told)
    }

    #[test]
    fn rounding_makes_no_levels() {
        let halves = [100.000_001_5, 99.999_998_5, 105.0, 110.000_3, 110.000_9, 109.999_9];
        for unit in ElevationUnit::ALL {
            assert_eq!(united(&halves, unit), (vec![100.0, 100.0, 105.0, 110.0, 110.0, 110.0], true), "{unit:?}");
        }
        // Elevations in single precision.
        let single = [f64::from(12.192_f32), 12.192, f64::from(100.1_f32), 100.1];
        assert_eq!(united(&single, ElevationUnit::Metre).0, [12.192, 12.192, 100.1, 100.1]);
    }

    #[test]
    fn real_levels_stay() {
        for levels in
            [&[100.0, 105.0, 110.0][..], &[12.19, 12.192, 12.5], &[0.0, 0.001, 0.002, 0.003], &[0.0, 0.000_5, 0.02]]
        {
            assert_eq!(united(levels, ElevationUnit::Metre), (levels.to_vec(), false));
        }
        assert_eq!(united(&[], ElevationUnit::Metre), (vec![], false));
    }
}
