//! The levels that an output layer is to have.

use super::levels::Interval;
use crate::base::ElevationUnit;
use crate::base::error::{Error, Result};

/// Largest number of levels per target.
const MOST_LEVELS: f64 = 1e6;

/// The levels of one output layer.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Target {
    /// Every level `base + k * step`, in metres or in the unit that the layers ask for.
    Interval {
        /// Distance between levels.
        step: f64,
        /// Offset of the levels.
        base: f64,
    },
    /// These elevations, likewise.
    Levels(Vec<f64>),
}

impl From<Interval> for Target {
    fn from(Interval { step, base, .. }: Interval) -> Self {
        Self::Interval { step, base }
    }
}

impl Target {
    /// The levels, which are in `unit`, from `lowest` to `highest`, ascending. All of these are in metres.
    ///
    /// # Errors
    /// When the step is not a positive number, a level is not finite, or there would be more than a million levels.
    pub fn levels(&self, unit: ElevationUnit, lowest: f64, highest: f64) -> Result<Vec<f64>> {
        let (lowest, highest, sign) = (unit.from_metres(lowest), unit.from_metres(highest), unit.symbol());
        let levels = match self {
            Self::Interval { step, base } => {
                if !(step.is_finite() && *step > 0.0 && base.is_finite()) {
                    return Err(Error::out_of_range("interval", *step, "more than 0"));
                }
                let (first, last) = (((lowest - base) / step).ceil(), ((highest - base) / step).floor());
                if last - first >= MOST_LEVELS {
                    return Err(Error::Parameter(format!(
                        "an interval of {step} {sign} gives {:.0} levels between {lowest} and {highest} {sign}: choose a \
                         larger one",
                        last - first
                    )));
                }
                let interval = Interval { step: *step, base: *base, rounding: 0.0 };
                (first as i64..=last as i64).map(|k| interval.level(k)).collect()
            }
            Self::Levels(levels) => {
                if let Some(bad) = levels.iter().find(|l| !l.is_finite()) {
                    return Err(Error::Parameter(format!("the level {bad} is not a number")));
                }
                let mut levels: Vec<f64> = levels.iter().copied().filter(|l| (lowest..=highest).contains(l)).collect();
                levels.sort_by(f64::total_cmp);
                levels.dedup();
                levels
            }
        };
        Ok(levels.into_iter().map(|level: f64| unit.metres(level)).collect())
    }

    /// Whether a height, metres, is one of the levels, which are in `unit`, up to rounding.
    pub fn has(&self, unit: ElevationUnit, height: f64) -> bool {
        match self {
            Self::Interval { step, base } => {
                Interval { step: *step, base: *base, rounding: 0.0 }.is_level(unit.from_metres(height))
            }
            Self::Levels(levels) => levels.iter().any(|&level| is_one(unit.metres(level), height)),
        }
    }

    /// The levels next to a height, below and above it, all in metres. One that the height itself is, up to rounding, does not
    /// count. Infinite beyond a list of levels.
    pub fn beside(&self, unit: ElevationUnit, height: f64) -> [f64; 2] {
        match self {
            Self::Interval { step, base } => {
                let (interval, height) =
                    (Interval { step: *step, base: *base, rounding: 0.0 }, unit.from_metres(height));
                [interval.next_below(height), interval.next_above(height)].map(|level| unit.metres(level))
            }
            Self::Levels(levels) => {
                let others = || levels.iter().map(|&level| unit.metres(level)).filter(|&level| !is_one(level, height));
                let below = others().filter(|&level| level < height).fold(f64::NEG_INFINITY, f64::max);
                [below, others().filter(|&level| level > height).fold(f64::INFINITY, f64::min)]
            }
        }
    }

    /// Whether this is an interval, in `unit`, that is larger than `interval` metres.
    pub fn is_coarser(&self, unit: ElevationUnit, interval: f64) -> bool {
        // Feet that became metres and back have rounding errors.
        matches!(self, Self::Interval { step, .. } if unit.metres(*step) > interval * (1.0 + 1e-9))
    }

    /// Whether a level is a whole multiple of `every` steps. For a list of levels, the step is the contour interval of the
    /// input, or what the caller takes for it.
    pub fn is_index(&self, interval: f64, unit: ElevationUnit, every: u32, level: f64) -> bool {
        let (step, base, level) = match self {
            Self::Interval { step, base } => (*step, *base, unit.about(level)),
            Self::Levels(_) => (interval, 0.0, level),
        };
        let steps = (level - base) / (step * f64::from(every));
        every > 0 && (steps - steps.round()).abs() < 1e-6
    }

    /// The name of the layer for levels in `unit`: `contours_2m`, `contours_2ft`, `contours_2usft`, or `contours` for a
    /// list of levels.
    pub fn layer_name(&self, unit: ElevationUnit) -> String {
        let unit = match unit {
            ElevationUnit::Metre => "m",
            ElevationUnit::Foot => "ft",
            ElevationUnit::UsSurveyFoot => "usft",
        };
        match self {
            Self::Interval { step, .. } => format!("contours_{step}{unit}"),
            Self::Levels(_) => "contours".into(),
        }
    }
}

/// Whether two elevations, metres, differ by rounding only.
fn is_one(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::ElevationUnit::Metre;

    #[test]
    fn levels_are_the_decimals_that_one_writes() {
        let target = Target::Interval { step: 0.1, base: 0.0 };
        assert_eq!(target.levels(Metre, 0.05, 0.45).unwrap(), [0.1, 0.2, 0.3, 0.4]);
        let target = Target::Interval { step: 4.0, base: 1.0 };
        assert_eq!(target.levels(Metre, -8.0, 9.0).unwrap(), [-7.0, -3.0, 1.0, 5.0, 9.0]);
        let tens = Target::Interval { step: 10.0, base: 0.0 };
        for unit in ElevationUnit::ALL {
            let feet = [unit.metres(70.0), unit.metres(80.0), unit.metres(90.0)];
            assert_eq!(tens.levels(unit, feet[0], feet[2]).unwrap(), feet, "{unit:?}");
        }
        assert_eq!(tens.layer_name(ElevationUnit::Foot), "contours_10ft");
        assert!(Target::Interval { step: 1e-6, base: 0.0 }.levels(Metre, 0.0, 10.0).is_err());
        assert!(Target::Interval { step: -1.0, base: 0.0 }.levels(Metre, 0.0, 10.0).is_err());
        assert_eq!(Target::Levels(vec![5.0, 1.0, 5.0, 99.0]).levels(Metre, 0.0, 10.0).unwrap(), [1.0, 5.0]);
    }

    #[test]
    fn a_height_lies_between_two_levels() {
        let feet = ElevationUnit::Foot;
        let tens = Target::Interval { step: 10.0, base: 0.0 };
        assert!(tens.has(feet, 3.048 * 7.0) && !tens.has(Metre, 25.0));
        assert_eq!(tens.beside(feet, 3.048 * 7.0).map(|z| (z / 0.3048).round()), [60.0, 80.0]);
        assert_eq!(tens.beside(Metre, 25.0), [20.0, 30.0]);
        let list = Target::Levels(vec![50.0, 10.0, 20.0]);
        assert!(list.has(Metre, 20.0_f64.next_up()) && !list.has(Metre, 30.0));
        assert_eq!(list.beside(Metre, 20.0_f64.next_up()), [10.0, 50.0]);
        assert_eq!(list.beside(Metre, 5.0), [f64::NEG_INFINITY, 10.0]);
        assert_eq!(list.beside(Metre, 50.0), [20.0, f64::INFINITY]);
    }
}
