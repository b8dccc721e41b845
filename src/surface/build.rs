//! From a clean map to a surface: triangulate, find the sub-domains and the skeleton, triangulate again with it.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::DVec2;

use super::{Surface, SurfaceKind, SurfaceParams};
use crate::contour::{Border, Clipped, ContourMap, Interval, clip, find_interval};
use crate::error::{Error, Finding, FindingKind, Report, Result};
use crate::progress::Progress;
use crate::skeleton::{AxisPoint, End, Skeleton, axis_heights, skeleton};
use crate::tin::{
    Frame, FrameRing, Gaps, Link, Regions, Side, Tin, TinInput, VertexKind, close_gaps, frame_ring, link_open_ends,
    regions, triangulate,
};

/// Builds the surface of a clean map (see [`clean`](fn@crate::contour::clean)).
///
/// # Errors
/// When the map has fewer than two levels, when a contour line crosses another, when the points have no extent, or
/// when the parameters are out of range.
pub fn build(map: ContourMap, params: &SurfaceParams, progress: &dyn Progress) -> Result<Report<Surface>> {
    if !params.resolution.is_finite() || params.resolution < 0.0 {
        return Err(Error::Parameter(format!(
            "the resolution parameter w is {}, it must be 0 or more",
            params.resolution
        )));
    }
    let frame = frame_ring(&map, &params.frame);
    let mut findings = Vec::new();
    let (map, frame) = match &params.frame {
        Frame::Polygon(wanted) => {
            if frame.area != *wanted {
                let message = "the frame polygon reaches beyond the contours; the surface ends at their convex hull";
                findings.push(Finding::general(FindingKind::FrameBeyondMap, message));
            }
            let Clipped { map, area } = clip(map, &frame.area);
            (map, FrameRing { area })
        }
        Frame::Hull | Frame::Box => (map, frame),
    };
    let interval = find_interval(&map.contours).ok_or_else(|| too_few_levels(&map, &params.frame))?;
    let tolerance = 1e-9 * frame.diagonal();
    let (ends, links) = link_open_ends(&map, &frame, tolerance);
    let frame = match params.frame {
        Frame::Hull | Frame::Box => frame,
        Frame::Polygon(_) => frame.with_points(&links.iter().map(|l| l.frame).collect::<Vec<_>>()),
    };
    let frame_edges = matches!(params.frame, Frame::Polygon(_));
    let parts = Parts { map: &map, frame: &frame, frame_edges, links: &links, tolerance };

    progress.start("triangulating", 0);
    let mut spots: Vec<bool> = vec![true; map.spots.len()];
    let (tin, sub_domains, gaps) = loop {
        let input = parts.input(&spots);
        let tin = with_frame(triangulate(input)?, params, &frame);
        let gaps = close_gaps(&tin, &ends, interval.step);
        let tin = tin.with_gaps(&gaps);
        let (tin, report) = known_regions(tin, &interval);
        let outside = spots_outside_bands(&map, &tin, &report.value);
        if outside.is_empty() {
            findings.extend(report.findings);
            break (tin, report.value, gaps);
        }
        for (spot, finding) in outside {
            spots[spot] = false;
            findings.push(finding);
        }
    };
    let tin = with_frame_heights(tin, &sub_domains);
    progress.finish();
    let bridges = bridges(&tin, &sub_domains, &gaps);
    if params.kind == SurfaceKind::Linear {
        let surface = Surface { map, tin, regions: sub_domains, bridges, break_lines: Vec::new(), frame, interval };
        return Ok(Report { value: surface, findings });
    }

    progress.start("ridge and canyon lines", 0);
    let skeleton = skeleton(&tin, &sub_domains, params.resolution);
    progress.finish();

    progress.start("triangulating with them", 0);
    let mut input = parts.input(&spots);
    push_skeleton(&mut input, &tin, &skeleton);
    for &[u, v] in gaps.bridges.iter().chain(&gaps.gates) {
        input.push_edge(tin.source[u as usize], tin.source[v as usize]);
    }
    drop((tin, sub_domains));
    // The same points come first, so the vertices of the gaps have the same numbers again.
    let tin = with_frame(triangulate(input)?, params, &frame).with_gaps(&gaps);
    let (tin, report) = known_regions(tin, &interval);
    let sub_domains = report.value;
    let tin = with_frame_heights(tin, &sub_domains);
    progress.finish();
    let break_lines = skeleton.lines;
    let surface = Surface { map, tin, regions: sub_domains, bridges, break_lines, frame, interval };
    Ok(Report { value: surface, findings })
}

fn too_few_levels(map: &ContourMap, frame: &Frame) -> Error {
    let (inside, remedy) = match frame {
        Frame::Polygon(_) => (" inside the frame polygon", "choose a larger polygon"),
        Frame::Hull | Frame::Box => ("", "is it the right elevation field?"),
    };
    Error::Data(match map.contours.first() {
        None => format!("there is no contour line{inside}"),
        Some(c) if map.contours.len() == 1 => format!(
            "there is one contour line only{inside} (elevation {}): a surface needs contours of two levels",
            c.elevation
        ),
        Some(c) => format!(
            "all {} contour lines{inside} have the elevation {}: a surface needs contours of two levels ({remedy})",
            map.contours.len(),
            c.elevation
        ),
    })
}

/// All that is triangulated, contours first, so that their heights win where points coincide.
struct Parts<'a> {
    map: &'a ContourMap,
    frame: &'a FrameRing,
    /// The frame's edges go in too: it is a polygon that the convex hull of all points does not follow.
    frame_edges: bool,
    links: &'a [Link],
    tolerance: f64,
}

impl Parts<'_> {
    /// `spots` says which spot heights are used.
    fn input(&self, spots: &[bool]) -> TinInput {
        let rings: Vec<Vec<DVec2>> = self.frame.rings().collect();
        let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for &p in self.map.contours.iter().flat_map(|c| &c.points).chain(rings.iter().flatten()) {
            lo = lo.min(p);
            hi = hi.max(p);
        }
        let mut input = TinInput::new([lo, hi], self.tolerance);
        for contour in &self.map.contours {
            input.push_line(&contour.points, contour.elevation, VertexKind::Contour);
        }
        for link in self.links {
            input.push_line(&[link.end, link.frame], link.elevation, VertexKind::Contour);
        }
        for spot in self.map.spots.iter().zip(spots).filter(|(_, used)| **used).map(|(s, _)| s) {
            input.push(spot.truncate(), spot.z, VertexKind::Spot);
        }
        for ring in rings {
            let corners: Vec<u32> = ring.iter().map(|&c| input.push(c, f64::NAN, VertexKind::Frame)).collect();
            if self.frame_edges {
                let next = corners.iter().cycle().skip(1);
                corners.iter().zip(next).for_each(|(&a, &b)| input.push_edge(a, b));
            }
        }
        input
    }
}

fn push_skeleton(input: &mut TinInput, tin: &Tin, skeleton: &Skeleton) {
    let points: Vec<u32> = skeleton
        .axis
        .points
        .iter()
        .zip(&skeleton.heights)
        .map(|(p, &h)| input.push_local(p.position, h, VertexKind::Axis))
        .collect();
    for piece in &skeleton.axis.pieces {
        let [a, b] = piece.map(|end| match end {
            End::Axis(p) => points[p as usize],
            End::Vertex(v) => tin.source[v as usize],
        });
        input.push_edge(a, b);
    }
}

/// Takes the triangles outside a boundary polygon out of the frame.
fn with_frame(tin: Tin, params: &SurfaceParams, frame: &FrameRing) -> Tin {
    match params.frame {
        Frame::Hull | Frame::Box => tin,
        Frame::Polygon(_) => {
            let border = Border::new(&frame.area);
            tin.restricted(|p| border.contains(p))
        }
    }
}

/// The sub-domains, less parts of the frame that hold no contour: nothing is known of their heights, so they are taken out
/// of the frame.
fn known_regions(tin: Tin, interval: &Interval) -> (Tin, Report<Regions>) {
    let report = regions(&tin, interval);
    let middle = |t: u32| tin.corners(t).iter().sum::<DVec2>() / 3.0 + tin.origin;
    let unknown = report.value.regions.iter().filter(|r| r.levels.is_empty());
    let unknown: Vec<DVec2> = unknown.map(|r| middle(r.triangle)).collect();
    if unknown.is_empty() {
        return (tin, report);
    }
    let is_known: Vec<bool> =
        (0..tin.len() as u32).map(|t| report.value.region(t).is_some_and(|r| !r.levels.is_empty())).collect();
    let tin = tin.only(&is_known);
    let mut report = regions(&tin, interval);
    report.findings.extend(unknown.into_iter().map(|place| {
        let message = "a part of the frame holds no contour; it is left without heights";
        Finding::at(FindingKind::FrameBeyondMap, place, message)
    }));
    (tin, report)
}

/// Spot heights that contradict the levels around them, by their number in the map.
fn spots_outside_bands(map: &ContourMap, tin: &Tin, regions: &Regions) -> Vec<(usize, Finding)> {
    let number: HashMap<[u64; 2], usize> =
        map.spots.iter().enumerate().map(|(i, s)| ([s.x.to_bits(), s.y.to_bits()], i)).collect();
    let mut checked = vec![false; tin.positions.len()];
    let mut outside = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let Some(region) = regions.region(t) else { continue };
        for v in tin.triangles[t as usize].map(|v| v as usize) {
            if tin.kinds[v] != VertexKind::Spot || std::mem::replace(&mut checked[v], true) {
                continue;
            }
            let p = tin.point(v as u32);
            if region.band.contains(p.z) {
                continue;
            }
            if let Some(&spot) = number.get(&[p.x.to_bits(), p.y.to_bits()]) {
                let (lo, hi) = (region.band.lo, region.band.hi);
                let message = format!("spot height {} lies between contours {lo} and {hi}; it is left out", p.z);
                outside.push((spot, Finding::at(FindingKind::SpotOutsideBand, p.truncate(), message)));
            }
        }
    }
    outside.sort_by_key(|(spot, _)| *spot);
    outside
}

/// The bridges as lines, higher ground on their right.
fn bridges(tin: &Tin, regions: &Regions, gaps: &Gaps) -> Vec<(f64, [DVec2; 2])> {
    let mut wanted: HashSet<[u32; 2]> = gaps.bridges.iter().map(|&[u, v]| [u.min(v), u.max(v)]).collect();
    let mut found = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in 0..3 {
            let [u, v] = tin.edge(t, i);
            if wanted.is_empty() || !wanted.remove(&[u.min(v), u.max(v)]) {
                continue;
            }
            let level = tin.heights[u as usize];
            let rises = regions.region(t).and_then(|r| r.side(level)) == Some(Side::Above);
            // The triangle lies on the left of the edge from u to v.
            let ends = if rises { [v, u] } else { [u, v] };
            found.push((level, ends.map(|v| tin.point(v).truncate())));
        }
    }
    found
}

/// Gives the corners of the frame heights from the contours around them. Where no contour borders the sub-domain, a
/// corner has the height of the nearest vertex that it shares a triangle with. Where two parts of the frame touch, the
/// height lies in the bands of both, if it can.
fn with_frame_heights(tin: Tin, regions: &Regions) -> Tin {
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
    let found = axis_heights(&tin, regions, &points);
    let mut heights = tin.heights.clone();
    for (&v, height) in corners.iter().zip(found) {
        let fallback = || nearest.get(&v).map_or(f64::NAN, |n| n.1);
        heights[v as usize] = if height.is_nan() { fallback() } else { height };
    }
    for (v, (lo, hi)) in limits.into_iter().filter(|(_, (lo, hi))| lo <= hi) {
        heights[v as usize] = heights[v as usize].clamp(lo, hi);
    }
    tin.with_heights(heights)
}
