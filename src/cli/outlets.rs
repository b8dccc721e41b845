//! The arguments about outlets, and the catchments above them.

use clap::Args;
use tokosen::base::Units;
use tokosen::base::error::Finding;
use tokosen::crs::Crs;
use tokosen::raster::{Dem, GroundScale};
use tokosen::terrain::{Outlets, Place};

use super::console::Console;
use super::failure::Failure;
use super::places::{self, PlaceArg};

/// Outlets that the summary describes without `--verbose`.
const DESCRIBED: usize = 10;

#[derive(Debug, Clone, Args)]
pub struct OutletArgs {
    /// Write only the catchment above this place, or above each point of this file [coordinates of the height map]. May be
    /// given several times
    #[arg(long, value_name = "X,Y|FILE", value_parser = PlaceArg::parser(), requires = "catchments")]
    pub outlet: Vec<PlaceArg>,
    /// An outlet moves to the cell with the largest upstream area within this distance [metres; default: 3 cells]
    #[arg(long, value_name = "DISTANCE", requires = "outlet", hide_short_help = true)]
    pub outlet_snap: Option<f64>,
}

impl OutletArgs {
    /// Refuses a distance that is none.
    pub fn check(&self) -> Result<(), Failure> {
        match self.outlet_snap.filter(|snap| !(snap.is_finite() && *snap >= 0.0)) {
            Some(snap) => Err(Failure::Usage(format!("--outlet-snap is {snap}, it must be 0 or more"))),
            None => Ok(()),
        }
    }

    /// The outlets on a height map, moved to their streams; reads the files of places.
    pub fn find(&self, areas: &Dem, scale: &GroundScale, findings: &mut Vec<Finding>) -> Result<Outlets, Failure> {
        let places = places::read(&self.outlet, areas.crs.as_ref(), findings)?;
        Ok(Outlets::find(&places, areas, scale, self.outlet_snap)?.collect(findings))
    }
}

/// The lines of the summary.
pub fn describe(found: &Outlets, crs: Option<&Crs>, console: &Console) {
    let units = Units::METRES;
    let shown = if console.verbose { found.outlets.len() } else { DESCRIBED };
    for (k, (outlet, name)) in found.outlets.iter().zip(&found.names).enumerate().take(shown) {
        let first = found.outlets.iter().position(|other| other.cell == outlet.cell).filter(|first| *first < k);
        let same = first.map(|first| format!("; the same place as outlet {}", first + 1)).unwrap_or_default();
        console.say(&format!(
            "outlet     {}: {name}, moved by {} (at most {}) to {}; {} above it{same}",
            k + 1,
            units.length(outlet.moved),
            units.length(found.distance),
            Place::at(outlet.place, crs).name,
            units.area(outlet.area),
        ));
    }
    if found.outlets.len() > shown {
        console.say(&format!("           and {} more; --verbose lists them", found.outlets.len() - shown));
    }
}
