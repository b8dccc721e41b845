//! Units of elevations on the command line: `--unit`, `--to-unit`.

use clap::{Args, ValueEnum};
use tokosen::base::{ElevationUnit, Units};
use tokosen::crs::{Crs, FromWorking};

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
    /// 2 feet. Elevations of an input in this unit come back exactly. Pictures are in this unit too; printed figures about the
    /// input and the surface are in the unit of the input
    #[arg(long, value_enum, default_value_t = UnitArg::M, hide_short_help = true)]
    pub to_unit: UnitArg,
}

impl ToUnitArgs {
    /// The library's unit.
    pub fn unit(&self) -> ElevationUnit {
        self.to_unit.unit()
    }

    /// The units of a picture of an input in `units`: feet if heights are written in feet, else those of the input.
    pub fn drawn(&self, units: Units) -> Units {
        if self.unit().is_foot() { Units::all(self.unit()) } else { units }
    }
}

/// What the summary says behind the contents of a file: the unit of heights if they are in feet, and the unit of x and y of a
/// drawing that is not in metres. Metres are not told.
pub fn in_units(back: &FromWorking) -> String {
    match of_drawing(back.crs(), back.unit()) {
        text if text.is_empty() && back.unit().is_foot() => format!(", heights in {}", back.unit().name()),
        text => text,
    }
}

/// What the summary says about the units of a drawing that is not in metres, with heights in `unit`; nothing for other
/// coordinates.
pub fn of_drawing(crs: Option<&Crs>, unit: ElevationUnit) -> String {
    let drawn = crs.filter(|crs| crs.is_local()).and_then(Crs::length_unit).filter(|drawn| drawn.metres != 1.0);
    match drawn {
        Some(drawn) if ElevationUnit::of_size(drawn.metres) == Some(unit) => {
            format!(", x, y and heights in {}", unit.name())
        }
        Some(drawn) => {
            let known = ElevationUnit::of_size(drawn.metres);
            let name = known.map_or(drawn.name, |unit| unit.name().to_owned());
            format!(", x and y in {name}, but heights in {}: --to-unit chooses their unit", unit.name())
        }
        None => String::new(),
    }
}
