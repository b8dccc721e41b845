//! Lakes in the form in which they are triangulated.

use std::borrow::Cow;
use std::collections::BTreeMap;

use geo::{BoundingRect, Contains, Coord, MultiPolygon, Point};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};

use crate::base::FeatureId;
use crate::base::error::{Finding, FindingKind};
use crate::geometry::{Border, rings};
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

    /// Heights of the lakes by their numbers.
    pub fn heights(&self) -> Vec<f64> {
        self.water_bodies.iter().map(|body| body.height).collect()
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

/// The finding about a lake that contradicts the contours around it.
pub(crate) fn lake_finding(water_bodies: &WaterBodies, lake: u32, place: DVec2, band: Band) -> Finding {
    let WaterBody { height, feature, .. } = &water_bodies.water_bodies[lake as usize];
    let shown = rounded(*height);
    let message = if band.contains(*height) {
        format!(
            "the shore of the lake of feature {feature} at {shown} is open beside a contour of another level; it is left out"
        )
    } else {
        let Band { lo, hi } = band;
        format!(
            "the lake of feature {feature} has the height {shown} and lies between contours {lo} and {hi}; it is left out"
        )
    };
    Finding::at(FindingKind::LakeLeftOut, place, message).about(*feature, *height)
}
