//! The lines around labels.

use glam::DVec2;

use super::LabelledLines;
use crate::base::parallel;
use crate::contour::ContourLine;
use crate::geometry::{BoxTree, OrientedBox};

/// Segments in a box of the tree. More make it smaller, and a search slower.
const CHUNK: usize = 12;

/// All lines, to find those under a text.
pub(super) struct Neighbours<'a> {
    lines: &'a [ContourLine],
    labelled: LabelledLines,
    /// The line and the first segment of each box of the tree.
    chunks: Vec<(u32, u32)>,
    tree: BoxTree,
}

impl<'a> Neighbours<'a> {
    /// Lines that are not usable are passed over.
    pub fn new(lines: &'a [ContourLine], usable: &[bool], labelled: LabelledLines) -> Self {
        let chunks: Vec<(u32, u32)> = (0..lines.len())
            .filter(|&k| usable[k])
            .flat_map(|k| {
                (0..lines[k].points.len().saturating_sub(1)).step_by(CHUNK).map(move |s| (k as u32, s as u32))
            })
            .collect();
        let points = |&(line, first): &(u32, u32)| segments_of(&lines[line as usize].points, first as usize);
        let boxes: Vec<OrientedBox> = parallel::map_each(&chunks, |chunk| OrientedBox::around(points(chunk)));
        Self { lines, labelled, tree: BoxTree::new(&boxes), chunks }
    }

    /// The number of lines with labels, and of others, that meet a box. Segments of the line `own` count as another line
    /// with labels, but not those that `is_skipped`.
    pub fn under(&self, area: &OrientedBox, own: usize, is_skipped: impl Fn(usize) -> bool) -> (usize, usize) {
        let mut found: Vec<u32> = Vec::new();
        for chunk in self.tree.near(*area) {
            let (line, first) = self.chunks[chunk as usize];
            let points = segments_of(&self.lines[line as usize].points, first as usize);
            let is_under = |(k, ends): (usize, &[DVec2])| {
                let is_own = line as usize == own && is_skipped(first as usize + k);
                !is_own && OrientedBox::around(ends).meets(area)
            };
            if points.windows(2).enumerate().any(is_under) {
                found.push(line);
            }
        }
        found.sort_unstable();
        found.dedup();
        let labelled = found.iter().filter(|&&line| self.labelled.includes(&self.lines[line as usize])).count();
        (labelled, found.len() - labelled)
    }
}

/// The vertices of the segments from `first` on that share a box.
fn segments_of(points: &[DVec2], first: usize) -> &[DVec2] {
    &points[first..points.len().min(first + CHUNK + 1)]
}
