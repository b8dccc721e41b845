//! Heights, lengths and areas in sentences, in the units that the reader's map is in.
//!
//! Inside, all of them are in metres. The steps write heights as a number and `m`, and lengths on the plane as a number and
//! `map units`; [`Units::message`] puts such sentences into the units of a map, with no more decimals than anybody measures.
//! Names in quotation marks stay as they are.

use super::ElevationUnit;
use super::ElevationUnit::{Foot, Metre};

/// The units that sentences use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub struct Units {
    /// The unit of heights.
    pub heights: ElevationUnit,
    /// The unit of lengths on the plane; `None` if nobody knows in which unit the plane is.
    pub plane: Option<ElevationUnit>,
}

/// Units for lengths from this many metres on.
const KILOMETRE: f64 = 1000.0;
/// Areas from this many square metres on are in square kilometres.
const LARGE_AREA: f64 = 1e5;
/// Numbers of heights have so many decimals at most. They are a tenth of a millimetre.
const DECIMALS: usize = 4;

impl Units {
    /// Metres for heights and on the plane.
    pub const METRES: Self = Self { heights: Metre, plane: Some(Metre) };

    /// Metres for heights, and a plane of which nobody knows the unit.
    pub const METRES_ON_ANY_PLANE: Self = Self { heights: Metre, plane: None };

    /// Heights and lengths in one unit.
    pub fn all(unit: ElevationUnit) -> Self {
        Self { heights: unit, plane: Some(unit) }
    }

    /// A height or a difference of heights, given in metres, without needless digits: `50 ft`.
    pub fn height(self, metres: f64) -> String {
        format!("{} {}", self.height_number(metres), sign(self.heights))
    }

    /// The number of [`Units::height`] alone.
    pub fn height_number(self, metres: f64) -> String {
        plain(self.heights.from_metres(metres), DECIMALS)
    }

    /// A height or a difference of heights, given in metres, with two significant digits.
    pub fn rough_height(self, metres: f64) -> String {
        format!("{} {}", rough(self.heights.about(metres)), sign(self.heights))
    }

    /// A length on the plane, given in metres: `12.3 m`, `461 km`, `1514 ft`.
    pub fn length(self, metres: f64) -> String {
        match self.plane {
            Some(unit) if unit.is_foot() => format!("{} ft", three_digits(unit.about(metres))),
            Some(_) if metres.abs() >= KILOMETRE => format!("{} km", three_digits(metres / KILOMETRE)),
            Some(_) => format!("{} m", three_digits(metres)),
            None => format!("{} map units", three_digits(metres)),
        }
    }

    /// An area on the plane, given in square metres: `250 m²`, `12.3 km²`, `5400 ft²`.
    pub fn area(self, square_metres: f64) -> String {
        match self.plane {
            Some(unit) if unit.is_foot() => format!("{} ft²", three_digits(unit.about(unit.about(square_metres)))),
            Some(_) if square_metres.abs() >= LARGE_AREA => {
                format!("{} km²", three_digits(square_metres / (KILOMETRE * KILOMETRE)))
            }
            Some(_) => format!("{} m²", three_digits(square_metres)),
            None => format!("{} square map units", three_digits(square_metres)),
        }
    }

    /// A sentence of a step in these units.
    pub fn message(self, message: &str) -> String {
        let mut changed = String::with_capacity(message.len());
        for (k, part) in message.split('"').enumerate() {
            if k > 0 {
                changed.push('"');
            }
            // Every second part is in quotation marks.
            changed.push_str(&if k % 2 == 0 { self.outside_quotes(part) } else { part.to_owned() });
        }
        changed
    }

    fn outside_quotes(self, text: &str) -> String {
        let mut changed = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
            // A number that is the end of a word is a part of a name.
            let before = rest[..start].trim_end_matches('-');
            let is_number =
                !before.ends_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '/' | ':'));
            let start = if is_number && rest[..start].ends_with('-') { start - 1 } else { start };
            let length = rest[start..].find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | 'e' | '-')));
            let end = length.map_or(rest.len(), |length| start + length);
            let (number, after) = (&rest[start..end], &rest[end..]);
            changed.push_str(&rest[..start]);
            rest = match is_number.then(|| self.quantity(number, after)).flatten() {
                Some((said, unit)) => {
                    changed.push_str(&said);
                    &after[unit.len()..]
                }
                None => {
                    changed.push_str(number);
                    after
                }
            };
        }
        changed.push_str(rest);
        changed
    }

    /// A number and its unit in these units, if a unit that is to be changed follows; and what that is.
    fn quantity(self, number: &str, after: &str) -> Option<(String, &'static str)> {
        let metres: f64 = number.parse().ok()?;
        let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let is_long = decimals > DECIMALS && !number.contains('e');
        let decimals = decimals.min(DECIMALS);
        let follows = |unit: &str| {
            let rest = after.strip_prefix(unit);
            rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        };
        let said = |unit: ElevationUnit, value: f64, power: &str| match unit {
            Metre if is_long => format!("{} m{power}", plain(metres, decimals)),
            Metre => format!("{number} m{power}"),
            _ if number.contains('e') => format!("{value:.1e} ft{power}"),
            _ => format!("{} ft{power}", plain(value, decimals)),
        };
        let plane = self.plane;
        if follows(" m") {
            let is_changed = self.heights.is_foot() || is_long;
            return is_changed.then(|| (said(self.heights, self.heights.from_metres(metres), ""), " m"));
        }
        if follows(" map units") {
            return plane.map(|unit| (said(unit, unit.from_metres(metres), ""), " map units"));
        }
        if follows(" ft") && is_long {
            return Some((format!("{} ft", plain(metres, decimals)), " ft"));
        }
        if follows(" square map units") {
            return plane.map(|unit| (said(unit, unit.about(unit.about(metres)), "²"), " square map units"));
        }
        None
    }
}

/// The sign of a unit. Sentences do not tell one foot from the other: they differ in the sixth digit.
fn sign(unit: ElevationUnit) -> &'static str {
    if unit.is_foot() { Foot.symbol() } else { Metre.symbol() }
}

/// A number with so many decimals at most, and without zeros at its end.
fn plain(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    match text {
        "-0" => "0".to_owned(),
        // So small a number needs all of its digits.
        "0" if value != 0.0 => value.to_string(),
        _ => text.to_owned(),
    }
}

/// A number with two significant digits.
fn rough(value: f64) -> String {
    let decimals = if value > 0.0 { (1.0 - value.log10().floor()).clamp(0.0, 6.0) as usize } else { 0 };
    format!("{value:.decimals$}")
}

/// A number with three significant digits, and with all of those before the point.
fn three_digits(value: f64) -> String {
    // An empty sum is -0.
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::ElevationUnit::UsSurveyFoot;

    const FEET: Units = Units { heights: UsSurveyFoot, plane: Some(Foot) };
    const UNKNOWN: Units = Units { heights: Metre, plane: None };

    #[test]
    fn heights_have_the_digits_that_people_wrote() {
        assert_eq!(FEET.height(UsSurveyFoot.metres(50.0)), "50 ft");
        assert_eq!(FEET.height(UsSurveyFoot.metres(-12.5)), "-12.5 ft");
        assert_eq!(
            [20.0, 0.1, 1_234.567_891, 1e-6].map(|z| Units::METRES.height(z)),
            ["20 m", "0.1 m", "1234.5679 m", "0.000001 m"]
        );
        assert_eq!([FEET.rough_height(0.75), Units::METRES.rough_height(0.75)], ["2.5 ft", "0.75 m"]);
        assert_eq!(Units::METRES.rough_height(0.0), "0 m");
    }

    #[test]
    fn lengths_and_areas_have_three_digits() {
        assert_eq!([12.345, 461_482.0, 0.0].map(|l| Units::METRES.length(l)), ["12.3 m", "461 km", "0 m"]);
        assert_eq!([12.345, 2.5e6, -0.0].map(|a| Units::METRES.area(a)), ["12.3 m²", "2.50 km²", "0 m²"]);
        assert_eq!([FEET.length(304.8), FEET.area(9.290_304)], ["1000 ft", "100 ft²"]);
        assert_eq!([UNKNOWN.length(3.0), UNKNOWN.area(3.0)], ["3.00 map units", "3.00 square map units"]);
    }

    #[test]
    fn sentences_are_in_the_units_of_the_map() {
        let said = |units: Units, text: &str| units.message(text);
        let text = "a gap of 3.048 map units in the contour 15.24003048006096 m (feature 3) was closed";
        assert_eq!(said(FEET, text), "a gap of 10 ft in the contour 50 ft (feature 3) was closed");
        let unknown = "a gap of 3.048 map units in the contour 15.24 m (feature 3) was closed";
        assert_eq!(said(UNKNOWN, text), unknown);
        let metric = "a gap of 3.048 m in the contour 15.24 m (feature 3) was closed";
        assert_eq!(said(Units::METRES, text), metric);
        // The plane may be in metres although heights are in feet.
        let mixed = Units { heights: UsSurveyFoot, plane: Some(Metre) };
        assert_eq!(said(mixed, text), "a gap of 3.048 m in the contour 50 ft (feature 3) was closed");
        assert_eq!(said(FEET, "they differ by up to 3.0e-6 m"), "they differ by up to 9.8e-6 ft");
        let long = "at 37.79994579185547 m, 0.00000012345 m and 1246.716705938243 ft, 2.5 ft, 1.25 m";
        let short = "at 37.7999 m, 0.00000012345 m and 1246.7167 ft, 2.5 ft, 1.25 m";
        assert_eq!([said(Units::METRES, long), said(UNKNOWN, long)], [short, short]);
        assert_eq!(said(FEET, "from -30.48006096012192 m; 9 square map units"), "from -100 ft; 97 ft²");
    }

    #[test]
    fn names_and_other_numbers_stay() {
        for text in [
            "the layer \"levels 5 m\" has 3 metres, 7 mm and EPSG:2274 m",
            "sheet5 m, a/5 m, a_5 m: 12 of 15",
            "",
            "5",
            "a quote \" alone",
        ] {
            assert_eq!(FEET.message(text), text);
        }
    }
}
