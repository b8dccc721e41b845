//! The arguments about the map.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::base::error::Error;
use tokosen::contour::{ContourMap, find_interval};
use tokosen::crs::Crs;
use tokosen::io::{Content, VectorSource, content};
use tokosen::terrain::{Preparation, Repair};
use tokosen::{Input, InputOptions};

use super::console::Console;
use super::failure::Failure;
use super::features::{MapFeatureArgs, paths};
use super::source::source;
use super::unit::UnitArg;
use super::viewer::title;
use super::{memory, plane};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Input")]
pub struct MapArgs {
    /// Contour lines: GeoJSON (.geojson, .json, .geojsonl, .geojsons), GeoPackage (.gpkg), shapefile (.shp, also in a
    /// .zip), FlatGeobuf (.fgb), GeoParquet (.parquet), DXF (.dxf), KML (.kml, .kmz), GML (.gml), well-known text (.csv, .tsv), or 基盤地図情報 (a .xml, .zip or folder), in any coordinate reference system. Several files, a folder or a pattern
    /// such as 'sheets/*.shp' are one map. A layer can follow the file: 'all.gpkg|layername=contours', and a box that features must meet: 'all.gpkg|bbox=XMIN,YMIN,XMAX,YMAX'
    #[arg(required = true, value_name = "CONTOURS", value_parser = source())]
    pub contours: Vec<VectorSource>,
    /// Attribute that holds the elevation [default: recognised by name, else the z coordinate]
    #[arg(short = 'a', long, value_name = "FIELD")]
    pub elevation_field: Option<String>,
    /// Layer of a GeoPackage, type of the features of a GML, or shapefile in a .zip with several; layers of a DXF: A,B
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Spot heights: points with an elevation, which the surface then passes through. A vector file, or text with columns
    /// such as x,y,z or lon,lat,elev (.csv, .txt, .xyz)
    #[arg(long, value_name = "FILE", value_parser = source())]
    pub points: Option<VectorSource>,
    /// Standard error of the spot heights of --points: the surface comes near them instead of passing through. An attribute
    /// sigma gives each point its own [unit of the spot heights]
    #[arg(long, value_name = "SIGMA", requires = "points")]
    pub points_sigma: Option<f64>,
    #[command(flatten)]
    pub features: MapFeatureArgs,
    /// Unit of the elevations of contours, spot heights and lakes [default: that which an attribute such as units or uom
    /// states beside them; else that of the vertical part of each file's CRS, such as NAVD88 height (ftUS); else that of the
    /// contours; else metres]
    #[arg(long, value_enum, hide_short_help = true)]
    pub unit: Option<UnitArg>,
    /// Unit of x and y of contours without a CRS, and of files beside them without one [default: that of the drawing
    /// ($INSUNITS of a DXF); else metres]. The work is done in metres; lines, height maps and models come back in this unit
    #[arg(long, value_enum, hide_short_help = true)]
    pub plane_unit: Option<UnitArg>,
    /// Read depths as negative elevations: the numbers of the attribute of --elevation-field, or else of attributes with
    /// names such as depth, VALDCO or 水深. Other elevations stay as they are
    #[arg(long, hide_short_help = true)]
    pub depths: bool,
    /// Coordinate reference system of the contours, if the file names none or a wrong one: EPSG:6668, or a WKT
    #[arg(long, value_name = "CRS", value_parser = plane::crs)]
    pub crs: Option<Crs>,
    /// Projected system in metres to work in, the working CRS [default: the input's own; for degrees and feet the
    /// Japanese plane rectangular zone or the UTM zone of the data, or a transverse Mercator about them]
    #[arg(long, value_name = "CRS", value_parser = plane::crs, hide_short_help = true)]
    pub work_crs: Option<Crs>,
    /// Join line ends of one elevation up to this distance, and close rings with such a gap [units of the working CRS]
    #[arg(long, value_name = "DISTANCE", default_value_t = SNAP, hide_short_help = true)]
    pub snap: f64,
    /// How far to repair the contours. Safe repairs, also made without this option, are those of repeated points,
    /// duplicates, line ends within --snap and crossings. At a crossing, vertices that stray across the other line are
    /// removed; otherwise the shorter crossing part is removed
    #[arg(long, value_enum, value_name = "HOW", hide_short_help = true)]
    pub repair: Option<RepairArg>,
    /// Stop with exit status 1 if there is an error or a warning about the input, instead of going on with safe repairs
    #[arg(long, hide_short_help = true)]
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

/// The flags that apply to contours alone, beside those of roles.
pub const ABOUT_CONTOURS: [&str; 10] = [
    "--elevation-field",
    "--layer",
    "--points-sigma",
    "--unit",
    "--plane-unit",
    "--depths",
    "--crs",
    "--work-crs",
    "--snap",
    "--repair",
];

impl MapArgs {
    /// The files that are read: patterns and folders are expanded.
    pub fn files(&self) -> Result<Vec<PathBuf>, Failure> {
        let contours = self.sources()?;
        let others = self.points.iter().map(|source| source.path.as_path()).chain(paths(self.features.sources()));
        Ok(contours.into_iter().map(|source| source.path).chain(others.map(Path::to_owned)).collect())
    }

    /// The sources of the contours: patterns and folders are expanded.
    pub fn sources(&self) -> Result<Vec<VectorSource>, Failure> {
        let sources = self.contours.iter().map(VectorSource::expand).collect::<Result<Vec<_>, _>>()?;
        Ok(sources.into_iter().flatten().collect())
    }

    /// What the input holds. Several files must hold contours.
    pub fn content(&self) -> Result<Content, Failure> {
        let sources = self.sources()?;
        let contents = sources.iter().map(|source| content(&source.path)).collect::<Result<Vec<_>, _>>()?;
        match (sources.as_slice(), contents.as_slice()) {
            ([VectorSource { layer: Some(_), .. }], [Content::HeightMap]) => {
                Err(Failure::Usage("a height map has no layers: leave out |layername=".into()))
            }
            (_, [only]) => Ok(*only),
            (sources, contents) => match contents.iter().position(|content| *content == Content::HeightMap) {
                Some(k) => {
                    let path = sources[k].path.display();
                    Err(Failure::Usage(format!("{path} is a height map; only one height map can be the input")))
                }
                None => Ok(Content::Contours),
            },
        }
    }

    /// The file of the input, if it is one; otherwise the first.
    pub fn file(&self) -> &Path {
        self.contours.first().map_or(Path::new(""), |source| &source.path)
    }

    /// The input in words.
    pub fn name(&self) -> String {
        let names: Vec<String> = self.contours.iter().map(|source| source.path.display().to_string()).collect();
        names.join(", ")
    }

    /// What a page of the input is called.
    pub fn title(&self) -> String {
        title(&self.contours.iter().map(|source| source.path.as_path()).collect::<Vec<_>>())
    }

    /// How the lines are prepared.
    pub fn preparation(&self) -> Preparation {
        let repair = self.repair.map_or(Repair::Safe, RepairArg::repair);
        Preparation { snap: self.snap, repair, strict: self.strict, ..Preparation::default() }
    }

    /// Reads the map.
    pub fn read(&self, console: &Console) -> Result<Input, Failure> {
        let sources = self.sources()?;
        // What is neither is an error that the reader explains.
        let is_height_map = |source: &&VectorSource| matches!(content(&source.path), Ok(Content::HeightMap));
        if let Some(source) = sources.iter().find(is_height_map) {
            let is_xml = source.path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("xml"));
            let what = if is_xml { "its cells or triangles are a height map" } else { "this is a height map" };
            let message = format!("{what}, and contour lines are needed; 'tokosen contour' draws its contours");
            return Err(Failure::Work(Error::file(&source.path, message)));
        }
        let options = InputOptions {
            elevation_field: self.elevation_field.clone(),
            layer: self.layer.clone(),
            unit: self.unit.map(UnitArg::unit),
            plane_unit: self.plane_unit.map(UnitArg::unit),
            depths: self.depths,
            crs: self.crs.clone(),
            work_crs: self.work_crs.clone(),
            memory: memory::available(),
        };
        let mut input = Input::read_all(&sources, &options, console)?;
        if let Some(sigma) = self.points_sigma.filter(|sigma| !(sigma.is_finite() && *sigma >= 0.0)) {
            return Err(Failure::Usage(format!("--points-sigma is {sigma}: it must be 0 or more")));
        }
        if let Some(source) = &self.points {
            input.read_spots(source, self.points_sigma, console)?;
        }
        self.features.add_to(&mut input)?;
        console.set_input(&input);
        Ok(input)
    }

    /// The lines of the summary that describe the input.
    pub fn describe(&self, map: &ContourMap, console: &Console) {
        let units = console.units();
        let levels = || map.contours.iter().map(|c| c.elevation);
        let (low, high) = levels().fold((f64::INFINITY, f64::NEG_INFINITY), |m, z| (m.0.min(z), m.1.max(z)));
        let mut distinct: Vec<f64> = levels().collect();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        let interval = find_interval(&map.contours).map_or("unknown".into(), |i| units.height(i.step));
        console.say(&format!("input      {}", self.name()));
        let vertices = if console.verbose { format!(", {} vertices", map.vertex_count()) } else { String::new() };
        let size = format!("{} lines{vertices}", map.contours.len());
        let what = match distinct.len() {
            0 => "none".to_owned(),
            1 => format!("{size}, all at {}", units.height(low)),
            n => {
                let (low, high) = (units.height_number(low), units.height(high));
                format!("{size}, {n} levels from {low} to {high}, vertical interval {interval}")
            }
        };
        console.say(&format!("contours   {what}"));
        let soft = map.soft_spots.len();
        if map.spots.len() + soft > 0 {
            let of_them = if soft > 0 { format!(", {soft} of them with a standard error") } else { String::new() };
            console.say(&format!("spots      {}{of_them}", map.spots.len() + soft));
        }
        if units.heights.is_foot() {
            let unit = units.heights.name();
            console.say(&format!("unit       the elevations of the input are {unit}, and so are these figures"));
        }
        console.say(&format!("crs        {}", plane::describe(map, console.reprojection())));
        let heights = map.height_system.as_ref().map_or("the input does not name their system", |s| s.name.as_str());
        console.say(&format!("heights    {heights}"));
        if let Some(why) = plane::why_not_wgs84(console.reprojection()).filter(|_| self.work_crs.is_none()) {
            console.say(&format!("           {why}"));
        }
    }
}
