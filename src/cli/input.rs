//! The arguments about the input: the map, and how its lines are prepared.

use clap::Args;
use tokosen::features::{Role, Serves};
use tokosen::resample::{Fitted, Sampled};
use tokosen::terrain::Preparation;
use tokosen::{GridSpec, Input};

use super::console::Console;
use super::failure::Failure;
use super::flags::Flags;
use super::map::{ABOUT_CONTOURS, MapArgs};
use super::memory;
use super::part::PartArgs;
use super::summary;
use super::surface::FrameArgs;

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Input")]
pub struct InputArgs {
    #[command(flatten)]
    pub map: MapArgs,
    /// Smooth the contours: fit a curve to each within this tolerance, and space its vertices evenly [units of the
    /// working CRS]. The input's vertices are then not kept
    #[arg(long, value_name = "TOLERANCE", hide_short_help = true)]
    pub fit: Option<f64>,
    /// Add vertices until the distance between neighbours on a line is at most S times the distance to the nearest
    /// other contour. The input's own vertices stay; with --fit, all vertices lie on the fitted curve
    #[arg(long, value_name = "S", value_parser = sampling_ratio, hide_short_help = true)]
    pub sample: Option<f64>,
}

/// What is known of the job before the map is prepared.
#[derive(Debug, Clone, Copy)]
pub struct Scope<'a> {
    /// Where the ground ends.
    pub frame: &'a FrameArgs,
    /// The part of the map that is written.
    pub part: Option<&'a PartArgs>,
    /// The level of the sea in metres.
    pub sea: Option<f64>,
    /// The cells of the height map.
    pub grid: Option<&'a GridSpec>,
}

impl<'a> Scope<'a> {
    /// The whole map inside a frame.
    pub fn of(frame: &'a FrameArgs) -> Self {
        Self { frame, part: None, sea: None, grid: None }
    }
}

impl InputArgs {
    /// The first flag that applies to contours, if one is given; a run without contours must not ignore it. `but` are flags
    /// that apply to height maps too.
    pub fn about_contours(flags: &Flags, but: &[&str]) -> Option<&'static str> {
        let of_roles = Role::all().filter(|role| role.serves() == Serves::Contours).map(Role::flag);
        let all = ABOUT_CONTOURS.into_iter().chain(["--fit", "--sample"]).chain(of_roles);
        all.filter(|flag| !but.contains(flag)).find(|flag| flags.has(flag))
    }

    /// Reads and prepares the map. A height map that is too large is refused before the preparation.
    pub fn read(&self, scope: Scope<'_>, console: &Console) -> Result<Input, Failure> {
        let params = Preparation { fit: self.fit, sample: self.sample, ..self.map.preparation() };
        params.check()?;
        let mut input = self.map.read(console)?;
        scope.sea.into_iter().for_each(|level| input.expect_level(level));
        scope.frame.add_to(&mut input)?;
        scope.part.map(|part| part.add_to(&mut input)).transpose()?;
        scope.grid.map(|grid| input.check_room(grid, memory::available())).transpose()?;
        let prepared = input.prepare(&params, console);
        input.fitted.iter().for_each(|fitted| describe_fit(fitted, console));
        input.sampled.iter().for_each(|sampled| describe_sample(sampled, console));
        prepared.map_err(|error| summary::after_findings(error, &input.findings, console))?;
        Ok(input)
    }
}

fn describe_fit(fitted: &Fitted, console: &Console) {
    let [half, quarter, eighth] = fitted.narrowed;
    console.say(&format!(
        "fitted     {} vertices by {} control points, {} new vertices, deviation at most {:.3}; tolerance halved for \
         {half} lines, quartered for {quarter}, an eighth for {eighth}; {} lines unchanged",
        fitted.vertices_before, fitted.control_points, fitted.vertices_after, fitted.deviation, fitted.unchanged
    ));
}

fn describe_sample(sampled: &Sampled, console: &Console) {
    console.say(&format!(
        "sampled    {} vertices added; {} pieces stay longer because the lower limit is {:.3}, {} segments stay whole \
         because lines would meet",
        sampled.added, sampled.held, sampled.least, sampled.whole
    ));
}

fn sampling_ratio(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(ratio) if ratio > 0.0 && ratio < 1.0 => Ok(ratio),
        _ => Err("it must be more than 0 and less than 1".into()),
    }
}
