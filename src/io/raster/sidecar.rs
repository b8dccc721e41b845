//! Reads the files that describe a raster: world file, `.aux.xml`, `.prj`.

use std::path::Path;

use glam::DVec2;
use quick_xml::Reader;
use quick_xml::escape::unescape;
use quick_xml::events::Event;

use super::output::beside;
use super::pam::ENCODING;
use super::placement::{Placement, north_up};
use crate::ordinary::{MAX_DESCRIPTION, read_small};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// Reads six numbers that are separated by anything except letters and digits.
pub(super) fn six_numbers(text: &str) -> Option<[f64; 6]> {
    let words = text.split([',', ' ', '\t', '\r', '\n']).filter(|word| !word.is_empty());
    let numbers: Vec<f64> = words.map(str::parse).collect::<std::result::Result<_, _>>().ok()?;
    numbers.try_into().ok()
}

/// The content of an `.aux.xml` about the first band.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Aux {
    pub crs: Option<Crs>,
    pub transform: Option<[f64; 6]>,
    pub nodata: Option<f64>,
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    pub unit: Option<String>,
    /// How heights are stored as colours.
    pub encoding: Option<String>,
}

/// The content of a small text file, if it exists.
pub(super) fn read_text(path: &Path) -> Result<Option<String>> {
    if std::fs::metadata(path).is_err_and(|e| e.kind() == std::io::ErrorKind::NotFound) {
        return Ok(None);
    }
    let bytes = read_small(path, MAX_DESCRIPTION, "a file that describes a raster")?;
    Ok(Some(String::from_utf8_lossy(&bytes).trim_start_matches('\u{feff}').to_owned()))
}

/// Reads `path` + `.aux.xml`, if it exists.
///
/// # Errors
/// The file cannot be read or is not XML.
pub(super) fn read_aux_xml(path: &Path) -> Result<Option<Aux>> {
    let path = &beside(path, ".aux.xml");
    let Some(text) = read_text(path)? else { return Ok(None) };
    let elements = elements(&text).map_err(|e| Error::file_cause(path, "is not the XML that it should be", e))?;
    let (mut aux, mut band) = (Aux::default(), Aux::default());
    for element in elements {
        let text = element.text.trim();
        let number = || text.parse::<f64>().ok();
        match (element.parent.as_str(), element.name.as_str()) {
            ("PAMDataset", "SRS") => aux.crs = by_text(text),
            ("PAMDataset", "GeoTransform") => aux.transform = six_numbers(text),
            ("Metadata", "MDI") if element.attribute("key") == Some(ENCODING) => aux.encoding = Some(text.to_owned()),
            ("PAMRasterBand", "NoDataValue") => band.nodata = number(),
            ("PAMRasterBand", "Scale") => band.scale = number(),
            ("PAMRasterBand", "Offset") => band.offset = number(),
            ("PAMRasterBand", "UnitType") => band.unit = Some(text.to_owned()),
            // The end tag of a band comes after all of its content.
            ("PAMDataset", "PAMRasterBand") => {
                let Aux { nodata, scale, offset, unit, .. } = std::mem::take(&mut band);
                if element.attribute("band").is_none_or(|number| number == "1") {
                    aux = Aux { nodata, scale, offset, unit, ..aux };
                }
            }
            _ => {}
        }
    }
    Ok(Some(aux))
}

/// The system in a text of a sidecar file: well-known text or `EPSG:…`.
fn by_text(text: &str) -> Option<Crs> {
    if text.contains(['[', '(']) { Some(Crs::from_wkt(text)) } else { Crs::from_name(text) }
}

/// Reads the `.prj` beside a raster, if it exists and is well-known text.
///
/// # Errors
/// The file exists and cannot be read.
pub(super) fn read_prj(path: &Path) -> Result<Option<Crs>> {
    Ok(read_text(&path.with_extension("prj"))?.and_then(|text| by_text(text.trim())))
}

/// Reads the world file beside a raster: the first of these extensions that exists.
///
/// # Errors
/// The file cannot be read, does not hold six numbers, or describes a rotated raster.
pub(super) fn read_world(path: &Path, extensions: &[&str], size: (usize, usize)) -> Result<Option<Placement>> {
    for extension in extensions {
        let path = path.with_extension(extension);
        let Some(text) = read_text(&path)? else { continue };
        let [a, d, b, e, x, y] = six_numbers(&text)
            .ok_or_else(|| Error::file(&path, "is not a world file, which holds six numbers, one per line"))?;
        // A world file gives the centre of the first cell.
        let (across, down) = (DVec2::new(a, d), DVec2::new(b, e));
        let origin = DVec2::new(x, y) - 0.5 * (across + down);
        return north_up(origin, across, down, size).map(Some).map_err(|message| Error::file(&path, message));
    }
    Ok(None)
}

/// An element of an XML text with its direct text.
#[derive(Debug, Default)]
pub(super) struct Element {
    pub name: String,
    /// The name of the parent element; empty for the root.
    pub parent: String,
    pub attributes: Vec<(String, String)>,
    pub text: String,
}

impl Element {
    /// The value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }
}

/// The elements of an XML text in the order in which they end.
pub(super) fn elements(xml: &str) -> std::result::Result<Vec<Element>, quick_xml::Error> {
    let mut reader = Reader::from_str(xml);
    let (mut open, mut done): (Vec<Element>, Vec<Element>) = (Vec::new(), Vec::new());
    loop {
        match reader.read_event()? {
            event @ (Event::Start(_) | Event::Empty(_)) => {
                let is_empty = matches!(event, Event::Empty(_));
                let (Event::Start(start) | Event::Empty(start)) = event else { continue };
                let attributes = start
                    .attributes()
                    .flatten()
                    .map(|a| {
                        let value = String::from_utf8_lossy(&a.value);
                        let value = unescape(&value).map_or_else(|_| value.to_string(), |v| v.into_owned());
                        (String::from_utf8_lossy(a.key.as_ref()).into_owned(), value)
                    })
                    .collect();
                let name = String::from_utf8_lossy(start.name().as_ref()).into_owned();
                let parent = open.last().map(|element| element.name.clone()).unwrap_or_default();
                let element = Element { name, parent, attributes, text: String::new() };
                if is_empty { done.push(element) } else { open.push(element) }
            }
            Event::Text(text) => {
                if let Some(element) = open.last_mut() {
                    element.text.push_str(&String::from_utf8_lossy(&text));
                }
            }
            Event::CData(text) => {
                if let Some(element) = open.last_mut() {
                    element.text.push_str(&String::from_utf8_lossy(&text).replace('&', "&amp;"));
                }
            }
            Event::GeneralRef(name) => {
                if let Some(element) = open.last_mut() {
                    element.text.push_str(&format!("&{};", String::from_utf8_lossy(&name)));
                }
            }
            Event::End(_) => {
                if let Some(mut element) = open.pop() {
                    if let Ok(text) = unescape(&element.text) {
                        element.text = text.into_owned();
                    }
                    done.push(element);
                }
            }
            Event::Eof => return Ok(done),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use tokosen_core::base::Grid;

    use super::*;

    #[test]
    fn the_first_band_is_told_from_the_others() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.tif");
        let text = "<PAMDataset><SRS dataAxisToSRSAxisMapping=\"1,2\">LOCAL_CS[&quot;a &amp; b&quot;]</SRS>\
                    <GeoTransform> 1e2, 2,0, 30 ,0,-2</GeoTransform>\
                    <PAMRasterBand band=\"2\"><NoDataValue>7</NoDataValue><Scale>9</Scale></PAMRasterBand>\
                    <PAMRasterBand band=\"1\"><NoDataValue>-1</NoDataValue><UnitType>ft</UnitType></PAMRasterBand>\
                    <PAMRasterBand band=\"3\"><Offset>5</Offset></PAMRasterBand></PAMDataset>";
        std::fs::write(dir.path().join("a.tif.aux.xml"), text).unwrap();
        let expected = Aux {
            crs: Some(Crs::from_wkt("LOCAL_CS[\"a & b\"]")),
            transform: Some([100.0, 2.0, 0.0, 30.0, 0.0, -2.0]),
            nodata: Some(-1.0),
            scale: None,
            offset: None,
            unit: Some("ft".into()),
            encoding: None,
        };
        assert_eq!(read_aux_xml(&path).unwrap(), Some(expected));
        assert_eq!(read_aux_xml(&dir.path().join("b.tif")).unwrap(), None);
    }

    #[test]
    fn a_world_file_names_the_centre_of_the_first_cell() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.tif");
        let read = |text: &str| {
            std::fs::write(dir.path().join("a.tfw"), text).unwrap();
            read_world(&path, &["pgw", "tfw"], (4, 3))
        };
        let grid = Grid { corner: DVec2::new(100.0, 60.0), cell: DVec2::new(2.0, 5.0), cols: 4, rows: 3 };
        assert_eq!(read("2\n0\n0\n-5\n101\n57.5\n").unwrap(), Some(Placement { grid, south_up: false }));
        assert_eq!(read("2\r\n0\r\n0\r\n5\r\n101\r\n47.5").unwrap(), Some(Placement { grid, south_up: true }));
        for (text, words) in
            [("2 0 0 -5 101", "six numbers"), ("2 1 1 -5 0 0", "rotated"), ("-2 0 0 -5 0 0", "east to west")]
        {
            assert!(read(text).unwrap_err().to_string().contains(words), "{text}");
        }
        assert_eq!(read_world(&path, &["pgw"], (4, 3)).unwrap(), None);
    }
}
