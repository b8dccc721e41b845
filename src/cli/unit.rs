//! Units of elevations on the command line: `--unit`, `--to-unit`.

use clap::{Args, ValueEnum};
use tokosen::base::ElevationUnit;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UnitArg {
    /// Metres
    #[value(aliases = ["metre", "metres", "meter", "meters"])]
    M,
    /// International feet
    #[value(aliases = ["feet", "foot"])]
    Ft,
    /// US survey feet
    #[value(aliases = ["usft", "ftus", "us-feet", "us-foot", "us-survey-feet", "us-survey-foot"])]
    UsFt,
}

impl UnitArg {
    /// The library's unit.
    pub fn unit(self) -> ElevationUnit {
        match self {
            Self::M => ElevationUnit::Metre,
            Self::Ft => ElevationUnit::Foot,
            Self::UsFt => ElevationUnit::UsSurveyFoot,
        }
    }
}

/// The unit that heights are written in.
#[derive(Debug, Clone, Args)]
pub struct ToUnitArgs {
    /// Unit of the heights that are written, and of the heights in other options: -i 2 --to-unit ft gives contours every
    /// 2 feet. Elevations of an input in this unit come back exactly. Pictures, and printed figures about the input and
    /// the surface, stay in metres
    #[arg(long, value_enum, default_value_t = UnitArg::M, hide_short_help = true)]
    pub to_unit: UnitArg,
}

impl ToUnitArgs {
    /// The library's unit.
    pub fn unit(&self) -> ElevationUnit {
        self.to_unit.unit()
    }
}

/// What the summary says behind the contents of a file whose heights are in feet. Metres are not told.
pub fn in_feet(unit: ElevationUnit) -> String {
    if unit.is_foot() { format!(", heights in {}", unit.name()) } else { String::new() }
}
