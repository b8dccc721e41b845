//! The arguments about lines, polygons and points beside the contours, and about pits.

use std::path::Path;

use clap::builder::TypedValueParser;
use clap::{Args, ValueEnum};
use tokosen::Input;
use tokosen::base::ElevationUnit;
use tokosen::drain::Drain;
use tokosen::features::Role;
use tokosen::io::VectorSource;

use super::failure::Failure;
use super::source::source;

/// Files, each with the role of its features.
pub type Sources<'a> = Vec<(Role, &'a VectorSource)>;

/// The files in one role.
fn in_role<'a>(role: Role, sources: impl IntoIterator<Item = &'a VectorSource>) -> Sources<'a> {
    sources.into_iter().map(|source| (role, source)).collect()
}

/// The paths of files.
pub fn paths<'a>(sources: Sources<'a>) -> impl Iterator<Item = &'a Path> {
    sources.into_iter().map(|(_, source)| source.path.as_path())
}

/// Reads files and adds their features to an input.
pub fn add(sources: Sources<'_>, input: &mut Input) -> Result<(), Failure> {
    sources.into_iter().try_for_each(|(role, source)| Ok(input.read_features(role, source)?))
}

/// What belongs to the map itself.
#[derive(Debug, Clone, Args)]
pub struct MapFeatureArgs {
    /// Leave out the contours and spot heights inside the polygons of this file, for instance of a quarry or of wrong
    /// lines; the surface bridges them. Can be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    exclude: Vec<VectorSource>,
    /// Cliffs: lines across which the surface may jump. Contours that end at them or run together in them are no fault. Can
    /// be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    cliffs: Vec<VectorSource>,
    /// Coast: lines, or polygons of land or sea, at their elevation attribute or z, otherwise at 0; or the level of contours
    /// that are the coast. The sea becomes level; the contours show which side is land
    #[arg(long, value_name = "FILE|LEVEL", value_parser = CoastArg::parser())]
    coast: Option<CoastArg>,
}

/// Where the coast is.
#[derive(Debug, Clone, PartialEq)]
enum CoastArg {
    /// The contours of a level.
    Level(f64),
    /// The lines or polygons of a file.
    File(VectorSource),
}

impl CoastArg {
    /// Reads a level, otherwise the name of a file.
    fn parser() -> impl TypedValueParser<Value = Self> {
        source().map(|source| match source.path.to_str().map(str::parse) {
            Some(Ok(level)) if source.layer.is_none() => Self::Level(level),
            _ => Self::File(source),
        })
    }
}

impl MapFeatureArgs {
    /// The files.
    pub fn sources(&self) -> Sources<'_> {
        let coast = match &self.coast {
            Some(CoastArg::File(source)) => Some(source),
            Some(CoastArg::Level(_)) | None => None,
        };
        let roles =
            [in_role(Role::Coast, coast), in_role(Role::Exclude, &self.exclude), in_role(Role::Cliffs, &self.cliffs)];
        roles.concat()
    }

    /// Adds the features to an input; reads their files.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        match self.coast {
            Some(CoastArg::Level(level)) if !level.is_finite() => {
                return Err(Failure::Usage(format!("--coast is {level}, which is no elevation")));
            }
            Some(CoastArg::Level(level)) => input.set_coast_level(level)?,
            Some(CoastArg::File(_)) | None => {}
        }
        add(self.sources(), input)
    }
}

#[derive(Debug, Clone, Args)]
pub struct WaterArgs {
    /// Lakes: polygons that are level, at their elevation attribute or z, otherwise at the height of their shore; holes
    /// are islands
    #[arg(long, value_name = "FILE", value_parser = source())]
    water: Option<VectorSource>,
    /// Level of the sea [metres, or the unit of --to-unit if the command has it]; the input must have contours at it.
    /// Ground that reaches down only to contours of this level becomes level sea
    #[arg(long, value_name = "LEVEL")]
    pub sea: Option<f64>,
}

impl WaterArgs {
    /// The file with lakes, if there is one.
    pub fn sources(&self) -> Sources<'_> {
        in_role(Role::Water, &self.water)
    }

    /// The level of the sea, metres. It was given in `unit`.
    pub fn sea_in_metres(&self, unit: ElevationUnit) -> Option<f64> {
        self.sea.map(|level| unit.metres(level))
    }

    /// Checks the level of the sea.
    pub fn check(&self) -> Result<(), Failure> {
        match self.sea.filter(|sea| !sea.is_finite()) {
            Some(sea) => Err(Failure::Usage(format!("--sea is {sea}, which is no elevation"))),
            None => Ok(()),
        }
    }
}

#[derive(Debug, Clone, Args)]
pub struct StreamArgs {
    /// Lines of rivers and streams, drawn in any direction: the surface falls steadily along them. Contours count more
    /// than streams. May be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    streams: Vec<VectorSource>,
    /// Move streams up to this distance into the bends of contours; beyond it, contours cut streams [units of the working
    /// CRS; default: a quarter of the mean spacing of the contours]
    #[arg(long, value_name = "DISTANCE", requires = "streams", hide_short_help = true)]
    pub stream_tolerance: Option<f64>,
}

impl StreamArgs {
    /// The files with streams.
    pub fn sources(&self) -> Sources<'_> {
        in_role(Role::Streams, &self.streams)
    }
}

#[derive(Debug, Clone, Args)]
pub struct BreakLineArgs {
    /// Break lines: lines along which the ground bends sharply, such as edges of ditches and embankments. Lines with z give
    /// heights, which the surface then passes through. An attribute kind = ridge, valley or edge says how the ground bends.
    /// Can be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    breaklines: Vec<VectorSource>,
}

impl BreakLineArgs {
    /// The files with break lines.
    pub fn sources(&self) -> Sources<'_> {
        in_role(Role::BreakLines, &self.breaklines)
    }
}

#[derive(Debug, Clone, Args)]
pub struct DrainArgs {
    /// Points or polygons where water may stay, for instance in karst or quarries: a point keeps the pit that holds it, a
    /// polygon keeps all inside. May be given several times
    #[arg(long, value_name = "FILE", value_parser = source())]
    sinks: Vec<VectorSource>,
    /// Which pits get a way out
    #[arg(long, value_enum, value_name = "WHICH", default_value_t = DrainArg::Safe, hide_short_help = true)]
    pub drain: DrainArg,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DrainArg {
    /// None: pits stay
    None,
    /// Pits that no contour speaks for
    Safe,
    /// All pits, except in --sinks and in water: height maps then leave the contours where nothing else drains a pit
    All,
}

impl DrainArg {
    /// The library's setting.
    pub fn drain(self) -> Drain {
        match self {
            Self::None => Drain::None,
            Self::Safe => Drain::Safe,
            Self::All => Drain::All,
        }
    }
}

impl DrainArgs {
    /// The files with sinks.
    pub fn sources(&self) -> Sources<'_> {
        in_role(Role::Sinks, &self.sinks)
    }
}
