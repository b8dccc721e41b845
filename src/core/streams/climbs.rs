//! Streams along which the ground rises between contours.

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;

use super::line::Stream;
use crate::base::FeatureId;
use crate::base::error::{Finding, FindingKind};

/// The findings about streams along which the surface rises by more than `least` metres. Between contours nothing else speaks
/// against such a stream. `height` is that of the surface. `streams` come in an order in which each one follows those that flow
/// into it.
pub(crate) fn climbs(streams: &[Stream], height: impl Fn(DVec2) -> f64, least: f64) -> Vec<Finding> {
    // The lowest height upstream of where a stream begins.
    let mut lowest: HashMap<[u64; 2], f64> = HashMap::new();
    // For each feature, its largest rise and where it ends.
    let mut rises: BTreeMap<FeatureId, (f64, DVec2)> = BTreeMap::new();
    for stream in streams {
        let Some([first, last]) = stream.ends() else { continue };
        let mut low = lowest.get(&first).copied().unwrap_or(f64::INFINITY);
        for place in stream.points.iter().map(|p| p.truncate()) {
            let z = height(place);
            low = low.min(z);
            if z - low > least {
                let rise = rises.entry(stream.feature).or_insert((0.0, place));
                if z - low > rise.0 {
                    *rise = (z - low, place);
                }
            }
        }
        let at = lowest.entry(last).or_insert(f64::INFINITY);
        *at = at.min(low);
    }
    let finding = |(feature, (rise, place)): (FeatureId, (f64, DVec2))| {
        let message = format!(
            "the ground rises by {rise:.1} m along the stream, which the contours neither show nor forbid; it may be drawn \
             over a ridge. Its heights there are levelled"
        );
        Finding::at(FindingKind::StreamClimbs, place, message).of_feature(feature)
    };
    rises.into_iter().map(finding).collect()
}
