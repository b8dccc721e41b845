//! One fault, one finding: the consequences of a reported fault are not reported again.

use std::collections::HashSet;

use crate::base::FeatureId;
use crate::base::error::{Finding, FindingKind, Proposal};

/// Removes findings that only follow from another one:
///
/// - a line with a wrong elevation also contradicts the ground around it;
/// - a piece that was cut out leaves a gap;
/// - a line far from the others moves the frame away from all ends.
pub fn first_causes(mut findings: Vec<Finding>) -> Vec<Finding> {
    use FindingKind::{FarAway, Gap, LevelJump, LooksLikeDegrees, OpenEnd, WrongLabel, ZeroElevation};
    let mut zero = HashSet::new();
    // Spot heights belong to no feature of lines.
    let mut is_new = |f: &Finding| f.features.iter().fold(f.features.is_empty(), |new, n| zero.insert(*n) | new);
    findings.retain(|f| f.kind != ZeroElevation || is_new(f));

    let frame_is_moved =
        findings.iter().any(|f| matches!(f.kind, FarAway | LooksLikeDegrees) && !f.features.is_empty());
    let known = |f: &&Finding| matches!(f.kind, FarAway | LooksLikeDegrees | LevelJump | ZeroElevation);
    let known: HashSet<FeatureId> = findings.iter().filter(known).flat_map(|f| f.features.iter().copied()).collect();
    let is_cut = |f: &&Finding| is_cut(f.kind);
    let mut cuts: Vec<Finding> = findings.iter().filter(is_cut).cloned().collect();
    // Sorted by x, to look only at those near a gap.
    cuts.sort_by(|a, b| x_of(a).total_cmp(&x_of(b)));
    findings.retain(|f| match f.kind {
        WrongLabel => !all_in(&f.features, &known),
        Gap => !all_in(&f.features, &known) && !is_left_by(f, &cuts),
        OpenEnd => !frame_is_moved && !all_in(&f.features, &known),
        _ => true,
    });
    findings
}

fn is_cut(kind: FindingKind) -> bool {
    use FindingKind::{LevelsCross, OverlappingLines, SelfCross, Spike};
    matches!(kind, LevelsCross | OverlappingLines | SelfCross | Spike)
}

fn x_of(finding: &Finding) -> f64 {
    finding.place.map_or(f64::NEG_INFINITY, |p| p.x)
}

fn all_in(features: &[FeatureId], known: &HashSet<FeatureId>) -> bool {
    !features.is_empty() && features.iter().all(|feature| known.contains(feature))
}

/// Whether a gap lies where a piece of its line was cut out.
fn is_left_by(gap: &Finding, cuts: &[Finding]) -> bool {
    let (Some(place), Some(Proposal::Join { ends: [a, b] })) = (gap.place, &gap.proposal) else { return false };
    let reach = a.distance(*b);
    let from = cuts.partition_point(|cut| x_of(cut) < place.x - reach);
    cuts[from..].iter().take_while(|cut| x_of(cut) <= place.x + reach).any(|cut| {
        let is_near = cut.place.is_some_and(|p| p.distance(place) <= reach);
        is_near && gap.features.iter().any(|feature| cut.features.contains(feature))
    })
}
