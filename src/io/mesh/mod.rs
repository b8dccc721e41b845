//! Writes meshes: PLY, OBJ and binary glTF; surfaces of triangles as LandXML and DXF; and solids to print as STL and 3MF. The file's extension selects the format.
//!
//! | name | axes | positions |
//! |---|---|---|
//! | `.ply` | z up | double precision, offset and reference system as comments |
//! | `.obj` | z up | decimal, exact; offset and reference system as comments |
//! | `.glb` | y up, z south, as glTF has it | single precision, offset and reference system in the `extras` of scene, node and asset |
//!
//! | `.xml` | LandXML 1.2, northing before easting | decimal, in map coordinates |
//! | `.dxf` | z up | a 3DFACE for each triangle, in map coordinates |
//! | `.stl` | z up | single precision, millimetres from the lower left corner |
//! | `.3mf` | z up | decimal, millimetres from the lower left corner |
//!
//! Positions of `.ply` and `.obj` are in the unit of the mesh, those of `.glb` always in metres, which glTF prescribes.
//!
//! Positions are relative to the mesh's origin (the offset). Otherwise viewers that compute in single precision show
//! jitter. Rounding to single precision may flatten the narrowest triangles of a `.glb`; [`flattened`] counts them. The
//! vertex indices do not change: no crack opens, and a solid stays closed.

mod crs_name;
mod dxf;
mod glb;
mod landxml;
mod obj;
mod ply;
mod stl;
mod threemf;

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use glam::DVec3;

use tokosen_core::base::error::{Error, Result};
use tokosen_core::mesh::Mesh;

/// The extensions that [`write_mesh`] accepts, for messages and help texts.
pub const MESH_EXTENSIONS: [&str; 3] = ["ply", "obj", "glb"];
/// The extensions of [`write_mesh`] for surfaces in map coordinates, without walls.
pub const SURFACE_EXTENSIONS: [&str; 2] = ["xml", "dxf"];
/// The extensions of [`write_mesh`] for solids to print, in millimetres ([`Mesh::printed`]).
pub const PRINT_EXTENSIONS: [&str; 2] = ["stl", "3mf"];

/// Writes a mesh in the format of the extension of `path`.
///
/// # Errors
/// The extension is in none of [`MESH_EXTENSIONS`], [`SURFACE_EXTENSIONS`] and [`PRINT_EXTENSIONS`], a solid is to become a surface or
/// a shell is to be printed, the mesh is larger than the format can hold, or the operating system reports an error.
pub fn write_mesh(path: &Path, mesh: &Mesh) -> Result<()> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "ply" => create(path, |out| ply::write(out, mesh)),
        "obj" => create(path, |out| obj::write(out, mesh)),
        "xml" | "dxf" if mesh.base.is_some() => {
            Err(Error::file(path, "a surface has no walls and no bottom: write a solid as .ply, .obj or .glb"))
        }
        "stl" | "3mf" if mesh.base.is_none() => {
            Err(Error::file(path, "a shell cannot be printed: close it to a solid"))
        }
        "stl" => {
            let count = u32::try_from(mesh.triangles.len());
            let count = count.map_err(|_| Error::file(path, "the mesh is too large for STL: use .3mf"))?;
            create(path, |out| stl::write(out, mesh, count))
        }
        "3mf" => create(path, |out| threemf::write(out, mesh)),
        "xml" => create(path, |out| landxml::write(out, mesh)),
        "dxf" => create(path, |out| dxf::write(out, mesh)),
        "glb" => {
            let in_metres = mesh.in_metres();
            let mesh = in_metres.as_ref().unwrap_or(mesh);
            let header =
                glb::header(mesh).ok_or_else(|| Error::file(path, "the mesh is too large for glTF: use .ply"))?;
            create(path, |out| glb::write(out, mesh, &header))
        }
        _ => Err(Error::file(
            path,
            format!(
                "no mesh format has this extension; meshes are written as {}",
                [MESH_EXTENSIONS.as_slice(), &SURFACE_EXTENSIONS, &PRINT_EXTENSIONS].concat().join(", ")
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

/// How the coordinates of the map come from the positions in a file, as a formula for people. Many programs drop the offset and
/// the unit that the file states.
pub fn placement(path: &Path, mesh: &Mesh) -> String {
    let is_y_up = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
    let in_metres = if is_y_up { mesh.in_metres() } else { None };
    let mesh = in_metres.as_ref().unwrap_or(mesh);
    let DVec3 { x, y, z } = mesh.origin;
    let crs = crs_name::crs_name(mesh).map_or(String::new(), |name| format!("; {name}"));
    let unit = mesh.unit_name();
    let is_in_place =
        SURFACE_EXTENSIONS.iter().any(|own| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(own)));
    match is_y_up {
        _ if is_in_place => format!("x, y and heights are those of the map, in the {unit}{crs}"),
        true => format!("east = x + {x}, north = {y} - z, height = y + {z}, in the {unit}{crs}"),
        false => format!("east = x + {x}, north = y + {y}, height = z + {z}, in the {unit}{crs}"),
    }
}

/// Creates `path` and lets `fill` write to it through a buffer.
fn create(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) -> Result<()> {
    let file = File::create(path).map_err(|e| Error::io("create", path, e))?;
    let mut out = BufWriter::with_capacity(1 << 20, file);
    fill(&mut out).and_then(|()| out.flush()).map_err(|e| Error::io("write", path, e))
}
