//! Edges that get a vertex where lines meet them: [`Noded`].

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DVec2, DVec3};
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use super::ON;

/// Edges that do not cross. What is nearer to an edge or a vertex than [`ON`] lies on it.
pub(super) struct Noded {
    /// Places of the vertices, in cells.
    pub places: Vec<DVec2>,
    /// The vertices, map units and metres.
    pub vertices: Vec<DVec3>,
    pub edges: Vec<[u32; 2]>,
    /// Vertices on edges, and their shares of the way along them.
    on_edges: BTreeMap<u32, Vec<(f64, u32)>>,
    tree: RTree<GeomWithData<Line<[f64; 2]>, u32>>,
}

impl Noded {
    /// Edges that meet at vertices only.
    pub fn new(places: Vec<DVec2>, vertices: Vec<DVec3>, edges: Vec<[u32; 2]>) -> Self {
        let line = |(number, edge): (u32, &[u32; 2])| {
            let [from, to] = edge.map(|v| places[v as usize].to_array());
            GeomWithData::new(Line::new(from, to), number)
        };
        let tree = RTree::bulk_load((0..).zip(&edges).map(line).collect());
        Self { places, vertices, edges, on_edges: BTreeMap::new(), tree }
    }

    /// Adds a line. It gets a vertex where it crosses edges, with the height of these, and edges get one where it ends on them.
    pub fn add(&mut self, line: &[DVec3], place: impl Fn(DVec3) -> DVec2) {
        let mut from = None;
        for v in line {
            let to = self.vertex(place(*v), *v);
            if let Some(from) = from.filter(|from| *from != to) {
                self.add_edge(from, to);
            }
            from = Some(to);
        }
    }

    /// Some of the edges, parted at the vertices on them.
    pub fn pieces(&self, edges: Range<usize>) -> Vec<[u32; 2]> {
        let mut pieces = Vec::with_capacity(edges.len());
        for number in edges {
            let [from, to] = self.edges[number];
            let mut on_edge = self.on_edges.get(&(number as u32)).cloned().unwrap_or_default();
            on_edge.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let mut chain: Vec<u32> = on_edge.into_iter().map(|(_, v)| v).collect();
            chain.insert(0, from);
            chain.push(to);
            chain.dedup();
            pieces.extend(chain.windows(2).map(|ends| [ends[0], ends[1]]));
        }
        pieces
    }

    /// The vertex at a place; a new one, if there is none.
    fn vertex(&mut self, at: DVec2, vertex: DVec3) -> u32 {
        let near = self.near(at, at);
        let ends = near.iter().flat_map(|&edge| self.edges[edge as usize]);
        if let Some(same) = ends.into_iter().find(|&v| self.places[v as usize].distance(at) <= ON) {
            return same;
        }
        let v = self.push(at, vertex);
        for edge in near {
            if self.is_on(at, self.edges[edge as usize]) {
                self.part(edge, v);
            }
        }
        v
    }

    fn add_edge(&mut self, from: u32, to: u32) {
        let number = self.edges.len() as u32;
        let own = [from, to];
        let [a, b] = own.map(|v| self.places[v as usize]);
        let near = self.near(a, b);
        self.edges.push(own);
        for edge in near {
            let ends = self.edges[edge as usize];
            let [u, v] = ends.map(|v| self.places[v as usize]);
            let touching: Vec<u32> =
                ends.into_iter().filter(|&v| !own.contains(&v) && self.is_on(self.places[v as usize], own)).collect();
            touching.iter().for_each(|&v| self.part(number, v));
            let meets = !touching.is_empty()
                || ends.iter().any(|v| own.contains(v))
                || own.iter().any(|&v| self.is_on(self.places[v as usize], ends));
            let aside = |p: DVec2, from: DVec2, to: DVec2| (to - from).perp_dot(p - from);
            let crosses = aside(u, a, b) * aside(v, a, b) < 0.0 && aside(a, u, v) * aside(b, u, v) < 0.0;
            if !meets && crosses {
                let share = aside(u, a, b) / (aside(u, a, b) - aside(v, a, b));
                let [first, last] = ends.map(|v| self.vertices[v as usize]);
                let crossing = self.push(u.lerp(v, share), first.lerp(last, share));
                self.part(edge, crossing);
                self.part(number, crossing);
            }
        }
        self.tree.insert(GeomWithData::new(Line::new(a.to_array(), b.to_array()), number));
    }

    fn push(&mut self, at: DVec2, vertex: DVec3) -> u32 {
        self.places.push(at);
        self.vertices.push(vertex);
        self.places.len() as u32 - 1
    }

    /// The edges near the box between two places, in their order.
    fn near(&self, a: DVec2, b: DVec2) -> Vec<u32> {
        let around = AABB::from_corners((a.min(b) - ON).to_array(), (a.max(b) + ON).to_array());
        let mut near: Vec<u32> = self.tree.locate_in_envelope_intersecting(&around).map(|edge| edge.data).collect();
        near.sort_unstable();
        near
    }

    /// Whether a place lies on an edge.
    fn is_on(&self, at: DVec2, edge: [u32; 2]) -> bool {
        let [u, v] = edge.map(|v| self.places[v as usize]);
        let share = (at - u).dot(v - u) / u.distance_squared(v);
        u.lerp(v, share.clamp(0.0, 1.0)).distance(at) <= ON
    }

    /// Notes a vertex on an edge.
    fn part(&mut self, edge: u32, vertex: u32) {
        let [u, v] = self.edges[edge as usize].map(|v| self.places[v as usize]);
        let share = (self.places[vertex as usize] - u).dot(v - u) / u.distance_squared(v);
        self.on_edges.entry(edge).or_default().push((share, vertex));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_vertices_where_they_meet() {
        let places: Vec<DVec2> = [(0.0, 0.0), (10.0, 0.0), (0.0, 5.0), (10.0, 5.0)].map(DVec2::from).to_vec();
        let vertices = places.iter().map(|p| p.extend(p.y)).collect();
        let mut noded = Noded::new(places, vertices, vec![[0, 1], [2, 3]]);
        let at = |x: f64, y: f64| DVec3::new(x, y, 100.0);
        // It ends on the first edge, crosses the second, and ends at a vertex that is there but for rounding.
        noded.add(&[at(2.0, 1e-9), at(4.0, 8.0), at(10.0, 5.0 + 1e-9)], |v| v.truncate());
        // It crosses the line and both edges.
        noded.add(&[at(3.0, -1.0), at(3.0, 9.0)], |v| v.truncate());
        let place = |v: u32| noded.places[v as usize].round().to_array().map(|c| c as i32);
        let pieces: Vec<[[i32; 2]; 2]> =
            noded.pieces(0..noded.edges.len()).iter().map(|ends| ends.map(place)).collect();
        assert_eq!(noded.places.len(), 4 + 3 + 2 + 3);
        let expected: [&[[i32; 2]]; 5] = [
            &[[0, 0], [2, 0], [3, 0], [10, 0]],
            &[[0, 5], [3, 5], [3, 5], [10, 5]],
            &[[2, 0], [3, 4], [3, 5], [4, 8]],
            &[[4, 8], [10, 5]],
            &[[3, -1], [3, 0], [3, 4], [3, 5], [3, 9]],
        ];
        let expected: Vec<[[i32; 2]; 2]> =
            expected.iter().flat_map(|chain| chain.windows(2).map(|ends| [ends[0], ends[1]])).collect();
        assert_eq!(pieces, expected);
        // A crossing has the height of the edge that was there.
        assert!(noded.vertices[7..].iter().any(|v| v.z == 5.0) && noded.vertices[4..7].iter().all(|v| v.z >= 5.0));
    }
}
