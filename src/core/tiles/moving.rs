//! One step of a vertex: it moves if its two new segments touch no other line, and if no vertex lies in the ground that the line
//! sweeps over.

use std::collections::HashMap;

use glam::DVec2;

use super::cells::Cells;
use super::network::{Line, Links, NONE, Network};
use super::thin::{is_in_triangle, side};
use crate::base::bits::bits;
use crate::geometry::{Bounds, Meeting, Segment, meeting, point_distance};

/// Points of the grid that are tried first, and those that are tried where these are not free.
pub(super) const FEW: usize = 4;
pub(super) const MANY: usize = 16;
/// Farthest that a vertex moves, units: to the farthest of the points that are tried, and then away from others.
const REACH: f64 = 6.0;
/// Farthest that a line moves where a vertex without a place leaves it, units.
const FARTHEST: f64 = 4.0;

/// What a line may not touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Obstacles {
    /// Any line, also itself.
    All,
    /// The line itself, and lines of other levels. Where contours are missing, lines of one level touch in the input already.
    OtherLevels,
}

/// Lines whose vertices move one after the other.
pub(super) struct Moving {
    lines: Vec<Line>,
    places: Vec<DVec2>,
    /// The line of each vertex.
    line_of: Vec<u32>,
    is_left: Vec<bool>,
    /// Number of vertices that each line has.
    counts: Vec<u32>,
    links: Links,
    /// Finds segments, each by the number of its first vertex.
    cells: Cells,
    /// The ends of other lines of the level at the same place, of ends that have some.
    mates: HashMap<u32, Vec<u32>>,
}

/// A vertex that is to move.
struct Move {
    v: u32,
    from: DVec2,
    to: DVec2,
    /// Its neighbours on the line.
    ends: [u32; 2],
    /// The neighbour at whose place it would be.
    merged: u32,
    bounds: Bounds,
    obstacles: Obstacles,
}

impl Moving {
    pub fn new(network: &mut Network) -> Self {
        let (lines, places) = (std::mem::take(&mut network.lines), std::mem::take(&mut network.places));
        let links = Links::new(&lines, places.len());
        let mut line_of = vec![0; places.len()];
        for (k, line) in lines.iter().enumerate() {
            line_of[line.first as usize..(line.first + line.count) as usize].fill(k as u32);
        }
        let segment = |v: usize| {
            let next = links.next[v];
            (next != NONE).then(|| Bounds::around(&[places[v], places[next as usize]]).grown(REACH))
        };
        let size = 2.0 * mean_length(&places, &links) + REACH;
        let cells = Cells::new(places.len(), size, segment);
        let counts = lines.iter().map(|line| line.count).collect();
        let mates = mates(&lines, &places);
        Self { is_left: vec![true; places.len()], lines, places, line_of, counts, links, cells, mates }
    }

    /// Number of vertices, also of those that left their line.
    pub fn count(&self) -> u32 {
        self.places.len() as u32
    }

    pub fn at(&self, v: u32) -> DVec2 {
        self.places[v as usize]
    }

    /// The ends of segments whose boxes meet a box.
    pub fn vertices_near(&self, bounds: Bounds) -> Vec<u32> {
        let mut found = Vec::new();
        self.cells.any(bounds, |a| {
            let b = self.links.next[a as usize];
            if b != NONE && Bounds::around(&[self.at(a), self.at(b)]).meets(&bounds) {
                found.extend([a, b]);
            }
            false
        });
        found.sort_unstable();
        found.dedup();
        found
    }

    fn line(&self, v: u32) -> &Line {
        &self.lines[self.line_of[v as usize] as usize]
    }

    /// Brings a vertex to a point of the grid, or out of its line. `count` points are tried. Returns whether it has a place.
    pub fn settle(&mut self, v: u32, step: f64, count: usize, obstacles: Obstacles) -> bool {
        let from = self.at(v);
        if (from / step).fract() == DVec2::ZERO {
            return true;
        }
        let base = (from / step).floor();
        let mut points: [DVec2; MANY] =
            std::array::from_fn(|k| (base + DVec2::new((k % 4) as f64, (k / 4) as f64) - 1.0) * step);
        points.sort_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from)));
        // Lines that meet go on meeting.
        let known = self.mates.get(&v).into_iter().flatten().map(|mate| self.at(*mate));
        let shared = known.filter(|to| *to != from && to.distance(from) < REACH).collect::<Vec<_>>();
        if shared.iter().chain(&points[..count]).any(|to| self.try_move(v, *to, obstacles)) {
            return true;
        }
        let (p, n) = (self.links.previous[v as usize], self.links.next[v as usize]);
        if count == FEW || p == NONE || n == NONE {
            return false;
        }
        let piece = Segment { a: self.at(p), b: self.at(n) };
        point_distance(from, &piece) <= FARTHEST
            && (self.try_move(v, piece.a, obstacles) || self.try_move(v, piece.b, obstacles))
    }

    /// Moves a vertex if the line then touches no obstacle, and sweeps over none. At the place of a neighbour, it leaves the line.
    pub fn try_move(&mut self, v: u32, to: DVec2, obstacles: Obstacles) -> bool {
        let ends = [self.links.previous[v as usize], self.links.next[v as usize]];
        let from = self.at(v);
        let known = ends.into_iter().filter(|end| *end != NONE);
        let merged = known.clone().find(|end| self.at(*end) == to).unwrap_or(NONE);
        let line = self.line_of[v as usize] as usize;
        if merged != NONE && self.counts[line] <= if self.lines[line].is_ring { 3 } else { 2 } {
            return false;
        }
        let bounds = known.fold(Bounds::around(&[from, to]), |b, end| b.union(Bounds::around(&[self.at(end)])));
        let step = Move { v, from, to, ends, merged, bounds, obstacles };
        let is_bend = merged == NONE && !ends.contains(&NONE);
        if is_bend && overlap(to, self.at(ends[0]), self.at(ends[1])) {
            return false;
        }
        if self.cells.any(bounds, |segment| self.is_in_the_way(segment, &step)) {
            return false;
        }
        if merged == NONE {
            self.places[v as usize] = to;
        } else {
            self.links.leave_out(v);
            self.is_left[v as usize] = false;
            self.counts[line] -= 1;
            if !ends.contains(&NONE) {
                self.cells.add(ends[0], Bounds::around(&ends.map(|end| self.at(end))).grown(REACH));
            }
        }
        true
    }

    /// Whether a segment, by its first vertex, would touch the line after the move.
    fn is_in_the_way(&self, a: u32, step: &Move) -> bool {
        let b = self.links.next[a as usize];
        let Move { v, from, to, ends, merged, bounds, obstacles } = *step;
        if b == NONE || a == v || b == v {
            // The second vertex of a segment that is replaced may still be the last one of its line.
            return false;
        }
        let segment = Segment { a: self.at(a), b: self.at(b) };
        if !segment.bounds().meets(&bounds) {
            return false;
        }
        let is_own = self.line_of[a as usize] == self.line_of[v as usize];
        if obstacles == Obstacles::OtherLevels && !is_own && self.line(a).level == self.line(v).level {
            return false;
        }
        // Ends of other lines of this level at the same place: lines that meet there go on doing so.
        let meets = |vertex: u32, own: u32, place: DVec2| {
            self.is_end(vertex)
                && self.is_end(own)
                && self.at(vertex) == place
                && self.line(vertex).level == self.line(own).level
        };
        let known = || ends.into_iter().filter(|end| *end != NONE);
        for vertex in [a, b] {
            let p = self.at(vertex);
            let is_own = ends.contains(&vertex) || meets(vertex, v, from) || meets(vertex, v, to);
            let is_own = is_own || known().any(|end| meets(vertex, end, self.at(end)));
            if !is_own && known().any(|end| is_in_triangle(p, [self.at(end), from, to])) {
                return true;
            }
        }
        known().filter(|end| self.at(*end) != to).any(|end| {
            let place = self.at(end);
            for (vertex, other) in [(a, segment.b), (b, segment.a)] {
                if vertex == end || meets(vertex, end, place) {
                    return overlap(place, to, other);
                }
                if vertex == merged || meets(vertex, v, to) {
                    return overlap(to, place, other);
                }
            }
            meeting(&Segment { a: place, b: to }, &segment) != Meeting::Apart
        })
    }

    /// Whether a vertex is the first or last one of a line that is no ring.
    fn is_end(&self, v: u32) -> bool {
        self.links.previous[v as usize] == NONE || self.links.next[v as usize] == NONE
    }

    /// The lines without vertices that have no place, the vertices of all, and the number of gaps.
    pub fn into_lines(self, has_place: &[bool]) -> (Vec<Line>, Vec<DVec2>, usize) {
        let (mut lines, mut places, mut gaps) = (Vec::new(), Vec::new(), 0);
        for line in &self.lines {
            let mut along: Vec<u32> = line.vertices().filter(|v| self.is_left[*v as usize]).collect();
            let gap = along.iter().position(|v| !has_place[*v as usize]);
            if let Some(gap) = gap.filter(|_| line.is_ring) {
                along.rotate_left(gap);
            }
            let is_ring = line.is_ring && gap.is_none();
            let pieces: Vec<&[u32]> =
                along.split(|v| !has_place[*v as usize]).filter(|piece| piece.len() > 1).collect();
            gaps += match (gap, line.is_ring) {
                (None, _) => 0,
                (Some(_), true) => pieces.len().max(1),
                (Some(_), false) => pieces.len().saturating_sub(1).max(1),
            };
            for piece in pieces {
                let first = places.len() as u32;
                places.extend(piece.iter().map(|v| self.at(*v)));
                lines.push(Line { level: line.level, first, count: piece.len() as u32, is_ring });
            }
        }
        (lines, places, gaps)
    }
}

/// The other ends at the place of each end where lines of one level meet.
fn mates(lines: &[Line], places: &[DVec2]) -> HashMap<u32, Vec<u32>> {
    let mut at: HashMap<(u32, [u64; 2]), Vec<u32>> = HashMap::new();
    for line in lines.iter().filter(|line| !line.is_ring) {
        for end in [line.first, line.first + line.count - 1] {
            at.entry((line.level, bits(places[end as usize]))).or_default().push(end);
        }
    }
    let groups = at.into_values().filter(|ends| ends.len() > 1);
    groups.flat_map(|ends| ends.clone().into_iter().map(move |end| (end, ends.clone()))).collect()
}

fn mean_length(places: &[DVec2], links: &Links) -> f64 {
    let lengths = places.iter().zip(&links.next).filter(|(_, next)| **next != NONE);
    let (sum, count) =
        lengths.fold((0.0, 0), |(sum, count), (p, next)| (sum + p.distance(places[*next as usize]), count + 1));
    sum / f64::from(count.max(1))
}

/// Whether the ways from a corner to two points lie on each other.
fn overlap(corner: DVec2, a: DVec2, b: DVec2) -> bool {
    side(corner, a, b) == 0.0 && (a - corner).dot(b - corner) > 0.0
}
