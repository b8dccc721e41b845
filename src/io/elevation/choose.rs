//! Chooses the attribute or coordinate that holds the elevations.

use super::{Item, SAME_ELEVATION, constant_z, value};
use crate::attributes::{is_depth_name, is_elevation_name, is_open_name};
use crate::table::{Field, Value};
use tokosen_core::base::error::{Error, Result, ZCoordinate};

/// The source of the elevations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ElevationSource {
    Field(usize),
    Z,
}

/// What the caller says about the elevations of a file.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Asked<'a> {
    /// The attribute that holds them.
    pub field: Option<&'a str>,
    /// Whether the named attribute, or else those with names of depths, hold depths.
    pub depths: bool,
}

/// Decides which attribute or coordinate holds the elevations of all items. An unclear choice is an error.
pub(super) fn choose(items: &[Item<'_>], fields: &[Field], asked: Asked<'_>) -> Result<ElevationSource> {
    let has_z = items.iter().any(|item| item.z.is_some());
    if let Some(named) = asked.field {
        return match find_field(fields, named) {
            Some(field) => Ok(ElevationSource::Field(field)),
            None if has_z && named.eq_ignore_ascii_case("z") => Ok(ElevationSource::Z),
            None => Err(Error::Data(format!("there is no field {named:?}; {}", field_list(fields)))),
        };
    }
    let z_is_set = items.iter().any(|item| item.z.is_some_and(|z| z != [0.0; 2]));
    let z_is_usable = z_is_set && items.iter().any(|item| constant_z(item).is_some());
    let z_is_per_line = z_is_usable && items.iter().all(|item| item.z.is_none() || constant_z(item).is_some());

    let with_numbers = |is_known: fn(&str) -> bool| {
        let mut candidates: Vec<(usize, usize)> = (0..fields.len())
            .filter(|&field| is_known(&fields[field].name))
            .map(|field| (count_heights(items, field), field))
            .filter(|&(count, _)| count > 0)
            .collect();
        candidates.sort_by_key(|&(count, field)| (std::cmp::Reverse(count), field));
        candidates
    };
    let mut candidates = if asked.depths { with_numbers(is_depth_name) } else { Vec::new() };
    if candidates.is_empty() {
        candidates = with_numbers(is_elevation_name);
    }
    if candidates.is_empty() && z_is_usable {
        return Ok(ElevationSource::Z);
    }
    if candidates.is_empty() {
        candidates = with_numbers(is_open_name);
    }
    let Some(&(_, best)) = candidates.first() else {
        let z = match (has_z, z_is_set) {
            (false, _) => ZCoordinate::Missing,
            (true, false) => ZCoordinate::Zero,
            (true, true) => ZCoordinate::Varies,
        };
        let depth = with_numbers(is_depth_name).first().map(|&(_, field)| {
            format!(
                "; {:?} seems to hold depths, which are read as negative elevations if asked for",
                fields[field].name
            )
        });
        let fields = format!("{}{}", field_list(fields), depth.unwrap_or_default());
        return Err(Error::NoElevationField { z, fields });
    };
    let doubt = |what: String, with_z: bool, feature: u64| {
        Err(Error::ElevationsDisagree { what, feature, with_z, fields: field_list(fields) })
    };
    // A number for no data contradicts nothing.
    let differ = |a: f64, b: f64| (a - b).abs() > SAME_ELEVATION && ![a, b].iter().any(|z| stands_for_no_data(*z));
    for item in items {
        let Some(elevation) = number(item, best) else { continue };
        for &(_, other) in &candidates[1..] {
            if let Some(rival) = number(item, other).filter(|&rival| differ(elevation, rival)) {
                let (a, b) = (&fields[best].name, &fields[other].name);
                return doubt(format!("the fields {a:?} ({elevation}) and {b:?} ({rival})"), false, item.feature);
            }
        }
        // If z varies, the lines were draped over a terrain. Then z is not the contour's elevation.
        if let Some(z) = constant_z(item).filter(|&z| z_is_per_line && differ(elevation, z)) {
            let a = &fields[best].name;
            return doubt(format!("the field {a:?} ({elevation}) and the z coordinate ({z})"), true, item.feature);
        }
    }
    Ok(ElevationSource::Field(best))
}

/// The value of a field if it is a finite number, or text that is a finite number.
pub(super) fn number(item: &Item<'_>, field: usize) -> Option<f64> {
    let number = match value(item, field) {
        Value::Null => None,
        Value::Number(number) | Value::Measured(number, _) => Some(*number),
        Value::Text(text) => text.trim().parse().ok(),
    };
    number.filter(|n| n.is_finite())
}

pub(super) fn count_numbers(items: &[Item<'_>], field: usize) -> usize {
    items.iter().filter(|item| number(item, field).is_some()).count()
}

/// Number of items with a number that may be an elevation.
fn count_heights(items: &[Item<'_>], field: usize) -> usize {
    items.iter().filter(|item| number(item, field).is_some_and(|z| !stands_for_no_data(z))).count()
}

/// Numbers that programs write for no data and that are no elevations in any unit.
const NO_DATA: [f64; 6] = [-9998.0, -9999.0, -32_767.0, -32_768.0, -99_999.0, -999_999.0];
/// Larger numbers are no elevations in any unit.
const ABSURD: f64 = 1e7;

/// Whether a number stands for no data, whatever its unit is.
pub(super) fn stands_for_no_data(z: f64) -> bool {
    NO_DATA.contains(&z) || z.abs() >= ABSURD
}

/// The field of exactly this name, otherwise of this name in another letter case.
pub(super) fn find_field(fields: &[Field], name: &str) -> Option<usize> {
    let lower = name.to_lowercase();
    let exact = fields.iter().position(|field| field.name == name);
    exact.or_else(|| fields.iter().position(|field| field.name.to_lowercase() == lower))
}

/// All fields, each with an example value, for messages.
fn field_list(fields: &[Field]) -> String {
    if fields.is_empty() {
        return "the file has no fields".to_owned();
    }
    let list: Vec<String> = fields
        .iter()
        .map(|field| match &field.example {
            Some(example) => format!("{} (such as {example})", field.name),
            None => format!("{} (always empty)", field.name),
        })
        .collect();
    format!("its fields are {}", list.join(", "))
}
