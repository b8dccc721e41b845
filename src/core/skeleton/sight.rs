//! Lines of sight within a sub-domain: they must not cross a contour or the frame.
//!
//! A line of sight may run along a contour and may touch it. Contours that were traced on a grid have their vertices on
//! its rows, and so have the midpoints between two of them. Lines of sight that run exactly through vertices are
//! therefore common.

use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashSet, VecDeque};

use glam::DVec2;

use super::branches::{BranchLevels, is_on_border};
use super::cone::Cone;
use crate::tin::{NONE, Tin};

/// A point this near to a line of sight lies on it, as a share of the line's length.
const ON_SIGHT: f64 = 1e-9;
/// Number of edges that are tried first.
const BLOCKING: usize = 8;
/// Most views of a search, without those as narrow as a line. With more, a search by distance takes less time.
const MOST_VIEWS: usize = 1 << 11;

/// A line of sight, as a straight line from a point in a direction.
struct Sight {
    from: DVec2,
    way: DVec2,
}

impl Sight {
    /// -1 on the right of the line, 0 on it, 1 on the left of it.
    fn side(&self, p: DVec2) -> i8 {
        let off = self.way.perp_dot(p - self.from);
        let slack = ON_SIGHT * self.way.length_squared();
        i8::from(off > slack) - i8::from(off < -slack)
    }

    /// Whether the line leads through an edge, from the left of the edge to the right. It is clear of both ends of the edge, and
    /// both its own ends are clear of the edge.
    fn crosses(&self, [u, v]: &[DVec2; 2]) -> bool {
        let near = ON_SIGHT * self.way.length() * u.distance(*v);
        let beyond = |p: DVec2| (v - u).perp_dot(p - u);
        self.side(*u) < 0 && self.side(*v) > 0 && beyond(self.from + self.way) < -near && beyond(self.from) > near
    }

    /// Position along the line, as a share of its length.
    fn along(&self, p: DVec2) -> f64 {
        self.way.dot(p - self.from) / self.way.length_squared()
    }
}

/// Lines of sight from one point of triangle `t`, and the edges that ended the last of them. Places near each other are mostly
/// hidden by one edge, and the way to it may be long.
pub(super) struct Sights<'a> {
    tin: &'a Tin,
    t: u32,
    from: DVec2,
    blocking: VecDeque<[DVec2; 2]>,
}

impl<'a> Sights<'a> {
    pub fn new(tin: &'a Tin, t: u32, from: DVec2) -> Self {
        Self { tin, t, from, blocking: VecDeque::new() }
    }

    /// Whether `to` can be seen without crossing a contour or the frame.
    pub fn sees(&mut self, to: DVec2) -> bool {
        let sight = Sight { from: self.from, way: to - self.from };
        if sight.way.length_squared() == 0.0 {
            return true;
        }
        if self.blocking.iter().any(|edge| sight.crosses(edge)) {
            return false;
        }
        match end_of(self.tin, self.t, &sight) {
            Way::Free => true,
            Way::Hidden => false,
            Way::Blocked(edge) => {
                self.blocking.truncate(BLOCKING - 1);
                self.blocking.push_front(edge);
                false
            }
        }
    }
}

/// How a line of sight ends.
enum Way {
    /// At the place that it leads to.
    Free,
    /// At a border edge.
    Blocked([DVec2; 2]),
    /// At a vertex.
    Hidden,
}

/// Follows a line of sight from a point of triangle `t`.
fn end_of(tin: &Tin, mut t: u32, sight: &Sight) -> Way {
    let to = sight.from + sight.way;
    let near = ON_SIGHT * sight.way.length();
    let (mut came_from, mut reached) = (NONE, 0.0);
    // A line of sight enters each triangle once at most, so this many steps are enough.
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
            let Some(n) = tin.across(t, i) else { return Way::Blocked([corners[i], corners[(i + 1) % 3]]) };
            (came_from, t) = (t, n);
            continue;
        }
        let passed = (0..3)
            .filter(|&k| sides[k] == 0)
            .map(|k| (sight.along(corners[k]), k))
            .filter(|&(along, _)| along > reached + ON_SIGHT)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((along, k)) = passed.filter(|p| p.0 < 1.0 - ON_SIGHT) else { return Way::Free };
        let vertex = tin.triangles[t as usize][k];
        let Some(n) = onwards(tin, t, vertex, sight) else { return Way::Hidden };
        (t, came_from, reached) = (n, NONE, along);
    }
    Way::Hidden
}

/// The triangle in which a line of sight continues beyond a vertex on it, if a way around the vertex leads there from
/// triangle `t`.
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
    reachable_around(tin, t, vertex).find(leads_on).map(|(t, _)| t)
}

/// A view through an edge: the triangle that it leaves, the edge, and the directions of the right and left limit of
/// the view.
struct View {
    triangle: u32,
    edge: usize,
    right: DVec2,
    left: DVec2,
    /// Nearest point of the edge.
    nearest: DVec2,
}

/// What a search by views found.
pub(super) enum Found {
    /// The distance of the nearest visible segment, if there is one.
    Nearest(Option<f64>),
    /// After [`MOST_VIEWS`], the distance up to which visible segments are known, and the cone with those that may be nearer.
    Open(f64, Cone),
}

/// Of the views in a heap, the one with the nearest edge comes first.
impl Ord for View {
    fn cmp(&self, other: &Self) -> Ordering {
        other.nearest.length_squared().total_cmp(&self.nearest.length_squared())
    }
}

impl PartialOrd for View {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for View {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for View {}

/// Distance from the point of `sights` to the nearest visible contour segment of one level. The segment's nearest
/// point must be visible. None if the sub-domain has no such segment.
///
/// The view spreads from triangle to triangle, the nearest edge first. Each edge narrows it, and it ends at the nearest
/// segment found so far. The time depends on the number of visible triangles up to there, not on that of hidden
/// segments. After [`MOST_VIEWS`] it ends. Branches without the level are left out. A view may be as narrow as a line
/// between two vertices. What such a view shows is checked again with [`Sights::sees`].
///
/// Long because the view, its stack of edges and the nearest distance change together.
pub(super) fn nearest_in_sight(sights: &mut Sights, branches: &BranchLevels, level: f64) -> Found {
    let (tin, t, from) = (sights.tin, sights.t, sights.from);
    let mut best = f64::INFINITY;
    let ends = |t: u32, i: usize| tin.edge(t, i).map(|v| tin.positions[v as usize] - from);
    let not_right_of = |a: DVec2, b: DVec2| a.perp_dot(b) >= -ON_SIGHT * a.length() * b.length();
    let is_line = |view: &View| not_right_of(view.left, view.right) && view.left.dot(view.right) > 0.0;
    let mut views: BinaryHeap<View> = (0..3)
        .map(|edge| {
            let [right, left] = ends(t, edge);
            View { triangle: t, edge, right, left, nearest: nearest_to_origin(right, left) }
        })
        .collect();
    // A view as narrow as a line passes a vertex on both sides. Without this set, their number would double at each
    // vertex of a row.
    let mut lines = HashSet::new();
    let mut count = 0;
    while let Some(view) = views.pop() {
        count += usize::from(!is_line(&view));
        if count > MOST_VIEWS {
            let limits = std::iter::once(&view).chain(&views).map(|view| [view.right, view.left]);
            return Found::Open(best, Cone::around(from, limits));
        }
        let [a, b] = ends(view.triangle, view.edge);
        let nearest = view.nearest;
        if nearest.length() >= best {
            break;
        }
        let shows = |p: DVec2| not_right_of(view.right, p) && not_right_of(p, view.left);
        for (v, at) in tin.edge(view.triangle, view.edge).into_iter().zip([a, b]) {
            if is_on_border(tin, v)
                && tin.heights[v as usize] == level
                && at.length() < best
                && shows(at)
                && leads_away(tin, view.triangle, v, from)
                && sights.sees(from + at)
            {
                best = at.length();
            }
        }
        if tin.border_level(view.triangle, view.edge) == Some(level) {
            if shows(nearest) && sights.sees(from + nearest) {
                best = nearest.length();
            }
            continue;
        }
        let Some(n) = tin.across(view.triangle, view.edge) else { continue };
        if branches.is_without(view.triangle, n, level) {
            continue;
        }
        let Some(entry) = tin.edge_towards(n, view.triangle) else { continue };
        for edge in [(entry + 1) % 3, (entry + 2) % 3] {
            let [a, b] = ends(n, edge);
            let nearest = nearest_to_origin(a, b);
            // A view leaves a triangle only forwards. One as narrow as a line would turn around a vertex without end.
            if !not_right_of(a, b) {
                continue;
            }
            // A view as narrow as a line is not narrowed further, so that it is recognised later. From a point on an
            // edge, the view through that edge is a half-plane, which is no narrow view.
            if is_line(&view) {
                let is_touched = not_right_of(a, view.left) && not_right_of(view.right, b);
                let bits = [view.right, view.left].map(|p| p.to_array().map(f64::to_bits));
                if is_touched && lines.insert((n, edge, bits)) {
                    views.push(View { triangle: n, edge, nearest, ..view });
                }
                continue;
            }
            let right = if view.right.perp_dot(a) > 0.0 { a } else { view.right };
            let left = if b.perp_dot(view.left) > 0.0 { b } else { view.left };
            if not_right_of(right, left) {
                views.push(View { triangle: n, edge, right, left, nearest });
            }
        }
    }
    Found::Nearest(best.is_finite().then_some(best))
}

/// Whether a contour segment at a vertex of triangle `t` leads away from `from`: the vertex is then its nearest point.
/// The segment itself may be hidden.
fn leads_away(tin: &Tin, t: u32, vertex: u32, from: DVec2) -> bool {
    let at = tin.positions[vertex as usize];
    reachable_around(tin, t, vertex).any(|(t, k)| {
        // Edge k leads from the vertex, edge k + 2 to it.
        [(k, k + 1), (k + 2, k + 2)].into_iter().any(|(edge, end)| {
            let away = tin.corners(t)[end % 3] - at;
            tin.border_level(t, edge % 3).is_some() && away.dot(at - from) >= 0.0
        })
    })
}

/// The triangles around a vertex that can be reached from `first` without crossing a contour or the frame, each with
/// the corner number of the vertex.
fn reachable_around(tin: &Tin, first: u32, vertex: u32) -> impl Iterator<Item = (u32, usize)> + '_ {
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
    use crate::tin::{TinInput, VertexKind, triangulate};

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
        let branches = BranchLevels::new(&tin);
        let found = |level: f64| match nearest_in_sight(&mut Sights::new(&tin, t, from), &branches, level) {
            Found::Nearest(found) => found,
            Found::Open(..) => panic!("few views"),
        };
        assert_eq!(found(10.0), Some(49.5));
        assert_eq!(found(20.0), None);
    }
}
