//! Bands of single triangles, where the band of the sub-domain is too wide to be of use.
//!
//! At a broken contour the ground on both sides is one sub-domain. A line with a wrong elevation gives its two
//! sub-domains another level. Both make the band wide, even kilometres away. But a triangle with corners on two levels
//! lies between those levels, and most likely the ground beside it does too. A surveyed height, of a spot height or of a
//! break line, tells the same: the ground there lies between the levels around it.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use foldhash::HashMap;
use glam::DVec2;

use super::regions::WIDE;
use super::{Band, Regions};
use crate::base::{Sure, parallel};
use crate::contour::Interval;
use crate::tin::{NONE, Tin, VertexKind};

/// Narrower bands for triangles of sub-domains that are wider than one interval. A triangle with corners on two levels, or
/// with a corner whose height is surveyed, lies between the levels at its corners. Any other takes the band of the nearest
/// such triangle whose band reaches to the contours around both. The band of a triangle holds the heights that are `given`
/// at its corners, also of streams. Bands that would not be narrower are left out. Triangles with a corner that `is_wrong`
/// (a vertex of a line with a wrong elevation) keep the band of the sub-domain.
pub(crate) fn local_bands(
    tin: &Tin,
    regions: &Regions,
    is_wrong: impl Fn(u32) -> bool + Sync,
    given: impl Fn(u32) -> Option<(f64, Sure)> + Sync,
) -> HashMap<u32, Band> {
    let near = WIDE * regions.interval.step;
    let is_wide = |t: u32| {
        tin.is_inside(t)
            && regions
                .region(t)
                .is_some_and(|r| r.water.is_none() && r.levels.len() > 2 && r.band.hi - r.band.lo > near)
    };
    let is_beside_wrong = |t: u32| tin.triangles[t as usize].into_iter().any(&is_wrong);
    let surveyed = |v: u32| given(v).filter(|(_, sure)| *sure >= Sure::Surveyed);
    let at_corner = |v: u32| level(tin, v).or_else(|| Some(between_levels(&regions.interval, surveyed(v)?.0)));
    let corner_band = |t: u32| {
        let band = tin.triangles[t as usize].into_iter().filter_map(at_corner).reduce(Band::union)?;
        (band.lo < band.hi).then_some(band)
    };
    // Most maps have few of these triangles. So they are known by their places in this list.
    let wide = |t: usize| Some(t as u32).filter(|&t| is_wide(t) && !is_beside_wrong(t));
    let wide: Vec<u32> = parallel::flat_map(tin.len(), wide);
    let known = |k: usize| Some((k, corner_band(wide[k])?));
    let known: Vec<(usize, Band)> = parallel::flat_map(wide.len(), known);
    if known.is_empty() {
        return HashMap::default();
    }
    let mut place = vec![NONE; tin.len()];
    wide.iter().enumerate().for_each(|(k, &t)| place[t as usize] = k as u32);
    // Nothing about a band passes through a contour.
    let is_next = |t: u32, n: u32| regions.of_triangle[t as usize] == regions.of_triangle[n as usize];
    let next = |k: usize| {
        let t = wide[k];
        let across = (0..3).filter_map(move |i| tin.across(t, i)).filter(move |&n| is_next(t, n));
        across.map(|n| place[n as usize]).filter(|&k| k != NONE).map(|k| k as usize)
    };
    let levels = levels_around(tin, &wide, next);
    // A band that does not reach to the contours around a triangle is not its own.
    let fits = |k: usize, band: Band| levels[k].is_none_or(|at| band.lo <= at.lo && at.hi <= band.hi);
    let nearest = nearest_known((tin, &wide), &known, next, fits);
    let narrower = |k: usize| {
        let t = wide[k];
        let (_, band) = known.get(nearest[k] as usize)?;
        let whole = regions.region(t)?.band;
        let at_corners = tin.triangles[t as usize].into_iter().filter_map(&given);
        let wide = at_corners.map(|(height, _)| between_levels(&regions.interval, height)).fold(*band, Band::union);
        let band = Band { lo: wide.lo.max(whole.lo), hi: wide.hi.min(whole.hi) };
        (band.lo < band.hi && band != whole).then_some((t, band))
    };
    parallel::flat_map(wide.len(), narrower).into_iter().collect()
}

/// The level of a vertex of a contour, as a band.
fn level(tin: &Tin, v: u32) -> Option<Band> {
    let height = tin.heights[v as usize];
    (tin.kinds[v as usize] == VertexKind::Contour).then_some(Band { lo: height, hi: height })
}

/// The levels of the contours at the corners of each of these triangles, and elsewhere those at the nearest triangle with such
/// corners, counted in triangles. `next` gives the triangles beside one, by their places in the list.
fn levels_around<N: Iterator<Item = usize>>(
    tin: &Tin,
    triangles: &[u32],
    next: impl Fn(usize) -> N,
) -> Vec<Option<Band>> {
    let of_corners = |&t: &u32| tin.triangles[t as usize].into_iter().filter_map(|v| level(tin, v)).reduce(Band::union);
    let mut levels: Vec<Option<Band>> = parallel::map_each(triangles, of_corners);
    let mut open: VecDeque<usize> = (0..levels.len()).filter(|&k| levels[k].is_some()).collect();
    while let Some(k) = open.pop_front() {
        for n in next(k) {
            if levels[n].is_none() {
                levels[n] = levels[k];
                open.push_back(n);
            }
        }
    }
    levels
}

/// For each of these triangles: which of those `known` is the nearest whose band fits it and all triangles on the way. The way
/// runs through the middles of the triangles. `next` gives the triangles beside one. Triangles are known by their places in the
/// list.
fn nearest_known<N: Iterator<Item = usize>>(
    (tin, triangles): (&Tin, &[u32]),
    known: &[(usize, Band)],
    next: impl Fn(usize) -> N,
    fits: impl Fn(usize, Band) -> bool,
) -> Vec<u32> {
    let middle = |k: usize| tin.corners(triangles[k]).iter().sum::<DVec2>() / 3.0;
    let mut nearest = vec![NONE; triangles.len()];
    known.iter().enumerate().for_each(|(own, &(k, _))| nearest[k] = own as u32);
    let mut open = BinaryHeap::new();
    let reach = |open: &mut BinaryHeap<_>, nearest: &[u32], distance: f64, own: u32, k: usize| {
        for n in next(k).filter(|&n| nearest[n] == NONE && fits(n, known[own as usize].1)) {
            let distance = distance + middle(k).distance(middle(n));
            // The bits of numbers that are not negative have the order of the numbers.
            open.push(Reverse((distance.to_bits(), own, n as u32)));
        }
    };
    known.iter().enumerate().for_each(|(own, &(k, _))| reach(&mut open, &nearest, 0.0, own as u32, k));
    while let Some(Reverse((distance, own, k))) = open.pop() {
        if nearest[k as usize] == NONE {
            nearest[k as usize] = own;
            reach(&mut open, &nearest, f64::from_bits(distance), own, k as usize);
        }
    }
    nearest
}

/// The band between the levels around a height.
fn between_levels(interval: &Interval, height: f64) -> Band {
    let number = (height - interval.base) / interval.step;
    Band { lo: interval.level(number.floor() as i64), hi: interval.level(number.ceil() as i64) }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::subdomains::regions;
    use crate::tin::{TinInput, triangulate};

    const TEN: Interval = Interval { step: 10.0, base: 0.0, rounding: 0.0 };

    /// Points every 5 units along a square around a centre.
    fn ring(x: f64, half: f64) -> Vec<DVec2> {
        let side = |from: DVec2, to: DVec2| {
            let count = (from.distance(to) / 5.0).ceil() as usize;
            (0..count).map(move |k| from.lerp(to, k as f64 / count as f64))
        };
        let corners = [(-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)];
        let corners = corners.map(|(u, v)| DVec2::new(x + u, v));
        corners.windows(2).flat_map(|w| side(w[0], w[1])).chain([corners[0]]).collect()
    }

    /// A triangulation, its sub-domains, and the bands of single triangles. Heights of spots are `sure`; guessed ones are
    /// not given.
    fn local(lines: &[(f64, Vec<DVec2>)], spots: &[(f64, DVec2)], sure: Sure) -> (Tin, Regions, HashMap<u32, Band>) {
        let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
        lines.iter().for_each(|(level, line)| input.push_line(line, *level, VertexKind::Contour));
        for &(height, at) in spots {
            input.push(at, height, if sure == Sure::Guessed { VertexKind::Axis } else { VertexKind::Spot });
        }
        let tin = triangulate(input).unwrap();
        let found = regions(&tin, &TEN);
        let given = |v: u32| (tin.kinds[v as usize] == VertexKind::Spot).then(|| (tin.heights[v as usize], sure));
        let wrong = |v: u32| tin.heights[v as usize] == 160.0;
        let local = local_bands(&tin, &found, wrong, given);
        (tin, found, local)
    }

    /// The bands at points of the x-axis: first those of the sub-domains, then those of the triangles.
    fn bands(lines: &[(f64, Vec<DVec2>)], spots: &[(f64, DVec2)], places: &[f64]) -> Vec<[Band; 2]> {
        let (tin, found, local) = local(lines, spots, Sure::Surveyed);
        let holds = |t: u32, p: DVec2| {
            let [a, b, c] = tin.corners(t);
            [(a, b), (b, c), (c, a)].iter().all(|(u, v)| (*v - *u).perp_dot(p - *u) >= 0.0)
        };
        let band = |x: &f64| {
            let t = (0..tin.len() as u32).find(|&t| holds(t, DVec2::new(*x, 1.0))).unwrap();
            let whole = found.region(t).unwrap().band;
            [whole, local.get(&t).copied().unwrap_or(whole)]
        };
        places.iter().map(band).collect()
    }

    /// Three rings. The one in the middle has a gap in the east.
    fn rings_with_gap() -> [(f64, Vec<DVec2>); 4] {
        let mut broken = ring(0.0, 60.0);
        let gap = broken.iter().position(|p| p.x == 60.0 && p.y > -45.0).unwrap()
            ..broken.iter().position(|p| p.x == 60.0 && p.y > 45.0).unwrap();
        let rest = broken.split_off(gap.end);
        broken.truncate(gap.start);
        [(100.0, ring(0.0, 90.0)), (110.0, broken), (110.0, rest), (120.0, ring(0.0, 30.0))]
    }

    #[test]
    fn a_broken_contour_tells_the_bands_on_both_its_sides_but_in_the_gap() {
        let lines = rings_with_gap();
        let whole = Band { lo: 100.0, hi: 120.0 };
        let expected = [Band { lo: 100.0, hi: 110.0 }, Band { lo: 110.0, hi: 120.0 }, whole].map(|band| [whole, band]);
        assert_eq!(bands(&lines, &[], &[-75.0, -45.0, 60.0]), expected);
    }

    #[test]
    fn a_given_height_in_the_gap_tells_the_side_on_which_it_lies() {
        let [lower, upper, whole] = [(100.0, 110.0), (110.0, 120.0), (100.0, 120.0)].map(|(lo, hi)| Band { lo, hi });
        for (height, expected) in [(104.0, [lower, whole]), (113.0, [whole, upper])] {
            let found = bands(&rings_with_gap(), &[(height, DVec2::new(60.0, 0.0))], &[75.0, 45.0]);
            assert_eq!(found, expected.map(|band| [whole, band]), "{height}");
        }
    }

    #[test]
    fn the_band_of_a_triangle_holds_the_heights_at_its_corners() {
        let mut narrowed = 0;
        for (sure, height) in [Sure::Between, Sure::Surveyed].into_iter().flat_map(|s| [102.0, 117.0].map(|z| (s, z))) {
            for at in (0..12).map(|k| DVec2::new(35.0 + 4.5 * f64::from(k), 6.0 * f64::from(k) - 33.0)) {
                let (tin, _, local) = local(&rings_with_gap(), &[(height, at)], sure);
                let has_spot = |t: u32| tin.triangles[t as usize].iter().any(|&v| tin.heights[v as usize] == height);
                for (t, band) in local.iter().filter(|(t, _)| has_spot(**t)) {
                    assert!(band.contains(height), "{sure:?} {height} at {at}, triangle {t}: {band:?}");
                    narrowed += 1;
                }
            }
        }
        assert!(narrowed > 50, "{narrowed}");
    }

    #[test]
    fn a_band_reaches_to_the_contours_at_its_triangle() {
        // A ring of points without sure heights, such as those of a stream, parts the ground between two contours. So no
        // triangle there tells its band, and the gap leads to ground beyond the lower contour.
        let spots: Vec<(f64, DVec2)> = ring(0.0, 45.0).into_iter().map(|p| (115.0, p)).collect();
        let (tin, _, local) = local(&rings_with_gap(), &spots, Sure::Guessed);
        let mut checked = 0;
        for (&t, band) in &local {
            for v in tin.triangles[t as usize].into_iter().filter(|&v| tin.kinds[v as usize] == VertexKind::Contour) {
                let level = tin.heights[v as usize];
                assert!(band.lo <= level && level <= band.hi, "a triangle at {level} in {band:?}");
                checked += 1;
            }
        }
        assert!(checked > 50, "{checked}");
    }

    #[test]
    fn a_wrong_elevation_widens_the_band_beside_it_alone() {
        let lines = [(100.0, ring(0.0, 95.0)), (110.0, ring(0.0, 20.0)), (160.0, ring(60.0, 3.0))];
        let whole = Band { lo: 100.0, hi: 160.0 };
        let expected = [Band { lo: 100.0, hi: 110.0 }, whole].map(|band| [whole, band]);
        assert_eq!(bands(&lines, &[], &[-60.0, 40.0]), expected);
    }
}
