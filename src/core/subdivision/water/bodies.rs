//! Lakes in the form in which they are triangulated.

use std::borrow::Cow;
use std::collections::BTreeMap;

use geo::{BoundingRect, Contains, Coord, MultiPolygon, Point};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};

use crate::base::FeatureId;
use crate::base::error::{Finding, FindingKind, Result};
use crate::base::parallel;
use crate::geometry::{Border, BoxTree, Meeting, OrientedBox, Segment, meeting, point_distance, rings};
use crate::subdomains::Band;
use crate::tin::{Tin, TinInput, VertexKind};

/// A lake with its height and its shore.
#[derive(Debug, Clone)]
pub(crate) struct WaterBody {
    pub area: MultiPolygon<f64>,
    pub height: f64,
    pub feature: FeatureId,
    /// The shore inside the frame, with a vertex wherever it meets a contour of its level.
    pub shores: Vec<Vec<DVec2>>,
    /// Whether it is used.
    pub used: bool,
}

/// Vertices that shores add to segments of contours, by the number of the line and that of the segment.
pub(crate) type Nodes = BTreeMap<(u32, u32), Vec<DVec2>>;

/// All lakes.
#[derive(Debug, Clone, Default)]
pub(crate) struct WaterBodies {
    pub(crate) water_bodies: Vec<WaterBody>,
    pub(crate) nodes: Nodes,
}

impl WaterBodies {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.water_bodies.is_empty()
    }

    /// Those that the surface has.
    pub fn used(&self) -> impl Iterator<Item = &WaterBody> {
        self.water_bodies.iter().filter(|body| body.used)
    }

    /// Heights of the lakes by their numbers.
    pub fn heights(&self) -> Vec<f64> {
        self.water_bodies.iter().map(|body| body.height).collect()
    }

    /// Lakes to leave out where lines cross, each with the place; none if no lake is in use. `first` is a place on a line
    /// that crosses another. `crossing` gives the edges of all such lines.
    ///
    /// The lake nearest to each place is left out. An edge that crosses the shore of such a lake may cross nothing else,
    /// and waits for the next triangulation.
    ///
    /// # Errors
    /// Those of `crossing`.
    pub fn crossed(&self, first: DVec2, crossing: impl FnOnce() -> Result<Vec<Segment>>) -> Result<Vec<(u32, DVec2)>> {
        let used = (0u32..).zip(&self.water_bodies).filter(|(_, body)| body.used);
        let edges: Vec<(u32, Segment)> = used
            .flat_map(|(lake, body)| body.shores.iter().flat_map(move |shore| shore.windows(2).map(move |w| (lake, w))))
            .map(|(lake, w)| (lake, Segment { a: w[0], b: w[1] }))
            .collect();
        if edges.is_empty() {
            return Ok(Vec::new());
        }
        let tree = BoxTree::new(&parallel::map_each(&edges, |(_, edge)| OrientedBox::around(&[edge.a, edge.b])));
        let nearest = |place: DVec2| {
            let mut best = (f64::INFINITY, u32::MAX);
            for (edge, least) in tree.nearest_first(place) {
                if least > best.0 {
                    break;
                }
                let (lake, edge) = &edges[edge as usize];
                let found = (point_distance(place, edge), *lake);
                best = if found < best { found } else { best };
            }
            best.1
        };
        let mut found = vec![(nearest(first), first)];
        let mut is_left_out = vec![false; self.water_bodies.len()];
        is_left_out[found[0].0 as usize] = true;
        for edge in crossing()? {
            let crosses = |(lake, shore): &(u32, Segment)| {
                is_left_out[*lake as usize] && matches!(meeting(&edge, shore), Meeting::Cross | Meeting::Overlap)
            };
            let place = edge.a.midpoint(edge.b);
            let lake = nearest(place);
            let around = OrientedBox::around(&[edge.a, edge.b]);
            if !is_left_out[lake as usize] && !tree.near(around).any(|k| crosses(&edges[k as usize])) {
                is_left_out[lake as usize] = true;
                found.push((lake, place));
            }
        }
        Ok(found)
    }

    /// Leaves out a lake.
    pub fn leave_out(&mut self, lake: u32) {
        self.water_bodies[lake as usize].used = false;
    }

    /// Adds lines of one level each (the map's contours, then the frame extensions), and the shores. The lines' own
    /// points come first.
    pub fn push<'a>(&self, input: &mut TinInput, courses: impl Iterator<Item = (f64, Cow<'a, [DVec2]>)>) {
        let mut split: Vec<(u32, f64, &[DVec2])> = Vec::new();
        for (line, (level, points)) in (0u32..).zip(courses) {
            if self.nodes.range((line, 0)..=(line, u32::MAX)).next().is_none() {
                input.push_line(&points, level, VertexKind::Contour);
                continue;
            }
            let mut before = None;
            for (i, &p) in (0u32..).zip(points.iter()) {
                let v = input.push(p, level, VertexKind::Contour);
                match (before, i.checked_sub(1).and_then(|segment| self.nodes.get(&(line, segment)))) {
                    (Some(u), Some(nodes)) => split.extend([(u, level, &nodes[..]), (v, f64::NAN, &[][..])]),
                    (Some(u), None) => input.push_edge(u, v),
                    (None, _) => {}
                }
                before = Some(v);
            }
        }
        for pair in split.chunks_exact(2) {
            let ((mut from, level, nodes), (to, ..)) = (pair[0], pair[1]);
            for &node in nodes {
                let v = input.push(node, level, VertexKind::Contour);
                input.push_edge(from, v);
                from = v;
            }
            input.push_edge(from, to);
        }
        for body in self.water_bodies.iter().filter(|body| body.used) {
            body.shores.iter().for_each(|shore| input.push_line(shore, body.height, VertexKind::Shore));
        }
    }

    /// The triangulation, with the lake in which each triangle lies.
    pub fn mark(&self, tin: Tin) -> Tin {
        if self.water_bodies.is_empty() {
            return tin;
        }
        let used = (0u32..).zip(&self.water_bodies).filter(|(_, body)| body.used);
        let borders: Vec<_> =
            used.filter_map(|(id, body)| Some((id, body.area.bounding_rect()?, Border::new(&body.area)))).collect();
        let corner = |c: Coord<f64>| [c.x, c.y];
        let boxes = (0..borders.len()).map(|k| {
            let bounds = &borders[k].1;
            GeomWithData::new(Rectangle::from_corners(corner(bounds.min()), corner(bounds.max())), k)
        });
        let boxes = RTree::bulk_load(boxes.collect());
        tin.with_lakes(|p| {
            let mut near: Vec<usize> = boxes.locate_all_at_point(&p.to_array()).map(|near| near.data).collect();
            near.sort_unstable();
            let mut near = near.into_iter().map(|k| &borders[k]);
            near.find(|(_, bounds, border)| bounds.contains(&Point::new(p.x, p.y)) && border.contains(p))
                .map(|(id, ..)| *id)
        })
    }
}

/// The first vertex of an area, as its place in messages.
pub(super) fn first_vertex(area: &MultiPolygon<f64>) -> DVec2 {
    rings(area).flat_map(|ring| ring.coords()).next().map_or(DVec2::NAN, |c| DVec2::new(c.x, c.y))
}

/// A height rounded to the centimetre, for messages.
pub(crate) fn rounded(height: f64) -> f64 {
    (height * 100.0).round() / 100.0
}

/// The finding about a lake whose shore crosses another line, for instance the frame.
pub(crate) fn crossing_finding(water_bodies: &WaterBodies, lake: u32, place: DVec2) -> Finding {
    let WaterBody { height, feature, .. } = &water_bodies.water_bodies[lake as usize];
    let message = format!("the shore of the lake of feature {feature} crosses itself or another line; it is left out");
    Finding::at(FindingKind::LakeLeftOut, place, message).about(*feature, *height)
}

/// The finding about a lake that contradicts the contours around it.
pub(crate) fn lake_finding(water_bodies: &WaterBodies, lake: u32, place: DVec2, band: Band) -> Finding {
    let WaterBody { height, feature, .. } = &water_bodies.water_bodies[lake as usize];
    let shown = rounded(*height);
    let message = if band.contains(*height) {
        format!(
            "the shore of the lake of feature {feature} at {shown} m is open beside a contour of another level; it is left out"
        )
    } else {
        let Band { lo, hi } = band;
        format!(
            "the lake of feature {feature} has the height {shown} m and lies between the levels {lo} m and {hi} m; it is left out"
        )
    };
    Finding::at(FindingKind::LakeLeftOut, place, message).about(*feature, *height)
}

#[cfg(test)]
mod tests {
    use super::super::super::constraints::Constraints;
    use super::*;
    use crate::contour::{Contour, ContourMap, Interval};
    use crate::subdomains::{Frame, frame_ring};

    #[test]
    fn a_lake_whose_shore_crosses_a_line_is_named_and_left_out() {
        let square = |from: f64, to: f64| {
            [(from, from), (to, from), (to, to), (from, to), (from, from)].map(|(x, y)| DVec2::new(x, y)).to_vec()
        };
        let line = |points, elevation| Contour { elevation, points, feature: 0.into() };
        let contours = vec![line(square(0.0, 100.0), 10.0), line(square(40.0, 60.0), 20.0)];
        let map = ContourMap { contours, ..ContourMap::default() };
        let lake = |number: u64, from: f64, to: f64| {
            let ring = square(from, to).iter().map(|p| (p.x, p.y)).collect();
            let area = MultiPolygon::from(geo::Polygon::new(ring, Vec::new()));
            WaterBody { area, height: 15.0, feature: number.into(), shores: vec![square(from, to)], used: true }
        };
        let water_bodies = vec![lake(3, 5.0, 20.0), lake(4, 50.0, 80.0)];
        let mut constraints = Constraints {
            is_polygon: false,
            extensions: Vec::new(),
            tolerance: 1e-7,
            spots: Vec::new(),
            water_bodies: WaterBodies { water_bodies, ..WaterBodies::default() },
            sea: None,
            coast: Vec::new(),
        };
        let mut findings = Vec::new();
        let frame = frame_ring(&map, &Frame::Hull);
        let interval = Interval { step: 10.0, base: 0.0, rounding: 0.0 };
        let found = constraints.triangulated(&map, &frame, &[], &interval, &mut findings);
        assert!(found.is_ok());
        let used: Vec<bool> = constraints.water_bodies.water_bodies.iter().map(|body| body.used).collect();
        assert_eq!(used, [true, false]);
        assert!(findings[0].message.contains("the lake of feature 4 crosses"), "{}", findings[0].message);
    }

    #[test]
    fn all_lakes_that_surely_cross_are_left_out_at_once() {
        let square = |from: f64, to: f64| {
            [(from, from), (to, from), (to, to), (from, to), (from, from)].map(|(x, y)| DVec2::new(x, y)).to_vec()
        };
        let lake = |(from, to)| WaterBody {
            area: MultiPolygon::new(Vec::new()),
            height: 15.0,
            feature: 0.into(),
            shores: vec![square(from, to)],
            used: true,
        };
        let water_bodies: Vec<WaterBody> = [(0.0, 20.0), (10.0, 40.0), (35.0, 75.0), (100.0, 120.0)].map(lake).into();
        let mut all = WaterBodies { water_bodies, ..WaterBodies::default() };
        let edge = |from: f64, to: f64| Segment { a: DVec2::new(from, from), b: DVec2::new(to, from) };
        let crossing = || Ok(vec![edge(10.0, 40.0), edge(35.0, 75.0), edge(100.0, 120.0)]);
        let [first, last] = [DVec2::new(25.0, 10.0), DVec2::new(110.0, 100.0)];
        // The third lake crosses the second alone, which is left out.
        assert_eq!(all.crossed(first, crossing).unwrap(), [(1, first), (3, last)]);
        all.water_bodies.iter_mut().for_each(|body| body.used = false);
        assert!(all.crossed(first, crossing).unwrap().is_empty());
    }
}
