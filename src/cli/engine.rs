//! Height maps for game engines and 3-D programs.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use tokosen::GridSpec;
use tokosen::io::raster::{Engine, EngineFiles};

use super::console::Console;
use super::extensions::check_extension;
use super::failure::Failure;
use super::flags::Flags;

/// The program that a height map is for.
#[derive(Debug, Clone, Args)]
pub struct EngineArgs {
    /// Make the height map for a game engine or a 3-D program: as many samples on a side as it takes, 16 bits or .exr, in metres.
    /// A .json beside it says what to type in. Give --size, or --cell: then the size follows from the map, and a map that is
    /// too large becomes tiles
    #[arg(long = "for", value_enum, value_name = "PROGRAM")]
    pub engine: Option<EngineArg>,
    /// Samples on a side of the height map for --for: 1009 for Unreal, 1025 for Unity and Godot
    #[arg(long, value_name = "N", requires = "engine", hide_short_help = true)]
    pub size: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EngineArg {
    /// Landscapes: .png, .r16 or .raw with 127, 253, 505, 1009, 2017, 4033 or 8129 samples on a side
    Unreal,
    /// Terrains: .raw with 33, 65, 129 ... 4097 samples on a side, from south to north
    Unity,
    /// The add-ons HTerrain and Terrain3D: .exr, .r16 or .raw with 513, 1025, 2049 or 4097 samples on a side
    Godot,
    /// Displacement: .exr or .png of any size
    Blender,
}

/// A height map for a program.
#[derive(Debug, Clone)]
pub struct ForEngine {
    pub engine: Engine,
    /// How many samples a side may have, in ascending order; any number if empty.
    pub sides: Vec<usize>,
    /// The distance of samples, if it is given.
    pub cell: Option<f64>,
}

impl ForEngine {
    /// Its cells.
    pub fn grid(&self) -> GridSpec {
        GridSpec::Samples { sides: self.sides.clone(), cell: self.cell }
    }

    /// The side of a tile of a height map with so many columns: the smallest that holds them all, or the largest.
    pub fn side(&self, cols: usize) -> Option<usize> {
        self.sides.iter().copied().find(|side| *side >= cols).or(self.sides.last().copied())
    }
}

/// Flags that say otherwise where the cells are or how heights are stored.
const AGAINST: [&str; 9] = [
    "--cell-degrees",
    "--like",
    "--png-encoding",
    "--cog",
    "--uncertainty",
    "--max-zoom",
    "--to-crs",
    "--to-unit",
    "--base",
];

impl EngineArgs {
    /// The program, and the cells that it takes; `None` if the height map is for none. `cell` is that of `--cell`.
    pub fn wanted(&self, output: &[PathBuf], cell: Option<f64>, flags: &Flags) -> Result<Option<ForEngine>, Failure> {
        let Some(engine) = self.engine.map(EngineArg::engine) else { return Ok(None) };
        let name = engine.name();
        if let Some(flag) = flags.first(&AGAINST) {
            return Err(Failure::Usage(format!(
                "--for {name} decides about cells and values, so {flag} does not apply"
            )));
        }
        let what = format!("height maps for {name}");
        output.iter().try_for_each(|path| check_extension(path, &what, engine.extensions()))?;
        let known = engine.sides();
        let sides = match self.size {
            Some(size) if size < 2 => return Err(Failure::Usage("--size is 2 or more".into())),
            Some(size) if !known.is_empty() && !known.contains(&size) => {
                let known: Vec<String> = known.iter().map(usize::to_string).collect();
                let message = format!("--size {size}: {name} takes {} samples on a side", known.join(", "));
                return Err(Failure::Usage(message));
            }
            Some(size) => vec![size],
            None => known.to_vec(),
        };
        if self.size.is_none() && cell.is_none() {
            return Err(Failure::Usage(format!("--for {name} needs --size N or --cell SIZE")));
        }
        let wanted = ForEngine { engine, sides, cell };
        wanted.grid().check()?;
        Ok(Some(wanted))
    }
}

impl EngineArg {
    fn engine(self) -> Engine {
        match self {
            Self::Unreal => Engine::Unreal,
            Self::Unity => Engine::Unity,
            Self::Godot => Engine::Godot,
            Self::Blender => Engine::Blender,
        }
    }
}

/// The lines of the summary about it.
pub fn describe(path: &Path, engine: Engine, files: &EngineFiles, console: &Console) {
    let [across, down] = files.tiles;
    if across * down > 1 {
        console.say(&format!(
            "           the first of {across} x {down} tiles of {0} x {0} samples, with common borders",
            files.side
        ));
    }
    let typed: Vec<String> = files.settings.iter().map(|(name, value)| format!("{name} {}", rounded(*value))).collect();
    console.say(&format!(
        "           {}: {} (in {})",
        engine.name(),
        typed.join(", "),
        path.with_extension("json").display()
    ));
    if files.filled > 0.0 {
        console.warn(&format!(
            "           {:.1} % of the samples lie outside of the frame and got the lowest height; a square --extent with --frame bbox has none",
            100.0 * files.filled
        ));
    }
}

/// A number with as many digits as one types in.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
