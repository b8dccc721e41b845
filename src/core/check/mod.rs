//! Checks of a map: the faults of its contours, where they are, and their corrections.
//!
//! Faults that one line or a pair of lines shows are found when the map is read, by [`examine`], and by cleaning. Wrong
//! elevations, missing contours and gaps show only in the ground around them. They need the sub-domains, so they are
//! found in the triangulation.

mod bands;
mod causes;
mod correction;
mod depressions;
mod ends;
mod graph;
mod grid;
mod ground;
mod labels;
mod lakes;
mod lines;
mod placeholders;
mod sea;
mod widths;

pub use causes::first_causes;
pub use correction::{Correction, Judged, correct};
pub(crate) use depressions::contradicted_marks;
pub(crate) use ground::Ground;
pub(crate) use lakes::possible_lakes;
pub use lines::{LineParams, examine, far_lines, merged};
pub use placeholders::{Placeholders, placeholder_heights, placeholders};
pub(crate) use sea::possible_sea;

use self::graph::Graph;
use self::grid::LevelGrid;

/// Checks the labels, the ends and the completeness of a triangulated map, from the bands of its sub-domains.
pub(crate) fn judge(ground: &Ground) -> Judged {
    let Ground { map, tin, regions, gaps, .. } = *ground;
    let mut judged = Judged::default();
    let grid = LevelGrid::new(map, &regions.interval);
    let graph = Graph::new(map, tin, regions, gaps, &grid);
    let explained = bands::explain(&graph, &widths::for_missing(tin, regions, &graph));
    let spans = &explained.spans;
    let mut wrong = labels::wrong_labels(map, &graph, &explained, &grid);
    labels::settle_innermost(ground, &graph, &grid, spans, &mut wrong);
    labels::report_wrong(map, &grid, &wrong, &mut judged);
    labels::report_skipped(ground, &graph, &grid, spans, &mut judged);
    labels::report_auxiliary(map, &grid, &wrong, &mut judged);
    ends::report_ends(ground, &graph, &grid, &wrong, &mut judged);
    judged
}
