//! Streams along which the ground rises between contours are cut there.

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;

use super::line::Stream;
use crate::base::FeatureId;
use crate::base::error::{Finding, FindingKind};

/// Cuts streams where the surface rises along them by more than `least` metres. Between contours nothing else speaks against
/// such a stream, and one height for both sides of a ridge would be wrong on both. A piece ends where the rise is `least`, and
/// the next one begins at the top. So no height changes by more than `least` when the pieces are made to fall. `height` is that
/// of the surface. `streams` come in an order in which each one follows those that flow into it.
pub(crate) fn without_climbs(
    streams: &[Stream],
    height: impl Fn(DVec2) -> f64,
    least: f64,
) -> (Vec<Stream>, Vec<Finding>) {
    let mut pieces = Vec::with_capacity(streams.len());
    // The lowest height upstream of where a stream begins.
    let mut lowest: HashMap<[u64; 2], f64> = HashMap::new();
    // For each feature, its largest rise and where it ends, and the length that is left out.
    let mut rises: BTreeMap<FeatureId, (f64, DVec2, f64)> = BTreeMap::new();
    for stream in streams {
        let Some([first, last]) = stream.ends() else { continue };
        let heights: Vec<f64> = (0..stream.points.len()).map(|k| stream.height_on(k, &height)).collect();
        let mut low = lowest.get(&first).copied().unwrap_or(f64::INFINITY);
        let (mut start, mut k) = (0, 0);
        while k < heights.len() {
            if heights[k] - low > least {
                let is_over = |z: &&f64| **z - low > least;
                let end = k + heights[k..].iter().take_while(is_over).count();
                let top = (k..end).rev().max_by(|&a, &b| heights[a].total_cmp(&heights[b])).unwrap_or(k);
                pieces.extend(stream.part(start..k));
                let left_out = stream.part(k.saturating_sub(1)..top + 1).map_or(0.0, |piece| piece.length());
                let rise = rises.entry(stream.feature).or_insert((0.0, DVec2::ZERO, 0.0));
                if heights[top] - low > rise.0 {
                    (rise.0, rise.1) = (heights[top] - low, stream.points[top].truncate());
                }
                rise.2 += left_out;
                (start, k, low) = (top, top, heights[top]);
            }
            low = low.min(heights[k]);
            k += 1;
        }
        pieces.extend(stream.part(start..heights.len()));
        let at = lowest.entry(last).or_insert(f64::INFINITY);
        *at = at.min(low);
    }
    let finding = |(feature, (rise, place, length)): (FeatureId, (f64, DVec2, f64))| {
        let message = format!(
            "the ground rises by {rise:.1} m along the stream, which the contours neither show nor forbid; it may be drawn \
             over a ridge. {length:.0} m of it are left out"
        );
        Finding::at(FindingKind::StreamClimbs, place, message).of_feature(feature)
    };
    (pieces, rises.into_iter().map(finding).collect())
}
