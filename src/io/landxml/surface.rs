//! The triangles of a LandXML surface as a height map.

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;

use super::{length_unit, positions, system, with_document};
use crate::crs_finding::crs_finding;
use crate::xml::{Step, Xml};
use tokosen_core::base::error::{Finding, FindingKind, Report, Result};
use tokosen_core::crs::{Crs, LengthUnit};
use tokosen_core::raster::{Dem, rasterise_faces};

/// Whether a LandXML file is a height map: it has triangles, and no contours before them.
pub(super) fn is_surface(path: &Path) -> Result<bool> {
    with_document(path, |xml| {
        loop {
            match xml.next()? {
                Step::Start if xml.name() == "F" => return Ok(true),
                Step::Start if xml.name() == "Contour" => return Ok(false),
                Step::Over => return Ok(false),
                Step::Start | Step::End | Step::Text => {}
            }
        }
    })
}

/// Triangles and what the file says about their coordinates.
#[derive(Default)]
struct Surface {
    name: Option<String>,
    points: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    crs: Option<Crs>,
    unit: Option<LengthUnit>,
}

/// Reads the triangles as a height map, see [`rasterise_faces`]. Faces that the file marks as not visible are left out. Heights
/// become metres.
///
/// # Errors
/// The file cannot be read or is broken, it has triangles of several surfaces or none, or a face has a corner that is not there.
pub(crate) fn read_surface(path: &Path) -> Result<Report<Dem>> {
    let Surface { mut points, faces, crs, unit, .. } = with_document(path, parse)?;
    if let Some(unit) = &unit {
        points.iter_mut().for_each(|point| point.z *= unit.metres);
    }
    let mut dem = rasterise_faces(&points, &faces, &()).map_err(|e| e.in_file(path))?;
    let missing = || "the LandXML does not name its coordinate reference system by an EPSG code".to_owned();
    let mut findings: Vec<Finding> = crs_finding(crs.as_ref(), missing).into_iter().collect();
    dem.crs = crs.or_else(|| unit.as_ref().map(Crs::of_plane));
    let cell = dem.grid.cell.x;
    let message =
        format!("the heights of {} triangles were read at the centres of cells of {cell} x {cell}", faces.len());
    findings.push(Finding::general(FindingKind::TriangleCells, message));
    Ok(Report { value: dem, findings })
}

fn parse(xml: &mut Xml<'_, '_>) -> Result<Surface> {
    let (mut surface, mut name, mut id, mut text) = (Surface::default(), String::new(), None, String::new());
    let mut is_visible = true;
    // Points by their number, of the surface that is read.
    let mut numbers: HashMap<u64, u32> = HashMap::new();
    loop {
        match xml.next()? {
            Step::Start => {
                text.clear();
                match xml.name() {
                    "Metric" | "Imperial" => surface.unit = length_unit(xml)?,
                    "CoordinateSystem" => surface.crs = system(xml).or(surface.crs.take()),
                    "Surface" => {
                        name = xml.attribute("name").unwrap_or_default().to_owned();
                        numbers.clear();
                    }
                    "P" => id = xml.attribute("id").and_then(|id| id.parse::<u64>().ok()),
                    "F" => is_visible = xml.attribute("i") != Some("1"),
                    _ => {}
                }
            }
            Step::Text => text.push_str(xml.text()),
            Step::End => {
                match xml.name() {
                    "P" => {
                        let (places, z) = positions(&text, 3).map_err(|what| xml.error(format!("a point: {what}")))?;
                        let missing = || xml.error("a point has no number");
                        for (place, z) in places.iter().zip(z) {
                            if !place.is_finite() || !z.is_finite() {
                                return Err(xml.error(format!("the point {text:.80} is no place")));
                            }
                            numbers.insert(id.ok_or_else(missing)?, surface.points.len() as u32);
                            surface.points.push(place.extend(z));
                        }
                    }
                    "F" if is_visible => {
                        let face = face(&text, &numbers).map_err(|what| xml.error(what))?;
                        let first = surface.name.get_or_insert_with(|| name.clone());
                        if *first != name {
                            let message = "holds triangles of more than one surface";
                            return Err(xml.error(format!("{message} ({first}, {name}); export one of them")));
                        }
                        surface.faces.push(face);
                    }
                    _ => {}
                }
                text.clear();
            }
            Step::Over => return Ok(surface),
        }
    }
}

/// The corners of a face, which is given by the numbers of its points.
fn face(text: &str, numbers: &HashMap<u64, u32>) -> Result<[u32; 3], String> {
    let corner = |word: &str| {
        let number = word.parse().map_err(|_| format!("a face: {word:.40} is no number"))?;
        numbers
            .get(&number)
            .copied()
            .ok_or_else(|| format!("a face has the corner {number}, and no point has this number"))
    };
    let corners = text.split_whitespace().map(corner).collect::<Result<Vec<u32>, String>>()?;
    corners.try_into().map_err(|corners: Vec<u32>| format!("a face has {} corners and not three", corners.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::{Content, content};
    use crate::raster::read_dem;

    /// Two triangles of a plane that rises by one in ten to the east.
    const TEXT: &str = r#"<?xml version="1.0"?>
<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2" version="1.2"><Units><Metric linearUnit="meter"/></Units>
<CoordinateSystem epsgCode="6677"/><Surfaces><Surface name="site"><SourceData>
<DataPoints><PntList3D>7 8 9</PntList3D></DataPoints></SourceData>
<Definition surfType="TIN"><Pnts><P id="1">0 0 10</P><P id="2">100 0 10</P><P id="7">100 100 20</P><P id="8">0 100 20</P></Pnts>
<Faces><F>1 7 2</F><F n="1 0 0">1 7 8</F><F i="1">1 2 8</F></Faces></Definition></Surface></Surfaces></LandXML>"#;

    fn with_file<T>(text: &str, read: impl FnOnce(&Path) -> T) -> T {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("site.xml");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    fn height_map(text: &str) -> Result<Dem> {
        with_file(text, |path| read_dem(path).map(|read| read.value.dem))
    }

    #[test]
    fn triangles_are_a_height_map_and_contours_are_a_map() {
        let of = |text: &str| with_file(text, |path| content(path).unwrap());
        assert_eq!(of(TEXT), Content::HeightMap);
        let contours = r#"<SourceData><Contours><Contour elev="5"><PntList2D>0 0 1 1</PntList2D></Contour></Contours>"#;
        assert_eq!(of(&TEXT.replace("<SourceData>", contours)), Content::Contours);
    }

    #[test]
    fn heights_rise_to_the_east() {
        let dem = height_map(TEXT).unwrap();
        assert_eq!(dem.crs.as_ref().and_then(|crs| crs.epsg), Some(6677));
        assert_eq!((dem.grid.cell.x, dem.grid.cols, dem.grid.rows), (0.1, 1000, 1000));
        for (k, height) in dem.values.iter().enumerate() {
            let x = dem.grid.center(k % 1000, k / 1000).x;
            assert!((f64::from(*height) - 10.0 - 0.1 * x).abs() < 1e-4, "{height} at {x}");
        }
        // Of a visible triangle alone, half of the square.
        let half = height_map(&TEXT.replace(r#"<F n="1 0 0">"#, r#"<F i="1">"#)).unwrap();
        assert_eq!(half.values.iter().filter(|height| height.is_nan()).count(), 499_500);
    }

    #[test]
    fn heights_in_feet_become_metres() {
        let text = TEXT.replace("Metric linearUnit=\"meter\"", "Imperial linearUnit=\"foot\"");
        let text = text.replace(r#"<CoordinateSystem epsgCode="6677"/>"#, "");
        let dem = height_map(&text).unwrap();
        assert!((f64::from(dem.values[0]) - 0.3048 * 10.005).abs() < 1e-4);
        assert_eq!(dem.crs.and_then(|crs| crs.length_unit()).map(|unit| unit.metres), Some(0.3048));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let wrong = |from: &str, to: &str| height_map(&TEXT.replace(from, to)).map(|_| ()).unwrap_err().to_string();
        assert!(wrong("<F>1 7 2</F>", "<F>1 7 3</F>").contains("no point has this number"));
        assert!(wrong("<F>1 7 2</F>", "<F>1 7</F>").contains("2 corners and not three"));
        assert!(wrong("<F>1 7 2</F>", "<F>1 7 x</F>").contains("x is no number"));
        assert!(wrong("<P id=\"1\">", "<P>").contains("a point has no number"));
        assert!(wrong("0 0 10</P>", "0 10</P>").contains("2 numbers are no positions"));
        assert!(wrong("0 0 10</P>", "0 inf 10</P>").contains("is no place"));
        assert!(wrong("0 0 10</P>", "0 1e300 10</P>").contains("a coordinate is wrong"));
        assert!(wrong("F", "G").contains("no triangle has an area"));
        let second =
            r#"</Surface><Surface name="road"><Definition><Pnts><P id="1">0 0 1</P></Pnts><Faces><F>1 1 1</F>"#;
        let two = wrong("</Surface>", &format!("{second}</Faces></Definition></Surface>"));
        assert!(two.contains("more than one surface (site, road)"), "{two}");
    }

    #[test]
    fn broken_documents_are_errors_and_never_panic() {
        for end in (0..TEXT.len() - 1).step_by(7) {
            assert!(height_map(&TEXT[..end]).is_err(), "{}", &TEXT[..end]);
        }
        for at in (0..TEXT.len()).step_by(37) {
            let mut bytes = TEXT.as_bytes().to_vec();
            bytes[at] ^= 0x15;
            let _ = height_map(&String::from_utf8_lossy(&bytes));
        }
    }
}
