//! From the polygons of a file to lakes.

use std::path::Path;

use super::area::{single_polygons, united_polygons};
use super::elevation::polygon_heights;
use super::table::{NO_GEOMETRY, Table};
use crate::contour::Lake;
use crate::error::{Error, Result};

/// The polygons of a table as lakes, in the order of the file.
pub(super) fn lakes(path: &Path, table: Table, named: Option<&str>) -> Result<Vec<Lake>> {
    if let Some((kind, count)) = table.left_out.iter().find(|(kind, _)| *kind != NO_GEOMETRY) {
        let message =
            format!("{count} geometries of type {kind} are no water; convert them to polygons or leave them out");
        return Err(Error::file(path, message));
    }
    if table.features.iter().all(|feature| feature.polygons.is_empty()) {
        let found = table.found_words();
        return Err(Error::file(path, format!("there is no polygon in it{found}; water needs polygons")));
    }
    let heights = polygon_heights(path, &table, named)?;
    let members = if table.in_pieces {
        united_polygons(path, table, |a, b| heights.get(&a) == heights.get(&b))?
    } else {
        single_polygons(path, table)?
    };
    let lake = |m: super::area::Member| Lake {
        height: heights.get(&m.feature).copied(),
        polygon: m.polygon,
        feature: m.feature,
    };
    Ok(members.into_iter().map(lake).collect())
}
