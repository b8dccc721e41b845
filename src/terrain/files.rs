//! Reading of the facade's inputs from files.

use std::path::Path;

use super::compare::{Pair, Side};
use super::grid::GridSpec;
use super::input::{Input, InputOptions};
use super::measure::add_check_points;
use super::units::Elevations;
use crate::base::ElevationUnit;
use crate::base::error::{Finding, Report, Result};
use crate::base::progress::{Progress, step};
use crate::contour::SpotHeights;
use crate::dem::compare::Comparison;
use crate::io::raster::{DemFile, read_dem, read_grid};
use crate::io::{ReadOptions, read_area, read_contours, read_spot_heights, read_water};

impl Input {
    /// Reads contours and the spot heights that come with them: [`Input::read_with`] with default options.
    ///
    /// # Errors
    /// As [`Input::read_with`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::read_with(path.as_ref(), &InputOptions::default(), &())
    }

    /// Reads contours and the spot heights that come with them.
    ///
    /// # Errors
    /// As [`read_contours`] and [`Input::from_map`]; the error names the file.
    pub fn read_with(path: &Path, options: &InputOptions, progress: &dyn Progress) -> Result<Self> {
        step(progress, "reading", || {
            let InputOptions { elevation_field, layer, memory, .. } = options.clone();
            let read = read_contours(path, &ReadOptions { elevation_field, layer, memory })?;
            let input = Self::from_report(read, options).map_err(|error| error.in_file(path))?;
            Ok(Self { file: Some(path.to_owned()), ..input })
        })
    }

    /// Reads spot heights from a file and adds them.
    ///
    /// # Errors
    /// As [`read_spot_heights`] and [`Input::add_spots`]; the error names the file.
    pub fn read_spots(&mut self, path: &Path, progress: &dyn Progress) -> Result<()> {
        step(progress, "reading", || {
            let mut about = Vec::new();
            let SpotHeights { points, crs, unit_hint } = read_spot_heights(path, &self.reading())?.collect(&mut about);
            let to_working = self.reprojection.bring(crs.as_ref()).map_err(|error| error.in_file(path))?;
            for finding in &mut about {
                let place = finding.place.and_then(|p| to_working.point(p.extend(0.0)).ok());
                finding.place = place.map(|p| p.truncate());
            }
            self.findings.append(&mut about);
            let added = self.add_spots_with(points, crs.as_ref(), unit_hint.as_ref());
            added.map_err(|error| error.in_file(path))
        })
    }

    /// Reads lakes from a file and adds them.
    ///
    /// # Errors
    /// As [`read_water`] and [`Input::add_lakes`]; the error names the file.
    pub fn read_lakes(&mut self, path: &Path) -> Result<()> {
        let (lakes, crs) = read_water(path, &self.reading())?.collect(&mut self.findings);
        self.add_lakes(lakes, crs.as_ref()).map_err(|error| error.in_file(path))
    }

    /// Reads a boundary polygon from a file: the ground ends there.
    ///
    /// # Errors
    /// As [`read_area`] and [`Input::set_boundary`]; the error names the file.
    pub fn read_boundary(&mut self, path: &Path) -> Result<()> {
        let (area, crs) = read_area(path, &self.reading())?;
        self.set_boundary(&area, crs.as_ref()).map_err(|error| error.in_file(path))
    }

    /// How further files are read.
    fn reading(&self) -> ReadOptions {
        ReadOptions { memory: self.memory, ..ReadOptions::default() }
    }
}

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
    /// Reads a height map.
    ///
    /// # Errors
    /// As [`read_dem`].
    pub fn read_height_map(path: &Path, progress: &dyn Progress) -> Result<Report<Self>> {
        let Report { value: DemFile { dem, product }, findings } = step(progress, "reading", || read_dem(path))?;
        let product = product.map(|product| (product.name(), product.sigma()));
        Ok(Report { value: Self::of_dem(path, dem, product), findings })
    }
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
    (path, unit): (&Path, Option<ElevationUnit>),
    memory: Option<u64>,
    findings: &mut Vec<Finding>,
) -> Result<()> {
    let reading = ReadOptions { memory, ..ReadOptions::default() };
    let mut checks = read_spot_heights(path, &reading)?.collect(findings);
    let crs = checks.crs.as_ref().filter(|crs| crs.height_unit().is_some());
    let hint = checks.unit_hint.as_ref();
    let heights = Elevations { what: "the check points", asked: unit, otherwise: pair.unit(), crs, hint };
    let unit = heights.unit(findings);
    checks.points.iter_mut().for_each(|point| point.z = unit.metres(point.z));
    add_check_points(found, pair, &checks, path)
}
