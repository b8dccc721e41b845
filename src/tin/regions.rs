//! Sub-domains and their bands (paper, section 3.2, for open contours too).
//!
//! A sub-domain is what a flood over the triangulation reaches without crossing a contour; the frame closes it where
//! contours run off the map. Two levels on its border give its band. Where there is only one, the side is known from the
//! neighbour: crossing a contour changes the side.

use glam::DVec2;

use super::{NONE, Tin};
use crate::contour::Interval;
use crate::error::{Finding, FindingKind, Report};

/// Sub-domains whose levels are further apart than so many intervals hold a place where contours are missing.
const WIDE: f64 = 1.5;

/// How the band of a sub-domain is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Two or more levels on the border: the ground lies between the lowest and the highest.
    Between,
    /// One level on the border, the ground lies above it (a peak, a ridge).
    Above,
    /// One level on the border, the ground lies below it (a pit, a valley).
    Below,
}

/// The two levels that all heights of a sub-domain lie between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower level, metres.
    pub lo: f64,
    /// Upper level, metres.
    pub hi: f64,
    /// How it is known.
    pub side: Side,
}

impl Band {
    /// The height moved strictly inside the band, at least a thousandth of the band's width from both levels.
    pub fn strictly_inside(&self, height: f64) -> f64 {
        let margin = 1e-3 * (self.hi - self.lo);
        height.clamp(self.lo + margin, self.hi - margin)
    }

    /// Whether the height lies in the band, the levels included.
    pub fn contains(&self, height: f64) -> bool {
        self.lo <= height && height <= self.hi
    }
}

/// One sub-domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// The levels around its heights.
    pub band: Band,
    /// Lowest level on its border.
    pub lowest: f64,
    /// Highest level on its border.
    pub highest: f64,
    /// One of its triangles.
    pub triangle: u32,
    /// Whether it lies between the frame and a ragged outline of the contours: outside their reach, with several levels
    /// around it and no order among them.
    pub outer: bool,
}

/// The sub-domains of a triangulation.
#[derive(Debug, Clone)]
pub struct Regions {
    /// Sub-domain of each triangle, [`NONE`] outside the frame.
    pub of_triangle: Vec<u32>,
    /// The sub-domains, numbered by their first triangle.
    pub regions: Vec<Region>,
}

impl Regions {
    /// The sub-domain that triangle `t` lies in, none outside the frame.
    pub fn region(&self, t: u32) -> Option<&Region> {
        self.regions.get(self.of_triangle[t as usize] as usize)
    }
}

/// Finds the sub-domains, their bands, and where neighbouring levels contradict each other.
///
/// `interval` gives the next level above a peak's or below a pit's last contour.
pub fn regions(tin: &Tin, interval: &Interval) -> Report<Regions> {
    let (of_triangle, mut regions) = flood(tin, interval);
    let borders = Borders::new(tin, &of_triangle, regions.len());
    propagate(&mut regions, &borders, interval);
    let findings = contradictions(tin, &of_triangle, &regions, &borders, interval);
    Report { value: Regions { of_triangle, regions }, findings }
}

/// Numbers the connected components and collects the levels on their borders.
fn flood(tin: &Tin, interval: &Interval) -> (Vec<u32>, Vec<Region>) {
    let mut of_triangle = vec![NONE; tin.len()];
    let mut regions = Vec::new();
    let mut stack = Vec::new();
    for first in 0..tin.len() as u32 {
        if of_triangle[first as usize] != NONE || !tin.is_inside(first) {
            continue;
        }
        let id = regions.len() as u32;
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut at_frame, mut at_gate) = (false, false);
        of_triangle[first as usize] = id;
        stack.push(first);
        while let Some(t) = stack.pop() {
            for i in 0..3 {
                if let Some(level) = tin.contour_level(t, i) {
                    lowest = lowest.min(level);
                    highest = highest.max(level);
                    continue;
                }
                if tin.is_gate(t, i) {
                    for level in tin.edge(t, i).map(|v| tin.heights[v as usize]) {
                        lowest = lowest.min(level);
                        highest = highest.max(level);
                    }
                    at_gate = true;
                    continue;
                }
                match tin.inner_neighbour(t, i) {
                    Some(n) if of_triangle[n as usize] == NONE => {
                        of_triangle[n as usize] = id;
                        stack.push(n);
                    }
                    Some(_) => {}
                    None => at_frame = true,
                }
            }
        }
        let band = Band { lo: lowest, hi: highest, side: Side::Between };
        let outer = at_frame && at_gate && highest - lowest > WIDE * interval.step;
        regions.push(Region { band, lowest, highest, triangle: first, outer });
    }
    (of_triangle, regions)
}

/// A piece of contour between two sub-domains, seen from one of them.
#[derive(Debug, Clone, Copy)]
struct Border {
    other: u32,
    level: f64,
    length: f64,
    place: DVec2,
}

/// The borders of every sub-domain with its neighbours, in compressed rows.
struct Borders {
    start: Vec<u32>,
    borders: Vec<Border>,
}

impl Borders {
    fn new(tin: &Tin, of_triangle: &[u32], count: usize) -> Self {
        let edges = || {
            (0..tin.len() as u32).filter(|&t| tin.is_inside(t)).flat_map(move |t| {
                (0..3).filter_map(move |i| {
                    let level = tin.contour_level(t, i)?;
                    let other = of_triangle[tin.inner_neighbour(t, i)? as usize];
                    let own = of_triangle[t as usize];
                    (own != other).then_some((own, other, level, t, i))
                })
            })
        };
        let mut start = vec![0u32; count + 1];
        for (own, ..) in edges() {
            start[own as usize + 1] += 1;
        }
        for r in 0..count {
            start[r + 1] += start[r];
        }
        let mut next = start.clone();
        let empty = Border { other: NONE, level: 0.0, length: 0.0, place: DVec2::ZERO };
        let mut borders = vec![empty; start[count] as usize];
        for (own, other, level, t, i) in edges() {
            let [u, v] = tin.edge(t, i).map(|v| tin.positions[v as usize]);
            let slot = &mut next[own as usize];
            borders[*slot as usize] = Border { other, level, length: u.distance(v), place: u.midpoint(v) + tin.origin };
            *slot += 1;
        }
        Self { start, borders }
    }

    fn of(&self, region: u32) -> &[Border] {
        let r = region as usize;
        &self.borders[self.start[r] as usize..self.start[r + 1] as usize]
    }
}

/// The side of a level that a sub-domain lies on, if its own border tells.
pub fn side_of(region: &Region, level: f64) -> Option<Side> {
    match region.band.side {
        Side::Between if level == region.lowest => Some(Side::Above),
        Side::Between if level == region.highest => Some(Side::Below),
        Side::Between => None,
        side => Some(side),
    }
}

/// Gives every sub-domain of one level its side, outwards from those of two levels.
///
/// The longer common border wins where neighbours disagree. Sub-domains that nothing reaches lie above their level.
fn propagate(regions: &mut [Region], borders: &Borders, interval: &Interval) {
    let mut known: Vec<bool> = regions.iter().map(|r| r.lowest < r.highest).collect();
    let mut frontier: Vec<u32> = (0..regions.len() as u32).filter(|&r| known[r as usize]).collect();
    while !frontier.is_empty() {
        let mut next: Vec<u32> = frontier
            .iter()
            .flat_map(|&r| borders.of(r).iter().map(|b| b.other))
            .filter(|&r| !known[r as usize])
            .collect();
        next.sort_unstable();
        next.dedup();
        let sides: Vec<(u32, f64)> = next
            .iter()
            .map(|&r| {
                let votes = borders.of(r).iter().filter(|b| known[b.other as usize]).map(|b| {
                    match side_of(&regions[b.other as usize], b.level) {
                        Some(Side::Above) => -b.length,
                        Some(Side::Below) => b.length,
                        _ => 0.0,
                    }
                });
                (r, votes.sum())
            })
            .collect();
        for (r, above) in sides {
            known[r as usize] = true;
            set_side(&mut regions[r as usize], above >= 0.0, interval);
        }
        frontier = next;
    }
    for (region, _) in regions.iter_mut().zip(&known).filter(|(_, known)| !**known) {
        set_side(region, true, interval);
    }
}

fn set_side(region: &mut Region, above: bool, interval: &Interval) {
    let level = region.lowest;
    region.band = if !level.is_finite() {
        // No contour borders it: it can only be all of a part of the frame that holds no contour.
        Band { lo: f64::NEG_INFINITY, hi: f64::INFINITY, side: Side::Between }
    } else if above {
        Band { lo: level, hi: interval.next_above(level), side: Side::Above }
    } else {
        Band { lo: interval.next_below(level), hi: level, side: Side::Below }
    };
}

/// Skipped levels and contours with the same side on both sides.
fn contradictions(
    tin: &Tin,
    of_triangle: &[u32],
    regions: &[Region],
    borders: &Borders,
    interval: &Interval,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let gap = |r: &Region| r.highest - r.lowest;
    for (id, region) in regions.iter().enumerate() {
        if region.outer {
            continue;
        }
        if gap(region) > WIDE * interval.step {
            findings.push(Finding::at(
                FindingKind::SkippedLevel,
                steepest_place(tin, of_triangle, id as u32, region.triangle),
                format!(
                    "contours {} and {} are neighbours: a contour between them is missing, broken or mislabelled",
                    region.lowest, region.highest
                ),
            ));
            continue;
        }
        let mut told = Vec::new();
        for border in borders.of(id as u32).iter().filter(|b| b.other > id as u32) {
            let other = &regions[border.other as usize];
            let sides = (side_of(region, border.level), side_of(other, border.level));
            if gap(other) > WIDE * interval.step || told.contains(&(border.other, border.level.to_bits())) {
                continue;
            }
            if let (Some(a), Some(b)) = sides
                && a == b
            {
                told.push((border.other, border.level.to_bits()));
                let side = if a == Side::Above { "above" } else { "below" };
                findings.push(Finding::at(
                    FindingKind::BandContradiction,
                    border.place,
                    format!(
                        "the ground on both sides of contour {} lies {side} it: a label may be wrong",
                        border.level
                    ),
                ));
            }
        }
    }
    findings
}

/// Where the sub-domain's lowest and highest level meet in a triangle, or else its first triangle.
fn steepest_place(tin: &Tin, of_triangle: &[u32], region: u32, first: u32) -> DVec2 {
    let range = |t: u32| {
        let h = tin.corner_heights(t);
        h[0].max(h[1]).max(h[2]) - h[0].min(h[1]).min(h[2])
    };
    let mut seen = std::collections::HashSet::from([first]);
    let (mut stack, mut best) = (vec![first], first);
    while let Some(t) = stack.pop() {
        if range(t) > range(best) {
            best = t;
        }
        for n in (0..3).filter_map(|i| tin.across(t, i)) {
            if of_triangle[n as usize] == region && seen.insert(n) {
                stack.push(n);
            }
        }
    }
    let [a, b, c] = tin.corners(best);
    (a + b + c) / 3.0 + tin.origin
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::{TinInput, VertexKind, triangulate};

    const TEN: Interval = Interval { step: 10.0, base: 0.0 };

    /// Square rings (half side, height) around one centre.
    fn rings(squares: &[(f64, f64)]) -> Tin {
        let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
        for &(h, z) in squares {
            let ring = [(-h, -h), (h, -h), (h, h), (-h, h), (-h, -h)].map(DVec2::from);
            input.push_line(&ring, z, VertexKind::Contour);
        }
        triangulate(input).unwrap()
    }

    fn band_at(tin: &Tin, regions: &Regions, p: DVec2) -> Band {
        let inside = |t: u32| {
            let [a, b, c] = tin.corners(t);
            [(a, b), (b, c), (c, a)].iter().all(|(u, v)| (*v - *u).perp_dot(p - *u) >= 0.0)
        };
        let t = (0..tin.len() as u32).find(|&t| inside(t)).unwrap();
        regions.region(t).unwrap().band
    }

    #[test]
    fn a_hill_has_a_peak_above_and_a_crater_a_floor_below() {
        let hill = rings(&[(90.0, 100.0), (60.0, 110.0), (30.0, 120.0)]);
        let report = regions(&hill, &TEN);
        assert!(report.findings.is_empty());
        let band = |x: f64| band_at(&hill, &report.value, DVec2::new(x, 1.0));
        assert_eq!(band(75.0), Band { lo: 100.0, hi: 110.0, side: Side::Between });
        assert_eq!(band(10.0), Band { lo: 120.0, hi: 130.0, side: Side::Above });

        let crater = rings(&[(90.0, 100.0), (60.0, 110.0), (45.0, 110.0), (30.0, 100.0)]);
        let report = regions(&crater, &TEN);
        assert!(report.findings.is_empty());
        let band = |x: f64| band_at(&crater, &report.value, DVec2::new(x, 1.0));
        assert_eq!(band(50.0), Band { lo: 110.0, hi: 120.0, side: Side::Above });
        assert_eq!(band(40.0), Band { lo: 100.0, hi: 110.0, side: Side::Between });
        assert_eq!(band(10.0), Band { lo: 90.0, hi: 100.0, side: Side::Below });
    }

    #[test]
    fn a_missing_contour_is_told_with_its_place() {
        let tin = rings(&[(90.0, 100.0), (60.0, 110.0), (30.0, 140.0)]);
        let findings = regions(&tin, &TEN).findings;
        assert_eq!(findings.len(), 1);
        assert_eq!(findings[0].kind, FindingKind::SkippedLevel);
        let place = findings[0].place.unwrap().abs().max_element();
        assert!((30.0..=60.0).contains(&place), "{place}");
    }

    #[test]
    fn a_wrong_label_contradicts_its_neighbours() {
        let tin = rings(&[(90.0, 100.0), (60.0, 110.0), (45.0, 100.0), (30.0, 110.0)]);
        // 110 between two lines of 100 is a ridge, drawn once: its two sides are both below it.
        let findings = regions(&tin, &TEN).findings;
        assert!(findings.iter().any(|f| f.kind == FindingKind::BandContradiction), "{findings:?}");
    }
}
