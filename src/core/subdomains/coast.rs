//! Land and sea on both sides of a coast.
//!
//! A sub-domain at the coast with a contour above the sea is land. Across a coast, land and sea change. This decides about
//! the sub-domains without any other contour: the sea, bays that the frame cuts off, low islands, lagoons. Where lines
//! contradict each other, the longer ones count.

use std::collections::BTreeMap;

use glam::DVec2;

use super::land::{Kind, Shores};
use super::orient::{line_starts, piece_of};
use super::{Band, Regions, Side};
use crate::base::error::{Finding, FindingKind};
use crate::contour::ContourMap;
use crate::tin::Tin;

/// Makes the sea level and the land beside it higher. `coast` are the levels of coasts, metres; their contours and those of
/// the map at these levels are the coast. `tin` holds the map's contours before all other points.
///
/// Coasts with one kind on both sides are findings, and so are contours in the sea, by their numbers in the map.
pub(crate) fn with_coast(
    regions: &mut Regions,
    tin: &Tin,
    map: &ContourMap,
    coast: &[f64],
) -> (Vec<Finding>, BTreeMap<u32, Finding>) {
    let (mut findings, mut in_sea) = (Vec::new(), BTreeMap::new());
    for &level in coast {
        let shores = Shores::new(regions, tin, level);
        findings.extend(contradictions(regions, tin, level, &shores.kinds));
        in_sea.extend(astray(regions, tin, map, level, &shores));
        (0..regions.regions.len()).for_each(|r| settle(regions, r, level, &shores));
    }
    (findings, in_sea)
}

/// Takes contours in the sea for what they are: without them the ground around is the sea, and the ground across its coasts
/// is land. `level` is that of the coast, metres. `tin` holds the map's contours before all other points.
///
/// Coasts without such contours stay as they are. The contours are findings, by their numbers in the map.
pub(crate) fn with_open_sea(regions: &mut Regions, tin: &Tin, map: &ContourMap, level: f64) -> BTreeMap<u32, Finding> {
    let shores = Shores::new(regions, tin, level);
    let mut is_wrong = vec![false; regions.regions.len()];
    for r in (0..regions.regions.len()).filter(|&r| has_astray(&shores, r)) {
        is_wrong[shores.groups[r]] = true;
    }
    let findings = astray(regions, tin, map, level, &shores);
    for r in (0..regions.regions.len()).filter(|&r| is_wrong[shores.groups[r]]) {
        settle(regions, r, level, &shores);
    }
    findings
}

/// Whether each sub-domain is level sea with contours in it that do not belong there. `level` is that of the coast, metres.
pub(crate) fn seas_with_contours(regions: &Regions, tin: &Tin, level: f64) -> Vec<bool> {
    let shores = Shores::new(regions, tin, level);
    (0..regions.regions.len()).map(|r| has_astray(&shores, r)).collect()
}

fn has_astray(shores: &Shores, r: usize) -> bool {
    shores.is_level_sea(r) && shores.shores[r].has_others()
}

/// Gives a sub-domain the sides and the band of its kind.
fn settle(regions: &mut Regions, r: usize, level: f64, shores: &Shores) {
    let interval = regions.interval;
    let region = &mut regions.regions[r];
    match shores.kinds[r] {
        Some(Kind::Sea) if shores.is_level_sea(r) => {
            region.levels = vec![(level, Side::Below)];
            region.band = Band { lo: level, hi: level };
            region.water = Some(level);
        }
        // The contours below the sea show its ground.
        Some(Kind::Sea) if region.levels.last().is_some_and(|highest| highest.0 > level) => {
            region.levels.retain(|(of, _)| *of <= level);
            region.levels.iter_mut().for_each(|(of, side)| *side = if *of < level { Side::Above } else { Side::Below });
            region.band = Band { lo: region.levels[0].0, hi: level };
        }
        Some(Kind::Land) if region.levels.first().is_some_and(|lowest| lowest.0 == level) => {
            region.levels[0].1 = Side::Above;
            region.band.lo = level;
            if region.levels.len() == 1 {
                region.band.hi = interval.next_above(level);
            }
        }
        _ => {}
    }
}

/// The findings about contours that are in the sea, by their numbers in the map.
fn astray(regions: &Regions, tin: &Tin, map: &ContourMap, level: f64, shores: &Shores) -> BTreeMap<u32, Finding> {
    let start = line_starts(map);
    let pieces = tin.flat_map_inside(|t| {
        let (start, r) = (&start, regions.of_triangle[t as usize] as usize);
        (0..3).filter_map(move |i| {
            let of = tin.contour_level(t, i).filter(|of| shores.is_astray(r, *of, level))?;
            let [u, v] = tin.edge(t, i);
            let (line, _) = piece_of(map, tin, start, u, v)?;
            let [a, b] = [u, v].map(|v| tin.positions[v as usize]);
            Some((line, of, (a.distance(b), (a + b) / 2.0 + tin.origin)))
        })
    });
    let mut found: BTreeMap<u32, (f64, (f64, DVec2))> = BTreeMap::new();
    for (line, of, piece) in pieces {
        let longest = &mut found.entry(line).or_insert((of, piece)).1;
        if piece.0 > longest.0 {
            *longest = piece;
        }
    }
    let finding = |(line, (of, longest)): (u32, (f64, (f64, DVec2)))| {
        let feature = map.contours[line as usize].feature;
        let message = if of > level {
            format!(
                "the contour {of} m (feature {feature}) is in the sea ({level} m), without a coast around it: its coast is missing, or \
                 its elevation is wrong"
            )
        } else {
            format!("the contour {of} m (feature {feature}) is in the sea ({level} m), which is level around it")
        };
        (line, Finding::at(FindingKind::ContourInSea, longest.1, message).about(feature, of))
    };
    found.into_iter().map(finding).collect()
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
        let message = format!("the coast at {level} m {what}, over a length of {:.0} map units", stretch.length);
        Finding::at(FindingKind::CoastContradicted, stretch.longest.1, message).of_elevations([level])
    };
    found.into_iter().map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An elevation and the points of its line.
    type Line<'a> = (f64, &'a [(f64, f64)]);
    use crate::contour::{Contour, Interval};
    use crate::subdomains::{regions, with_water};
    use crate::tin::{TinInput, VertexKind, triangulate};

    /// Lines of a level in a frame of 200 units around the origin.
    fn map(lines: &[(f64, &[(f64, f64)])]) -> (ContourMap, Tin, Regions) {
        let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
        for (level, points) in lines {
            let points: Vec<DVec2> = points.iter().map(|&p| p.into()).collect();
            input.push_line(&points, *level, VertexKind::Contour);
        }
        for p in [(-100.0, -100.0), (100.0, -100.0), (100.0, 100.0), (-100.0, 100.0)] {
            input.push(p.into(), f64::NAN, VertexKind::Frame);
        }
        let tin = triangulate(input).unwrap();
        let found = regions(&tin, &Interval { step: 10.0, base: 0.0, rounding: 0.0 });
        let contour = |(k, (elevation, points)): (u64, &Line)| Contour {
            elevation: *elevation,
            points: points.iter().map(|&p| p.into()).collect(),
            feature: k.into(),
        };
        let contours = (1..).zip(lines).map(contour).collect();
        (ContourMap { contours, ..ContourMap::default() }, tin, found)
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
        let (map, tin, mut found) =
            map(&[(0.0, &coast), (10.0, &hills), (0.0, &island), (0.0, &lagoon), (0.0, &islet)]);
        let (findings, _) = with_coast(&mut found, &tin, &map, &[0.0]);
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
        let (map, tin, mut found) = map(&[(0.0, &coast), (10.0, &hills), (10.0, &others)]);
        let (findings, _) = with_coast(&mut found, &tin, &map, &[0.0]);
        let [finding] = &findings[..] else { panic!("{findings:?}") };
        assert!(finding.message.contains("land on both sides") && finding.message.contains("200"), "{finding}");
        assert!(finding.place.is_some_and(|p| p.x == -20.0));
        assert!(found.regions.iter().all(|region| region.water.is_none()));
    }

    /// Two islands of 0 and 10 m, a rock of 0 m, and `others` around the sea between them.
    fn islands(others: &[(f64, &[(f64, f64)])]) -> (ContourMap, Tin, Regions) {
        let [west, east] = [-60.0, 60.0].map(|x| [ring(x, 0.0, 30.0), ring(x, 0.0, 20.0)]);
        let rock = ring(0.0, -50.0, 8.0);
        let mut lines: Vec<(f64, &[(f64, f64)])> =
            vec![(0.0, &west[0]), (10.0, &west[1]), (0.0, &east[0]), (10.0, &east[1]), (0.0, &rock)];
        lines.extend(others);
        map(&lines)
    }

    /// Features of the contours in the sea.
    fn told(findings: &BTreeMap<u32, Finding>) -> Vec<u64> {
        assert!(findings.values().all(|f| f.kind == FindingKind::ContourInSea && f.place.is_some()), "{findings:?}");
        findings.values().map(|f| f.features[0].number()).collect()
    }

    #[test]
    fn contours_in_the_sea_do_not_make_it_land() {
        let at = |x: f64| ring(x, 50.0, 6.0);
        let (one, two, three) = (at(-40.0), at(0.0), at(40.0));
        let cases: [(&[Line], &[u64]); 6] = [
            (&[], &[]),
            (&[(10.0, &one)], &[6]),
            (&[(10.0, &one), (10.0, &two), (10.0, &three)], &[6, 7, 8]),
            (&[(20.0, &two)], &[6]),
            (&[(-10.0, &two)], &[6]),
            (&[(10.0, &one), (-10.0, &two)], &[6, 7]),
        ];
        for (others, features) in cases {
            for by_level in [false, true] {
                let (map, tin, mut found) = islands(others);
                let (findings, in_sea) = match by_level {
                    false => with_coast(&mut found, &tin, &map, &[0.0]),
                    true => (Vec::new(), with_open_sea(&mut found, &tin, &map, 0.0)),
                };
                assert_eq!((findings, told(&in_sea)), (Vec::new(), features.to_vec()));
                let found = with_water(found, &tin, &[], Some(0.0));
                let at = |x: f64, y: f64| {
                    let t = tin.locate(0, DVec2::new(x, y) - tin.origin).unwrap();
                    let region = found.region(t).unwrap();
                    (region.water, region.band.lo)
                };
                assert_eq!([at(90.0, 90.0), at(0.0, 0.0), at(0.0, 30.0)], [(Some(0.0), 0.0); 3], "{others:?}");
                assert_eq!([at(0.0, -50.0), at(-85.0, 0.0), at(85.0, 0.0)], [(None, 0.0); 3], "{others:?}");
                for (level, ring) in others {
                    let (x, y) = ring[0];
                    let lo = if *level > 0.0 { *level } else { level - 10.0 };
                    assert_eq!(at(x + 6.0, y + 6.0), (None, lo), "inside {level}");
                }
            }
        }
    }

    #[test]
    fn contours_that_show_the_ground_of_the_sea_stay() {
        // Around both islands, and from frame to frame.
        let deep = ring(0.0, 0.0, 95.0);
        let across = [(-100.0, 70.0), (100.0, 70.0)];
        for others in [&[(-10.0, &deep[..])], &[(-10.0, &across[..])]] {
            let (map, tin, mut found) = islands(others);
            let before = found.regions.clone();
            assert_eq!(with_coast(&mut found, &tin, &map, &[0.0]), (Vec::new(), BTreeMap::new()));
            let sea = found.region(tin.locate(0, DVec2::new(0.0, 5.0) - tin.origin).unwrap()).unwrap();
            assert_eq!((sea.water, sea.band), (None, Band { lo: -10.0, hi: 0.0 }));
            found.regions = before.clone();
            assert!(with_open_sea(&mut found, &tin, &map, 0.0).is_empty());
            assert_eq!(found.regions, before);
        }
    }

    #[test]
    fn a_coast_at_the_frame_and_a_lagoon_have_land_behind_them_despite_a_contour_in_the_sea() {
        let coast = [(-20.0, -100.0), (-20.0, 100.0)];
        let hills = [(-70.0, -100.0), (-70.0, 100.0)];
        let (lagoon, islet) = (ring(-45.0, 0.0, 15.0), ring(50.0, 0.0, 8.0));
        let (map, tin, mut found) = map(&[(0.0, &coast), (10.0, &hills), (0.0, &lagoon), (10.0, &islet)]);
        let (findings, in_sea) = with_coast(&mut found, &tin, &map, &[0.0]);
        assert_eq!((findings, told(&in_sea)), (Vec::new(), vec![4]));
        let at = |x: f64| water(&tin, &found, (x, 1.0));
        assert_eq!([at(-90.0), at(-65.0), at(50.0)], [None; 3], "land and islet");
        assert_eq!([at(-45.0), at(0.0), at(90.0)], [Some(0.0); 3], "lagoon and sea");
    }
}
