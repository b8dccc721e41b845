//! An index of the contours near lakes.

use std::borrow::Cow;

use geo::{BoundingRect, Rect};
use glam::DVec2;
use rstar::primitives::Rectangle;
use rstar::{AABB, RTree};

use super::bodies::Nodes;
use crate::base::parallel;
use crate::contour::{ContourMap, Lake};
use crate::geometry::{BoxTree, OrientedBox, Segment};
use crate::subdomains::FrameExtension;

/// A line of one level: a contour or a frame extension.
pub(crate) struct Course<'a> {
    pub level: f64,
    pub points: Cow<'a, [DVec2]>,
    /// Whether it is a frame extension and no contour.
    pub is_extension: bool,
}

/// A piece of a segment between two vertices; added vertices count too.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub line: u32,
    pub segment: u32,
    pub level: f64,
    pub ends: Segment,
}

/// The segments of courses near lakes, and the vertices that were added to them.
pub(crate) struct Net<'a> {
    pub courses: Vec<Course<'a>>,
    pub nodes: Nodes,
    /// By box of the tree: the number of the line, and that of the segment on it.
    segments: Vec<(u32, u32)>,
    tree: BoxTree,
}

impl<'a> Net<'a> {
    /// Takes the segments within `reach` of the boxes around lakes.
    pub fn new(map: &'a ContourMap, extensions: &[FrameExtension], lakes: &[Lake], reach: f64) -> Self {
        let contours = map.contours.iter().map(|c| Course {
            level: c.elevation,
            points: Cow::from(&c.points),
            is_extension: false,
        });
        let extensions = extensions.iter().map(|l| Course {
            level: l.elevation,
            points: Cow::from(vec![l.end, l.frame]),
            is_extension: true,
        });
        let courses: Vec<Course> = contours.chain(extensions).collect();
        let grown = |r: Rect<f64>| {
            Rectangle::from_corners([r.min().x - reach, r.min().y - reach], [r.max().x + reach, r.max().y + reach])
        };
        let boxes: Vec<_> = lakes.iter().filter_map(|lake| lake.polygon.bounding_rect()).map(grown).collect();
        let boxes = RTree::bulk_load(boxes);
        let mut segments = Vec::new();
        for (line, course) in (0u32..).zip(&courses) {
            for (segment, ends) in (0u32..).zip(course.points.windows(2)) {
                let [a, b] = [ends[0], ends[1]].map(|p| p.to_array());
                if boxes.locate_in_envelope_intersecting(&AABB::from_corners(a, b)).next().is_some() {
                    segments.push((line, segment));
                }
            }
        }
        let around = |&(line, segment): &(u32, u32)| {
            OrientedBox::around(&courses[line as usize].points[segment as usize..][..2])
        };
        let tree = BoxTree::new(&parallel::map_each(&segments, around));
        Self { courses, nodes: Nodes::new(), segments, tree }
    }

    /// The pieces within `reach` of the segment from `a` to `b`, in a fixed order; some may be a little further away.
    pub fn near(&self, a: DVec2, b: DVec2, reach: f64) -> Vec<Piece> {
        self.near_box(OrientedBox::around(&[a, b]).grown(reach))
    }

    /// The pieces that meet a box, in a fixed order; some may only be near it.
    pub fn near_box(&self, area: OrientedBox) -> Vec<Piece> {
        let mut found: Vec<(u32, u32)> = self.tree.near(area).map(|s| self.segments[s as usize]).collect();
        found.sort_unstable();
        found.into_iter().flat_map(|key| self.pieces(key)).collect()
    }

    fn pieces(&self, (line, segment): (u32, u32)) -> Vec<Piece> {
        let course = &self.courses[line as usize];
        let ends = &course.points[segment as usize..][..2];
        let nodes = self.nodes.get(&(line, segment)).map_or(&[][..], Vec::as_slice);
        let from = std::iter::once(ends[0]).chain(nodes.iter().copied());
        let to = nodes.iter().copied().chain([ends[1]]);
        let piece = |(a, b)| Piece { line, segment, level: course.level, ends: Segment { a, b } };
        from.zip(to).filter(|(a, b)| a != b).map(piece).collect()
    }

    /// Adds a vertex to a segment.
    pub fn add_node(&mut self, piece: &Piece, place: DVec2) {
        let points = &self.courses[piece.line as usize].points;
        let [a, b] = [0, 1].map(|k| points[piece.segment as usize + k]);
        let nodes = self.nodes.entry((piece.line, piece.segment)).or_default();
        if place != a && place != b && !nodes.contains(&place) {
            nodes.push(place);
            nodes.sort_by(|p, q| (*p - a).dot(b - a).total_cmp(&(*q - a).dot(b - a)));
        }
    }
}
