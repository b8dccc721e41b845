//! The streams and break lines of a map, in agreement with its contours.

use super::given::Given;
use super::params::{SurfaceKind, SurfaceParams};
use crate::base::error::Finding;
use crate::base::progress::Progress;
use crate::base::{KnownLine, Sure};
use crate::break_lines::{self, FittedBreakLine};
use crate::skeleton::Heights;
use crate::streams::{self, Stream};
use crate::subdivision::Subdivision;

/// Streams and break lines that agree with the contours.
#[derive(Default)]
pub struct GivenLines<'a> {
    /// The streams, with heights.
    pub streams: Vec<Stream>,
    /// The break lines, with heights.
    pub break_lines: Vec<FittedBreakLine>,
    /// What was turned, moved, cut, left out, or contradicts the contours.
    pub findings: Vec<Finding>,
    /// Heights by the distance from contours, if any line needed them.
    pub(crate) heights: Option<Heights<'a>>,
}

/// Brings the given streams and break lines into agreement with the contours. The linear surface has none.
pub fn settle_lines<'a>(
    subdivision: &'a Subdivision,
    given: &Given,
    params: &SurfaceParams,
    progress: &dyn Progress,
) -> GivenLines<'a> {
    let mut settled = GivenLines::default();
    if params.kind == SurfaceKind::Linear {
        return settled;
    }
    let spacing = subdivision.extent().spacing;
    let Subdivision { map, tin, regions, .. } = subdivision;
    if !given.streams.lines.is_empty() || !given.streams.areas.is_empty() {
        progress.start("streams", 0);
        let heights = settled.heights.get_or_insert_with(|| Heights::new(tin, regions));
        // Without a smooth surface, the curve along a stream is what is known between near contours.
        let known_from = if params.kind == SurfaceKind::Skeleton { Sure::Between } else { Sure::Exact };
        let tuning = &params.tuning.streams;
        let tolerance = params.stream_tolerance.unwrap_or(tuning.tolerance * spacing);
        let found =
            streams::settle(&given.streams, (map, tin, regions), heights, (spacing, tolerance), known_from, tuning);
        settled.streams = found.streams;
        settled.findings.extend(found.findings);
        progress.finish();
    }
    let step = spacing / params.tuning.break_lines.vertices_per_spacing;
    let (banks, about_areas) = streams::banks(&given.streams.areas, &settled.streams, step);
    settled.findings.extend(about_areas);
    if !banks.is_empty() || !given.break_lines.is_empty() {
        progress.start("break lines", 0);
        let heights = settled.heights.get_or_insert_with(|| Heights::new(tin, regions));
        // The heights of banks are those of the streams beside them.
        let both = [(banks.as_slice(), Sure::Between), (given.break_lines.as_slice(), Sure::Surveyed)];
        for lines in both.into_iter().filter(|(lines, _)| !lines.is_empty()) {
            let interval = subdivision.interval.step;
            let found =
                break_lines::settle(lines, (tin, regions), heights, interval, spacing, &params.tuning.break_lines);
            settled.break_lines.extend(found.break_lines);
            settled.findings.extend(found.findings);
        }
        progress.finish();
    }
    settled
}

/// Streams and break lines with their heights.
pub(super) fn known<'a>(
    streams: &'a [Stream],
    break_lines: &'a [FittedBreakLine],
) -> impl Iterator<Item = KnownLine<'a>> {
    streams.iter().map(Stream::known).chain(break_lines.iter().map(FittedBreakLine::known))
}
