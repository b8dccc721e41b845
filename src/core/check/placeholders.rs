//! Contours and spot heights whose elevation stands for no data: 0 where the ground is not at 0, or a number that programs
//! write for no data. They are left out, as those with an empty attribute are.
//!
//! A level is a placeholder if it is such a number, and no other level lies near it. A coast at 0 m is therefore none, as
//! long as the contours above it are there. Where the levels begin near 0, a line at 0 is still a placeholder if it is the
//! neat line of the map: straight, with all other contours on one side of it and the ends of several levels along it.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use rayon::prelude::*;

use crate::base::error::{Finding, FindingKind};
use crate::contour::{Contour, ContourMap, ElevationUnit, find_interval};

/// Numbers that stand for no data, in the file's unit, with either sign.
const EITHER_SIGN: &[f64] = &[0.0, 999.0, 9999.0, 99_999.0, 999_999.0, 32_767.0, 32_768.0, 65_535.0];
/// Numbers that stand for no data with a negative sign only, in the file's unit. The last are those of well logs.
const NEGATIVE: &[f64] = &[1.0, 99.0, 9998.0, 999.25, 999.9, 9999.9, 8888.0, 88_888.0];
/// Of those, numbers from here on are no elevations of any ground, without their sign and in metres.
const NO_GROUND: f64 = 9000.0;
/// Elevations from here on, above or below zero, are doubtful, metres. In a file in millimetres they are real.
const HIGHEST: f64 = 100_000.0;
/// Elevations from here on are not real in any unit, metres.
const ABSURD: f64 = 1e7;
/// A doubtful level has no neighbour if the next one is further away than this many intervals.
const APART: f64 = 3.0;
/// A line is straight within this share of the map's diagonal.
const STRAIGHT: f64 = 1e-3;
/// A neat line is longer than this share of the shorter side of the map.
const LONG: f64 = 0.5;
/// Ends of contours within this share of the map's diagonal are near a neat line.
const NEAR: f64 = 0.05;
/// Contours of at least this many levels end at a neat line.
const ENDING: usize = 3;

/// What a map holds without an elevation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placeholders {
    /// Numbers of the contours, ascending.
    pub lines: Vec<u32>,
    /// Numbers of the spot heights, ascending.
    pub spots: Vec<u32>,
    /// Numbers of the spot heights with a standard error, ascending.
    pub soft_spots: Vec<u32>,
    /// One finding for each, in this order. They say that it was left out.
    pub findings: Vec<Finding>,
}

/// Finds the contours and spot heights of a map whose elevations stand for no data. Levels in `named` are real: the caller
/// knows them, for instance as the level of the sea.
///
/// The result does not depend on the order of the contours, except for the numbers.
pub fn placeholders(map: &ContourMap, named: &[f64]) -> Placeholders {
    let is_named = |z: f64| named.iter().any(|level| (level - z).abs() <= SAME_LEVEL);
    let mut found = Placeholders::default();
    let mut is_out = vec![false; map.contours.len()];
    for Placeholder { line, why } in lines(map).into_iter().filter(|p| !is_named(map.contours[p.line].elevation)) {
        let contour = &map.contours[line];
        let Contour { elevation, feature, .. } = contour;
        let unless = match elevation {
            0.0 => "; if it is a coast, name 0 as the level of the coast",
            _ => "",
        };
        let message = format!("the contour {elevation} m (feature {feature}) was left out: {why}{unless}");
        let finding = Finding::new(FindingKind::ZeroElevation, middle(contour), message);
        found.findings.push(finding.about(*feature, *elevation));
        found.lines.push(line as u32);
        is_out[line] = true;
    }
    let kept = map.contours.iter().zip(&is_out).filter(|(_, is_out)| !**is_out).map(|(contour, _)| contour);
    let soft = map.soft_spots.iter().map(|spot| spot.place);
    let heights: Vec<f64> = map.spots.iter().copied().chain(soft.clone()).map(|p| p.z).collect();
    let Some(levels) = SpotLevels::new(kept, &heights) else { return found };
    let mut add = |place: glam::DVec3| {
        let why = levels.fault(place.z).filter(|_| !is_named(place.z))?;
        let message = format!("the spot height {} m was left out: {why}", place.z);
        let finding = Finding::new(FindingKind::ZeroElevation, Some(place.truncate()), message);
        found.findings.push(finding.of_elevations([place.z]));
        Some(())
    };
    let mut of = |places: &mut dyn Iterator<Item = glam::DVec3>| {
        (0u32..).zip(places).filter_map(|(k, place)| add(place).map(|()| k)).collect::<Vec<u32>>()
    };
    let (spots, soft_spots) = (of(&mut map.spots.iter().copied()), of(&mut soft.clone()));
    (found.spots, found.soft_spots) = (spots, soft_spots);
    found
}

/// Levels that differ by no more are one, metres.
const SAME_LEVEL: f64 = 1e-3;

impl Placeholders {
    /// The map without them, and the findings about them.
    pub fn leave_out(self, map: &mut ContourMap) -> Vec<Finding> {
        remove(&mut map.contours, &self.lines);
        remove(&mut map.spots, &self.spots);
        remove(&mut map.soft_spots, &self.soft_spots);
        self.findings
    }
}

/// Removes the items of these numbers, which are ascending.
fn remove<T>(items: &mut Vec<T>, numbers: &[u32]) {
    if numbers.is_empty() {
        return;
    }
    let mut k = 0u32;
    items.retain(|_| {
        k += 1;
        numbers.binary_search(&(k - 1)).is_err()
    });
}

/// Which of these heights stand for no data, judged by the heights alone: numbers that are no elevations of any ground, and
/// 0 further away from all others than these are from each other.
pub fn placeholder_heights(heights: &[f64]) -> Vec<bool> {
    let sound = || heights.iter().copied().filter(|z| z.is_finite() && !is_doubtful(*z));
    let (low, high) = sound().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    let is_out = |z: f64| z < low - (high - low) || z > high + (high - low);
    let judge = |&z: &f64| low <= high && is_doubtful(z) && (is_certain(z) || is_out(z)) && !(low..=high).contains(&z);
    heights.iter().map(judge).collect()
}

/// A contour whose elevation stands for no data.
pub(super) struct Placeholder {
    /// The number of the contour.
    pub line: usize,
    /// Why so, as a sentence without its full stop.
    pub why: String,
}

/// The contours of a map whose elevations stand for no data, ascending.
pub(super) fn lines(map: &ContourMap) -> Vec<Placeholder> {
    if !map.contours.iter().any(|line| is_doubtful(line.elevation)) {
        return Vec::new();
    }
    let levels = Levels::new(map.contours.iter());
    let neat = NeatLines::new(map);
    let judge = |(line, contour): (usize, &Contour)| {
        let z = contour.elevation;
        let why = if is_doubtful(z) { levels.fault(z).or_else(|| neat.fault(contour)) } else { None };
        why.map(|why| Placeholder { line, why })
    };
    map.contours.par_iter().enumerate().filter_map(judge).collect()
}

/// The levels of contours, with those that have no neighbour.
struct Levels {
    /// For each level without a neighbour: the nearest other one.
    lonely: BTreeMap<u64, f64>,
    /// The distance within which a level has a neighbour; `None` with one level.
    reach: Option<f64>,
}

impl Levels {
    fn new<'a>(contours: impl Iterator<Item = &'a Contour> + Clone) -> Self {
        let mut counts: BTreeMap<u64, (f64, usize)> = BTreeMap::new();
        for z in contours.clone().map(|c| c.elevation + 0.0).filter(|z| z.is_finite()) {
            counts.entry(z.to_bits()).or_insert((z, 0)).1 += 1;
        }
        let mut plain: Vec<f64> = counts.values().map(|level| level.0).filter(|z| !is_listed(*z)).collect();
        plain.sort_unstable_by(f64::total_cmp);
        let reach = interval(contours).map(|step| APART * step);
        let mut lonely = BTreeMap::new();
        for &(z, _) in counts.values().filter(|(z, _)| is_doubtful(*z)) {
            let Some(other) = nearest(&plain, z) else { continue };
            let is_apart = reach.map_or(is_certain(z), |reach| (other - z).abs() > reach);
            if is_apart {
                lonely.insert(z.to_bits(), other);
            }
        }
        // Where most lines have such a level, it may be that of the map, and the others may be wrong.
        let lines = |of: &dyn Fn(f64) -> bool| counts.values().filter(|l| of(l.0)).map(|l| l.1).sum::<usize>();
        let open = |z: f64| lonely.contains_key(&z.to_bits()) && !is_certain(z);
        if lines(&open) >= lines(&|z| !is_listed(z) && !open(z)) {
            lonely.retain(|&bits, _| is_certain(f64::from_bits(bits)));
        }
        Self { lonely, reach }
    }

    /// Why a level stands for no data; `None` if it does not.
    fn fault(&self, z: f64) -> Option<String> {
        let other = self.lonely.get(&(z + 0.0).to_bits())?;
        Some(no_neighbour(*other, self.reach))
    }
}

/// The levels with which spot heights are compared.
struct SpotLevels {
    /// The levels of contours, and the spot heights that are no doubtful numbers; ascending.
    plain: Vec<f64>,
    reach: Option<f64>,
}

impl SpotLevels {
    /// The levels of contours that are left, and the heights of all spots. `None` if no spot is doubtful.
    fn new<'a>(contours: impl Iterator<Item = &'a Contour> + Clone, heights: &[f64]) -> Option<Self> {
        if !heights.iter().any(|z| is_doubtful(*z)) {
            return None;
        }
        let reach = interval(contours.clone()).map(|step| APART * step);
        let sound = heights.iter().copied().filter(|z| !is_doubtful(*z));
        let mut plain: Vec<f64> = contours.map(|c| c.elevation).chain(sound).filter(|z| z.is_finite()).collect();
        plain.sort_unstable_by(f64::total_cmp);
        Some(Self { plain, reach })
    }

    fn fault(&self, z: f64) -> Option<String> {
        let other = nearest(&self.plain, z).filter(|_| is_doubtful(z))?;
        let is_apart = self.reach.map_or(is_certain(z), |reach| (other - z).abs() > reach);
        is_apart.then(|| no_neighbour(other, self.reach))
    }
}

fn no_neighbour(other: f64, reach: Option<f64>) -> String {
    match reach {
        Some(reach) => {
            format!("no other level lies within {reach} m, the nearest is {other} m, so it seems to have no elevation")
        }
        None => format!("the number stands for no data, and the other level is {other} m"),
    }
}

/// The interval of the levels that are no doubtful numbers.
fn interval<'a>(contours: impl Iterator<Item = &'a Contour> + Clone) -> Option<f64> {
    let of = |is_out: fn(f64) -> bool| {
        let sound = contours.clone().filter(|c| c.elevation.is_finite() && !is_out(c.elevation));
        find_interval(&sound.cloned().collect::<Vec<Contour>>()).map(|interval| interval.step)
    };
    // In a file in millimetres, all levels are high.
    of(is_doubtful).or_else(|| of(is_listed))
}

/// The level nearest to another one, among ascending levels; not that level itself.
fn nearest(levels: &[f64], z: f64) -> Option<f64> {
    let below = levels.partition_point(|level| *level < z);
    let above = levels.partition_point(|level| *level <= z);
    let sides = [below.checked_sub(1).map(|k| levels[k]), levels.get(above).copied()];
    sides.into_iter().flatten().min_by(|a, b| (a - z).abs().total_cmp(&(b - z).abs()))
}

/// Whether an elevation may stand for no data.
fn is_doubtful(z: f64) -> bool {
    is_listed(z) || (z.is_finite() && z.abs() >= HIGHEST)
}

/// Whether an elevation is a number for no data, or not real in any unit.
fn is_listed(z: f64) -> bool {
    let units = || ElevationUnit::ALL.into_iter();
    let is = |n: &f64| units().any(|unit| unit.metres(*n) == z.abs());
    z.is_finite() && (z.abs() >= ABSURD || EITHER_SIGN.iter().any(is) || (z < 0.0 && NEGATIVE.iter().any(is)))
}

/// Whether a doubtful elevation is that of no ground. Then it need not be rare.
fn is_certain(z: f64) -> bool {
    is_listed(z) && (z.abs() >= ABSURD || ElevationUnit::ALL.into_iter().any(|unit| z.abs() >= unit.metres(NO_GROUND)))
}

/// The position of a finding about a line.
pub(super) fn middle(line: &Contour) -> Option<DVec2> {
    line.points.get(line.points.len() / 2).copied().filter(|p| p.is_finite())
}

/// The sheets of a map, to recognise their neat lines. Each file is a sheet.
struct NeatLines<'a> {
    map: &'a ContourMap,
    /// The extent of each.
    sheets: BTreeMap<Option<u32>, [DVec2; 2]>,
}

impl<'a> NeatLines<'a> {
    fn new(map: &'a ContourMap) -> Self {
        let mut sheets = BTreeMap::new();
        for line in &map.contours {
            let [low, high] = sheets.entry(line.feature.file()).or_insert([DVec2::INFINITY, DVec2::NEG_INFINITY]);
            for p in line.points.iter().filter(|p| p.is_finite()) {
                (*low, *high) = (low.min(*p), high.max(*p));
            }
        }
        Self { map, sheets }
    }

    /// Why a line is the neat line of its sheet, or a side of it; `None` if it is not.
    fn fault(&self, line: &Contour) -> Option<String> {
        let file = line.feature.file();
        let [low, high] = self.sheets.get(&file)?;
        let (diagonal, side) = (low.distance(*high), (high - low).min_element());
        if !(diagonal.is_finite() && line.length() > LONG * side) {
            return None;
        }
        let corners = corners(&line.points, STRAIGHT * diagonal)?;
        let sides: Vec<[DVec2; 2]> = corners.windows(2).map(|w| [w[0], w[1]]).collect();
        let is_other = |other: &&Contour| other.feature.file() == file && !is_doubtful(other.elevation);
        let others = || self.map.contours.iter().filter(is_other);
        // On one side of every side: within a frame, or beyond a single edge of it.
        let slack = STRAIGHT * diagonal;
        let depth = |p: DVec2, [a, b]: [DVec2; 2]| (b - a).normalize_or_zero().perp_dot(p - a);
        let all = |sign: f64| {
            let is_inside = |p: &DVec2| !p.is_finite() || sides.iter().all(|side| sign * depth(*p, *side) >= -slack);
            others().all(|other| other.points.iter().all(is_inside))
        };
        if !(all(1.0) || all(-1.0)) {
            return None;
        }
        let is_near = |p: DVec2| sides.iter().any(|[a, b]| distance(p, *a, *b) <= NEAR * diagonal);
        let mut ending = BTreeSet::new();
        for other in others().filter(|other| !other.is_closed()) {
            if [other.points.first(), other.points.last()].into_iter().flatten().any(|p| is_near(*p)) {
                ending.insert((other.elevation + 0.0).to_bits());
            }
        }
        let levels = ending.len();
        (levels >= ENDING)
            .then(|| format!("contours of {levels} levels end along it, so it is the neat line of the map"))
    }
}

/// The corners of a line that is a single straight piece, or straight around four corners; otherwise `None`.
fn corners(points: &[DVec2], tolerance: f64) -> Option<Vec<DVec2>> {
    let (first, last) = (*points.first()?, *points.last()?);
    let is_straight = |points: &[DVec2]| {
        let [a, b] = [points[0], points[points.len() - 1]];
        points.iter().all(|p| distance(*p, a, b) <= tolerance)
    };
    if first != last {
        return is_straight(points).then(|| vec![first, last]);
    }
    let ring = &points[..points.len() - 1];
    let farthest =
        |from: DVec2| (0..ring.len()).max_by(|&i, &j| ring[i].distance(from).total_cmp(&ring[j].distance(from)));
    // Two opposite corners, then the one farthest from their diagonal on each side.
    let a = farthest(ring.iter().fold(DVec2::ZERO, |sum, p| sum + *p) / ring.len().max(1) as f64)?;
    let c = farthest(ring[a])?;
    let off = |i: usize| (ring[c] - ring[a]).perp_dot(ring[i] - ring[a]);
    let b = (0..ring.len()).max_by(|&i, &j| off(i).total_cmp(&off(j)))?;
    let d = (0..ring.len()).min_by(|&i, &j| off(i).total_cmp(&off(j)))?;
    let mut corners = vec![a, b, c, d];
    corners.sort_unstable();
    corners.dedup();
    if corners.len() != 4 {
        return None;
    }
    let turned: Vec<DVec2> = ring[corners[0]..].iter().chain(&ring[..=corners[0]]).copied().collect();
    let at: Vec<usize> = corners.iter().map(|k| k - corners[0]).chain([ring.len()]).collect();
    at.windows(2).all(|w| is_straight(&turned[w[0]..=w[1]])).then(|| at.iter().map(|&k| turned[k]).collect())
}

/// The distance of a point from a segment.
fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let t = if along == DVec2::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
    p.distance(a + t * along)
}

#[cfg(test)]
mod tests;
