//! Makes lakes from the polygons of a file.

use std::path::Path;

use super::area::{check_polygons, single_polygons, united_polygons};
use super::elevation::polygon_heights;
use super::table::Table;
use crate::base::error::Result;
use crate::contour::Lake;

/// The polygons of a table as lakes, in the order of the file.
pub(super) fn lakes(path: &Path, table: Table, named: Option<&str>) -> Result<Vec<Lake>> {
    check_polygons(path, &table, "water")?;
    let heights = polygon_heights(path, &table, named)?;
    let members = if table.in_pieces {
        united_polygons(path, table, |a, b| heights.get(&a) == heights.get(&b))?
    } else {
        single_polygons(path, table)?
    };
    let lake = |m: super::area::Member| Lake {
        height: heights.get(&m.feature).copied(),
        polygon: m.polygon,
        feature: m.feature.into(),
    };
    Ok(members.into_iter().map(lake).collect())
}
