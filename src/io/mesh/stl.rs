//! STL, binary: a normal and three corners for each triangle, single precision.

use std::io::{Result, Write};

use glam::DVec3;
use tokosen_core::mesh::Mesh;

/// Writes the header, the number of triangles and the triangles.
pub(super) fn write(out: &mut impl Write, mesh: &Mesh, count: u32) -> Result<()> {
    let mut header = [b' '; 80];
    header[..14].copy_from_slice(b"tokosen, in mm");
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.vertices[v as usize]);
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::ZERO);
        let mut row = [0; 50];
        let numbers = [normal, a, b, c].into_iter().flat_map(|v| v.as_vec3().to_array());
        for (bytes, value) in row.chunks_exact_mut(4).zip(numbers) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
        out.write_all(&row)?;
    }
    Ok(())
}
