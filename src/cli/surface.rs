//! The arguments about the surface.

use std::path::Path;

use clap::{Args, ValueEnum};
use tokosen::base::error::Error;
use tokosen::io::{ReadOptions, read_area};
use tokosen::spline::SplineParams;
use tokosen::subdomains::Frame;
use tokosen::surface::{Surface, SurfaceKind, SurfaceParams, Triangles, Uncertainty, build};
use tokosen::tuning::Tuning;

use super::Failure;
use super::console::Console;
use super::input::first_given;
use super::map::Input;
use super::output::GridChoice;
use super::water::WaterArgs;
use super::{plane, summary};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Surface")]
pub struct SurfaceArgs {
    /// How heights between contours are found
    #[arg(long, value_enum, default_value_t = KindArg::Spline)]
    pub surface: KindArg,
    #[command(flatten)]
    pub frame: FrameArgs,
    #[command(flatten)]
    pub water: WaterArgs,
    /// Resolution parameter w of the method: more of it, fewer ridge and canyon lines
    #[arg(long, value_name = "W", default_value_t = RESOLUTION, allow_negative_numbers = true)]
    pub resolution: f64,
    /// Tension of the smooth surface: 0 bends least, 10 and more is near the one with ridge and canyon lines. Chosen from
    /// the contours if not given
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub tension: Option<f64>,
    /// Noise of the contours: 0 for smooth ones, 1 for those of unsmoothed lidar, which jitter. Seen from the contours if
    /// not given
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub noise: Option<f64>,
    /// Another value of a tuned number, for scripts/sweep.py
    #[arg(long, value_name = "NAME=VALUE", hide = true)]
    pub tune: Vec<String>,
}

/// Default of `--resolution`.
const RESOLUTION: f64 = 1.0;

/// Where the ground ends.
#[derive(Debug, Clone, Args)]
pub struct FrameArgs {
    /// Outermost border: the convex hull of the contours, the box around them, or a polygon in a vector file
    #[arg(long, value_name = "hull|bbox|FILE", default_value = "hull")]
    pub frame: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum KindArg {
    /// The triangulated contours as they stand
    Linear,
    /// With ridge and canyon lines, without flat triangles
    Skeleton,
    /// Smooth: of minimum curvature through the contours
    Spline,
}

impl KindArg {
    /// The word for it on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Skeleton => "skeleton",
            Self::Spline => "spline",
        }
    }
}

impl SurfaceArgs {
    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.frame.file().into_iter().chain(self.water.file())
    }

    /// The first flag that is given; a run without contours makes no surface and must not pass over it.
    pub fn given(&self) -> Option<&'static str> {
        let given = [
            (self.surface != KindArg::Spline, "--surface"),
            (self.frame.frame != "hull", "--frame"),
            (self.water.water.is_some(), "--water"),
            (self.water.sea.is_some(), "--sea"),
            (self.resolution != RESOLUTION, "--resolution"),
            (self.tension.is_some(), "--tension"),
            (self.noise.is_some(), "--noise"),
            (!self.tune.is_empty(), "--tune"),
        ];
        first_given(given)
    }

    /// The first flag that is given and says nothing about this kind of surface.
    fn idle(&self) -> Option<&'static str> {
        let is_smooth = self.surface == KindArg::Spline;
        first_given([
            (self.resolution != RESOLUTION && self.surface == KindArg::Linear, "--resolution"),
            (self.tension.is_some() && !is_smooth, "--tension"),
            (self.noise.is_some() && !is_smooth, "--noise"),
        ])
    }

    /// The library's parameters; reads the boundary polygon and the lakes if there are any, and adds what was
    /// noticed about them to the input's findings.
    pub fn params(
        &self,
        input: &mut Input,
        grid: Option<&GridChoice>,
        triangles: Triangles,
    ) -> Result<SurfaceParams, Failure> {
        if let Some(flag) = self.idle() {
            let message = format!("{flag} has no meaning for --surface {}", self.surface.name());
            return Err(Failure::Usage(message));
        }
        let spline =
            SplineParams { wanted: grid.and_then(GridChoice::wanted), tension: self.tension, noise: self.noise };
        let kind = match self.surface {
            KindArg::Linear => SurfaceKind::Linear,
            KindArg::Skeleton => SurfaceKind::Skeleton,
            KindArg::Spline => SurfaceKind::Spline,
        };
        Ok(SurfaceParams {
            kind,
            frame: self.frame.read(input)?,
            resolution: self.resolution,
            water: self.water.read(input)?,
            spline,
            triangles,
            uncertainty: Uncertainty::default(),
            tuning: tuning(&self.tune)?,
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
        (!matches!(self.frame.as_str(), "hull" | "bbox")).then(|| Path::new(&self.frame))
    }

    /// The frame; reads the boundary polygon if there is one.
    pub fn read(&self, input: &Input) -> Result<Frame, Failure> {
        let Some(path) = self.file() else {
            return Ok(if self.frame == "bbox" { Frame::Box } else { Frame::Hull });
        };
        let (area, crs) = read_area(path, &ReadOptions::default())?;
        let bring = plane::bringer(&input.places, path, crs.as_ref())?;
        Ok(Frame::Polygon(bring.boundary(&area).map_err(|e| Error::file(path, e.to_string()))?))
    }
}

/// Builds the surface of an input's map, which it takes out of it, and adds what was noticed to its findings.
pub fn build_surface(input: &mut Input, params: &SurfaceParams, console: &Console) -> Result<Surface, Failure> {
    let built = build(std::mem::take(&mut input.map), params, console);
    Ok(summary::found(built, &input.path, &mut input.findings, console)?)
}
