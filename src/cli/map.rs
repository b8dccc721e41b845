//! The arguments about the map, and reading it into a clean one on a plane in metres.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::base::error::{Error, Finding, Severity};
use tokosen::clean::CleanParams;
use tokosen::contour::{ContourMap, ElevationUnit, find_interval};
use tokosen::crs::{Crs, Places};
use tokosen::io::{ReadOptions, read_contours, read_spot_heights};

use super::console::Console;
use super::repair::{self, Repair};
use super::{Failure, plane, summary};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Input")]
pub struct MapArgs {
    /// Contour lines: GeoJSON (.geojson, .json), GeoPackage (.gpkg), shapefile (.shp), FlatGeobuf (.fgb), DXF (.dxf), or
    /// 基盤地図情報 (a .xml, .zip or folder), in any coordinate reference system
    pub contours: PathBuf,
    /// Attribute that holds the elevation [default: recognised by name, else the z coordinate]
    #[arg(short = 'a', long, value_name = "FIELD")]
    pub elevation_field: Option<String>,
    /// Layer of a GeoPackage with several, or layers of a DXF: A,B
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Spot heights: points with an elevation, which the surface then passes through
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// Unit of the elevations of contours, spot heights and lakes; on output they are metres
    #[arg(long, value_enum, default_value_t = UnitArg::M)]
    pub unit: UnitArg,
    /// Coordinate reference system of the contours, where the file names none or a wrong one: EPSG:6668, or a WKT
    #[arg(long, value_name = "CRS", value_parser = plane::crs)]
    pub crs: Option<Crs>,
    /// Projected system in metres to work in [default: the input's own; for degrees and feet the Japanese plane rectangular
    /// zone or the UTM zone of the data, or a transverse Mercator about them]
    #[arg(long, value_name = "CRS", value_parser = plane::crs)]
    pub work_crs: Option<Crs>,
    /// Join ends of one elevation that are at most so far apart, and close rings with such a gap [units of the working CRS]
    #[arg(long, value_name = "DISTANCE", default_value_t = SNAP, allow_negative_numbers = true)]
    pub snap: f64,
    /// How far to repair the contours: not at all, which stops where lines must be cut or joined; only what cannot change
    /// their meaning (repeated points, duplicates, ends within --snap, vertices that stray across another line, else the
    /// smallest piece where lines cross); or also elevations, gaps and stray vertices that cross nothing, as
    /// 'tokosen check' proposes
    #[arg(long, value_enum, value_name = "HOW")]
    pub repair: Option<Repair>,
    /// Stop with exit status 1 when anything is wrong with the input (notes are not), instead of going on without the
    /// smallest piece
    #[arg(long)]
    pub strict: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnitArg {
    /// Metres
    M,
    /// International feet
    Ft,
    /// US survey feet
    UsFt,
}

impl UnitArg {
    /// The library's word.
    pub fn unit(self) -> ElevationUnit {
        match self {
            Self::M => ElevationUnit::Metre,
            Self::Ft => ElevationUnit::Foot,
            Self::UsFt => ElevationUnit::UsSurveyFoot,
        }
    }
}

/// Default of `--snap`.
const SNAP: f64 = 0.01;

/// A clean map with all that was noticed about it.
pub struct Input {
    /// The file of the contours.
    pub path: PathBuf,
    /// In coordinates of the working CRS.
    pub map: ContourMap,
    /// Their places are in the working CRS too.
    pub findings: Vec<Finding>,
    /// How the working CRS lies to the coordinates of the files.
    pub places: Places,
    /// Unit of elevations in further files.
    pub unit: ElevationUnit,
}

impl MapArgs {
    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(&self.contours).chain(&self.points).map(PathBuf::as_path)
    }

    /// The flags that say something about contours, and whether they are given.
    pub fn flags(&self) -> impl Iterator<Item = (bool, &'static str)> {
        [
            (self.elevation_field.is_some(), "--elevation-field"),
            (self.layer.is_some(), "--layer"),
            (self.unit != UnitArg::M, "--unit"),
            (self.crs.is_some(), "--crs"),
            (self.work_crs.is_some(), "--work-crs"),
            (self.snap != SNAP, "--snap"),
            (self.repair.is_some(), "--repair"),
        ]
        .into_iter()
    }

    /// How far the map is repaired.
    pub fn repair(&self) -> Repair {
        self.repair.unwrap_or(Repair::Safe)
    }

    /// What counts as near when the map is cleaned.
    pub fn clean_params(&self) -> CleanParams {
        CleanParams { snap: self.snap, ..CleanParams::default() }
    }

    /// Reads the map, repairs it as far as it is asked for and cleans it.
    pub fn read(&self, console: &Console) -> Result<Input, Failure> {
        if !(self.snap.is_finite() && self.snap >= 0.0) {
            return Err(Failure::Usage(format!("--snap is {}, it must be 0 or more", self.snap)));
        }
        let options = ReadOptions { elevation_field: self.elevation_field.clone(), layer: self.layer.clone() };
        let mut findings = Vec::new();
        let (map, places) = console.step("reading", || -> Result<(ContourMap, Places), Failure> {
            let map = read_contours(&self.contours, &options)?.collect(&mut findings);
            let map = plane::named(self.unit.unit().map_in_metres(map), self.crs.as_ref(), &mut findings);
            let (mut map, places) = plane::flat(&self.contours, map, self.work_crs.as_ref(), &mut findings)?;
            if let Some(path) = &self.points {
                let mut about = Vec::new();
                let spots = read_spot_heights(path, &ReadOptions::default())?.collect(&mut about);
                let bring = plane::bringer(&places, path, spots.crs.as_ref())?;
                for finding in &mut about {
                    let place = finding.place.and_then(|p| bring.point(p.extend(0.0)).ok());
                    finding.place = place.map(|p| p.truncate());
                }
                findings.append(&mut about);
                for spot in spots.points {
                    let spot = spot.truncate().extend(self.unit.unit().metres(spot.z));
                    map.spots.push(bring.point(spot).map_err(|e| Error::file(path, e.to_string()))?);
                }
            }
            Ok((map, places))
        })?;
        console.places_are(&places);
        let map = repair::cleaned(map, self, &mut findings, console)?;
        let unit = self.unit.unit();
        repair::corrected(Input { path: self.contours.clone(), map, findings, places, unit }, self, console)
    }

    /// With `--strict`, an error or a warning ends the work.
    pub fn check_strict(&self, findings: &[Finding], console: &Console) -> Result<(), Failure> {
        let checked = self.strictly(findings);
        if checked.is_err() {
            console.clear();
            summary::findings(findings, console);
        }
        checked
    }

    /// The same where the findings are told already.
    pub fn strictly(&self, findings: &[Finding]) -> Result<(), Failure> {
        let is_wrong = |finding: &&Finding| finding.kind.severity() > Severity::Note;
        match findings.iter().filter(is_wrong).count() {
            count if self.strict && count > 0 => {
                let count = if count == 1 { "1 finding".into() } else { format!("{count} findings") };
                let message = format!("{count} about {}, and --strict is set", self.contours.display());
                Err(Failure::Work(Error::Data(message)))
            }
            _ => Ok(()),
        }
    }

    /// The lines of the summary that describe the input.
    pub fn describe(&self, map: &ContourMap, console: &Console) {
        let levels = || map.contours.iter().map(|c| c.elevation);
        let (low, high) = levels().fold((f64::INFINITY, f64::NEG_INFINITY), |m, z| (m.0.min(z), m.1.max(z)));
        let mut distinct: Vec<f64> = levels().collect();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        let interval = find_interval(&map.contours).map_or("unknown".into(), |i| format!("{} m", i.step));
        console.say(&format!("input      {}", self.contours.display()));
        let what = match distinct.len() {
            0 => "none".to_owned(),
            1 => format!("{} lines, {} vertices, all at {low} m", map.contours.len(), map.vertex_count()),
            n => format!(
                "{} lines, {} vertices, {n} levels from {low} to {high} m, vertical interval {interval}",
                map.contours.len(),
                map.vertex_count(),
            ),
        };
        console.say(&format!("contours   {what}"));
        if !map.spots.is_empty() {
            console.say(&format!("spots      {}", map.spots.len()));
        }
        console.say(&format!("crs        {}", plane::describe(map, console.places())));
    }
}
