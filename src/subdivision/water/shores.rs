//! What lakes are settled in.

use crate::contour::ContourMap;
use crate::subdomains::{FrameRing, Link, Regions};
use crate::tin::Tin;

/// The ground without lakes.
pub(crate) struct Shores<'a> {
    pub map: &'a ContourMap,
    pub links: &'a [Link],
    pub frame: &'a FrameRing,
    pub tin: &'a Tin,
    pub regions: &'a Regions,
}
