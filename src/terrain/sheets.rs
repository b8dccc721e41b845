//! Joins the maps of several files to one.

use std::path::PathBuf;

use glam::DVec2;

use super::height_systems::beside;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::contour::ContourMap;
use tokosen_core::crs::{Crs, LengthUnit, Transform, label};

/// The map of one file, with its elevations in metres.
pub(super) struct Sheet {
    /// The file.
    pub file: PathBuf,
    /// Its map. Places in the findings are in its coordinates.
    pub map: ContourMap,
    /// The findings about it.
    pub findings: Vec<Finding>,
    /// The unit that its elevations had.
    pub unit: ElevationUnit,
    /// Its heights in this unit, if it is not the metre.
    pub heights: Vec<f64>,
}

/// The lines and spot heights of all sheets as one map, in the coordinate reference system of the first sheet that names
/// one. The lines of sheets in another system are transformed, with a finding. Sheets that name none are taken to be in
/// that system.
///
/// If no sheet names a system, drawings are brought to one unit of x and y, unless the caller asks for a unit.
///
/// Features get the number of their file, from 1. Findings get its name.
///
/// # Errors
/// As [`Transform::between`]. [`Error::PlaneUnit`] for a drawing in a unit in which no map is drawn. [`Error::NoPlace`] if a vertex has no place in the system of the others.
pub(super) fn joined(mut sheets: Vec<Sheet>, asked: Option<ElevationUnit>) -> Result<Report<ContourMap>> {
    let mut findings = Vec::new();
    let mut map = ContourMap { crs: sheets.iter().find_map(|sheet| sheet.map.crs.clone()), ..ContourMap::default() };
    if map.crs.is_none() && asked.is_none() {
        map.plane_unit = same_unit(&mut sheets)?;
    }
    map.height_system = sheets.iter().find_map(|sheet| sheet.map.height_system.clone());
    if let Some((first, system)) = sheets.iter().find_map(|s| Some((s.file.clone(), s.map.height_system.clone()?))) {
        for sheet in &sheets {
            findings
                .extend(beside((&first.display(), &system), (&sheet.file.display(), sheet.map.height_system.as_ref())));
        }
    }
    for (number, mut sheet) in (1..).zip(sheets) {
        let name = sheet.file.display().to_string();
        if let Some(common) = &map.crs {
            match &sheet.map.crs {
                Some(own) if !own.horizontal().matches(&common.horizontal()) => {
                    let (from, to) = (label(own), label(common));
                    let own = own.clone();
                    transform(&mut sheet, &own, common).map_err(|error| error.in_file(&sheet.file))?;
                    let message = format!("the file is in {from}; its lines were transformed to {to}");
                    sheet.findings.push(Finding::general(FindingKind::OtherCrs, message));
                }
                Some(_) => {}
                None => {
                    let others = format!("; it is taken to be that of the other files, {}", label(common));
                    let about = |finding: &&mut Finding| finding.kind == FindingKind::UnknownCrs;
                    sheet.findings.iter_mut().filter(about).for_each(|finding| finding.message.push_str(&others));
                }
            }
        }
        for finding in &mut sheet.findings {
            finding.message = format!("{name}: {}", finding.message);
            finding.features.iter_mut().for_each(|feature| *feature = feature.in_file(number));
        }
        findings.append(&mut sheet.findings);
        let ContourMap { contours, spots, depressions, .. } = sheet.map;
        map.contours.extend(contours.into_iter().map(|mut line| {
            line.feature = line.feature.in_file(number);
            line
        }));
        map.spots.extend(spots);
        map.depressions.extend(depressions.into_iter().map(|(feature, mark)| (feature.in_file(number), mark)));
    }
    Ok(Report { value: map, findings })
}

/// Brings drawings without a coordinate reference system to one unit of x and y, which is returned: that of the first sheet that
/// states one. Sheets that state none are taken to be in it.
fn same_unit(sheets: &mut [Sheet]) -> Result<Option<LengthUnit>> {
    let Some(common) = sheets.iter().find_map(|sheet| sheet.map.plane_unit.clone()) else { return Ok(None) };
    for sheet in sheets {
        let message = match &sheet.map.plane_unit {
            Some(own) if ElevationUnit::of_size(own.metres).is_none() => {
                return Err(Error::PlaneUnit { unit: own.name.clone() }.in_file(&sheet.file));
            }
            Some(own) if own.metres == common.metres => continue,
            Some(own) => {
                let (unit, factor) = (own.name.clone(), own.metres / common.metres);
                scale(&mut sheet.map, factor);
                sheet.findings.iter_mut().for_each(|finding| finding.place = finding.place.map(|p| p * factor));
                format!(
                    "the unit of the drawing is the {unit}; x and y were turned into the unit of the others, the {}",
                    common.name
                )
            }
            None if common.metres == 1.0 => continue,
            None => {
                format!("nothing states the unit of x and y; it is taken to be that of the others, the {}", common.name)
            }
        };
        sheet.findings.push(Finding::general(FindingKind::OtherCrs, message));
    }
    Ok(Some(common))
}

/// Multiplies x and y.
fn scale(map: &mut ContourMap, factor: f64) {
    map.contours.iter_mut().flat_map(|line| &mut line.points).for_each(|p| *p *= factor);
    map.spots.iter_mut().for_each(|spot| *spot = (spot.truncate() * factor).extend(spot.z));
}

/// Transforms the places of a sheet.
fn transform(sheet: &mut Sheet, from: &Crs, to: &Crs) -> Result<()> {
    let way = Transform::between(from, to)?;
    let place = |p: DVec2| way.forward(p).ok_or_else(|| Error::NoPlace { place: p, from: label(from), to: label(to) });
    for point in sheet.map.contours.iter_mut().flat_map(|line| &mut line.points) {
        *point = place(*point)?;
    }
    for spot in &mut sheet.map.spots {
        *spot = place(spot.truncate())?.extend(spot.z);
    }
    for finding in &mut sheet.findings {
        finding.place = finding.place.and_then(|p| way.forward(p));
    }
    Ok(())
}
