//! The arguments about the input, and reading it into a clean map on a plane in metres.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::contour::{
    CleanParams, ContourMap, ElevationUnit, FitParams, Fitted, SampleParams, Sampled, clean, find_interval, fit, sample,
};
use tokosen::crs::{Crs, Places};
use tokosen::error::{Error, Finding};
use tokosen::io::{ReadOptions, read_contours, read_spot_heights};

use super::console::Console;
use super::{Failure, plane, summary};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Input")]
pub struct InputArgs {
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
    /// Smooth the contours: fit each with a curve that stays so near, and space its vertices evenly [units of the working
    /// CRS]. The input is then not kept vertex for vertex
    #[arg(long, value_name = "TOLERANCE")]
    pub fit: Option<f64>,
    /// Add vertices until, for each of them, its neighbours on the line are at most S times as far away as the nearest other
    /// contour; the input's own vertices stay. With --fit the points lie on the fitted curve
    #[arg(long, value_name = "S", value_parser = sampling_ratio, allow_negative_numbers = true)]
    pub sample: Option<f64>,
    /// Stop with exit status 1 when anything is wrong with the input, instead of going on without the smallest piece
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
    /// In coordinates of the working CRS.
    pub map: ContourMap,
    /// Their places are in the working CRS too.
    pub findings: Vec<Finding>,
    /// How the working CRS lies to the coordinates of the files.
    pub places: Places,
    /// Unit of elevations in further files.
    pub unit: ElevationUnit,
}

impl InputArgs {
    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(&self.contours).chain(&self.points).map(PathBuf::as_path)
    }

    /// The first flag that says something about contours, if there is one; a run without contours must not pass over it.
    pub fn about_contours(&self) -> Option<&'static str> {
        let given = [
            (self.elevation_field.is_some(), "--elevation-field"),
            (self.layer.is_some(), "--layer"),
            (self.unit != UnitArg::M, "--unit"),
            (self.crs.is_some(), "--crs"),
            (self.work_crs.is_some(), "--work-crs"),
            (self.snap != SNAP, "--snap"),
            (self.fit.is_some(), "--fit"),
            (self.sample.is_some(), "--sample"),
        ];
        first_given(&given)
    }

    /// Reads and cleans the map.
    pub fn read(&self, console: &Console) -> Result<Input, Failure> {
        if !(self.snap.is_finite() && self.snap >= 0.0) {
            return Err(Failure::Usage(format!("--snap is {}, it must be 0 or more", self.snap)));
        }
        if let Some(tolerance) = self.fit
            && !(tolerance.is_finite() && tolerance > 0.0)
        {
            return Err(Failure::Usage(format!("--fit is {tolerance}, it must be more than 0")));
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
        let params = CleanParams { snap: self.snap, ..CleanParams::default() };
        let cleaned = console.step("cleaning", || clean(map, &params));
        let map = summary::or_tell(cleaned, &findings, console)?.collect(&mut findings);
        let map = match self.fit {
            Some(tolerance) => {
                let fitted =
                    console.step("fitting", || fit(map, &FitParams { tolerance, sampling: self.sampling() }, &params));
                let fitted = summary::or_tell(fitted, &findings, console)?.collect(&mut findings);
                describe_fit(&fitted, console);
                fitted.map
            }
            None => map,
        };
        let map = match self.sampling() {
            Some(sampling) => {
                let sampled = console.step("sampling", || sample(map, &sampling, &params));
                let sampled = summary::or_tell(sampled, &findings, console)?.collect(&mut findings);
                describe_sample(&sampled, console);
                sampled.map
            }
            None => map,
        };
        self.check_strict(&findings, console)?;
        Ok(Input { map, findings, places, unit: self.unit.unit() })
    }

    fn sampling(&self) -> Option<SampleParams> {
        self.sample.map(|ratio| SampleParams { ratio, ..SampleParams::default() })
    }

    /// With `--strict`, any finding ends the work.
    pub fn check_strict(&self, findings: &[Finding], console: &Console) -> Result<(), Failure> {
        if self.strict && !findings.is_empty() {
            console.clear();
            summary::findings(findings, console);
            let count = if findings.len() == 1 { "1 finding".into() } else { format!("{} findings", findings.len()) };
            let message = format!("{count} about {}, and --strict is set", self.contours.display());
            return Err(Failure::Work(Error::Data(message)));
        }
        Ok(())
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
        console.say(&format!(
            "contours   {} lines, {} vertices, {} levels from {low} to {high} m, vertical interval {interval}",
            map.contours.len(),
            map.vertex_count(),
            distinct.len(),
        ));
        if !map.spots.is_empty() {
            console.say(&format!("spots      {}", map.spots.len()));
        }
        console.say(&format!("crs        {}", plane::describe(map, console.places())));
    }
}

/// The name of the first flag that is given.
pub fn first_given(flags: &[(bool, &'static str)]) -> Option<&'static str> {
    flags.iter().find(|(is_given, _)| *is_given).map(|(_, flag)| *flag)
}

fn describe_fit(fitted: &Fitted, console: &Console) {
    let [half, quarter, eighth] = fitted.narrowed;
    console.say(&format!(
        "fitted     {} vertices with {} control points, {} vertices out, off by {:.3} at most; tolerance halved for {half} \
         lines, quartered for {quarter}, an eighth for {eighth}; {} lines unchanged",
        fitted.vertices_before, fitted.control_points, fitted.vertices_after, fitted.deviation, fitted.unchanged
    ));
}

fn describe_sample(sampled: &Sampled, console: &Console) {
    console.say(&format!(
        "sampled    {} vertices added; {} pieces kept longer by the lower limit of {:.3}, {} segments left whole lest lines \
         meet",
        sampled.added, sampled.held, sampled.least, sampled.whole
    ));
}

fn sampling_ratio(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(ratio) if ratio > 0.0 && ratio < 1.0 => Ok(ratio),
        _ => Err("it must be more than 0 and less than 1".into()),
    }
}
