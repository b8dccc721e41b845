//! Stretches of lines whose inner vertices may be stray.

use glam::DVec2;

use super::canonical::is_closed;
use super::segments::Segments;
use crate::base::parallel;

/// Largest number of stray vertices in a row.
pub(super) const MOST: usize = 4;

/// At least two successive segments of a line. The vertices between them may be stray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub(super) line: u32,
    /// Number of the first segment on the line.
    pub(super) from: u32,
    /// Number of segments. On a ring they may run across its start.
    pub(super) count: u32,
    /// Length of the way along the segments, divided by the length of the straight way.
    pub(super) detour: f64,
    /// The ground that changes sides if the straight way replaces the segments, square map units.
    pub(super) swept: f64,
}

impl Stretch {
    fn new(line: usize, from: usize, count: usize, points: &[DVec2]) -> Self {
        let vertex = |k: usize| points[wrapped(points, from + k)];
        let way: f64 = (0..count).map(|k| vertex(k).distance(vertex(k + 1))).sum();
        let detour = way / vertex(0).distance(vertex(count));
        // The vertices are left out one after the other, from either end. Each sweeps a triangle.
        let fan = |root: DVec2, k: usize| (vertex(k) - root).perp_dot(vertex(k + 1) - root).abs() / 2.0;
        let forward: f64 = (1..count).map(|k| fan(vertex(0), k)).sum();
        let back: f64 = (0..count - 1).map(|k| fan(vertex(count), k)).sum();
        Self { line: line as u32, from: from as u32, count: count as u32, detour, swept: forward.min(back) }
    }

    /// The stretch's vertices, with the one before and the one after those that may be stray.
    pub(super) fn way(&self, segments: &Segments) -> Vec<DVec2> {
        let points = &segments.lines()[self.line as usize].points;
        (0..=self.count as usize).map(|k| points[self.index(points, k)]).collect()
    }

    /// The index of the stretch's vertex number `k` on its line.
    pub(super) fn index(&self, points: &[DVec2], k: usize) -> usize {
        wrapped(points, self.from as usize + k)
    }

    /// Numbers of the segments among all segments.
    pub(super) fn ids(&self, segments: &Segments) -> impl Iterator<Item = u32> + use<> {
        let (start, after) = (segments.start(self.line), segments.start(self.line + 1));
        let (from, count) = (self.from, after - start);
        (0..self.count).map(move |k| start + (from + k) % count)
    }
}

/// The index of a vertex, which continues at the start of a ring.
fn wrapped(points: &[DVec2], k: usize) -> usize {
    if is_closed(points) { k % (points.len() - 1) } else { k }
}

/// The stretches that contain the segments, by line and place.
pub(super) fn stretches(segments: &Segments, of: &[u32]) -> Vec<Stretch> {
    let around = |&s: &u32| {
        let line = segments.line_number(s);
        let points = &segments.lines()[line].points;
        let (ring, sides) = (is_closed(points), points.len() - 1);
        let number = (s - segments.start(line as u32)) as usize;
        let froms = (2..=MOST + 1).flat_map(|count| (0..count).map(move |back| (count, back)));
        froms.filter_map(move |(count, back)| match number.checked_sub(back) {
            Some(from) if ring || from + count <= sides => Some((line, from, count)),
            None if ring && back <= sides => Some((line, number + sides - back, count)),
            _ => None,
        })
    };
    let mut all = parallel::flat_map_each(of, around);
    all.sort_unstable();
    all.dedup();
    parallel::map_each(&all, |&(line, from, count)| Stretch::new(line, from, count, &segments.lines()[line].points))
}
