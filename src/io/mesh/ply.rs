//! PLY, binary little-endian: double positions, float normals, 32-bit indices.

use std::io::{Result, Write};

use super::crs_name::crs_name;
use tokosen_core::mesh::Mesh;

/// Writes the header, the vertices and the triangles.
pub(super) fn write(out: &mut impl Write, mesh: &Mesh) -> Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment tokosen")?;
    writeln!(out, "comment offset {} {} {}", mesh.origin.x, mesh.origin.y, mesh.origin.z)?;
    if mesh.unit.is_some() {
        writeln!(out, "comment unit {}", mesh.unit_name())?;
    }
    if let Some(crs) = crs_name(mesh) {
        writeln!(out, "comment crs {crs}")?;
    }
    writeln!(out, "element vertex {}", mesh.vertices.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property double {axis}")?;
    }
    for axis in ["nx", "ny", "nz"] {
        writeln!(out, "property float {axis}")?;
    }
    writeln!(out, "element face {}\nproperty list uchar uint vertex_indices\nend_header", mesh.triangles.len())?;
    for (v, n) in mesh.vertices.iter().zip(&mesh.normals) {
        let mut row = [0; 36];
        for (bytes, value) in row[..24].chunks_exact_mut(8).zip(v.to_array()) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        for (bytes, value) in row[24..].chunks_exact_mut(4).zip(n.to_array()) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        out.write_all(&row)?;
    }
    for t in &mesh.triangles {
        let mut row = [3; 13];
        for (bytes, v) in row[1..].chunks_exact_mut(4).zip(t) {
            bytes.copy_from_slice(&v.to_le_bytes());
        }
        out.write_all(&row)?;
    }
    Ok(())
}
