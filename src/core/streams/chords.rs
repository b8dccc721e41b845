//! Ways through an area, from edge to edge of its triangles.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::tin::{NONE, Tin};

/// The middles of the edges that span an area, its tips, and the steps between them. All steps lie inside triangles.
/// Places are relative to the origin of the triangulation.
pub(super) struct Chords<'a> {
    tin: &'a Tin,
    places: Vec<DVec2>,
    /// By node: the nodes that are one step away.
    steps: Vec<Vec<u32>>,
    /// The nodes at the tips of the area.
    tips: Vec<u32>,
    /// By triangle: the nodes on its edges.
    of_triangle: Vec<Vec<u32>>,
    /// The corners of the triangles inside, each once for each triangle.
    corners: RTree<GeomWithData<[f64; 2], u32>>,
}

impl<'a> Chords<'a> {
    /// Finds the steps through the triangles inside.
    pub fn new(tin: &'a Tin) -> Self {
        let inside = || (0..tin.len() as u32).filter(|&t| tin.is_inside(t));
        let corners = inside().flat_map(|t| tin.corners(t).map(|p| GeomWithData::new(p.to_array(), t)));
        let mut chords = Self {
            tin,
            places: Vec::new(),
            steps: Vec::new(),
            tips: Vec::new(),
            of_triangle: vec![Vec::new(); tin.len()],
            corners: RTree::bulk_load(corners.collect()),
        };
        let mut of_edge = BTreeMap::new();
        for t in inside() {
            let spanning: Vec<usize> = (0..3).filter(|&i| spans(tin, t, i)).collect();
            let middles: Vec<u32> = spanning
                .iter()
                .map(|&i| {
                    let [u, v] = tin.edge(t, i);
                    let middle = tin.positions[u as usize].midpoint(tin.positions[v as usize]);
                    *of_edge.entry([u.min(v), u.max(v)]).or_insert_with(|| chords.push(middle))
                })
                .collect();
            let [a, b, c] = tin.corners(t);
            match middles[..] {
                [only] => {
                    let tip = chords.push([c, a, b][spanning[0]]);
                    chords.tips.push(tip);
                    chords.join(tip, only);
                }
                [one, other] => chords.join(one, other),
                [..] => {
                    let centre = chords.push((a + b + c) / 3.0);
                    middles.iter().for_each(|&middle| chords.join(centre, middle));
                }
            }
            chords.of_triangle[t as usize] = middles;
        }
        chords
    }

    fn push(&mut self, place: DVec2) -> u32 {
        self.places.push(place);
        self.steps.push(Vec::new());
        (self.places.len() - 1) as u32
    }

    fn join(&mut self, a: u32, b: u32) {
        self.steps[a as usize].push(b);
        self.steps[b as usize].push(a);
    }

    /// The way through the area between the two ends that are furthest apart, and then the ways from the other entries to
    /// it, all in map units. Ends are the entries (map units), and the tips that are further than `own` from all entries.
    /// Empty if there are no two ends.
    pub fn courses(mut self, entries: &[DVec2], own: f64) -> Vec<Vec<DVec2>> {
        let origin = self.tin.origin;
        let near = RTree::bulk_load(entries.iter().map(|p| (*p - origin).to_array()).collect());
        let is_own =
            |&tip: &u32| near.locate_within_distance(self.places[tip as usize].to_array(), own * own).next().is_none();
        let mut ends: Vec<u32> = self.tips.iter().copied().filter(is_own).collect();
        let entered: Vec<u32> = entries.iter().filter_map(|p| self.enter(*p - origin)).collect();
        ends.extend(&entered);
        let from_first = ends.first().map(|&first| self.furthest(first, &ends));
        let Some(&from) = from_first.as_ref().and_then(|way| way.first()) else { return Vec::new() };
        let main = self.furthest(from, &ends);
        if main.len() < 2 {
            return Vec::new();
        }
        let (distances, before) = self.distances(&main);
        let mut is_on = vec![false; self.places.len()];
        main.iter().for_each(|&n| is_on[n as usize] = true);
        let mut ways = vec![main];
        for entry in entered.into_iter().filter(|&entry| distances[entry as usize].is_finite()) {
            // To the main way, or to a way that leads there.
            let step = |&n: &u32| (!is_on[n as usize]).then(|| before[n as usize]);
            let way: Vec<u32> = std::iter::successors(Some(entry), step).collect();
            way.iter().for_each(|&n| is_on[n as usize] = true);
            ways.extend(Some(way).filter(|way| way.len() > 1));
        }
        ways.iter().map(|way| way.iter().map(|&n| self.places[n as usize] + origin).collect()).collect()
    }

    /// Adds an entry: a node that is one step from the edges of its triangle or, outside, of those at the nearest corner.
    fn enter(&mut self, at: DVec2) -> Option<u32> {
        let entry = self.push(at);
        let from = self.corners.nearest_neighbor(&at.to_array())?;
        let (corner, near) = (*from.geom(), from.data);
        if let Some(t) = self.tin.locate(near, at).filter(|&t| self.tin.is_inside(t)) {
            self.of_triangle[t as usize].clone().into_iter().for_each(|middle| self.join(entry, middle));
        } else {
            let bank = self.push(corner.into());
            self.join(entry, bank);
            let around = self.corners.locate_all_at_point(&corner).map(|at| at.data);
            let middles: Vec<u32> = around.flat_map(|t| self.of_triangle[t as usize].iter().copied()).collect();
            middles.into_iter().for_each(|middle| self.join(bank, middle));
        }
        Some(entry)
    }

    /// The shortest way from the end that is furthest away to a node.
    fn furthest(&self, to: u32, ends: &[u32]) -> Vec<u32> {
        let (distances, before) = self.distances(&[to]);
        let reached = ends.iter().copied().filter(|&end| distances[end as usize].is_finite());
        let from = reached.max_by(|&a, &b| distances[a as usize].total_cmp(&distances[b as usize])).unwrap_or(to);
        let step = |&n: &u32| (n != to).then(|| before[n as usize]);
        std::iter::successors(Some(from), step).collect()
    }

    /// The length of the shortest way from any of some nodes to each node, and the node before it on this way (Dijkstra's
    /// algorithm).
    fn distances(&self, from: &[u32]) -> (Vec<f64>, Vec<u32>) {
        let mut distances = vec![f64::INFINITY; self.places.len()];
        let mut before = vec![NONE; self.places.len()];
        let mut heap: BinaryHeap<_> = from.iter().map(|&n| Reverse((0, n))).collect();
        from.iter().for_each(|&n| distances[n as usize] = 0.0);
        while let Some(Reverse((key, n))) = heap.pop() {
            let so_far = distances[n as usize];
            if key > so_far.to_bits() {
                continue;
            }
            for &next in &self.steps[n as usize] {
                let distance = so_far + self.places[n as usize].distance(self.places[next as usize]);
                if distance < distances[next as usize] {
                    distances[next as usize] = distance;
                    before[next as usize] = n;
                    // Lengths are not negative. So their bits are in their order.
                    heap.push(Reverse((distance.to_bits(), next)));
                }
            }
        }
        (distances, before)
    }
}

/// Whether an edge of a triangle has both ends, but no more, on the outline.
fn spans(tin: &Tin, t: u32, i: usize) -> bool {
    !tin.is_constraint(t, i) && tin.inner_neighbour(t, i).is_some()
}
