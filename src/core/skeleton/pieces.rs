//! The axis as data: its points and the pieces between them.

use glam::DVec2;

use crate::tin::NONE;

/// A point of the axis. Most lie midway between two vertices on one level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPoint {
    /// Position relative to the triangulation's origin.
    pub position: DVec2,
    /// The level of those vertices; none for a point anywhere in its sub-domain.
    pub level: Option<f64>,
    /// A triangle that the point lies in or on.
    pub triangle: u32,
    /// The sub-domain.
    pub region: u32,
}

/// The end of a piece of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum End {
    /// To an axis point.
    Axis(u32),
    /// To a vertex of the triangulation: the tip of a contour's bend, or a vertex of the next contour.
    Vertex(u32),
}

/// Axis points and the pieces of line between them.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// The points. Those in dropped branches are here too: they carry heights, but no lines.
    pub points: Vec<AxisPoint>,
    /// Pieces of ridge and canyon lines. The first end is an axis point.
    pub pieces: Vec<[End; 2]>,
}

impl Axis {
    /// Drops the points that are not `kept`, and the pieces that lead to them.
    pub(crate) fn retain(&mut self, kept: &[bool]) {
        let is_kept = |end: &End| !matches!(end, End::Axis(p) if !kept[*p as usize]);
        self.pieces.retain(|piece| piece.iter().all(is_kept));
        let mut number = vec![NONE; kept.len()];
        for (next, k) in (0..kept.len()).filter(|&k| kept[k]).enumerate() {
            number[k] = next as u32;
        }
        let mut kept = kept.iter();
        self.points.retain(|_| *kept.next().unwrap_or(&false));
        for end in self.pieces.iter_mut().flatten() {
            if let End::Axis(p) = end {
                *p = number[*p as usize];
            }
        }
    }
}
