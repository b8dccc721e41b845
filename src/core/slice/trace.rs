//! Slicing: traces the contour lines of given levels on a surface.
//!
//! A level is traced from triangle to triangle. A vertex with `height >= level` is above the level, any other vertex is
//! below. So a vertex exactly on the level is no special case: the line passes through it. A level crosses each
//! triangle at most once, so lines of one level never cross. Heights inside a triangle are linear, so lines of
//! different levels never meet.
//!
//! A height that differs from a level only by rounding is set to this level. Otherwise, points around this vertex would
//! differ by rounding too, in any order.
//!
//! On a smooth surface, a level crosses an edge where the smooth surface has it ([`Bends`]). Levels cross it in the same order
//! as on flat triangles, so all this still holds.
//!
//! A level is traced only in sub-domains whose band has it strictly inside. At the limits of the band, there are
//! contours of the input already. A contour may end inside the map (auxiliary contours, gaps). A new line then goes on
//! from its end and does not run along it again.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use glam::DVec2;
use rayon::prelude::*;

use super::edge::{Bends, Edge};
use super::simplify::{Simplification, simplified};
use crate::base::parallel;
use crate::base::progress::Progress;
use crate::base::rows::Rows;
use crate::subdomains::{Regions, Side};
use crate::tin::{NONE, Tin, VertexKind};

/// Number of crossings of triangles and levels in memory at a time. It limits memory.
const BATCH: usize = 1 << 25;

/// Points nearer to each other than this share of their coordinates are the same point: a few units in the last place.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Traces `levels` (ascending, metres) through the triangulation. Lines are in map coordinates.
///
/// Higher ground lies on the right of each line. A closed line repeats its first point. The result has one entry per
/// level, with lines in a fixed order. A ring around a single computed vertex between two contours is an artefact of
/// the interpolation along a ridge or a gully. Such rings are only counted.
///
/// Lines lose vertices that `simplification` does not need. They follow `bends` of the surface; without them, edges are
/// straight.
pub fn slice(
    tin: &Tin,
    regions: &Regions,
    levels: &[f64],
    simplification: Simplification,
    bends: Option<&Bends<'_>>,
    progress: &dyn Progress,
) -> Vec<Traced> {
    let heights = &*heights_on_levels(tin, levels);
    let ranges: Vec<(u32, u32)> = parallel::values(tin.len(), |t| levels_of(tin, heights, regions, levels, t as u32));
    let mut counts = vec![0usize; levels.len()];
    for &(first, end) in &ranges {
        for level in first..end {
            counts[level as usize] += 1;
        }
    }
    progress.start("slicing", levels.len() as u64);
    let mut lines = Vec::with_capacity(levels.len());
    let marks: Vec<Mutex<Vec<u32>>> = (0..rayon::current_num_threads().max(1)).map(|_| Mutex::default()).collect();
    let mut from = 0;
    while from < levels.len() {
        let to = end_of_batch(&counts, from, BATCH);
        let batch = from as u32..to as u32;
        let crossed = Rows::new(to - from, || {
            ranges.iter().enumerate().flat_map(|(t, &(first, end))| {
                let levels = first.max(batch.start)..end.min(batch.end);
                levels.map(move |k| ((k as usize) - from, t as u32))
            })
        });
        lines.par_extend((from..to).into_par_iter().map(|k| {
            // Levels have different marks. So an array that another level used needs no clearing.
            let own = rayon::current_thread_index().unwrap_or(0) % marks.len();
            let mut visited = marks[own].lock().unwrap_or_else(PoisonError::into_inner);
            visited.resize(tin.len(), NONE);
            let level = levels[k];
            let mut trace = Trace {
                tin,
                heights,
                regions,
                ranges: &ranges,
                k: k as u32,
                level,
                gap: gap(levels, k),
                simplification,
                bends,
                visited: &mut visited,
                artefact_rings: 0,
            };
            let lines = trace.lines(crossed.of(k - from));
            let artefact_rings = trace.artefact_rings;
            progress.advance(1);
            Traced { lines, artefact_rings }
        }));
        from = to;
    }
    progress.finish();
    lines
}

/// The end of the batch of levels that begins with `from`: at least one level, and no more crossings than `most`.
pub(crate) fn end_of_batch(counts: &[usize], from: usize, most: usize) -> usize {
    let mut size = counts[from];
    let further = counts[from + 1..].iter().take_while(|&&count| {
        size += count;
        size <= most
    });
    from + 1 + further.count()
}

/// Difference between a level and the nearest other one, metres; infinite if there is none.
fn gap(levels: &[f64], k: usize) -> f64 {
    let below = k.checked_sub(1).map_or(f64::INFINITY, |below| levels[k] - levels[below]);
    levels.get(k + 1).map_or(f64::INFINITY, |above| above - levels[k]).min(below)
}

/// What was traced at one level.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Traced {
    /// The lines, map coordinates.
    pub lines: Vec<Vec<DVec2>>,
    /// Number of artefact rings, which are left out: tiny rings around a single computed vertex.
    pub artefact_rings: usize,
}

/// The heights of the vertices. A height that differs from a level only by rounding is set to this level.
fn heights_on_levels<'a>(tin: &'a Tin, levels: &[f64]) -> Cow<'a, [f64]> {
    let is_off = |height: &f64| !height.is_nan() && as_given(levels, *height) != *height;
    if tin.heights.iter().any(is_off) {
        parallel::values_each(&tin.heights, |&height| as_given(levels, height)).into()
    } else {
        Cow::from(&tin.heights)
    }
}

/// The one of `given` (ascending) that differs from `level` only by rounding, otherwise `level` itself.
pub(crate) fn as_given(given: &[f64], level: f64) -> f64 {
    let near = |l: &f64| (l - level).abs() <= 1e-9 * level.abs().max(1.0);
    let at = given.partition_point(|&l| l < level);
    let around = [at.checked_sub(1), Some(at)].into_iter().flatten().filter_map(|i| given.get(i));
    around.copied().find(near).unwrap_or(level)
}

/// The levels that cross triangle `t`, as indices `first..end`. They are above its lowest corner, not above its highest
/// corner, and strictly inside the band of its sub-domain.
fn levels_of(tin: &Tin, heights: &[f64], regions: &Regions, levels: &[f64], t: u32) -> (u32, u32) {
    let Some(region) = regions.region(t) else { return (0, 0) };
    if !region.band.lo.is_finite() {
        return (0, 0);
    }
    let [a, b, c] = tin.triangles[t as usize].map(|v| heights[v as usize]);
    let (lowest, highest) = (a.min(b).min(c), a.max(b).max(c));
    let first = levels.partition_point(|&l| l <= lowest || l <= region.band.lo);
    let end = levels.partition_point(|&l| l <= highest && l < region.band.hi);
    (first as u32, end.max(first) as u32)
}

/// A point of a traced line.
#[derive(Debug, Clone, Copy)]
struct Step {
    position: DVec2,
    /// The vertex, if the line passes exactly through one.
    vertex: Option<u32>,
    /// Where a simplified line may cross this edge of the triangulation: the ends of that part of it, on the right of the
    /// line and on its left. Both are the position itself at a vertex.
    window: [DVec2; 2],
    /// Whether the piece before this point runs along the frame, or along a contour of the input at this level.
    on_border: bool,
}

/// Traces one level.
struct Trace<'a> {
    tin: &'a Tin,
    heights: &'a [f64],
    regions: &'a Regions,
    ranges: &'a [(u32, u32)],
    k: u32,
    level: f64,
    /// Difference to the nearest other level, metres.
    gap: f64,
    simplification: Simplification,
    bends: Option<&'a Bends<'a>>,
    /// For each triangle, the last level that visited it.
    visited: &'a mut [u32],
    /// Number of rings left out because they are smaller than the detail of the contours.
    artefact_rings: usize,
}

impl Trace<'_> {
    fn lines(&mut self, triangles: &[u32]) -> Vec<Vec<DVec2>> {
        let mut lines = Vec::new();
        for &t in triangles {
            // A line comes in through the frame where there is no triangle before.
            let (entry, _) = self.doors(t);
            if self.before(t, entry).is_none() {
                self.walk(t, entry, &mut lines);
            }
        }
        for &t in triangles {
            if self.visited[t as usize] != self.k {
                let (entry, _) = self.doors(t);
                self.walk(t, entry, &mut lines);
            }
        }
        lines
    }

    fn crosses(&self, t: u32) -> bool {
        let (first, end) = self.ranges[t as usize];
        (first..end).contains(&self.k)
    }

    fn above(&self, v: u32) -> bool {
        self.heights[v as usize] >= self.level
    }

    /// The edges of `t` at which a line with higher ground on its right enters and leaves.
    fn doors(&self, t: u32) -> (usize, usize) {
        let above = self.tin.triangles[t as usize].map(|v| self.above(v));
        let edge = |from: bool| (0..3).find(|&i| above[i] == from && above[(i + 1) % 3] != from);
        (edge(false).unwrap_or(0), edge(true).unwrap_or(0))
    }

    /// The triangle before `t` on a line that enters `t` by edge `entry`.
    fn before(&self, t: u32, entry: usize) -> Option<u32> {
        self.tin.inner_neighbour(t, entry).filter(|&n| self.crosses(n))
    }

    /// The point where the level crosses edge `i` of `t`. It is the same for both triangles of the edge.
    fn crossing(&self, t: u32, i: usize, on_border: bool) -> Step {
        let [u, v] = self.tin.edge(t, i);
        let (u, v) = (u.min(v), u.max(v));
        let (zu, zv) = (self.heights[u as usize], self.heights[v as usize]);
        let (pu, pv) = (self.tin.positions[u as usize], self.tin.positions[v as usize]);
        if let Some(w) = [u, v].into_iter().find(|&w| self.heights[w as usize] == self.level) {
            let position = self.tin.positions[w as usize] + self.tin.origin;
            return Step { position, vertex: Some(w), window: [position; 2], on_border };
        }
        let edge = Edge::new([u, v], [zu, zv], self.bends);
        let at = |share: f64| pu + (pv - pu) * share + self.tin.origin;
        let share = edge.share(self.level);
        let [low, high] = self.simplification.window(pu.distance(pv), &edge, self.level, self.gap).map(at);
        // Higher ground is on the right.
        let window = if edge.rises() { [high, low] } else { [low, high] };
        Step { position: at(share), vertex: None, window, on_border }
    }

    fn walk(&mut self, first: u32, entry: usize, lines: &mut Vec<Vec<DVec2>>) {
        let start = self.crossing(first, entry, false);
        let mut steps = vec![start];
        let mut t = first;
        // The vertices at an end of every edge crossed so far. In a ring around a single vertex, this vertex remains to
        // the end.
        let mut hub = self.tin.edge(first, entry).map(Some);
        let closed = loop {
            self.visited[t as usize] = self.k;
            let (_, exit) = self.doors(t);
            let mut out = (t, exit);
            let mut step = self.crossing(t, exit, false);
            if let (Some(a), Some(b)) = (steps[steps.len() - 1].vertex, step.vertex)
                && a != b
            {
                if let Some(twin) = self.crest_twin(t, a, b) {
                    // On a crest, the line turns back to its own side.
                    out = (twin, self.doors(twin).1);
                    step = self.crossing(twin, out.1, false);
                } else {
                    step.on_border = self.along_border(t, a, b);
                }
            }
            let ends = self.tin.edge(out.0, out.1);
            hub = hub.map(|v| v.filter(|v| ends.contains(v)));
            steps.push(step);
            match self.tin.inner_neighbour(out.0, out.1).filter(|&n| self.crosses(n)) {
                Some(n) if n == first => break true,
                Some(n) if self.visited[n as usize] == self.k => break false,
                Some(n) => t = n,
                None => break false,
            }
        };
        match hub {
            [Some(v), None] | [None, Some(v)] if closed && self.is_artefact_ring(first, v) => self.artefact_rings += 1,
            _ => push_pieces(steps, closed, lines),
        }
    }

    /// Whether a ring around the single vertex `v`, in the sub-domain of triangle `t`, is an artefact. It is one if the
    /// vertex is computed, not surveyed, and is no top or hollow beyond the last contour.
    fn is_artefact_ring(&self, t: u32, v: u32) -> bool {
        let height = self.heights[v as usize];
        let levels = self.regions.region(t).map_or(&[][..], |r| &r.levels);
        let between = |(low, high): (&(f64, Side), &(f64, Side))| low.0 < height && height < high.0;
        self.tin.kinds[v as usize] == VertexKind::Axis && levels.first().zip(levels.last()).is_some_and(between)
    }

    /// The triangle on the other side of a crest: an edge with both ends exactly on the level and lower ground on both
    /// sides. The lines of both sides would run along it. Instead, each line goes on where the other one left the
    /// crest.
    fn crest_twin(&self, t: u32, a: u32, b: u32) -> Option<u32> {
        let i = (0..3).find(|&i| matches!(self.tin.edge(t, i), [u, v] if [u, v] == [a, b] || [u, v] == [b, a]))?;
        let twin = self.tin.across(t, i).filter(|&n| self.crosses(n))?;
        let (entry, exit) = self.doors(twin);
        let vertex = |door: usize| self.crossing(twin, door, false).vertex;
        (vertex(entry) == Some(b) && vertex(exit) == Some(a)).then_some(twin)
    }

    /// Whether the vertices `a` and `b` of `t` are the ends of a piece of contour, of a barrier edge or of the frame. A
    /// line may run along a shore, because no other line does.
    fn along_border(&self, t: u32, a: u32, b: u32) -> bool {
        (0..3).any(|i| {
            let [u, v] = self.tin.edge(t, i);
            [u.min(v), u.max(v)] == [a.min(b), a.max(b)]
                && self.tin.across(t, i).is_none()
                && (self.tin.contour_level(t, i).is_some() || !self.tin.is_shore(t, i))
        })
    }
}

/// Turns the steps of one walk into lines. Steps are cut where they run along a contour of the input or along the
/// frame. They are divided where they pass a vertex twice. So no line touches itself.
fn push_pieces(mut steps: Vec<Step>, closed: bool, lines: &mut Vec<Vec<DVec2>>) {
    if closed && steps.iter().any(|s| s.on_border) {
        // The last step repeats the first one and closes the ring. Only the last step knows the piece before it. After
        // rotation, the ring starts behind a piece of contour. So it is a line that ends before this piece.
        let closing = steps.pop().is_some_and(|s| s.on_border);
        steps[0].on_border = closing;
        let at = steps.iter().position(|s| s.on_border).unwrap_or(0);
        steps.rotate_left(at);
    }
    for piece in split_before(&steps, |s| s.on_border) {
        untangle(piece, lines);
    }
}

/// Splits steps into runs; a step with `cut` starts a new run.
fn split_before(steps: &[Step], cut: impl Fn(&Step) -> bool) -> Vec<&[Step]> {
    let mut runs = Vec::new();
    let mut from = 0;
    for i in 1..=steps.len() {
        if i == steps.len() || cut(&steps[i]) {
            runs.push(&steps[from..i]);
            from = i;
        }
    }
    runs
}

/// Whether two points differ only by the rounding of their coordinates. Between such points, a line could turn back and
/// cross itself.
fn is_one(a: DVec2, b: DVec2) -> bool {
    (b - a).abs().max_element() <= ROUNDING * a.abs().max_element()
}

/// Takes the loops out of a run that passes a vertex more than once. Lines without length are dropped. Of points that
/// differ only by rounding, vertices and ends are kept.
fn untangle(run: &[Step], lines: &mut Vec<Vec<DVec2>>) {
    let mut steps: Vec<Step> = Vec::with_capacity(run.len());
    let mut at: HashMap<u32, usize> = HashMap::new();
    for (k, &step) in run.iter().enumerate() {
        if let Some(last) = steps.last() {
            if last.position == step.position {
                continue;
            }
            if is_one(last.position, step.position) {
                let is_end = k + 1 == run.len();
                if step.vertex.is_none() && !is_end {
                    continue;
                }
                if steps.len() > 1 && last.vertex.is_none() {
                    steps.pop();
                }
            }
        }
        if let Some(v) = step.vertex {
            if let Some(&from) = at.get(&v) {
                let mut ring = steps.split_off(from + 1);
                ring.iter().filter_map(|step| step.vertex).for_each(|w| {
                    at.remove(&w);
                });
                ring.insert(0, steps[from]);
                ring.push(step);
                push_line(&ring, lines);
                continue;
            }
            at.insert(v, steps.len());
        }
        steps.push(step);
    }
    push_line(&steps, lines);
}

fn push_line(steps: &[Step], lines: &mut Vec<Vec<DVec2>>) {
    let is_ring = steps.first().map(|s| s.position) == steps.last().map(|s| s.position);
    let least = if is_ring { 4 } else { 2 };
    if steps.len() < least {
        return;
    }
    let mut line = simplified(steps.len(), |k| (steps[k].position, steps[k].window));
    if line.len() < least {
        line = steps.iter().map(|step| step.position).collect();
    }
    lines.push(line);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Interval;
    use crate::subdomains::regions;
    use crate::tin::{TinInput, triangulate};

    /// A square of level 0 with inner points, sliced.
    fn lines_of(points: &[(f64, f64, f64)], level: f64) -> Vec<Vec<DVec2>> {
        let mut input = TinInput::new([DVec2::splat(-10.0), DVec2::splat(10.0)], 0.0);
        let ring = [(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0), (-10.0, -10.0)].map(DVec2::from);
        input.push_line(&ring, 0.0, VertexKind::Contour);
        let core = [(-1.0, -9.0), (0.0, -9.0), (-1.0, -8.5), (-1.0, -9.0)].map(DVec2::from);
        input.push_line(&core, 10.0, VertexKind::Contour);
        for &(x, y, z) in points {
            input.push(DVec2::new(x, y), z, VertexKind::Spot);
        }
        let tin = triangulate(input).unwrap();
        let regions = regions(&tin, &Interval { step: 10.0, base: 0.0, rounding: 0.0 });
        slice(&tin, &regions, &[level], Simplification::NONE, None, &()).remove(0).lines
    }

    #[test]
    fn points_that_are_one_but_for_rounding_come_once() {
        let step = |x: f64, y: f64, vertex| {
            let position = DVec2::new(-1e7 + x, y);
            Step { position, vertex, window: [position; 2], on_border: false }
        };
        let lines = |steps: &[Step]| {
            let mut lines = Vec::new();
            untangle(steps, &mut lines);
            lines
        };
        let [start, next, far, on] =
            [step(0.0, 0.0, None), step(0.0, 3e-9, None), step(5.0, 1.0, None), step(5.0, 1.0 + 2e-9, Some(7))];
        let end = step(0.0, 5.0, None);
        let points = |steps: &[Step]| steps.iter().map(|s| s.position).collect::<Vec<_>>();
        assert_eq!(lines(&[start, next, far, on, end]), [points(&[start, on, end])], "vertices are kept");
        assert_eq!(lines(&[on, far, end]), [points(&[on, end])]);
        assert_eq!(lines(&[start, far, end, next, start]), [points(&[start, far, end, start])], "a ring stays closed");
        assert_eq!(lines(&[end, far, start, next]), [points(&[end, far, next])], "an end stays where it is");
        assert!(lines(&[start, next, start]).is_empty());
    }

    #[test]
    fn a_vertex_on_the_level_belongs_to_the_line_once() {
        let lines = lines_of(&[(0.0, 0.0, 8.0), (0.0, 5.0, 5.0)], 5.0);
        let through = lines.iter().flatten().filter(|p| **p == DVec2::new(0.0, 5.0)).count();
        assert_eq!(through, 1, "{lines:?}");
    }

    #[test]
    fn a_vertex_on_the_level_but_for_rounding_is_on_it() {
        let lines = lines_of(&[(0.0, 0.0, 8.0), (0.3, 5.1, 5.0_f64.next_up()), (5.0, 0.1, 5.0_f64.next_down())], 5.0);
        for place in [DVec2::new(0.3, 5.1), DVec2::new(5.0, 0.1)] {
            let near = lines.iter().flatten().filter(|p| p.distance(place) < 1e-6);
            assert_eq!(near.collect::<Vec<_>>(), [&place], "{lines:?}");
        }
    }

    #[test]
    fn a_saddle_on_the_level_does_not_make_a_line_touch_itself() {
        // Two tops joined by a pass that lies exactly on the level.
        let lines =
            lines_of(&[(-5.0, 2.0, 9.0), (5.0, 2.0, 9.0), (0.0, 2.0, 5.0), (0.0, 6.0, 1.0), (0.0, -2.0, 1.0)], 5.0);
        for line in &lines {
            let inner = &line[..line.len() - usize::from(line.first() == line.last())];
            let mut seen = std::collections::HashSet::new();
            assert!(inner.iter().all(|p| seen.insert([p.x.to_bits(), p.y.to_bits()])), "{line:?}");
        }
        assert!(lines.len() >= 2);
    }

    #[test]
    fn no_two_lines_run_along_a_crest_on_the_level() {
        let lines = lines_of(&[(-5.0, 2.0, 5.0), (5.0, 2.0, 5.0), (0.0, 6.0, 1.0), (0.0, -2.0, 1.0)], 5.0);
        let along = |w: &[DVec2]| w.iter().all(|p| p.y == 2.0 && p.x.abs() == 5.0);
        assert_eq!(lines.iter().flat_map(|l| l.windows(2)).filter(|w| along(w)).count(), 0, "{lines:?}");
    }

    #[test]
    fn a_single_point_at_the_level_is_no_line() {
        let before = lines_of(&[], 5.0).len();
        assert_eq!(lines_of(&[(6.0, 6.0, 5.0)], 5.0).len(), before);
    }

    #[test]
    fn a_ring_of_the_level_is_not_traced_again() {
        // A hill of 10 m in a sub-domain of wrong extent: the open line of 20 m makes it a sub-domain from 0 to 20 m.
        let ring =
            |half: f64| [(-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)].map(DVec2::from);
        let mut input = TinInput::new([DVec2::splat(-10.0), DVec2::splat(10.0)], 0.0);
        input.push_line(&ring(10.0), 0.0, VertexKind::Contour);
        input.push_line(&ring(2.0), 10.0, VertexKind::Contour);
        input.push_line(&[DVec2::new(-8.0, 8.0), DVec2::new(8.0, 8.0)], 20.0, VertexKind::Contour);
        let tin = triangulate(input).unwrap();
        let regions = regions(&tin, &Interval { step: 10.0, base: 0.0, rounding: 0.0 });
        let lines = slice(&tin, &regions, &[10.0], Simplification::NONE, None, &()).remove(0).lines;
        assert!(!lines.is_empty());
        let on_ring = |p: &DVec2| p.abs().max_element() == 2.0;
        for line in lines {
            assert!(!line.windows(2).any(|w| w.iter().all(on_ring)), "{line:?} runs along the ring");
        }
    }

    #[test]
    fn higher_ground_is_on_the_right() {
        let lines = lines_of(&[(4.0, 4.0, 9.0)], 6.0);
        assert_eq!(lines.len(), 1, "one line around both tops");
        assert!(crate::slice::signed_area(&lines[0]) < 0.0, "clockwise around higher ground");
    }
}
