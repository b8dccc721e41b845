//! Makes lakes from the polygons of a file.

use std::path::Path;

use super::ReadOptions;
use super::area::{check_polygons, single_polygons, united_polygons};
use super::elevation::{Heights, polygon_heights};
use super::table::Table;
use tokosen_core::base::error::{Report, Result};
use tokosen_core::contour::{Lake, StatedUnit};

/// The polygons of a table as lakes, in the order of the file.
///
/// Also gives the unit that the file states for their heights.
pub(super) fn lakes(
    path: &Path,
    mut table: Table,
    options: &ReadOptions,
) -> Result<Report<(Vec<Lake>, Option<StatedUnit>)>> {
    check_polygons(path, &table, "water")?;
    let Heights { of: heights, stated_unit, findings } = polygon_heights(path, &mut table, options)?;
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
    Ok(Report { value: (members.into_iter().map(lake).collect(), stated_unit), findings })
}
