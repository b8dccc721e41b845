//! The name by which a mesh file gives its coordinate reference system.

use tokosen_core::mesh::Mesh;

/// The name of the mesh's coordinate reference system on one line.
pub(super) fn crs_name(mesh: &Mesh) -> Option<String> {
    let name = mesh.crs.as_ref()?.name()?;
    Some(name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect())
}
