//! Reprojection of the contours to the working plane.

use crate::base::ElevationUnit;
use crate::base::error::{CrsNeed, Error, Finding, FindingKind, Result};
use crate::contour::{ContourMap, reproject};
use crate::crs::{Crs, CrsKind, Reprojection, working_crs};

/// The map with the system that the caller names.
pub(super) fn named(map: ContourMap, crs: Option<&Crs>, findings: &mut Vec<Finding>) -> ContourMap {
    let Some(crs) = crs else { return map };
    findings.retain(|finding| finding.kind != FindingKind::UnknownCrs);
    ContourMap { crs: Some(crs.clone()), ..map }
}

/// Reprojects the map and the places of the findings to the working plane.
pub(super) fn on_plane(
    map: ContourMap,
    work: Option<&Crs>,
    findings: &mut Vec<Finding>,
) -> Result<(ContourMap, Reprojection)> {
    if let Some(work) = work
        && !(work.kind() == Some(CrsKind::Projected) && work.length_unit().is_none_or(|unit| unit.metres == 1.0))
    {
        return Err(Error::NotProjectedInMetres { name: work.name().unwrap_or_default() });
    }
    let kind = map.crs.as_ref().and_then(Crs::kind);
    if kind.is_none() && map.looks_like_degrees() {
        return Err(Error::LooksLikeDegrees);
    }
    if work.is_some() && map.crs.is_none() {
        return Err(Error::UnknownCrs { needed_for: CrsNeed::WorkingCrs });
    }
    let working = match (work, &map.crs) {
        (Some(work), _) => work.with_heights_in(ElevationUnit::Metre),
        (None, Some(crs)) if kind.is_some() => working_crs(crs, map.contours.iter().flat_map(|c| &c.points).copied())?,
        (None, crs) => {
            let reprojection = Reprojection::unmoved(crs.clone());
            let crs = reprojection.working_crs().cloned();
            return Ok((ContourMap { crs, ..map }, reprojection));
        }
    };
    let (map, reprojection) = reproject(map, &working)?.collect(findings);
    for finding in findings {
        finding.place = finding.place.and_then(|p| reprojection.on_plane(p));
    }
    Ok((map, reprojection))
}
