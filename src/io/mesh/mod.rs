//! Writes meshes: PLY, OBJ and binary glTF. The file's extension selects the format.
//!
//! | name | axes | positions |
//! |---|---|---|
//! | `.ply` | z up | double precision, offset and reference system as comments |
//! | `.obj` | z up | decimal, exact; offset and reference system as comments |
//! | `.glb` | y up, z south, as glTF has it | single precision, offset and reference system in `asset.extras` |
//!
//! Positions are relative to the mesh's origin (the offset). Otherwise viewers that compute in single precision show
//! jitter. Rounding to single precision may flatten the narrowest triangles of a `.glb`; [`flattened`] counts them. The
//! vertex indices do not change: no crack opens, and a solid stays closed.

mod crs_name;
mod glb;
mod obj;
mod ply;

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::base::error::{Error, Result};
use crate::mesh::Mesh;

/// The extensions that [`write_mesh`] accepts, for messages and help texts.
pub const MESH_EXTENSIONS: [&str; 3] = ["ply", "obj", "glb"];

/// Writes a mesh in the format of the extension of `path`.
///
/// # Errors
/// The extension is not in [`MESH_EXTENSIONS`], the mesh is larger than the format can hold, or the operating system
/// reports an error.
pub fn write_mesh(path: &Path, mesh: &Mesh) -> Result<()> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "ply" => create(path, |out| ply::write(out, mesh)),
        "obj" => create(path, |out| obj::write(out, mesh)),
        "glb" => {
            let header =
                glb::header(mesh).ok_or_else(|| Error::file(path, "the mesh is too large for glTF: use .ply"))?;
            create(path, |out| glb::write(out, mesh, &header))
        }
        _ => Err(Error::file(
            path,
            format!(
                "no mesh format has this extension; meshes are written as {}",
                MESH_EXTENSIONS.map(|e| format!(".{e}")).join(", ")
            ),
        )),
    }
}

/// How many triangles lose their area on the map, or are turned over, when positions are rounded to the precision of
/// the format of `path`.
pub fn flattened(path: &Path, mesh: &Mesh) -> usize {
    let is_single = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
    if is_single { glb::flattened(mesh) } else { 0 }
}

/// Creates `path` and lets `fill` write to it through a buffer.
fn create(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) -> Result<()> {
    let file = File::create(path).map_err(|e| Error::io("create", path, e))?;
    let mut out = BufWriter::with_capacity(1 << 20, file);
    fill(&mut out).and_then(|()| out.flush()).map_err(|e| Error::io("write", path, e))
}
