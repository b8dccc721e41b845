//! What the lines of a zoom go through: they are joined, then simplified, then moved to the grid.

use super::chains::{Chain, chains};
use super::mercator::in_tiles;
use super::network::{LONGEST, LevelLine, Line, Network};
use super::{EXTENT, snap, thin};
use crate::geometry::Bounds;

/// Largest distance of a vertex that is left out from its line, units: a quarter of a pixel.
const TOLERANCE: f64 = 2.0;
/// The same at the highest zoom, which map libraries enlarge.
const FINE_TOLERANCE: f64 = 1.0;
/// Lines whose length and width are less are left out, units: two pixels.
const SMALLEST: f64 = 16.0;
/// The same at the highest zoom.
const FINE_SMALLEST: f64 = 4.0;

impl Network {
    /// The network of lines for the highest zoom. Those of one level that meet at their ends are joined.
    pub fn new(lines: Vec<LevelLine>, zoom: u8) -> Self {
        let mut network = Self { zoom, fineness: 1, lines: Vec::new(), places: Vec::new() };
        for Chain { level, mut points, is_ring } in chains(lines) {
            if is_ring {
                points.pop();
            }
            points.iter_mut().for_each(|p| *p = in_tiles(*p, zoom) * f64::from(EXTENT));
            network.push(level, is_ring, points.into_iter());
        }
        network
    }

    /// Leaves out what cannot be seen: lines, whose number is returned, and vertices. No line touches another one by it.
    pub fn simplify(&mut self, is_highest: bool) -> usize {
        let (tolerance, smallest) = if is_highest { (FINE_TOLERANCE, FINE_SMALLEST) } else { (TOLERANCE, SMALLEST) };
        let before = self.lines.len();
        let size = |line: &Line| {
            let vertices = &self.places[line.first as usize..(line.first + line.count) as usize];
            let bounds = Bounds::around(vertices);
            (bounds.max - bounds.min).max_element()
        };
        let is_seen: Vec<bool> = self.lines.iter().map(|line| size(line) >= smallest).collect();
        self.retain(|k, _| is_seen[k]);
        thin::thin(self, tolerance, LONGEST);
        before - self.lines.len()
    }

    /// Moves all vertices to the grid. Returns the number of gaps in lines that lie closer to another level than any grid shows.
    pub fn to_grid(&mut self) -> usize {
        snap::snap(self)
    }
}
