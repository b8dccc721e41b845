//! A coast that nobody named: ground beyond contours at sea level that reaches the frame.

use glam::DVec2;

use super::lakes::inner_circle;
use crate::base::error::{Finding, FindingKind};
use crate::contour::ContourMap;
use crate::subdomains::{Regions, Side, seas_with_contours};
use crate::tin::Tin;

/// Levels up to this far from 0 may be those of a coast, metres.
const NEAR_ZERO: f64 = 0.5;
/// Least share of the map that lies beyond the coast. Beside a smaller part, the sea makes no difference.
const LARGE: f64 = 0.002;
/// Least length of the coast, as a share of the side of a square as large as the map.
const LONG: f64 = 0.1;
/// Least radius of the widest place beyond the coast, as a multiple of the mean spacing of the contours. The frame leaves
/// narrower places in the bends of every outermost contour.
const WIDE: f64 = 1.0;

/// Contours below the coast are all in the level sea if these are a larger share of them.
const NEARLY_ALL: f64 = 0.999;

/// The finding that the lowest level may be a coast: it is at about 0 m, and it is the only level around ground below it
/// that reaches the frame and is wide. A few contours in the sea do not count.
///
/// `tin` holds the map's contours before all other points.
pub(crate) fn possible_sea(map: &ContourMap, tin: &Tin, regions: &Regions) -> Option<Finding> {
    let levels = || regions.regions.iter().flat_map(|region| region.levels.iter().map(|(level, _)| *level));
    let lowest = levels().filter(|level| level.abs() <= NEAR_ZERO).reduce(f64::min)?;
    let has_contours = seas_with_contours(regions, tin, lowest);
    let has_lower = levels().any(|level| level < lowest);
    if has_lower && !are_in(&has_contours, tin, regions, lowest) {
        return None;
    }
    let is_below = |k: u32| {
        let region = &regions.regions[k as usize];
        region.water.is_none() && (has_contours[k as usize] || region.levels[..] == [(lowest, Side::Below)])
    };
    let mut found = vec![Beyond::default(); regions.regions.len()];
    let mut map_area = 0.0;
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let [a, b, c] = tin.corners(t);
        let area = (b - a).perp_dot(c - a) / 2.0;
        map_area += area;
        let k = regions.of_triangle[t as usize];
        if is_below(k) {
            found[k as usize].add(tin, t, area);
        }
    }
    let open = || found.iter().filter(|beyond| beyond.is_open);
    let (area, coast) = open().fold((0.0, 0.0), |(area, coast), beyond| (area + beyond.area, coast + beyond.coast));
    let widest = open().max_by(|a, b| a.largest.0.total_cmp(&b.largest.0))?;
    let spacing = map_area / map.contours.iter().map(|line| line.length()).sum::<f64>();
    if area < LARGE * map_area || coast < LONG * map_area.sqrt() || widest.largest.0 < WIDE * spacing {
        return None;
    }
    let share = 100.0 * area / map_area;
    let what = if has_lower { "only single contours lie" } else { "nothing lies" };
    let message = format!(
        "contour {lowest} m may be the coast: {what} below it, and the ground beyond it, {share:.1} % of the map, reaches \
         the frame"
    );
    let place = tin.origin + widest.largest.1;
    Some(Finding::at(FindingKind::MayBeSea, place, message).of_elevations([lowest]))
}

/// Whether the contours below a level are on the border of some sub-domains.
fn are_in(some: &[bool], tin: &Tin, regions: &Regions, level: f64) -> bool {
    let (mut all, mut inside) = (0.0, 0.0);
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let is_in = some[regions.of_triangle[t as usize] as usize];
        for i in (0..3).filter(|&i| tin.contour_level(t, i).is_some_and(|of| of < level)) {
            all += tin.edge_length(t, i) / 2.0;
            inside += if is_in { tin.edge_length(t, i) } else { 0.0 };
        }
    }
    inside > NEARLY_ALL * all
}

/// Ground below the lowest level.
#[derive(Debug, Clone, Copy, Default)]
struct Beyond {
    area: f64,
    /// Length of the contours around it.
    coast: f64,
    is_open: bool,
    /// Radius and centre of the largest circle inside, relative to the origin of the triangulation.
    largest: (f64, DVec2),
}

impl Beyond {
    fn add(&mut self, tin: &Tin, t: u32, area: f64) {
        self.area += area;
        let circle = inner_circle(tin.corners(t)).filter(|(radius, _)| *radius > self.largest.0);
        self.largest = circle.unwrap_or(self.largest);
        for i in 0..3 {
            if tin.inner_neighbour(t, i).is_none() {
                self.is_open = true;
            } else if tin.border_level(t, i).is_some() {
                self.coast += tin.edge_length(t, i);
            }
        }
    }
}
