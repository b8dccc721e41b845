//! Units of elevations. Inside they are metres; inputs and outputs may be in feet.

/// A unit that elevations may be in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
pub enum ElevationUnit {
    /// Metres.
    #[default]
    Metre,
    /// International feet, 0.3048 m.
    Foot,
    /// US survey feet, 1200/3937 m.
    UsSurveyFoot,
}

/// Texts write the size of a foot with different numbers of digits. The two feet differ by 6e-7 m.
const SAME_SIZE: f64 = 2.5e-7;

/// A decimal number of at most this many places comes back from metres exactly.
const MOST_DECIMALS: i32 = 9;

impl ElevationUnit {
    /// All units.
    pub const ALL: [Self; 3] = [Self::Metre, Self::Foot, Self::UsSurveyFoot];

    /// The unit of this size, metres. `None` if it is another one.
    pub fn of_size(metres: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| (unit.metres(1.0) - metres).abs() <= SAME_SIZE)
    }

    /// Its name in sentences, plural.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "metres",
            Self::Foot => "feet",
            Self::UsSurveyFoot => "US survey feet",
        }
    }

    /// Its sign behind numbers.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Foot => "ft",
            Self::UsSurveyFoot => "US ft",
        }
    }

    /// Whether it is a foot.
    pub fn is_foot(self) -> bool {
        self != Self::Metre
    }

    /// An elevation of this unit in metres. Numerator and denominator are exact, so 40 feet are the number 12.192.
    pub fn metres(self, elevation: f64) -> f64 {
        match self {
            Self::Metre => elevation,
            Self::Foot => elevation * 3048.0 / 10_000.0,
            Self::UsSurveyFoot => elevation * 1200.0 / 3937.0,
        }
    }

    /// An elevation in metres, in this unit, up to rounding. For many values; [`ElevationUnit::from_metres`] is exact.
    pub fn about(self, metres: f64) -> f64 {
        match self {
            Self::Metre => metres,
            Self::Foot => metres * 10_000.0 / 3048.0,
            Self::UsSurveyFoot => metres * 3937.0 / 1200.0,
        }
    }

    /// An elevation in metres, in this unit.
    ///
    /// It is the number that [`ElevationUnit::metres`] turns into `metres`. Several numbers may do so. Then it is the
    /// one with the fewest decimals, else the one of 32 bits. So numbers that people write, and numbers of 32 bits,
    /// come back bit for bit.
    pub fn from_metres(self, metres: f64) -> f64 {
        let about = self.about(metres);
        if self == Self::Metre || !about.is_finite() {
            return about;
        }
        let is_it = |number: &f64| self.metres(*number).to_bits() == metres.to_bits();
        let decimal = |places: i32| {
            let scale = 10f64.powi(places);
            (about * scale).round() / scale
        };
        let decimals = (0..=MOST_DECIMALS).map(decimal);
        decimals
            .chain([f64::from(about as f32), about, about.next_up(), about.next_down()])
            .find(is_it)
            .unwrap_or(about)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::ElevationUnit::{Foot, Metre, UsSurveyFoot};
    use super::*;

    #[test]
    fn feet_are_round_numbers_of_metres() {
        assert_eq!(Foot.metres(40.0), 12.192);
        assert_eq!(Foot.metres(1240.0), 377.952);
        assert_eq!(UsSurveyFoot.metres(3937.0), 1200.0);
        assert_eq!(Metre.metres(0.1), 0.1);
    }

    #[test]
    fn feet_come_back_bit_for_bit() {
        for unit in ElevationUnit::ALL {
            for tenth in -20_000_i32..300_000 {
                let feet = f64::from(tenth) / 10.0;
                assert_eq!(unit.from_metres(unit.metres(feet)).to_bits(), feet.to_bits(), "{unit:?} {feet}");
            }
            for whole in 0..60_000_i32 {
                let feet = f64::from(whole);
                assert_eq!(unit.from_metres(unit.metres(feet)).to_bits(), feet.to_bits(), "{unit:?} {feet}");
            }
        }
    }

    #[test]
    fn what_is_no_number_stays_none() {
        for unit in ElevationUnit::ALL {
            assert!(unit.from_metres(f64::NAN).is_nan());
            assert_eq!(unit.from_metres(f64::INFINITY), f64::INFINITY);
            assert_eq!(unit.from_metres(-0.0).to_bits(), (-0.0f64).to_bits());
            let _ = unit.from_metres(f64::MAX);
        }
    }

    #[test]
    fn sizes_of_texts_name_their_unit() {
        for (size, unit) in [
            (1.0, Some(Metre)),
            (0.3048, Some(Foot)),
            (0.304_800_609_601_219_2, Some(UsSurveyFoot)),
            (0.304_800_61, Some(UsSurveyFoot)),
            (0.304_800_6, Some(UsSurveyFoot)),
            (0.304_799_471_538_676_2, None),
            (0.01, None),
            (f64::NAN, None),
        ] {
            assert_eq!(ElevationUnit::of_size(size), unit, "{size}");
        }
    }

    proptest! {
        #![proptest_config(crate::draws::draws())]

        #[test]
        fn decimals_and_numbers_of_32_bits_come_back_bit_for_bit(
            digits in -9_000_000_000_i64..90_000_000_000,
            places in 0..=6,
            short in -2000.0..30_000.0f32,
        ) {
            let decimal = (digits as f64) / 10f64.powi(places);
            prop_assume!(decimal.abs() < 1e6);
            for unit in ElevationUnit::ALL {
                for feet in [decimal, f64::from(short)] {
                    prop_assert_eq!(unit.from_metres(unit.metres(feet)).to_bits(), feet.to_bits());
                }
            }
        }
    }
}
