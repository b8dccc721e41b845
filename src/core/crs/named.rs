//! A coordinate reference system from a name, a PROJ string, or what a user writes.

use super::system::Crs;
use super::wkt;
use super::{proj_string, vertical};

impl Crs {
    /// The system of a PROJ string such as `+proj=utm +zone=33 +datum=WGS84`; `None` if the text is none.
    ///
    /// # Errors
    /// A sentence if the built-in table has no entry with these parameters, or several of different datums.
    pub fn from_proj(text: &str) -> Option<Result<Self, String>> {
        proj_string::is_proj(text).then(|| proj_string::from_proj(text))
    }

    /// The system that a name stands for: `EPSG:25832`, `urn:ogc:def:crs:EPSG::25832`,
    /// `urn:ogc:def:crs:OGC:1.3:CRS84`, `http://www.opengis.net/def/crs/EPSG/0/25832`, a WKT, or a horizontal and a
    /// vertical system: `EPSG:2229+6360`, `urn:ogc:def:crs,crs:EPSG::2229,crs:EPSG::6360`.
    ///
    /// CRS84 is WGS 84 with the longitude first. Coordinates are always kept in that order here, so it gives EPSG:4326.
    /// `None` if the name is none of these.
    pub fn from_name(name: &str) -> Option<Self> {
        let name = name.trim();
        if name.contains(['[', '(']) {
            return wkt::parse(name).map(|_| Self::from_wkt(name));
        }
        if let Some([plane, height]) = vertical::pair_in(name) {
            return Some(vertical::compound(Self::from_epsg(plane), height));
        }
        let parts: Vec<&str> = name.split([':', '/', '#']).filter(|p| !p.is_empty()).collect();
        let last = *parts.last()?;
        match last.to_ascii_uppercase().as_str() {
            "CRS84" | "WGS84" => return Some(Self::wgs84()),
            "CRS83" => return Some(Self::from_epsg(4269)),
            "CRS27" => return Some(Self::from_epsg(4267)),
            _ => {}
        }
        let of_epsg = parts.iter().any(|p| p.to_ascii_uppercase().starts_with("EPSG"));
        let code = last.trim_end_matches(".xml").parse().ok().filter(|&code| code > 0)?;
        of_epsg.then(|| Self::from_epsg(code))
    }

    /// The system that a user names: an EPSG code alone, a PROJ string, or anything that [`Crs::from_name`] takes.
    ///
    /// # Errors
    /// A sentence if the text is none of these, or if it is not known whether the system is projected or in degrees.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let code = text.trim().parse().ok().filter(|&code: &u32| code > 0);
        let crs = match Self::from_proj(text) {
            Some(found) => found?,
            None => {
                let crs = code.map(Self::from_epsg).or_else(|| Self::from_name(text));
                crs.ok_or("it must be an EPSG code such as EPSG:6668, a WKT or a PROJ string")?
            }
        };
        if crs.kind().is_none() && !(crs.is_local() && crs.length_unit().is_some()) {
            return Err("the built-in table does not list it as projected or in degrees; give its WKT".into());
        }
        Ok(crs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_codes() {
        for name in [
            "urn:ogc:def:crs:EPSG::25832",
            "urn:ogc:def:crs:EPSG:6.6:25832",
            "EPSG:25832",
            "epsg:25832",
            "http://www.opengis.net/def/crs/EPSG/0/25832",
            "http://www.opengis.net/gml/srs/epsg.xml#25832",
        ] {
            let crs = Crs::from_name(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(crs.epsg, Some(25832), "{name}");
            assert_eq!(crs.name().as_deref(), Some("ETRS89 / UTM zone 32N"));
            assert!(!crs.is_geographic());
        }
        for name in ["urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:OGC::CRS84", "CRS84", "EPSG:4326"] {
            let crs = Crs::from_name(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(crs.epsg, Some(4326));
            assert!(crs.is_geographic());
        }
        for name in ["", ":", "25832", "EPSG:", "EPSG:0", "EPSG:-3", "my grid", "[", "urn:ogc:def:crs:ESRI::102100"] {
            assert_eq!(Crs::from_name(name), None, "{name}");
        }
    }
}
