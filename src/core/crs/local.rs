//! Systems that say nothing about the place on the Earth: the plane of a drawing, the grid of a building site.
//!
//! Of such a system, the unit is known at most. That is enough to work in metres: coordinates in feet are multiplied, and
//! divided again for the output. Two of these systems are the same plane if they have the same name,
//! or none but that of their unit.

use super::system::{Crs, LengthUnit};
use super::vertical::epsg_name;
use crate::base::ElevationUnit;

/// The name of a plane that no file names; a comma and the unit follow.
const UNNAMED: &str = "Unnamed plane";

/// The unit of the working plane.
const METRE: (&str, f64) = ("metre", 1.0);

impl LengthUnit {
    /// EPSG code of the unit, if it has a usual one.
    fn code(&self) -> Option<u32> {
        let is = |metres: f64| (self.metres - metres).abs() <= 1e-12 * metres;
        [(1.0, 9001), (0.3048, 9002), (1200.0 / 3937.0, 9003)].into_iter().find(|(m, _)| is(*m)).map(|(_, code)| code)
    }
}

impl Crs {
    /// The system of coordinates of which the unit is known and nothing else, such as those of a drawing in feet.
    pub fn of_plane(unit: &LengthUnit) -> Self {
        Self::local(&format!("{UNNAMED}, {}", unit.name), unit)
    }

    /// The same for a unit by its name.
    pub fn of_plane_in(unit: ElevationUnit) -> Self {
        Self::of_plane(&LengthUnit { name: epsg_name(unit).to_owned(), metres: unit.metres(1.0) })
    }

    fn local(name: &str, unit: &LengthUnit) -> Self {
        let quoted = |text: &str| text.replace('"', "\"\"");
        let authority = unit.code().map_or(String::new(), |code| format!(",AUTHORITY[\"EPSG\",\"{code}\"]"));
        let wkt = format!(
            "LOCAL_CS[\"{}\",UNIT[\"{}\",{}{authority}],AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH]]",
            quoted(name),
            quoted(&unit.name),
            unit.metres
        );
        Self { epsg: None, wkt: Some(wkt) }
    }

    /// Whether the system has plane coordinates without a place on the Earth.
    pub fn is_local(&self) -> bool {
        self.root().is_some_and(|root| root.horizontal().is_local())
    }

    /// Whether nothing but the unit is known: see [`Crs::of_plane`].
    pub fn is_unnamed_plane(&self) -> bool {
        self.is_local() && self.horizontal().name().is_some_and(|name| name.starts_with(UNNAMED))
    }

    /// The same plane in metres, if this system has no place on the Earth and is in another unit.
    pub fn local_in_metres(&self) -> Option<Self> {
        let own = self.horizontal();
        let is_other = own.is_local() && own.length_unit().is_some_and(|unit| unit.metres != 1.0);
        let metre = LengthUnit { name: METRE.0.to_owned(), metres: METRE.1 };
        is_other.then(|| match own.is_unnamed_plane() {
            true => Self::of_plane(&metre),
            false => Self::local(&own.name().unwrap_or_default(), &metre),
        })
    }

    /// Units of `other` per unit of this system, if both are the same plane without a place on the Earth.
    pub(super) fn units_of(&self, other: &Self) -> Option<f64> {
        let is_one = self.name() == other.name() || (self.is_unnamed_plane() && other.is_unnamed_plane());
        if !(is_one && self.is_local() && other.is_local()) {
            return None;
        }
        let [own, its] = [self.length_unit()?.metres, other.length_unit()?.metres];
        // Texts write the size of a unit with different numbers of digits.
        Some(if (own - its).abs() <= 1e-9 * its { 1.0 } else { own / its })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Transform;

    fn plane(name: &str, metres: f64) -> Crs {
        Crs::of_plane(&LengthUnit { name: name.into(), metres })
    }

    #[test]
    fn a_plane_states_its_unit_and_no_place() {
        let feet = plane("US survey foot", 1200.0 / 3937.0);
        assert_eq!(
            feet.length_unit().map(|unit| (unit.name, unit.metres)),
            Some(("US survey foot".into(), 1200.0 / 3937.0))
        );
        assert!(feet.is_local() && feet.is_unnamed_plane() && feet.kind().is_none());
        assert!(feet.wkt1().is_some_and(|text| text.contains("\"9003\"")), "{feet:?}");
        let metres = feet.local_in_metres().unwrap();
        assert_eq!(metres.length_unit().map(|unit| unit.metres), Some(1.0));
        assert_eq!(metres.local_in_metres(), None);
        for other in [Crs::from_epsg(2222), Crs::wgs84(), Crs::from_wkt("LOCAL_CS[\"site\"]")] {
            assert_eq!(other.local_in_metres(), None);
            assert!(!other.is_unnamed_plane());
        }
    }

    #[test]
    fn coordinates_are_multiplied_and_divided() {
        let feet = plane("foot", 0.3048);
        let way = Transform::between(&feet, &feet.local_in_metres().unwrap()).unwrap();
        let p = glam::DVec2::new(1000.0, -250.0);
        assert_eq!(way.forward(p), Some(glam::DVec2::new(1000.0 * 0.3048, -250.0 * 0.3048)));
        assert!(way.inverse(way.forward(p).unwrap()).unwrap().distance(p) < 1e-9);
        assert!((way.factor().unwrap() - 0.3048).abs() < 1e-15 && !way.is_identity());
        // The same unit with fewer digits, and in the words of WKT 2.
        let text = "ENGCRS[\"Unnamed plane\",EDATUM[\"x\"],CS[Cartesian,2],AXIS[\"e\",east],AXIS[\"n\",north],\
                    LENGTHUNIT[\"foot\",0.30480000001]]";
        assert!(Transform::between(&feet, &Crs::from_wkt(text)).unwrap().is_identity());
    }

    #[test]
    fn different_planes_are_not_mixed() {
        let site = Crs::from_wkt("LOCAL_CS[\"site\",UNIT[\"foot\",0.3048]]");
        for other in
            [plane("foot", 0.3048), Crs::from_wkt("LOCAL_CS[\"other site\",UNIT[\"metre\",1]]"), Crs::from_epsg(2222)]
        {
            assert!(Transform::between(&site, &other).is_err(), "{other:?}");
        }
        assert_eq!(site.local_in_metres().and_then(|crs| crs.name()).as_deref(), Some("site"));
    }
}
