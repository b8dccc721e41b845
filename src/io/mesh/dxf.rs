//! DXF: a 3DFACE for each triangle, on the layer TERRAIN.
//!
//! Coordinates are those of the map; there is no offset. The version is R12, which every program reads.

use std::io::{Result, Write};

use crate::dxf::unit_code;
use tokosen_core::mesh::Mesh;

/// Writes the header and the faces. A triangle is a face whose fourth corner is the third.
pub(super) fn write(out: &mut impl Write, mesh: &Mesh) -> Result<()> {
    let (unit, _) = unit_code(mesh.unit.as_ref());
    write!(
        out,
        "999\nmade by tokosen\n0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n0\nSECTION\n2\n\
         TABLES\n0\nTABLE\n2\nLAYER\n70\n1\n0\nLAYER\n2\nTERRAIN\n70\n0\n62\n7\n6\nCONTINUOUS\n0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\n\
         ENTITIES\n"
    )?;
    for triangle in &mesh.triangles {
        writeln!(out, "0\n3DFACE\n8\nTERRAIN")?;
        let [a, b, c] = triangle.map(|v| mesh.vertices[v as usize] + mesh.origin);
        for (corner, p) in [a, b, c, c].into_iter().enumerate() {
            writeln!(out, "1{corner}\n{:.6}\n2{corner}\n{:.6}\n3{corner}\n{:.6}", p.x, p.y, p.z)?;
        }
    }
    writeln!(out, "0\nENDSEC\n0\nEOF")
}
