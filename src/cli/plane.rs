//! From the coordinates of the files to the plane that is worked on, and back: `--crs`, `--work-crs`, `--to-crs`.

use std::path::Path;

use clap::Args;
use tokosen::base::error::{Error, Finding, FindingKind};
use tokosen::contour::{ContourMap, reproject};
use tokosen::crs::{Bringer, Crs, CrsKind, Places, Returner, working_crs};
use tokosen::io::looks_like_degrees;

use super::Failure;

/// The coordinates that vector files are written in.
#[derive(Debug, Clone, Args)]
pub struct ToCrsArgs {
    /// Coordinate reference system to write lines and areas in [default: the input's, its vertices bit for bit]
    #[arg(long, value_name = "CRS", value_parser = crs)]
    pub to_crs: Option<Crs>,
}

impl ToCrsArgs {
    /// The way from the plane to the output.
    pub fn way(&self, places: &Places) -> Result<Returner, Failure> {
        Ok(places.give_back(self.to_crs.as_ref())?)
    }
}

/// A system as it is named on the command line.
pub fn crs(text: &str) -> Result<Crs, String> {
    let code = text.trim().parse().ok().filter(|&code: &u32| code > 0);
    let crs = code.map(Crs::from_epsg).or_else(|| Crs::from_name(text));
    let crs = crs.ok_or("it must be an EPSG code such as EPSG:6668, or a WKT")?;
    if crs.kind().is_none() {
        return Err(
            "it is neither projected nor in degrees, as far as the built-in table tells; name it by its WKT".into()
        );
    }
    Ok(crs)
}

/// The map with the system that the user names.
pub fn named(map: ContourMap, crs: Option<&Crs>, findings: &mut Vec<Finding>) -> ContourMap {
    let Some(crs) = crs else { return map };
    findings.retain(|finding| finding.kind != FindingKind::UnknownCrs);
    ContourMap { crs: Some(crs.clone()), ..map }
}

/// The map on the plane that it is worked on.
pub fn flat(
    path: &Path,
    map: ContourMap,
    work: Option<&Crs>,
    findings: &mut Vec<Finding>,
) -> Result<(ContourMap, Places), Failure> {
    if let Some(work) = work
        && !(work.kind() == Some(CrsKind::Projected) && work.length_unit().is_none_or(|unit| unit.metres == 1.0))
    {
        let name = work.name().unwrap_or_default();
        return Err(Failure::Usage(format!("--work-crs {name} is no projected system in metres")));
    }
    let kind = map.crs.as_ref().and_then(Crs::kind);
    if kind.is_none() && looks_like_degrees(&map) {
        return Err(Failure::Work(Error::file(
            path,
            "the coordinates look like degrees, and the file does not say in which coordinate reference system; name it \
             with --crs, for instance --crs EPSG:4326 (WGS 84) or --crs EPSG:6668 (JGD2011)",
        )));
    }
    if work.is_some() && map.crs.is_none() {
        let message = "--work-crs needs contours whose coordinate reference system is known; name it with --crs";
        return Err(Failure::Usage(message.into()));
    }
    let about = |e: Error| Error::file(path, e.to_string());
    let working = match (work, &map.crs) {
        (Some(work), _) => work.clone(),
        (None, Some(crs)) if kind.is_some() => {
            working_crs(crs, map.contours.iter().flat_map(|c| &c.points).copied()).map_err(about)?
        }
        (None, crs) => {
            let places = Places::unmoved(crs.clone());
            return Ok((map, places));
        }
    };
    let (map, places) = reproject(map, &working).map_err(about)?.collect(findings);
    for finding in findings {
        finding.place = finding.place.and_then(|p| places.on_plane(p));
    }
    Ok((map, places))
}

/// The way to the plane for another file.
pub fn bringer(places: &Places, path: &Path, crs: Option<&Crs>) -> Result<Bringer, Error> {
    places.bring(crs).map_err(|e| Error::file(path, e.to_string()))
}

/// The systems, for the summary.
pub fn describe(map: &ContourMap, places: Option<&Places>) -> String {
    let label = |crs: Option<&Crs>| match (crs.and_then(|c| c.name()), crs.and_then(|c| c.epsg)) {
        (Some(name), Some(code)) if !name.starts_with("EPSG:") => format!("{name} (EPSG:{code})"),
        (Some(name), _) => name,
        (None, _) => "unknown".to_owned(),
    };
    match places.filter(|places| !places.are_unmoved()) {
        Some(places) => format!("{}, worked on in {}", label(places.input_crs()), label(places.working_crs())),
        None => label(map.crs.as_ref()),
    }
}
