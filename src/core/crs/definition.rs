//! What the coordinates of a system mean, as parameters of `proj4rs`.
//!
//! The built-in table has them for EPSG codes. For a system known only by its text, they are taken from the text, for
//! projections in wide use. If the shift between two datums is not known, the transformation is refused. A silent error
//! of a hundred metres is worse than no result.

use super::system::{Crs, CrsKind, DEGREE, definition};
use super::wkt::Node;
use crate::base::error::{Error, Result};

/// The parameters of a system.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Definition {
    /// Names and values, in the order of the text.
    parameters: Vec<(String, Option<String>)>,
    /// Name of the datum in lower case, letters and digits only, if it is known.
    pub datum: Option<String>,
    /// Radians per unit of the coordinates, for geographic systems.
    pub angle: Option<f64>,
}

/// The shift from a datum to WGS 84.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shift {
    /// None, within about a metre: coordinates stay as they are.
    None,
    /// Known parameters.
    Known,
    /// A grid file of shifts, which is not available.
    Grid,
    /// Not known.
    Unknown,
}

/// Semi-major axis and inverse flattening of WGS 84 and GRS 1980, to the digits that they share.
const MODERN: (f64, f64) = (6_378_137.0, 298.2572);

impl Definition {
    /// The parameters of a system.
    pub fn of(crs: &Crs) -> Result<Self> {
        let crs = crs.horizontal();
        let refuse = |why: &str| Err(Error::Data(format!("{}: {why}", label(&crs))));
        let Some(root) = crs.root() else {
            return refuse("the coordinate reference system is not known, so its coordinates cannot be transformed");
        };
        let root = root.horizontal();
        let angle = match crs.kind() {
            Some(CrsKind::Geographic) => Some(root.angle()),
            Some(CrsKind::Projected) => None,
            None => return refuse("is neither projected nor in degrees, so its coordinates cannot be transformed"),
        };
        let base = if angle.is_some() { Some(root) } else { root.child(&["GEOGCS", "BASEGEOGCRS", "BASEGEODCRS"]) };
        let datum = base.and_then(|base| base.child(&["DATUM", "ENSEMBLE"])).and_then(datum_form);
        let entry = crs.epsg.and_then(definition).map(|d| d.proj4).filter(|text| !text.is_empty());
        let text = match entry {
            Some(text) => text.to_owned(),
            None => match base.and_then(|base| from_text(root, base, angle)) {
                Some(text) => text,
                None => return refuse("its projection is not supported, so its coordinates cannot be transformed"),
            },
        };
        let parameter = |token: &str| match token.split_once('=') {
            Some((name, value)) => (name.to_owned(), Some(value.to_owned())),
            None => (token.to_owned(), None),
        };
        let parameters = text.split_whitespace().map(|token| parameter(token.trim_start_matches('+'))).collect();
        let mut found = Self { parameters, datum, angle };
        // Of two ways to WGS 84, the one without a file is used.
        if found.get("towgs84").is_some() || found.get("datum").is_some() {
            found.drop("nadgrids");
        }
        Ok(found)
    }

    fn get(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_deref().unwrap_or(""))
    }

    fn drop(&mut self, name: &str) {
        self.parameters.retain(|(n, _)| n != name);
    }

    /// The shift from the datum to WGS 84.
    pub fn shift(&self) -> Shift {
        match (self.get("datum"), self.get("towgs84"), self.get("nadgrids")) {
            (Some("NAD27"), ..) => Shift::Grid,
            (Some("WGS84" | "NAD83"), ..) => Shift::None,
            (Some(_), ..) => Shift::Known,
            (_, Some(numbers), _) => {
                let zero = |n: &str| n.trim().parse::<f64>().is_ok_and(|n| n == 0.0);
                if numbers.split(',').all(zero) { Shift::None } else { Shift::Known }
            }
            (_, _, Some("@null")) => Shift::None,
            (_, _, Some(_)) => Shift::Grid,
            _ if self.is_modern() => Shift::None,
            _ => Shift::Unknown,
        }
    }

    /// Whether the ellipsoid is that of WGS 84 or GRS 1980: datums on them lie within a metre or so of WGS 84.
    fn is_modern(&self) -> bool {
        let number = |name| self.get(name).and_then(|n| n.parse::<f64>().ok());
        match (self.get("ellps"), number("a"), number("rf")) {
            (Some(name), ..) => matches!(name, "WGS84" | "GRS80"),
            (None, Some(a), Some(rf)) => a == MODERN.0 && (rf - MODERN.1).abs() < 1e-3,
            (None, None, None) => self.get("R").is_none(),
            _ => false,
        }
    }

    /// Whether longitudes count from Greenwich.
    pub fn counts_from_greenwich(&self) -> bool {
        self.get("pm").is_none_or(|meridian| meridian == "greenwich")
    }

    /// The text for `proj4rs`, with coordinates on the system's own datum.
    pub fn on_own_datum(&self) -> String {
        let mut own = self.clone();
        own.drop("towgs84");
        own.drop("nadgrids");
        // The datum stands for a grid file that is not needed here.
        if own.get("datum") == Some("NAD27") {
            own.drop("datum");
            own.parameters.push(("ellps".to_owned(), Some("clrk66".to_owned())));
        }
        own.text()
    }

    /// The text for `proj4rs`, with a shift to WGS 84. Without one, coordinates would keep their values on another
    /// datum.
    pub fn with_shift(&self) -> String {
        let mut text = self.text();
        if ["datum", "towgs84", "nadgrids"].iter().all(|name| self.get(name).is_none()) {
            text.push_str(" +towgs84=0,0,0");
        }
        text
    }

    fn text(&self) -> String {
        let token = |(name, value): &(String, Option<String>)| match value {
            Some(value) => format!("+{name}={value}"),
            None => format!("+{name}"),
        };
        self.parameters.iter().map(token).collect::<Vec<_>>().join(" ")
    }
}

/// The name of a system in messages.
pub fn label(crs: &Crs) -> String {
    match (crs.name(), crs.epsg) {
        (Some(name), Some(code)) if !name.starts_with("EPSG:") => format!("{name} (EPSG:{code})"),
        (Some(name), _) => name,
        (None, _) => "a system without a name".to_owned(),
    }
}

/// Lower case, letters and digits only.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Beginnings of names that programs write for a datum without a name, in plain form.
const NAMELESS: [&str; 3] = ["unknown", "unnamed", "notspecified"];

/// A datum's name, the same for all flavours of WKT. A datum without a name goes by its ellipsoid and its shift: two datums
/// "unknown" on different ellipsoids are not the same.
fn datum_form(datum: &Node) -> Option<String> {
    let name = datum.name()?;
    let name = plain(name.strip_prefix("D_").unwrap_or(name));
    let name = name.strip_suffix("ensemble").unwrap_or(&name);
    if NAMELESS.iter().any(|start| name.starts_with(start)) {
        let numbers = |keywords: &[&str]| datum.child(keywords).map(|node| node.numbers().collect::<Vec<f64>>());
        let [axes, shift] = [numbers(&["SPHEROID", "ELLIPSOID"]), numbers(&["TOWGS84"])];
        return Some(format!("unknown {axes:?} {shift:?}"));
    }
    Some(match name {
        "wgs1984" | "worldgeodeticsystem1984" => "wgs84".to_owned(),
        "etrs1989" | "europeanterrestrialreferencesystem1989" => "etrs89".to_owned(),
        "jgd2000" | "japanesegeodeticdatum2000" => "jgd2000".to_owned(),
        "jgd2011" | "japanesegeodeticdatum2011" => "jgd2011".to_owned(),
        other => other.to_owned(),
    })
}

/// The projections that are read from texts, by the plain forms of their names.
const PROJECTIONS: &[(&[&str], &str)] = &[
    (&["transversemercator", "gausskruger", "transversemercatorsouthorientated"], "tmerc"),
    (&["lambertconformalconic", "lambertconformalconic1sp", "lambertconicconformal1sp"], "lcc"),
    (&["lambertconformalconic2sp", "lambertconicconformal2sp"], "lcc"),
    (&["mercator", "mercator1sp", "mercator2sp", "mercatorvarianta", "mercatorvariantb"], "merc"),
    (&["lambertazimuthalequalarea"], "laea"),
    (&["albers", "albersconicequalarea", "albersequalarea"], "aea"),
    (&["obliquestereographic", "doublestereographic"], "sterea"),
];

/// Names of parameters in the texts, in plain form, and in `proj4rs`; angles first.
const ANGLES: &[(&[&str], &str)] = &[
    (
        &[
            "latitudeoforigin",
            "latitudeofcenter",
            "latitudeofnaturalorigin",
            "latitudeoffalseorigin",
            "latitudeofprojectioncentre",
        ],
        "lat_0",
    ),
    (
        &[
            "centralmeridian",
            "longitudeofcenter",
            "longitudeoforigin",
            "longitudeofnaturalorigin",
            "longitudeoffalseorigin",
        ],
        "lon_0",
    ),
    (&["standardparallel1", "latitudeof1ststandardparallel"], "lat_1"),
    (&["standardparallel2", "latitudeof2ndstandardparallel"], "lat_2"),
];
const LENGTHS: &[(&[&str], &str)] =
    &[(&["falseeasting", "eastingatfalseorigin"], "x_0"), (&["falsenorthing", "northingatfalseorigin"], "y_0")];
const SCALES: &[&str] = &["scalefactor", "scalefactoratnaturalorigin"];

/// The parameters that a text describes. `None` if its projection or one of its parameters is not known here.
fn from_text(root: &Node, base: &Node, angle: Option<f64>) -> Option<String> {
    let ellipsoid = base.child(&["DATUM", "ENSEMBLE"])?.child(&["SPHEROID", "ELLIPSOID"])?;
    let mut axes = ellipsoid.numbers();
    let (a, rf) = (axes.next().filter(|a| a.is_finite() && *a > 0.0)?, axes.next()?);
    let mut text = if rf == 0.0 { format!("+a={a} +b={a}") } else { format!("+a={a} +rf={rf}") };
    if let Some(shift) = base.all().into_iter().find(|node| node.keyword == "TOWGS84") {
        let numbers: Vec<String> = shift.numbers().map(|n| n.to_string()).collect();
        text.push_str(&format!(" +towgs84={}", numbers.join(",")));
    }
    let unit = base.angle();
    if let Some(node) = base.child(&["PRIMEM", "PRIMEMERIDIAN"])
        && let Some(meridian) = node.numbers().next().filter(|meridian| *meridian != 0.0)
    {
        // In degrees, whatever the unit of the system is, unless the meridian names a unit of its own.
        let own_unit = node.child(&["ANGLEUNIT", "UNIT"]).and_then(|unit| unit.numbers().next());
        text.push_str(&format!(" +pm={}", degrees(meridian, own_unit.unwrap_or(DEGREE))));
    }
    if angle.is_some() {
        return Some(format!("+proj=longlat {text}"));
    }
    let conversion = root.child(&["CONVERSION"]).unwrap_or(root);
    let name = plain(conversion.child(&["PROJECTION", "METHOD"])?.name()?);
    let (_, projection) = PROJECTIONS.iter().find(|(names, _)| names.contains(&name.as_str()))?;
    if name.ends_with("southorientated") {
        text.push_str(" +axis=wsu");
    }
    let (_, metres) = root.length_unit()?;
    for node in conversion.nodes().filter(|node| node.keyword == "PARAMETER") {
        let (name, value) = (plain(node.name()?), node.numbers().next()?);
        let known = |table: &[(&[&str], &'static str)]| {
            table.iter().find(|(names, _)| names.contains(&name.as_str())).map(|(_, known)| *known)
        };
        let own_unit = node.child(&["ANGLEUNIT", "LENGTHUNIT", "SCALEUNIT", "UNIT"]).and_then(|u| u.numbers().next());
        if let Some(known) = known(ANGLES) {
            // Mercator's parallel of true scale has a name of its own.
            let known = if known == "lat_1" && *projection == "merc" { "lat_ts" } else { known };
            text.push_str(&format!(" +{known}={}", degrees(value, own_unit.unwrap_or(unit))));
        } else if let Some(known) = known(LENGTHS) {
            text.push_str(&format!(" +{known}={}", value * own_unit.unwrap_or(metres)));
        } else if SCALES.contains(&name.as_str()) {
            text.push_str(&format!(" +k_0={value}"));
        } else {
            return None;
        }
    }
    // A cone with one standard parallel touches at the latitude of origin.
    if *projection == "lcc" && !text.contains("+lat_1=") {
        let origin = text.split("+lat_0=").nth(1)?.split(' ').next()?.to_owned();
        text.push_str(&format!(" +lat_1={origin}"));
    }
    Some(format!("+proj={projection} {text} +to_meter={metres}"))
}

/// An angle in degrees, without rounding if it is given in degrees.
fn degrees(value: f64, unit: f64) -> f64 {
    if (unit - DEGREE).abs() < 1e-12 { value } else { (value * unit).to_degrees() }
}

impl Node {
    /// Radians per unit of angle of this geographic system; those of a degree if it does not say.
    pub(super) fn angle(&self) -> f64 {
        let unit = self
            .child(&["UNIT", "ANGLEUNIT"])
            .or_else(|| self.child(&["AXIS"]).and_then(|axis| axis.child(&["ANGLEUNIT", "UNIT"])));
        let radians = unit.and_then(|unit| unit.numbers().next()).filter(|r| r.is_finite() && *r > 0.0);
        // Texts round this number.
        radians.filter(|r| (r - DEGREE).abs() > 1e-12).unwrap_or(DEGREE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_are_known_or_said_to_be_unknown() {
        for (code, shift) in [
            (4326, Shift::None),
            (4612, Shift::None),
            (6668, Shift::None),
            (6677, Shift::None),
            (25832, Shift::None),
            (4269, Shift::None),
            (3857, Shift::None),
            (4301, Shift::Known),
            (30169, Shift::Known),
            (27200, Shift::Known),
            (4267, Shift::Grid),
            (4004, Shift::Unknown),
            (4035, Shift::Unknown),
        ] {
            assert_eq!(Definition::of(&Crs::from_epsg(code)).unwrap().shift(), shift, "{code}");
        }
    }

    #[test]
    fn what_has_no_plane_and_no_degrees_is_refused() {
        for crs in [Crs::from_epsg(4978), Crs::from_wkt("LOCAL_CS[\"site\"]"), Crs { epsg: Some(10162), wkt: None }] {
            assert!(Definition::of(&crs).is_err());
        }
    }

    #[test]
    fn datums_have_one_name_in_all_flavours() {
        let of = |text: &str| Definition::of(&Crs::from_wkt(text)).unwrap().datum;
        let esri = r#"GEOGCS["GCS_JGD_2011",DATUM["D_JGD_2011",SPHEROID["GRS_1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["Degree",0.0174532925199433]]"#;
        assert_eq!(of(esri), Definition::of(&Crs::from_epsg(6668)).unwrap().datum);
        let new = r#"GEOGCRS["WGS 84",ENSEMBLE["World Geodetic System 1984 ensemble",ELLIPSOID["WGS 84",6378137,298.257223563]],CS[ellipsoidal,2],ANGLEUNIT["degree",0.0174532925199433]]"#;
        assert_eq!(of(new), Definition::of(&Crs::wgs84()).unwrap().datum);
    }

    #[test]
    fn datums_without_a_name_are_told_apart_by_their_ellipsoids() {
        let of = |datum: &str| {
            let text = format!(
                "GEOGCS[\"unknown\",DATUM[{datum}],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]"
            );
            Definition::of(&Crs::from_wkt(&text)).unwrap().datum
        };
        let bessel = r#""unknown",SPHEROID["Bessel 1841",6377397.155,299.1528128]"#;
        assert_eq!(of(bessel), of(&bessel.replace("Bessel 1841", "b").replace("unknown", "Unknown_based_on_b")));
        assert_ne!(of(bessel), of(r#""unknown",SPHEROID["International 1924",6378388,297]"#));
        assert_ne!(of(bessel), of(&format!("{bessel},TOWGS84[1,2,3,0,0,0,0]")));
    }
}
