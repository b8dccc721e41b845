//! Vertical systems that a name gives by code, beside the horizontal one: `EPSG:2229+6360`,
//! `urn:ogc:def:crs,crs:EPSG::2229,crs:EPSG::6360`.

use super::height_system::vertical_unit;
use super::system::Crs;
use crate::base::ElevationUnit;

/// The name of a unit as EPSG has it.
pub fn epsg_name(unit: ElevationUnit) -> &'static str {
    match unit {
        ElevationUnit::Metre => "metre",
        ElevationUnit::Foot => "foot",
        ElevationUnit::UsSurveyFoot => "US survey foot",
    }
}

/// The codes of a horizontal and a vertical system in a name.
pub(super) fn pair_in(name: &str) -> Option<[u32; 2]> {
    let rest = name.get(..5).filter(|start| start.eq_ignore_ascii_case("EPSG:")).map(|start| &name[start.len()..]);
    let [first, second] = match rest.and_then(|rest| rest.split_once('+')) {
        Some((first, second)) => [first, second],
        None => {
            let rest = name.get(..16).filter(|start| start.eq_ignore_ascii_case("urn:ogc:def:crs,"))?;
            let (first, second) = name[rest.len()..].split_once(',')?;
            let epsg =
                |part: &str| part.to_ascii_uppercase().contains("EPSG").then(|| part.rsplit(':').next())?.map(str::len);
            [&first[first.len() - epsg(first)?..], &second[second.len() - epsg(second)?..]]
        }
    };
    let second = second.trim().trim_start_matches("EPSG:");
    Some([first.trim().parse().ok()?, second.parse().ok()?])
}

/// The compound system of a horizontal one and a vertical one by its code. The horizontal one alone if the vertical one is
/// not known here.
pub(super) fn compound(horizontal: Crs, code: u32) -> Crs {
    let (Some(plane), Some(unit)) = (horizontal.wkt(), vertical_unit(code)) else { return horizontal };
    let name = horizontal.name().unwrap_or_default().replace('"', "\"\"");
    let vertical = format!(
        "VERT_CS[\"EPSG:{code}\",VERT_DATUM[\"EPSG:{code}\",2005],UNIT[\"{}\",{:?}],AXIS[\"Up\",UP],AUTHORITY[\"EPSG\",\"{code}\"]]",
        epsg_name(unit),
        unit.metres(1.0)
    );
    Crs { epsg: None, wkt: Some(format!("COMPD_CS[\"{name} + EPSG:{code}\",{plane},{vertical}]")) }
}

impl Crs {
    /// The horizontal part with another vertical system, by its EPSG code. The horizontal part alone if there is no code, or it is
    /// not in the table of height systems.
    pub fn with_vertical(&self, code: Option<u32>) -> Self {
        let horizontal = self.horizontal();
        code.map_or_else(|| horizontal.clone(), |code| compound(horizontal.clone(), code))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_codes_are_compound_systems() {
        for name in ["EPSG:2229+6360", "epsg:2229+EPSG:6360", "urn:ogc:def:crs,crs:EPSG::2229,crs:EPSG:9.1:6360"] {
            let crs = Crs::from_name(name).expect("a system");
            assert_eq!(crs.horizontal().epsg, Some(2229), "{name}");
            let feet = crs.height_unit().map(|unit| unit.metres);
            assert!(feet.is_some_and(|feet| (feet - 0.304_800_609_601_219).abs() < 1e-15), "{name}");
        }
        let metres = Crs::from_name("EPSG:25832+5730").and_then(|crs| crs.height_unit()).map(|unit| unit.metres);
        assert_eq!(metres, Some(1.0));
        // A vertical system that is not known here says nothing about the unit.
        assert_eq!(Crs::from_name("EPSG:25832+1"), Some(Crs::from_epsg(25832)));
        let other = Crs::from_name("EPSG:25832+5730").map(|crs| crs.with_vertical(Some(5621)));
        assert_eq!(other.as_ref().and_then(Crs::height_system).map(|system| system.name).as_deref(), Some("EVRF2007"));
        assert_eq!(other.map(|crs| crs.with_vertical(None)), Some(Crs::from_epsg(25832)));
        for none in ["EPSG:25832+", "EPSG:+5730", "urn:ogc:def:crs,crs:EPSG::25832"] {
            assert_eq!(pair_in(none), None, "{none}");
        }
    }
}
