//! A surface that was built.

use glam::DVec2;

use crate::contour::{ContourMap, Interval};
use crate::skeleton::BreakLine;
use crate::spline::WorkingGrid;
use crate::subdomains::{FrameRing, Regions};
use crate::tin::Tin;
use crate::validate::{Chosen, ErrorField};

/// Heights everywhere inside the frame.
#[derive(Debug, Clone)]
pub struct Surface {
    /// The map that the surface was built from, cut to the frame.
    pub map: ContourMap,
    /// The triangulation, contours among its edges, every vertex with a height.
    pub tin: Tin,
    /// The sub-domains of its triangles.
    pub regions: Regions,
    /// Pieces across gaps in contours: level and ends, higher ground on the right.
    pub closures: Vec<(f64, [DVec2; 2])>,
    /// Ridge and canyon lines; empty for [`SurfaceKind::Linear`](super::SurfaceKind::Linear).
    pub break_lines: Vec<BreakLine>,
    /// The frame's outline.
    pub frame: FrameRing,
    /// The input's vertical interval.
    pub interval: Interval,
    /// The smooth surface; only for [`SurfaceKind::Spline`](super::SurfaceKind::Spline).
    pub working: Option<WorkingGrid>,
    /// How the smooth surface was drawn, and how far it may be off; only for [`SurfaceKind::Spline`](super::SurfaceKind::Spline).
    pub chosen: Option<Chosen>,
    /// The expected error, if it was asked for.
    pub errors: Option<ErrorField>,
}
