//! Cliffs: lines across which the surface may jump. Contours end at them or run together in them.

use std::collections::BTreeSet;

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::Line;

use super::Input;
use tokosen_core::base::FeatureId;
use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::contour::CliffLine;
use tokosen_core::tuning::CliffTuning;

/// Findings that a cliff explains.
const EXPLAINED: [FindingKind; 8] = [
    FindingKind::Gap,
    FindingKind::OpenEnd,
    FindingKind::SkippedLevel,
    FindingKind::LevelsCross,
    FindingKind::SelfCross,
    FindingKind::OverlappingLines,
    FindingKind::ClosedGap,
    FindingKind::Spike,
];

impl Input {
    /// Takes cliffs, which are on the working plane. Ends of contours beside them are no gaps.
    pub(super) fn take_cliffs(&mut self, lines: Vec<CliffLine>) {
        if lines.is_empty() {
            return;
        }
        self.cliff_reach = CliffTuning::default().reach * self.mean_spacing();
        let near = NearCliffs::new(&lines, self.cliff_reach);
        let mut met = Vec::new();
        for line in self.map.contours.iter().filter(|line| !line.is_closed()) {
            let ends = [line.points.first(), line.points.last()].into_iter().flatten().copied();
            let before = met.len();
            met.extend(ends.filter(|end| near.holds(*end)));
            if met.len() > before {
                self.at_cliffs.insert(line.feature);
            }
        }
        if !met.is_empty() {
            let message = format!("{} ends of contours at cliffs are no gaps", met.len());
            self.findings.push(Finding::general(FindingKind::AtCliff, message));
        }
        self.map.cut_ends.extend(met);
        self.features.cliffs.extend(lines);
    }

    /// Mean spacing of the contours: the area of their box divided by their length, map units.
    fn mean_spacing(&self) -> f64 {
        let points = || self.map.contours.iter().flat_map(|line| &line.points).filter(|p| p.is_finite());
        let (least, most) = points().fold((DVec2::MAX, DVec2::MIN), |(a, b), p| (a.min(*p), b.max(*p)));
        let length: f64 = self.map.contours.iter().map(|line| line.length()).filter(|length| length.is_finite()).sum();
        if length > 0.0 { (most - least).element_product() / length } else { 0.0 }
    }

    /// [`explain_by_cliffs`] for all findings.
    pub(in crate::terrain) fn explain_by_cliffs(&mut self) {
        explain_by_cliffs(&mut self.findings, &self.features.cliffs, self.cliff_reach, &self.at_cliffs);
    }
}

/// Findings beside cliffs become notes that say so, and so do those about elevations of contours that end at a cliff: at its
/// end, the ground on the other side may have any elevation. `at_cliffs` are the features of these contours.
pub(in crate::terrain) fn explain_by_cliffs(
    findings: &mut [Finding],
    cliffs: &[CliffLine],
    reach: f64,
    at_cliffs: &BTreeSet<FeatureId>,
) {
    let near = NearCliffs::new(cliffs, reach);
    let ends_there = |f: &Finding| f.features.iter().all(|feature| at_cliffs.contains(feature));
    let is_explained = |f: &Finding| match f.kind {
        FindingKind::WrongLabel => !f.features.is_empty() && ends_there(f),
        kind => EXPLAINED.contains(&kind) && f.place.is_some_and(|p| near.holds(p)),
    };
    for finding in findings.iter_mut().filter(|finding| is_explained(finding)) {
        finding.message = format!("at a cliff: {}", finding.message);
        finding.kind = FindingKind::AtCliff;
    }
}

/// The places near cliffs.
struct NearCliffs {
    segments: RTree<Line<[f64; 2]>>,
    reach: f64,
}

impl NearCliffs {
    fn new(cliffs: &[CliffLine], reach: f64) -> Self {
        let segments = cliffs.iter().flat_map(|line| line.points.windows(2));
        let segments = segments.map(|w| Line::new(w[0].to_array(), w[1].to_array())).collect();
        Self { segments: RTree::bulk_load(segments), reach }
    }

    fn holds(&self, p: DVec2) -> bool {
        p.is_finite() && self.segments.locate_within_distance(p.to_array(), self.reach * self.reach).next().is_some()
    }
}
