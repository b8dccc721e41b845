//! The geometry of a feature: one array of all coordinates, and where its parts end.

use std::ops::Range;

use ::flatgeobuf::{Geometry, GeometryType};
use glam::DVec2;

use crate::table::{Feature, NO_GEOMETRY, Spot, Table};

/// Adds a geometry to the feature, or returns what is wrong with it. `declared` is the type that the file declares for
/// all its features.
///
/// Nested geometries cannot be deeper than the limit of the crate's verifier.
pub(super) fn read(
    geometry: &Geometry<'_>,
    declared: GeometryType,
    feature: &mut Feature,
    table: &mut Table,
) -> Result<(), String> {
    let kind = if declared == GeometryType::Unknown { geometry.type_() } else { declared };
    match kind {
        GeometryType::Point | GeometryType::MultiPoint => {
            let Coordinates { points, z } = coordinates(geometry)?;
            if points.is_empty() {
                table.leave_out(NO_GEOMETRY);
            }
            let spots = points.iter().enumerate();
            feature.spots.extend(spots.map(|(i, &place)| Spot { place, z: z.get(i).copied().filter(|z| !z.is_nan()) }));
        }
        GeometryType::LineString | GeometryType::MultiLineString => {
            let Coordinates { points, z } = coordinates(geometry)?;
            let parts = match kind {
                GeometryType::MultiLineString => parts(geometry, points.len())?,
                _ => whole(points.len()),
            };
            if points.is_empty() {
                table.leave_out(NO_GEOMETRY);
            }
            for part in parts {
                let z = z.get(part.clone()).unwrap_or_default();
                feature.push_line(points[part].to_vec(), z);
            }
        }
        GeometryType::Polygon | GeometryType::MultiPolygon if !(table.wants_polygons || table.wants_rings) => {
            table.leave_out(kind.variant_name().unwrap_or("polygon"));
        }
        GeometryType::MultiPolygon if geometry.parts().is_some_and(|parts| !parts.is_empty()) => {
            for part in geometry.parts().into_iter().flat_map(|parts| parts.iter()) {
                read(&part, GeometryType::Polygon, feature, table)?;
            }
        }
        GeometryType::Polygon | GeometryType::MultiPolygon => {
            let Coordinates { points, z } = coordinates(geometry)?;
            if points.is_empty() {
                table.leave_out(NO_GEOMETRY);
                return Ok(());
            }
            if table.wants_rings {
                for part in parts(geometry, points.len())? {
                    let z = z.get(part.clone()).unwrap_or_default();
                    feature.push_ring("Polygon", points[part].to_vec(), z);
                }
                return Ok(());
            }
            feature.note_polygon_z(&z);
            let rings = parts(geometry, points.len())?.into_iter().map(|part| points[part].to_vec());
            feature.polygons.push(rings.collect());
        }
        GeometryType::GeometryCollection => match geometry.parts().filter(|parts| !parts.is_empty()) {
            Some(parts) => parts.iter().try_for_each(|part| read(&part, part.type_(), feature, table))?,
            None => table.leave_out(NO_GEOMETRY),
        },
        other => table.leave_out(other.variant_name().unwrap_or("unknown")),
    }
    Ok(())
}

struct Coordinates {
    points: Vec<DVec2>,
    /// One value per point, or empty.
    z: Vec<f64>,
}

fn coordinates(geometry: &Geometry<'_>) -> Result<Coordinates, String> {
    let numbers: Vec<f64> = geometry.xy().into_iter().flat_map(|xy| xy.iter()).collect();
    if !numbers.len().is_multiple_of(2) {
        return Err("its last vertex lacks a coordinate".to_owned());
    }
    let points: Vec<DVec2> = numbers.chunks_exact(2).map(DVec2::from_slice).collect();
    let z: Vec<f64> = geometry.z().into_iter().flat_map(|z| z.iter()).collect();
    if !z.is_empty() && z.len() != points.len() {
        return Err(format!("it has {} vertices and {} heights", points.len(), z.len()));
    }
    Ok(Coordinates { points, z })
}

/// A single part of all vertices.
fn whole(count: usize) -> Vec<Range<usize>> {
    std::iter::once(0..count).collect()
}

/// The vertex range of each part. The file may omit the ends of a single part.
fn parts(geometry: &Geometry<'_>, count: usize) -> Result<Vec<Range<usize>>, String> {
    let Some(ends) = geometry.ends().filter(|ends| !ends.is_empty()) else { return Ok(whole(count)) };
    let mut start = 0;
    let mut parts = Vec::with_capacity(ends.len());
    for end in ends.iter() {
        let end = end as usize;
        if end < start || end > count {
            return Err("its parts contradict its vertices".to_owned());
        }
        parts.push(start..end);
        start = end;
    }
    if start < count {
        return Err("its parts contradict its vertices".to_owned());
    }
    Ok(parts)
}
