//! The steps from a triangulation to its skeleton.

use super::axis::axis;
use super::eliminate::{Elimination, eliminate};
use super::flow::{Flow, flow};
use super::heights::{Heights, axis_heights};
use super::line::SkeletonLine;
use super::lines::skeleton_lines;
use super::pieces::{Axis, AxisPoint};
use crate::subdomains::Regions;
use crate::tin::{Tin, TriangleKind, triangle_kinds};
use crate::tuning::SkeletonTuning;

/// The axis of a map's spurs, gullies and tops, with heights and as lines.
#[derive(Debug, Clone)]
pub struct Skeleton {
    /// Axis points and the pieces between them.
    pub axis: Axis,
    /// Heights of the axis points, and the direction in which the pieces fall.
    pub flow: Flow,
    /// Ridge and canyon lines.
    pub lines: Vec<SkeletonLine>,
    /// Kind of each triangle.
    pub kinds: Vec<TriangleKind>,
    /// Junctions that were turned into sleeves, and the branches that were dropped with them.
    pub elimination: Elimination,
}

/// Finds ridge and canyon lines. `resolution` is the paper's w: a larger value gives fewer lines.
pub fn skeleton(tin: &Tin, regions: &Regions, resolution: f64, tuning: &SkeletonTuning) -> Skeleton {
    skeleton_by((tin, regions), resolution, tuning, |points| axis_heights(tin, regions, points, tuning))
}

/// The [`skeleton`] of the triangulation that `heights` are of.
pub(crate) fn skeleton_with(heights: &Heights<'_>, resolution: f64, tuning: &SkeletonTuning) -> Skeleton {
    skeleton_by((heights.tin, heights.regions), resolution, tuning, |points| heights.of_points(points, tuning))
}

/// The skeleton of a triangulation. `heights` gives those of the axis points.
fn skeleton_by(
    (tin, regions): (&Tin, &Regions),
    resolution: f64,
    tuning: &SkeletonTuning,
    heights: impl FnOnce(&[AxisPoint]) -> Vec<f64>,
) -> Skeleton {
    let kinds = triangle_kinds(tin);
    let elimination = eliminate(tin, &kinds, regions, resolution);
    let axis = axis(tin, &kinds, regions, &elimination, tuning.join_reach);
    let heights = heights(&axis.points);
    let flow = flow(tin, regions, &axis, heights, tuning);
    let lines = skeleton_lines(tin, regions, &axis, &flow);
    Skeleton { axis, flow, lines, kinds, elimination }
}
