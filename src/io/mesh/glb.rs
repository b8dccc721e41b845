//! glTF 2.0 in one binary file: a header, a JSON chunk that describes the buffer, and the buffer.
//!
//! glTF's y axis points up, so a vertex is written as (x, z, -y): x east, y up, z south.

use std::io::{Result, Write};

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::crs_name::crs_name;
use tokosen_core::mesh::Mesh;

/// Component types and buffer targets, with the numbers that glTF defines.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The JSON chunk, with padding, and the lengths of all parts.
pub(super) struct Header {
    json: Vec<u8>,
    total: u32,
    binary: u32,
}

fn position(v: DVec3) -> Vec3 {
    y_up(v.as_vec3())
}

/// How many triangles have no area seen from above, or are turned over, after their corners are rounded.
pub(super) fn flattened(mesh: &Mesh) -> usize {
    let is_lost = |t: &&[u32; 3]| {
        let corners = t.map(|v| mesh.vertices[v as usize]);
        // Differences and products of two rounded numbers are exact, or nearly exact, in double precision.
        let area = |[a, b, c]: [DVec3; 3]| (b - a).truncate().perp_dot((c - a).truncate());
        let (exact, rounded) = (area(corners), area(corners.map(|c| c.as_vec3().as_dvec3())));
        exact != 0.0 && rounded * exact.signum() <= 0.0
    };
    mesh.triangles.iter().filter(is_lost).count()
}

fn y_up(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, -v.y)
}

/// Where the model is: the offset, and the coordinate reference system if it is known.
fn placement(mesh: &Mesh) -> Value {
    let mut placement = json!({ "offset": mesh.origin.to_array(), "unit": mesh.unit_name() });
    if let Some(name) = crs_name(mesh) {
        placement["crs"] = name.into();
    }
    placement
}

/// The JSON chunk. `None` if the file's length does not fit into 32 bits.
pub(super) fn header(mesh: &Mesh) -> Option<Header> {
    let (count, corners) = (mesh.vertices.len() as u64, 3 * mesh.triangles.len() as u64);
    let (vectors, indices) = (12 * count, 4 * corners);
    let binary = u32::try_from(2 * vectors + indices).ok()?;
    let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (lo, hi) = mesh.vertices.iter().map(|&v| position(v)).fold(start, |(lo, hi), p| (lo.min(p), hi.max(p)));
    // Blender and trimesh drop those of the asset. Both keep those of the scene, and Blender those of the node.
    let placement = placement(mesh);
    let text = json!({
        "asset": { "version": "2.0", "generator": "tokosen", "extras": placement },
        "scene": 0,
        "scenes": [{ "nodes": [0], "extras": placement }],
        "nodes": [{ "mesh": 0, "name": "terrain", "extras": placement }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 }, "indices": 2, "material": 0 }] }],
        "materials": [{
            "pbrMetallicRoughness": { "baseColorFactor": [0.72, 0.68, 0.58, 1.0], "metallicFactor": 0.0 },
            "doubleSided": true,
        }],
        "accessors": [
            {
                "bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3",
                "min": lo.to_array(), "max": hi.to_array(),
            },
            { "bufferView": 1, "componentType": FLOAT, "count": count, "type": "VEC3" },
            { "bufferView": 2, "componentType": UNSIGNED_INT, "count": corners, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": vectors, "target": ARRAY_BUFFER },
            { "buffer": 0, "byteOffset": vectors, "byteLength": vectors, "target": ARRAY_BUFFER },
            { "buffer": 0, "byteOffset": 2 * vectors, "byteLength": indices, "target": ELEMENT_ARRAY_BUFFER },
        ],
        "buffers": [{ "byteLength": binary }],
    });
    let mut json = text.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    // Every part of the binary chunk is a multiple of four bytes long, so it needs no padding.
    let total = u32::try_from(12 + 8 + json.len() as u64 + 8 + u64::from(binary)).ok()?;
    Some(Header { json, total, binary })
}

/// Writes the file.
pub(super) fn write(out: &mut impl Write, mesh: &Mesh, header: &Header) -> Result<()> {
    out.write_all(b"glTF")?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&header.total.to_le_bytes())?;
    out.write_all(&(header.json.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&header.json)?;
    out.write_all(&header.binary.to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    let positions = mesh.vertices.iter().map(|&v| position(v));
    let normals = mesh.normals.iter().map(|&n| y_up(n));
    for v in positions.chain(normals) {
        words(out, v.to_array().map(f32::to_le_bytes))?;
    }
    mesh.triangles.iter().try_for_each(|t| words(out, t.map(u32::to_le_bytes)))
}

fn words(out: &mut impl Write, words: [[u8; 4]; 3]) -> Result<()> {
    out.write_all(words.as_flattened())
}
