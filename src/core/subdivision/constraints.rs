//! What is triangulated besides the contours, and a triangulation without spot heights and lakes that contradict them.

use std::borrow::Cow;

use glam::DVec2;

use super::known::known_regions;
use super::spots::spots_outside_bands;
use super::water::{WaterBodies, crossing_finding, lake_finding, leave_out_vanished};
use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::contour::{ContourMap, Interval};
use crate::geometry::Border;
use crate::subdomains::{
    FrameExtension, FrameRing, GapEdges, OpenEnd, Regions, agreeing_at_corners, close_gaps, contradicted_lakes,
    with_coast, with_open_sea, with_water,
};
use crate::tin::{Tin, TinInput, VertexKind, crossing_edges, triangulate};

/// What is triangulated besides the contours.
#[derive(Debug, Clone)]
pub(super) struct Constraints {
    /// The frame is a polygon. Its edges are triangulated too, because the convex hull of all points does not follow
    /// them.
    pub(super) is_polygon: bool,
    /// Frame extensions of open ends.
    pub(super) extensions: Vec<FrameExtension>,
    /// Points closer to each other than this count as one, map units.
    pub(super) tolerance: f64,
    /// Which of the map's spot heights are used.
    pub(super) spots: Vec<bool>,
    /// The lakes, with their shores.
    pub(super) water_bodies: WaterBodies,
    /// The level of the sea, if there is one.
    pub(super) sea: Option<f64>,
    /// The levels of coasts.
    pub(super) coast: Vec<f64>,
}

/// A triangulation with its sub-domains.
pub(super) struct Found {
    pub(super) input: TinInput,
    pub(super) tin: Tin,
    pub(super) regions: Regions,
    pub(super) gaps: GapEdges,
    /// Numbers of the contours that are in the sea and do not belong there, ascending.
    pub(super) lines_in_sea: Vec<u32>,
    /// Findings about the sub-domains.
    pub(super) findings: Vec<Finding>,
}

impl Constraints {
    /// The input of the triangulation. Contours come first: their heights win where points coincide.
    fn input(&self, map: &ContourMap, frame: &FrameRing) -> TinInput {
        let rings: Vec<Vec<DVec2>> = frame.rings().collect();
        let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for &p in map.contours.iter().flat_map(|c| &c.points).chain(rings.iter().flatten()) {
            lo = lo.min(p);
            hi = hi.max(p);
        }
        let mut input = TinInput::new([lo, hi], self.tolerance);
        let others = 2 * self.extensions.len() + map.spots.len() + rings.iter().map(Vec::len).sum::<usize>();
        input.reserve(map.vertex_count() + others);
        let extensions =
            self.extensions.iter().map(|extension| (extension.elevation, vec![extension.end, extension.frame]));
        let contours = map.contours.iter().map(|c| (c.elevation, Cow::from(&c.points)));
        let courses = contours.chain(extensions.map(|(level, points)| (level, Cow::from(points))));
        self.water_bodies.push(&mut input, courses);
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

    /// Triangulates. Leaves out spot heights and lakes that contradict the contours, until none is left.
    pub(super) fn triangulated(
        &mut self,
        map: &ContourMap,
        frame: &FrameRing,
        ends: &[OpenEnd],
        interval: &Interval,
        findings: &mut Vec<Finding>,
    ) -> Result<Found> {
        loop {
            let input = self.input(map, frame);
            let tin = triangulate(&input);
            if let Err(Error::LinesCross { place }) = &tin {
                // Without lakes, the lines were triangulated before. So one of the lines that cross is a shore.
                let crossed = self.water_bodies.crossed(*place, || crossing_edges(&input))?;
                for &(lake, place) in &crossed {
                    findings.push(crossing_finding(&self.water_bodies, lake, place));
                    self.water_bodies.leave_out(lake);
                }
                if !crossed.is_empty() {
                    continue;
                }
            }
            let tin = self.within_frame(tin?, frame);
            let gaps = close_gaps(&tin, ends, interval.step);
            let tin = self.water_bodies.mark(tin.with_gap_edges(&gaps.closures, &gaps.barriers));
            let (tin, mut report) = known_regions(tin, interval);
            let (of_coast, mut in_sea) = with_coast(&mut report.value, &tin, map, &self.coast);
            report.findings.extend(of_coast);
            if let Some(sea) = self.sea.filter(|sea| !self.coast.contains(sea)) {
                in_sea.extend(with_open_sea(&mut report.value, &tin, map, sea));
                let is_known = |k: usize| map.contours[k].elevation >= sea || in_sea.contains_key(&(k as u32));
                if !in_sea.is_empty() && (0..map.contours.len()).all(is_known) {
                    // The ground between them and the coast becomes sea all the same.
                    findings.retain(|finding| finding.kind != FindingKind::BelowSea);
                }
            }
            let lines_in_sea = in_sea.keys().copied().collect();
            report.findings.extend(in_sea.into_values());
            let heights = self.water_bodies.heights();
            let dry = contradicted_lakes(&tin, &report.value, &heights);
            let vanished = leave_out_vanished(&mut self.water_bodies, &tin);
            if !dry.is_empty() || !vanished.is_empty() {
                findings.extend(vanished);
                for (lake, place, band) in dry {
                    findings.push(lake_finding(&self.water_bodies, lake, place, band));
                    self.water_bodies.leave_out(lake);
                }
                continue;
            }
            let regions = agreeing_at_corners(with_water(report.value, &tin, &heights, self.sea), &tin);
            let outside = spots_outside_bands(map, &tin, &regions);
            if outside.is_empty() {
                return Ok(Found { input, tin, regions, gaps, lines_in_sea, findings: report.findings });
            }
            for (spot, finding) in outside {
                self.spots[spot] = false;
                findings.push(finding);
            }
        }
    }

    /// Removes the triangles outside a boundary polygon from the frame.
    fn within_frame(&self, tin: Tin, frame: &FrameRing) -> Tin {
        if !self.is_polygon {
            return tin;
        }
        let border = Border::new(&frame.area);
        tin.restricted(|p| border.contains(p))
    }
}
