//! Decides which value is the elevation of each line and point, for every format.
//!
//! The order is: the attribute that the user named; an attribute with a known elevation name; the z coordinate. If the
//! choice is not clear, the result is an error that lists the attributes. A wrong guess would give a wrong map without
//! any message.

mod choose;
mod depths;
mod outlines;
mod texts;
mod unit_hint;
mod units;

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DVec2, DVec3};

use self::choose::{Asked, ElevationSource, choose, count_numbers, find_field, number};
use self::depths::Sign;
use self::outlines::Outlines;
use self::texts::read_texts;
use self::units::{Group, Units};
use super::ReadOptions;
use super::attributes::{is_elevation_name, is_sigma_name, unit_in_name};
use super::crs_finding::crs_finding;
use super::depression;
use super::table::{Field, Line, NO_GEOMETRY, Spot, Table, Value};
use tokosen_core::base::decimal::shortest_between;
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::contour::{Contour, ContourMap, SpotHeights, StatedUnit};
use tokosen_core::crs::Crs;

/// Attributes are often rounded to centimetres. Elevations that differ by no more than this are equal, metres.
const SAME_ELEVATION: f64 = 0.01;

/// Heights along a line that differ by no more are one level: a millimetre up or down, and a micrometre for rounding.
const SAME_HEIGHT: f64 = 2.001e-3;

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
pub(super) fn contour_map(path: &Path, mut table: Table, options: &ReadOptions) -> Result<Report<ContourMap>> {
    let asked = Asked { field: options.elevation_field.as_deref(), depths: options.depths };
    let mut findings = file_findings(&mut table);
    read_texts(&mut table, asked.field).map_err(|error| error.in_file(path))?;
    let mut outlines = Outlines::find(&table);
    let items = outlines.first_items(&table);
    if items.is_empty() {
        let (found, why) = (table.found_words(), outlines.why_not());
        return Err(Error::file(path, format!("there is no line in it{found}{why}")));
    }
    let chosen = choose(&items, &table.fields, asked);
    let source = chosen.map_err(|error| outlines.without_elevations(&table, noted(error, &table)).in_file(path))?;
    outlines.judge(&table, |item| match elevation(source, &table.fields, item) {
        Outcome::Known(z) => Some(z),
        Outcome::Missing(_) | Outcome::Invalid(_) => None,
    });
    let items = outlines.items(&table);
    if items.is_empty() {
        let (found, why) = (table.found_words(), outlines.why_not());
        return Err(Error::file(path, format!("there is no line in it{found}{why}")));
    }
    let unit_hint = unit_hint::hint(source, &items, &table.fields).or(table.unit_hint.clone());
    let sign = Sign::of(source, &table.fields, asked, &items);
    findings.extend(outlines.findings());
    findings.extend(left_out_findings(&table));
    findings.extend(sign.finding.clone());

    let spots_before = findings.len();
    let spot_source = spot_source(&table, asked, &mut findings);
    let spot_items = spot_items(&table);
    let groups =
        [Some(Group { items: &items, source }), spot_source.map(|source| Group { items: &spot_items, source })];
    let units = Units::of(groups.into_iter().flatten(), &table.fields, options.unit);
    drop(items);
    drop(spot_items);
    let spots = match spot_source {
        Some(source) => spots_beside_lines(&table, source, asked, &units, &mut findings),
        None => Vec::new(),
    };
    let spot_findings = findings.split_off(spots_before);

    let depressions = depression::marks(&table);
    let mut contours = Vec::new();
    let mut first_reason = None;
    let mut invalid = InvalidValues::default();
    let mut uneven = Uneven::default();
    let statement = units.of_source(source, &table.fields);
    for feature in table.features {
        for Line { points, z, is_ring, .. } in feature.lines {
            if is_ring && !outlines.has(feature.number) {
                continue;
            }
            let item = item(feature.number, &feature.values, z);
            match units.in_map_unit(&statement, &item) {
                Outcome::Known(elevation) => {
                    let elevation = sign.of_height(elevation);
                    invalid.known += 1;
                    uneven.note(source, &item);
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
    findings.extend(uneven.finding());
    findings.extend(units.findings);
    findings.extend(spot_findings);
    let height_system = table.height_system.or_else(|| table.crs.as_ref().and_then(Crs::height_system));
    let (crs, plane_unit, stated_unit) = (table.crs, table.plane_unit, units.stated);
    let map = ContourMap {
        contours,
        spots,
        depressions,
        crs,
        height_system,
        plane_unit,
        unit_hint,
        stated_unit,
        ..ContourMap::default()
    };
    Ok(Report { value: map, findings })
}

/// The points of a table as spot heights.
pub(super) fn spot_heights(path: &Path, mut table: Table, options: &ReadOptions) -> Result<Report<SpotHeights>> {
    let asked = Asked { field: options.elevation_field.as_deref(), depths: options.depths };
    let mut findings = take_findings(&mut table);
    read_texts(&mut table, asked.field).map_err(|error| error.in_file(path))?;
    let items = spot_items(&table);
    if items.is_empty() {
        return Err(Error::file(path, format!("there is no point in it{}", table.found_words())));
    }
    let source = choose(&items, &table.fields, asked).map_err(|error| noted(error, &table).in_file(path))?;
    let unit_hint = unit_hint::hint(source, &items, &table.fields).or(table.unit_hint.clone());
    let sign = Sign::of(source, &table.fields, asked, &items);
    findings.extend(sign.finding.clone().filter(|_| !asked.depths));
    let mut units = Units::of([Group { items: &items, source }], &table.fields, options.unit);
    findings.append(&mut units.findings);
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
    let statement = units.of_source(source, &table.fields);
    let sigma_field = table.fields.iter().position(|field| is_sigma_name(&field.name));
    for feature in &table.features {
        for spot in &feature.spots {
            let item = spot_item(feature.number, &feature.values, spot);
            let sigma = match sigma_field.map(|field| sigma(&item, field, &table.fields)) {
                None => None,
                Some(Ok(sigma)) => sigma.map(|sigma| units.size_in_map_unit(&statement, &item, sigma)),
                Some(Err(what)) => {
                    findings.push(left_out("point", feature.number, Some(&spot.place), &what));
                    continue;
                }
            };
            match units.in_map_unit(&statement, &item) {
                Outcome::Known(height) => {
                    invalid.known += 1;
                    keep_spot(spot, sign.of_height(height), &mut points, &mut findings);
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
    let stated_unit = units.stated;
    Ok(Report { value: SpotHeights { points, sigmas, crs: table.crs, unit_hint, stated_unit }, findings })
}

/// Heights of features, by their number. Features without a height are missing.
#[derive(Default)]
pub(super) struct Heights {
    pub of: BTreeMap<u64, f64>,
    /// What the file states about their unit.
    pub stated_unit: Option<StatedUnit>,
    pub findings: Vec<Finding>,
}

/// The height of each feature's polygons.
pub(super) fn polygon_heights(path: &Path, table: &mut Table, options: &ReadOptions) -> Result<Heights> {
    read_texts(table, options.elevation_field.as_deref()).map_err(|error| error.in_file(path))?;
    let with_polygons = table.features.iter().filter(|feature| !feature.polygons.is_empty());
    let items = with_polygons.map(|f| item(f.number, &f.values, f.polygon_z)).collect();
    heights_if_any(path, table, options, items)
}

/// The levels of lines and polygons of a coast. They are optional.
pub(super) fn coast_heights(path: &Path, table: &mut Table, options: &ReadOptions) -> Result<Heights> {
    read_texts(table, None).map_err(|error| error.in_file(path))?;
    let z = |f: &super::table::Feature| match (f.polygon_z, f.lines.first()) {
        (None, Some(line)) => line.z,
        (z, _) => z,
    };
    let items = table.features.iter().map(|f| item(f.number, &f.values, z(f))).collect();
    heights_if_any(path, table, &ReadOptions { elevation_field: None, ..options.clone() }, items)
}

/// The heights of features, where there are some.
fn heights_if_any(path: &Path, table: &Table, options: &ReadOptions, items: Vec<Item<'_>>) -> Result<Heights> {
    let asked = Asked { field: options.elevation_field.as_deref(), depths: false };
    let numbers =
        (0..table.fields.len()).any(|f| is_elevation_name(&table.fields[f].name) && count_numbers(&items, f) > 0);
    // If z varies, the outline was draped over a terrain. Then z is not the water level.
    let levels = items.iter().any(|item| constant_z(item).is_some_and(|z| z != 0.0));
    if asked.field.is_none() && !numbers && !levels {
        let may_be = |field: usize| {
            let name = &table.fields[field].name;
            is_elevation_name(name) || unit_in_name(name).is_some()
        };
        let text = items.iter().flat_map(|item| item.values.iter().map(move |value| (item.feature, value)));
        let word = |value: &Value| matches!(value, Value::Text(text) if !text.trim().is_empty());
        return match text.into_iter().find(|(_, (field, value))| may_be(*field) && word(value)) {
            None => Ok(Heights::default()),
            Some((feature, (field, value))) => {
                let name = &table.fields[*field].name;
                let message = format!("feature {feature}: the field {name:?} holds {value}, which is not a number");
                Err(Error::file(path, message))
            }
        };
    }
    let source = choose(&items, &table.fields, asked).map_err(|error| noted(error, table).in_file(path))?;
    let units = Units::of([Group { items: &items, source }], &table.fields, options.unit);
    let statement = units.of_source(source, &table.fields);
    let mut heights = BTreeMap::new();
    for item in &items {
        match units.in_map_unit(&statement, item) {
            Outcome::Known(height) => {
                heights.insert(item.feature, height);
            }
            Outcome::Missing(_) => {}
            Outcome::Invalid(what) => return Err(Error::file(path, format!("feature {}: {what}", item.feature))),
        }
    }
    Ok(Heights { of: heights, stated_unit: units.stated, findings: units.findings })
}

/// The source of the heights of points in a contour file. They are optional: any problem with them is a finding, not an
/// error. The user's name is meant for the lines; points may use another attribute.
fn spot_source(table: &Table, asked: Asked<'_>, findings: &mut Vec<Finding>) -> Option<ElevationSource> {
    let items = spot_items(table);
    if items.is_empty() {
        return None;
    }
    match choose(&items, &table.fields, asked_of_spots(table, &items, asked)) {
        Ok(source) => Some(source),
        Err(error) => {
            let message = format!("{} points left out: {error}", items.len());
            findings.push(Finding::general(FindingKind::SkippedFeature, message));
            None
        }
    }
}

/// What the caller says about contours, as far as it is true of the points beside them.
fn asked_of_spots<'a>(table: &Table, items: &[Item<'_>], asked: Asked<'a>) -> Asked<'a> {
    let has_numbers = |named: &&str| find_field(&table.fields, named).is_some_and(|f| count_numbers(items, f) > 0);
    Asked { field: asked.field.filter(has_numbers), ..asked }
}

/// The points of a contour file.
fn spots_beside_lines(
    table: &Table,
    source: ElevationSource,
    asked: Asked<'_>,
    units: &Units,
    findings: &mut Vec<Finding>,
) -> Vec<DVec3> {
    let items = spot_items(table);
    let sign = Sign::of(source, &table.fields, asked_of_spots(table, &items, asked), &items);
    let statement = units.of_source(source, &table.fields);
    let mut spots = Vec::new();
    for feature in &table.features {
        for spot in &feature.spots {
            match units.in_map_unit(&statement, &spot_item(feature.number, &feature.values, spot)) {
                Outcome::Known(height) => keep_spot(spot, sign.of_height(height), &mut spots, findings),
                Outcome::Missing(reason) | Outcome::Invalid(reason) => {
                    findings.push(left_out("point", feature.number, Some(&spot.place), &reason));
                }
            }
        }
    }
    spots
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
            Some([lo, _]) if lo.is_nan() => checked(lo, "its z"),
            Some([lo, hi]) if is_level([lo, hi]) => checked(level_of([lo, hi]), "its z"),
            Some([lo, hi]) => Outcome::Missing(format!("its z varies from {lo} to {hi}, so it is not a contour")),
        },
        ElevationSource::Field(index) => {
            let name = &fields[index].name;
            match value(item, index) {
                Value::Null => Outcome::Missing(format!("its field {name:?} is empty")),
                Value::Number(z) | Value::Measured(z, _) => checked(*z, &format!("its field {name:?}")),
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

/// The z coordinate of an item, if it is the same everywhere up to rounding.
fn constant_z(item: &Item<'_>) -> Option<f64> {
    item.z.filter(|z| is_level(*z)).map(level_of)
}

/// Whether heights in this range are one level.
fn is_level([low, high]: [f64; 2]) -> bool {
    low == high || high - low <= SAME_HEIGHT
}

/// The level of heights in this range.
fn level_of([low, high]: [f64; 2]) -> f64 {
    if low == high { low } else { shortest_between(low, high) }
}

/// Lines whose z varies by rounding.
#[derive(Default)]
struct Uneven {
    count: usize,
    widest: f64,
}

impl Uneven {
    fn note(&mut self, source: ElevationSource, item: &Item<'_>) {
        if let (ElevationSource::Z, Some([low, high])) = (source, item.z)
            && high > low
        {
            self.count += 1;
            self.widest = self.widest.max(high - low);
        }
    }

    fn finding(&self) -> Option<Finding> {
        let Self { count, widest } = self;
        let message = format!("z varies by up to {widest:.1e} along {count} lines; each was taken as one level");
        (*count > 0).then(|| Finding::general(FindingKind::SameLevel, message))
    }
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
    let mut findings = file_findings(table);
    findings.extend(left_out_findings(table));
    findings
}

/// The findings of the reader, and that about the coordinate reference system.
fn file_findings(table: &mut Table) -> Vec<Finding> {
    let mut findings = std::mem::take(&mut table.findings);
    let problem = table.crs_problem.take();
    let missing = || problem.unwrap_or_else(|| "the file does not name its coordinate reference system".to_owned());
    findings.extend(crs_finding(table.crs.as_ref(), missing));
    findings
}

/// The findings about geometries that are left out.
fn left_out_findings(table: &Table) -> impl Iterator<Item = Finding> {
    table.left_out.iter().map(|(kind, count)| {
        let message = match kind.as_str() {
            NO_GEOMETRY => format!("{count} features without geometry left out"),
            kind => format!("{count} geometries of type {kind} left out: only lines and points are read"),
        };
        Finding::general(FindingKind::SkippedFeature, message)
    })
}

#[cfg(test)]
mod tests;
