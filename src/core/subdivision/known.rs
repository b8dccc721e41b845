//! The sub-domains that have at least one contour.

use glam::DVec2;

use crate::base::error::{Finding, FindingKind, Report};
use crate::contour::Interval;
use crate::subdomains::{Regions, regions};
use crate::tin::Tin;

/// Finds the sub-domains. Parts of the frame without any contour are removed from the frame, because nothing is known
/// of their heights.
pub(super) fn known_regions(tin: Tin, interval: &Interval) -> (Tin, Report<Regions>) {
    let found = regions(&tin, interval);
    let middle = |t: u32| tin.corners(t).iter().sum::<DVec2>() / 3.0 + tin.origin;
    let unknown = found.regions.iter().filter(|r| r.levels.is_empty());
    let unknown: Vec<DVec2> = unknown.map(|r| middle(r.triangle)).collect();
    if unknown.is_empty() {
        return (tin, Report { value: found, findings: Vec::new() });
    }
    let is_known: Vec<bool> =
        (0..tin.len() as u32).map(|t| found.region(t).is_some_and(|r| !r.levels.is_empty())).collect();
    let tin = tin.only(&is_known);
    let value = regions(&tin, interval);
    let findings = unknown.into_iter().map(|place| {
        let message = "a part of the frame holds no contour; it is left without heights";
        Finding::at(FindingKind::FrameBeyondMap, place, message)
    });
    (tin, Report { value, findings: findings.collect() })
}
