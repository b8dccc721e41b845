//! From a clean map to a surface: tiling, skeleton, and a triangulation with it.

use std::collections::HashSet;

use glam::DVec2;

use super::tiling::{Tiling, tiling_with_water};
use super::{Surface, SurfaceKind, SurfaceParams};
use crate::contour::ContourMap;
use crate::error::{Error, Report, Result};
use crate::progress::Progress;
use crate::skeleton::{End, Skeleton, skeleton};
use crate::tin::{Gaps, Regions, Side, Tin, TinInput, VertexKind};

/// Builds the surface of a clean map (see [`clean`](fn@crate::contour::clean)).
///
/// # Errors
/// As [`tiling_with_water`], and when the parameters are out of range.
pub fn build(map: ContourMap, params: &SurfaceParams, progress: &dyn Progress) -> Result<Report<Surface>> {
    if !params.resolution.is_finite() || params.resolution < 0.0 {
        return Err(Error::Parameter(format!(
            "the resolution parameter w is {}, it must be 0 or more",
            params.resolution
        )));
    }
    let Report { value: mut tiled, findings } = tiling_with_water(map, &params.frame, &params.water, progress)?;
    let bridges = bridges(&tiled.tin, &tiled.regions, &tiled.gaps);
    let mut break_lines = Vec::new();
    if params.kind == SurfaceKind::Skeleton {
        progress.start("ridge and canyon lines", 0);
        let skeleton = skeleton(&tiled.tin, &tiled.regions, params.resolution);
        progress.finish();
        progress.start("triangulating with them", 0);
        let mut input = tiled.input();
        push_skeleton(&mut input, &tiled.tin, &skeleton);
        tiled = tiled.retriangulated(input)?;
        progress.finish();
        break_lines = skeleton.lines;
    }
    let Tiling { map, tin, regions, frame, interval, .. } = tiled;
    let surface = Surface { map, tin, regions, bridges, break_lines, frame, interval };
    Ok(Report { value: surface, findings })
}

fn push_skeleton(input: &mut TinInput, tin: &Tin, skeleton: &Skeleton) {
    let points: Vec<u32> = skeleton
        .axis
        .points
        .iter()
        .zip(&skeleton.flow.heights)
        .map(|(p, &h)| input.push_local(p.position, h, VertexKind::Axis))
        .collect();
    for piece in &skeleton.axis.pieces {
        let [a, b] = piece.map(|end| match end {
            End::Axis(p) => points[p as usize],
            End::Vertex(v) => tin.source[v as usize],
        });
        input.push_edge(a, b);
    }
}

/// The bridges as lines, higher ground on their right.
fn bridges(tin: &Tin, regions: &Regions, gaps: &Gaps) -> Vec<(f64, [DVec2; 2])> {
    let mut wanted: HashSet<[u32; 2]> = gaps.bridges.iter().map(|&[u, v]| [u.min(v), u.max(v)]).collect();
    let mut found = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in 0..3 {
            let [u, v] = tin.edge(t, i);
            if wanted.is_empty() || !wanted.remove(&[u.min(v), u.max(v)]) {
                continue;
            }
            let level = tin.heights[u as usize];
            let rises = regions.region(t).and_then(|r| r.side(level)) == Some(Side::Above);
            // The triangle lies on the left of the edge from u to v.
            let ends = if rises { [v, u] } else { [u, v] };
            found.push((level, ends.map(|v| tin.point(v).truncate())));
        }
    }
    found
}
