//! A quick check that a level is hidden: whether views from a point end before they reach it.
//!
//! Most points of ridge and canyon lines lie deep in spurs and gullies, from which no other level can be seen. Views are
//! taken a little too wide here. So what this check calls hidden is hidden for the exact search too.

use glam::DVec2;

use super::branches::{BranchLevels, is_on_border};
use crate::tin::Tin;

/// Views pass vertices this near to them, as a share of the size of the map. It is more than lines of sight do.
const WIDER: f64 = 1e-8;
/// Most views of a check. With more, the level counts as not hidden, and the exact search decides.
const MOST_VIEWS: usize = 1 << 14;

/// Checks from which points levels are hidden.
pub(super) struct Glimpse<'a> {
    tin: &'a Tin,
    branches: BranchLevels,
    /// Views pass vertices this near to them, map units.
    slack: f64,
}

/// A view into a triangle.
struct View {
    triangle: u32,
    /// The edge of the triangle that the view enters through.
    entry: usize,
    /// The directions of the right and left limit; none for a view through the edge on which the point lies.
    limits: Option<[DVec2; 2]>,
}

impl<'a> Glimpse<'a> {
    /// Prepares checks in all sub-domains of a triangulation.
    pub fn new(tin: &'a Tin) -> Self {
        let extent = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (lo, hi) = tin.positions.iter().fold(extent, |(lo, hi), &p| (lo.min(p), hi.max(p)));
        Self { tin, branches: BranchLevels::new(tin), slack: WIDER * lo.distance(hi) }
    }

    /// The levels in the branches.
    pub fn branches(&self) -> &BranchLevels {
        &self.branches
    }

    /// Whether no vertex of a level can be seen from `from`, a point in or on triangle `t`. False if that is not sure.
    pub fn hides(&self, t: u32, from: DVec2, level: f64) -> bool {
        self.look(t, from, level).0
    }

    /// The answer of [`hides`](Self::hides), and the number of views that it took.
    fn look(&self, t: u32, from: DVec2, level: f64) -> (bool, usize) {
        let mut views = Vec::new();
        if self.spread(t, from, level, None, &mut views) {
            return (false, 0);
        }
        let mut count = 0;
        while let Some(view) = views.pop() {
            count += 1;
            if count > MOST_VIEWS || self.spread(view.triangle, from, level, Some(view), &mut views) {
                return (false, count);
            }
        }
        (true, count)
    }

    /// Adds the views out of a triangle. Returns whether the triangle has a corner on the level.
    fn spread(&self, t: u32, from: DVec2, level: f64, entry: Option<View>, views: &mut Vec<View>) -> bool {
        let tin = self.tin;
        // The ends of the edge of entry are corners of the triangle before too.
        let (edges, new_corners, limits) = match &entry {
            None => (0..3, 0..3, None),
            Some(View { entry, limits, .. }) => (entry + 1..entry + 3, entry + 2..entry + 3, *limits),
        };
        let corners = tin.triangles[t as usize];
        let on_level = |v: u32| tin.heights[v as usize] == level && is_on_border(tin, v);
        if new_corners.into_iter().any(|k| on_level(corners[k % 3])) {
            return true;
        }
        for i in edges {
            let Some(n) = tin.across(t, i % 3) else { continue };
            if self.branches.is_without(t, n, level) {
                continue;
            }
            let [a, b] = tin.edge(t, i % 3).map(|v| tin.positions[v as usize] - from);
            if let (Some(limits), Some(entry)) = (self.narrowed(limits, a, b), tin.edge_towards(n, t)) {
                views.push(View { triangle: n, entry, limits });
            }
        }
        false
    }

    /// The limits of a view through an edge from `a` to `b`; none if no view passes it.
    #[allow(clippy::option_option)]
    fn narrowed(&self, limits: Option<[DVec2; 2]>, a: DVec2, b: DVec2) -> Option<Option<[DVec2; 2]>> {
        // The left one may be to the right of the other by this much, for limits that are as wide as the slack.
        let off = |right: DVec2, left: DVec2| self.slack * (right.length() + left.length());
        let opening = a.perp_dot(b);
        if opening < -off(a, b) {
            return None;
        }
        let Some([right, left]) = limits else {
            return Some((opening > off(a, b)).then_some([a, b]));
        };
        let new_right = if right.perp_dot(a) > 0.0 { a } else { right };
        let new_left = if b.perp_dot(left) > 0.0 { b } else { left };
        let opening = new_right.perp_dot(new_left);
        if opening < -off(new_right, new_left) {
            return None;
        }
        // Limits that nearly coincide are not taken over: the view stays wider than it is.
        let is_clear = opening > off(new_right, new_left);
        Some(Some(if is_clear { [new_right, new_left] } else { [right, left] }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::{TinInput, VertexKind, triangulate};

    /// A corridor of level 10 with a bend, which opens into a wide floor below a line of level 20.
    fn bent_corridor() -> Tin {
        let mut input = TinInput::new([DVec2::new(-50.0, 0.0), DVec2::new(200.0, 60.0)], 1e-6);
        let corners = [(-50, 50), (100, 50), (100, 1), (0, 1), (0, 0), (101, 0), (101, 50), (200, 50)];
        let mut wall = Vec::new();
        for pair in corners.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)));
            let steps = a.distance(b).round() as u32;
            wall.extend((0..steps).map(|k| a.lerp(b, f64::from(k) / f64::from(steps))));
        }
        wall.push(DVec2::new(200.0, 50.0));
        input.push_line(&wall, 10.0, VertexKind::Contour);
        input.push_line(&[DVec2::new(-50.0, 60.0), DVec2::new(200.0, 60.0)], 20.0, VertexKind::Contour);
        for k in 0..2000 {
            let (x, y) = ((f64::from(k) * 0.618).fract(), (f64::from(k) * 0.414).fract());
            input.push(DVec2::new(250.0 * x - 50.0, 51.0 + 8.0 * y), 15.0, VertexKind::Spot);
        }
        triangulate(input).unwrap()
    }

    #[test]
    fn a_view_out_of_a_bent_corridor_ends_in_it() {
        let tin = bent_corridor();
        let glimpse = Glimpse::new(&tin);
        let look = |x: f64, y: f64| {
            let place = DVec2::new(x, y) - tin.origin;
            glimpse.look(tin.locate(0, place).unwrap(), place, 20.0)
        };
        let (is_hidden, views) = look(5.25, 0.5);
        assert!(is_hidden && views < 300, "{views}");
        assert!(!look(100.5, 40.25).0);
        assert!(!look(50.25, 55.25).0);
    }
}
