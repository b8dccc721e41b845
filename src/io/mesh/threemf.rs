//! 3MF: a package (ZIP) with one model in XML, in millimetres. Triangles share their vertices, so that the solid is closed whatever
//! the precision.

use std::io::{BufWriter, Seek, Write};

use crate::maker::MADE_BY;
use tokosen_core::mesh::Mesh;
use zip::write::SimpleFileOptions;
use zip::{DateTime, ZipWriter};

const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>";
const RELATIONS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/3dmodel.model\" Id=\"model\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

/// Writes the package.
pub(super) fn write(out: &mut (impl Write + Seek), mesh: &Mesh) -> std::io::Result<()> {
    let mut package = ZipWriter::new(out);
    package.set_comment(MADE_BY)?;
    // The time of a run would make its bytes differ from those of the next one.
    let options = SimpleFileOptions::default().last_modified_time(DateTime::default()).large_file(true);
    for (name, content) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        package.start_file(name, options)?;
        package.write_all(content.as_bytes())?;
    }
    package.start_file("3D/3dmodel.model", options)?;
    let mut model = BufWriter::with_capacity(1 << 16, &mut package);
    write!(
        model,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<metadata name=\"Application\">tokosen</metadata>\n\
         <resources><object id=\"1\" type=\"model\"><mesh>\n<vertices>\n"
    )?;
    for v in &mesh.vertices {
        writeln!(model, "<vertex x=\"{:.6}\" y=\"{:.6}\" z=\"{:.6}\"/>", v.x, v.y, v.z)?;
    }
    writeln!(model, "</vertices>\n<triangles>")?;
    for [a, b, c] in &mesh.triangles {
        writeln!(model, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>")?;
    }
    writeln!(model, "</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>")?;
    model.flush()?;
    drop(model);
    package.finish()?;
    Ok(())
}
