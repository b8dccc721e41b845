//! What can be seen from a point of a sub-domain without looking across a contour or the frame.
//!
//! A sight may run along a contour and may touch it, but not cross it. Contours that were cut from a grid have their
//! vertices on its rows, and so have the centres between two of them: sights that run through vertices exactly are common.

use std::collections::HashSet;

use glam::DVec2;

use crate::tin::{NONE, Tin, VertexKind};

/// How far off a sight something may lie to count as on it, as a share of the sight's length.
const ON_SIGHT: f64 = 1e-9;

/// A straight line from one point to another, for questions about where others lie.
struct Sight {
    from: DVec2,
    way: DVec2,
}

impl Sight {
    /// -1 right of the line, 0 on it, 1 left of it.
    fn side(&self, p: DVec2) -> i8 {
        let off = self.way.perp_dot(p - self.from);
        let slack = ON_SIGHT * self.way.length_squared();
        i8::from(off > slack) - i8::from(off < -slack)
    }

    /// How far along the line, as a share of its length.
    fn along(&self, p: DVec2) -> f64 {
        self.way.dot(p - self.from) / self.way.length_squared()
    }
}

/// Whether `to` can be seen from `from`, a point of triangle `t`, without crossing a contour or the frame.
pub(super) fn sees(tin: &Tin, t: u32, from: DVec2, to: DVec2) -> bool {
    let sight = Sight { from, way: to - from };
    if sight.way.length_squared() == 0.0 {
        return true;
    }
    let near = ON_SIGHT * sight.way.length();
    let (mut t, mut came_from, mut reached) = (t, NONE, 0.0);
    // A sight passes each triangle once, so that this many steps are always enough.
    for _ in 0..=tin.len() {
        let corners = tin.corners(t);
        let sides = corners.map(|p| sight.side(p));
        let exit = (0..3).find(|&i| {
            let [u, v] = [corners[i], corners[(i + 1) % 3]];
            let entered = came_from != NONE && tin.neighbours[t as usize][i] == came_from;
            let crosses = sides[i] < 0 && sides[(i + 1) % 3] > 0;
            crosses && !entered && (v - u).perp_dot(to - u) < -near * u.distance(v)
        });
        if let Some(i) = exit {
            let Some(n) = tin.across(t, i) else { return false };
            (came_from, t) = (t, n);
            continue;
        }
        let passed = (0..3)
            .filter(|&k| sides[k] == 0)
            .map(|k| (sight.along(corners[k]), k))
            .filter(|&(along, _)| along > reached + ON_SIGHT)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((along, k)) = passed.filter(|p| p.0 < 1.0 - ON_SIGHT) else { return true };
        let vertex = tin.triangles[t as usize][k];
        let Some(n) = onwards(tin, t, vertex, &sight) else { return false };
        (t, came_from, reached) = (n, NONE, along);
    }
    false
}

/// The triangle that a sight goes on in beyond a vertex on it, if it can be reached around the vertex from triangle `t`.
fn onwards(tin: &Tin, t: u32, vertex: u32, sight: &Sight) -> Option<u32> {
    let leads_on = |&(t, k): &(u32, usize)| {
        let corners = tin.corners(t);
        let [at, right, left] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
        let ahead = |p: DVec2| sight.along(p) > sight.along(at);
        match (sight.side(right), sight.side(left)) {
            (-1, 1) => true,
            (0, 1) => ahead(right),
            (-1, 0) => ahead(left),
            _ => false,
        }
    };
    around(tin, t, vertex).find(leads_on).map(|(t, _)| t)
}

/// A view through an edge: the triangle that it leads out of, the edge, and the directions of the view's right and left end.
struct View {
    triangle: u32,
    edge: usize,
    right: DVec2,
    left: DVec2,
}

/// Distance from a point in triangle `t` to the nearest segment of contour of one level whose nearest point can be seen
/// from there; none if there is no such segment in the sub-domain.
///
/// The view spreads from triangle to triangle, narrowed by each edge that it passes, and no further than the nearest
/// segment found so far. So it takes as long as there are triangles in sight, no matter how many segments are hidden.
/// Views may be as narrow as a line between two vertices; what such a view shows is looked at once more with [`sees`].
pub(super) fn nearest_in_sight(tin: &Tin, t: u32, from: DVec2, level: f64) -> Option<f64> {
    let mut best = f64::INFINITY;
    let ends = |t: u32, i: usize| tin.edge(t, i).map(|v| tin.positions[v as usize] - from);
    let not_right_of = |a: DVec2, b: DVec2| a.perp_dot(b) >= -ON_SIGHT * a.length() * b.length();
    let mut views: Vec<View> = (0..3)
        .map(|edge| {
            let [right, left] = ends(t, edge);
            View { triangle: t, edge, right, left }
        })
        .collect();
    // Views as narrow as a line pass a vertex on both sides. Along a row of vertices they would double at each.
    let mut lines = HashSet::new();
    while let Some(view) = views.pop() {
        let [a, b] = ends(view.triangle, view.edge);
        let nearest = nearest_to_origin(a, b);
        if nearest.length() >= best {
            continue;
        }
        let shows = |p: DVec2| not_right_of(view.right, p) && not_right_of(p, view.left);
        for (v, at) in tin.edge(view.triangle, view.edge).into_iter().zip([a, b]) {
            let candidate = matches!(tin.kinds[v as usize], VertexKind::Contour | VertexKind::Shore)
                && tin.heights[v as usize] == level;
            if candidate
                && at.length() < best
                && shows(at)
                && leads_away(tin, view.triangle, v, from)
                && sees(tin, t, from, from + at)
            {
                best = at.length();
            }
        }
        if tin.border_level(view.triangle, view.edge) == Some(level) {
            if shows(nearest) && sees(tin, t, from, from + nearest) {
                best = nearest.length();
            }
            continue;
        }
        let Some(n) = tin.across(view.triangle, view.edge) else { continue };
        let Some(entry) = tin.edge_towards(n, view.triangle) else { continue };
        for edge in [(entry + 1) % 3, (entry + 2) % 3] {
            let [a, b] = ends(n, edge);
            // A straight view leaves a triangle forwards only. One as narrow as a line would turn around a vertex for ever.
            if !not_right_of(a, b) {
                continue;
            }
            // What is as narrow as a line stays as it is, so that it is known again. From a point on an edge the view through
            // that edge is half of all around.
            if not_right_of(view.left, view.right) && view.left.dot(view.right) > 0.0 {
                let is_touched = not_right_of(a, view.left) && not_right_of(view.right, b);
                let bits = [view.right, view.left].map(|p| p.to_array().map(f64::to_bits));
                if is_touched && lines.insert((n, edge, bits)) {
                    views.push(View { triangle: n, edge, ..view });
                }
                continue;
            }
            let right = if view.right.perp_dot(a) > 0.0 { a } else { view.right };
            let left = if b.perp_dot(view.left) > 0.0 { b } else { view.left };
            if not_right_of(right, left) {
                views.push(View { triangle: n, edge, right, left });
            }
        }
    }
    best.is_finite().then_some(best)
}

/// Whether a segment of contour at a vertex of triangle `t` leads away from `from`, so that the vertex is its nearest point.
/// The segment itself may be out of sight.
fn leads_away(tin: &Tin, t: u32, vertex: u32, from: DVec2) -> bool {
    let at = tin.positions[vertex as usize];
    around(tin, t, vertex).any(|(t, k)| {
        // Edge k leaves the vertex, edge k + 2 comes to it.
        [(k, k + 1), (k + 2, k + 2)].into_iter().any(|(edge, end)| {
            let away = tin.corners(t)[end % 3] - at;
            tin.border_level(t, edge % 3).is_some() && away.dot(at - from) >= 0.0
        })
    })
}

/// The triangles around a vertex that can be reached from one of them without crossing a contour or the frame, each with
/// the number of its corner there.
fn around(tin: &Tin, first: u32, vertex: u32) -> impl Iterator<Item = (u32, usize)> + '_ {
    let corner = move |t: u32| tin.triangles[t as usize].iter().position(|&v| v == vertex).map(|k| (t, k));
    let turn = move |step: usize| {
        std::iter::successors(corner(first), move |&(t, k)| {
            tin.across(t, (k + step) % 3).filter(|&n| n != first).and_then(corner)
        })
    };
    turn(0).chain(turn(2).skip(1))
}

fn nearest_to_origin(a: DVec2, b: DVec2) -> DVec2 {
    let along = b - a;
    let square = along.length_squared();
    let share = if square > 0.0 { (-a.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    a + along * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::{TinInput, triangulate};

    #[test]
    fn a_view_along_a_row_of_vertices_comes_to_an_end() {
        let mut input = TinInput::new([DVec2::new(0.0, -1.0), DVec2::new(50.0, 1.0)], 0.0);
        for i in 0..50 {
            for (x, y) in [(0.0, 0.0), (0.5, 1.0), (0.5, -1.0)] {
                input.push(DVec2::new(x + f64::from(i), y), 5.0, VertexKind::Spot);
            }
        }
        let wall = [DVec2::new(50.0, -1.0), DVec2::new(50.0, 1.0)];
        input.push_line(&wall, 10.0, VertexKind::Contour);
        let tin = triangulate(input).unwrap();
        let from = DVec2::new(0.5, 0.0);
        let t = tin.locate(0, from).unwrap();
        assert_eq!(nearest_in_sight(&tin, t, from, 10.0), Some(49.5));
        assert_eq!(nearest_in_sight(&tin, t, from, 20.0), None);
    }
}
