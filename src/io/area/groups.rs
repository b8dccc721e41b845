//! Which polygons cross themselves, and which overlap or share an edge.
//!
//! Boxes along the edges are searched, not upright ones: those of an outline with long spikes would all meet. Two polygons
//! are compared only if they are not connected by others already. So many nearly equal polygons take little time.

use std::path::Path;

use geo::coordinate_position::{CoordPos, CoordinatePosition};
use geo::{Area, BooleanOps, BoundingRect, Coord};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};

use super::{Member, REMEDY};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::parallel;
use tokosen_core::base::union_find::UnionFind;
use tokosen_core::geometry::{BoxTree, Meeting, OrientedBox, Segment, meeting, place};

/// The edges of a polygon, with a tree of their boxes.
struct Edges {
    edges: Vec<Segment>,
    tree: BoxTree,
}

/// Checks that no polygon crosses itself. Then gives each polygon the number of its group's first polygon. Polygons of one
/// group overlap or share an edge, not only single points, or others connect them. `may_unite` tells which pairs of
/// features count.
///
/// # Errors
/// The rings of one polygon cross.
pub(super) fn groups(path: &Path, members: &[Member], may_unite: &dyn Fn(u64, u64) -> bool) -> Result<Vec<usize>> {
    let edges: Vec<Edges> = members.iter().map(Edges::of).collect();
    if let Some((member, p)) = members.iter().zip(&edges).find_map(|(m, edges)| Some((m, edges.own_crossing()?))) {
        let feature = member.feature;
        let message = format!("feature {feature}: its boundary crosses itself at {:.3} {:.3}; {REMEDY}", p.x, p.y);
        return Err(Error::file(path, message));
    }
    let mut groups = UnionFind::new(members.len());
    for [m, n] in near_pairs(members) {
        if groups.root(m) != groups.root(n)
            && may_unite(members[m].feature, members[n].feature)
            && have_common_ground([&members[m], &members[n]], [&edges[m], &edges[n]])
        {
            groups.unite(m, n);
        }
    }
    Ok((0..members.len()).map(|m| groups.root(m)).collect())
}

impl Edges {
    fn of(member: &Member) -> Self {
        let rings = std::iter::once(member.polygon.exterior()).chain(member.polygon.interiors());
        let point = |c: Coord| DVec2::new(c.x, c.y);
        let lines = rings.flat_map(|ring| ring.lines()).filter(|line| line.start != line.end);
        let edges: Vec<Segment> = lines.map(|l| Segment { a: point(l.start), b: point(l.end) }).collect();
        let tree = BoxTree::new(&parallel::map_each(&edges, along));
        Self { edges, tree }
    }

    /// The edges that may meet an edge, with their numbers.
    fn near(&self, edge: &Segment) -> impl Iterator<Item = (usize, &Segment)> {
        self.tree.near(along(edge)).map(|k| (k as usize, &self.edges[k as usize]))
    }

    /// The first place, by its coordinates, where two of the edges cross.
    fn own_crossing(&self) -> Option<DVec2> {
        let crossings = parallel::flat_map(self.edges.len(), |i| {
            let s = &self.edges[i];
            let later = self.near(s).filter(|(j, t)| i < *j && meeting(s, t) == Meeting::Cross);
            later.map(|(_, t)| place(s, t)).collect::<Vec<_>>()
        });
        crossings.into_iter().min_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)))
    }
}

fn along(edge: &Segment) -> OrientedBox {
    OrientedBox::around(&[edge.a, edge.b])
}

/// Pairs of polygons whose boxes meet, in order.
fn near_pairs(members: &[Member]) -> Vec<[usize; 2]> {
    let boxes = members.iter().enumerate().filter_map(|(m, member)| {
        let bounds = member.polygon.bounding_rect()?;
        let corners = [bounds.min(), bounds.max()].map(|c| [c.x, c.y]);
        Some(GeomWithData::new(Rectangle::from_corners(corners[0], corners[1]), m))
    });
    let boxes = RTree::bulk_load(boxes.collect());
    let pairs = boxes.intersection_candidates_with_other_tree(&boxes);
    let mut pairs: Vec<[usize; 2]> = pairs.map(|(a, b)| [a.data, b.data]).filter(|[m, n]| m < n).collect();
    pairs.sort_unstable();
    pairs
}

/// Whether two polygons overlap or share an edge.
fn have_common_ground(members: [&Member; 2], edges: [&Edges; 2]) -> bool {
    let [few, many] = if edges[0].edges.len() <= edges[1].edges.len() { edges } else { [edges[1], edges[0]] };
    let mut is_touched = false;
    for s in &few.edges {
        for (_, t) in many.near(s) {
            match meeting(s, t) {
                Meeting::Apart => {}
                Meeting::Touch => is_touched = true,
                Meeting::Cross | Meeting::Overlap => return true,
            }
        }
    }
    let [a, b] = members.map(|member| &member.polygon);
    let is_in = |inner: &geo::Polygon<f64>, outer: &geo::Polygon<f64>| {
        let mut positions = inner.exterior().coords().map(|c| outer.coordinate_position(c));
        positions.find(|p| *p != CoordPos::OnBoundary) == Some(CoordPos::Inside)
    };
    is_in(a, b) || is_in(b, a) || (is_touched && a.intersection(b).unsigned_area() > 0.0)
}
