//! The unit of the heights in a file: the band's own, otherwise that of the coordinate reference system.

use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::crs::Crs;

/// The unit of stored heights.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HeightUnit {
    /// Metres per unit.
    pub metres: f64,
    /// What there is to say about it.
    pub finding: Option<Finding>,
}

/// The unit of the heights of a band: the first name that is given, otherwise that of the vertical part of `crs`,
/// otherwise metres.
pub(super) fn height_unit<'a>(names: impl IntoIterator<Item = Option<&'a str>>, crs: Option<&Crs>) -> HeightUnit {
    let mut names = names.into_iter().flatten().map(str::trim).filter(|name| !name.is_empty());
    let stated = crs.and_then(Crs::height_unit);
    let (metres, told) = match (names.next(), stated) {
        (Some(name), stated) => match (metres_in(name), stated) {
            (None, _) => {
                (1.0, note(format!("the heights are in {name:?}, which is not known; they are taken as metres")))
            }
            (Some(metres), Some(stated)) if ElevationUnit::of_size(stated.metres) != ElevationUnit::of_size(metres) => {
                let text = format!(
                    "the heights are in {name}, but the coordinate reference system states {}; they are taken as {name}",
                    stated.name
                );
                (metres, Some((FindingKind::UnitDoubt, text)))
            }
            (Some(metres), _) => (metres, converted(metres, name)),
        },
        (None, Some(stated)) => (stated.metres, converted(stated.metres, &stated.name)),
        (None, None) => (1.0, crs.and_then(doubt)),
    };
    HeightUnit { metres, finding: told.map(|(kind, text)| Finding::general(kind, text)) }
}

fn note(text: String) -> Option<(FindingKind, String)> {
    Some((FindingKind::HeightUnit, text))
}

fn converted(metres: f64, name: &str) -> Option<(FindingKind, String)> {
    if metres == 1.0 { None } else { note(format!("the heights are in {name}, and were read as that")) }
}

/// The doubt about heights without a unit on a plane in feet.
fn doubt(crs: &Crs) -> Option<(FindingKind, String)> {
    let plane = ElevationUnit::of_size(crs.length_unit()?.metres).filter(|unit| unit.is_foot())?.name();
    let text = format!(
        "the coordinates are {plane}, and nothing states the unit of heights; they are taken as metres. If they are feet, \
         state it in the file, for example with 'gdal_edit.py -units ft dem.tif'"
    );
    Some((FindingKind::UnitDoubt, text))
}

/// Metres per unit of height, by the unit's name. `None` if the name is not known.
fn metres_in(unit: &str) -> Option<f64> {
    match unit.to_ascii_lowercase().as_str() {
        "m" | "metre" | "meter" | "metres" | "meters" => Some(1.0),
        "ft" | "foot" | "feet" | "foot (international)" | "international foot" | "international feet" => {
            Some(ElevationUnit::Foot.metres(1.0))
        }
        "us-ft" | "us ft" | "usft" | "ftus" | "us survey foot" | "foot_us" | "us survey feet" | "foot us"
        | "survey foot" => Some(ElevationUnit::UsSurveyFoot.metres(1.0)),
        "dm" | "decimetre" | "decimeter" => Some(0.1),
        "cm" | "centimetre" | "centimeter" => Some(0.01),
        "mm" | "millimetre" | "millimeter" => Some(0.001),
        "km" | "kilometre" | "kilometer" => Some(1000.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(unit: &HeightUnit) -> Option<FindingKind> {
        unit.finding.as_ref().map(|finding| finding.kind)
    }

    #[test]
    fn the_band_comes_before_the_system() {
        // NAD83 / Arizona East (ft) + NAVD88 height (ft), and the same without heights.
        let (feet, plane) = (Crs::from_epsg(8700), Crs::from_epsg(2222));
        let unit = height_unit([None, Some(" "), Some("US survey foot")], None);
        assert_eq!((unit.metres, kind(&unit)), (1200.0 / 3937.0, Some(FindingKind::HeightUnit)));
        let unit = height_unit([None], Some(&feet));
        assert_eq!((unit.metres, kind(&unit)), (0.3048, Some(FindingKind::HeightUnit)));
        let unit = height_unit([Some("m")], Some(&feet));
        assert_eq!((unit.metres, kind(&unit)), (1.0, Some(FindingKind::UnitDoubt)));
        let unit = height_unit([Some("ft")], Some(&feet));
        assert_eq!((unit.metres, kind(&unit)), (0.3048, Some(FindingKind::HeightUnit)));
        let unit = height_unit([None], Some(&plane));
        assert_eq!((unit.metres, kind(&unit)), (1.0, Some(FindingKind::UnitDoubt)));
        assert_eq!(height_unit([Some("metre")], Some(&plane)), HeightUnit { metres: 1.0, finding: None });
        assert_eq!(height_unit([], None), HeightUnit { metres: 1.0, finding: None });
        let unit = height_unit([Some("smoot")], None);
        assert_eq!((unit.metres, kind(&unit)), (1.0, Some(FindingKind::HeightUnit)));
    }
}
