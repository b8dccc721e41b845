//! Depths: larger numbers are lower ground.

use super::choose::{Asked, ElevationSource, number};
use super::{Item, constant_z};
use crate::attributes::is_depth_name;
use crate::table::Field;
use tokosen_core::base::error::{Finding, FindingKind};

/// Whether the numbers of a source are depths, and what is to be said about it.
pub(super) struct Sign {
    is_depth: bool,
    pub finding: Option<Finding>,
}

impl Sign {
    /// For the chosen source: what the caller says comes first. A name alone is a finding.
    pub fn of(source: ElevationSource, fields: &[Field], asked: Asked<'_>, items: &[Item<'_>]) -> Self {
        let name = match source {
            ElevationSource::Field(field) => format!("the field {:?}", fields[field].name),
            ElevationSource::Z => "the z coordinate".to_owned(),
        };
        let by_name = matches!(source, ElevationSource::Field(field) if is_depth_name(&fields[field].name));
        let is_depth = asked.depths && (asked.field.is_some() || by_name);
        let height = |item: &Item<'_>| match source {
            ElevationSource::Field(field) => number(item, field),
            ElevationSource::Z => constant_z(item),
        };
        let is_positive = || items.iter().filter_map(height).any(|z| z > 0.0);
        let message = match (asked.depths, is_depth, by_name) {
            (false, _, true) if is_positive() => Some(format!(
                "{name} seems to hold depths, and its numbers are taken as heights, so that basins become hills; ask for \
                 depths to read them as negative elevations"
            )),
            (true, false, _) => Some(format!(
                "depths are asked for, and {name} has no name of depths, so its numbers are taken as heights; name the field \
                 to read them as depths"
            )),
            _ => None,
        };
        Self { is_depth, finding: message.map(|message| Finding::general(FindingKind::Depths, message)) }
    }

    /// The elevation for a number of the source.
    pub fn of_height(&self, number: f64) -> f64 {
        if self.is_depth { 0.0 - number } else { number }
    }
}
