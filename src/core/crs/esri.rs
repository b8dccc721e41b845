//! Finds the EPSG code of a WKT that does not name one.
//!
//! Esri's `.prj` files name systems in Esri's own spelling (`JGD_2011_Japan_Zone_9`) and leave the code out. Both
//! spellings are brought to one form and compared with each entry of the built-in table. An entry counts only if its
//! ellipsoid, unit and projection parameters agree too. So a similar name never moves a map.

use super::wkt::{self, Node};

/// Largest relative difference of parameters that are the same number with other digits.
const SAME: f64 = 1e-8;

/// Names that differ by more than spelling, in the common form: Esri's name, EPSG's name.
const OTHER_NAMES: &[(&str, &str)] = &[
    ("wgs84webmercatorauxiliarysphere", "wgs84pseudomercator"),
    ("wgs84webmercator", "wgs84pseudomercator"),
    ("britishnationalgrid", "osgb36britishnationalgrid"),
    ("nzgd2000newzealandtransversemercator", "nzgd2000newzealandtransversemercator2000"),
    ("etrs89laea", "etrs89laeaeurope"),
];

/// The one code whose table entry has this system's name and parameters.
pub(super) fn epsg_of(root: &Node) -> Option<u32> {
    let prefix = match root.keyword.as_str() {
        "PROJCS" | "PROJCRS" => "PROJCS[",
        "GEOGCS" | "GEOGCRS" => "GEOGCS[",
        _ => return None,
    };
    let name = common_form(root.name()?);
    (1024..=u16::MAX)
        .filter_map(crs_definitions::from_code)
        .filter(|entry| entry.wkt.starts_with(prefix))
        .filter(|entry| entry.wkt.split('"').nth(1).is_some_and(|n| common_form(n) == name))
        .find(|entry| wkt::parse(entry.wkt).is_some_and(|known| same_numbers(root, &known)))
        .map(|entry| u32::from(entry.code))
}

/// A name in a common spelling: lower case, letters and digits only, years of datums with two digits.
fn common_form(name: &str) -> String {
    let name = name.strip_prefix("GCS_").unwrap_or(name);
    let mut form = String::new();
    for part in name.split(|c: char| !c.is_alphanumeric()).filter(|p| !p.is_empty()) {
        let year = part.len() == 4 && part.starts_with("19") && part.bytes().all(|b| b.is_ascii_digit());
        form.push_str(&part[if year { 2 } else { 0 }..].to_lowercase());
    }
    if let Some((datum, zone)) = form.split_once("japanplanerectangularcs")
        && let Some(number) = roman(zone)
    {
        return format!("{datum}japanzone{number}");
    }
    form = form.replace("gausskruger", "gauss");
    match OTHER_NAMES.iter().find(|(esri, _)| *esri == form) {
        Some((_, epsg)) => (*epsg).to_owned(),
        None => form,
    }
}

/// The value of a small Roman number in lower case.
fn roman(text: &str) -> Option<u32> {
    let digits: Option<Vec<u32>> = text
        .chars()
        .map(|c| match c {
            'i' => Some(1),
            'v' => Some(5),
            'x' => Some(10),
            _ => None,
        })
        .collect();
    let digits = digits.filter(|d| !d.is_empty())?;
    let mut sum = 0;
    for (i, &digit) in digits.iter().enumerate() {
        let before_larger = digits.get(i + 1).is_some_and(|&next| next > digit);
        sum = if before_larger { sum - i64::from(digit) } else { sum + i64::from(digit) };
    }
    u32::try_from(sum).ok()
}

/// Whether ellipsoid, unit and all parameters that both name agree, and both name enough of them.
fn same_numbers(a: &Node, b: &Node) -> bool {
    let (Some(axes_a), Some(axes_b)) = (ellipsoid(a), ellipsoid(b)) else { return false };
    if axes_a.len() < 2 || axes_a.len() != axes_b.len() || !axes_a.iter().zip(&axes_b).all(|(x, y)| same(*x, *y)) {
        return false;
    }
    if a.is_geographic() {
        return b.is_geographic();
    }
    let (Some((_, unit_a)), Some((_, unit_b))) = (a.length_unit(), b.length_unit()) else { return false };
    if !same(unit_a, unit_b) {
        return false;
    }
    let (params_a, params_b) = (parameters(a), parameters(b));
    let mut common = 0;
    for (name, value) in &params_a {
        if let Some((_, other)) = params_b.iter().find(|(n, _)| n == name) {
            if !same(*value, *other) {
                return false;
            }
            common += 1;
        }
    }
    common >= 3
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(1.0)
}

fn parameters(node: &Node) -> Vec<(String, f64)> {
    node.nodes()
        .filter(|n| n.keyword == "PARAMETER")
        .filter_map(|n| Some((n.name()?.to_lowercase(), n.numbers().next()?)))
        .collect()
}

/// Semi-major axis and inverse flattening.
fn ellipsoid(node: &Node) -> Option<Vec<f64>> {
    let geographic = if node.is_geographic() { node } else { node.child(&["GEOGCS", "BASEGEOGCRS", "GEOGCRS"])? };
    let spheroid = geographic.child(&["DATUM"])?.child(&["SPHEROID", "ELLIPSOID"])?;
    Some(spheroid.numbers().take(2).collect())
}

#[cfg(test)]
mod tests {
    use crate::crs::Crs;

    const JGD2011_ZONE_9: &str = r#"PROJCS["JGD_2011_Japan_Zone_9",GEOGCS["GCS_JGD_2011",DATUM["D_JGD_2011",
        SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],
        PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",0.0],PARAMETER["False_Northing",0.0],
        PARAMETER["Central_Meridian",139.8333333333333],PARAMETER["Scale_Factor",0.9999],
        PARAMETER["Latitude_Of_Origin",36.0],UNIT["Meter",1.0]]"#;

    #[test]
    fn esri_names_find_their_code() {
        let crs = Crs::from_wkt(JGD2011_ZONE_9);
        assert_eq!(crs.epsg, Some(6677));
        assert!(!crs.is_geographic());
        assert_eq!(crs.length_unit().map(|u| u.metres), Some(1.0));

        let utm = r#"PROJCS["ETRS_1989_UTM_Zone_32N",GEOGCS["GCS_ETRS_1989",DATUM["D_ETRS_1989",
            SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],
            PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],
            PARAMETER["Central_Meridian",9.0],PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],
            UNIT["Meter",1.0]]"#;
        assert_eq!(Crs::from_wkt(utm).epsg, Some(25832));

        let wgs = r#"GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],
            PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]"#;
        assert_eq!(Crs::from_wkt(wgs).epsg, Some(4326));
    }

    #[test]
    fn a_known_name_with_other_numbers_is_not_taken() {
        let shifted = JGD2011_ZONE_9.replace("139.8333333333333", "140.8333333333333");
        let crs = Crs::from_wkt(&shifted);
        assert_eq!(crs.epsg, None);
        assert_eq!(crs.wkt.as_deref(), Some(shifted.as_str()));
        assert_eq!(Crs::from_wkt(&JGD2011_ZONE_9.replace("UNIT[\"Meter\",1.0]", "UNIT[\"Foot\",0.3048]")).epsg, None);
        assert_eq!(Crs::from_wkt(&JGD2011_ZONE_9.replace("Zone_9", "Zone_99")).epsg, None);
    }

    #[test]
    fn all_zones_of_japan() {
        for (zone, code) in (1..=19).zip(6669..) {
            let wkt = Crs::from_epsg(code).wkt.expect("the table has all zones");
            let stem = wkt.split("\"").nth(1).expect("a name").to_owned();
            let end = wkt.rfind(",AUTHORITY").expect("a code");
            let bare = format!("{}]", &wkt[..end]).replacen(&stem, &format!("JGD_2011_Japan_Zone_{zone}"), 1);
            assert_eq!(Crs::from_wkt(&bare).epsg, Some(code), "zone {zone}");
        }
    }
}
