//! The height of a lake that has none in the data: that of its shore.

use std::collections::BTreeMap;

use geo::Polygon;
use glam::DVec2;

use super::dry::DrySubdivision;
use super::net::Net;
use crate::geometry::point_distance;

/// A shore runs along a contour if it does so for at least this share of its length.
const ALONG: f64 = 0.8;

/// The level of the contour that runs along the shore within `near`, if there is one.
pub(crate) fn level_along(polygon: &Polygon<f64>, net: &Net, near: f64) -> Option<f64> {
    let mut lengths: BTreeMap<u64, f64> = BTreeMap::new();
    let mut total = 0.0;
    for (place, length) in samples(polygon) {
        total += length;
        let near_pieces = net.near(place, place, near).into_iter();
        let distances = near_pieces.map(|piece| (point_distance(place, &piece.ends), piece.level));
        let nearest = distances.filter(|(distance, _)| *distance <= near).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, level)) = nearest {
            *lengths.entry(level.to_bits()).or_default() += length;
        }
    }
    let longest = lengths.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (longest.1 >= ALONG * total).then(|| f64::from_bits(longest.0))
}

/// The lowest ground along the shore, in the sub-domain that contains most of the shore. None if no part of the shore
/// lies on ground of known height.
pub(crate) fn lowest_on_shore(polygon: &Polygon<f64>, dry: &DrySubdivision) -> Option<f64> {
    let mut by_region: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
    let mut t = 0;
    for (place, length) in samples(polygon) {
        let local = place - dry.tin.origin;
        let Some(found) = dry.tin.locate(t, local) else { continue };
        t = found;
        if dry.regions.region(t).is_none() {
            continue;
        }
        let height = height_in(dry, t, local);
        let entry = by_region.entry(dry.regions.of_triangle[t as usize]).or_insert((0.0, f64::INFINITY));
        entry.0 += length;
        entry.1 = entry.1.min(height);
    }
    let (region, (_, lowest)) = by_region.into_iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0).then(b.0.cmp(&a.0)))?;
    let band = dry.regions.regions[region as usize].band;
    lowest.is_finite().then(|| lowest.clamp(band.lo, band.hi))
}

/// Points along the shore, each with the length that it represents: every vertex and the middle of every segment.
fn samples(polygon: &Polygon<f64>) -> impl Iterator<Item = (DVec2, f64)> + '_ {
    polygon.exterior().lines().flat_map(|line| {
        let [a, b] = [line.start, line.end].map(|c| DVec2::new(c.x, c.y));
        let half = 0.5 * a.distance(b);
        [(a, half), (a.midpoint(b), half)]
    })
}

/// Height at a point in or on triangle `t`.
fn height_in(dry: &DrySubdivision, t: u32, place: DVec2) -> f64 {
    let [a, b, c] = dry.tin.corners(t);
    let [za, zb, zc] = dry.tin.corner_heights(t);
    let area = (b - a).perp_dot(c - a);
    if area <= 0.0 {
        return za.min(zb).min(zc);
    }
    let (u, v) = ((place - a).perp_dot(c - a) / area, (b - a).perp_dot(place - a) / area);
    za + u * (zb - za) + v * (zc - za)
}
