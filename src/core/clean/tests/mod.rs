//! Cleaning as a whole: cases, and properties against a slow search for conflicts in whole numbers.

mod cases;
mod overruns;
mod properties;

use glam::{DVec2, DVec3};

use super::{CleanParams, clean};
use crate::base::error::{FindingKind, Report};
use crate::contour::{Contour, ContourMap};

/// A line through whole coordinates.
fn line(feature: u64, elevation: f64, points: &[(i32, i32)]) -> Contour {
    let points = points.iter().map(|&(x, y)| DVec2::new(x.into(), y.into())).collect();
    Contour { elevation, points, feature: feature.into() }
}

fn map(contours: Vec<Contour>) -> ContourMap {
    ContourMap { contours, ..ContourMap::default() }
}

fn cleaned(contours: Vec<Contour>, snap: f64) -> Report<ContourMap> {
    let params = CleanParams { snap, ..CleanParams::default() };
    let report = clean(map(contours), &params).expect("few conflicts");
    super::validate(&report.value, &params).expect("sound");
    report
}

fn with_spots(contours: Vec<Contour>, spots: &[[f64; 3]]) -> Report<ContourMap> {
    let spots = spots.iter().map(|s| DVec3::from_array(*s)).collect();
    clean(ContourMap { spots, ..map(contours) }, &CleanParams::default()).expect("few conflicts")
}

fn kinds(report: &Report<ContourMap>) -> Vec<FindingKind> {
    report.findings.iter().map(|f| f.kind).collect()
}
