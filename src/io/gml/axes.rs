//! The order of coordinates in a GML document, by the name of its coordinate reference system.
//!
//! `urn:ogc:def:crs:EPSG::4326` and `http://www.opengis.net/def/crs/EPSG/0/4326` stand for the definition of EPSG with its
//! axes: latitude first, and for many plane systems northing first. `EPSG:4326` and `…/gml/srs/epsg.xml#4326` are older;
//! most programs write longitude or easting first with them. GDAL reads them so too. What is not certain is told.

use tokosen_core::crs::{Crs, label};

/// A system with the order of its coordinates.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axes {
    pub crs: Crs,
    /// Whether the first number is the latitude or the northing.
    pub north_first: bool,
    /// Why the order is not certain, as a sentence.
    pub doubt: Option<String>,
}

/// The system and the order that a name stands for; `None` if the name is not known.
pub(super) fn of_name(name: &str) -> Option<Axes> {
    let crs = Crs::from_name(name)?;
    let lower = name.trim().to_ascii_lowercase();
    let horizontal = crs.horizontal();
    let shown = label(&crs);
    if lower.contains("crs84") || lower.contains("crs83") || lower.contains("crs27") {
        return Some(Axes { crs, north_first: false, doubt: None });
    }
    let is_short = lower.starts_with("epsg:") || lower.contains("/gml/srs/epsg.xml#");
    let (north_first, doubt) = match (is_short, horizontal.is_geographic(), horizontal.is_east_first()) {
        (true, true, _) => {
            let doubt = format!(
                "the name {name:?} of the coordinate reference system leaves open whether longitude or latitude comes \
                 first; longitude is taken to come first"
            );
            (false, Some(doubt))
        }
        (true, false, _) => (false, None),
        (false, true, _) => (true, None),
        (false, false, Some(true)) => (false, None),
        (false, false, Some(false)) => {
            let doubt = format!(
                "by its definition, {shown} has the northing first, and the coordinates are taken in this order; if the map \
                 is mirrored, the file has the easting first: change its srsName from {name:?} to \"EPSG:{}\"",
                horizontal.epsg.unwrap_or_default()
            );
            (true, Some(doubt))
        }
        (false, false, None) => {
            let doubt =
                format!("the order of the axes of {shown} is not known here; the easting is taken to come first");
            (false, Some(doubt))
        }
    };
    Some(Axes { crs, north_first, doubt })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_form_of_the_name_decides() {
        let of = |name: &str| {
            let axes = of_name(name).unwrap_or_else(|| panic!("{name}"));
            (axes.crs.epsg, axes.north_first, axes.doubt.is_some())
        };
        assert_eq!(of("urn:ogc:def:crs:EPSG::4326"), (Some(4326), true, false));
        assert_eq!(of("http://www.opengis.net/def/crs/EPSG/0/6668"), (Some(6668), true, false));
        assert_eq!(of("urn:ogc:def:crs:OGC:1.3:CRS84"), (Some(4326), false, false));
        assert_eq!(of("EPSG:4326"), (Some(4326), false, true));
        assert_eq!(of("http://www.opengis.net/gml/srs/epsg.xml#4326"), (Some(4326), false, true));
        // UTM has the easting first, Gauss-Krüger and the zones of Japan the northing.
        assert_eq!(of("urn:ogc:def:crs:EPSG::25832"), (Some(25832), false, false));
        assert_eq!(of("urn:ogc:def:crs:EPSG::31467"), (Some(31467), true, true));
        assert_eq!(of("urn:ogc:def:crs:EPSG::6677"), (Some(6677), true, true));
        assert_eq!(of("EPSG:31467"), (Some(31467), false, false));
        assert_eq!(of("http://www.opengis.net/def/crs/EPSG/0/27700"), (Some(27700), false, false));
        assert_eq!(of("urn:ogc:def:crs:EPSG::65000"), (Some(65000), false, true));
        assert_eq!(of_name("my grid"), None);
    }
}
