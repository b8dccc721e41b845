//! `tokosen plan`: a map that is too large for one run becomes a folder of tasks.

use std::path::PathBuf;

use clap::Args;
use tokosen::GridSpec;
use tokosen::base::Units;
use tokosen::surface::Triangles;
use tokosen::tiling::{Levels, Plan, PlanParams, STEP, Task, plan};

use super::console::Console;
use super::failure::Failure;
use super::input::{InputArgs, Scope};
use super::job::Job;
use super::levels::WhichLevelsArgs;
use super::picture::Asked;
use super::surface::SurfaceArgs;
use super::unit::ToUnitArgs;
use super::{hints, summary};

/// Cut a map that is too large for one run into tiles
///
/// Reads the map, chooses what depends on the whole map, cuts it into tiles, and writes a folder with a task for each tile.
/// 'tokosen work FOLDER' does the tasks, on one machine or on many. 'tokosen join FOLDER' joins the results. The manifest.json in the
/// folder lists the tasks for other schedulers.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct PlanArgs {
    #[command(flatten)]
    input: InputArgs,
    /// Folder to write the plan into: a new one, or that of a former plan. Results of a former plan that belong to the new one are
    /// kept
    #[arg(short, long, value_name = "FOLDER", help_heading = "Output")]
    output: PathBuf,
    /// Interval of the new contours [metres, or the unit of --to-unit], or several: 5,2,1. Without it, there are no new contours
    #[arg(short, long, value_name = "STEP", value_delimiter = ',', help_heading = "Output")]
    interval: Vec<f64>,
    #[command(flatten)]
    which: WhichLevelsArgs,
    /// Keep all contours of the input also where the interval is coarser than theirs
    #[arg(long, help_heading = "Output", hide_short_help = true)]
    keep_input: bool,
    /// Cell size of the height map [units of the working CRS]; cells lie on multiples of it. Without it, there is no height map
    #[arg(long, value_name = "SIZE", help_heading = "Output")]
    cell: Option<f64>,
    #[command(flatten, next_help_heading = "Output")]
    to_unit: ToUnitArgs,
    /// Largest side of a tile [units of the working CRS; default: as --memory allows]
    #[arg(long, value_name = "SIZE", value_parser = size, help_heading = "Tiles")]
    tile_side: Option<f64>,
    /// Memory that a task may take, such as 4G or 800M. Tiles are cut so that their tasks fit
    #[arg(long, value_name = "BYTES", value_parser = bytes, default_value = "4G", help_heading = "Tiles")]
    memory: u64,
    #[command(flatten)]
    surface: SurfaceArgs,
}

const EXAMPLES: &str = "\
Examples:
  tokosen plan 'sheets/*.gpkg' -i 2 --cell 10 -o plan
  tokosen work plan --jobs 4
  tokosen join plan -o dense.gpkg --dem dem.tif --cog";

/// The flags that tiles cannot take.
const REFUSED: [&str; 3] = ["--strict", "--tune", "--save-run"];

/// The size of tiles.
fn size(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(size) if size > 0.0 && size.is_finite() => Ok(size),
        _ => Err("it must be more than 0".into()),
    }
}

/// A number of bytes, with K, M, G or T for powers of 1000.
fn bytes(text: &str) -> Result<u64, String> {
    let text = text.trim().trim_end_matches(['B', 'b']);
    let (number, factor) = match text.chars().last().map(|c| c.to_ascii_uppercase()) {
        Some('K') => (&text[..text.len() - 1], 1e3),
        Some('M') => (&text[..text.len() - 1], 1e6),
        Some('G') => (&text[..text.len() - 1], 1e9),
        Some('T') => (&text[..text.len() - 1], 1e12),
        _ => (text, 1.0),
    };
    match number.trim().parse::<f64>() {
        Ok(count) if count > 0.0 && count.is_finite() => Ok((count * factor) as u64),
        _ => Err("it must be a number of bytes, such as 4G or 800M".into()),
    }
}

/// Runs the verb.
pub fn run(args: &PlanArgs, console: &Console) -> Result<(), Failure> {
    args.check(console)?;
    let targets = args.which.targets(&args.interval)?;
    let unit = args.to_unit.unit();
    let grid = args.cell.map(GridSpec::Cell);
    let job =
        Job::start(&args.input, args.surface.files(), std::iter::empty::<&std::path::Path>(), Asked::Nothing, console)?;
    console.plan(["the whole map", "cutting into tiles"]);
    let mut input = job.read(Scope { grid: None, ..Scope::of(&args.surface.frame) })?;
    args.surface.add_to(&mut input)?;
    let options = args.surface.options(grid.as_ref(), Triangles::Smooth, unit)?;
    let index_every = args.which.index;
    let levels = Levels { targets, index_every, keep_input: args.keep_input };
    let params = PlanParams {
        levels: Some(levels).filter(|levels| !levels.targets.is_empty()),
        unit,
        tile_side: args.tile_side,
        memory: Some(args.memory),
    };
    let Plan { manifest, removed } = plan(&mut input, &options, &params, &args.output, console)
        .map_err(|error| summary::after_findings(error, &input.findings, console))?;
    job.report(&input.findings, &input.map);
    let vertices = manifest.tasks.iter().map(|task| task.vertices);
    console.say(&format!(
        "plan       {}: {} tiles; the largest task reads {} vertices",
        args.output.display(),
        manifest.tasks.len(),
        vertices.max().unwrap_or_default()
    ));
    let side = manifest.tasks.iter().map(side_of).fold(0.0, f64::max);
    if let Some(asked) = args.tile_side.filter(|asked| side > 1.01 * asked) {
        console.say(&format!(
            "           sides of tiles are up to {}, not {}: a tile has at least {STEP} cells on a side",
            Units::METRES.length(side),
            Units::METRES.length(asked)
        ));
    }
    if removed > 0 {
        console.warn(&format!(
            "removed    results of {removed} tiles of the former plan, which the new one does not have"
        ));
    }
    console.say(&format!("           next: tokosen work {}", args.output.display()));
    summary::close(input.findings.len(), console);
    Ok(())
}

/// The longer side of the tile of a task, metres.
fn side_of(task: &Task) -> f64 {
    let [west, south, east, north] = task.tile;
    (east - west).max(north - south)
}

impl PlanArgs {
    fn check(&self, console: &Console) -> Result<(), Failure> {
        if let Some(flag) = console.flags.first(&REFUSED) {
            return Err(Failure::Usage(format!("{flag}: {}", hints::not_in_tiles(flag))));
        }
        if self.cell.is_none() && self.interval.is_empty() && self.which.levels.is_empty() {
            let message = "name what to make: --interval for new contours, --cell for a height map, or both";
            return Err(Failure::Usage(message.into()));
        }
        if let Some(bad) = self.cell.filter(|cell| !(cell.is_finite() && *cell > 0.0)) {
            return Err(Failure::Usage(format!("--cell is {bad}, it must be more than 0")));
        }
        self.surface.check(&console.flags)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_a_number_of_bytes() {
        for (text, expected) in
            [("4G", 4_000_000_000), ("800M", 800_000_000), ("1.5gb", 1_500_000_000), ("70000", 70_000)]
        {
            assert_eq!(bytes(text), Ok(expected), "{text}");
        }
        for wrong in ["", "G", "-1G", "0", "four", "nan"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }
}
