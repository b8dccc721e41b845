//! The unit of lengths in findings.
//!
//! The steps work on any plane, so their messages speak of map units. The working plane of an input is in metres, unless nothing
//! states the unit of the coordinates. Here the messages get the unit.

use super::input::Input;
use tokosen_core::base::error::Finding;

/// What the steps call a length and an area, and what these are on a plane in metres.
const UNITS: [(&str, &str); 2] = [(" square map units", " square metres"), (" map units", " m")];

impl Input {
    /// States the unit of lengths in the findings, if it is known.
    pub(super) fn state_unit(&mut self) {
        if self.is_plane_in_metres {
            self.findings.iter_mut().for_each(in_metres);
        }
    }
}

fn in_metres(finding: &mut Finding) {
    for (general, metric) in UNITS {
        finding.message = with_unit(&finding.message, general, metric);
    }
}

/// A message with another unit after its numbers. The name of a file may hold the same words.
fn with_unit(message: &str, general: &str, metric: &str) -> String {
    let mut parts = message.split(general);
    let mut changed = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        changed.push_str(if changed.ends_with(|c: char| c.is_ascii_digit()) { metric } else { general });
        changed.push_str(part);
    }
    changed
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::terrain::{InputOptions, Preparation};
    use tokosen_core::base::ElevationUnit;
    use tokosen_core::base::error::FindingKind;
    use tokosen_core::contour::{Contour, ContourMap};
    use tokosen_core::crs::{Crs, LengthUnit};

    #[test]
    fn units_follow_numbers() {
        let message = "3.5 map units of my map units.shp, 12 square map units large";
        let mut finding = Finding::general(FindingKind::Excluded, message);
        in_metres(&mut finding);
        assert_eq!(finding.message, "3.5 m of my map units.shp, 12 square metres large");
    }

    #[test]
    fn lengths_are_in_metres_unless_nobody_knows_the_unit() {
        let line = |elevation: f64, y: f64| {
            let points = [0.0, 400.0, 800.0, 1200.0].map(|x| DVec2::new(x, y)).to_vec();
            Contour { elevation, points, feature: 1.into() }
        };
        // The middle piece of the upper line runs on the lower one.
        let mut upper = line(20.0, 300.0);
        (upper.points[1].y, upper.points[2].y) = (0.0, 0.0);
        let told = |crs: Option<Crs>, plane_unit: Option<LengthUnit>, asked: Option<ElevationUnit>| {
            let contours = vec![line(10.0, 0.0), upper.clone(), line(30.0, 600.0)];
            let map = ContourMap { contours, crs, plane_unit, ..ContourMap::default() };
            let mut input =
                Input::from_map(map, &InputOptions { plane_unit: asked, ..InputOptions::default() }).unwrap();
            input.prepare(&Preparation::default(), &()).unwrap();
            let cut = input.findings.iter().find(|finding| finding.kind == FindingKind::OverlappingLines).unwrap();
            cut.message.clone()
        };
        let metre = LengthUnit { name: "metre".into(), metres: 1.0 };
        for message in [
            told(Some(Crs::from_epsg(6677)), None, None),
            told(None, Some(metre), None),
            told(None, None, Some(ElevationUnit::Metre)),
        ] {
            assert!(message.contains("for 400.000 m,"), "{message}");
            assert!(!message.contains("map units"), "{message}");
        }
        // The work on a drawing in feet is done in metres.
        let feet = told(None, None, Some(ElevationUnit::Foot));
        assert!(feet.contains("for 121.920 m,"), "{feet}");
        let unknown = told(None, None, None);
        assert!(unknown.contains("for 400.000 map units,"), "{unknown}");
    }
}
