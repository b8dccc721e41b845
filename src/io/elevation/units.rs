//! The unit that a file states for each elevation: in an attribute beside it, or in its text.
//!
//! It is a statement, not a hint: it is used, and said in one finding. If all elevations are in one unit, they stay as they
//! are, and the map says which unit it is. If units differ, or are none that a map can have, elevations become metres here.

use std::collections::BTreeMap;

use super::choose::{ElevationSource, number, stands_for_no_data};
use super::{Item, Outcome, constant_z, elevation, value};
use crate::attributes::{has_usgs_codes, most_metres, small_unit_in_name, unit_column};
use crate::table::{Field, Value};
use crate::unit_words::LengthWord;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::contour::StatedUnit;

/// Lines or points, and the source of their elevations.
pub(super) struct Group<'a> {
    pub items: &'a [Item<'a>],
    pub source: ElevationSource,
}

/// The units of the elevations of a table.
#[derive(Default)]
pub(super) struct Units {
    rule: Rule,
    /// Sources whose names give the unit.
    by_name: Vec<(ElevationSource, LengthWord)>,
    /// What the file states about the unit that elevations are in after reading.
    pub stated: Option<StatedUnit>,
    pub findings: Vec<Finding>,
}

/// What is done with an elevation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Rule {
    /// Nothing.
    #[default]
    Keep,
    /// Nothing; those in an unknown unit are left out.
    One,
    /// It becomes metres; those in an unknown unit, or none, are left out.
    Each,
}

/// The unit of one elevation.
enum Unit {
    Unstated,
    Known(LengthWord),
    /// This is no unit known here.
    Unknown(String),
}

/// How a table states the units of the elevations from one source.
pub(super) struct Statement<'a> {
    source: ElevationSource,
    fields: &'a [Field],
    column: Option<usize>,
    /// The unit that the name of the source gives.
    by_name: Option<LengthWord>,
}

impl Units {
    /// The units of some groups of one table. `asked` is the unit that the caller asks for; it comes first.
    pub fn of<'a>(groups: impl IntoIterator<Item = Group<'a>>, fields: &[Field], asked: Option<ElevationUnit>) -> Self {
        let mut counts: BTreeMap<LengthWord, usize> = BTreeMap::new();
        let (mut unstated, mut unknown) = (0_usize, BTreeMap::<String, usize>::new());
        let mut by = None;
        let mut by_name = Vec::new();
        for Group { items, source } in groups {
            let mut statement = Statement::of(source, fields);
            statement.by_name = statement.unit_of_name(items);
            by_name.extend(statement.by_name.map(|unit| (source, unit)));
            for item in items.iter().filter(|item| statement.height(item).is_some()) {
                match statement.unit(item) {
                    Unit::Unstated => unstated += 1,
                    Unit::Known(unit) => *counts.entry(unit).or_default() += 1,
                    Unit::Unknown(text) => *unknown.entry(text).or_default() += 1,
                }
            }
            if by.is_none() && !(counts.is_empty() && unknown.is_empty()) {
                by = Some(statement.words());
            }
        }
        let Some(by) = by else { return Self::default() };
        let mut findings = Vec::new();
        let mut add = |kind, message: String| findings.push(Finding::general(kind, message));
        let example = unknown.keys().next().cloned();
        if counts.is_empty() {
            let example = example.unwrap_or_default();
            add(
                FindingKind::UnitDoubt,
                format!("{by} holds {example}, which is no unit known here, so the unit is not certain"),
            );
            return Self { findings, ..Self::default() };
        }
        let only = counts.keys().next().filter(|_| counts.len() == 1).and_then(|unit| unit.elevation_unit());
        let list: Vec<String> = counts.iter().map(|(unit, count)| format!("{} for {count}", unit.name())).collect();
        let states = match counts.keys().next().filter(|_| counts.len() == 1) {
            Some(unit) => format!("{by} states {}", unit.name()),
            None => format!("{by} states {}", list.join(" and ")),
        };
        let rule = match (only, asked) {
            (Some(_), None) => Rule::One,
            (None, None) => Rule::Each,
            (_, Some(_)) => Rule::Keep,
        };
        match (rule, only, asked) {
            (Rule::Each, ..) => add(FindingKind::HeightUnit, format!("{states}; each elevation was read in its unit")),
            (Rule::Keep, None, Some(asked)) => {
                add(
                    FindingKind::UnitDoubt,
                    format!("{states}; the elevations are taken as {} all the same", asked.name()),
                );
            }
            (Rule::One, Some(unit), _) if unstated > 0 && unit.is_foot() => {
                let message =
                    format!("{states}, and {unstated} elevations have no unit; they are taken as {}", unit.name());
                add(FindingKind::UnitDoubt, message);
            }
            _ => {}
        }
        let stated = match rule {
            Rule::Each => Some(StatedUnit { says: states, unit: ElevationUnit::Metre }),
            Rule::One | Rule::Keep => only.map(|unit| StatedUnit { says: states, unit }),
        };
        Self { rule, by_name, stated, findings }
    }

    /// How the elevations from a source are read.
    pub fn of_source<'a>(&self, source: ElevationSource, fields: &'a [Field]) -> Statement<'a> {
        let by_name = self.by_name.iter().find(|(of, _)| *of == source).map(|(_, unit)| *unit);
        Statement { by_name, ..Statement::of(source, fields) }
    }

    /// The elevation of an item, in the unit of the map.
    pub fn in_map_unit(&self, statement: &Statement<'_>, item: &Item<'_>) -> Outcome {
        let outcome = elevation(statement.source, statement.fields, item);
        let Outcome::Known(z) = outcome else { return outcome };
        // A number for no data has no unit.
        if self.rule == Rule::Keep || stands_for_no_data(z) {
            return outcome;
        }
        match (statement.unit(item), self.rule) {
            (Unit::Unknown(text), _) => {
                let words = statement.words();
                Outcome::Missing(format!("{words} holds {text}, which is no unit known here, and others have one"))
            }
            (Unit::Known(unit), Rule::Each) => Outcome::Known(unit.metres(z)),
            (Unit::Unstated, Rule::Each) => {
                Outcome::Missing("it has no unit, and others are in different units".to_owned())
            }
            (Unit::Known(_) | Unit::Unstated, _) => outcome,
        }
    }

    /// A size beside an elevation, such as its standard error, in the unit of the map.
    pub fn size_in_map_unit(&self, statement: &Statement<'_>, item: &Item<'_>, size: f64) -> f64 {
        match statement.unit(item) {
            Unit::Known(unit) if self.rule == Rule::Each => unit.metres(size),
            _ => size,
        }
    }
}

/// The name of a source.
fn name_of(source: ElevationSource, fields: &[Field]) -> &str {
    match source {
        ElevationSource::Field(field) => fields[field].name.as_str(),
        ElevationSource::Z => "z",
    }
}

impl<'a> Statement<'a> {
    fn of(source: ElevationSource, fields: &'a [Field]) -> Self {
        let own = name_of(source, fields);
        let columns = (0..fields.len()).filter(|&field| source != ElevationSource::Field(field));
        let about = columns.filter_map(|field| Some((unit_column(&fields[field].name, own)?, field)));
        let column = about.max_by_key(|&(about, field)| (about, std::cmp::Reverse(field))).map(|(_, field)| field);
        Self { source, fields, column, by_name: None }
    }

    /// The unit that the name of the source gives, if no attribute beside it does: `height_cm`, or one whose numbers can
    /// only be millimetres by their size.
    fn unit_of_name(&self, items: &[Item<'_>]) -> Option<LengthWord> {
        let name = name_of(self.source, self.fields);
        let heights = || items.iter().filter_map(|item| self.height(item)).filter(|z| !stands_for_no_data(*z));
        let is_too_high = |most: &f64| heights().any(|z| z.abs() > *most);
        let millimetres = || most_metres(name).filter(is_too_high).map(|_| LengthWord::Millimetre);
        if self.column.is_some() { None } else { small_unit_in_name(name).or_else(millimetres) }
    }

    /// The number of an item in the source.
    fn height(&self, item: &Item<'_>) -> Option<f64> {
        match self.source {
            ElevationSource::Field(field) => number(item, field),
            ElevationSource::Z => constant_z(item),
        }
    }

    fn unit(&self, item: &Item<'_>) -> Unit {
        if let ElevationSource::Field(field) = self.source
            && let Value::Measured(_, unit) = value(item, field)
        {
            return Unit::Known(*unit);
        }
        if let Some(unit) = self.by_name {
            return Unit::Known(unit);
        }
        let Some(column) = self.column else { return Unit::Unstated };
        let code = |code: f64| match has_usgs_codes(&self.fields[column].name) {
            true => LengthWord::of_usgs_code(code).or_else(|| LengthWord::of_code(code)),
            false => LengthWord::of_code(code),
        };
        let stated = value(item, column);
        let unit = match stated {
            Value::Null => return Unit::Unstated,
            Value::Text(text) if text.trim().is_empty() => return Unit::Unstated,
            Value::Number(number) | Value::Measured(number, _) => code(*number),
            Value::Text(text) => text.trim().parse().ok().and_then(code).or_else(|| LengthWord::of_text(text)),
        };
        unit.map_or_else(|| Unit::Unknown(stated.to_string()), Unit::Known)
    }

    /// What states the units, in words.
    fn words(&self) -> String {
        match (self.column, self.source) {
            (Some(column), _) => format!("the field {:?}", self.fields[column].name),
            (None, ElevationSource::Field(field)) => format!("the field {:?}", self.fields[field].name),
            (None, ElevationSource::Z) => "the file".to_owned(),
        }
    }
}
