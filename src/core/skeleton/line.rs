//! Ridge and canyon lines as data.

use glam::DVec3;

/// Which way the ground falls from a break line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SkeletonKind {
    /// Ground falls to both sides.
    Ridge,
    /// Ground rises to both sides.
    Canyon,
}

/// What lies at the end of a ridge or canyon line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LineEnd {
    /// A vertex of a contour: the tip of a bend, or a vertex of the next contour. A line of the neighbouring sub-domain
    /// may continue there.
    Contour,
    /// Another line of the sub-domain, which continues through this point.
    Junction,
    /// The highest point of a ridge.
    Peak,
    /// The lowest point of a canyon without an outlet.
    Bottom,
    /// The lowest point of a ridge between two ways up, the highest of a canyon between two ways down.
    Saddle,
    /// The frame or a barrier edge.
    Frame,
    /// A spot height.
    Spot,
}

impl LineEnd {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Contour => "contour",
            Self::Junction => "junction",
            Self::Peak => "peak",
            Self::Bottom => "bottom",
            Self::Saddle => "saddle",
            Self::Frame => "frame",
            Self::Spot => "spot",
        }
    }
}

/// A ridge or canyon line with its heights, which fall from the first point to the last.
#[derive(Debug, Clone, PartialEq)]
pub struct SkeletonLine {
    /// Ridge or canyon.
    pub kind: SkeletonKind,
    /// Vertices (x, y in map units, height in metres), downhill.
    pub points: Vec<DVec3>,
    /// The sub-domain that the line runs in.
    pub region: u32,
    /// What lies at the first point, and what at the last.
    pub ends: [LineEnd; 2],
    /// Number of the network. Lines that share end points, directly or through other lines, have the same number.
    pub network: u32,
}

impl SkeletonLine {
    /// Length on the map, map units.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|w| w[0].truncate().distance(w[1].truncate())).sum()
    }
}
