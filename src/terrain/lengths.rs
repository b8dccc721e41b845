//! The units of heights and lengths in findings.
//!
//! The steps work in metres, on any plane, so their messages speak of metres and of map units. The working plane of an input
//! is in metres, unless nothing states the unit of the coordinates. Here the messages get the units of the input.

use super::input::Input;
use tokosen_core::base::{ElevationUnit, Units};
use tokosen_core::crs::Crs;

impl Input {
    /// The units of the input, in which messages about it speak: that of its elevations, and feet or metres for lengths.
    pub fn units(&self) -> Units {
        let own = self.reprojection.input_crs().and_then(Crs::length_unit);
        let foot = own.and_then(|own| ElevationUnit::of_size(own.metres)).filter(|unit| unit.is_foot());
        let plane = self.is_plane_in_metres.then(|| foot.unwrap_or_default());
        Units { heights: self.unit(), plane }
    }

    /// States heights and lengths in the findings in the units of the input.
    pub(super) fn state_unit(&mut self) {
        let units = self.units();
        self.findings.iter_mut().for_each(|finding| finding.message = units.message(&finding.message));
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::terrain::{InputOptions, Preparation};
    use tokosen_core::base::error::FindingKind;
    use tokosen_core::contour::{Contour, ContourMap};
    use tokosen_core::crs::LengthUnit;

    #[test]
    fn lengths_are_in_the_unit_of_the_input_unless_nobody_knows_it() {
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
        // The work on a drawing in feet is done in metres, and its user thinks in feet.
        let feet = told(None, None, Some(ElevationUnit::Foot));
        assert!(feet.contains("for 400 ft,"), "{feet}");
        let unknown = told(None, None, None);
        assert!(unknown.contains("for 400.000 map units,"), "{unknown}");
    }
}
