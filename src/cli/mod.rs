//! The command line. It turns arguments into the library's parameters, and prints. The library does not depend on it. It is a
//! module of the library so that packages for other languages can bring the same program.
//!
//! Exit status: 0 done, 1 the input or the work failed, 2 wrong usage.

mod address_space;
mod bands;
mod base;
mod check;
mod compare;
mod console;
mod contour;
mod dem;
mod densify;
mod derive;
mod diagnostics;
mod engine;
mod extensions;
mod failure;
mod features;
mod flags;
mod flood;
mod flow;
mod for_map;
mod height_map;
mod hints;
mod input;
mod interrupt;
mod job;
mod join;
mod labels;
mod levels;
mod light;
mod map;
mod memory;
mod mesh;
mod negative;
#[cfg(test)]
mod option_table;
mod outlets;
mod output;
mod part;
mod picture;
mod places;
mod plan;
mod plane;
mod plates;
mod profile;
mod progress;
mod regions;
mod results;
mod run_file;
mod shell;
mod skeleton;
mod source;
mod suggest;
mod summary;
mod surface;
mod terrain_page;
mod terrain_tiles;
mod tiles;
mod unit;
mod vertical_shift;
mod viewer;
mod volume;
mod work;
mod zooms;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand};

use console::{Console, Shown};
use failure::Failure;
use flags::Flags;
pub use memory::available as available_memory;
use run_file::{Record, Repeated, RunFile};
pub use viewer::write_viewer;

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
  tokosen profile contours.gpkg --line road.gpkg -o profile.svg
  tokosen volume dem.tif --levels 700:760:1 -o storage.csv
  tokosen check contours.gpkg -o findings.gpkg
  tokosen regions contours.gpkg -o regions.gpkg
  tokosen skeleton contours.gpkg -o ridges_and_canyons.gpkg
  tokosen dem contours.gpkg --cell 10 -o dem.tif --save-run run.json
  tokosen --run run.json
  tokosen plan country/*.gpkg -i 2 --cell 5 -o plan && tokosen work plan --jobs 4 && tokosen join plan -o dense.gpkg

'tokosen VERB -h' shows the usual options of a verb, 'tokosen VERB --help' all of them.";

#[derive(Debug, Subcommand)]
enum Verb {
    Densify(Box<densify::DensifyArgs>),
    Dem(Box<dem::DemArgs>),
    Contour(Box<contour::ContourArgs>),
    Derive(Box<derive::DeriveArgs>),
    Mesh(Box<mesh::MeshArgs>),
    Compare(Box<compare::CompareArgs>),
    Profile(Box<profile::ProfileArgs>),
    Volume(Box<volume::VolumeArgs>),
    Check(Box<check::CheckArgs>),
    Regions(Box<regions::RegionsArgs>),
    Skeleton(Box<skeleton::SkeletonArgs>),
    Plan(Box<plan::PlanArgs>),
    Work(Box<work::WorkArgs>),
    Join(Box<join::JoinArgs>),
    #[command(hide = true)]
    Completions(shell::CompletionsArgs),
    #[command(hide = true)]
    Man(shell::ManArgs),
}

/// Options that every verb has.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Run")]
struct Common {
    /// Print errors only
    #[arg(short, long, global = true)]
    quiet: bool,
    /// Print details, and list every finding about the input, not just the first ones of each kind
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    verbose: bool,
    /// Replace files, and layers of a GeoPackage, that another program made. Without this option only those that tokosen
    /// made are replaced; other layers of a GeoPackage always stay
    #[arg(long, global = true)]
    overwrite: bool,
    /// How progress is shown on standard error: as a bar on a terminal, or as lines of JSON for other programs, each with the
    /// share that is done (0 to 1) and the name of the step: {"progress":0.42,"step":"smooth surface"}
    #[arg(long, global = true, value_enum, default_value_t = Shown::Bar, value_name = "bar|json", hide_short_help = true)]
    progress: Shown,
    /// Number of threads [default: all cores]; the result does not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), hide_short_help = true)]
    threads: Option<u16>,
    /// Also write what is needed to repeat this run: .json, with the arguments, the checksums of the inputs, and what was
    /// chosen automatically. 'tokosen --run FILE' repeats it
    #[arg(long, global = true, value_name = "FILE", hide_short_help = true)]
    save_run: Option<PathBuf>,
}

/// The exit statuses.
const DONE: u8 = 0;
const FAILED: u8 = 1;
const WRONG_USAGE: u8 = 2;

/// Parses the arguments, of which the first is the name of the program, runs the verb, and turns its outcome into an exit
/// status. It installs signal handlers, and ends the process if the arguments are wrong or ask for help.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    if let Err(e) = interrupt::prepare() {
        console::error(&format!("cannot install the signal handlers: {e}"));
        return FAILED;
    }
    let outcome = parsed(arguments.into_iter().collect()).and_then(|run| {
        if let Some(threads) = run.cli.common.threads.map(usize::from).or_else(address_space::most_threads)
            && let Err(e) = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()
        {
            let message = format!("cannot start {threads} threads: {e}; take fewer with --threads");
            return Err(Failure::Work(tokosen::Error::Data(message)));
        }
        run.run()
    });
    match outcome {
        Ok(()) => DONE,
        Err(Failure::Usage(message)) => {
            console::error(&format!("{message}\n\nFor more information, try '--help'."));
            WRONG_USAGE
        }
        Err(Failure::Work(error)) => {
            console::error(&hints::with_causes(&error));
            FAILED
        }
        Err(Failure::Told(text)) => {
            console::error(&text);
            FAILED
        }
    }
}

/// What is run: the arguments of the program, or those of a saved run.
struct Run {
    cli: Cli,
    /// The flags that are given.
    flags: Flags,
    /// The arguments as text, if they are to be saved.
    arguments: Vec<String>,
    /// The saved run that is repeated, with what is different now.
    repeated: Option<(RunFile, Vec<String>)>,
}

/// Parses the arguments. Ends the program if they are wrong or ask for help.
fn parsed(arguments: Vec<OsString>) -> Result<Run, Failure> {
    let given = arguments.get(1..).unwrap_or_default();
    if run_file::is_repeat(given) {
        let Repeated { cli, flags, saved, warnings } = run_file::repeated(&arguments)?;
        return Ok(Run { cli, flags, arguments: saved.arguments.clone(), repeated: Some((saved, warnings)) });
    }
    let (cli, flags) = Cli::with_flags(negative::joined(Cli::command(), arguments.clone()))
        .unwrap_or_else(|error| suggest::with_right_flag(error, Cli::command(), &arguments).exit());
    let arguments = match cli.common.save_run {
        Some(_) => run_file::saved_arguments(given.to_vec())?,
        None => Vec::new(),
    };
    Ok(Run { cli, flags, arguments, repeated: None })
}

impl Cli {
    /// Parses arguments, and notes which flags are given.
    fn with_flags(arguments: impl IntoIterator<Item = OsString>) -> Result<(Self, Flags), clap::Error> {
        let matches: ArgMatches = Self::command().try_get_matches_from(arguments)?;
        Ok((Self::from_arg_matches(&matches)?, Flags::of(&matches)))
    }
}

impl Run {
    /// Runs the verb. The run is saved if it went well.
    fn run(self) -> Result<(), Failure> {
        let Self { cli, flags, arguments, repeated } = self;
        let record = cli.common.save_run.as_deref().map(|path| Record::open(path, arguments)).transpose()?;
        let (saved, warnings) = repeated.unzip();
        let mut console = Console::new(&cli.common, flags, record, saved);
        warnings.iter().flatten().for_each(|warning| console.warn(&format!("warning: {warning}")));
        let outcome = cli.verb.run(&console);
        console.clear();
        outcome.map_err(|failure| failure.in_units(console.error_units()))?;
        console.save_run()?;
        console.done();
        Ok(console.printed()?)
    }
}

impl Verb {
    fn run(&self, console: &Console) -> Result<(), Failure> {
        match self {
            Self::Densify(args) => densify::run(args, console),
            Self::Dem(args) => dem::run(args, console),
            Self::Contour(args) => contour::run(args, console),
            Self::Derive(args) => derive::run(args, console),
            Self::Mesh(args) => mesh::run(args, console),
            Self::Compare(args) => compare::run(args, console),
            Self::Profile(args) => profile::run(args, console),
            Self::Volume(args) => volume::run(args, console),
            Self::Check(args) => check::run(args, console),
            Self::Regions(args) => regions::run(args, console),
            Self::Skeleton(args) => skeleton::run(args, console),
            Self::Plan(args) => plan::run(args, console),
            Self::Work(args) => work::run(args, console),
            Self::Join(args) => join::run(args, console),
            Self::Completions(args) => shell::completions(args, Cli::command(), console),
            Self::Man(args) => shell::man(args, Cli::command(), console),
        }
    }
}
