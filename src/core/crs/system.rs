//! A coordinate reference system: its names, its text, and the kind of its coordinates.

use std::borrow::Cow;

use super::esri;
use super::wkt::{self, Node};
use crate::base::ElevationUnit;

/// Radians per degree.
pub(super) const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// A coordinate reference system, by its EPSG code, its WKT, or both.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Crs {
    /// EPSG code, if known.
    pub epsg: Option<u32>,
    /// Well-known text (OGC WKT 1 or what the input had), if known.
    pub wkt: Option<String>,
}

/// The kind of a system's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CrsKind {
    /// Plane coordinates.
    Projected,
    /// Degrees of longitude and latitude.
    Geographic,
}

/// A unit of length of map coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct LengthUnit {
    /// The unit's name as the WKT has it, such as `metre` or `US survey foot`.
    pub name: String,
    /// Metres per unit.
    pub metres: f64,
}

impl Crs {
    /// WGS 84 in degrees (EPSG:4326).
    pub fn wgs84() -> Self {
        Self::from_epsg(4326)
    }

    /// The system of an EPSG code, with its WKT where the built-in table has it.
    pub fn from_epsg(code: u32) -> Self {
        Self { epsg: Some(code), wkt: definition(code).map(|d| d.wkt.to_owned()) }
    }

    /// The system that a WKT describes.
    ///
    /// The EPSG code is the one at the root of the WKT. A WKT without one, such as the `.prj` file of a shapefile, is
    /// compared by name and parameters with the built-in table. If no entry agrees beyond doubt, the code stays
    /// unknown. Text that is not WKT is kept unchanged for the output. A horizontal and a vertical system beside each
    /// other, as Esri's programs write them, become a compound one.
    pub fn from_wkt(text: &str) -> Self {
        let compound = compound_of_pair(text.trim());
        let text = compound.as_deref().unwrap_or(text.trim());
        let epsg = wkt::parse(text).and_then(|root| match root.unbound().authority() {
            Some((authority, code)) if authority.eq_ignore_ascii_case("EPSG") => Some(code),
            Some(_) => None,
            None => esri::epsg_of(root.unbound()),
        });
        Self { epsg, wkt: Some(text.to_owned()) }
    }

    /// The well-known text: the system's own, or the built-in table's for its EPSG code.
    pub fn wkt(&self) -> Option<&str> {
        self.wkt.as_deref().or_else(|| self.epsg.and_then(definition).map(|d| d.wkt))
    }

    /// The well-known text in version 1, for older formats: the system's own if it is version 1, otherwise the built-in
    /// table's for its EPSG code.
    pub fn wkt1(&self) -> Option<&str> {
        let is_wkt1 = |text: &str| {
            wkt::parse(text).is_some_and(|root| {
                matches!(root.keyword.as_str(), "PROJCS" | "GEOGCS" | "GEOCCS" | "COMPD_CS" | "LOCAL_CS")
            })
        };
        let own = self.wkt.as_deref().filter(|text| is_wkt1(text));
        own.or_else(|| self.epsg.and_then(definition).map(|d| d.wkt).filter(|text| is_wkt1(text)))
    }

    /// The well-known text for a file's header. It names the EPSG code where that is known. Then it has no
    /// `TOWGS84[...]`: a datum has several shifts, and with one of them in the text, programs take the system for
    /// another one than the code names.
    pub fn header_wkt(&self) -> Option<Cow<'_, str>> {
        let own = self.wkt()?;
        let Some(root) = wkt::parse(own) else { return Some(Cow::Borrowed(own)) };
        if epsg_in(root.horizontal()).is_some() {
            return Some(without_shifts(own, &root));
        }
        // Esri's texts do not name the code that was found for them.
        let entry = self.epsg.and_then(definition).and_then(|d| Some((d.wkt, wkt::parse(d.wkt)?)));
        Some(entry.map_or(Cow::Borrowed(own), |(text, root)| without_shifts(text, &root)))
    }

    /// The system's name, such as `JGD2011 / Japan Plane Rectangular CS IX`, or `EPSG:…` if only the code is known.
    pub fn name(&self) -> Option<String> {
        let from_wkt = self.root().and_then(|root| root.unbound().name().map(str::to_owned));
        from_wkt.or_else(|| self.epsg.map(|code| format!("EPSG:{code}")))
    }

    /// The horizontal part of a compound system, without a transformation bound to it; the system itself if it is
    /// neither compound nor bound.
    pub fn horizontal(&self) -> Self {
        let Some((text, root)) = self.wkt().and_then(|text| Some((text, wkt::parse(text)?))) else {
            return self.clone();
        };
        let part = root.horizontal();
        let named = epsg_in(part);
        if std::ptr::eq(part, &root) {
            return Self { epsg: named.or(self.epsg), wkt: Some(text.to_owned()) };
        }
        Self { epsg: named.or_else(|| esri::epsg_of(part)), wkt: Some(text[part.span.clone()].to_owned()) }
    }

    /// Whether the coordinates are degrees or those of a plane.
    ///
    /// For a compound system, the kind of its horizontal part. `None` if neither the WKT nor the built-in table says,
    /// and for systems that are neither, such as the grid of a building site.
    pub fn kind(&self) -> Option<CrsKind> {
        let root = self.root()?;
        let horizontal = root.horizontal();
        if horizontal.is_geographic() {
            Some(CrsKind::Geographic)
        } else {
            horizontal.is_projected().then_some(CrsKind::Projected)
        }
    }

    /// Whether the coordinates are known to be degrees of longitude and latitude; see [`Crs::kind`].
    pub fn is_geographic(&self) -> bool {
        self.kind() == Some(CrsKind::Geographic)
    }

    /// Whether the coordinates are angles in another unit than the degree, such as grads.
    pub fn is_in_other_angles(&self) -> bool {
        self.is_geographic() && self.root().is_some_and(|root| root.horizontal().angle() != DEGREE)
    }

    /// Radians per unit of the coordinates of a geographic system.
    pub fn angle_unit(&self) -> Option<f64> {
        self.root().map(|root| root.horizontal().angle()).filter(|_| self.is_geographic())
    }

    /// Whether the first axis of a projected system's definition points east; otherwise the northing comes first. `None` if
    /// there is no definition. The built-in table lists axes only where the easting comes first.
    pub fn is_east_first(&self) -> Option<bool> {
        let text = self.horizontal().wkt?;
        let root = wkt::parse(&text)?;
        let axis = root.child(&["AXIS"]);
        Some(axis.is_some_and(|axis| text[axis.span.clone()].to_ascii_uppercase().contains(",EAST")))
    }

    /// The unit of length of the coordinates; `None` for degrees or if the WKT does not say.
    pub fn length_unit(&self) -> Option<LengthUnit> {
        let root = self.root()?;
        let (name, metres) = root.horizontal().length_unit()?;
        Some(LengthUnit { name: name.to_owned(), metres })
    }

    /// The unit of heights, by the vertical part of a compound system. `None` if there is none or it does not say.
    pub fn height_unit(&self) -> Option<LengthUnit> {
        let root = self.root()?;
        let (name, metres) = root.vertical()?.length_unit()?;
        Some(LengthUnit { name: name.to_owned(), metres })
    }

    /// The system for heights in `unit`: if its vertical part has another unit, the horizontal part alone.
    pub fn with_heights_in(&self, unit: ElevationUnit) -> Self {
        match self.height_unit() {
            Some(own) if ElevationUnit::of_size(own.metres) != Some(unit) => self.horizontal(),
            _ => self.clone(),
        }
    }

    /// The geographic system on which a projected system is based, with degrees for coordinates; a geographic system
    /// itself. `None` if the WKT does not say.
    pub fn geographic(&self) -> Option<Self> {
        let own = self.horizontal();
        if own.is_geographic() {
            return Some(own);
        }
        // The table's text comes first, because texts of other programs leave the code out.
        let text = own.epsg.and_then(definition).map(|d| d.wkt).or_else(|| own.wkt())?;
        let root = wkt::parse(text)?;
        let base = root.horizontal().child(&["GEOGCS", "BASEGEOGCRS", "BASEGEODCRS"])?;
        if let Some(code) = epsg_in(base) {
            return Some(Self::from_epsg(code));
        }
        let text = &text[base.span.clone()];
        // The base of a projected system has a keyword of its own in WKT 2 and no axes, but is a system like any other.
        Some(match text.split_once('[') {
            Some((keyword, rest)) if keyword.starts_with("BASE") => Self::from_wkt(&format!("GEOGCRS[{rest}")),
            _ => Self::from_wkt(text),
        })
    }

    /// Whether both are the same system: by EPSG code if both have one, otherwise by their WKT.
    pub fn matches(&self, other: &Self) -> bool {
        match (self.epsg, other.epsg) {
            (Some(a), Some(b)) => a == b,
            _ => self.wkt() == other.wkt(),
        }
    }

    pub(super) fn root(&self) -> Option<Node> {
        self.wkt().and_then(wkt::parse)
    }
}

/// The text of a compound system for a horizontal and a vertical one beside each other.
fn compound_of_pair(text: &str) -> Option<String> {
    let (horizontal, vertical, rest) = wkt::parse_pair(text).filter(|(_, vertical, _)| vertical.keyword == "VERTCS")?;
    let quoted = |node: &Node| node.name().unwrap_or_default().replace('"', "\"\"");
    let first = &text[horizontal.span.clone()];
    Some(format!("COMPD_CS[\"{} + {}\",{first},{rest}]", quoted(&horizontal), quoted(&vertical)))
}

/// The EPSG code that a system names for itself.
fn epsg_in(node: &Node) -> Option<u32> {
    node.authority().filter(|(authority, _)| authority.eq_ignore_ascii_case("EPSG")).map(|(_, code)| code)
}

/// The text without the datum shifts in it.
fn without_shifts<'a>(text: &'a str, root: &Node) -> Cow<'a, str> {
    let mut rest = 0;
    let mut kept = String::new();
    for shift in root.all().into_iter().filter(|n| n.keyword == "TOWGS84") {
        kept.push_str(text[rest..shift.span.start].trim_end().trim_end_matches(','));
        rest = shift.span.end;
    }
    if kept.is_empty() {
        return Cow::Borrowed(text);
    }
    kept.push_str(&text[rest..]);
    Cow::Owned(kept)
}

/// The built-in table's entry of an EPSG code. A few entries have no text and cannot be used.
pub(super) fn definition(code: u32) -> Option<crs_definitions::Def> {
    crs_definitions::from_code(u16::try_from(code).ok()?).filter(|entry| !entry.wkt.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_is_the_roots_own() {
        let wkt = Crs::from_epsg(6677).wkt.expect("the table has zone 9");
        assert_eq!(Crs::from_wkt(&wkt).epsg, Some(6677));
        let wkt2 = r#"PROJCRS["x",BASEGEOGCRS["WGS 84",ID["EPSG",4326]],CS[Cartesian,2],AXIS["e",east],
            LENGTHUNIT["metre",1,ID["EPSG",9001]],ID["EPSG",32633]]"#;
        assert_eq!(Crs::from_wkt(wkt2).epsg, Some(32633));
        let without = r#"PROJCS["nowhere",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]],UNIT["metre",1]]"#;
        assert_eq!(Crs::from_wkt(without).epsg, None);
        let other = r#"PROJCS["x",GEOGCS["WGS 84"],UNIT["metre",1],AUTHORITY["ESRI","102100"]]"#;
        assert_eq!(Crs::from_wkt(other).epsg, None);
    }

    #[test]
    fn compound_systems_are_judged_by_the_horizontal_part() {
        assert!(!Crs::from_epsg(5972).is_geographic());
        assert!(Crs::from_epsg(7423).is_geographic());
        assert_eq!(Crs::from_epsg(5972).length_unit().map(|u| u.metres), Some(1.0));
        assert!(!Crs::from_epsg(4978).is_geographic(), "earth-centred coordinates are metres");
        let bound = r#"BOUNDCRS[SOURCECRS[GEOGCRS["a",CS[ellipsoidal,2]]],TARGETCRS[PROJCRS["b"]]]"#;
        assert!(Crs::from_wkt(bound).is_geographic());
        let cartesian = r#"GEODCRS["WGS 84",CS[Cartesian,3],LENGTHUNIT["metre",1]]"#;
        assert!(!Crs::from_wkt(cartesian).is_geographic());
    }

    #[test]
    fn units_of_length() {
        assert_eq!(Crs::from_epsg(25832).length_unit(), Some(LengthUnit { name: "metre".into(), metres: 1.0 }));
        let feet = Crs::from_epsg(2229).length_unit().expect("California zone 5 is in feet");
        assert!((feet.metres - 0.304_800_6).abs() < 1e-6, "{feet:?}");
        assert_eq!(Crs::wgs84().length_unit(), None);
        let on_axis = r#"PROJCRS["x",CS[Cartesian,2],AXIS["e",east,LENGTHUNIT["foot",0.3048]]]"#;
        assert_eq!(Crs::from_wkt(on_axis).length_unit().map(|u| u.metres), Some(0.3048));
    }

    #[test]
    fn the_same_system_by_code_or_by_text() {
        assert!(Crs { epsg: Some(6677), wkt: None }.matches(&Crs::from_epsg(6677)));
        assert!(!Crs::from_epsg(6678).matches(&Crs::from_epsg(6677)));
        assert!(Crs::from_wkt("a").matches(&Crs::from_wkt(" a ")));
        assert!(!Crs::from_wkt("a").matches(&Crs::from_epsg(6677)));
    }

    #[test]
    fn version_1_is_taken_from_the_table_where_the_text_is_version_2() {
        let crs = Crs { epsg: Some(6677), wkt: Some(r#"PROJCRS["x",ID["EPSG",6677]]"#.into()) };
        assert!(crs.wkt1().is_some_and(|text| text.starts_with("PROJCS[")));
        assert_eq!(Crs::from_wkt(r#"PROJCRS["x"]"#).wkt1(), None);
    }

    #[test]
    fn a_projected_system_is_told_from_the_geographic_one_inside_it() {
        let utm = Crs::from_epsg(6690);
        assert_eq!(utm.kind(), Some(CrsKind::Projected));
        assert_eq!(utm.horizontal(), utm);
        assert_eq!(utm.name().as_deref(), Some("JGD2011 / UTM zone 53N"));
        assert_eq!(utm.length_unit(), Some(LengthUnit { name: "metre".into(), metres: 1.0 }));
        let degrees = Crs::from_wkt(Crs::from_epsg(4326).wkt().expect("the table has WGS 84"));
        assert_eq!(degrees.kind(), Some(CrsKind::Geographic));
        assert_eq!(degrees.epsg, Some(4326));
        assert_eq!(degrees.length_unit(), None);
        assert_eq!(Crs::from_wkt("LOCAL_CS[\"site\",UNIT[\"metre\",1]]").kind(), None);
    }

    #[test]
    fn a_compound_system_gives_its_horizontal_part() {
        let utm = Crs::from_epsg(6690).wkt.expect("the table has zone 53");
        let vertical = "VERT_CS[\"height\",UNIT[\"metre\",1]]";
        let compound = Crs::from_wkt(&format!("COMPD_CS[\"both [1]\",{utm},{vertical},AUTHORITY[\"EPSG\",\"99999\"]]"));
        assert_eq!(compound.horizontal(), Crs { epsg: Some(6690), wkt: Some(utm.clone()) });
        assert_eq!(compound.header_wkt().as_deref(), compound.wkt.as_deref());
        let end = utm.rfind(",AUTHORITY").expect("a code");
        let uncoded = Crs::from_wkt(&format!("COMPD_CS[\"both\",{}],{vertical}]", &utm[..end]));
        assert_eq!((uncoded.epsg, uncoded.horizontal().epsg), (None, Some(6690)));
    }

    /// California zone 5 in US survey feet, with heights in a unit.
    fn with_heights(vertical: &str) -> Crs {
        let plane = Crs::from_epsg(2229).wkt.expect("the table has California zone 5");
        Crs::from_wkt(&format!("COMPD_CS[\"both\",{plane},{vertical}]"))
    }

    #[test]
    fn the_unit_of_heights_is_that_of_the_vertical_part() {
        let metres = |crs: &Crs| crs.height_unit().map(|unit| unit.metres);
        // NAD83 / Arizona East (ft) + NAVD88 height (ft), NAD27 + NGVD29 height (ftUS), UTM zone 32N + NN2000 height.
        assert_eq!(metres(&Crs::from_epsg(8700)), Some(0.3048));
        assert_eq!(metres(&Crs::from_epsg(7406)), Some(0.304_800_609_601_219_2));
        assert_eq!(metres(&Crs::from_epsg(5972)), Some(1.0));
        for vertical in [
            "VERT_CS[\"NAVD88 height (ftUS)\",VERT_DATUM[\"d\",2005],UNIT[\"US survey foot\",0.304800609601219]]",
            "VERTCRS[\"h\",VDATUM[\"d\"],CS[vertical,1],AXIS[\"up\",up,LENGTHUNIT[\"US survey foot\",0.304800609601219]]]",
            "BOUNDCRS[SOURCECRS[VERTCRS[\"h\",LENGTHUNIT[\"US survey foot\",0.304800609601219]]],TARGETCRS[GEOGCRS[\"g\"]]]",
        ] {
            assert_eq!(metres(&with_heights(vertical)), Some(0.304_800_609_601_219), "{vertical}");
        }
        for crs in [Crs::from_epsg(2229), Crs::wgs84(), with_heights("VERT_CS[\"h\"]"), Crs::from_wkt("VERT_CS[\"h\"]")]
        {
            assert_eq!(crs.height_unit(), None, "{crs:?}");
        }
    }

    #[test]
    fn heights_in_another_unit_have_no_vertical_part() {
        let feet = with_heights("VERT_CS[\"h\",UNIT[\"US survey foot\",0.304800609601219]]");
        assert_eq!(feet.with_heights_in(ElevationUnit::UsSurveyFoot), feet);
        assert_eq!(feet.with_heights_in(ElevationUnit::Foot).epsg, Some(2229));
        assert_eq!(feet.with_heights_in(ElevationUnit::Metre).wkt, Crs::from_epsg(2229).wkt);
        let metres = Crs::from_epsg(5972);
        assert_eq!(metres.with_heights_in(ElevationUnit::Metre), metres);
        assert_eq!(metres.with_heights_in(ElevationUnit::Foot).epsg, Some(25832));
        let plain = Crs::from_epsg(2229);
        assert_eq!(plain.with_heights_in(ElevationUnit::Metre), plain);
    }

    #[test]
    fn esris_pair_of_systems_is_a_compound_one() {
        let plane = "PROJCS[\"NAD_1983_StatePlane_California_V_FIPS_0405_Feet\",GEOGCS[\"g\"],UNIT[\"Foot_US\",0.3048006096012192]]";
        let height = "VERTCS[\"NAVD_1988_Foot_US\",VDATUM[\"d\"],PARAMETER[\"Direction\",1.0],UNIT[\"Foot_US\",0.3048006096012192]]";
        let crs = Crs::from_wkt(&format!("{plane} , {height}\r\n"));
        assert_eq!(crs.kind(), Some(CrsKind::Projected));
        assert_eq!(crs.height_unit().map(|unit| unit.metres), Some(0.304_800_609_601_219_2));
        assert_eq!(crs.horizontal().wkt.as_deref(), Some(plane));
        for text in [format!("{plane},"), format!("{plane},{plane}"), format!("{plane} {height}"), format!("{plane},x")]
        {
            assert_eq!(Crs::from_wkt(&text), Crs { epsg: None, wkt: Some(text) });
        }
    }

    #[test]
    fn wkt_2_is_read_as_well() {
        let text = "PROJCRS[\"plan\",BASEGEOGCRS[\"base\",ID[\"EPSG\",4326]],CONVERSION[\"c\"],CS[Cartesian,2],\
                    AXIS[\"e\",east,LENGTHUNIT[\"US survey foot\",0.304800609601219]],ID[\"EPSG\",2225]]";
        let crs = Crs::from_wkt(text);
        assert_eq!((crs.epsg, crs.kind()), (Some(2225), Some(CrsKind::Projected)));
        assert_eq!(crs.name().as_deref(), Some("plan"));
        let unit = LengthUnit { name: "US survey foot".into(), metres: 0.304800609601219 };
        assert_eq!(crs.length_unit(), Some(unit));
    }

    #[test]
    fn headers_name_the_code_and_then_no_shift() {
        let text = "PROJCS[\"p\",GEOGCS[\"g\",DATUM[\"d\", TOWGS84[1,2,3] ]],AUTHORITY[\"EPSG\",\"31287\"]]";
        let expected = "PROJCS[\"p\",GEOGCS[\"g\",DATUM[\"d\" ]],AUTHORITY[\"EPSG\",\"31287\"]]";
        assert_eq!(Crs::from_wkt(text).header_wkt().as_deref(), Some(expected));
        let own = "PROJCS[\"p\",GEOGCS[\"g\",DATUM[\"d\",TOWGS84[1,2,3]]]]";
        assert_eq!(Crs::from_wkt(own).header_wkt().as_deref(), Some(own));
        let esri = Crs { epsg: Some(6677), wkt: Some("PROJCS[\"JGD_2011_Japan_Zone_9\"]".into()) };
        assert!(esri.header_wkt().is_some_and(|text| text.ends_with("AUTHORITY[\"EPSG\",\"6677\"]]")));
        assert_eq!(Crs { epsg: Some(6677), wkt: Some("no text".into()) }.header_wkt().as_deref(), Some("no text"));
        assert_eq!(Crs { epsg: None, wkt: None }.header_wkt(), None);
        for code in 1024..=u16::MAX {
            let header = Crs::from_epsg(code.into()).header_wkt().map(Cow::into_owned);
            assert!(header.is_none_or(|text| wkt::parse(&text).is_some() && !text.contains("TOWGS84")), "{code}");
        }
    }

    #[test]
    fn nonsense_names_nothing() {
        for text in
            ["", "]", "[[[", "PROJCS", "PROJCS[", "PROJCS[\"", "ENGCRS[\"site\"]", "PROJCS[\"é[\",ID[EPSG", "é[é]"]
        {
            let crs = Crs::from_wkt(text);
            assert_eq!((crs.epsg, crs.kind(), crs.length_unit()), (None, None, None), "{text}");
            assert_eq!(crs.horizontal(), crs, "{text}");
        }
    }

    #[test]
    fn every_table_entry_finds_itself() {
        let (mut seen, mut others) = (0, Vec::new());
        for code in 1024..=u16::MAX {
            let Some(entry) = definition(u32::from(code)) else { continue };
            seen += 1;
            let crs = Crs::from_wkt(entry.wkt);
            assert!(crs.name().is_some(), "{code}");
            if crs.epsg != Some(u32::from(code)) {
                others.push(crs);
            }
        }
        assert!(seen > 5000);
        // Some withdrawn three-dimensional systems carry the text of their successors.
        assert!(others.len() < 40 && others.iter().all(Crs::is_geographic), "{others:?}");
    }
}
