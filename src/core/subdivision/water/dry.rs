//! The data for placing lakes.

use crate::contour::ContourMap;
use crate::subdomains::{FrameExtension, FrameRing, Regions};
use crate::tin::Tin;

/// The map and its subdivision without lakes.
pub(crate) struct DrySubdivision<'a> {
    pub map: &'a ContourMap,
    pub extensions: &'a [FrameExtension],
    pub frame: &'a FrameRing,
    pub tin: &'a Tin,
    pub regions: &'a Regions,
}
