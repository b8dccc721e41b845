//! The coordinate reference system in a GeoTIFF: the GeoKey directory, written and read.
//!
//! An EPSG code is one key. A system that only has well-known text is written as a citation that starts with `ESRI PE
//! String = `, together with the model type "user-defined". GDAL and QGIS look for the text in this form. Systems that other
//! programs describe by keys for the projection and its parameters are read ([`user_defined`]), and written as such a text.

mod user_defined;

use tokosen_core::base::ElevationUnit;
use tokosen_core::crs::{Crs, CrsKind, epsg_name, vertical_unit};

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const CITATION: u16 = 1026;
const GEOGRAPHIC_TYPE: u16 = 2048;
const GEOGRAPHIC_CITATION: u16 = 2049;
const PROJECTED_TYPE: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;

const VERTICAL_TYPE: u16 = 4096;
const VERTICAL_UNIT: u16 = 4099;

const MODEL_PROJECTED: u16 = 1;
const MODEL_GEOGRAPHIC: u16 = 2;
const RASTER_PIXEL_IS_AREA: u16 = 1;
const RASTER_PIXEL_IS_POINT: u16 = 2;
const USER_DEFINED: u16 = 32767;

/// The placement refers to the corners of cells.
const AREA: [u16; 4] = [RASTER_TYPE, 0, 1, RASTER_PIXEL_IS_AREA];

/// The tag that holds a key's numbers.
const DOUBLE_PARAMS: u16 = 34736;
/// The tag that holds a key's text.
const ASCII_PARAMS: u16 = 34737;
const PE_STRING: &str = "ESRI PE String = ";

/// A GeoKey directory, and the texts and numbers it points into.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct GeoKeys {
    /// The header and four numbers per key.
    pub directory: Vec<u16>,
    /// The texts, each ended by a bar.
    pub ascii: String,
    /// The numbers. None are written.
    pub doubles: Vec<f64>,
}

impl GeoKeys {
    /// The keys of a system. `None` if it has neither a code nor a text.
    pub fn of(crs: &Crs) -> Option<Self> {
        // A compound system has no key: the key holds the code of its horizontal part.
        let crs = crs.horizontal();
        let mut keys = Self::default();
        match crs.epsg.and_then(|code| u16::try_from(code).ok()) {
            Some(code) => match crs.kind().unwrap_or_else(|| guess_kind(code)) {
                CrsKind::Projected => {
                    keys.push(&[[MODEL_TYPE, 0, 1, MODEL_PROJECTED], AREA, [PROJECTED_TYPE, 0, 1, code]])
                }
                CrsKind::Geographic => {
                    keys.push(&[[MODEL_TYPE, 0, 1, MODEL_GEOGRAPHIC], AREA, [GEOGRAPHIC_TYPE, 0, 1, code]])
                }
            },
            None => {
                let text = crs.header_wkt()?;
                // The texts are ASCII, and a bar ends each.
                let plain = text.chars().map(|c| match c {
                    '|' => '/',
                    ' '..='~' => c,
                    _ if c.is_whitespace() => ' ',
                    _ => '?',
                });
                keys.ascii = PE_STRING.chars().chain(plain).chain(['|']).collect();
                let length = u16::try_from(keys.ascii.len()).ok()?;
                keys.push(&[[MODEL_TYPE, 0, 1, USER_DEFINED], AREA, [PROJECTED_CITATION, ASCII_PARAMS, length, 0]]);
            }
        }
        Some(keys)
    }

    /// Fills the directory: the version, the number of keys, and the keys.
    fn push(&mut self, keys: &[[u16; 4]]) {
        self.directory = vec![1, 1, 0, keys.len() as u16];
        self.directory.extend(keys.iter().flatten());
    }

    /// The value of a key that is a number.
    fn number(&self, key: u16) -> Option<u16> {
        self.entries().find(|e| e[0] == key && e[1] == 0).map(|e| e[3])
    }

    /// The value of a key that is a text.
    fn text(&self, key: u16) -> Option<&str> {
        let [_, _, count, start] = *self.entries().find(|e| e[0] == key && e[1] == ASCII_PARAMS)?;
        let (start, count) = (usize::from(start), usize::from(count));
        self.ascii.get(start..start + count).map(|text| text.trim_end_matches(['|', '\0', ' ']))
    }

    /// The numbers of a key.
    fn doubles(&self, key: u16) -> Option<&[f64]> {
        let [_, _, count, start] = *self.entries().find(|e| e[0] == key && e[1] == DOUBLE_PARAMS)?;
        let (start, count) = (usize::from(start), usize::from(count));
        self.doubles.get(start..start + count)
    }

    fn entries(&self) -> impl Iterator<Item = &[u16; 4]> {
        self.directory.as_chunks().0.iter().skip(1)
    }

    /// Whether the placement refers to the centres of cells instead of their corners.
    pub fn pixel_is_point(&self) -> bool {
        self.number(RASTER_TYPE) == Some(RASTER_PIXEL_IS_POINT)
    }

    /// The name of the unit of heights: of the key for it, otherwise of the vertical system.
    pub fn vertical_unit(&self) -> Option<&'static str> {
        let unit = match self.number(VERTICAL_UNIT) {
            Some(9001) => ElevationUnit::Metre,
            Some(9002) => ElevationUnit::Foot,
            Some(9003) => ElevationUnit::UsSurveyFoot,
            _ => vertical_unit(self.number(VERTICAL_TYPE)?.into())?,
        };
        Some(epsg_name(unit))
    }

    /// The system that the keys name, if they name one by code or by text.
    pub fn crs(&self) -> Option<Crs> {
        let keys = match self.number(MODEL_TYPE) {
            Some(MODEL_GEOGRAPHIC) => [GEOGRAPHIC_TYPE, GEOGRAPHIC_TYPE],
            Some(MODEL_PROJECTED) => [PROJECTED_TYPE, PROJECTED_TYPE],
            _ => [PROJECTED_TYPE, GEOGRAPHIC_TYPE],
        };
        let code = keys.iter().filter_map(|&key| self.number(key)).find(|&code| code > 0);
        if let Some(code) = code.filter(|&code| code != USER_DEFINED) {
            return Some(Crs::from_epsg(code.into()));
        }
        let citations = [PROJECTED_CITATION, GEOGRAPHIC_CITATION, CITATION];
        let text = citations.iter().filter_map(|&key| self.text(key)).find_map(|text| text.strip_prefix(PE_STRING))?;
        Some(Crs::from_wkt(text))
    }
}

/// Projected or geographic, by the code alone: EPSG keeps most geographic systems between 4000 and 4999.
fn guess_kind(code: u16) -> CrsKind {
    if (4000..5000).contains(&code) { CrsKind::Geographic } else { CrsKind::Projected }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_go_into_the_key_of_their_kind_and_come_back() {
        for (code, model, key) in [(6690, 1, 3072), (4326, 2, 2048), (6668, 2, 2048), (32654, 1, 3072)] {
            let keys = GeoKeys::of(&Crs { epsg: Some(code), wkt: None }).unwrap();
            assert_eq!(keys.directory, [1, 1, 0, 3, 1024, 0, 1, model, 1025, 0, 1, 1, key, 0, 1, code as u16]);
            let back = keys.crs().unwrap();
            assert_eq!(back.epsg, Some(code));
            assert_eq!(back.wkt, Crs::from_epsg(code).wkt);
        }
    }

    #[test]
    fn a_system_without_a_code_travels_as_text() {
        let text = "PROJCS[\"Site | 敷地\",GEOGCS[\"g\"],UNIT[\"metre\",1]]";
        let keys = GeoKeys::of(&Crs { epsg: None, wkt: Some(text.into()) }).unwrap();
        assert!(keys.ascii.is_ascii() && keys.ascii.ends_with('|'));
        let back = keys.crs().unwrap();
        assert_eq!(back.wkt.unwrap(), "PROJCS[\"Site / ??\",GEOGCS[\"g\"],UNIT[\"metre\",1]]");
        assert_eq!(back.epsg, None);
        assert_eq!(GeoKeys::of(&Crs { epsg: None, wkt: None }), None);
    }

    #[test]
    fn the_unit_of_heights_is_that_of_its_key_or_of_the_vertical_system() {
        let unit = |keys: &[[u16; 4]]| {
            let mut found = GeoKeys::default();
            found.push(keys);
            found.vertical_unit()
        };
        assert_eq!(unit(&[[VERTICAL_UNIT, 0, 1, 9003]]), Some("US survey foot"));
        assert_eq!(unit(&[[VERTICAL_TYPE, 0, 1, 6360]]), Some("US survey foot"));
        assert_eq!(unit(&[[VERTICAL_TYPE, 0, 1, 8228]]), Some("foot"));
        assert_eq!(unit(&[[VERTICAL_TYPE, 0, 1, 6360], [VERTICAL_UNIT, 0, 1, 9001]]), Some("metre"));
        assert_eq!(unit(&[[VERTICAL_TYPE, 0, 1, 5103]]), None);
        assert_eq!(unit(&[]), None);
    }

    #[test]
    fn broken_directories_name_no_system() {
        for directory in [vec![], vec![1, 1, 0], vec![1, 1, 0, 9, 3072, 0, 1], vec![1, 1, 0, 1, 3073, 34737, 900, 900]]
        {
            let keys = GeoKeys { directory, ascii: "ESRI PE String".into(), doubles: vec![1.0] };
            assert_eq!((keys.crs(), keys.described()), (None, None));
            assert!(!keys.pixel_is_point());
        }
    }
}
