//! The arguments about the height map that gives the heights outside the frame.

use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::Input;
use tokosen::dem::join::Join;
use tokosen::terrain::BaseJoin;

use super::console::Console;
use super::failure::Failure;

#[derive(Debug, Clone, Args)]
pub struct BaseArgs {
    /// Take the heights outside the frame from this height map (.tif, .asc, .exr, .png, .xyz or 基盤地図情報), in any CRS. The
    /// difference at the border is carried outwards and fades, so that there is no step; heights inside stay the same.
    /// Without --extent, --clip or --like, the result covers this height map too
    #[arg(long, value_name = "DEM")]
    pub base: Option<PathBuf>,
    /// Distance from the border at which a twentieth of the difference is left; 0 changes nothing of the base [units of
    /// the working CRS; default: 12 times the mean spacing of the contours]
    #[arg(long, value_name = "DISTANCE", requires = "base", hide_short_help = true)]
    pub base_fade: Option<f64>,
}

impl BaseArgs {
    /// The file that is read.
    pub fn file(&self) -> Option<&Path> {
        self.base.as_deref()
    }

    /// Sets the base of an input; reads its file if there is one.
    pub fn add_to(&self, input: &mut Input, console: &Console) -> Result<(), Failure> {
        match &self.base {
            Some(path) => Ok(input.read_base(path, console)?),
            None => Ok(()),
        }
    }
}

/// Prints what the base gave to a height map, and how it fits.
pub fn describe(base: &BaseJoin, console: &Console) {
    let BaseJoin { file, join: Join { filled, border, median, largest, .. }, fade } = base;
    console.say(&format!("base       {}: {filled} cells outside the surface", file.display()));
    if *border == 0 || *filled == 0 {
        return;
    }
    let units = console.units();
    let fades = match *fade > 0.0 {
        true => format!("it fades over {}", units.length(*fade)),
        false => "it does not fade: there is a step".into(),
    };
    console.say(&format!(
        "           surface minus base at {border} cells of the border: median {}, largest {}; {fades}",
        units.height((median * 100.0).round() / 100.0),
        units.height((largest * 100.0).round() / 100.0)
    ));
}
