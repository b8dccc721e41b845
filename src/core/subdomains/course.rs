//! The contours that a line crosses, and the sub-domains between them.

use glam::DVec2;
use robust::{Coord, orient2d};

use super::regions::{Band, Regions};
use crate::tin::{NONE, Tin};

/// A crossing nearer to a vertex of the line than this share of a segment is at the vertex: a tolerance of rounding.
const AT_VERTEX: f64 = 1e-7;

/// The place where a line crosses the border of a sub-domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Distance along the line, map units.
    pub at: f64,
    /// Position relative to the origin of the triangulation.
    pub place: DVec2,
    /// The level of the contour or shore; none at the frame and at barrier edges.
    pub level: Option<f64>,
    /// The edge of the triangulation, by its vertices.
    pub edge: [u32; 2],
}

/// A piece of a line inside one sub-domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    /// The sub-domain; [`NONE`] outside the frame.
    pub region: u32,
    /// Where it begins and ends along the line, map units.
    pub from: f64,
    pub to: f64,
}

/// A line through the sub-domains.
#[derive(Debug, Clone, Default)]
pub(crate) struct Course {
    /// The pieces, one after the other.
    pub stretches: Vec<Stretch>,
    /// The crossings between them, one fewer. A contour that ends in the open is crossed inside one sub-domain.
    pub crossings: Vec<Crossing>,
}

impl Course {
    /// Follows a line (relative to the origin of the triangulation). The search for its first triangle starts at `near`,
    /// which becomes the triangle of the last point.
    pub fn new(tin: &Tin, regions: &Regions, points: &[DVec2], near: &mut u32) -> Self {
        let mut course = Self::default();
        let Some(&first) = points.first() else { return course };
        let mut t = tin.walk(*near, first).unwrap_or(NONE);
        let region = |t: u32| if t == NONE { NONE } else { regions.of_triangle[t as usize] };
        let mut from = 0.0;
        let mut walked = 0.0;
        for w in points.windows(2) {
            let length = w[0].distance(w[1]);
            if t == NONE {
                // Outside the triangulation. The line may come back.
                t = tin.walk(*near, w[1]).unwrap_or(NONE);
                if region(t) != NONE {
                    course.stretches.push(Stretch { region: NONE, from, to: walked + length });
                    let (at, place) = (walked + length, w[1]);
                    course.crossings.push(Crossing { at, place, level: None, edge: [NONE; 2] });
                    from = at;
                }
            } else {
                t = follow(tin, t, w[0], w[1], &mut |Crossed { triangle, edge, beyond, share }| {
                    let level = tin.border_level(triangle, edge);
                    let (before, after) = (region(triangle), region(beyond));
                    if level.is_none() && before == after {
                        return;
                    }
                    let at = walked + share * length;
                    course.stretches.push(Stretch { region: before, from, to: at });
                    // A line that was moved has its vertices exactly on those of contours.
                    let place = match share {
                        ..AT_VERTEX => w[0],
                        _ if share > 1.0 - AT_VERTEX => w[1],
                        _ => w[0].lerp(w[1], share),
                    };
                    course.crossings.push(Crossing { at, place, level, edge: tin.edge(triangle, edge) });
                    from = at;
                });
            }
            walked += length;
            if t != NONE {
                *near = t;
            }
        }
        course.stretches.push(Stretch { region: region(t), from, to: walked });
        course
    }
}

/// An edge that a line crosses.
struct Crossed {
    triangle: u32,
    edge: usize,
    beyond: u32,
    /// Share of the way along the segment.
    share: f64,
}

/// Walks from `a` in triangle `t` to `b`. Calls `visit` for each edge on the way. Returns the triangle of `b`; [`NONE`]
/// if it lies outside the triangulation.
fn follow(tin: &Tin, mut t: u32, a: DVec2, b: DVec2, visit: &mut impl FnMut(Crossed)) -> u32 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    let side = |p: DVec2, q: DVec2, r: DVec2| orient2d(coord(p), coord(q), coord(r));
    let mut from = NONE;
    for _ in 0..=tin.len() {
        if t == NONE {
            return NONE;
        }
        let leaves = |i: &usize| {
            let [u, v] = tin.edge(t, *i).map(|v| tin.positions[v as usize]);
            side(u, v, b) < 0.0 && side(a, b, u) <= 0.0 && side(a, b, v) >= 0.0
        };
        let back = |i: &usize| from != NONE && tin.neighbours[t as usize][*i] == from;
        let exit = (0..3).find(|i| leaves(i) && !back(i));
        let Some(edge) = exit else {
            // By rounding, the line may miss the edge through which it left. The walk finds the end all the same.
            return if tin.holds(t, b) { t } else { tin.walk(t, b).unwrap_or(NONE) };
        };
        let [u, v] = tin.edge(t, edge).map(|v| tin.positions[v as usize]);
        let (along, across) = (b - a, v - u);
        let share = ((u - a).perp_dot(across) / along.perp_dot(across)).clamp(0.0, 1.0);
        let beyond = tin.neighbours[t as usize][edge];
        visit(Crossed { triangle: t, edge, beyond, share: if share.is_nan() { 0.0 } else { share } });
        (from, t) = (t, beyond);
    }
    NONE
}

/// The band of a sub-domain; without limits outside the frame.
pub(crate) fn band_of(regions: &Regions, region: u32) -> Band {
    let everything = Band { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    regions.regions.get(region as usize).map_or(everything, |r| r.band)
}

/// Whether the first of two bands lies above the second.
pub(crate) fn is_above(a: Band, b: Band) -> bool {
    a.lo >= b.hi && (a.lo, a.hi) != (b.lo, b.hi)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Interval;
    use crate::subdomains::regions;
    use crate::tin::{TinInput, VertexKind, triangulate};

    #[test]
    fn a_line_down_a_slope_crosses_its_contours_in_order() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(40.0)], 0.0);
        for k in 0..5 {
            let y = f64::from(k) * 10.0;
            let points: Vec<DVec2> = (0..9).map(|i| DVec2::new(5.0 * f64::from(i), y)).collect();
            input.push_line(&points, y, VertexKind::Contour);
        }
        let tin = triangulate(input).unwrap();
        let regions = regions(&tin, &Interval { step: 10.0, base: 0.0, rounding: 0.0 });
        let points = [(3.0, 35.0), (7.0, 22.0), (20.0, 12.0), (20.0, 10.0), (33.0, 1.0)].map(DVec2::from);
        let points = points.map(|p| p - tin.origin);
        let course = Course::new(&tin, &regions, &points, &mut 0);
        let levels: Vec<f64> = course.crossings.iter().filter_map(|c| c.level).collect();
        assert_eq!(levels, [30.0, 20.0, 10.0]);
        let bands: Vec<f64> = course.stretches.iter().map(|s| regions.regions[s.region as usize].band.lo).collect();
        assert_eq!(bands, [30.0, 20.0, 10.0, 0.0]);
        for crossing in &course.crossings {
            let y = crossing.place.y + tin.origin.y;
            assert!((y - crossing.level.unwrap()).abs() < 1e-9, "{crossing:?}");
        }
        let end = course.stretches.last().unwrap().to;
        assert!((end - points.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>()).abs() < 1e-9);
    }
}
