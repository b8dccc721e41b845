//! Elevations as level numbers, and the usual ways to mistake one elevation for another.

use std::collections::HashMap;

use crate::contour::{ContourMap, Interval};

/// Largest distance from a level for an elevation that still counts as that level, as a share of the interval. Feet
/// converted to metres are rounded.
const ON_LEVEL: f64 = 0.025;

/// Levels further from the base than this many intervals are absurd.
const FARTHEST: f64 = 1e12;

/// Metres per foot.
pub const FOOT: f64 = 0.3048;

/// An elevation, given by level numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Label {
    /// The level of this number.
    On(i64),
    /// Between the level of this number and the next one.
    Within(i64),
}

/// The levels of a map: those of its interval, with the values that the map has for them.
#[derive(Debug, Clone)]
pub struct LevelGrid {
    interval: Interval,
    written: HashMap<i64, f64>,
}

impl LevelGrid {
    /// The levels of an interval. For a level that the map has, the value is the most frequent one in the map.
    pub fn new(map: &ContourMap, interval: &Interval) -> Self {
        let mut grid = Self { interval: *interval, written: HashMap::new() };
        let mut levels: Vec<f64> = map.contours.iter().map(|c| c.elevation).collect();
        levels.sort_unstable_by(f64::total_cmp);
        let mut most: HashMap<i64, usize> = HashMap::new();
        for same in levels.chunk_by(|a, b| a == b) {
            if let Label::On(k) = grid.label(same[0])
                && same.len() > most.get(&k).copied().unwrap_or(0)
            {
                most.insert(k, same.len());
                grid.written.insert(k, same[0]);
            }
        }
        grid
    }

    /// The level number of an elevation.
    pub fn label(&self, elevation: f64) -> Label {
        // Absurd elevations must differ from all others, and still allow counting up and down from them.
        let k = ((elevation - self.interval.base) / self.interval.step).clamp(-FARTHEST, FARTHEST);
        let nearest = k.round();
        let on_level = ON_LEVEL.max(self.interval.rounding / self.interval.step);
        if (k - nearest).abs() <= on_level { Label::On(nearest as i64) } else { Label::Within(k.floor() as i64) }
    }

    /// The elevation of level `k`, metres.
    pub fn elevation(&self, k: i64) -> f64 {
        self.written.get(&k).copied().unwrap_or_else(|| self.interval.level(k))
    }

    /// Height between levels, metres.
    pub fn step(&self) -> f64 {
        self.interval.step
    }
}

/// Whether `label` is `truth` in feet, or the other way round, to the rounding of `label`.
pub fn is_other_unit(label: f64, truth: f64) -> bool {
    let near = |other: f64| (label - other).abs() <= 0.51 && (label - other).abs() <= 2e-3 * label.abs();
    near(truth / FOOT) || near(truth * FOOT)
}

/// How much more plausible this wrong label is than any other, as a difference of negative logarithms: for two digits
/// swapped, one digit wrong, or another unit. By chance, one label in about thirty equals a level in another unit.
pub fn likeness(label: f64, truth: f64) -> f64 {
    if is_other_unit(label, truth) {
        return 3.0;
    }
    let digits = |z: f64| format!("{:.3}", z.abs()).into_bytes();
    let (a, b) = (digits(label), digits(truth));
    if a.len() != b.len() || (label < 0.0) != (truth < 0.0) {
        return 0.0;
    }
    let differ: Vec<usize> = (0..a.len()).filter(|&i| a[i] != b[i]).collect();
    match differ[..] {
        [_] => 0.5,
        [i, j] if a[i] == b[j] && a[j] == b[i] => 1.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_levels_or_lie_between() {
        let grid = LevelGrid::new(&ContourMap::default(), &Interval { step: 10.0, base: 5.0, rounding: 0.0 });
        assert_eq!(grid.label(25.0), Label::On(2));
        assert_eq!(grid.label(24.9), Label::On(2));
        assert_eq!(grid.label(23.0), Label::Within(1));
        assert_eq!(grid.label(-6.0), Label::Within(-2));
        assert_eq!(grid.elevation(3), 35.0);
    }

    #[test]
    fn mistakes_have_their_likeness() {
        assert_eq!(likeness(1230.0, 1320.0), 1.0);
        assert_eq!(likeness(1230.0, 1250.0), 0.5);
        assert_eq!(likeness(4035.4, 1230.0), 3.0);
        assert_eq!(likeness(1230.0, 1570.0), 0.0);
        assert!(is_other_unit(374.904, 1230.0) && !is_other_unit(0.0, 0.1));
    }
}
