//! Reading of the facade's inputs from files.

use std::mem::take;
use std::path::{Path, PathBuf};

use super::{InMetres, Input, InputOptions, Signs, in_metres};
use crate::terrain::sheets::{Sheet, joined};
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::contour::SpotHeights;
use tokosen_core::crs::Crs;
use tokosen_core::features::Role;
use tokosen_io::raster::{DemFile, read_dem};
use tokosen_io::{FileFeatures, ReadOptions, VectorSource, read_area, read_contours, read_features, read_spot_heights};

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
    /// As [`Input::read_all`].
    pub fn read_with(path: &Path, options: &InputOptions, progress: &dyn Progress) -> Result<Self> {
        Self::read_all(&[path.into()], options, progress)
    }

    /// Reads the contours of files as one map, and the spot heights that come with them. Lines that end at the edge of one
    /// sheet and go on in the next one are joined by [`Input::prepare`].
    ///
    /// The map is in the coordinate reference system of the first file that names one. Lines of files in another system
    /// are transformed, with a finding. Each file may have a unit of elevations of its own. The layer of the options is
    /// that of files which name none.
    ///
    /// # Errors
    /// As [`read_contours`] and [`Input::from_map`]; the error names the file. If no file is given.
    pub fn read_all(sources: &[VectorSource], options: &InputOptions, progress: &dyn Progress) -> Result<Self> {
        let sheet = |source: &VectorSource| {
            let layer = source.layer.clone().or_else(|| options.layer.clone());
            let InputOptions { elevation_field, memory, unit, depths, .. } = options.clone();
            let reading = ReadOptions { elevation_field, layer, memory, unit, depths, ..source.reading() };
            let InMetres { read, unit, heights } = in_metres(read_contours(&source.path, &reading)?, options);
            let Report { value: map, findings } = read;
            Ok(Sheet { file: source.path.clone(), map, findings, unit, heights })
        };
        step(progress, "reading", || {
            let mut sheets = sources.iter().map(sheet).collect::<Result<Vec<Sheet>>>()?;
            let files: Vec<PathBuf> = sheets.iter().map(|sheet| sheet.file.clone()).collect();
            let Some(unit) = sheets.first().map(|sheet| sheet.unit) else {
                return Err(Error::Parameter("no file is given".into()));
            };
            let in_unit = sheets.iter().filter(|sheet| sheet.unit == unit);
            let heights = in_unit.flat_map(|sheet| sheet.heights.iter().copied()).collect();
            let read = match sheets.as_mut_slice() {
                [one] => Report { value: take(&mut one.map), findings: take(&mut one.findings) },
                _ => joined(sheets, options.plane_unit)?,
            };
            let input = Self::from_metres(read, (unit, heights), options);
            let input = input.map_err(|error| if let [file] = &files[..] { error.in_file(file) } else { error })?;
            Ok(Self { files, ..input })
        })
    }

    /// Reads spot heights from a file and adds them. An attribute `sigma` holds their standard errors; those without one
    /// have the standard error `sigma`, if there is one, in the unit of the heights. Without any, the surface passes
    /// through them.
    ///
    /// # Errors
    /// As [`read_spot_heights`] and [`Input::add_spots`]; the error names the file.
    pub fn read_spots(&mut self, source: &VectorSource, sigma: Option<f64>, progress: &dyn Progress) -> Result<()> {
        let path = &source.path;
        step(progress, "reading", || {
            let mut about = Vec::new();
            let SpotHeights { points, sigmas, crs, unit_hint, stated_unit } =
                read_spot_heights(path, &self.reading(source))?.collect(&mut about);
            self.take_findings(path, about, crs.as_ref())?;
            if let Some(system) = crs.as_ref().and_then(Crs::height_system) {
                self.note_heights(&path.display(), Some(&system));
            }
            let spots = points.into_iter().zip(sigmas.into_iter().map(|own| own.or(sigma)));
            let signs = Signs { stated: stated_unit.as_ref(), hint: unit_hint.as_ref() };
            let added = self.add_spots_with(spots, crs.as_ref(), signs);
            added.map_err(|error| error.in_file(path))
        })
    }

    /// Reads the features of a file in a role, and adds them: see [`Input::add`].
    ///
    /// # Errors
    /// As [`read_features`] and [`Input::add`]; the error names the file.
    pub fn read_features(&mut self, role: Role, source: &VectorSource) -> Result<()> {
        let path = &source.path;
        let Report { value, findings } = read_features(role, path, &self.reading(source))?;
        let FileFeatures { features, crs, unit } = value;
        self.take_findings(path, findings, crs.as_ref())?;
        // Most features have no heights, and name no system.
        if let Some(system) = crs.as_ref().and_then(Crs::height_system) {
            self.note_heights(&path.display(), Some(&system));
        }
        let signs = Signs { stated: unit.as_ref(), hint: None };
        self.add_from(&path.display().to_string(), features, crs.as_ref(), signs).map_err(|error| error.in_file(path))
    }

    /// Adds findings about a file beside the contours, in some coordinate reference system.
    fn take_findings(&mut self, path: &Path, mut findings: Vec<Finding>, crs: Option<&Crs>) -> Result<()> {
        let to_working = self.reprojection.bring(crs).map_err(|error| error.in_file(path))?;
        for finding in &mut findings {
            finding.message = beside_contours(path, finding);
            let place = finding.place.and_then(|p| to_working.point(p.extend(0.0)).ok());
            finding.place = place.map(|p| p.truncate());
        }
        self.findings.append(&mut findings);
        Ok(())
    }

    /// Reads the height map that gives the heights outside the frame.
    ///
    /// # Errors
    /// As [`read_dem`] and [`Input::set_base`]; the error names the file.
    pub fn read_base(&mut self, path: &Path, progress: &dyn Progress) -> Result<()> {
        let Report { value: DemFile { dem, height_system, .. }, findings } =
            step(progress, "reading", || read_dem(path))?;
        self.note_heights(&path.display(), height_system.as_ref());
        for finding in findings {
            self.findings.push(Finding { message: beside_contours(path, &finding), place: None, ..finding });
        }
        self.set_base(dem, path)
    }

    /// Reads a boundary polygon from a file: the ground ends there.
    ///
    /// # Errors
    /// As [`read_area`] and [`Input::set_boundary`]; the error names the file.
    pub fn read_boundary(&mut self, source: &VectorSource) -> Result<()> {
        let path = &source.path;
        let (area, crs) = read_area(path, &self.reading(source))?;
        self.set_boundary(&area, crs.as_ref()).map_err(|error| error.in_file(path))
    }

    /// Reads the polygons of the part of the map that results cover.
    ///
    /// # Errors
    /// As [`read_area`] and [`Input::set_part`]; the error names the file.
    pub fn read_part(&mut self, source: &VectorSource) -> Result<()> {
        let path = &source.path;
        let (area, crs) = read_area(path, &self.reading(source))?;
        self.set_part(&area, crs.as_ref()).map_err(|error| error.in_file(path))
    }

    /// How further files are read.
    fn reading(&self, source: &VectorSource) -> ReadOptions {
        let Self { memory, asked_unit: unit, depths, .. } = *self;
        ReadOptions { memory, unit, depths, ..source.reading() }
    }
}

/// The message of a finding about a file that is read beside the contours.
fn beside_contours(path: &Path, finding: &Finding) -> String {
    let system = match finding.kind {
        FindingKind::UnknownCrs => "; it is taken to be in that of the contours",
        _ => "",
    };
    format!("{}: {}{system}", path.display(), finding.message)
}
