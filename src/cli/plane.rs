//! Coordinate reference systems on the command line: `--crs`, `--work-crs`, `--to-crs`.

use std::path::Path;

use clap::Args;
use tokosen::base::ElevationUnit;
use tokosen::contour::ContourMap;
use tokosen::crs::{Crs, FromWorking, Reprojection};
use tokosen::io::VectorFormat;

use super::failure::Failure;

/// The EPSG code of WGS 84.
const WGS84: u32 = 4326;

/// The coordinates that vector files are written in.
#[derive(Debug, Clone, Args)]
pub struct ToCrsArgs {
    /// Coordinate reference system to write lines and areas in [default: the input's; its vertices stay bit for bit]. A
    /// vertical part with another unit than the heights that are written is left out
    #[arg(long, value_name = "CRS", value_parser = crs)]
    pub to_crs: Option<Crs>,
}

impl ToCrsArgs {
    /// Refuses another system than that of KML for a KML.
    pub fn check(&self, output: &Path) -> Result<(), Failure> {
        match self.to_crs.as_ref().filter(|crs| is_kml(output) && crs.epsg != Some(WGS84)) {
            Some(_) => {
                Err(Failure::Usage(format!("{}: KML is always in WGS 84: leave out --to-crs", output.display())))
            }
            None => Ok(()),
        }
    }

    /// The conversion from the working plane to the output, with heights in `unit` there. A KML is refused now, not after the
    /// work, if nobody knows where the map lies.
    pub fn way(
        &self,
        output: Option<&Path>,
        reprojection: &Reprojection,
        unit: ElevationUnit,
    ) -> Result<FromWorking, Failure> {
        let back = reprojection.from_working(self.to_crs.as_ref())?.with_heights_in(unit);
        output.filter(|output| is_kml(output)).map(|_| back.to(&Crs::from_epsg(WGS84))).transpose()?;
        Ok(back)
    }
}

fn is_kml(output: &Path) -> bool {
    matches!(VectorFormat::from_path(output), Ok(VectorFormat::Kml))
}

/// The coordinates of the cells of a height map.
#[derive(Debug, Clone, Args)]
pub struct CellsCrsArgs {
    /// Coordinate reference system of the height map; its cells are on multiples of --cell there [units of this CRS], or
    /// of --cell-degrees if it is in degrees [default: the working CRS]
    #[arg(long, value_name = "CRS", value_parser = crs, conflicts_with = "like")]
    pub to_crs: Option<Crs>,
}

/// A system as it is named on the command line.
pub fn crs(text: &str) -> Result<Crs, String> {
    Crs::from_text(text)
}

/// The systems, for the summary.
pub fn describe(map: &ContourMap, reprojection: Option<&Reprojection>) -> String {
    let input = reprojection.map_or(map.crs.as_ref(), Reprojection::input_crs);
    if let Some(unit) = input.filter(|crs| crs.is_unnamed_plane()).and_then(Crs::length_unit) {
        let work = if unit.metres == 1.0 { "" } else { "; the work is done in metres" };
        return format!("unknown; the unit of x and y is the {}{work}", unit.name);
    }
    let label = |crs: Option<&Crs>| match (crs.and_then(|c| c.name()), crs.and_then(|c| c.epsg)) {
        (Some(name), Some(code)) if !name.starts_with("EPSG:") => format!("{name} (EPSG:{code})"),
        (Some(name), _) => name,
        (None, _) => "unknown".to_owned(),
    };
    match reprojection.filter(|reprojection| !reprojection.are_unmoved()) {
        Some(known) => format!("{}, working CRS {}", label(known.input_crs()), label(known.working_crs())),
        None => label(map.crs.as_ref()),
    }
}

/// Why data on WGS 84 are worked on in a system of another name.
pub fn why_not_wgs84(reprojection: Option<&Reprojection>) -> Option<&'static str> {
    let known = reprojection?;
    let is_wgs84 = |crs: Option<&Crs>| crs.and_then(Crs::name).is_some_and(|name| name.starts_with("WGS 84"));
    (is_wgs84(known.input_crs()) && known.working_crs().is_some() && !is_wgs84(known.working_crs()))
        .then_some("maps of this region are made in that system; it agrees with WGS 84 within about a metre")
}
