//! Volumes of a side, or between two sides.

use std::path::PathBuf;
use std::sync::Arc;

use geo::MultiPolygon;

use super::compare::{Nodes, Side};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::progress::Progress;
use tokosen_core::crs::converted;
use tokosen_core::dem::compare::heights_between;
use tokosen_core::dem::volume::Heights;
use tokosen_core::raster::{Dem, RasterRows};
use tokosen_core::surface::standard_errors_on;

/// Whose heights count.
#[derive(Debug, Clone, Copy)]
pub struct VolumeSides<'a> {
    /// The ground.
    pub a: &'a Side,
    /// Heights that are subtracted from those of the ground, if there are any.
    pub b: Option<&'a Side>,
}

/// The heights of a side, or the differences A − B, at the cells of a grid, ready for volumes. `area` is the part that counts, in
/// the coordinates of the cells, and the file that it is from. Errors are those that the sides state; those of two sides add up as if they were independent.
///
/// # Errors
/// As [`Heights::of`]; if the cells cannot be converted to the coordinates of a side.
pub fn heights_of(
    sides: VolumeSides<'_>,
    nodes: &Nodes,
    area: impl FnOnce(&Dem) -> Result<Option<(MultiPolygon<f64>, PathBuf)>>,
    progress: &dyn Progress,
) -> Result<Heights> {
    let (mut a, errors_a) = on_cells(sides.a, nodes, progress)?;
    let b = sides.b.map(|b| on_cells(b, nodes, progress)).transpose()?;
    if let Some((area, path)) = area(&a)? {
        a = a.inside(&area).map_err(|error| error.in_file(&path))?;
    }
    let reach = |side: &Side| side.surface()?.errors.as_ref()?.reach();
    match (b, sides.b) {
        (Some((heights, errors_b)), Some(side_b)) => {
            let both = |(a, b): (Vec<f32>, Vec<f32>)| a.iter().zip(&b).map(|(a, b)| a.hypot(*b)).collect::<Vec<f32>>();
            let errors = errors_a.zip(errors_b).map(both);
            let reach = reach(sides.a).zip(reach(side_b)).map(|(a, b)| a.max(b));
            Heights::between(&a, &heights, errors.as_deref(), reach)
        }
        _ => Heights::of(&a, errors_a.as_deref(), reach(sides.a)),
    }
    .map_err(|error| match error {
        Error::Data(_) if sides.b.is_some() => Error::Data(
            "there is no cell in which both A and B have a height: do they overlap, and does --clip?".into(),
        ),
        other => other,
    })
}

/// The heights of a side at the cells, and their standard errors, if it states any.
fn on_cells(side: &Side, (grid, crs): &Nodes, progress: &dyn Progress) -> Result<(Dem, Option<Vec<f32>>)> {
    let rows: Arc<dyn RasterRows> = side.on(grid, crs.as_ref(), progress)?;
    let dem: Dem = rows.whole()?.into_owned();
    let errors = match side.surface() {
        Some(surface) => {
            let transform = side.transform_from(crs.as_ref(), &side.source.file)?;
            standard_errors_on(surface, &dem, &|p| converted(transform.as_ref(), p))
        }
        None => match (side.sigma, &side.errors) {
            (None, Some(errors)) => {
                let transform = side.transform_from(crs.as_ref(), &side.source.file)?;
                Some(heights_between(errors, grid, &|p| converted(transform.as_ref(), p)))
            }
            (sigma, _) => sigma.map(|sigma| vec![sigma as f32; dem.values.len()]),
        },
    };
    Ok((dem, errors))
}
