//! LandXML 1.2: a surface of triangles (TIN) for programs of civil engineering, with the break lines that it follows.
//!
//! Coordinates are those of the map, northing before easting, as the format has it; there is no offset. Points are counted from
//! 1 without gaps, with single spaces, which all readers understand.

use std::io::{Result, Write};

use super::crs_name::crs_name;
use tokosen_core::base::ElevationUnit;
use tokosen_core::mesh::Mesh;

/// Writes the units, the system, the points and the faces.
pub(super) fn write(out: &mut impl Write, mesh: &Mesh) -> Result<()> {
    // The time of a run would make its bytes differ from those of the next one.
    write!(
        out,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
         xsi:schemaLocation=\"http://www.landxml.org/schema/LandXML-1.2 http://www.landxml.org/schema/LandXML-1.2/LandXML-1.2.xsd\" \
         version=\"1.2\" date=\"1970-01-01\" time=\"00:00:00\" readOnly=\"false\" language=\"English\">\n"
    )?;
    let unit = mesh.unit.as_ref().and_then(|unit| ElevationUnit::of_size(unit.metres)).unwrap_or_default();
    let [system, length, area, volume] = match unit {
        ElevationUnit::Metre => ["Metric", "meter", "squareMeter", "cubicMeter"],
        ElevationUnit::Foot => ["Imperial", "foot", "squareFoot", "cubicFeet"],
        ElevationUnit::UsSurveyFoot => ["Imperial", "USSurveyFoot", "squareFoot", "cubicFeet"],
    };
    let [temperature, pressure] = if unit.is_foot() { ["fahrenheit", "inchHG"] } else { ["celsius", "milliBars"] };
    writeln!(
        out,
        "<Units><{system} linearUnit=\"{length}\" areaUnit=\"{area}\" volumeUnit=\"{volume}\" temperatureUnit=\"{temperature}\" \
         pressureUnit=\"{pressure}\" angularUnit=\"decimal degrees\" directionUnit=\"decimal degrees\"/></Units>"
    )?;
    if let Some(name) = crs_name(mesh) {
        let code = mesh.crs.as_ref().and_then(|crs| crs.epsg).map(|code| format!(" epsgCode=\"{code}\""));
        writeln!(out, "<CoordinateSystem name=\"{}\"{}/>", escaped(&name), code.unwrap_or_default())?;
    }
    writeln!(
        out,
        "<Project name=\"terrain\"/>\n<Application name=\"tokosen\" version=\"{}\"/>\n\
         <Surfaces><Surface name=\"terrain\">",
        env!("CARGO_PKG_VERSION")
    )?;
    if !mesh.break_lines.is_empty() {
        writeln!(out, "<SourceData><Breaklines>")?;
        for (k, line) in (1_u64..).zip(&mesh.break_lines) {
            write!(out, "<Breakline brkType=\"standard\" name=\"{k}\"><PntList3D>")?;
            for (k, vertex) in line.iter().enumerate() {
                let (gap, p) = (if k == 0 { "" } else { " " }, *vertex + mesh.origin);
                write!(out, "{gap}{:.6} {:.6} {:.6}", p.y, p.x, p.z)?;
            }
            writeln!(out, "</PntList3D></Breakline>")?;
        }
        writeln!(out, "</Breaklines></SourceData>")?;
    }
    writeln!(out, "<Definition surfType=\"TIN\">\n<Pnts>")?;
    for (k, vertex) in (1_u64..).zip(&mesh.vertices) {
        let p = *vertex + mesh.origin;
        writeln!(out, "<P id=\"{k}\">{:.6} {:.6} {:.6}</P>", p.y, p.x, p.z)?;
    }
    writeln!(out, "</Pnts>\n<Faces>")?;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| u64::from(v) + 1);
        writeln!(out, "<F>{a} {b} {c}</F>")?;
    }
    writeln!(out, "</Faces>\n</Definition></Surface></Surfaces>\n</LandXML>")
}

/// A text between quotation marks of XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
