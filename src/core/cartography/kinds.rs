//! The kinds of contours on a map, by their levels.

use super::supplementary::OfInput;
use crate::base::ElevationUnit;
use crate::base::error::{Error, Result};
use crate::contour::{ContourKind, ContourLayer, Interval, Target};

/// Levels are compared with this tolerance, as a share of the interval. It is far above the rounding of feet.
const ON_LEVEL: f64 = 1e-6;

/// Which level has which kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinds {
    /// The interval of index and intermediate contours, in `unit`.
    pub interval: Interval,
    /// The unit of the interval.
    pub unit: ElevationUnit,
    /// One contour of the interval in so many is an index contour; 0 for none.
    pub index_every: u32,
    /// Into how many parts supplementary contours divide the interval: 1 for none, 2 or 4.
    pub parts: u8,
}

impl Kinds {
    /// Of supplementary contours at these steps: half of the interval, or half and a quarter of it.
    ///
    /// # Errors
    /// Other steps.
    pub fn with_steps(self, steps: &[f64]) -> Result<Self> {
        let step = self.interval.step;
        let is = |asked: f64, parts: f64| (asked * parts - step).abs() <= ON_LEVEL * step;
        let parts = match *steps {
            [half] if is(half, 2.0) => 2,
            [half, quarter] if is(half, 2.0) && is(quarter, 4.0) => 4,
            _ => {
                let (half, quarter) = (step / 2.0, step / 4.0);
                return Err(Error::Parameter(format!(
                    "supplementary contours are at half of the interval, or at half and a quarter: {half} or {half},{quarter} for an interval of \
                     {step}"
                )));
            }
        };
        Ok(Self { parts, ..self })
    }

    /// The levels of all kinds.
    pub fn levels(&self) -> Target {
        let Interval { step, base, .. } = self.interval;
        Target::Interval { step: step / f64::from(self.parts), base }
    }

    /// The kind of a level, metres. Contours of the input may lie at other levels; they are intermediate ones.
    fn of(&self, level: f64) -> Option<ContourKind> {
        let steps = (self.unit.about(level) - self.interval.base) / self.interval.step;
        let is_whole = |steps: f64| (steps - steps.round()).abs() < ON_LEVEL;
        match () {
            () if self.index_every > 0 && is_whole(steps / f64::from(self.index_every)) => Some(ContourKind::Index),
            () if is_whole(steps) => Some(ContourKind::Intermediate),
            () if self.parts >= 2 && is_whole(2.0 * steps) => Some(ContourKind::Supplementary),
            () if self.parts >= 4 && is_whole(4.0 * steps) => Some(ContourKind::SupplementaryQuarter),
            () => None,
        }
    }

    /// Gives each line of a layer its kind, and the layer the name of the interval. Lines at other levels are intermediate ones,
    /// or left out.
    pub fn mark(&self, layer: &mut ContourLayer, input: OfInput) {
        layer.name = Target::from(self.interval).layer_name(self.unit);
        layer.lines.retain(|line| input == OfInput::Whole || self.of(line.elevation).is_some());
        for line in &mut layer.lines {
            let kind = self.of(line.elevation).unwrap_or(ContourKind::Intermediate);
            (line.kind, line.index) = (Some(kind), kind == ContourKind::Index);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(step: f64, unit: ElevationUnit) -> Kinds {
        Kinds { interval: Interval { step, base: 0.0, rounding: 0.0 }, unit, index_every: 5, parts: 1 }
    }

    #[test]
    fn levels_have_kinds() {
        let kinds = kinds(10.0, ElevationUnit::Metre).with_steps(&[5.0, 2.5]).unwrap();
        let names = [100.0, 110.0, -5.0, 2.5, 57.5, 50.0, 1.0].map(|z| kinds.of(z).map(ContourKind::name));
        let expected =
            ["index", "intermediate", "supplementary", "supplementary_quarter", "supplementary_quarter", "index"];
        assert_eq!(names[..6], expected.map(Some));
        assert_eq!(names[6], None);
        assert_eq!(kinds.levels(), Target::Interval { step: 2.5, base: 0.0 });
    }

    #[test]
    fn steps_are_half_and_a_quarter() {
        let metres = kinds(10.0, ElevationUnit::Metre);
        assert_eq!(metres.with_steps(&[5.0]).unwrap().parts, 2);
        for wrong in [&[10.0][..], &[4.0], &[2.5], &[2.5, 5.0], &[5.0, 2.5, 1.25], &[0.0], &[f64::NAN]] {
            let said = metres.with_steps(wrong).unwrap_err().to_string();
            assert!(said.contains("5 or 5,2.5"), "{wrong:?}: {said}");
        }
    }

    #[test]
    fn feet_are_no_different() {
        let unit = ElevationUnit::Foot;
        let kinds = kinds(20.0, unit).with_steps(&[10.0, 5.0]).unwrap();
        let levels = kinds.levels().levels(unit, 0.0, unit.metres(100.0)).unwrap();
        let count = |kind| levels.iter().filter(|level| kinds.of(**level) == Some(kind)).count();
        assert_eq!([ContourKind::Index, ContourKind::Intermediate].map(count), [2, 4]);
        assert_eq!([ContourKind::Supplementary, ContourKind::SupplementaryQuarter].map(count), [5, 10]);
    }
}
