//! What the surface of an input is made from.

use std::mem::take;

use glam::DVec2;

use super::Input;
use crate::terrain::grid::Cells;
use crate::terrain::options::Options;
use tokosen_core::contour::ContourMap;
use tokosen_core::features::Features;
use tokosen_core::spline::{SplineParams, Wanted};
use tokosen_core::streams::Streams;
use tokosen_core::subdivision::Water;
use tokosen_core::subdomains::Frame;
use tokosen_core::surface::SurfaceParams;

impl Input {
    /// The parameters of the surface. Frame, lakes and lines are moved out of the input.
    pub(in crate::terrain) fn surface_params(&mut self, options: &Options, cells: Option<&Cells>) -> SurfaceParams {
        let wanted = cells.zip(middle(&self.map)).and_then(|(cells, place)| cells.wanted(place));
        surface_params(options, take(&mut self.features), self.coast.clone(), (take(&mut self.frame), wanted))
    }
}

/// The parameters of a surface with these features and coasts at these levels, in a frame.
pub(in crate::terrain) fn surface_params(
    options: &Options,
    features: Features,
    coast: Vec<f64>,
    (frame, wanted): (Frame, Option<Wanted>),
) -> SurfaceParams {
    let Features { cliffs, lakes, streams, river_areas, break_lines, sinks, .. } = features;
    SurfaceParams {
        kind: options.kind,
        frame,
        resolution: options.resolution,
        water: Water { lakes, sea: options.sea, coast },
        cliffs: cliffs.into_iter().map(|cliff| cliff.points).collect(),
        creases: break_lines,
        streams: Streams { lines: streams, areas: river_areas, tolerance: options.stream_tolerance },
        drain: options.drain,
        sinks,
        spline: SplineParams { wanted, tension: options.tension, noise: options.noise },
        whole: None,
        triangles: options.triangles,
        uncertainty: options.uncertainty,
        memory: options.memory,
        tuning: options.tuning,
    }
}

/// The middle of the box around the contours of a map.
fn middle(map: &ContourMap) -> Option<DVec2> {
    let points = map.contours.iter().flat_map(|c| c.points.iter().copied());
    let around = points.map(|p| (p, p)).reduce(|(lo, hi), (p, _)| (lo.min(p), hi.max(p)));
    around.map(|(lo, hi)| (lo + hi) / 2.0)
}
