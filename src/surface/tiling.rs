//! Tiling (paper, section 3.3): the triangulated contours of a clean map with their sub-domains.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::base::bits::bits;
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::base::progress::Progress;
use crate::check::contradicted_marks;
use crate::check::{Correction, Ground, Judged, judge};
use crate::contour::{Clipped, ContourMap, Interval, clip, find_interval};
use crate::geometry::{Border, with_corners_at};
use crate::skeleton::{AxisPoint, axis_heights};
use crate::spline::WorkingGrid;
use crate::subdomains::Sheet;
use crate::subdomains::water::{Ponds, Shores, Water, lake_finding, leave_out_vanished, sea_level, settle};
use crate::subdomains::{
    Band, Frame, FrameRing, Gaps, KeptBands, Link, OpenEnd, Outline, Regions, agreeing_at_corners, close_gaps,
    contradicted_lakes, frame_ring, link_open_ends, links_at, regions, sub_domains, with_water,
};
use crate::tin::{Tin, TinInput, Triangulation, VertexKind};

/// Triangles that one task looks at.
const CHUNK: usize = 1 << 14;

/// The triangulated map: contours, spot heights and frame, without any line or point that was computed.
#[derive(Debug, Clone)]
pub struct Tiling {
    /// The map, cut to the frame.
    pub map: ContourMap,
    /// Its constrained Delaunay triangulation; corners of the frame have heights too.
    pub tin: Tin,
    /// The sub-domains of its triangles.
    pub regions: Regions,
    /// The frame's outline.
    pub frame: FrameRing,
    /// The input's vertical interval.
    pub interval: Interval,
    /// What would mend the faults that were found, for [`correct`](crate::check::correct). Their lines are those of the map as
    /// it came in where the frame is no polygon.
    pub corrections: Vec<Correction>,
    /// As [`Judged::doubted`].
    pub(crate) doubted: Vec<u32>,
    /// What closes the gaps between open ends.
    pub(crate) gaps: Gaps,
    parts: Parts,
    /// The triangulation itself, to which points can be added, until it is taken.
    pub(crate) triangulation: Triangulation,
    /// Number of its points; those that are computed come after them.
    pub(crate) given: usize,
}

/// Triangulates a clean map (see [`clean`](fn@crate::clean::clean)) and finds its sub-domains.
///
/// # Errors
/// When the map has fewer than two levels, when a contour line crosses another, or when the points have no extent.
pub fn tiling(map: ContourMap, wanted: &Frame, progress: &dyn Progress) -> Result<Report<Tiling>> {
    tiling_with_water(map, wanted, &Water::default(), progress)
}

/// [`tiling`] with lakes and the sea.
///
/// A lake whose height is not known gets that of its shore. Where contours of other levels cross or touch it, it is cut
/// back from them; what contradicts the contours around it is left out.
///
/// # Errors
/// As [`tiling`], and [`Error::Parameter`] when no contour lies at the level of the sea.
pub fn tiling_with_water(
    map: ContourMap,
    wanted: &Frame,
    water: &Water,
    progress: &dyn Progress,
) -> Result<Report<Tiling>> {
    prepare(map, wanted, water)?.tiled(water, progress)
}

/// A map in its frame, ready to be triangulated.
pub(crate) struct Prepared {
    /// The map, cut to the frame.
    pub map: ContourMap,
    /// The frame's outline.
    pub frame: FrameRing,
    /// The vertical interval.
    pub interval: Interval,
    ends: Vec<OpenEnd>,
    parts: Parts,
    findings: Vec<Finding>,
}

/// Cuts a map to its frame, and sees what has to be triangulated.
///
/// # Errors
/// When the map has fewer than two levels, or as [`tiling_with_water`] for the sea.
pub(crate) fn prepare(map: ContourMap, wanted: &Frame, water: &Water) -> Result<Prepared> {
    let frame = frame_ring(&map, wanted);
    let mut findings = Vec::new();
    let (map, frame) = match wanted {
        Frame::Polygon(polygon) => {
            if frame.area != *polygon {
                let message = "the frame polygon reaches beyond the contours; the surface ends at their convex hull";
                findings.push(Finding::general(FindingKind::FrameBeyondMap, message));
            }
            let area = with_corners_at(&map.places().collect::<Vec<_>>(), &frame.area);
            let Clipped { map, area } = clip(map, &area);
            (map, FrameRing { area })
        }
        Frame::Hull | Frame::Box => (map, frame),
    };
    let sea = sea_level(water, &map, &mut findings)?;
    let interval = find_interval(&map.contours).ok_or_else(|| too_few_levels(&map, wanted))?;
    let tolerance = frame.tolerance();
    let (ends, links) = link_open_ends(&map, &frame, tolerance);
    let frame = match wanted {
        Frame::Hull | Frame::Box => frame,
        Frame::Polygon(_) => frame.with_points(&links.iter().map(|l| l.frame).collect::<Vec<_>>()),
    };
    let is_polygon = matches!(wanted, Frame::Polygon(_));
    let on_links = links_at(&map.spots, &links, tolerance);
    for (spot, link) in map.spots.iter().zip(&on_links) {
        if let Some(link) = link.filter(|link| link.elevation != spot.z) {
            let message = format!(
                "the spot height {} m lies where the contour {} m leads on to the frame; it is left out",
                spot.z, link.elevation
            );
            let finding = Finding::at(FindingKind::SpotOnLine, spot.truncate(), message);
            findings.push(finding.of_elevations([spot.z, link.elevation]));
        }
    }
    let spots = on_links.iter().map(Option::is_none).collect();
    let parts = Parts { is_polygon, links, tolerance, spots, ponds: Ponds::default(), sea };
    Ok(Prepared { map, frame, interval, ends, parts, findings })
}

impl Prepared {
    /// Triangulates it and finds the sub-domains.
    ///
    /// # Errors
    /// When a contour line crosses another, or when the points have no extent.
    pub fn tiled(self, water: &Water, progress: &dyn Progress) -> Result<Report<Tiling>> {
        let Self { map, mut frame, interval, ends, mut parts, mut findings } = self;
        progress.start("triangulating", 0);
        let mut found = parts.triangulated(&map, &frame, &ends, &interval, &mut findings)?;
        if !water.lakes.is_empty() {
            let ground = with_frame_heights(found.tin, &found.regions, None);
            let shores =
                Shores { map: &map, links: &parts.links, frame: &frame, tin: &ground, regions: &found.regions };
            let (ponds, with_ends) = settle(&water.lakes, &shores, &mut findings)?;
            (parts.ponds, frame) = (ponds, with_ends);
            found = parts.triangulated(&map, &frame, &ends, &interval, &mut findings)?;
        }
        let Found { mut triangulation, tin, regions: sub_domains, gaps, findings: of_regions } = found;
        findings.extend(of_regions);
        let ground = Ground {
            map: &map,
            tin: &tin,
            regions: &sub_domains,
            frame: &frame,
            ends: &ends,
            links: &parts.links,
            gaps: &gaps,
        };
        let Judged { findings: of_labels, corrections, doubted } = judge(&ground);
        findings.extend(of_labels);
        findings.extend(contradicted_marks(&map, &tin, &sub_domains));
        let tin = with_frame_heights(tin, &sub_domains, None);
        progress.finish();
        let given = triangulation.input().len();
        let regions = sub_domains;
        let tiling =
            Tiling { map, tin, regions, frame, interval, corrections, doubted, gaps, parts, triangulation, given };
        Ok(Report { value: tiling, findings })
    }
}

impl Tiling {
    /// What the triangles do not tell, with the area of the triangles inside the frame.
    pub(crate) fn sheet(&self) -> Sheet<'_> {
        let tin = &self.tin;
        let doubled = |t: u32| {
            let [a, b, c] = tin.corners(t);
            (b - a).perp_dot(c - a)
        };
        // Added up in this order whatever the number of threads.
        let chunks = tin.triangles.par_chunks(CHUNK).enumerate().map(|(k, chunk)| {
            let first = (k * CHUNK) as u32;
            (first..first + chunk.len() as u32).filter(|&t| tin.is_inside(t)).map(doubled).sum::<f64>()
        });
        let area = chunks.collect::<Vec<f64>>().into_iter().sum::<f64>() / 2.0;
        Sheet::with_area(&self.map, &self.frame, self.interval, area)
    }

    /// Adds the edges that sub-domains and the frame end at and that are no lines: a finer triangulation must hold them.
    pub(crate) fn push_borders(&self, input: &mut TinInput) {
        for &[u, v] in self.gaps.bridges.iter().chain(&self.gaps.gates) {
            input.push_edge(self.tin.source[u as usize], self.tin.source[v as usize]);
        }
        for [u, v] in Outline::new(&self.tin).loose_edges() {
            input.push_edge(self.tin.source[u as usize], self.tin.source[v as usize]);
        }
    }

    /// The spot heights that agree with the contours around them.
    pub(crate) fn used_spots(&self) -> impl Iterator<Item = DVec3> {
        self.map.spots.iter().zip(&self.parts.spots).filter(|(_, used)| **used).map(|(spot, _)| *spot)
    }

    /// The same with a finer triangulation, which more points and edges were added to.
    ///
    /// Corners of the frame get the heights of `working`, if there is one.
    pub(crate) fn retriangulated(self, finer: Tin, working: Option<&WorkingGrid>) -> Self {
        let Self { map, tin, regions, frame, interval, corrections, doubted, gaps, parts, given, .. } = self;
        let kept = KeptBands::new(&tin, regions);
        let outline = Outline::new(&tin);
        // The first triangulation is a large part of the memory; with lakes it tells where they are.
        let before = (!parts.ponds.is_empty()).then_some(tin);
        let tin = outline.applied(finer).with_gaps(&gaps.bridges, &gaps.gates);
        let tin = match before {
            Some(before) => tin.with_lakes_of(&before),
            None => tin,
        };
        let is_dry = parts.ponds.is_empty() && parts.sea.is_none();
        let known = is_dry.then(|| kept.applied(&tin, sub_domains(&tin, &interval)));
        let (tin, regions) = match known {
            Some((regions, true)) => (tin, regions),
            // With water, and where parts of the frame that hold no contour are in it again.
            _ => {
                let (tin, Report { value: regions, .. }) = known_regions(tin, &interval);
                let regions = with_water(regions, &tin, &parts.ponds.heights(), parts.sea);
                let (regions, _) = kept.applied(&tin, regions);
                (tin, regions)
            }
        };
        let tin = with_frame_heights(tin, &regions, working);
        let triangulation = Triangulation::default();
        Self { map, tin, regions, frame, interval, corrections, doubted, gaps, parts, triangulation, given }
    }
}

fn too_few_levels(map: &ContourMap, frame: &Frame) -> Error {
    let in_polygon = matches!(frame, Frame::Polygon(_));
    match map.contours.first() {
        None => Error::NoContours { in_polygon },
        Some(c) => Error::TooFewLevels { lines: map.contours.len(), elevation: c.elevation, in_polygon },
    }
}

/// What is triangulated besides the contours.
#[derive(Debug, Clone)]
struct Parts {
    /// The frame is a polygon: its edges go in too, because the convex hull of all points does not follow it.
    is_polygon: bool,
    /// From open ends to the frame.
    links: Vec<Link>,
    /// Points nearer than this to each other are one.
    tolerance: f64,
    /// Which of the map's spot heights are used.
    spots: Vec<bool>,
    /// The lakes, with their shores.
    ponds: Ponds,
    /// The level of the sea.
    sea: Option<f64>,
}

/// A triangulation with its sub-domains.
struct Found {
    triangulation: Triangulation,
    tin: Tin,
    regions: Regions,
    gaps: Gaps,
    /// About the sub-domains.
    findings: Vec<Finding>,
}

impl Parts {
    /// Contours come first, so that their heights win where points coincide.
    fn input(&self, map: &ContourMap, frame: &FrameRing) -> TinInput {
        let rings: Vec<Vec<DVec2>> = frame.rings().collect();
        let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for &p in map.contours.iter().flat_map(|c| &c.points).chain(rings.iter().flatten()) {
            lo = lo.min(p);
            hi = hi.max(p);
        }
        let mut input = TinInput::new([lo, hi], self.tolerance);
        let links = self.links.iter().map(|link| (link.elevation, vec![link.end, link.frame]));
        let contours = map.contours.iter().map(|c| (c.elevation, Cow::from(&c.points)));
        let courses = contours.chain(links.map(|(level, points)| (level, Cow::from(points))));
        self.ponds.push(&mut input, courses);
        for spot in map.spots.iter().zip(&self.spots).filter(|(_, used)| **used).map(|(s, _)| s) {
            input.push(spot.truncate(), spot.z, VertexKind::Spot);
        }
        for ring in rings {
            let corners: Vec<u32> = ring.iter().map(|&c| input.push(c, f64::NAN, VertexKind::Frame)).collect();
            if self.is_polygon {
                let next = corners.iter().cycle().skip(1);
                corners.iter().zip(next).for_each(|(&a, &b)| input.push_edge(a, b));
            }
        }
        input
    }

    /// Triangulates, and leaves out spot heights and lakes until none contradicts the contours around it.
    fn triangulated(
        &mut self,
        map: &ContourMap,
        frame: &FrameRing,
        ends: &[OpenEnd],
        interval: &Interval,
        findings: &mut Vec<Finding>,
    ) -> Result<Found> {
        loop {
            let mut triangulation = Triangulation::new(self.input(map, frame))?;
            let tin = self.within_frame(triangulation.tin()?, frame);
            let gaps = close_gaps(&tin, ends, interval.step);
            let tin = self.ponds.mark(tin.with_gaps(&gaps.bridges, &gaps.gates));
            let (tin, report) = known_regions(tin, interval);
            let heights = self.ponds.heights();
            let dry = contradicted_lakes(&tin, &report.value, &heights);
            let vanished = leave_out_vanished(&mut self.ponds, &tin);
            if !dry.is_empty() || !vanished.is_empty() {
                findings.extend(vanished);
                for (lake, place, band) in dry {
                    findings.push(lake_finding(&self.ponds, lake, place, band));
                    self.ponds.leave_out(lake);
                }
                continue;
            }
            let regions = agreeing_at_corners(with_water(report.value, &tin, &heights, self.sea), &tin);
            let outside = spots_outside_bands(map, &tin, &regions);
            if outside.is_empty() {
                return Ok(Found { triangulation, tin, regions, gaps, findings: report.findings });
            }
            for (spot, finding) in outside {
                self.spots[spot] = false;
                findings.push(finding);
            }
        }
    }

    /// Takes the triangles outside a boundary polygon out of the frame.
    fn within_frame(&self, tin: Tin, frame: &FrameRing) -> Tin {
        if !self.is_polygon {
            return tin;
        }
        let border = Border::new(&frame.area);
        tin.restricted(|p| border.contains(p))
    }
}

/// The sub-domains, less parts of the frame that hold no contour: nothing is known of their heights, so they are taken out
/// of the frame.
fn known_regions(tin: Tin, interval: &Interval) -> (Tin, Report<Regions>) {
    let found = regions(&tin, interval);
    let middle = |t: u32| tin.corners(t).iter().sum::<DVec2>() / 3.0 + tin.origin;
    let unknown = found.regions.iter().filter(|r| r.levels.is_empty());
    let unknown: Vec<DVec2> = unknown.map(|r| middle(r.triangle)).collect();
    if unknown.is_empty() {
        return (tin, Report { value: found, findings: Vec::new() });
    }
    let is_known: Vec<bool> =
        (0..tin.len() as u32).map(|t| found.region(t).is_some_and(|r| !r.levels.is_empty())).collect();
    let tin = tin.only(&is_known);
    let value = regions(&tin, interval);
    let findings = unknown.into_iter().map(|place| {
        let message = "a part of the frame holds no contour; it is left without heights";
        Finding::at(FindingKind::FrameBeyondMap, place, message)
    });
    (tin, Report { value, findings: findings.collect() })
}

/// Spot heights that contradict the levels around them, by their number in the map.
fn spots_outside_bands(map: &ContourMap, tin: &Tin, regions: &Regions) -> Vec<(usize, Finding)> {
    let number: HashMap<[u64; 2], usize> = map.spots.iter().enumerate().map(|(i, s)| (bits(s.truncate()), i)).collect();
    let mut told = HashSet::new();
    let mut outside = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let Some(region) = regions.region(t) else { continue };
        for v in tin.triangles[t as usize].map(|v| v as usize) {
            if tin.kinds[v] != VertexKind::Spot {
                continue;
            }
            let p = tin.point(v as u32);
            if region.band.contains(p.z) || !told.insert(v) {
                continue;
            }
            if let Some(&spot) = number.get(&bits(p.truncate())) {
                let (lo, hi) = (region.band.lo, region.band.hi);
                let message = match region.water {
                    Some(level) => format!("spot height {} lies in water of {level}; it is left out", p.z),
                    None => format!("spot height {} lies between contours {lo} and {hi}; it is left out", p.z),
                };
                let finding = Finding::at(FindingKind::SpotOutsideBand, p.truncate(), message);
                outside.push((spot, finding.of_elevations([p.z])));
            }
        }
    }
    outside.sort_by_key(|(spot, _)| *spot);
    outside
}

/// Gives the corners of the frame heights from the contours around them. Where no contour borders the sub-domain, a
/// corner has the height of the nearest vertex that it shares a triangle with, or the middle of the band. Where two parts
/// of the frame touch, the height lies in the bands of both. Where `working` has heights, a corner has one of those.
fn with_frame_heights(tin: Tin, regions: &Regions, working: Option<&WorkingGrid>) -> Tin {
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
    for ((&v, height), region) in corners.iter().zip(found).zip(points.iter().map(|p| p.region)) {
        let band = regions.regions[region as usize].band;
        // Among other corners alone nothing tells more than the band.
        let fallback = || nearest.get(&v).map_or((band.lo + band.hi) / 2.0, |n| n.1);
        let smooth = working.map_or(f64::NAN, |w| f64::from(w.at(tin.point(v).truncate())));
        let choice = [smooth, height].into_iter().find(|h| !h.is_nan());
        heights[v as usize] = choice.unwrap_or_else(fallback);
    }
    for (v, (lo, hi)) in limits.into_iter().filter(|(_, (lo, hi))| lo <= hi && (hi - lo).is_finite()) {
        heights[v as usize] = Band { lo, hi }.strictly_inside(heights[v as usize]);
    }
    tin.with_heights(heights)
}
