//! Joins the maps of several files to one.

use std::path::PathBuf;

use glam::DVec2;

use crate::base::ElevationUnit;
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::contour::ContourMap;
use crate::crs::{Crs, Transform, label};

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
}

/// The lines and spot heights of all sheets as one map, in the coordinate reference system of the first sheet that names
/// one. The lines of sheets in another system are transformed, with a finding. Sheets that name none are taken to be in
/// that system.
///
/// Features get the number of their file, from 1. Findings get its name.
///
/// # Errors
/// As [`Transform::between`]. [`Error::NoPlace`] if a vertex has no place in the system of the others.
pub(super) fn joined(sheets: Vec<Sheet>) -> Result<Report<ContourMap>> {
    let mut findings = Vec::new();
    let mut map = ContourMap { crs: sheets.iter().find_map(|sheet| sheet.map.crs.clone()), ..ContourMap::default() };
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
