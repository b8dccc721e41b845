//! Traces one level through a grid of heights.
//!
//! Four neighbouring cell centres are the corners of a square. On a side of it, heights are linear. A corner with
//! `height >= level` is above the level, any other corner is below. So a corner exactly on the level is no special
//! case, also where it is a single one or one of a row: the level runs around it, close beside it. Inside a square, a
//! line runs straight from side to side. Where two corners above the level lie across from each other (a saddle), the
//! mean of the four heights decides which two sides a line joins.
//!
//! Lines of one level and of different levels never meet. On each side they have windows of their own (see
//! [`window`]), in the order of their levels and apart from the corners. And two straight pieces in a square do not cross
//! if the ends of one are not on both sides of the other.
//!
//! A square without data at one of its corners has no lines.

use glam::DVec2;

use crate::base::parallel;
use crate::slice::window;

/// The rank of a node without data.
const NO_DATA: u32 = u32::MAX;
/// Share of the way to a corner that a window may take. The corner's height is one of many, so a line may come close.
const TO_CORNER: f64 = 0.9;
/// Where a corner has exactly the height of the level, the window begins at this share of its length. Otherwise the
/// lines on all sides of the corner would meet there.
const OFF_CORNER: f64 = 0.125;

/// Heights at the nodes of a grid, and the levels to trace.
pub(super) struct Field<'a> {
    cols: usize,
    heights: &'a [f32],
    levels: &'a [f32],
    /// How many levels are not above the node.
    ranks: Vec<u32>,
}

/// Where a line crosses a side of a square. The unit is the cell, x grows to the east and y to the north; the first
/// node is the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// Whether the side runs from west to east, not from south to north.
    pub along_x: bool,
    /// The coordinate of the whole side.
    pub across: f64,
    /// The coordinate along the side.
    pub at: f64,
    /// Ends of the window along the side.
    pub window: [f64; 2],
    /// Whether the side rises with the coordinate.
    pub rises: bool,
}

impl Crossing {
    /// The point at a coordinate along the side.
    pub fn point(&self, at: f64) -> DVec2 {
        if self.along_x { DVec2::new(at, self.across) } else { DVec2::new(self.across, at) }
    }
}

/// How far a line may move along a side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Freedom {
    /// Largest distance along sides in x and in y, cells.
    pub tolerance: DVec2,
    /// Difference to the nearest other level, metres.
    pub gap: f64,
}

/// One line as it was traced. The last crossing of a closed line repeats the first one.
pub(super) struct Course<'a> {
    pub crossings: &'a [Crossing],
    pub is_closed: bool,
}

impl<'a> Field<'a> {
    /// `levels` ascend.
    pub fn new(heights: &'a [f32], cols: usize, levels: &'a [f32]) -> Self {
        let rank = |z: &f32| if z.is_nan() { NO_DATA } else { levels.partition_point(|level| level <= z) as u32 };
        Self { cols, heights, levels, ranks: parallel::values_each(heights, rank) }
    }

    /// The levels that cross the square whose north-west corner is this node, as indices. None for a node in the last
    /// column.
    pub fn levels_of(&self, node: usize) -> std::ops::Range<u32> {
        if !self.is_square(node) {
            return 0..0;
        }
        let ranks = self.corners(node).map(|n| self.ranks[n]);
        let low = ranks.into_iter().fold(NO_DATA, u32::min);
        low..ranks.into_iter().fold(0, u32::max)
    }

    /// Whether there is a square south-east of a node, with data at all corners.
    fn is_square(&self, node: usize) -> bool {
        node % self.cols + 1 < self.cols
            && node + self.cols < self.heights.len()
            && self.corners(node).iter().all(|&n| self.ranks[n] != NO_DATA)
    }

    /// The corners of a square clockwise from the north-west. Side `i` runs from corner `i` to the next one.
    fn corners(&self, square: usize) -> [usize; 4] {
        [square, square + 1, square + self.cols + 1, square + self.cols]
    }

    /// The square on the other side of side `i`, if there is one with data.
    fn across(&self, square: usize, i: usize) -> Option<usize> {
        let other = match i {
            0 => square.checked_sub(self.cols)?,
            1 => square + 1,
            2 => square + self.cols,
            _ if square.is_multiple_of(self.cols) => return None,
            _ => square - 1,
        };
        self.is_square(other).then_some(other)
    }

    /// The point where level `k` crosses side `i` of a square. It is the same for both squares of the side.
    fn crossing(&self, k: usize, square: usize, i: usize, freedom: Freedom) -> Crossing {
        let south_east = square + self.cols + 1;
        let (from, to) = match i {
            0 => (square, square + 1),
            1 => (square + 1, south_east),
            2 => (south_east - 1, south_east),
            _ => (square, south_east - 1),
        };
        let along_x = i.is_multiple_of(2);
        let (start, end) = (f64::from(self.heights[from]), f64::from(self.heights[to]));
        let share = (f64::from(self.levels[k]) - start) / (end - start);
        let tolerance = if along_x { freedom.tolerance.x } else { freedom.tolerance.y };
        let [mut low, mut high] = window(tolerance, freedom.gap / (end - start).abs(), share, TO_CORNER);
        if share <= 0.0 {
            low = OFF_CORNER * high;
        } else if share >= 1.0 {
            high = 1.0 - OFF_CORNER * (1.0 - low);
        }
        let share = share.clamp(low, high);
        let (col, row) = ((from % self.cols) as f64, (from / self.cols) as f64);
        let rises = end > start;
        if along_x {
            let (at, window) = (col + share, [col + low, col + high]);
            Crossing { along_x, across: -row, at, window, rises }
        } else {
            let (at, window) = (-row - share, [-row - high, -row - low]);
            Crossing { along_x, across: col, at, window, rises: !rises }
        }
    }
}

/// Traces one level.
pub(super) struct Trace<'a> {
    pub field: &'a Field<'a>,
    /// The level, as an index.
    pub k: u32,
    pub freedom: Freedom,
    /// For each square, four times the last level traced through it, plus a bit for each line that passed it.
    pub visited: &'a mut [u32],
}

/// The mark of a square before the first level.
pub(super) const NOT_VISITED: u32 = u32::MAX;

impl Trace<'_> {
    /// Hands over all lines through these squares, which are those that the level crosses: first the open ones, then the
    /// closed ones. Higher ground is on their right.
    pub fn lines(&mut self, squares: &[u32], mut line: impl FnMut(Course<'_>)) {
        let mut crossings = Vec::new();
        for open in [true, false] {
            for square in squares.iter().map(|&square| square as usize) {
                for entry in self.entries(square) {
                    let is_start = !open || self.field.across(square, entry).is_none();
                    if is_start && !self.is_visited(square, entry) {
                        crossings.clear();
                        let is_closed = self.walk(square, entry, &mut crossings);
                        line(Course { crossings: &crossings, is_closed });
                    }
                }
            }
        }
    }

    fn above(&self, square: usize) -> [bool; 4] {
        self.field.corners(square).map(|n| self.field.ranks[n] > self.k)
    }

    /// The sides at which lines with higher ground on their right enter a square.
    fn entries(&self, square: usize) -> impl Iterator<Item = usize> + use<> {
        let above = self.above(square);
        (0..4).filter(move |&i| above[i] && !above[(i + 1) % 4])
    }

    /// The side at which the line that entered by `entry` leaves.
    fn exit(&self, square: usize, entry: usize) -> usize {
        let above = self.above(square);
        let rises = |i: usize| !above[i % 4] && above[(i + 1) % 4];
        if rises(entry + 1) && rises(entry + 3) {
            let heights = self.field.corners(square).map(|n| f64::from(self.field.heights[n]));
            let mean = heights.iter().sum::<f64>() / 4.0;
            let are_joined = mean >= f64::from(self.field.levels[self.k as usize]);
            return (entry + if are_joined { 1 } else { 3 }) % 4;
        }
        (entry + (1..4).find(|d| rises(entry + d)).unwrap_or(2)) % 4
    }

    /// In a square with two lines, these enter from opposite sides.
    fn mark(entry: usize) -> u32 {
        1 << (entry / 2)
    }

    fn is_visited(&self, square: usize, entry: usize) -> bool {
        let mark = self.visited[square];
        mark != NOT_VISITED && mark >> 2 == self.k && mark & Self::mark(entry) != 0
    }

    fn visit(&mut self, square: usize, entry: usize) {
        let mark = &mut self.visited[square];
        let bits = if *mark != NOT_VISITED && *mark >> 2 == self.k { *mark & 3 } else { 0 };
        *mark = (self.k << 2) | bits | Self::mark(entry);
    }

    /// Follows a line from its first square, and tells whether it is closed.
    fn walk(&mut self, first: usize, entry: usize, crossings: &mut Vec<Crossing>) -> bool {
        let k = self.k as usize;
        crossings.push(self.field.crossing(k, first, entry, self.freedom));
        let (mut square, mut side) = (first, entry);
        loop {
            self.visit(square, side);
            let exit = self.exit(square, side);
            crossings.push(self.field.crossing(k, square, exit, self.freedom));
            let Some(next) = self.field.across(square, exit) else { return false };
            (square, side) = (next, (exit + 2) % 4);
            if (square, side) == (first, entry) {
                return true;
            }
        }
    }
}
