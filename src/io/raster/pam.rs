//! The sidecar files of pictures that GDAL and QGIS read: `.aux.xml` and the world file.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::Path;

use quick_xml::escape::escape;

use super::output::{beside, geo_transform, write_text};
use tokosen_core::base::error::Result;
use tokosen_core::raster::Dem;

/// The key of the text that names the encoding of heights as colours.
pub(super) const ENCODING: &str = "ElevationEncoding";

/// How stored values become heights, and which stored value means no data.
#[derive(Clone, Copy)]
pub(super) struct Band {
    /// What the values are.
    pub name: &'static str,
    /// Their unit: the name that programs use, and words.
    pub unit: Option<(&'static str, &'static str)>,
    /// Height of the stored value 0, metres; likewise for other quantities.
    pub offset: f64,
    /// Metres per step.
    pub scale: f64,
    /// The stored value that means no data, as text.
    pub nodata: Option<&'static str>,
}

/// Writes `path` + `.aux.xml`: coordinate reference system, placement, and how to read the values.
///
/// # Errors
/// The operating system reports an error.
pub(super) fn write_aux_xml(path: &Path, dem: &Dem, bands: &[Band]) -> Result<()> {
    let mut xml = placement(dem, &[]);
    for (k, band) in bands.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = writeln!(xml, "  <PAMRasterBand band=\"{}\">\n    <Description>{}</Description>", k + 1, band.name);
        if let Some(nodata) = band.nodata {
            let _ = writeln!(xml, "    <NoDataValue>{nodata}</NoDataValue>");
        }
        if let Some((unit, _)) = band.unit {
            let _ = writeln!(xml, "    <UnitType>{unit}</UnitType>");
        }
        let _ = writeln!(xml, "    <Offset>{}</Offset>\n    <Scale>{}</Scale>", band.offset, band.scale);
        xml.push_str("  </PAMRasterBand>\n");
    }
    xml.push_str("</PAMDataset>\n");
    write_text(&beside(path, ".aux.xml"), &xml)
}

/// Writes `path` + `.aux.xml` with the coordinate reference system, the placement, and further statements: a key and a
/// text each, which need no escape.
///
/// # Errors
/// The operating system reports an error.
pub(super) fn write_aux_placement(path: &Path, dem: &Dem, statements: &[(&str, &str)]) -> Result<()> {
    write_text(&beside(path, ".aux.xml"), &(placement(dem, statements) + "</PAMDataset>\n"))
}

/// The beginning of an `.aux.xml`, which gives the raster's placement.
fn placement(dem: &Dem, statements: &[(&str, &str)]) -> String {
    let mut xml = String::from("<PAMDataset>\n");
    let name = dem
        .crs
        .as_ref()
        .and_then(|crs| crs.header_wkt().map(Cow::into_owned).or_else(|| crs.epsg.map(|code| format!("EPSG:{code}"))));
    // Writing to a String cannot fail.
    if let Some(name) = name {
        let _ = writeln!(xml, "  <SRS>{}</SRS>", escape(&name));
    }
    let transform = geo_transform(&dem.grid).map(|v| v.to_string()).join(", ");
    let _ = writeln!(xml, "  <GeoTransform>{transform}</GeoTransform>");
    xml.push_str("  <Metadata>\n");
    for (key, text) in [("AREA_OR_POINT", "Area")].iter().chain(statements) {
        let _ = writeln!(xml, "    <MDI key=\"{key}\">{text}</MDI>");
    }
    xml.push_str("  </Metadata>\n");
    xml
}

/// Writes the world file: cell size, rotation and the centre of the north-west cell, one number per line.
///
/// # Errors
/// The operating system reports an error.
pub(super) fn write_world(path: &Path, extension: &str, dem: &Dem) -> Result<()> {
    let (cell, first) = (dem.grid.cell, dem.grid.center(0, 0));
    let text = format!("{}\n0\n0\n{}\n{}\n{}\n", cell.x, -cell.y, first.x, first.y);
    write_text(&path.with_extension(extension), &text)
}
