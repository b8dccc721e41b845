//! Sub-domains and their bands (paper, section 3.2, for open contours too).
//!
//! A sub-domain is a set of triangles that are connected without crossing a contour. Where contours run off the map,
//! the frame closes it. Two levels on its border give its band. Where there is only one level, the neighbour decides
//! the side: crossing a contour changes the side.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashSet};

use crate::base::rows::Rows;
use crate::contour::Interval;
use crate::tin::{NONE, Tin, VertexKind};

/// Sub-domains whose levels are more than this many intervals apart contain missing contours.
pub(crate) const WIDE: f64 = 1.5;
/// A larger share of a sub-domain's border than this is most of it.
const MOST: f64 = 0.75;

/// The side of a level that ground lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Higher than the level.
    Above,
    /// Lower than the level.
    Below,
}

/// Two levels that heights lie between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower level, metres.
    pub lo: f64,
    /// Upper level, metres.
    pub hi: f64,
}

impl Band {
    /// Moves the height strictly inside the band: at least a thousandth of the band's width from both levels. An
    /// infinite band holds every height.
    pub fn strictly_inside(&self, height: f64) -> f64 {
        let margin = 1e-3 * (self.hi - self.lo);
        if margin.is_finite() { height.clamp(self.lo + margin, self.hi - margin) } else { height }
    }

    /// Whether the height lies in the band, the levels included.
    pub fn contains(&self, height: f64) -> bool {
        self.lo <= height && height <= self.hi
    }

    /// The narrowest band that holds this one and another.
    pub(crate) fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }
}

/// One sub-domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// The two levels that all its heights lie between; infinite where no contour touches it.
    pub band: Band,
    /// The levels on its border, ascending, with the side of each that the sub-domain lies on.
    pub levels: Vec<(f64, Side)>,
    /// One of its triangles.
    pub triangle: u32,
    /// Whether it reaches the frame through barrier edges of a ragged outline.
    pub outer: bool,
    /// Height of the water of a lake or the sea, whose band is this one height; none on land.
    pub water: Option<f64>,
}

impl Region {
    /// The side of a level on its border that the sub-domain lies on.
    pub fn side(&self, level: f64) -> Option<Side> {
        self.number_of(level).map(|k| self.levels[k].1)
    }

    /// Number of a level among those on the border.
    fn number_of(&self, level: f64) -> Option<usize> {
        let k = self.levels.partition_point(|(l, _)| *l < level);
        self.levels.get(k).is_some_and(|(l, _)| *l == level).then_some(k)
    }

    /// Difference between the highest and the lowest level on the border.
    fn gap(&self) -> f64 {
        match (self.levels.first(), self.levels.last()) {
            (Some(lowest), Some(highest)) => highest.0 - lowest.0,
            _ => 0.0,
        }
    }
}

/// The sub-domains of a triangulation.
#[derive(Debug, Clone)]
pub struct Regions {
    /// Sub-domain of each triangle, [`NONE`] outside the frame.
    pub of_triangle: Vec<u32>,
    /// The sub-domains, numbered by their first triangle.
    pub regions: Vec<Region>,
    /// The vertical interval, which gives the next level beyond a peak's or a pit's last contour.
    pub interval: Interval,
}

impl Regions {
    /// The sub-domain that triangle `t` lies in, none outside the frame.
    pub fn region(&self, t: u32) -> Option<&Region> {
        self.regions.get(self.of_triangle[t as usize] as usize)
    }

    /// The band from a level to the next one on that side.
    pub fn beyond(&self, level: f64, side: Side) -> Band {
        beyond(&self.interval, level, side)
    }
}

fn beyond(interval: &Interval, level: f64, side: Side) -> Band {
    match side {
        Side::Above => Band { lo: level, hi: interval.next_above(level) },
        Side::Below => Band { lo: interval.next_below(level), hi: level },
    }
}

/// Finds the sub-domains and their bands.
pub fn regions(tin: &Tin, interval: &Interval) -> Regions {
    let (of_triangle, mut regions) = flood(tin);
    let borders = borders_of(tin, &of_triangle, regions.len());
    let decided = |regions: &mut [Region], undecided: &[bool]| decide_by_spots(tin, &of_triangle, regions, undecided);
    propagate(&mut regions, &borders, interval, decided);
    Regions { of_triangle, regions, interval: *interval }
}

/// Numbers the connected components and collects the levels on their borders. At first every sub-domain counts as above
/// its lowest level and below the others.
fn flood(tin: &Tin) -> (Vec<u32>, Vec<Region>) {
    let mut of_triangle = vec![NONE; tin.len()];
    let mut regions = Vec::new();
    let mut stack = Vec::new();
    for first in 0..tin.len() as u32 {
        if of_triangle[first as usize] != NONE || !tin.is_inside(first) {
            continue;
        }
        let id = regions.len() as u32;
        let mut levels: Vec<f64> = Vec::new();
        let mut add = |level: f64| {
            if levels.last().is_none_or(|l| l.total_cmp(&level).is_ne()) {
                levels.push(level);
            }
        };
        let (mut at_frame, mut at_barrier) = (false, false);
        of_triangle[first as usize] = id;
        stack.push(first);
        while let Some(t) = stack.pop() {
            for i in 0..3 {
                if let Some(level) = tin.contour_level(t, i) {
                    add(level);
                    continue;
                }
                if tin.is_barrier(t, i) {
                    tin.edge(t, i).iter().for_each(|&v| add(tin.heights[v as usize]));
                    at_barrier = true;
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
        levels.sort_unstable_by(f64::total_cmp);
        levels.dedup_by(|a, b| a.total_cmp(b).is_eq());
        let side = |k: usize| if k == 0 { Side::Above } else { Side::Below };
        regions.push(Region {
            band: Band { lo: f64::NEG_INFINITY, hi: f64::INFINITY },
            levels: levels.into_iter().enumerate().map(|(k, level)| (level, side(k))).collect(),
            triangle: first,
            outer: at_frame && at_barrier,
            water: None,
        });
    }
    (of_triangle, regions)
}

/// A piece of contour between two sub-domains, seen from one of them.
#[derive(Debug, Clone, Copy, Default)]
struct SharedBorder {
    other: u32,
    level: f64,
    length: f64,
}

/// The borders of every sub-domain with its neighbours.
fn borders_of(tin: &Tin, of_triangle: &[u32], count: usize) -> Rows<SharedBorder> {
    let border = &|t: u32, i: usize| {
        let level = tin.contour_level(t, i)?;
        let other = of_triangle[tin.inner_neighbour(t, i)? as usize];
        let own = of_triangle[t as usize];
        let [u, v] = tin.edge(t, i).map(|v| tin.positions[v as usize]);
        let seen = SharedBorder { other, level, length: u.distance(v) };
        (own != other).then_some((own as usize, seen))
    };
    let all = tin.flat_map_inside(|t| (0..3).filter_map(move |i| border(t, i)));
    Rows::new(count, || all.iter().copied())
}

/// Gives every sub-domain its sides and its band. It begins with sub-domains between two neighbouring levels, where
/// both sides are known, and goes on outwards.
///
/// Other levels may be on the border too, if those two are most of it. So a line with a wrong elevation, or the rest of
/// a missing contour, does not make the ground around it unknown.
///
/// For the other sub-domains each level takes its side from the neighbours that are known: crossing a contour changes
/// the side. Where neighbours disagree, the longer common border wins. This is the rule for peaks and pits, and also
/// for ground where contours are missing.
///
/// If all lines around are of one level, no neighbour knows a side. There `decide` may give sides, and returns the numbers
/// of those sub-domains that it knows.
fn propagate(
    regions: &mut [Region],
    borders: &Rows<SharedBorder>,
    interval: &Interval,
    decide: impl Fn(&mut [Region], &[bool]) -> Vec<u32>,
) {
    let mut known: Vec<bool> = vec![false; regions.len()];
    for (r, region) in regions.iter_mut().enumerate() {
        let lower = main_pair(region, borders.of(r), interval);
        known[r] = lower.is_some();
        if let Some(lower) = lower {
            for (k, (_, side)) in region.levels.iter_mut().enumerate() {
                *side = if k <= lower { Side::Above } else { Side::Below };
            }
        }
    }
    let frontier: Vec<u32> = (0..regions.len() as u32).filter(|&r| known[r as usize]).collect();
    spread(frontier, &mut known, regions, borders);
    let undecided: Vec<bool> = known.iter().map(|known| !known).collect();
    if undecided.contains(&true) {
        let decided = decide(regions, &undecided);
        decided.iter().for_each(|&r| known[r as usize] = true);
        spread(decided, &mut known, regions, borders);
    }
    for region in regions {
        let (Some(&lowest), Some(&highest)) = (region.levels.first(), region.levels.last()) else { continue };
        let lo = if lowest.1 == Side::Below { interval.next_below(lowest.0) } else { lowest.0 };
        let hi = if highest.1 == Side::Above { interval.next_above(highest.0) } else { highest.0 };
        region.band = Band { lo, hi };
    }
}

/// Goes on from known sub-domains to their neighbours, until all that they lead to are known.
fn spread(mut frontier: Vec<u32>, known: &mut [bool], regions: &mut [Region], borders: &Rows<SharedBorder>) {
    while !frontier.is_empty() {
        let mut next: Vec<u32> = frontier
            .iter()
            .flat_map(|&r| borders.of(r as usize).iter().map(|b| b.other))
            .filter(|&r| !known[r as usize])
            .collect();
        next.sort_unstable();
        next.dedup();
        let sides: Vec<Vec<(f64, Side)>> = next.iter().map(|&r| vote(r, regions, borders, known)).collect();
        for (&r, sides) in next.iter().zip(sides) {
            known[r as usize] = true;
            regions[r as usize].levels = sides;
        }
        frontier = next;
    }
}

/// Gives undecided sub-domains the sides on which most of the spot heights in them lie, and returns their numbers.
fn decide_by_spots(tin: &Tin, of_triangle: &[u32], regions: &mut [Region], undecided: &[bool]) -> Vec<u32> {
    let mut seen = HashSet::new();
    let mut heights: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t) && undecided[of_triangle[t as usize] as usize]) {
        let spots = tin.triangles[t as usize].into_iter().filter(|&v| tin.kinds[v as usize] == VertexKind::Spot);
        for v in spots.filter(|&v| seen.insert(v)) {
            heights.entry(of_triangle[t as usize]).or_default().push(tin.heights[v as usize]);
        }
    }
    let mut decided = Vec::new();
    for (r, heights) in heights {
        let region = &mut regions[r as usize];
        let balance = |level: f64| {
            let [above, below] = [Ordering::Greater, Ordering::Less]
                .map(|is| heights.iter().filter(|z| z.total_cmp(&level) == is).count());
            above.cmp(&below)
        };
        let sides: Vec<Ordering> = region.levels.iter().map(|(level, _)| balance(*level)).collect();
        if sides.iter().any(|side| side.is_ne()) {
            for ((_, side), balance) in region.levels.iter_mut().zip(sides) {
                match balance {
                    Ordering::Greater => *side = Side::Above,
                    Ordering::Less => *side = Side::Below,
                    Ordering::Equal => {}
                }
            }
            decided.push(r);
        }
    }
    decided
}

/// The lower one of the two neighbouring levels that give a sub-domain's band, by its number; none if there are no two.
fn main_pair(region: &Region, borders: &[SharedBorder], interval: &Interval) -> Option<usize> {
    let near = WIDE * interval.step;
    if region.levels.len() < 2 {
        return None;
    }
    if region.gap() <= near {
        return Some(0);
    }
    let mut lengths = vec![0.0; region.levels.len()];
    for border in borders {
        if let Some(k) = region.number_of(border.level) {
            lengths[k] += border.length;
        }
    }
    let all: f64 = lengths.iter().sum();
    let of_pair = |k: usize| lengths[k] + lengths[k + 1];
    let is_pair = |&k: &usize| {
        let apart = region.levels[k + 1].0 - region.levels[k].0;
        apart <= near && lengths[k].min(lengths[k + 1]) > 0.0 && of_pair(k) > MOST * all
    };
    (0..lengths.len() - 1).filter(is_pair).max_by(|&j, &k| of_pair(j).total_cmp(&of_pair(k)))
}

/// The levels of a sub-domain with the sides that its known neighbours give. Without a known neighbour a side stays as
/// it was.
fn vote(region: u32, regions: &[Region], borders: &Rows<SharedBorder>, known: &[bool]) -> Vec<(f64, Side)> {
    let mut balance = vec![0.0; regions[region as usize].levels.len()];
    for border in borders.of(region as usize).iter().filter(|b| known[b.other as usize]) {
        let own = regions[region as usize].number_of(border.level);
        if let (Some(k), Some(side)) = (own, regions[border.other as usize].side(border.level)) {
            balance[k] += if side == Side::Below { border.length } else { -border.length };
        }
    }
    let decide = |(&(level, side), above): (&(f64, Side), f64)| {
        (
            level,
            if above > 0.0 {
                Side::Above
            } else if above < 0.0 {
                Side::Below
            } else {
                side
            },
        )
    };
    regions[region as usize].levels.iter().zip(balance).map(decide).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::tin::{TinInput, triangulate};

    const TEN: Interval = Interval { step: 10.0, base: 0.0, rounding: 0.0 };

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
    fn spot_heights_decide_where_all_lines_have_one_level() {
        let bands = |spots: &[(f64, f64)]| {
            let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
            for h in [50.0, 80.0] {
                let ring = [(-h, -h), (h, -h), (h, h), (-h, h), (-h, -h)].map(DVec2::from);
                input.push_line(&ring, 20.0, VertexKind::Contour);
            }
            for &(x, z) in spots {
                input.push(DVec2::new(x, 0.0), z, VertexKind::Spot);
            }
            let tin = triangulate(input).unwrap();
            let regions = regions(&tin, &TEN);
            [0.5, 65.5].map(|x| band_at(&tin, &regions, DVec2::new(x, 0.5)).lo)
        };
        assert_eq!(bands(&[(3.0, 25.0)]), [20.0, 10.0]);
        assert_eq!(bands(&[(3.0, 15.0)]), [10.0, 20.0]);
        assert_eq!(bands(&[(65.0, 26.0)]), [10.0, 20.0]);
        assert_eq!(bands(&[(65.0, 26.0), (-65.0, 14.0), (0.0, 65.0), (66.0, 12.0)]), [20.0, 10.0], "the majority");
        assert_eq!(bands(&[(3.0, 20.0)]), bands(&[]), "a spot height at the level says nothing");
    }

    #[test]
    fn an_infinite_band_holds_all_heights() {
        let band = Band { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
        assert_eq!(band.strictly_inside(7.0), 7.0);
        assert_eq!(Band { lo: 0.0, hi: 10.0 }.strictly_inside(12.0), 9.99);
    }

    #[test]
    fn a_hill_has_a_peak_above_and_a_crater_a_floor_below() {
        let hill = rings(&[(90.0, 100.0), (60.0, 110.0), (30.0, 120.0)]);
        let found = regions(&hill, &TEN);
        let band = |x: f64| band_at(&hill, &found, DVec2::new(x, 1.0));
        assert_eq!(band(75.0), Band { lo: 100.0, hi: 110.0 });
        assert_eq!(band(10.0), Band { lo: 120.0, hi: 130.0 });

        let crater = rings(&[(90.0, 100.0), (60.0, 110.0), (45.0, 110.0), (30.0, 100.0)]);
        let found = regions(&crater, &TEN);
        let band = |x: f64| band_at(&crater, &found, DVec2::new(x, 1.0));
        assert_eq!(band(50.0), Band { lo: 110.0, hi: 120.0 });
        assert_eq!(band(40.0), Band { lo: 100.0, hi: 110.0 });
        assert_eq!(band(10.0), Band { lo: 90.0, hi: 100.0 });
    }

    #[test]
    fn small_wrong_rings_do_not_turn_a_hollow_into_a_hill() {
        let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
        let mut ring = |x: f64, h: f64, z: f64| {
            let ring = [(-h, -h), (h, -h), (h, h), (-h, h), (-h, -h)].map(|(dx, dy)| DVec2::new(x + dx, dy));
            input.push_line(&ring, z, VertexKind::Contour);
        };
        for (h, z) in [(90.0, 120.0), (75.0, 110.0), (30.0, 100.0)] {
            ring(0.0, h, z);
        }
        // Knolls of 110 and 120 m.
        ring(55.0, 2.0, 160.0);
        ring(82.0, 2.0, 50.0);
        let crater = triangulate(input).unwrap();
        let found = regions(&crater, &TEN);
        let band = |x: f64| band_at(&crater, &found, DVec2::new(x, 1.0));
        assert_eq!(band(40.0), Band { lo: 100.0, hi: 160.0 });
        assert_eq!(band(10.0), Band { lo: 90.0, hi: 100.0 }, "the floor");
        assert_eq!(band(86.0), Band { lo: 50.0, hi: 120.0 });
    }
}
