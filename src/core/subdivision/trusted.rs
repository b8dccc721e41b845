//! The part of a map from which hyper-parameters and errors may be learnt. Near wrong labels, all ground looks rough
//! when levels are hidden, and sub-domains get bands that are not theirs.

use super::Subdivision;
use crate::check::{Correction, correct};
use crate::contour::ContourMap;
use crate::subdomains::MapExtent;

impl Subdivision {
    /// The map with the elevations that are proposed for wrong labels. Lines whose label is wrong without a proposal
    /// are left out. `None` if no label contradicts the ground around it.
    pub(crate) fn trusted(&self) -> Option<ContourMap> {
        let is_label = |c: &&Correction| matches!(c, Correction::Label { .. });
        let labels: Vec<Correction> = self.corrections.iter().filter(is_label).cloned().collect();
        if labels.is_empty() && self.doubted.is_empty() {
            return None;
        }
        let mut map = correct(self.map.clone(), &labels).value;
        let mut lines = 0u32..;
        map.contours.retain(|_| lines.next().is_some_and(|line| self.doubted.binary_search(&line).is_err()));
        Some(map)
    }

    /// Numbers of the lines whose label contradicts the ground around it, ascending.
    pub(crate) fn wrong_lines(&self) -> Vec<u32> {
        let label = |c: &Correction| if let Correction::Label { line, .. } = c { Some(*line) } else { None };
        let mut lines: Vec<u32> =
            self.corrections.iter().filter_map(label).chain(self.doubted.iter().copied()).collect();
        lines.sort_unstable();
        lines.dedup();
        lines
    }

    /// The extent of another map in the same frame.
    pub(crate) fn extent_of<'a>(&'a self, map: &'a ContourMap) -> MapExtent<'a> {
        let extent = MapExtent::new(map, &self.frame, self.interval);
        self.spacing.map_or(extent, |spacing| MapExtent { spacing, ..extent })
    }
}
