//! Elevations that are texts: `100,0`, `1 250`, `100 m`, `EL. 100`, full-width digits.
//!
//! A text is read where it is certain. Whether a comma stands before decimals or between thousands shows only in the whole
//! column; if not even there, it is an error.

use crate::attributes::{is_depth_name, is_elevation_name, is_open_name};
use crate::table::{Table, Value};
use crate::unit_words::LengthWord;
use tokosen_core::base::error::{Error, Result};

/// Words before a number that say that it is an elevation, in lower case.
const PREFIXES: &[&str] = &[
    "elevation",
    "elev",
    "el",
    "ele",
    "height",
    "hgt",
    "ht",
    "h",
    "z",
    "altitude",
    "alt",
    "cote",
    "cota",
    "quota",
    "kote",
    "kota",
    "höhe",
    "hoehe",
    "標高",
    "高さ",
    "高程",
];
/// Words behind a unit that say that it is an elevation, in lower case, without dots and spaces.
const SUFFIXES: &[&str] = &[
    "abovesealevel",
    "asl",
    "amsl",
    "msl",
    "ünn",
    "nn",
    "nhn",
    "ünhn",
    "üm",
    "üdm",
    "üadria",
    "snm",
    "slm",
    "nm",
    "npm",
    "npt",
];
/// Larger numbers are no elevations on land, metres or feet. A comma before them is one before decimals.
const MOST: f64 = 30_000.0;

/// Turns the texts of fields that may hold elevations into numbers, as far as they are certain. Others stay texts. A field
/// whose texts are all plain numbers stays as it is.
///
/// # Errors
/// If a comma in a field may stand before decimals or between thousands.
pub(super) fn read_texts(table: &mut Table, named: Option<&str>) -> Result<()> {
    let is_named = |name: &str| named.is_some_and(|named| named.to_lowercase() == name.to_lowercase());
    let may_be = |name: &str| is_elevation_name(name) || is_open_name(name) || is_depth_name(name) || is_named(name);
    let fields: Vec<usize> = (0..table.fields.len()).filter(|&field| may_be(&table.fields[field].name)).collect();
    for field in fields {
        let texts: Vec<&str> = table
            .features
            .iter()
            .flat_map(|feature| &feature.values)
            .filter_map(|(of, value)| match value {
                Value::Text(text) if *of == field && !text.trim().is_empty() => Some(text.as_str()),
                _ => None,
            })
            .collect();
        if texts.iter().all(|text| text.trim().parse::<f64>().is_ok()) {
            continue;
        }
        let style = Style::of(&texts).map_err(|example| {
            let name = &table.fields[field].name;
            Error::Data(format!(
                "the field {name:?} holds texts such as {example:?}, whose comma may stand before decimals or between \
                 thousands; turn it into a field of numbers"
            ))
        })?;
        for (of, value) in table.features.iter_mut().flat_map(|feature| &mut feature.values) {
            let Value::Text(text) = value else { continue };
            if *of == field
                && let Some(read) = style.value(text)
            {
                *value = read;
            }
        }
    }
    Ok(())
}

/// What the separators in the numbers of a column mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Style {
    /// A dot stands before decimals, a comma between thousands.
    Dot,
    /// A comma stands before decimals, a dot between thousands.
    Comma,
}

impl Style {
    /// The style of a column; otherwise an example of what may be either.
    fn of(texts: &[&str]) -> Result<Self, String> {
        let bodies: Vec<String> = texts.iter().filter_map(|text| peeled(text)).map(|(body, _)| body).collect();
        let readings = || bodies.iter().map(|body| (body, Self::Dot.number(body), Self::Comma.number(body)));
        let only_dot = readings().any(|(_, dot, comma)| dot.is_some() && comma.is_none());
        let only_comma = readings().any(|(_, dot, comma)| dot.is_none() && comma.is_some());
        let open = || readings().filter(|(_, dot, comma)| dot != comma && dot.is_some() && comma.is_some());
        match (only_dot, only_comma, open().next()) {
            (true, false, _) => return Ok(Self::Dot),
            (false, true, _) => return Ok(Self::Comma),
            (_, _, None) => return Ok(Self::Dot),
            // A dot before decimals is what programs write.
            (false, false, Some(_)) if open().all(|(body, ..)| !body.contains(',')) => return Ok(Self::Dot),
            _ => {}
        }
        let thousands = || open().filter_map(|(_, dot, _)| dot).map(f64::abs);
        let plain = || readings().filter(|(body, ..)| !body.contains(',')).filter_map(|(_, dot, _)| dot).map(f64::abs);
        if thousands().any(|z| z > MOST) {
            return Ok(Self::Comma);
        }
        // Numbers below 1000 without a comma, and numbers from 1000 on with one.
        let is_grouped = plain().next().is_some() && plain().all(|z| z < 1000.0) && thousands().all(|z| z >= 1000.0);
        match open().next() {
            Some((body, ..)) if !is_grouped => Err(body.clone()),
            _ => Ok(Self::Dot),
        }
    }

    /// The value of a text, if it is certain.
    fn value(self, text: &str) -> Option<Value> {
        let (body, unit) = peeled(text)?;
        let other = match self {
            Self::Dot => Self::Comma,
            Self::Comma => Self::Dot,
        };
        let number = self.number(&body).or_else(|| other.number(&body))?;
        Some(unit.map_or(Value::Number(number), |unit| Value::Measured(number, unit)))
    }

    /// The number that a text of digits and separators is.
    fn number(self, body: &str) -> Option<f64> {
        let (decimal, group) = match self {
            Self::Dot => ('.', ','),
            Self::Comma => (',', '.'),
        };
        let (sign, digits) = match body.strip_prefix('-') {
            Some(rest) => (-1.0, rest),
            None => (1.0, body.strip_prefix('+').unwrap_or(body)),
        };
        let (whole, decimals) = digits.split_once(decimal).unwrap_or((digits, "0"));
        let is_digits = |text: &str| text.chars().all(|c| c.is_ascii_digit());
        if !is_digits(decimals) {
            return None;
        }
        let separator = whole.chars().find(|c| !c.is_ascii_digit());
        if let Some(separator) = separator {
            let mut groups = whole.split(separator);
            let first = groups.next()?;
            let is_sound = [group, ' ', '\''].contains(&separator)
                && is_digits(first)
                && (1..=3).contains(&first.len())
                && !first.starts_with('0')
                && groups.all(|group| group.len() == 3 && is_digits(group));
            if !is_sound {
                return None;
            }
        }
        let plain: String = whole.chars().filter(char::is_ascii_digit).collect();
        if plain.is_empty() {
            return None;
        }
        format!("{plain}.{decimals}").trim_end_matches('.').parse::<f64>().ok().map(|z| sign * z)
    }
}

/// The digits and separators of a text, and the unit behind them. `None` if there is something else in the text.
fn peeled(text: &str) -> Option<(String, Option<LengthWord>)> {
    let text: String = text.trim().chars().map(narrow).collect::<String>().to_lowercase();
    let is_start = |c: char| c.is_ascii_digit() || "+-".contains(c);
    let bare = PREFIXES.iter().filter_map(|prefix| text.strip_prefix(prefix)).find_map(|rest| {
        let rest = rest.trim_start_matches(|c: char| c.is_whitespace() || ".:=".contains(c));
        rest.starts_with(is_start).then_some(rest)
    });
    let bare = bare.unwrap_or(&text);
    let end = bare.find(|c: char| !(c.is_ascii_digit() || "+-., '".contains(c))).unwrap_or(bare.len());
    let body = bare[..end].trim_end_matches(|c: char| !c.is_ascii_digit());
    if body.is_empty() {
        return None;
    }
    let rest = bare[body.len()..].trim();
    if rest.is_empty() {
        return Some((body.to_owned(), None));
    }
    if let Some(unit) = LengthWord::of_text(rest) {
        return Some((body.to_owned(), Some(unit)));
    }
    let flat: String = rest.chars().filter(|c| !c.is_whitespace() && *c != '.').collect();
    let unit = SUFFIXES.iter().find_map(|suffix| LengthWord::of_text(flat.strip_suffix(suffix)?))?;
    Some((body.to_owned(), Some(unit)))
}

/// A full-width digit or sign as the plain one, and any space and apostrophe as one kind.
fn narrow(c: char) -> char {
    match c {
        '０'..='９' | '，' | '．' | '＋' | '－' => char::from_u32(c as u32 - 0xfee0).unwrap_or(c),
        '\u{2212}' | '\u{2012}' | '\u{2013}' => '-',
        '\u{a0}' | '\u{2007}' | '\u{2009}' | '\u{202f}' | '\u{3000}' => ' ',
        '\u{2019}' | '\u{2032}' | '\u{b4}' => '\'',
        c => c,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number with its unit.
    type Reading = (f64, Option<LengthWord>);

    /// The numbers and units of a column; `None` for what stays a text.
    fn read(texts: &[&str]) -> Result<Vec<Option<Reading>>, String> {
        let style = Style::of(texts)?;
        let value = |text: &&str| match style.value(text)? {
            Value::Number(z) => Some((z, None)),
            Value::Measured(z, unit) => Some((z, Some(unit))),
            _ => None,
        };
        Ok(texts.iter().map(value).collect())
    }

    fn numbers(texts: &[&str]) -> Vec<f64> {
        read(texts).unwrap().into_iter().map(|value| value.map_or(f64::NAN, |(z, _)| z)).collect()
    }

    #[test]
    fn what_is_certain_is_read() {
        assert_eq!(numbers(&["100,0", "105,0", "1210,5"]), [100.0, 105.0, 1210.5]);
        assert_eq!(
            numbers(&["EL 100", "EL. 105", "el=110.5", "H:-3", "標高１２０"]),
            [100.0, 105.0, 110.5, -3.0, 120.0]
        );
        assert_eq!(
            numbers(&["1 250", "1'250", "1\u{a0}250,5", "+80", "\u{2212}4"]),
            [1250.0, 1250.0, 1250.5, 80.0, -4.0]
        );
        assert_eq!(numbers(&["1,234.5", "1,000", "980"]), [1234.5, 1000.0, 980.0]);
        assert_eq!(numbers(&["1.234,5", "1.000", "980"]), [1234.5, 1000.0, 980.0]);
        assert_eq!(numbers(&["100,000", "105,000"]), [100.0, 105.0]);
        assert_eq!(numbers(&["980", "1,000", "1,020"]), [980.0, 1000.0, 1020.0]);
        assert_eq!(numbers(&["1.000 m", "1.020 m"]), [1.0, 1.02]);
    }

    #[test]
    fn units_behind_numbers_are_read() {
        use LengthWord::{Foot, Metre};
        let all = ["100 m", "100m", "328 ft", "328'", "120 m ü. M.", "120 m a.s.l.", "130msnm", "140"];
        let units: Vec<_> = read(&all).unwrap().into_iter().map(|value| value.unwrap().1).collect();
        assert_eq!(
            units,
            [Some(Metre), Some(Metre), Some(Foot), Some(Foot), Some(Metre), Some(Metre), Some(Metre), None]
        );
    }

    #[test]
    fn what_is_not_certain_stays() {
        for text in
            ["index", "n/a", "100-120", "100 (index)", "about 100", "1,00,0", "12:30", "0x10", "1e2 m", "m", "", "-"]
        {
            assert_eq!(read(&[text]).unwrap(), [None], "{text}");
        }
        assert_eq!(read(&["1,000", "1,020"]).unwrap_err(), "1,000");
        assert!(read(&["1,000", "2,5", "1,234.5"]).is_err());
    }
}
