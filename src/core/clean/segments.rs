//! All segments of all lines, numbered, with a tree to find those near a position.
//!
//! The tree holds boxes of short runs of segments, not of single segments. That makes it an eighth of the size, and
//! lines are near themselves anyway. Long segments make large boxes with much empty ground, so their runs are shorter.

use glam::DVec2;

use super::removed::{self, SegmentKey};
use crate::base::error::{Error, Result};
use crate::base::parallel;
use crate::contour::Contour;
use crate::geometry::point_distance;
use crate::geometry::{Bounds, Segment};
use crate::geometry::{BoxTree, OrientedBox};

/// Largest number of segments in a run.
const RUN: usize = 8;
/// Largest area of the box around several segments: this many times the map's area per length of line, times their
/// length.
const ROOM: f64 = 16.0;

/// The segments of lines, numbered line by line.
pub(crate) struct Segments<'a> {
    lines: &'a [Contour],
    /// Number of each line's first segment, and at the end the number of all segments.
    starts: Vec<u32>,
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
    tree: BoxTree,
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

    /// Number of all segments.
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

    /// Returns the number of each line's first segment, and at the end the number of all segments.
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

    /// A key that identifies the segment.
    pub(super) fn key(&self, segment: u32) -> SegmentKey {
        let Segment { a, b } = self.get(segment);
        removed::key(self.line_of(segment).elevation, a, b)
    }

    /// Builds the tree.
    pub(crate) fn runs(&self) -> Runs {
        let room = ROOM * self.distance_between_lines();
        let (mut runs, mut boxes) = (Vec::with_capacity(self.len() / RUN + self.lines.len()), Vec::new());
        for (line, contour) in (0u32..).zip(self.lines) {
            let count = contour.points.len().saturating_sub(1);
            let mut from = 0;
            while from < count {
                let points = &contour.points[from..=(from + RUN).min(count)];
                let mut segments = points.len() - 1;
                let mut turned = OrientedBox::around(points);
                while segments > 1 && turned.area() > room * length(&points[..=segments]) {
                    segments -= 1;
                    turned = OrientedBox::around(&points[..=segments]);
                }
                let to = from + segments;
                runs.push(Run { line, from: from as u32, to: to as u32, bounds: Bounds::around(&points[..=segments]) });
                boxes.push(turned);
                from = to;
            }
        }
        Runs { runs, tree: BoxTree::new(&boxes) }
    }

    /// The spacing that lines would have if they were spread evenly over the map: its area per length of line.
    fn distance_between_lines(&self) -> f64 {
        let all = parallel::map_each(self.lines, |line| Bounds::around(&line.points));
        let all = all.into_iter().fold(Bounds::around(&[]), Bounds::union);
        let size = all.max - all.min;
        let sum: f64 = self.lines.iter().map(|line| length(&line.points)).sum();
        if sum > 0.0 { size.x / sum * size.y } else { 0.0 }
    }
}

/// Length of a line.
fn length(points: &[DVec2]) -> f64 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

impl Runs {
    /// Numbers of the runs that may share a point with `bounds`, in no particular order.
    pub(crate) fn near(&self, bounds: &Bounds) -> impl Iterator<Item = u32> {
        self.tree.near(OrientedBox::upright(bounds.min, bounds.max))
    }

    /// Numbers of the runs, including this one, that may be within `reach` of a run, in no particular order.
    pub(super) fn near_run(&self, lines: &[Contour], run: &Run, reach: f64) -> impl Iterator<Item = u32> {
        self.tree.near(OrientedBox::around(points_of(lines, run)).grown(reach))
    }

    /// Numbers of lines that may be within `reach` of a point, in no particular order and more than once.
    pub(crate) fn lines_near(&self, p: DVec2, reach: f64) -> Vec<u32> {
        self.near(&Bounds { min: p, max: p }.grown(reach)).map(|run| self.runs[run as usize].line).collect()
    }

    /// Distance from a point to the nearest of `lines` except the line number `own`. Infinite if there is no other.
    pub(crate) fn distance_to_others(&self, lines: &[Contour], p: DVec2, own: u32) -> f64 {
        let mut best = f64::INFINITY;
        for (run, at_least) in self.tree.nearest_first(p) {
            if at_least > best {
                break;
            }
            let run = &self.runs[run as usize];
            if run.line != own {
                for w in points_of(lines, run).windows(2) {
                    best = best.min(point_distance(p, &Segment { a: w[0], b: w[1] }));
                }
            }
        }
        best
    }
}

/// The vertices of a run.
fn points_of<'a>(lines: &'a [Contour], run: &Run) -> &'a [DVec2] {
    &lines[run.line as usize].points[run.from as usize..=run.to as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Regular rings around zero, a unit apart.
    fn rings(count: u32, corners: u32) -> Vec<Contour> {
        let ring = |r: u32| {
            let corner =
                |k: u32| f64::from(r) * DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / f64::from(corners));
            Contour {
                elevation: f64::from(r),
                points: (0..=corners).map(|k| corner(k % corners)).collect(),
                feature: 0.into(),
            }
        };
        (1..=count).map(ring).collect()
    }

    /// How many runs there are, and how many pairs of them may be near each other.
    fn candidates(lines: &[Contour]) -> (usize, usize) {
        let runs = Segments::new(lines).unwrap().runs();
        let near = runs.runs.iter().map(|run| runs.near_run(lines, run, 0.01).count()).sum();
        (runs.runs.len(), near)
    }

    #[test]
    fn nested_rings_of_few_long_sides_have_few_candidates() {
        for corners in [3, 8, 12] {
            let (runs, near) = candidates(&rings(1000, corners));
            assert!(near < 16 * runs, "{near} candidates of {runs} runs at {corners} corners");
        }
    }

    #[test]
    fn runs_of_short_segments_hold_several() {
        let lines = rings(100, 720);
        let (runs, _) = candidates(&lines);
        assert_eq!(runs, 100 * 720 / RUN);
    }

    #[test]
    fn runs_hold_each_segment_once() {
        let lines = [rings(30, 5), rings(3, 100)].concat();
        let runs = Segments::new(&lines).unwrap().runs().runs;
        let mut next = (0, 0);
        for run in &runs {
            if run.line != next.0 {
                assert_eq!(next.1 + 1, lines[next.0 as usize].points.len() as u32);
                next = (run.line, 0);
            }
            assert_eq!(run.from, next.1);
            assert!(run.to > run.from && run.to - run.from <= RUN as u32);
            next.1 = run.to;
        }
        assert_eq!(next, (lines.len() as u32 - 1, 100));
    }
}
