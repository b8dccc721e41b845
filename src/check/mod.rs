//! Checks of a map: what is wrong with its contours, where, and what would mend it.
//!
//! Faults that one line or a pair of lines shows are found while the map is read, by [`examine`], and by cleaning. Those that
//! only the ground around shows (wrong elevations, missing contours, gaps) need its sub-domains, so they are found in the
//! triangulation.

mod bands;
mod causes;
mod correction;
mod depressions;
mod ends;
mod graph;
mod grid;
mod ground;
mod labels;
mod lines;
mod widths;

pub use causes::first_causes;
pub use correction::{Correction, Judged, correct};
pub(crate) use depressions::contradicted_marks;
pub(crate) use ground::Ground;
pub use lines::{LineParams, examine, merged};

use self::graph::Graph;
use self::grid::LevelGrid;

/// Judges the labels, the ends and the completeness of a triangulated map by the bands of its sub-domains.
pub(crate) fn judge(ground: &Ground) -> Judged {
    let Ground { map, tin, regions, gaps, .. } = *ground;
    let mut judged = Judged::default();
    let grid = LevelGrid::new(map, &regions.interval);
    let graph = Graph::new(map, tin, regions, gaps, &grid);
    let explained = bands::explain(&graph, &widths::for_missing(tin, regions, &graph));
    let spans = &explained.spans;
    let mut wrong = labels::wrong_labels(map, &graph, &explained, &grid);
    labels::settle_innermost(ground, &graph, &grid, spans, &mut wrong);
    labels::tell_wrong(map, &grid, &wrong, &mut judged);
    labels::tell_skipped(ground, &graph, &grid, spans, &mut judged);
    labels::tell_auxiliary(map, &grid, &wrong, &mut judged);
    ends::tell_ends(ground, &graph, &grid, &wrong, &mut judged);
    judged
}
