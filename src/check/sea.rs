//! A coast that nobody named: ground beyond contours at sea level that reaches the frame.

use glam::DVec2;

use crate::base::error::{Finding, FindingKind};
use crate::subdomains::{Regions, Side};
use crate::tin::Tin;

/// Levels up to this far from 0 may be those of a coast, metres.
const NEAR_ZERO: f64 = 0.5;
/// Least share of the map that lies beyond the coast. Beside a smaller part, the sea makes no difference.
const LARGE: f64 = 0.002;
/// Least length of the coast, as a share of the side of a square as large as the map.
const LONG: f64 = 0.1;

/// The finding that the lowest level may be a coast: it is at about 0 m, and it is the only level around ground below it
/// that reaches the frame.
///
/// `tin` holds the map's contours before all other points.
pub(crate) fn possible_sea(tin: &Tin, regions: &Regions) -> Option<Finding> {
    let levels = || regions.regions.iter().flat_map(|region| region.levels.iter().map(|(level, _)| *level));
    let lowest = levels().reduce(f64::min).filter(|lowest| lowest.abs() <= NEAR_ZERO)?;
    let is_below = |k: u32| {
        let region = &regions.regions[k as usize];
        region.water.is_none() && region.levels[..] == [(lowest, Side::Below)]
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
    if area < LARGE * map_area || coast < LONG * map_area.sqrt() {
        return None;
    }
    let widest = open().max_by(|a, b| a.area.total_cmp(&b.area))?;
    let share = 100.0 * area / map_area;
    let message = format!(
        "contour {lowest} may be the coast: nothing lies below it, and the ground beyond it, {share:.1} % of the map, reaches \
         the frame"
    );
    let place = tin.origin + widest.place;
    Some(Finding::at(FindingKind::MayBeSea, place, message).of_elevations([lowest]))
}

/// Ground below the lowest level.
#[derive(Debug, Clone, Copy, Default)]
struct Beyond {
    area: f64,
    /// Length of the contours around it.
    coast: f64,
    is_open: bool,
    /// The middle of its largest triangle, relative to the origin of the triangulation.
    place: DVec2,
    largest: f64,
}

impl Beyond {
    fn add(&mut self, tin: &Tin, t: u32, area: f64) {
        self.area += area;
        if area > self.largest {
            let [a, b, c] = tin.corners(t);
            (self.largest, self.place) = (area, (a + b + c) / 3.0);
        }
        for i in 0..3 {
            if tin.inner_neighbour(t, i).is_none() {
                self.is_open = true;
            } else if tin.border_level(t, i).is_some() {
                self.coast += tin.edge_length(t, i);
            }
        }
    }
}
