//! Finds the attributes that mark depression contours.
//!
//! Agencies mark contours around lower ground in one of two ways: by a yes/no attribute, or by a word in the attribute
//! for the kind of line. Depressions are found without these marks. Where a mark contradicts the map, one of the two is
//! wrong.

use std::collections::BTreeMap;

use super::attributes::{FLAGS, KINDS};
use super::table::{Field, Table, Value};
use tokosen_core::base::FeatureId;

/// The marks of the features with lines: true for a depression. False only comes from a yes/no attribute.
///
/// If no feature says yes, the attribute was never filled in, and no mark is returned.
pub(super) fn marks(table: &Table) -> BTreeMap<FeatureId, bool> {
    let mut marks = BTreeMap::new();
    for feature in table.features.iter().filter(|feature| !feature.lines.is_empty()) {
        let found = feature.values.iter().filter_map(|(field, value)| mark(&table.fields[*field], value));
        if let Some(found) = found.reduce(|a, b| a || b) {
            marks.insert(feature.number.into(), found);
        }
    }
    if !marks.values().any(|&is_depression| is_depression) {
        marks.clear();
    }
    marks
}

/// What one value says about depressions; `None` if it says nothing.
fn mark(field: &Field, value: &Value) -> Option<bool> {
    let name = field.name.trim().to_lowercase();
    let is_flag = FLAGS.contains(&name.as_str());
    match value {
        Value::Number(number) if is_flag => Some(*number != 0.0),
        Value::Text(text) if is_flag || KINDS.contains(&name.as_str()) => {
            let text = text.trim().to_lowercase();
            match text.as_str() {
                "true" | "t" | "yes" | "y" | "1" if is_flag => Some(true),
                "false" | "f" | "no" | "n" | "0" if is_flag => Some(false),
                _ => {
                    ((text.contains("depression") && !text.starts_with("no")) || text.contains("凹地")).then_some(true)
                }
            }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str, value: Value) -> Option<bool> {
        mark(&Field { name: name.to_owned(), example: None, kept: true }, &value)
    }

    #[test]
    fn words_of_agencies_are_understood() {
        let text = |text: &str| Value::Text(text.to_owned());
        assert_eq!(of("DEPRESSION", Value::Number(1.0)), Some(true));
        assert_eq!(of("depression", Value::Number(0.0)), Some(false));
        assert_eq!(of("is_depression", text("false")), Some(false));
        assert_eq!(of("Depression", text("Y")), Some(true));
        assert_eq!(of("depression", Value::Null), None);
        assert_eq!(of("ContourType", text("Depression Index")), Some(true));
        assert_eq!(of("ContourType", text("Intermediate")), None);
        assert_eq!(of("type", text("凹地等高線")), Some(true));
        assert_eq!(of("type", text("一般等高線")), None);
        assert_eq!(of("type", text("non-depression")), None);
        assert_eq!(of("type", Value::Number(1.0)), None);
        assert_eq!(of("elev", text("depression")), None);
    }
}
