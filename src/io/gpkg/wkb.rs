//! The geometry of a GeoPackage: its own header, then well-known binary (WKB).
//!
//! This reader is written by hand for three reasons: curves must be distinguished from the types that share their low
//! bits; every part has its own byte order; no content of a file may make the reader panic.

use glam::DVec2;

use crate::layer::{Bounds, Outer, Shape};
use crate::table::{Feature, NO_GEOMETRY, Spot, Table};

/// How deep collections may be nested.
const MAX_DEPTH: usize = 16;

/// Names of the geometry types by their WKB code.
const TYPES: [&str; 18] = [
    "Geometry",
    "Point",
    "LineString",
    "Polygon",
    "MultiPoint",
    "MultiLineString",
    "MultiPolygon",
    "GeometryCollection",
    "CircularString",
    "CompoundCurve",
    "CurvePolygon",
    "MultiCurve",
    "MultiSurface",
    "Curve",
    "Surface",
    "PolyhedralSurface",
    "TIN",
    "Triangle",
];

/// The bytes that are not read yet.
struct Bytes<'a> {
    rest: &'a [u8],
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or("its geometry ends too early")?;
        self.rest = rest;
        Ok(taken)
    }

    fn u32(&mut self, little: bool) -> Result<u32, String> {
        let bytes = self.take(4)?.try_into().expect("four bytes");
        Ok(if little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    /// Takes this many positions of `width` numbers, as raw bytes.
    fn positions(&mut self, count: u32, width: usize) -> Result<&'a [u8], String> {
        let bytes = (count as usize).checked_mul(8 * width).ok_or("its geometry has too many vertices")?;
        self.take(bytes)
    }
}

/// The WKB after the header of a GeoPackage geometry. `None` if the header marks it as empty.
pub(super) fn without_header(blob: &[u8]) -> Result<Option<&[u8]>, String> {
    let [b'G', b'P', _version, flags, ..] = blob else {
        return Err("its geometry is not that of a GeoPackage".to_owned());
    };
    if flags & 0b10_0000 != 0 {
        return Err("its geometry is of an extended type".to_owned());
    }
    let envelope = match (flags >> 1) & 0b111 {
        0 => 0,
        1 => 32,
        2 | 3 => 48,
        4 => 64,
        _ => return Err("the header of its geometry is broken".to_owned()),
    };
    let wkb = blob.get(8 + envelope..).ok_or("its geometry ends too early")?;
    Ok((flags & 0b1_0000 == 0).then_some(wkb))
}

/// The name of the geometry's type.
pub(crate) fn type_name(wkb: &[u8]) -> Result<&'static str, String> {
    let (_, code, _) = head(&mut Bytes { rest: wkb })?;
    Ok(TYPES[code])
}

/// Adds the lines and points of a geometry to a feature, and its polygons if they are wanted. Anything else is counted
/// in the table.
pub(crate) fn read(wkb: &[u8], feature: &mut Feature, table: &mut Table) -> Result<(), String> {
    geometry(&mut Bytes { rest: wkb }, feature, table, 0)
}

/// Byte order, type, and whether z and m are present. Both codings of the type are read: thousands and flags.
fn head(bytes: &mut Bytes<'_>) -> Result<(bool, usize, [bool; 2]), String> {
    let little = match bytes.take(1)? {
        [0] => false,
        [1] => true,
        _ => return Err("the byte order of its geometry is neither of the two".to_owned()),
    };
    let raw = bytes.u32(little)?;
    if raw & 0x2000_0000 != 0 {
        bytes.take(4)?;
    }
    let code = raw & 0x0fff_ffff;
    let thousands = code / 1000;
    let kind = (code % 1000) as usize;
    if thousands > 3 || kind >= TYPES.len() {
        return Err(format!("its geometry has the unknown type {raw}"));
    }
    let z = thousands & 1 != 0 || raw & 0x8000_0000 != 0;
    let m = thousands & 2 != 0 || raw & 0x4000_0000 != 0;
    Ok((little, kind, [z, m]))
}

fn geometry(bytes: &mut Bytes<'_>, feature: &mut Feature, table: &mut Table, depth: usize) -> Result<(), String> {
    if depth > MAX_DEPTH {
        return Err("its geometry is nested too deep".to_owned());
    }
    let (little, kind, [has_z, has_m]) = head(bytes)?;
    let width = 2 + usize::from(has_z) + usize::from(has_m);
    match TYPES[kind] {
        "Point" => {
            let (points, z) = split(bytes.positions(1, width)?, width, has_z, little);
            let spots = points.into_iter().enumerate().map(|(i, place)| Spot { place, z: z.get(i).copied() });
            // An empty point is written as NaN.
            let before = feature.spots.len();
            feature.spots.extend(spots.filter(|spot| !spot.place.is_nan()));
            if feature.spots.len() == before {
                table.leave_out(NO_GEOMETRY);
            }
        }
        "LineString" => {
            let count = bytes.u32(little)?;
            let (points, z) = split(bytes.positions(count, width)?, width, has_z, little);
            if points.is_empty() {
                table.leave_out(NO_GEOMETRY);
            }
            feature.push_line(points, &z);
        }
        "Polygon" => {
            let mut rings = Vec::new();
            for _ in 0..bytes.u32(little)? {
                let count = bytes.u32(little)?;
                let positions = bytes.positions(count, width)?;
                if (table.wants_polygons || table.wants_rings) && count > 0 {
                    let (points, z) = split(positions, width, has_z, little);
                    if table.wants_rings {
                        feature.push_ring("Polygon", points, &z);
                        continue;
                    }
                    feature.note_polygon_z(&z);
                    rings.push(points);
                }
            }
            match (table.wants_polygons, rings.is_empty()) {
                (false, _) if table.wants_rings => {}
                (false, _) => table.leave_out("Polygon"),
                (true, true) => table.leave_out(NO_GEOMETRY),
                (true, false) => feature.polygons.push(rings),
            }
        }
        "MultiPoint" | "MultiLineString" | "MultiPolygon" | "GeometryCollection" | "MultiCurve" => {
            let count = bytes.u32(little)?;
            if count == 0 {
                table.leave_out(NO_GEOMETRY);
            }
            for _ in 0..count {
                geometry(bytes, feature, table, depth + 1)?;
            }
        }
        other if depth == 0 => table.leave_out(other),
        other => return Err(format!("its geometry holds a {other}, which is not read; convert curves to lines")),
    }
    Ok(())
}

/// The x and y of positions of `width` numbers, and the z if there is one.
fn split(bytes: &[u8], width: usize, has_z: bool, little: bool) -> (Vec<DVec2>, Vec<f64>) {
    let number = |bytes: &[u8]| {
        let bytes = bytes.try_into().expect("eight bytes");
        if little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) }
    };
    let positions = || bytes.chunks_exact(8 * width);
    let points = positions().map(|p| DVec2::new(number(&p[..8]), number(&p[8..16]))).collect();
    let z = if has_z { positions().map(|p| number(&p[16..24])).collect() } else { Vec::new() };
    (points, z)
}

/// Writes a shape into `blob` as a GeoPackage geometry, with its envelope in the header.
pub(super) fn put(blob: &mut Vec<u8>, shape: &Shape<'_>, srs_id: i32, envelope: Bounds) {
    blob.clear();
    blob.extend(b"GP\0");
    // Little-endian, envelope of x and y.
    blob.push(0b11);
    blob.extend(srs_id.to_le_bytes());
    blob.extend(envelope.iter().flat_map(|bound| bound.to_le_bytes()));
    put_plain(blob, shape);
}

/// Adds a shape as WKB, little-endian.
pub(crate) fn put_plain(blob: &mut Vec<u8>, shape: &Shape<'_>) {
    blob.push(1);
    if let Shape::Point(point) = shape {
        blob.extend(1_u32.to_le_bytes());
        let nowhere = DVec2::NAN;
        blob.extend(point.unwrap_or(nowhere).to_array().map(f64::to_le_bytes).as_flattened());
        return;
    }
    if let Shape::Area(_) = shape {
        blob.extend(3_u32.to_le_bytes());
        let rings = shape.rings(Outer::Counterclockwise);
        blob.extend((rings.len() as u32).to_le_bytes());
        for ring in rings {
            blob.extend((ring.len() as u32).to_le_bytes());
            ring.for_each(|point| blob.extend(point.to_array().map(f64::to_le_bytes).as_flattened()));
        }
        return;
    }
    blob.extend(1002_u32.to_le_bytes());
    blob.extend((shape.vertex_count() as u32).to_le_bytes());
    for point in shape.vertices() {
        blob.extend(point.to_array().map(f64::to_le_bytes).as_flattened());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Purpose, Request};

    fn table() -> Table {
        Table::new(&Request {
            elevation_field: None,
            layer: None,
            purpose: Purpose::Contours,
            within: None,
            memory: None,
        })
    }

    /// A line of two vertices whose numbers count up from a half.
    fn line(code: u32, little: bool, width: usize) -> Vec<u8> {
        let order = |n: u32| if little { n.to_le_bytes() } else { n.to_be_bytes() };
        let mut wkb = vec![u8::from(little)];
        wkb.extend(order(code));
        if code & 0x2000_0000 != 0 {
            wkb.extend(order(4326));
        }
        wkb.extend(order(2));
        for i in 0..2 * width {
            let number = i as f64 + 0.5;
            wkb.extend(if little { number.to_le_bytes() } else { number.to_be_bytes() });
        }
        wkb
    }

    #[test]
    fn every_spelling_of_the_dimensions() {
        let cases = [
            (2, 2, None),
            (1002, 3, Some([2.5, 5.5])),
            (2002, 3, None),
            (3002, 4, Some([2.5, 6.5])),
            (0x8000_0002, 3, Some([2.5, 5.5])),
            (0x4000_0002, 3, None),
            (0xc000_0002, 4, Some([2.5, 6.5])),
            (0xa000_0002, 3, Some([2.5, 5.5])),
        ];
        for (code, width, z) in cases {
            for little in [true, false] {
                let mut feature = Feature::default();
                read(&line(code, little, width), &mut feature, &mut table()).unwrap();
                assert_eq!(feature.lines[0].points[1], DVec2::new(width as f64 + 0.5, width as f64 + 1.5));
                assert_eq!(feature.lines[0].z, z, "{code:x}");
            }
        }
    }

    #[test]
    fn curves_are_counted_by_their_name() {
        let mut table = table();
        read(&line(8, true, 2), &mut Feature::default(), &mut table).unwrap();
        read(&line(1009, true, 2), &mut Feature::default(), &mut table).unwrap();
        assert_eq!(table.left_out.keys().collect::<Vec<_>>(), ["CircularString", "CompoundCurve"]);
    }

    #[test]
    fn headers_of_every_envelope() {
        for (flags, size) in [(0b0001, 0), (0b0011, 32), (0b0101, 48), (0b0111, 48), (0b1001, 64), (0b0000, 0)] {
            let mut blob = vec![b'G', b'P', 0, flags, 0, 0, 0, 0];
            blob.extend(vec![0; size]);
            blob.push(77);
            assert_eq!(without_header(&blob).unwrap(), Some(&[77][..]));
            blob[3] |= 0b1_0000;
            assert_eq!(without_header(&blob).unwrap(), None);
            blob.truncate(7 + size);
            assert!(without_header(&blob).is_err());
        }
        assert!(without_header(&[b'G', b'P', 0, 0b1011, 0, 0, 0, 0]).is_err());
        assert!(without_header(b"\x01\x02\0\0\0").is_err());
        assert!(without_header(b"").is_err());
    }

    #[test]
    fn cut_and_changed_bytes_never_panic() {
        let mut collection = vec![1];
        collection.extend(7_u32.to_le_bytes());
        collection.extend(2_u32.to_le_bytes());
        collection.extend(line(1002, true, 3));
        collection.extend(line(2, false, 2));
        for end in 0..collection.len() {
            assert!(read(&collection[..end], &mut Feature::default(), &mut table()).is_err());
        }
        for at in 0..collection.len() {
            for byte in [0, 1, 7, 0x20, 0x7f, 0xff] {
                let mut changed = collection.clone();
                changed[at] = byte;
                let _ = read(&changed, &mut Feature::default(), &mut table());
            }
        }
        let mut deep = Vec::new();
        for _ in 0..100_000 {
            deep.extend([1, 7, 0, 0, 0, 1, 0, 0, 0]);
        }
        assert!(read(&deep, &mut Feature::default(), &mut table()).unwrap_err().contains("deep"));
    }
}
