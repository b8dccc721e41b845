//! The nearest contour in sight, however little of it can be seen.

use glam::DVec2;

use crate::tin::Tin;

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
pub(super) fn nearest_in_sight(tin: &Tin, t: u32, from: DVec2, level: f64) -> Option<f64> {
    let mut best = f64::INFINITY;
    let ends = |t: u32, i: usize| tin.edge(t, i).map(|v| tin.positions[v as usize] - from);
    let mut views: Vec<View> = (0..3)
        .map(|edge| {
            let [right, left] = ends(t, edge);
            View { triangle: t, edge, right, left }
        })
        .collect();
    while let Some(view) = views.pop() {
        let [a, b] = ends(view.triangle, view.edge);
        let nearest = nearest_to_origin(a, b);
        if nearest.length() >= best {
            continue;
        }
        if tin.border_level(view.triangle, view.edge) == Some(level) {
            if view.right.perp_dot(nearest) >= 0.0 && nearest.perp_dot(view.left) >= 0.0 {
                best = nearest.length();
            }
            continue;
        }
        let Some(n) = tin.across(view.triangle, view.edge) else { continue };
        let Some(entry) = tin.edge_towards(n, view.triangle) else { continue };
        for edge in [(entry + 1) % 3, (entry + 2) % 3] {
            let [a, b] = ends(n, edge);
            let right = if view.right.perp_dot(a) > 0.0 { a } else { view.right };
            let left = if b.perp_dot(view.left) > 0.0 { b } else { view.left };
            if right.perp_dot(left) > 0.0 {
                views.push(View { triangle: n, edge, right, left });
            }
        }
    }
    best.is_finite().then_some(best)
}

fn nearest_to_origin(a: DVec2, b: DVec2) -> DVec2 {
    let along = b - a;
    let square = along.length_squared();
    let share = if square > 0.0 { (-a.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    a + along * share
}
