//! The system and the unit of the contours' coordinates, and their reprojection to the working plane.

use glam::DVec2;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{CrsNeed, Error, Finding, FindingKind, Result};
use tokosen_core::contour::{ContourMap, reproject};
use tokosen_core::crs::{Crs, CrsKind, Reprojection, label, look_swapped, working_crs};
use tokosen_core::raster::other_unit;

/// The map with the system that the caller names.
pub(super) fn named(map: ContourMap, crs: Option<&Crs>, findings: &mut Vec<Finding>) -> ContourMap {
    let Some(crs) = crs else { return map };
    findings.retain(|finding| finding.kind != FindingKind::UnknownCrs);
    ContourMap { crs: Some(crs.clone()), ..map }
}

/// A map of which the unit of x and y is settled.
pub(super) struct Plane {
    /// The map. If it has no coordinate reference system and is in feet, it has that of a plane in feet.
    pub map: ContourMap,
    /// Whether x and y are taken as metres although heights are in feet and nothing states the unit of x and y.
    pub is_guessed: bool,
}

/// Units of one header and one system that differ by no more are the same. The two feet differ by two millionths, and drawings
/// hardly know which one they are in.
const SAME_UNIT: f64 = 1e-5;

/// The finding about a drawing whose header contradicts the system of its coordinates. Headers with units in which no map is
/// drawn mean nothing.
fn contradiction(map: &ContourMap) -> Option<Finding> {
    let (crs, said) = (map.crs.as_ref()?, map.plane_unit.as_ref()?);
    let own = crs.length_unit()?;
    let differ = (said.metres - own.metres).abs() > SAME_UNIT * own.metres;
    let is_credible = ElevationUnit::of_size(said.metres).is_some();
    let message = || {
        format!(
            "the drawing says that its unit is the {}, and the unit of its coordinate reference system is the {}, which is used",
            said.name, own.name
        )
    };
    (differ && is_credible).then(|| Finding::general(FindingKind::PlaneUnit, message()))
}

/// Settles the unit of x and y. `asked` is the unit that the caller asks for, `heights` that of the elevations.
///
/// # Errors
/// [`Error::PlaneUnit`] for a drawing in a unit in which no map is drawn. [`Error::Parameter`] if the unit that is asked for
/// is not that of the coordinate reference system.
pub(super) fn settle(
    map: ContourMap,
    asked: Option<ElevationUnit>,
    heights: ElevationUnit,
    findings: &mut Vec<Finding>,
) -> Result<Plane> {
    findings.extend(contradiction(&map));
    let stated = map.crs.as_ref().and_then(Crs::length_unit);
    // Only a system without a place on the Earth may be silent about its unit.
    let is_open = map.crs.as_ref().is_none_or(|crs| crs.kind().is_none() && stated.is_none());
    if let Some(asked) = asked {
        return match &map.crs {
            Some(crs) if !is_open => match stated.and_then(|own| ElevationUnit::of_size(own.metres)) == Some(asked) {
                true => Ok(Plane { map, is_guessed: false }),
                false => Err(other_unit(asked, Some(crs))),
            },
            _ => Ok(Plane { map: ContourMap { crs: Some(Crs::of_plane_in(asked)), ..map }, is_guessed: false }),
        };
    }
    match map.plane_unit.clone().filter(|_| map.crs.is_none()) {
        Some(unit) if ElevationUnit::of_size(unit.metres).is_none() => Err(Error::PlaneUnit { unit: unit.name }),
        Some(unit) if unit.metres != 1.0 => {
            Ok(Plane { map: ContourMap { crs: Some(Crs::of_plane(&unit)), ..map }, is_guessed: false })
        }
        Some(_) => Ok(Plane { map, is_guessed: false }),
        None => {
            let is_guessed = is_open && heights.is_foot();
            if is_guessed {
                let message = format!(
                    "the elevations are in {}, and nothing states the unit of x and y, which are taken as metres",
                    heights.name()
                );
                findings.push(Finding::general(FindingKind::PlaneUnit, message));
            }
            Ok(Plane { map, is_guessed })
        }
    }
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
    let plane = map.crs.as_ref().filter(|crs| crs.is_unnamed_plane());
    if kind.is_none() && plane.is_none() && map.looks_like_degrees() {
        return Err(Error::LooksLikeDegrees);
    }
    if work.is_some() && (map.crs.is_none() || plane.is_some()) {
        return Err(Error::UnknownCrs { needed_for: CrsNeed::WorkingCrs });
    }
    if let (Some(crs), Some(middle)) = (&map.crs, middle(&map))
        && look_swapped(crs, middle)
    {
        if crs.is_geographic() {
            return Err(Error::AxesSwapped { crs: label(crs) });
        }
        let message = format!(
            "the coordinates lie far from where {} is in use, and would not if x and y were swapped: x is east, y is north",
            label(crs)
        );
        findings.push(Finding::at(FindingKind::AxesSwapped, middle, message));
    }
    let working = match (work, &map.crs) {
        (Some(work), _) => work.with_heights_in(ElevationUnit::Metre),
        (None, Some(crs)) if kind.is_some() || crs.local_in_metres().is_some() => {
            working_crs(crs, map.contours.iter().flat_map(|c| &c.points).copied())?
        }
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

/// The medians of x and of y of the lines' middle vertices: a few wrong lines do not move them.
fn middle(map: &ContourMap) -> Option<DVec2> {
    let places =
        || map.contours.iter().filter_map(|line| line.points.get(line.points.len() / 2)).filter(|p| p.is_finite());
    let median = |mut numbers: Vec<f64>| {
        let at = numbers.len() / 2;
        (at < numbers.len()).then(|| *numbers.select_nth_unstable_by(at, f64::total_cmp).1)
    };
    Some(DVec2::new(median(places().map(|p| p.x).collect())?, median(places().map(|p| p.y).collect())?))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use tokosen_core::base::ElevationUnit::{Foot, Metre, UsSurveyFoot};
    use tokosen_core::contour::Contour;
    use tokosen_core::crs::LengthUnit;

    fn map(crs: Option<Crs>, plane_unit: Option<LengthUnit>) -> ContourMap {
        let points = vec![DVec2::new(1000.0, 2000.0), DVec2::new(1500.0, 2000.0)];
        let contours = vec![Contour { elevation: 10.0, points, feature: 1.into() }];
        ContourMap { contours, crs, plane_unit, ..ContourMap::default() }
    }

    fn unit(name: &str, metres: f64) -> Option<LengthUnit> {
        Some(LengthUnit { name: name.into(), metres })
    }

    /// Metres per unit of the plane, and the kinds of the findings.
    fn settled(
        map: ContourMap,
        asked: Option<ElevationUnit>,
        heights: ElevationUnit,
    ) -> Result<(f64, bool, Vec<FindingKind>)> {
        let mut findings = Vec::new();
        let plane = settle(map, asked, heights, &mut findings)?;
        let metres = plane.map.crs.and_then(|crs| crs.length_unit()).map_or(1.0, |unit| unit.metres);
        Ok((metres, plane.is_guessed, findings.into_iter().map(|finding| finding.kind).collect()))
    }

    #[test]
    fn the_unit_that_is_asked_for_comes_before_that_of_the_file() {
        let us = 1200.0 / 3937.0;
        for (stated, asked, metres) in [
            (None, Some(UsSurveyFoot), us),
            (unit("foot", 0.3048), None, 0.3048),
            (unit("foot", 0.3048), Some(Metre), 1.0),
            (unit("millimetre", 1e-3), Some(Foot), 0.3048),
            (unit("metre", 1.0), None, 1.0),
            (None, None, 1.0),
        ] {
            let found = settled(map(None, stated.clone()), asked, Metre).unwrap();
            assert_eq!(found, (metres, false, vec![]), "{stated:?} {asked:?}");
        }
    }

    #[test]
    fn a_unit_that_nobody_knows_is_told_if_heights_are_in_feet() {
        for heights in [Foot, UsSurveyFoot] {
            let found = settled(map(None, None), None, heights).unwrap();
            assert_eq!(found, (1.0, true, vec![FindingKind::PlaneUnit]));
            let found = settled(map(None, unit("metre", 1.0)), None, heights).unwrap();
            assert_eq!(found, (1.0, false, vec![]));
            let site = Crs::from_wkt("LOCAL_CS[\"site\"]");
            assert!(settled(map(Some(site), None), None, heights).unwrap().1, "a system that states no unit");
            for known in [Crs::from_epsg(2222), Crs::from_wkt("LOCAL_CS[\"site\",UNIT[\"metre\",1]]")] {
                assert!(!settled(map(Some(known), None), None, heights).unwrap().1);
            }
        }
    }

    #[test]
    fn units_in_which_no_map_is_drawn_are_refused() {
        for (name, metres) in [
            ("millimetre", 1e-3),
            ("centimetre", 1e-2),
            ("kilometre", 1e3),
            ("inch", 0.0254),
            ("mile", 1609.344),
            ("yard", 0.9144),
        ] {
            let error = settled(map(None, unit(name, metres)), None, Metre).unwrap_err();
            assert!(matches!(&error, Error::PlaneUnit { unit } if unit == name), "{error}");
            // The coordinate reference system tells the unit.
            assert!(settled(map(Some(Crs::from_epsg(6677)), unit(name, metres)), None, Metre).is_ok());
        }
    }

    #[test]
    fn a_unit_beside_a_system_must_be_its_own() {
        for (crs, asked, is_well) in [
            (2222, Foot, true),
            (2222, Metre, false),
            (2222, UsSurveyFoot, false),
            (6677, Metre, true),
            (6677, Foot, false),
            (4326, Foot, false),
        ] {
            let found = settled(map(Some(Crs::from_epsg(crs)), None), Some(asked), Metre);
            assert_eq!(found.is_ok(), is_well, "{crs} {asked:?}");
        }
    }
}
