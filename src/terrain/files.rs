//! Reading of height maps and check points from files.

use std::mem::take;
use std::path::Path;
use std::sync::Arc;

use super::compare::{Kind, Pair, Side};
use super::grid::GridSpec;
use super::measure::add_check_points;
use super::units::Elevations;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Finding, FindingKind, Report, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::check::placeholder_heights;
use tokosen_core::contour::SpotHeights;
use tokosen_core::dem::compare::Comparison;
use tokosen_io::raster::{DemRows, open_dem, read_grid, read_standard_errors};
use tokosen_io::{ReadOptions, VectorSource, read_spot_heights};

impl GridSpec {
    /// The cells of a raster; only its header is read.
    ///
    /// # Errors
    /// As [`read_grid`].
    pub fn like(path: &Path) -> Result<Self> {
        let (grid, crs) = read_grid(path)?;
        Ok(Self::Cells { grid, crs, file: Some(path.to_owned()) })
    }
}

impl Side {
    /// Opens a height map. The rows of a GeoTIFF are read when they are needed; [`Side::late_findings`] then tells about their
    /// heights.
    ///
    /// # Errors
    /// As [`open_dem`].
    pub fn read_height_map(path: &Path, progress: &dyn Progress) -> Result<Report<Self>> {
        let Report { value: DemRows { heights, product, height_system }, findings } =
            step(progress, "reading", || open_dem(path))?;
        let product = product.map(|product| (product.name(), product.sigma()));
        let mut side = Self::of_dem(path, heights, product);
        side.height_system = height_system;
        Ok(Report { value: side, findings })
    }

    /// Reads the standard errors that a height map has beside its heights, if it has them and no other error is stated.
    ///
    /// # Errors
    /// As [`read_standard_errors`].
    pub fn read_errors(&mut self) -> Result<()> {
        if matches!(self.kind, Kind::Dem(_)) && self.sigma.is_none() {
            self.errors = read_standard_errors(&self.source.file)?.map(Arc::new);
        }
        Ok(())
    }

    /// The findings about heights that were read since the side was opened. Each call gives all of them.
    pub fn late_findings(&self) -> Vec<Finding> {
        match &self.kind {
            Kind::Dem(dem) => dem.findings(),
            Kind::Surface(_) => Vec::new(),
        }
    }
}

/// Leaves out check points whose heights stand for no data.
fn leave_out_placeholders(checks: &mut SpotHeights, findings: &mut Vec<Finding>) {
    let heights: Vec<f64> = checks.points.iter().map(|point| point.z).collect();
    let mut is_out = placeholder_heights(&heights).into_iter();
    let SpotHeights { points, sigmas, .. } = checks;
    let mut sigmas_left = take(sigmas).into_iter();
    points.retain(|point| {
        let sigma = sigmas_left.next();
        if is_out.next() == Some(true) {
            let message = format!("the check point {} m was left out: its height stands for no data", point.z);
            let finding = Finding::new(FindingKind::ZeroElevation, Some(point.truncate()), message);
            findings.push(finding.of_elevations([point.z]));
            return false;
        }
        sigmas.extend(sigma);
        true
    });
}

/// Adds the figures at the check points of a file. Their heights are in `unit`; if it is `None`: in that of the vertical
/// part of their coordinate reference system, else in that of the contours of the pair, else in metres. Findings about
/// the points are added to `findings`. `memory` is the memory that reading may take, bytes; no limit if `None`.
///
/// # Errors
/// As [`read_spot_heights`] and [`add_check_points`].
pub fn read_check_points(
    found: &mut Comparison,
    pair: &Pair,
    (source, unit): (&VectorSource, Option<ElevationUnit>),
    memory: Option<u64>,
    findings: &mut Vec<Finding>,
) -> Result<()> {
    let path = &source.path;
    let reading = ReadOptions { memory, unit, ..source.reading() };
    let mut checks = read_spot_heights(path, &reading)?.collect(findings);
    let crs = checks.crs.as_ref().filter(|crs| crs.height_unit().is_some());
    let hint = checks.unit_hint.as_ref();
    let stated = checks.stated_unit.as_ref();
    let heights = Elevations { what: "the check points", asked: unit, otherwise: pair.unit(), crs, stated, hint };
    let unit = heights.unit(findings);
    checks.points.iter_mut().for_each(|point| point.z = unit.metres(point.z));
    leave_out_placeholders(&mut checks, findings);
    add_check_points(found, pair, &checks, path)?;
    let all = checks.points.len();
    let used =
        [&found.a, &found.b].into_iter().filter_map(|side| side.points.as_ref()).map(|points| points.cells).max();
    if let Some(out) = all.checked_sub(used.unwrap_or_default()).filter(|out| *out > 0) {
        let message =
            format!("{}: {out} of {all} check points are not where A and B have heights; left out", path.display());
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
    }
    Ok(())
}
