//! What the surface of an input is made from.

use std::mem::take;

use glam::DVec2;

use super::Input;
use crate::terrain::grid::Cells;
use crate::terrain::options::Options;
use tokosen_core::contour::ContourMap;
use tokosen_core::spline::{SplineParams, Wanted};
use tokosen_core::subdomains::Frame;
use tokosen_core::surface::{Given, SurfaceParams};

impl Input {
    /// The parameters of the surface. The frame is moved out of the input.
    pub(in crate::terrain) fn surface_params(&mut self, options: &Options, cells: Option<&Cells>) -> SurfaceParams {
        let wanted = cells.zip(middle(&self.map)).and_then(|(cells, place)| cells.wanted(place));
        surface_params(options, take(&mut self.frame), wanted)
    }

    /// What the map gives beside its contours. Lakes and lines are moved out of the input.
    pub(in crate::terrain) fn given(&mut self, options: &Options) -> Given {
        Given::new(take(&mut self.features), options.sea, self.coast.clone())
    }
}

/// The parameters of a surface in a frame.
pub(in crate::terrain) fn surface_params(options: &Options, frame: Frame, wanted: Option<Wanted>) -> SurfaceParams {
    SurfaceParams {
        kind: options.kind,
        frame,
        resolution: options.resolution,
        stream_tolerance: options.stream_tolerance,
        drain: options.drain,
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
