//! Sub-domains with water: lakes cut pieces out of them, the sea takes whole ones.
//!
//! Bands are found without the water, because a shore is no contour. It may touch neighbouring levels, and does not say
//! on which side the ground lies. Only after that are sub-domains split along the shores.

use std::collections::BTreeSet;

use glam::DVec2;

use super::{Band, Region, Regions, Side};
use crate::tin::{NONE, Tin};

/// Lakes that contradict the contours: number, a point in the lake, and the band of the sub-domain around it. The
/// height of such a lake lies outside the band, or its shore is open and its water reaches a contour of another level.
/// `regions` are the sub-domains without water, `heights` those of the lakes by their numbers.
pub fn contradicted_lakes(tin: &Tin, regions: &Regions, heights: &[f64]) -> Vec<(u32, DVec2, Band)> {
    let mut seen = BTreeSet::new();
    let mut outside = Vec::new();
    for t in 0..tin.len() as u32 {
        let (Some(lake), Some(region)) = (tin.lake(t), regions.region(t)) else { continue };
        let height = heights[lake as usize];
        let is_open = || (0..3).filter_map(|i| tin.contour_level(t, i)).any(|level| level != height);
        if (!region.band.contains(height) || is_open()) && seen.insert(lake) {
            let middle = tin.corners(t).iter().sum::<DVec2>() / 3.0 + tin.origin;
            outside.push((lake, middle, region.band));
        }
    }
    outside.sort_by_key(|(lake, ..)| *lake);
    outside
}

/// Splits the sub-domains along the shores of lakes. Those that border only on the coast, from below, become the sea.
///
/// Water has a band of one height. Land beside water does not lie below the lowest shore, unless a contour below bounds
/// it. `heights` are those of the lakes by their numbers, `sea` is the level of the coast.
pub fn with_water(regions: Regions, tin: &Tin, heights: &[f64], sea: Option<f64>) -> Regions {
    let mut regions = if heights.is_empty() { regions } else { split_at_shores(&regions, tin, heights) };
    if let Some(sea) = sea {
        for region in regions.regions.iter_mut().filter(|r| r.levels[..] == [(sea, Side::Below)]) {
            region.water = Some(sea);
            region.band = Band { lo: sea, hi: sea };
        }
    }
    regions
}

fn split_at_shores(whole: &Regions, tin: &Tin, heights: &[f64]) -> Regions {
    let mut of_triangle = vec![NONE; tin.len()];
    let mut regions = Vec::new();
    let mut stack = Vec::new();
    for first in 0..tin.len() as u32 {
        let Some(parent) = whole.region(first) else { continue };
        if of_triangle[first as usize] != NONE {
            continue;
        }
        let id = regions.len() as u32;
        let mut border = PieceBorder::default();
        of_triangle[first as usize] = id;
        stack.push(first);
        while let Some(t) = stack.pop() {
            for i in 0..3 {
                border.add(tin, t, i);
                if let Some(n) = tin.across(t, i)
                    && of_triangle[n as usize] == NONE
                {
                    of_triangle[n as usize] = id;
                    stack.push(n);
                }
            }
        }
        let water = tin.lake(first).map(|lake| heights[lake as usize]).or(parent.water);
        regions.push(border.region(parent, first, water));
    }
    Regions { of_triangle, regions, interval: whole.interval }
}

/// The border of a piece of sub-domain: what is on it.
#[derive(Default)]
struct PieceBorder {
    levels: Vec<f64>,
    shores: Vec<f64>,
    has_barrier: bool,
}

impl PieceBorder {
    fn add(&mut self, tin: &Tin, t: u32, i: usize) {
        let insert = |levels: &mut Vec<f64>, level: f64| {
            if let Err(at) = levels.binary_search_by(|l| l.total_cmp(&level)) {
                levels.insert(at, level);
            }
        };
        if let Some(level) = tin.contour_level(t, i) {
            insert(&mut self.levels, level);
        } else if tin.is_barrier(t, i) {
            tin.edge(t, i).iter().for_each(|&v| insert(&mut self.levels, tin.heights[v as usize]));
            self.has_barrier = true;
        }
        if tin.is_shore(t, i) {
            insert(&mut self.shores, tin.heights[tin.edge(t, i)[0] as usize]);
        }
    }

    /// The sub-domain inside this border; `parent` is the whole one that it is a piece of.
    fn region(self, parent: &Region, triangle: u32, water: Option<f64>) -> Region {
        let mut levels: Vec<(f64, Side)> =
            parent.levels.iter().copied().filter(|(level, _)| self.levels.contains(level)).collect();
        let mut band = parent.band;
        if let Some(height) = water {
            band = Band { lo: height, hi: height };
        } else if let Some(&lowest) = self.shores.first() {
            // Where contours are missing, ground can count as below a level although the shore lies above that level.
            if levels.iter().all(|(level, side)| *side == Side::Below && lowest <= *level) {
                band.lo = band.lo.max(lowest).min(band.hi);
            }
            for &shore in &self.shores {
                if levels.iter().all(|(level, _)| *level != shore) {
                    levels.push((shore, Side::Above));
                }
            }
            levels.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Region { band, levels, triangle, outer: parent.outer && self.has_barrier, water }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Interval;
    use crate::subdomains::regions;
    use crate::tin::{TinInput, VertexKind, triangulate};

    const TEN: Interval = Interval { step: 10.0, base: 0.0, rounding: 0.0 };

    fn square(input: &mut TinInput, half: f64, height: f64, kind: VertexKind) {
        let ring = [(-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)].map(DVec2::from);
        input.push_line(&ring, height, kind);
    }

    #[test]
    fn a_lake_with_an_island_parts_a_hollow() {
        let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
        for (half, height) in [(90.0, 110.0), (60.0, 100.0)] {
            square(&mut input, half, height, VertexKind::Contour);
        }
        for half in [30.0, 10.0] {
            square(&mut input, half, 94.0, VertexKind::Shore);
        }
        let in_lake = |p: DVec2| (10.0..30.0).contains(&p.abs().max_element()).then_some(0);
        let tin = triangulate(input).unwrap().with_lakes(in_lake);
        let whole = regions(&tin, &TEN);
        assert_eq!(whole.regions.len(), 2);
        assert!(contradicted_lakes(&tin, &whole, &[94.0]).is_empty());
        assert_eq!(contradicted_lakes(&tin, &whole, &[80.0]).len(), 1);
        let spilt = tin.clone().with_lakes(|p| (p.abs().max_element() < 60.0).then_some(0));
        assert_eq!(contradicted_lakes(&spilt, &whole, &[94.0]).len(), 1);
        assert!(contradicted_lakes(&spilt, &whole, &[100.0]).is_empty());
        let found = with_water(whole, &tin, &[94.0], None);
        let at = |x: f64| {
            let t = tin.locate(0, DVec2::new(x, 0.5) - tin.origin).unwrap();
            let region = found.region(t).unwrap();
            (region.band.lo, region.band.hi, region.water)
        };
        assert_eq!(at(75.0), (100.0, 110.0, None));
        assert_eq!(at(45.0), (94.0, 100.0, None));
        assert_eq!(at(20.0), (94.0, 94.0, Some(94.0)));
        assert_eq!(at(5.0), (94.0, 100.0, None));
    }

    #[test]
    fn a_shore_above_a_contour_is_not_the_lowest_ground() {
        let border = || PieceBorder { levels: vec![0.0, 30.0], shores: vec![17.5], has_barrier: false };
        let land = |levels: Vec<(f64, Side)>, lo: f64| {
            let parent = Region { band: Band { lo, hi: 30.0 }, levels, triangle: 0, outer: false, water: None };
            border().region(&parent, 0, None).band
        };
        // Where contours are missing, ground from 0 to 30 can count as below both levels.
        assert_eq!(land(vec![(0.0, Side::Below), (30.0, Side::Below)], -10.0).lo, -10.0);
        assert_eq!(land(vec![(30.0, Side::Below)], 20.0).lo, 20.0);
        assert_eq!(land(vec![(30.0, Side::Below)], 10.0).lo, 17.5);
    }

    #[test]
    fn the_sea_takes_what_lies_below_its_coast_alone() {
        let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
        for (half, height) in [(50.0, 0.0), (20.0, 10.0)] {
            square(&mut input, half, height, VertexKind::Contour);
        }
        for p in [(-90.0, -90.0), (90.0, -90.0), (90.0, 90.0), (-90.0, 90.0)] {
            input.push(p.into(), f64::NAN, VertexKind::Frame);
        }
        let tin = triangulate(input).unwrap();
        let found = with_water(regions(&tin, &TEN), &tin, &[], Some(0.0));
        let water: Vec<_> = found.regions.iter().filter(|r| r.water == Some(0.0)).collect();
        assert_eq!(water.len(), 1);
        assert_eq!(water[0].band, Band { lo: 0.0, hi: 0.0 });
    }
}
