//! Land and sea on both sides of a coast.
//!
//! A sub-domain at the coast with a contour above the sea is land. Across a coast, land and sea change. This decides about
//! the sub-domains without any other contour: the sea, bays that the frame cuts off, low islands, lagoons.

use std::collections::BTreeMap;

use glam::DVec2;

use super::regions::borders_of;
use super::{Band, Regions, Side};
use crate::base::error::{Finding, FindingKind};
use crate::tin::Tin;

/// What a sub-domain at the coast is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Land,
    Sea,
}

/// Makes the sea level and the land beside it higher. `coast` are the levels of coasts, metres; their contours and those of
/// the map at these levels are the coast.
///
/// Begins with land that has contours above the coast. From there each sub-domain takes the kind that most of its coast
/// with known neighbours asks for; land wins a draw. A coast with one kind on both sides is a finding.
pub(crate) fn with_coast(regions: &mut Regions, tin: &Tin, coast: &[f64]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for &level in coast {
        let kinds = kinds(regions, tin, level);
        findings.extend(contradictions(regions, tin, level, &kinds));
        for (region, kind) in regions.regions.iter_mut().zip(&kinds) {
            let is_open = region.levels.len() == 1;
            match kind {
                Some(Kind::Sea) if is_open => {
                    region.levels = vec![(level, Side::Below)];
                    region.band = Band { lo: level, hi: level };
                    region.water = Some(level);
                }
                Some(Kind::Land) if region.levels.first().is_some_and(|lowest| lowest.0 == level) => {
                    region.levels[0].1 = Side::Above;
                    region.band.lo = level;
                    if is_open {
                        region.band.hi = regions.interval.next_above(level);
                    }
                }
                _ => {}
            }
        }
    }
    findings
}

/// What each sub-domain at the coast is; `None` away from it, and without land that would decide.
fn kinds(regions: &Regions, tin: &Tin, level: f64) -> Vec<Option<Kind>> {
    let count = regions.regions.len();
    let borders = borders_of(tin, &regions.of_triangle, count);
    let known = |r: usize| {
        let levels = &regions.regions[r].levels;
        let is_at_coast = levels.iter().any(|(l, _)| *l == level);
        match levels.last() {
            Some((highest, _)) if is_at_coast && *highest > level => Some(Kind::Land),
            // Contours in the sea.
            Some(_) if is_at_coast && levels.len() > 1 => Some(Kind::Sea),
            _ => None,
        }
    };
    let mut kinds: Vec<Option<Kind>> = (0..count).map(known).collect();
    let along_coast = |r: usize| borders.of(r).iter().filter(move |border| border.level == level);
    let mut frontier: Vec<usize> = (0..count).filter(|&r| kinds[r].is_some()).collect();
    while !frontier.is_empty() {
        let others = frontier.iter().flat_map(|&r| along_coast(r).map(|border| border.other as usize));
        let mut next: Vec<usize> = others.filter(|&r| kinds[r].is_none()).collect();
        next.sort_unstable();
        next.dedup();
        let decide = |&r: &usize| {
            let mut land = 0.0;
            for border in along_coast(r) {
                match kinds[border.other as usize] {
                    Some(Kind::Land) => land -= border.length,
                    Some(Kind::Sea) => land += border.length,
                    None => {}
                }
            }
            if land >= 0.0 { Kind::Land } else { Kind::Sea }
        };
        let decided: Vec<Kind> = next.iter().map(decide).collect();
        for (&r, kind) in next.iter().zip(decided) {
            kinds[r] = Some(kind);
        }
        frontier = next;
    }
    kinds
}

/// Coast between two sub-domains.
#[derive(Default)]
struct Stretch {
    length: f64,
    /// Length and middle of the longest piece.
    longest: (f64, DVec2),
}

/// The findings about coasts that do not part land from sea, one for each pair of sub-domains.
fn contradictions(regions: &Regions, tin: &Tin, level: f64, kinds: &[Option<Kind>]) -> Vec<Finding> {
    let mut found: BTreeMap<[u32; 2], Stretch> = BTreeMap::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in (0..3).filter(|&i| tin.contour_level(t, i) == Some(level)) {
            let Some(n) = tin.inner_neighbour(t, i).filter(|&n| t < n) else { continue };
            let [a, b] = [t, n].map(|t| regions.of_triangle[t as usize]);
            if kinds[a as usize] != kinds[b as usize] {
                continue;
            }
            let [u, v] = tin.edge(t, i).map(|v| tin.positions[v as usize]);
            let stretch = found.entry([a.min(b), a.max(b)]).or_default();
            let length = u.distance(v);
            stretch.length += length;
            if length > stretch.longest.0 {
                stretch.longest = (length, (u + v) / 2.0 + tin.origin);
            }
        }
    }
    let finding = |([a, b], stretch): ([u32; 2], Stretch)| {
        let what = match (a == b, kinds[a as usize]) {
            (true, _) => "ends in the open and parts nothing",
            (false, Some(Kind::Land)) => "has land on both sides",
            (false, Some(Kind::Sea)) => "has sea on both sides",
            (false, None) => "has no contour on either side that shows which is land",
        };
        let message = format!("the coast at {level} {what}, over a length of {:.0} map units", stretch.length);
        Finding::at(FindingKind::CoastContradicted, stretch.longest.1, message).of_elevations([level])
    };
    found.into_iter().map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Interval;
    use crate::subdomains::{regions, with_water};
    use crate::tin::{TinInput, VertexKind, triangulate};

    /// Lines of a level in a frame of 200 units around the origin.
    fn map(lines: &[(f64, &[(f64, f64)])]) -> (Tin, Regions) {
        let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
        for (level, points) in lines {
            let points: Vec<DVec2> = points.iter().map(|&p| p.into()).collect();
            input.push_line(&points, *level, VertexKind::Contour);
        }
        for p in [(-100.0, -100.0), (100.0, -100.0), (100.0, 100.0), (-100.0, 100.0)] {
            input.push(p.into(), f64::NAN, VertexKind::Frame);
        }
        let tin = triangulate(input).unwrap();
        let found = regions(&tin, &Interval { step: 10.0, base: 0.0 });
        (tin, found)
    }

    fn ring(x: f64, y: f64, half: f64) -> Vec<(f64, f64)> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]
            .map(|(i, j)| (x + half * i, y + half * j))
            .to_vec()
    }

    fn water(tin: &Tin, found: &Regions, p: (f64, f64)) -> Option<f64> {
        let t = tin.locate(0, DVec2::from(p) - tin.origin).unwrap();
        let region = found.region(t).unwrap();
        assert_eq!(region.water.is_some(), region.band.lo == region.band.hi);
        assert!(region.water.is_some() || region.band.lo >= 0.0);
        region.water
    }

    #[test]
    fn a_coast_from_frame_to_frame_has_an_island_and_a_lagoon() {
        let coast = [(-20.0, -100.0), (-20.0, 100.0)];
        let hills = [(-70.0, -100.0), (-70.0, 100.0)];
        // An island without contours, a lagoon on the land, an islet in the lagoon.
        let (island, lagoon, islet) = (ring(40.0, 0.0, 20.0), ring(-45.0, 0.0, 15.0), ring(-45.0, 0.0, 5.0));
        let (tin, mut found) = map(&[(0.0, &coast), (10.0, &hills), (0.0, &island), (0.0, &lagoon), (0.0, &islet)]);
        let findings = with_coast(&mut found, &tin, &[0.0]);
        assert!(findings.is_empty(), "{findings:?}");
        let found = with_water(found, &tin, &[], None);
        let at = |x: f64| water(&tin, &found, (x, 1.0));
        assert_eq!([at(-90.0), at(-65.0), at(-45.0), at(40.0)], [None; 4], "land, islet and island");
        assert_eq!([at(-55.0), at(0.0), at(90.0)], [Some(0.0); 3], "lagoon and sea");
    }

    #[test]
    fn a_coast_that_parts_nothing_is_told() {
        let coast = [(-20.0, -100.0), (-20.0, 100.0)];
        let [hills, others] = [-70.0, 60.0].map(|x| [(x, -100.0), (x, 100.0)]);
        let (tin, mut found) = map(&[(0.0, &coast), (10.0, &hills), (10.0, &others)]);
        let findings = with_coast(&mut found, &tin, &[0.0]);
        let [finding] = &findings[..] else { panic!("{findings:?}") };
        assert!(finding.message.contains("land on both sides") && finding.message.contains("200"), "{finding}");
        assert!(finding.place.is_some_and(|p| p.x == -20.0));
        assert!(found.regions.iter().all(|region| region.water.is_none()));
    }
}
