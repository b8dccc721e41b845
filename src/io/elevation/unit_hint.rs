//! What the names of fields let suppose about the unit of elevations.

use super::choose::{ElevationSource, number};
use super::{Item, SAME_ELEVATION, constant_z};
use crate::attributes::{NamedUnit, unit_in_name};
use crate::table::Field;
use tokosen_core::contour::UnitHint;

/// The hint about the elevations from `source`: the name of the field, otherwise the name of another field that holds
/// the same values.
pub(super) fn hint(source: ElevationSource, items: &[Item<'_>], fields: &[Field]) -> Option<UnitHint> {
    let named = |field: usize| unit_in_name(&fields[field].name).map(|unit| (field, unit));
    let own = match source {
        ElevationSource::Field(field) => named(field),
        ElevationSource::Z => None,
    };
    let others = (0..fields.len()).filter(|&field| source != ElevationSource::Field(field)).filter_map(named);
    let (field, unit) = own.or_else(|| others.into_iter().find(|&(field, _)| agrees(source, field, items)))?;
    let unit_name = match unit {
        NamedUnit::Metres => "metres",
        NamedUnit::Feet => "feet",
    };
    let says = format!("the field {:?} seems to hold {unit_name}", fields[field].name);
    Some(UnitHint { says, is_feet: unit == NamedUnit::Feet })
}

/// Whether a field holds the elevations too: of all items that have both, and not only zeros.
fn agrees(source: ElevationSource, field: usize, items: &[Item<'_>]) -> bool {
    let pair = |item: &Item<'_>| {
        let elevation = match source {
            ElevationSource::Field(field) => number(item, field),
            ElevationSource::Z => constant_z(item),
        };
        elevation.zip(number(item, field))
    };
    let is_same = |(elevation, other): (f64, f64)| (elevation - other).abs() <= SAME_ELEVATION;
    let pairs = || items.iter().filter_map(pair);
    pairs().all(is_same) && pairs().any(|(elevation, _)| elevation != 0.0)
}
