//! The arguments about the surface.

use std::path::Path;

use clap::builder::TypedValueParser;
use clap::{Args, ValueEnum};
use tokosen::base::ElevationUnit;
use tokosen::features::{Role, Serves};
use tokosen::io::VectorSource;
use tokosen::subdomains::Frame;
use tokosen::surface::{SurfaceKind, Triangles, Uncertainty};
use tokosen::tuning::Tuning;
use tokosen::{GridSpec, Input, Options};

use super::failure::Failure;
use super::features::{self, BreakLineArgs, DrainArgs, Sources, StreamArgs, WaterArgs, paths};
use super::flags::Flags;
use super::memory;
use super::source::source;

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Surface")]
pub struct SurfaceArgs {
    /// How heights between contours are interpolated
    #[arg(long, value_enum, default_value_t = KindArg::Spline, hide_short_help = true)]
    pub surface: KindArg,
    #[command(flatten)]
    pub frame: FrameArgs,
    #[command(flatten)]
    pub water: WaterArgs,
    #[command(flatten)]
    pub streams: StreamArgs,
    #[command(flatten)]
    pub break_lines: BreakLineArgs,
    #[command(flatten)]
    pub drain: DrainArgs,
    /// Resolution parameter w of the method: larger values give fewer ridge and canyon lines
    #[arg(long, value_name = "W", default_value_t = RESOLUTION, hide_short_help = true)]
    pub resolution: f64,
    /// Tension of the smooth surface: 0 is minimum curvature, 10 and more is close to the surface with ridge and canyon
    /// lines [default: chosen from the contours]
    #[arg(long, value_name = "T", hide_short_help = true)]
    pub tension: Option<f64>,
    /// Noise of the contours: 0 for smooth ones, 1 for those with jitter, as from unsmoothed lidar [default: chosen
    /// from the contours]
    #[arg(long, value_name = "N", hide_short_help = true)]
    pub noise: Option<f64>,
    /// Another value of a tuned number, for scripts/bench/sweep.py
    #[arg(long, value_name = "NAME=VALUE", hide = true)]
    pub tune: Vec<String>,
}

/// Default of `--resolution`.
const RESOLUTION: f64 = 1.0;

/// The flags about the surface beside those of [`Role`]s, and what each serves.
const ABOUT_SURFACE: [(&str, Serves); 8] = [
    ("--surface", Serves::Surface),
    ("--frame", Serves::Surface),
    ("--sea", Serves::Surface),
    ("--resolution", Serves::Skeleton),
    ("--tension", Serves::Spline),
    ("--noise", Serves::Spline),
    ("--tune", Serves::Surface),
    ("--drain", Serves::Spline),
];

/// The first given flag about the surface that serves nothing before `from`.
fn about(flags: &Flags, from: Serves) -> Option<&'static str> {
    let of_roles = Role::all().map(|role| (role.flag(), role.serves()));
    let mut all = ABOUT_SURFACE.into_iter().chain(of_roles);
    all.find(|(flag, serves)| *serves >= from && flags.has(flag)).map(|(flag, _)| flag)
}

/// The first given flag about the surface. A run without contours makes none.
pub fn about_surface(flags: &Flags) -> Option<&'static str> {
    about(flags, Serves::Surface)
}

/// Those about pits. The summary reports pits if one of them is given.
pub const ABOUT_PITS: [&str; 2] = ["--sinks", "--drain"];

/// Where the ground ends.
#[derive(Debug, Clone, Args)]
pub struct FrameArgs {
    /// Outer border: the convex hull of the contours, their bounding box, or a polygon in a vector file. The default is the
    /// hull, or an outline that follows the contours where these fill less than a third of the hull
    #[arg(long, value_name = "auto|hull|bbox|FILE", default_value = "auto", value_parser = source().map(FrameArg::of))]
    pub frame: FrameArg,
    /// Leave out heights in those parts of a --frame FILE that lie outside the convex hull of the contours
    #[arg(long, hide_short_help = true)]
    pub no_extend: bool,
}

/// An outer border.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FrameArg {
    Auto,
    Hull,
    Box,
    File(VectorSource),
}

impl FrameArg {
    fn of(source: VectorSource) -> Self {
        match source.path.to_str() {
            Some("auto") => Self::Auto,
            Some("hull") => Self::Hull,
            Some("bbox") => Self::Box,
            _ => Self::File(source),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum KindArg {
    /// The triangulated contours alone
    Linear,
    /// With ridge and canyon lines, without flat triangles
    Skeleton,
    /// Smooth: minimum curvature through the contours
    Spline,
}

impl KindArg {
    /// The library's kind.
    pub fn kind(self) -> SurfaceKind {
        match self {
            Self::Linear => SurfaceKind::Linear,
            Self::Skeleton => SurfaceKind::Skeleton,
            Self::Spline => SurfaceKind::Spline,
        }
    }
}

impl SurfaceArgs {
    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.frame.file().into_iter().chain(paths(self.sources()))
    }

    /// The files of lines, polygons and points beside the contours.
    fn sources(&self) -> Sources<'_> {
        [self.water.sources(), self.streams.sources(), self.break_lines.sources(), self.drain.sources()].concat()
    }

    /// The steps of building the surface, for the progress.
    pub fn steps(&self, options: &Options) -> impl Iterator<Item = &'static str> {
        let is_smooth = self.surface == KindArg::Spline;
        let has_triangles = is_smooth && options.triangles == Triangles::Smooth;
        let steps = [
            (self.surface != KindArg::Linear, "ridge and canyon lines"),
            (is_smooth, "smooth surface"),
            (is_smooth && options.uncertainty == Uncertainty::Learnt, "expected errors"),
            (has_triangles, "triangulating the smooth surface"),
        ];
        steps.into_iter().filter(|(is_done, _)| *is_done).map(|(_, step)| step)
    }

    /// Refuses flags that have no meaning for this kind of surface.
    pub fn check(&self, flags: &Flags) -> Result<(), Failure> {
        let unused = match self.surface {
            KindArg::Linear => about(flags, Serves::Skeleton),
            KindArg::Skeleton => about(flags, Serves::Spline),
            KindArg::Spline => None,
        };
        match unused {
            Some(flag) => {
                let kind = self.surface.kind().name();
                Err(Failure::Usage(format!("{flag} has no meaning for --surface {kind}")))
            }
            None => Ok(()),
        }
    }

    /// Adds the lakes, the streams, the break lines and the sinks to an input; reads their files if there are any.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        self.water.check()?;
        features::add(self.sources(), input)
    }

    /// The library's options, for a height map on a grid if there is one.
    /// `unit` is that of heights in the options.
    pub fn options(
        &self,
        grid: Option<&GridSpec>,
        triangles: Triangles,
        unit: ElevationUnit,
    ) -> Result<Options, Failure> {
        Ok(Options {
            kind: self.surface.kind(),
            resolution: self.resolution,
            tension: self.tension,
            noise: self.noise,
            sea: self.water.sea_in_metres(unit),
            stream_tolerance: self.streams.stream_tolerance,
            drain: self.drain.drain.drain(),
            grid: grid.cloned(),
            triangles,
            memory: memory::available(),
            tuning: tuning(&self.tune)?,
            ..Options::default()
        })
    }
}

/// The tuned numbers, with other values for those that are named.
fn tuning(given: &[String]) -> Result<Tuning, Failure> {
    let mut tuning = Tuning::default();
    for given in given {
        let (name, value) = given.split_once('=').unwrap_or((given, ""));
        tuning.set(name, value).map_err(|e| Failure::Usage(e.to_string()))?;
    }
    Ok(tuning)
}

impl FrameArgs {
    /// The boundary file, if the frame is one.
    pub fn file(&self) -> Option<&Path> {
        match &self.frame {
            FrameArg::File(source) => Some(&source.path),
            FrameArg::Auto | FrameArg::Hull | FrameArg::Box => None,
        }
    }

    /// Sets the frame of an input; reads the boundary polygon if there is one.
    pub fn add_to(&self, input: &mut Input) -> Result<(), Failure> {
        if self.no_extend && self.file().is_none() {
            return Err(Failure::Usage("--no-extend is for a polygon in a file: give --frame FILE".into()));
        }
        match &self.frame {
            // It was read already for a height map.
            FrameArg::File(_) if input.frame.polygon().is_some() => {}
            FrameArg::File(source) => {
                input.read_boundary(source)?;
                if self.no_extend {
                    input.frame = std::mem::take(&mut input.frame).in_hull();
                }
            }
            FrameArg::Auto => input.frame = Frame::Auto,
            FrameArg::Hull => input.frame = Frame::Hull,
            FrameArg::Box => input.frame = Frame::Box,
        }
        Ok(())
    }
}
