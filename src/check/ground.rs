//! What checks look at: a map with its triangulation.

use crate::contour::ContourMap;
use crate::subdomains::{FrameExtension, FrameRing, GapEdges, OpenEnd, Regions};
use crate::tin::Tin;

/// A triangulated map, as it is judged.
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
    /// From ends to the frame.
    pub extensions: &'a [FrameExtension],
    /// What closes the openings between ends.
    pub gaps: &'a GapEdges,
}
