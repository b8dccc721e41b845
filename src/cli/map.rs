//! The arguments about the map.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::contour::{ContourMap, find_interval};
use tokosen::crs::Crs;
use tokosen::terrain::{Preparation, Repair};
use tokosen::{Input, InputOptions};

use super::console::Console;
use super::failure::Failure;
use super::unit::UnitArg;
use super::{memory, plane};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Input")]
pub struct MapArgs {
    /// Contour lines: GeoJSON (.geojson, .json), GeoPackage (.gpkg), shapefile (.shp), FlatGeobuf (.fgb), DXF (.dxf),
    /// or 基盤地図情報 (a .xml, .zip or folder), in any coordinate reference system
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
    /// Unit of the elevations of contours, spot heights and lakes [default: that of the vertical part of each file's
    /// CRS, such as NAVD88 height (ftUS); else that of the contours; else metres]
    #[arg(long, value_enum)]
    pub unit: Option<UnitArg>,
    /// Coordinate reference system of the contours, if the file names none or a wrong one: EPSG:6668, or a WKT
    #[arg(long, value_name = "CRS", value_parser = plane::crs)]
    pub crs: Option<Crs>,
    /// Projected system in metres to work in, the working CRS [default: the input's own; for degrees and feet the
    /// Japanese plane rectangular zone or the UTM zone of the data, or a transverse Mercator about them]
    #[arg(long, value_name = "CRS", value_parser = plane::crs)]
    pub work_crs: Option<Crs>,
    /// Join line ends of one elevation up to this distance, and close rings with such a gap [units of the working CRS]
    #[arg(long, value_name = "DISTANCE", default_value_t = SNAP, allow_negative_numbers = true)]
    pub snap: f64,
    /// How far to repair the contours. Safe repairs, also made without this option, are those of repeated points,
    /// duplicates, line ends within --snap and crossings. At a crossing, vertices that stray across the other line are
    /// removed; otherwise the shorter crossing part is removed
    #[arg(long, value_enum, value_name = "HOW")]
    pub repair: Option<RepairArg>,
    /// Stop with exit status 1 if there is an error or a warning about the input, instead of going on with safe repairs
    #[arg(long)]
    pub strict: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RepairArg {
    /// No repair; stop where lines must be cut or joined
    None,
    /// Only what cannot change the meaning of the contours
    Safe,
    /// Also elevations, gaps and stray vertices that cross nothing, as 'tokosen check' proposes
    All,
}

impl RepairArg {
    /// The library's setting.
    fn repair(self) -> Repair {
        match self {
            Self::None => Repair::None,
            Self::Safe => Repair::Safe,
            Self::All => Repair::All,
        }
    }
}

/// Default of `--snap`.
const SNAP: f64 = 0.01;

impl MapArgs {
    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(&self.contours).chain(&self.points).map(PathBuf::as_path)
    }

    /// The flags that apply to contours, and whether they are given.
    pub fn flags(&self) -> impl Iterator<Item = (bool, &'static str)> {
        [
            (self.elevation_field.is_some(), "--elevation-field"),
            (self.layer.is_some(), "--layer"),
            (self.unit.is_some(), "--unit"),
            (self.crs.is_some(), "--crs"),
            (self.work_crs.is_some(), "--work-crs"),
            (self.snap != SNAP, "--snap"),
            (self.repair.is_some(), "--repair"),
        ]
        .into_iter()
    }

    /// How the lines are prepared.
    pub fn preparation(&self) -> Preparation {
        let repair = self.repair.map_or(Repair::Safe, RepairArg::repair);
        Preparation { snap: self.snap, repair, strict: self.strict, ..Preparation::default() }
    }

    /// Reads the map.
    pub fn read(&self, console: &Console) -> Result<Input, Failure> {
        let options = InputOptions {
            elevation_field: self.elevation_field.clone(),
            layer: self.layer.clone(),
            unit: self.unit.map(UnitArg::unit),
            crs: self.crs.clone(),
            work_crs: self.work_crs.clone(),
            memory: memory::available(),
        };
        let mut input = Input::read_with(&self.contours, &options, console)?;
        if let Some(path) = &self.points {
            input.read_spots(path, console)?;
        }
        console.set_input(&input);
        Ok(input)
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
        let size = format!("{} lines, {} vertices", map.contours.len(), map.vertex_count());
        let what = match distinct.len() {
            0 => "none".to_owned(),
            1 => format!("{size}, all at {low} m"),
            n => format!("{size}, {n} levels from {low} to {high} m, vertical interval {interval}"),
        };
        console.say(&format!("contours   {what}"));
        if !map.spots.is_empty() {
            console.say(&format!("spots      {}", map.spots.len()));
        }
        if console.unit().is_foot() {
            let unit = console.unit().name();
            console.say(&format!("unit       the elevations of the input were {unit}; these figures are in metres"));
        }
        console.say(&format!("crs        {}", plane::describe(map, console.reprojection())));
    }
}
