//! Ridge and canyon lines (paper, section 4).

use glam::DVec3;

/// Which way the ground falls from a break line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BreakKind {
    /// Ground falls to both sides.
    Ridge,
    /// Ground rises to both sides.
    Canyon,
}

/// A ridge or canyon line with its heights.
#[derive(Debug, Clone, PartialEq)]
pub struct BreakLine {
    /// Ridge or canyon.
    pub kind: BreakKind,
    /// Vertices (x, y in map units, height in metres).
    pub points: Vec<DVec3>,
}
