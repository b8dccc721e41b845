//! Lakes that nobody gave: hollows that look like water.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::base::error::{Finding, FindingKind};
use crate::contour::ContourMap;
use crate::subdomains::{Region, Regions, Side};
use crate::tin::Tin;

/// A slope is steep for a hollow if its contours are at most this share of the hollow's radius apart.
const STEEP: f64 = 1.0 / 3.0;
/// Share of the shore below a steep slope from which on the hollow lies among steep slopes.
const ALL_ROUND: f64 = 0.9;
/// A shore is smooth if it turns at most by this share of what contours of the map turn on the same length.
const SMOOTH: f64 = 1.0 / 3.0;
/// Share of the shore below a steep slope where the shore is smooth.
const HALF_ROUND: f64 = 0.5;

/// Hollows inside a single contour that may be lakes. Water is level, so no contour shows inside a lake. A hollow is reported where
///
/// * it is several times as wide as the strips between the contours around it, on nearly all sides, or
/// * it is so on half of the sides, and its shore turns much less than the contours of the map.
///
/// `tin` holds the map's contours before all other points. Hollows that reach the frame are left out.
pub(crate) fn possible_lakes(map: &ContourMap, tin: &Tin, regions: &Regions) -> Vec<Finding> {
    let mut hollows: Vec<Option<Hollow>> = regions.regions.iter().map(Hollow::new).collect();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        if let Some(hollow) = &mut hollows[regions.of_triangle[t as usize] as usize] {
            hollow.add(tin, t);
        }
    }
    let usual = hollows.iter().flatten().next().map_or(0.0, |_| turn_per_length(map));
    hollows.iter().flatten().filter(|hollow| hollow.may_be_water(usual)).map(|hollow| hollow.finding(tin)).collect()
}

/// A sub-domain below its only level.
struct Hollow {
    level: f64,
    is_open: bool,
    area: f64,
    /// Radius and centre of the largest circle inside, relative to the origin of the triangulation.
    largest: (f64, DVec2),
    /// Length of each piece of shore and the distance to the next level outside, map units; infinite if it is unknown.
    shore: Vec<(f64, f64)>,
    /// Corners of the shore: both pieces of contour that meet there.
    corners: BTreeMap<u32, Vec<DVec2>>,
}

impl Hollow {
    fn new(region: &Region) -> Option<Self> {
        match region.levels[..] {
            [(level, Side::Below)] if region.water.is_none() && !region.outer => Some(Self {
                level,
                is_open: false,
                area: 0.0,
                largest: (0.0, DVec2::ZERO),
                shore: Vec::new(),
                corners: BTreeMap::new(),
            }),
            _ => None,
        }
    }

    fn add(&mut self, tin: &Tin, t: u32) {
        let [a, b, c] = tin.corners(t);
        self.area += (b - a).perp_dot(c - a) / 2.0;
        if let Some((radius, centre)) = inner_circle([a, b, c]).filter(|(radius, _)| *radius > self.largest.0) {
            self.largest = (radius, centre);
        }
        for i in 0..3 {
            let Some(n) = tin.inner_neighbour(t, i) else {
                self.is_open = true;
                continue;
            };
            if tin.border_level(t, i).is_none() {
                continue;
            }
            let length = tin.edge_length(t, i);
            self.shore.push((length, distance_outside(tin, t, i, n, self.level).unwrap_or(f64::INFINITY)));
            let ends = tin.edge(t, i);
            let [from, to] = ends.map(|v| tin.positions[v as usize]);
            self.corners.entry(ends[0]).or_default().push(to - from);
            self.corners.entry(ends[1]).or_default().push(to - from);
        }
    }

    /// Whether it looks like water. `usual` is the turn of the map's contours, radians per map unit.
    fn may_be_water(&self, usual: f64) -> bool {
        let length: f64 = self.shore.iter().map(|s| s.0).sum();
        let steep: f64 = self.shore.iter().filter(|s| s.1 < STEEP * self.largest.0).map(|s| s.0).sum();
        let turn: f64 = self.corners.values().filter_map(|at| Some(at.first()?.angle_to(*at.get(1)?).abs())).sum();
        let is_smooth = turn - std::f64::consts::TAU < SMOOTH * usual * length;
        !self.is_open && (steep > ALL_ROUND * length || is_smooth && steep > HALF_ROUND * length)
    }

    fn finding(&self, tin: &Tin) -> Finding {
        let message = format!(
            "the hollow below contour {} m, with an area of about {:.0} square map units, may be a lake",
            self.level, self.area
        );
        Finding::at(FindingKind::MayBeLake, tin.origin + self.largest.1, message).of_elevations([self.level])
    }
}

/// The circle through three corners; `None` if its centre lies outside the triangle. In a Delaunay triangulation, no
/// corner lies inside it.
pub(super) fn inner_circle([a, b, c]: [DVec2; 3]) -> Option<(f64, DVec2)> {
    let (u, v) = (b - a, c - a);
    let is_acute = u.dot(v) > 0.0 && (a - b).dot(c - b) > 0.0 && (a - c).dot(b - c) > 0.0;
    let centre = (v.perp() * u.length_squared() - u.perp() * v.length_squared()) / (-2.0 * u.perp_dot(v));
    is_acute.then(|| (centre.length(), a + centre))
}

/// Distance from a piece of contour to the next level in the triangle `n` beyond it.
fn distance_outside(tin: &Tin, t: u32, i: usize, n: u32, level: f64) -> Option<f64> {
    let apex = tin.triangles[n as usize][(tin.edge_towards(n, t)? + 2) % 3] as usize;
    let [a, b] = tin.edge(t, i).map(|v| tin.positions[v as usize]);
    let is_other = tin.heights[apex].is_finite() && tin.heights[apex] != level;
    is_other.then(|| ((b - a).perp_dot(tin.positions[apex] - a) / a.distance(b)).abs())
}

/// How much the contours of a map turn, radians per map unit of their length.
fn turn_per_length(map: &ContourMap) -> f64 {
    let turns = map.contours.iter().flat_map(|c| c.points.windows(3));
    let turn: f64 = turns.map(|p| (p[1] - p[0]).angle_to(p[2] - p[1]).abs()).filter(|turn| turn.is_finite()).sum();
    turn / map.contours.iter().map(|c| c.length()).sum::<f64>()
}
