//! All lines of a zoom together.

use std::collections::BTreeMap;

use glam::DVec2;

use super::EXTENT;
use super::mercator::TilePlace;

/// Longest segment, units. Tiles take whole segments. Map libraries lose what lies further outside of a tile than a tile or two.
pub(super) const LONGEST: f64 = 1024.0;

/// A line in Web Mercator metres.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelLine {
    /// The number of its level. Lines of one level have the same.
    pub level: u32,
    /// Its vertices; a ring repeats the first.
    pub points: Vec<DVec2>,
}

/// A line of a network: its vertices are those from `first` on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub level: u32,
    pub first: u32,
    pub count: u32,
    pub is_ring: bool,
}

impl Line {
    /// The numbers of its vertices.
    pub fn vertices(&self) -> std::ops::Range<u32> {
        self.first..self.first + self.count
    }
}

/// The lines of a zoom, in units of its grid: a tile's side has [`EXTENT`].
#[derive(Debug, Clone)]
pub struct Network {
    pub(super) zoom: u8,
    /// Steps of the grid in a unit.
    pub(super) fineness: u32,
    pub(super) lines: Vec<Line>,
    pub(super) places: Vec<DVec2>,
}

/// A line whose vertices are on the grid.
#[derive(Debug, Clone, Copy)]
pub struct LineOnGrid<'a> {
    /// The number of its level.
    pub level: u32,
    /// Whether it closes. Then its first vertex is not repeated.
    pub is_ring: bool,
    places: &'a [DVec2],
    fineness: f64,
}

impl LineOnGrid<'_> {
    /// Number of its vertices.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// A vertex, in steps of the grid from the upper left corner of the map. Beyond the last one of a ring, it is counted from
    /// the first again.
    pub fn vertex(&self, k: usize) -> [i64; 2] {
        (self.places[k % self.places.len()] * self.fineness).to_array().map(|c| c.round() as i64)
    }
}

impl Network {
    /// Adds a line without repeated vertices. Long segments are divided: they take part in the search for what lies near.
    pub(super) fn push(&mut self, level: u32, is_ring: bool, points: impl Iterator<Item = DVec2>) {
        let first = self.places.len();
        for p in points {
            if self.places.len() > first {
                self.step_to(p);
            }
            if self.places.len() == first || self.places[self.places.len() - 1] != p {
                self.places.push(p);
            }
        }
        if is_ring && self.places.len() > first {
            self.step_to(self.places[first]);
            while self.places.len() > first + 1 && self.places[self.places.len() - 1] == self.places[first] {
                self.places.pop();
            }
        }
        let count = self.places.len() - first;
        if count < if is_ring { 3 } else { 2 } {
            self.places.truncate(first);
            return;
        }
        self.lines.push(Line { level, first: first as u32, count: count as u32, is_ring });
    }

    /// Adds vertices on the way from the last one to `p`.
    fn step_to(&mut self, p: DVec2) {
        let last = self.places[self.places.len() - 1];
        let parts = (last.distance(p) / LONGEST).ceil();
        for k in 1..parts as u32 {
            self.places.push(last.lerp(p, f64::from(k) / parts));
        }
    }

    /// The zoom that the network is for.
    pub fn zoom(&self) -> u8 {
        self.zoom
    }

    /// Steps of the grid along a tile's side: [`EXTENT`], or more where lines lie so close that a finer grid is needed.
    pub fn extent(&self) -> u32 {
        EXTENT * self.fineness
    }

    /// The tile with the most vertices of lines whose level is shown, and their number; none if there is none.
    pub fn fullest_tile(&self, is_shown: impl Fn(u32) -> bool) -> Option<(TilePlace, usize)> {
        let mut counts: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for line in self.lines.iter().filter(|line| is_shown(line.level)) {
            for place in &self.places[line.first as usize..(line.first + line.count) as usize] {
                let tile = *place / f64::from(EXTENT);
                *counts.entry((tile.x as u32, tile.y as u32)).or_default() += 1;
            }
        }
        let ((x, y), count) = counts.into_iter().max_by_key(|(_, count)| *count)?;
        Some((TilePlace { zoom: self.zoom, x, y }, count))
    }

    /// The same lines for the next lower zoom, those whose level is needed there.
    pub fn coarser(mut self, is_needed: impl Fn(u32) -> bool) -> Self {
        self.retain(|_, line| is_needed(line.level));
        self.places.iter_mut().for_each(|p| *p /= 2.0);
        Self { zoom: self.zoom - 1, fineness: 1, ..self }
    }

    /// Keeps some of the lines, and the memory of these only.
    pub(super) fn retain(&mut self, is_kept: impl Fn(usize, &Line) -> bool) {
        let mut places = Vec::new();
        let mut k = 0;
        self.lines.retain_mut(|line| {
            let kept = is_kept(k, line);
            k += 1;
            if kept {
                let from = places.len() as u32;
                places.extend_from_slice(&self.places[line.first as usize..(line.first + line.count) as usize]);
                line.first = from;
            }
            kept
        });
        places.shrink_to_fit();
        self.places = places;
    }

    /// Number of lines.
    pub fn count(&self) -> usize {
        self.lines.len()
    }

    /// A line, after [`Network::to_grid`].
    pub fn line(&self, k: usize) -> LineOnGrid<'_> {
        let Line { level, first, count, is_ring } = self.lines[k];
        let places = &self.places[first as usize..(first + count) as usize];
        LineOnGrid { level, is_ring, places, fineness: f64::from(self.fineness) }
    }
}

/// The vertices before and after each vertex on its line.
pub(super) struct Links {
    pub previous: Vec<u32>,
    pub next: Vec<u32>,
}

/// No vertex: beyond the end of a line, or one that was left out.
pub(super) const NONE: u32 = u32::MAX;

impl Links {
    pub fn new(lines: &[Line], count: usize) -> Self {
        let (mut previous, mut next) = (vec![NONE; count], vec![NONE; count]);
        for line in lines {
            for v in line.vertices().skip(1) {
                (previous[v as usize], next[v as usize - 1]) = (v - 1, v);
            }
            if line.is_ring {
                let last = line.first + line.count - 1;
                (previous[line.first as usize], next[last as usize]) = (last, line.first);
            }
        }
        Self { previous, next }
    }

    /// The neighbours of a vertex that is not an end.
    pub fn around(&self, v: u32) -> Option<(u32, u32)> {
        let (p, n) = (self.previous[v as usize], self.next[v as usize]);
        (p != NONE && n != NONE).then_some((p, n))
    }

    /// Takes a vertex out of its line.
    pub fn leave_out(&mut self, v: u32) {
        let (p, n) = (self.previous[v as usize], self.next[v as usize]);
        if p != NONE {
            self.next[p as usize] = n;
        }
        if n != NONE {
            self.previous[n as usize] = p;
        }
        (self.previous[v as usize], self.next[v as usize]) = (NONE, NONE);
    }
}
