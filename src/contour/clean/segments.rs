//! All segments of all lines, numbered, and a tree to find those near a place.
//!
//! The tree holds the boxes of short runs of segments, not of every single one: that makes it an eighth of the size,
//! and lines are near themselves anyway.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::meet::point_distance;
use super::removed::{self, SegmentKey};
use crate::contour::Contour;
use crate::error::{Error, Result};

/// Segments in a run.
const RUN: usize = 8;

/// The segments of lines, numbered line by line.
pub(crate) struct Segments<'a> {
    lines: &'a [Contour],
    /// Number of each line's first segment, and at the end the number of all.
    starts: Vec<u32>,
}

/// One segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Segment {
    pub(crate) a: DVec2,
    pub(crate) b: DVec2,
}

impl Segment {
    pub(super) fn bounds(&self) -> Bounds {
        Bounds { min: self.a.min(self.b), max: self.a.max(self.b) }
    }
}

/// An upright rectangle.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) min: DVec2,
    pub(crate) max: DVec2,
}

impl Bounds {
    /// Grown by `margin` on all sides.
    pub(crate) fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Whether they share a point.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    fn aabb(&self) -> AABB<[f64; 2]> {
        AABB::from_corners(self.min.to_array(), self.max.to_array())
    }
}

/// A run of successive segments of one line.
pub(crate) struct Run {
    pub(crate) line: u32,
    /// Number of its first segment among those of the line.
    pub(crate) from: u32,
    /// Number after its last.
    pub(crate) to: u32,
    pub(super) bounds: Bounds,
}

/// Runs of segments, and the tree of their boxes.
pub(crate) struct Runs {
    pub(crate) runs: Vec<Run>,
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, u32>>,
}

impl<'a> Segments<'a> {
    /// Numbers the segments.
    pub(crate) fn new(lines: &'a [Contour]) -> Result<Self> {
        let mut starts = Vec::with_capacity(lines.len() + 1);
        let mut sum = 0u32;
        for line in lines {
            starts.push(sum);
            sum = u32::try_from(line.points.len().saturating_sub(1)).ok().and_then(|n| sum.checked_add(n)).ok_or_else(
                || Error::Data("the contours have more than 4 294 967 295 vertices; clip them first".to_owned()),
            )?;
        }
        starts.push(sum);
        Ok(Self { lines, starts })
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.starts.last().map_or(0, |&n| n as usize)
    }

    pub(super) fn lines(&self) -> &'a [Contour] {
        self.lines
    }

    /// Number of a line's first segment.
    pub(super) fn start(&self, line: u32) -> u32 {
        self.starts[line as usize]
    }

    /// Gives back the number of each line's first segment, and at the end the number of all.
    pub(super) fn into_starts(self) -> Vec<u32> {
        self.starts
    }

    /// The line that a segment belongs to.
    pub(super) fn line_of(&self, segment: u32) -> &'a Contour {
        &self.lines[self.line_number(segment)]
    }

    /// Number of the line that a segment belongs to.
    pub(super) fn line_number(&self, segment: u32) -> usize {
        self.starts.partition_point(|&start| start <= segment) - 1
    }

    /// A segment's ends.
    pub(super) fn get(&self, segment: u32) -> Segment {
        let line = self.line_number(segment);
        let k = (segment - self.starts[line]) as usize;
        Segment { a: self.lines[line].points[k], b: self.lines[line].points[k + 1] }
    }

    /// What tells a segment from all others.
    pub(super) fn key(&self, segment: u32) -> SegmentKey {
        let Segment { a, b } = self.get(segment);
        removed::key(self.line_of(segment).elevation, a, b)
    }

    /// Builds the tree.
    pub(crate) fn runs(&self) -> Runs {
        let mut runs = Vec::with_capacity(self.len() / RUN + self.lines.len());
        for (line, contour) in (0u32..).zip(self.lines) {
            let count = contour.points.len().saturating_sub(1);
            for from in (0..count).step_by(RUN) {
                let to = (from + RUN).min(count);
                let first = contour.points[from];
                let bounds = contour.points[from + 1..=to]
                    .iter()
                    .fold(Bounds { min: first, max: first }, |b, p| Bounds { min: b.min.min(*p), max: b.max.max(*p) });
                runs.push(Run { line, from: from as u32, to: to as u32, bounds });
            }
        }
        let boxes = (0u32..).zip(&runs).map(|(i, run)| {
            let corners = (run.bounds.min.to_array(), run.bounds.max.to_array());
            GeomWithData::new(Rectangle::from_corners(corners.0, corners.1), i)
        });
        let tree = RTree::bulk_load(boxes.collect());
        Runs { runs, tree }
    }
}

impl Runs {
    /// Numbers of the runs whose boxes share a point with `bounds`, in no particular order.
    pub(crate) fn near(&self, bounds: &Bounds) -> impl Iterator<Item = u32> {
        self.tree.locate_in_envelope_intersecting(&bounds.aabb()).map(|run| run.data)
    }

    /// Numbers of lines that may be within `reach` of a point, in no particular order and more than once.
    pub(crate) fn lines_near(&self, p: DVec2, reach: f64) -> Vec<u32> {
        self.near(&Bounds { min: p, max: p }.grown(reach)).map(|run| self.runs[run as usize].line).collect()
    }

    /// Distance from a point to the nearest of `lines` but the line number `own`; infinite where there is no other.
    pub(crate) fn distance_to_others(&self, lines: &[Contour], p: DVec2, own: u32) -> f64 {
        let mut best = f64::INFINITY;
        for (run, box_distance_2) in self.tree.nearest_neighbor_iter_with_distance_2(&p.to_array()) {
            if box_distance_2 > best * best {
                break;
            }
            let run = &self.runs[run.data as usize];
            if run.line != own {
                let points = &lines[run.line as usize].points[run.from as usize..=run.to as usize];
                for w in points.windows(2) {
                    best = best.min(point_distance(p, &Segment { a: w[0], b: w[1] }));
                }
            }
        }
        best
    }
}
