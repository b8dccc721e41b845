//! Decides which value is the elevation of each line and point, for every format.
//!
//! The order is: the attribute that the user named; an attribute with a known elevation name; the z coordinate. If the
//! choice is not clear, the result is an error that lists the attributes. A wrong guess would give a wrong map without
//! any message.

mod unit_hint;

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DVec2, DVec3};

use super::attributes::{is_elevation_name, is_sigma_name};
use super::crs_finding::crs_finding;
use super::depression;
use super::table::{Field, Line, NO_GEOMETRY, Spot, Table, Value};
use crate::base::error::{Error, Finding, FindingKind, Report, Result, ZCoordinate};
use crate::contour::{Contour, ContourMap, SpotHeights};

/// Attributes are often rounded to centimetres. Elevations that differ by no more than this are equal, metres.
const SAME_ELEVATION: f64 = 0.01;

/// The source of the elevations.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ElevationSource {
    Field(usize),
    Z,
}

/// A line or point that needs an elevation.
struct Item<'a> {
    feature: u64,
    values: &'a [(usize, Value)],
    z: Option<[f64; 2]>,
}

/// The elevation of one item.
enum Outcome {
    Known(f64),
    /// There is no elevation, for this reason.
    Missing(String),
    /// The value is not a number, as described.
    Invalid(String),
}

/// The contours and spot heights of a table.
pub(super) fn contour_map(path: &Path, mut table: Table, named: Option<&str>) -> Result<Report<ContourMap>> {
    let mut findings = take_findings(&mut table);
    let mut items = Vec::new();
    for feature in &table.features {
        items.extend(feature.lines.iter().map(|line| item(feature.number, &feature.values, line.z)));
    }
    if items.is_empty() {
        return Err(Error::file(path, format!("there is no line in it{}", table.found_words())));
    }
    let source = choose(&items, &table.fields, named).map_err(|error| noted(error, &table).in_file(path))?;
    let unit_hint = unit_hint::hint(source, &items, &table.fields).or(table.unit_hint.clone());
    drop(items);

    let spots_before = findings.len();
    let spots = spots_beside_lines(&table, named, &mut findings);
    let spot_findings = findings.split_off(spots_before);

    let depressions = depression::marks(&table);
    let mut contours = Vec::new();
    let mut first_reason = None;
    let mut invalid = InvalidValues::default();
    for feature in table.features {
        for Line { points, z, .. } in feature.lines {
            match elevation(source, &table.fields, &item(feature.number, &feature.values, z)) {
                Outcome::Known(elevation) => {
                    invalid.known += 1;
                    let points = finite_points(points, feature.number, elevation, &mut findings);
                    if !points.is_empty() {
                        contours.push(Contour { elevation, points, feature: feature.number.into() });
                    }
                }
                Outcome::Missing(reason) => {
                    findings.push(left_out("line", feature.number, points.first(), &reason));
                    first_reason.get_or_insert(reason);
                }
                Outcome::Invalid(what) => {
                    findings.push(left_out("line", feature.number, points.first(), &what));
                    invalid.add(feature.number, what);
                }
            }
        }
    }
    invalid.check(path)?;
    if contours.is_empty() {
        let reason = first_reason.unwrap_or_else(|| "no vertex has finite coordinates".to_owned());
        return Err(Error::file(path, format!("no line has an elevation: {reason}")));
    }
    findings.extend(spot_findings);
    let map = ContourMap { contours, spots, depressions, crs: table.crs, unit_hint, ..ContourMap::default() };
    Ok(Report { value: map, findings })
}

/// The points of a table as spot heights.
pub(super) fn spot_heights(path: &Path, mut table: Table, named: Option<&str>) -> Result<Report<SpotHeights>> {
    let mut findings = take_findings(&mut table);
    let items = spot_items(&table);
    if items.is_empty() {
        return Err(Error::file(path, format!("there is no point in it{}", table.found_words())));
    }
    let source = choose(&items, &table.fields, named).map_err(|error| noted(error, &table).in_file(path))?;
    let unit_hint = unit_hint::hint(source, &items, &table.fields).or(table.unit_hint.clone());
    drop(items);
    let lines: usize = table.features.iter().map(|feature| feature.lines.len()).sum();
    if lines > 0 {
        findings.push(Finding::general(
            FindingKind::SkippedFeature,
            format!("{lines} lines left out: only points are wanted"),
        ));
    }
    let mut points = Vec::new();
    let mut sigmas = Vec::new();
    let mut invalid = InvalidValues::default();
    let sigma_field = table.fields.iter().position(|field| is_sigma_name(&field.name));
    for feature in &table.features {
        for spot in &feature.spots {
            let item = spot_item(feature.number, &feature.values, spot);
            let sigma = match sigma_field.map(|field| sigma(&item, field, &table.fields)) {
                None => None,
                Some(Ok(sigma)) => sigma,
                Some(Err(what)) => {
                    findings.push(left_out("point", feature.number, Some(&spot.place), &what));
                    continue;
                }
            };
            match elevation(source, &table.fields, &item) {
                Outcome::Known(height) => {
                    invalid.known += 1;
                    keep_spot(spot, height, &mut points, &mut findings);
                    sigmas.resize(points.len(), sigma);
                }
                Outcome::Missing(reason) => {
                    findings.push(left_out("point", feature.number, Some(&spot.place), &reason));
                }
                Outcome::Invalid(what) => {
                    findings.push(left_out("point", feature.number, Some(&spot.place), &what));
                    invalid.add(feature.number, what);
                }
            }
        }
    }
    invalid.check(path)?;
    if points.is_empty() {
        let reason = findings.last().map(|f| f.message.clone()).unwrap_or_default();
        return Err(Error::file(path, format!("no point has a height; {reason}")));
    }
    Ok(Report { value: SpotHeights { points, sigmas, crs: table.crs, unit_hint }, findings })
}

/// The height of each feature's polygons, by the feature's number. Features without a height are missing.
pub(super) fn polygon_heights(path: &Path, table: &Table, named: Option<&str>) -> Result<BTreeMap<u64, f64>> {
    let with_polygons = table.features.iter().filter(|feature| !feature.polygons.is_empty());
    heights_if_any(path, table, named, with_polygons.map(|f| item(f.number, &f.values, f.polygon_z)).collect())
}

/// The levels of lines and polygons of a coast, by the number of the feature. They are optional.
pub(super) fn coast_heights(path: &Path, table: &Table) -> Result<BTreeMap<u64, f64>> {
    let z = |f: &super::table::Feature| match (f.polygon_z, f.lines.first()) {
        (None, Some(line)) => line.z,
        (z, _) => z,
    };
    heights_if_any(path, table, None, table.features.iter().map(|f| item(f.number, &f.values, z(f))).collect())
}

/// The heights of features, where there are some. `named` is the attribute that the caller names.
fn heights_if_any(path: &Path, table: &Table, named: Option<&str>, items: Vec<Item<'_>>) -> Result<BTreeMap<u64, f64>> {
    let numbers =
        (0..table.fields.len()).any(|f| is_elevation_name(&table.fields[f].name) && count_numbers(&items, f) > 0);
    // If z varies, the outline was draped over a terrain. Then z is not the water level.
    let levels = items.iter().any(|item| item.z.is_some_and(|[lo, hi]| lo == hi && lo != 0.0));
    if named.is_none() && !numbers && !levels {
        let text = items.iter().flat_map(|item| item.values.iter().map(move |value| (item.feature, value)));
        let word = |value: &Value| matches!(value, Value::Text(text) if !text.trim().is_empty());
        return match text.into_iter().find(|(_, (_, value))| word(value)) {
            None => Ok(BTreeMap::new()),
            Some((feature, (field, value))) => {
                let name = &table.fields[*field].name;
                let message = format!("feature {feature}: the field {name:?} holds {value}, which is not a number");
                Err(Error::file(path, message))
            }
        };
    }
    let source = choose(&items, &table.fields, named).map_err(|error| noted(error, table).in_file(path))?;
    let mut heights = BTreeMap::new();
    for item in &items {
        match elevation(source, &table.fields, item) {
            Outcome::Known(height) => {
                heights.insert(item.feature, height);
            }
            Outcome::Missing(_) => {}
            Outcome::Invalid(what) => return Err(Error::file(path, format!("feature {}: {what}", item.feature))),
        }
    }
    Ok(heights)
}

/// The points of a contour file. They are optional: any problem with them is a finding, not an error.
fn spots_beside_lines(table: &Table, named: Option<&str>, findings: &mut Vec<Finding>) -> Vec<DVec3> {
    let items = spot_items(table);
    if items.is_empty() {
        return Vec::new();
    }
    // The user's name is meant for the lines; points may use another attribute.
    let named =
        named.filter(|named| find_field(&table.fields, named).is_some_and(|field| count_numbers(&items, field) > 0));
    let source = match choose(&items, &table.fields, named) {
        Ok(source) => source,
        Err(error) => {
            let message = format!("{} points left out: {error}", items.len());
            findings.push(Finding::general(FindingKind::SkippedFeature, message));
            return Vec::new();
        }
    };
    let mut spots = Vec::new();
    for feature in &table.features {
        for spot in &feature.spots {
            match elevation(source, &table.fields, &spot_item(feature.number, &feature.values, spot)) {
                Outcome::Known(height) => keep_spot(spot, height, &mut spots, findings),
                Outcome::Missing(reason) | Outcome::Invalid(reason) => {
                    findings.push(left_out("point", feature.number, Some(&spot.place), &reason));
                }
            }
        }
    }
    spots
}

/// Decides which attribute or coordinate holds the elevations of all items. An unclear choice is an error.
fn choose(items: &[Item<'_>], fields: &[Field], named: Option<&str>) -> Result<ElevationSource> {
    let has_z = items.iter().any(|item| item.z.is_some());
    if let Some(named) = named {
        return match find_field(fields, named) {
            Some(field) => Ok(ElevationSource::Field(field)),
            None if has_z && named.eq_ignore_ascii_case("z") => Ok(ElevationSource::Z),
            None => Err(Error::Data(format!("there is no field {named:?}; {}", field_list(fields)))),
        };
    }
    let z_is_set = items.iter().any(|item| item.z.is_some_and(|z| z != [0.0; 2]));
    let z_is_usable = z_is_set && items.iter().any(|item| constant_z(item).is_some());
    let z_is_per_line = z_is_usable && items.iter().all(|item| item.z.is_none() || constant_z(item).is_some());

    let mut candidates: Vec<(usize, usize)> = (0..fields.len())
        .filter(|&field| is_elevation_name(&fields[field].name))
        .map(|field| (count_numbers(items, field), field))
        .filter(|&(count, _)| count > 0)
        .collect();
    candidates.sort_by_key(|&(count, field)| (std::cmp::Reverse(count), field));
    let Some(&(_, best)) = candidates.first() else {
        if z_is_usable {
            return Ok(ElevationSource::Z);
        }
        let z = match (has_z, z_is_set) {
            (false, _) => ZCoordinate::Missing,
            (true, false) => ZCoordinate::Zero,
            (true, true) => ZCoordinate::Varies,
        };
        return Err(Error::NoElevationField { z, fields: field_list(fields) });
    };
    let doubt = |what: String, with_z: bool, feature: u64| {
        Err(Error::ElevationsDisagree { what, feature, with_z, fields: field_list(fields) })
    };
    let differ = |a: f64, b: f64| (a - b).abs() > SAME_ELEVATION;
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

/// The error of [`choose`] with what the reader of the file adds to a list of fields.
fn noted(error: Error, table: &Table) -> Error {
    let note = table.fields_note.as_deref().unwrap_or_default();
    match error {
        Error::NoElevationField { z, fields } => Error::NoElevationField { z, fields: fields + note },
        Error::Data(message) => Error::Data(message + note),
        other => other,
    }
}

/// The elevation of one item from the chosen source.
fn elevation(source: ElevationSource, fields: &[Field], item: &Item<'_>) -> Outcome {
    let checked = |z: f64, what: &str| match z.is_finite() {
        true => Outcome::Known(z),
        false => Outcome::Missing(format!("{what} is {z}")),
    };
    match source {
        ElevationSource::Z => match item.z {
            None => Outcome::Missing("it has no z".to_owned()),
            Some([lo, hi]) if lo == hi || lo.is_nan() => checked(lo, "its z"),
            Some([lo, hi]) => Outcome::Missing(format!("its z varies from {lo} to {hi}, so it is not a contour")),
        },
        ElevationSource::Field(index) => {
            let name = &fields[index].name;
            match value(item, index) {
                Value::Null => Outcome::Missing(format!("its field {name:?} is empty")),
                Value::Number(z) => checked(*z, &format!("its field {name:?}")),
                Value::Text(text) if text.trim().is_empty() => Outcome::Missing(format!("its field {name:?} is empty")),
                Value::Text(text) => match text.trim().parse() {
                    Ok(z) => checked(z, &format!("its field {name:?}")),
                    Err(_) => Outcome::Invalid(format!("the field {name:?} holds {text:?}, which is not a number")),
                },
            }
        }
    }
}

/// The standard error of an item; `None` if its field is empty. What is no standard error is an error.
fn sigma(item: &Item<'_>, field: usize, fields: &[Field]) -> Result<Option<f64>, String> {
    match (value(item, field), number(item, field)) {
        (Value::Null, _) => Ok(None),
        (Value::Text(text), _) if text.trim().is_empty() => Ok(None),
        (_, Some(sigma)) if sigma >= 0.0 => Ok(Some(sigma)),
        (value, _) => Err(format!("its field {:?} holds {value}, which is no standard error", fields[field].name)),
    }
}

fn item<'a>(feature: u64, values: &'a [(usize, Value)], z: Option<[f64; 2]>) -> Item<'a> {
    Item { feature, values, z }
}

fn spot_item<'a>(feature: u64, values: &'a [(usize, Value)], spot: &Spot) -> Item<'a> {
    item(feature, values, spot.z.map(|z| [z, z]))
}

fn spot_items(table: &Table) -> Vec<Item<'_>> {
    let features = table.features.iter();
    features.flat_map(|f| f.spots.iter().map(|spot| spot_item(f.number, &f.values, spot))).collect()
}

fn value<'a>(item: &Item<'a>, field: usize) -> &'a Value {
    item.values.iter().find(|(index, _)| *index == field).map_or(&Value::Null, |(_, value)| value)
}

/// The z coordinate of an item, if it is the same everywhere.
fn constant_z(item: &Item<'_>) -> Option<f64> {
    item.z.filter(|[lo, hi]| lo == hi).map(|[z, _]| z)
}

/// The value of a field if it is a finite number, or text that is a finite number.
fn number(item: &Item<'_>, field: usize) -> Option<f64> {
    let number = match value(item, field) {
        Value::Null => None,
        Value::Number(number) => Some(*number),
        Value::Text(text) => text.trim().parse().ok(),
    };
    number.filter(|n| n.is_finite())
}

fn count_numbers(items: &[Item<'_>], field: usize) -> usize {
    items.iter().filter(|item| number(item, field).is_some()).count()
}

/// The field of exactly this name, otherwise of this name in another letter case.
fn find_field(fields: &[Field], name: &str) -> Option<usize> {
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

/// Lines or points whose value is not a number. If more items have a number, these are left out. Otherwise the
/// attribute does not hold elevations, and that is an error.
#[derive(Default)]
struct InvalidValues {
    known: usize,
    invalid: usize,
    first: Option<(u64, String)>,
}

impl InvalidValues {
    fn add(&mut self, feature: u64, what: String) {
        self.invalid += 1;
        self.first.get_or_insert((feature, what));
    }

    fn check(self, path: &Path) -> Result<()> {
        match self.first {
            Some((feature, what)) if self.invalid >= self.known => {
                Err(Error::file(path, format!("feature {feature}: {what}")))
            }
            _ => Ok(()),
        }
    }
}

fn left_out(what: &str, feature: u64, place: Option<&DVec2>, why: &str) -> Finding {
    let place = place.copied().filter(|p| p.is_finite());
    let message = format!("{what} {feature} left out: {why}");
    Finding::new(FindingKind::MissingElevation, place, message).about(feature, f64::NAN)
}

fn keep_spot(spot: &Spot, height: f64, points: &mut Vec<DVec3>, findings: &mut Vec<Finding>) {
    if spot.place.is_finite() {
        points.push(spot.place.extend(height));
    } else {
        let message = "a point left out: its coordinates are not finite";
        findings.push(Finding::general(FindingKind::NonFinitePoint, message).of_elevations([height]));
    }
}

/// Removes points that are NaN or infinite, which no later step can handle.
fn finite_points(mut points: Vec<DVec2>, feature: u64, elevation: f64, findings: &mut Vec<Finding>) -> Vec<DVec2> {
    let before = points.len();
    points.retain(|p| p.is_finite());
    let lost = before - points.len();
    if lost > 0 {
        let message = format!("line {feature}: {lost} vertices left out, their coordinates are not finite");
        let finding = Finding::new(FindingKind::NonFinitePoint, points.first().copied(), message);
        findings.push(finding.about(feature, elevation));
    }
    points
}

/// The findings of the reader, and those that all formats share.
fn take_findings(table: &mut Table) -> Vec<Finding> {
    let mut findings = std::mem::take(&mut table.findings);
    let problem = table.crs_problem.take();
    let missing = || problem.unwrap_or_else(|| "the file does not name its coordinate reference system".to_owned());
    findings.extend(crs_finding(table.crs.as_ref(), missing));
    for (kind, count) in &table.left_out {
        let message = match kind.as_str() {
            NO_GEOMETRY => format!("{count} features without geometry left out"),
            kind => format!("{count} geometries of type {kind} left out: only lines and points are read"),
        };
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
    }
    findings
}

#[cfg(test)]
mod tests;
