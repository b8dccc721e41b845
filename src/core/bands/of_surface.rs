//! The bands between the contours of a surface.

use std::collections::HashMap;

use geo::{LineString, MultiPolygon, Polygon};
use glam::DVec2;

use super::{BandArea, BandKind, Ground, WaterArea, bands};
use crate::base::ElevationUnit;
use crate::base::bits::bits;
use crate::base::error::Report;
use crate::contour::{ContourLayer, ContourLine, Source, Target};
use crate::subdomains::{Landform, Region, Ring, Side, landforms, line_starts, piece_of};
use crate::surface::Surface;

/// The areas between the lines of a layer of a surface, up to its frame. `layer` are the lines at the levels of a target, which
/// are in `unit`.
///
/// Where a contour of the input ends near the frame, its straight extension to the frame is a border too. The layer does not
/// have it as a line.
pub fn bands_of_surface(
    surface: &Surface,
    layer: &ContourLayer,
    target: &Target,
    unit: ElevationUnit,
) -> Report<Vec<BandArea>> {
    let tin = &surface.tin;
    let extensions = extensions(surface);
    let water = water(surface);
    let corners = surface.frame.rings().flatten();
    let mut heights: HashMap<[u64; 2], f64> = corners.map(|p| (bits(p), f64::NAN)).collect();
    for v in 0..tin.positions.len() as u32 {
        let place = tin.point(v);
        if let Some(height) = heights.get_mut(&bits(place.truncate())) {
            *height = place.z;
        }
    }
    let height = |p: DVec2| heights.get(&bits(p)).copied().filter(|height| !height.is_nan());
    let crs = surface.map.crs.as_ref();
    let ground = Ground { frame: &surface.frame.area, water: &water, height: &height, crs };
    bands(layer.lines.iter().chain(&extensions), target, unit, &ground)
}

/// The pieces of contours in the triangulation that are no lines of the map: extensions to the frame.
fn extensions(surface: &Surface) -> Vec<ContourLine> {
    let Surface { map, tin, regions, .. } = surface;
    let start = line_starts(map);
    let written: Vec<[[u64; 2]; 2]> = surface.closures.iter().map(|(_, ends)| ends.map(bits)).collect();
    tin.flat_map_inside(|t| {
        let (start, written) = (&start, &written);
        (0..3).filter_map(move |i| {
            let elevation = tin.contour_level(t, i)?;
            let [u, v] = tin.edge(t, i);
            // Each edge has triangles on both sides, unless it is a part of the frame.
            let is_first = tin.inner_neighbour(t, i).is_none_or(|n| t < n);
            if !is_first || piece_of(map, tin, start, u, v).is_some() {
                return None;
            }
            let mut points = [u, v].map(|v| tin.point(v).truncate()).to_vec();
            let ends = [bits(points[0]), bits(points[1])];
            if written.iter().any(|closure| *closure == ends || *closure == [ends[1], ends[0]]) {
                return None;
            }
            // The triangle lies on the left of the edge.
            if regions.region(t)?.side(elevation)? == Side::Above {
                points.reverse();
            }
            let source = Source::Interpolated;
            Some(ContourLine { elevation, points, source, index: false, depression: false, expected: None, kind: None })
        })
    })
}

/// The lakes and the sea.
fn water(surface: &Surface) -> Vec<WaterArea> {
    let Surface { tin, regions, .. } = surface;
    if regions.regions.iter().all(|region| region.water.is_none()) {
        return Vec::new();
    }
    let forms = landforms(tin, regions);
    let of_region = |(region, form): (&Region, &Landform)| {
        let level = region.water?;
        let ring = |ring: &Ring| ring.points(tin).iter().map(|p| (p.x, p.y)).collect::<LineString<f64>>();
        let (outer, holes) = form.rings.split_first()?;
        let area = MultiPolygon::from(Polygon::new(ring(outer), holes.iter().map(ring).collect()));
        let kind = if tin.lake(region.triangle).is_some() { BandKind::Lake } else { BandKind::Sea };
        Some(WaterArea { kind, level, area })
    };
    regions.regions.iter().zip(&forms).filter_map(of_region).collect()
}
