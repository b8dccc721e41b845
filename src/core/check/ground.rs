//! The input of checks: a map with its triangulation.

use crate::contour::ContourMap;
use crate::subdomains::{FrameExtension, FrameRing, GapEdges, OpenEnd, Regions};
use crate::tin::Tin;

/// A triangulated map to be checked.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    /// The clean map, cut to the frame.
    pub map: &'a ContourMap,
    /// Its triangulation, the map's contours before all other points.
    pub tin: &'a Tin,
    /// The sub-domains of its triangles.
    pub regions: &'a Regions,
    /// The frame.
    pub frame: &'a FrameRing,
    /// All ends of open contours.
    pub ends: &'a [OpenEnd],
    /// The frame extensions of open ends.
    pub extensions: &'a [FrameExtension],
    /// The edges that close openings between ends.
    pub gaps: &'a GapEdges,
}
