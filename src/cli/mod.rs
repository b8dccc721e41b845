//! The command line. It turns arguments into the library's parameters, and prints. The library does not depend on it.
//!
//! Exit status: 0 done, 1 the input or the work failed, 2 wrong usage.

mod check;
mod coast;
mod compare;
mod console;
mod contour;
mod dem;
mod densify;
mod derive;
mod diagnostics;
mod drain;
mod failure;
mod flags;
mod flow;
mod hints;
mod input;
mod interrupt;
mod job;
mod labels;
mod levels;
mod light;
mod map;
mod memory;
mod mesh;
mod output;
mod part;
mod plane;
mod progress;
mod regions;
mod skeleton;
mod source;
mod streams;
mod suggest;
mod summary;
mod surface;
mod unit;

use std::process::ExitCode;

use clap::{Args, CommandFactory, Parser, Subcommand};

use console::Console;
use failure::Failure;

/// Denser contour lines, height maps and 3-D models from a map's contour lines
#[derive(Debug, Parser)]
#[command(name = "tokosen", version, about, max_term_width = 100, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    common: Common,
}

const EXAMPLES: &str = "\
Examples:
  tokosen densify contours.gpkg -i 2 -o contours_2m.gpkg
  tokosen densify contours.shp -a ELEV -i 5,2,1 -o dense.gpkg --dem dem.tif --cell 5
  tokosen dem contours.geojson --cell 10 -o dem.tif --preview look.png
  tokosen contour dem.tif -i 5 -o contours_5m.gpkg
  tokosen densify degrees.shp --crs EPSG:6668 -i 2 -o dense.gpkg
  tokosen derive dem.tif --slope slope.tif --steep steep.gpkg
  tokosen mesh contours.gpkg -o terrain.glb
  tokosen compare contours.gpkg published_dem.tif --report compare.html
  tokosen check contours.gpkg -o findings.gpkg
  tokosen regions contours.gpkg -o regions.gpkg
  tokosen skeleton contours.gpkg -o ridges_and_canyons.gpkg

'tokosen VERB -h' shows the usual options of a verb, 'tokosen VERB --help' all of them.";

#[derive(Debug, Subcommand)]
enum Verb {
    Densify(Box<densify::DensifyArgs>),
    Dem(Box<dem::DemArgs>),
    Contour(Box<contour::ContourArgs>),
    Derive(Box<derive::DeriveArgs>),
    Mesh(Box<mesh::MeshArgs>),
    Compare(Box<compare::CompareArgs>),
    Check(Box<check::CheckArgs>),
    Regions(Box<regions::RegionsArgs>),
    Skeleton(Box<skeleton::SkeletonArgs>),
}

/// Options that every verb has.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Run")]
struct Common {
    /// Print errors only
    #[arg(short, long, global = true)]
    quiet: bool,
    /// Tell details, and list every finding about the input, not just the first ones of each kind
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    verbose: bool,
    /// Replace files, and layers of a GeoPackage, that another program made. Without this option only those that tokosen
    /// made are replaced; other layers of a GeoPackage always stay
    #[arg(long, global = true)]
    overwrite: bool,
    /// Number of threads [default: all cores]; the result does not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), hide_short_help = true)]
    threads: Option<u16>,
}

/// Parses the arguments, runs the verb, and turns its outcome into an exit status.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => suggest::with_right_flag(error, Cli::command()).exit(),
    };
    if let Err(e) = interrupt::prepare() {
        console::error(&format!("cannot install the signal handlers: {e}"));
        return ExitCode::from(1);
    }
    if let Some(threads) = cli.common.threads
        && let Err(e) = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global()
    {
        console::error(&format!("cannot start {threads} threads: {e}"));
        return ExitCode::from(1);
    }
    let console = Console::new(&cli.common);
    let outcome = match &cli.verb {
        Verb::Densify(args) => densify::run(args, &console),
        Verb::Dem(args) => dem::run(args, &console),
        Verb::Contour(args) => contour::run(args, &console),
        Verb::Derive(args) => derive::run(args, &console),
        Verb::Mesh(args) => mesh::run(args, &console),
        Verb::Compare(args) => compare::run(args, &console),
        Verb::Check(args) => check::run(args, &console),
        Verb::Regions(args) => regions::run(args, &console),
        Verb::Skeleton(args) => skeleton::run(args, &console),
    };
    console.clear();
    match outcome.and_then(|()| Ok(console.printed()?)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(message)) => {
            console::error(&format!("{message}\n\nFor more information, try '--help'."));
            ExitCode::from(2)
        }
        Err(Failure::Work(error)) => {
            console::error(&hints::with_causes(&error));
            ExitCode::from(1)
        }
    }
}
