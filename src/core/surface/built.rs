//! A surface that was built.

use glam::DVec2;

use crate::break_lines::FittedBreakLine;
use crate::contour::{ContourMap, Interval};
use crate::drain::{Drain, Sink};
use crate::skeleton::SkeletonLine;
use crate::spline::WorkingGrids;
use crate::streams::{RiverArea, Stream};
use crate::subdomains::{FrameRing, Regions};
use crate::tin::Tin;
use crate::validate::{Chosen, ErrorField};

/// Heights everywhere inside the frame.
#[derive(Debug, Clone)]
pub struct Surface {
    /// The map that the surface was built from, cut to the frame.
    pub map: ContourMap,
    /// The triangulation. Its edges include the contours, and every vertex has a height.
    pub tin: Tin,
    /// The sub-domains of its triangles.
    pub regions: Regions,
    /// Gap closures, which are pieces across gaps in contours: level (metres) and ends (map coordinates), higher ground
    /// on the right.
    pub closures: Vec<(f64, [DVec2; 2])>,
    /// Ridge and canyon lines; empty for [`SurfaceKind::Linear`](super::SurfaceKind::Linear).
    pub skeleton_lines: Vec<SkeletonLine>,
    /// The streams as they are used.
    pub streams: Vec<Stream>,
    /// How far cells of height maps may be from the height of the stream through them, metres.
    pub stream_tolerance: f64,
    /// The given river areas: height maps are level across them.
    pub river_areas: Vec<RiverArea>,
    /// The given break lines as they are used.
    pub break_lines: Vec<FittedBreakLine>,
    /// Which pits get a way out in height maps.
    pub drain: Drain,
    /// Where water may stay. A point is the deepest place of its pit.
    pub sinks: Vec<Sink>,
    /// Numbers of the contours whose elevation contradicts the ground around it, ascending.
    pub wrong_lines: Vec<u32>,
    /// The outline of the frame.
    pub frame: FrameRing,
    /// The contour interval of the input.
    pub interval: Interval,
    /// The smooth surface. Only for [`SurfaceKind::Spline`](super::SurfaceKind::Spline).
    pub working: Option<WorkingGrids>,
    /// The hyper-parameters of the smooth surface and its accuracy. Only for
    /// [`SurfaceKind::Spline`](super::SurfaceKind::Spline).
    pub chosen: Option<Chosen>,
    /// The expected error, if it was requested.
    pub errors: Option<ErrorField>,
}
