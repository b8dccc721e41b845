//! Heights for the corners of the frame.

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;

use crate::skeleton::{AxisPoint, axis_heights};
use crate::subdomains::{Band, Regions};
use crate::tin::{Tin, VertexKind};
use crate::tuning::SkeletonTuning;

/// Gives the corners of the frame heights, from the first of these that is there:
///
/// 1. the height (metres) that `smooth` has for the map position of the corner;
/// 2. the height that the contours around the corner give;
/// 3. that of the nearest vertex with which the corner shares a triangle;
/// 4. the middle of the band.
///
/// Where two parts of the frame touch, the height lies in the bands of both.
pub(super) fn with_frame_heights(tin: Tin, regions: &Regions, smooth: &dyn Fn(DVec2) -> Option<f64>) -> Tin {
    let is_corner = |v: u32| tin.kinds[v as usize] == VertexKind::Frame;
    let mut points: BTreeMap<u32, AxisPoint> = BTreeMap::new();
    let mut nearest: HashMap<u32, (f64, f64)> = HashMap::new();
    let mut limits: HashMap<u32, (f64, f64)> = HashMap::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for corner in tin.triangles[t as usize].into_iter().filter(|&v| is_corner(v)) {
            let position = tin.positions[corner as usize];
            let region = regions.of_triangle[t as usize];
            points.insert(corner, AxisPoint { position, level: None, triangle: t, region });
            let band = regions.regions[region as usize].band;
            let limit = limits.entry(corner).or_insert((band.lo, band.hi));
            *limit = (limit.0.max(band.lo), limit.1.min(band.hi));
            for v in tin.triangles[t as usize].into_iter().filter(|&v| !is_corner(v)) {
                let distance = position.distance(tin.positions[v as usize]);
                let best = nearest.entry(corner).or_insert((f64::INFINITY, f64::NAN));
                if distance < best.0 {
                    *best = (distance, tin.heights[v as usize]);
                }
            }
        }
    }
    let (corners, points): (Vec<u32>, Vec<AxisPoint>) = points.into_iter().unzip();
    // The default value, not the one of a surface: the subdivision is made before any surface, and for other uses.
    let found = axis_heights(&tin, regions, &points, &SkeletonTuning::default());
    let mut heights = tin.heights.clone();
    for ((&v, height), region) in corners.iter().zip(found).zip(points.iter().map(|p| p.region)) {
        let band = regions.regions[region as usize].band;
        // A corner among other corners has only its band to go by.
        let fallback = || nearest.get(&v).map_or((band.lo + band.hi) / 2.0, |n| n.1);
        let smooth = smooth(tin.point(v).truncate()).filter(|h| !h.is_nan());
        let choice = smooth.or(Some(height).filter(|h| !h.is_nan()));
        heights[v as usize] = choice.unwrap_or_else(fallback);
    }
    for (v, (lo, hi)) in limits.into_iter().filter(|(_, (lo, hi))| lo <= hi && (hi - lo).is_finite()) {
        heights[v as usize] = Band { lo, hi }.strictly_inside(heights[v as usize]);
    }
    tin.with_heights(heights)
}
