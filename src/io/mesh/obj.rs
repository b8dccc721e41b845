//! Wavefront OBJ: text, positions with all digits, one normal per vertex.

use std::io::{Result, Write};

use super::crs_name::crs_name;
use tokosen_core::mesh::Mesh;

/// Writes the comments, the vertices, the normals and the faces. Faces count vertices from one.
pub(super) fn write(out: &mut impl Write, mesh: &Mesh) -> Result<()> {
    writeln!(out, "# tokosen\n# offset {} {} {}", mesh.origin.x, mesh.origin.y, mesh.origin.z)?;
    if mesh.unit.is_some() {
        writeln!(out, "# unit {}", mesh.unit_name())?;
    }
    if let Some(crs) = crs_name(mesh) {
        writeln!(out, "# crs {crs}")?;
    }
    writeln!(out, "o terrain")?;
    for v in &mesh.vertices {
        writeln!(out, "v {} {} {}", v.x, v.y, v.z)?;
    }
    for n in &mesh.normals {
        writeln!(out, "vn {:.5} {:.5} {:.5}", n.x, n.y, n.z)?;
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| u64::from(v) + 1);
        writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
    }
    Ok(())
}
