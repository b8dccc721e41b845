//! The streams and break lines of a map, in agreement with its contours.

use super::params::{SurfaceKind, SurfaceParams};
use crate::base::error::Finding;
use crate::base::progress::Progress;
use crate::base::{KnownLine, Sure};
use crate::creases::{self, Crease};
use crate::skeleton::Heights;
use crate::streams::{self, Stream};
use crate::subdivision::Subdivision;

/// Streams and break lines that agree with the contours.
#[derive(Default)]
pub struct GivenLines<'a> {
    /// The streams, with heights.
    pub streams: Vec<Stream>,
    /// The break lines, with heights.
    pub creases: Vec<Crease>,
    /// What was turned, moved, cut, left out, or contradicts the contours.
    pub findings: Vec<Finding>,
    /// Heights by the distance from contours, if any line needed them.
    pub(crate) heights: Option<Heights<'a>>,
}

/// Brings the streams and break lines of the parameters into agreement with the contours. The linear surface has none.
pub fn settle_lines<'a>(
    subdivision: &'a Subdivision,
    params: &SurfaceParams,
    progress: &dyn Progress,
) -> GivenLines<'a> {
    let mut given = GivenLines::default();
    if params.kind == SurfaceKind::Linear {
        return given;
    }
    let spacing = subdivision.extent().spacing;
    let Subdivision { map, tin, regions, .. } = subdivision;
    if !params.streams.lines.is_empty() || !params.streams.areas.is_empty() {
        progress.start("streams", 0);
        let heights = given.heights.get_or_insert_with(|| Heights::new(tin, regions));
        // Without a smooth surface, the curve along a stream is what is known between near contours.
        let known_from = if params.kind == SurfaceKind::Skeleton { Sure::Between } else { Sure::Exact };
        let tuning = &params.tuning.streams;
        let settled = streams::settle(&params.streams, (map, tin, regions), heights, spacing, known_from, tuning);
        given.streams = settled.streams;
        given.findings.extend(settled.findings);
        progress.finish();
    }
    let step = spacing / params.tuning.creases.vertices_per_spacing;
    let (banks, about_areas) = streams::banks(&params.streams.areas, &given.streams, step);
    given.findings.extend(about_areas);
    if !banks.is_empty() || !params.creases.is_empty() {
        progress.start("break lines", 0);
        let heights = given.heights.get_or_insert_with(|| Heights::new(tin, regions));
        // The heights of banks are those of the streams beside them.
        let both = [(banks.as_slice(), Sure::Between), (params.creases.as_slice(), Sure::Surveyed)];
        for lines in both.into_iter().filter(|(lines, _)| !lines.is_empty()) {
            let interval = subdivision.interval.step;
            let settled = creases::settle(lines, (tin, regions), heights, interval, spacing, &params.tuning.creases);
            given.creases.extend(settled.creases);
            given.findings.extend(settled.findings);
        }
        progress.finish();
    }
    given
}

/// Streams and break lines with their heights.
pub(super) fn known<'a>(streams: &'a [Stream], creases: &'a [Crease]) -> impl Iterator<Item = KnownLine<'a>> {
    streams.iter().map(Stream::known).chain(creases.iter().map(Crease::known))
}
