//! A map that is computed in tiles: what all tiles take from the whole map, and the surface of one tile.

use geo::{BoundingRect, MultiPolygon, Rect};
use glam::DVec2;

use super::grid::GridSpec;
use super::input::Input;
use super::options::Options;
use super::part::{Part, box_area};
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, FindingKind, Report, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::check::first_causes;
use tokosen_core::contour::ContourMap;
use tokosen_core::features::Features;
use tokosen_core::spline::{SplineParams, Wanted};
use tokosen_core::subdomains::{Frame, frame_ring};
use tokosen_core::surface::{Surface, SurfaceParams, Uncertainty, Whole, build, whole_map};

/// The frame of a whole map.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Ground {
    /// The convex hull of the map.
    Hull(MultiPolygon<f64>),
    /// The box around the map.
    Box(MultiPolygon<f64>),
    /// A polygon of the user's.
    Polygon(MultiPolygon<f64>),
    /// The part of such a polygon inside the hull.
    PolygonInHull(MultiPolygon<f64>),
    /// An outline of the contours.
    Outline(MultiPolygon<f64>),
}

impl Ground {
    /// The frame of a clean map.
    fn of(map: &ContourMap, frame: &Frame) -> Self {
        let area = || frame_ring(map, frame).area;
        match frame {
            Frame::Auto | Frame::Hull | Frame::Convex(_) => Self::Hull(area()),
            Frame::Box => Self::Box(area()),
            Frame::Polygon(polygon) => Self::Polygon(polygon.clone()),
            Frame::PolygonInHull(polygon) => Self::PolygonInHull(polygon.clone()),
            Frame::Outline(_) => Self::Outline(area()),
        }
    }

    /// The area inside.
    pub fn area(&self) -> &MultiPolygon<f64> {
        match self {
            Self::Hull(area)
            | Self::Box(area)
            | Self::Polygon(area)
            | Self::PolygonInHull(area)
            | Self::Outline(area) => area,
        }
    }

    /// The frame as the user asked for it.
    fn frame(&self) -> Frame {
        match self {
            Self::Hull(_) => Frame::Hull,
            Self::Box(_) => Frame::Box,
            Self::Polygon(area) => Frame::Polygon(area.clone()),
            Self::PolygonInHull(area) => Frame::PolygonInHull(area.clone()),
            Self::Outline(area) => Frame::Outline(area.clone()),
        }
    }
}

/// What the tiles of a map take from the whole map.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Planned {
    /// Its figures.
    pub whole: Whole,
    /// Its frame.
    pub ground: Ground,
    /// The cells of the height map of the whole map, if one is wanted.
    pub cells: Option<Grid>,
}

/// How the surface of a tile is made.
#[derive(Debug, Clone)]
pub(crate) struct TileParams {
    /// As for the whole map. The grid of cells is in `planned`.
    pub options: Options,
    /// What the tile takes from the whole map.
    pub planned: Planned,
    /// The tile: least x, least y, greatest x, greatest y.
    pub core: [f64; 4],
    /// The window around it, likewise.
    pub window: [f64; 4],
}

impl Input {
    /// What the tiles of a map take from the whole map. Lines that were not prepared are prepared first. The map stays in the input.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what tiles cannot take. As [`Input::prepare`] and [`whole_map`].
    pub(crate) fn plan(&mut self, options: &Options, progress: &dyn Progress) -> Result<Planned> {
        self.check_plannable(options)?;
        if !self.is_prepared {
            self.prepare(&options.preparation, progress)?;
        }
        let cells = options.cells(&self.reprojection)?;
        let frame = self.frame.clone();
        let params = self.surface_params(options, cells.as_ref());
        let figures = step(progress, "the whole map", || whole_map(&self.map, &params));
        let whole = figures.map_err(|error| self.named_error(error))?.ok_or_else(|| {
            Error::Parameter(
                "the map falls into groups of ground far from each other, which tiles cannot take: make each group by itself \
                 with --extent"
                    .into(),
            )
        })?;
        let ring = frame_ring(&self.map, &frame);
        let cells = cells.map(|cells| cells.grid(&ring)).transpose()?;
        Ok(Planned { whole, ground: Ground::of(&self.map, &frame), cells })
    }

    /// Refuses what tiles cannot take yet.
    fn check_plannable(&self, options: &Options) -> Result<()> {
        let Features { coast, excluded, cliffs, lakes, streams, river_areas, break_lines, sinks } = &self.features;
        let is_excluded = !self.excluded.is_empty() || !excluded.is_empty();
        let has_coast = options.sea.is_some() || !self.coast.is_empty() || !coast.is_empty();
        let has_water = !(lakes.is_empty() && streams.is_empty() && river_areas.is_empty() && sinks.is_empty());
        let is_elsewhere = !matches!(options.grid, None | Some(GridSpec::Cell(_)));
        let what = [
            (is_elsewhere, "cells of another grid than square ones in the working CRS: warp the joined height map"),
            (self.part.is_some(), "a part of the map: tiles cover the whole map, so cut the contours first"),
            (self.base.is_some(), "a base height map: fill the joined height map afterwards"),
            (is_excluded, "excluded parts: cut the joined results afterwards"),
            (has_coast, "the sea or a coast: make the map in one run or in parts (--extent)"),
            (has_water, "lakes, streams and sinks: make the map in one run or in parts (--extent)"),
            (
                !cliffs.is_empty() || !break_lines.is_empty(),
                "cliffs and break lines: make the map in one run or in parts (--extent)",
            ),
            (options.uncertainty == Uncertainty::Learnt, "expected errors: estimate them on a part (--extent)"),
            (
                self.reprojection.plane_of_drawing().is_some(),
                "a drawing in another unit than metres: scale it to metres",
            ),
        ];
        match what.iter().find(|(is_there, _)| *is_there) {
            Some((_, what)) => Err(Error::Parameter(format!("tiles cannot take {what}"))),
            None => Ok(()),
        }
    }
}

/// The surface of a tile over its window, and the findings in the tile. `map` holds the lines that meet the window.
///
/// # Errors
/// As [`build`](fn@build).
pub(crate) fn tile_surface(map: ContourMap, tile: &TileParams, progress: &dyn Progress) -> Result<Report<Surface>> {
    let TileParams { options, planned, core, window } = tile;
    let ground = planned.ground.area().clone();
    let around = box_area(*window)?.bounding_rect().ok_or(Error::NoContours { in_polygon: false })?;
    let part = Part::with_window(box_area(*core)?, around, ground);
    let wanted = planned.cells.map(|cells| Wanted::Cell(cells.cell.x));
    let params = SurfaceParams {
        kind: options.kind,
        frame: part.frame(planned.ground.frame()),
        resolution: options.resolution,
        drain: options.drain,
        spline: SplineParams { wanted, tension: options.tension, noise: options.noise },
        whole: Some(planned.whole.clone()),
        triangles: options.triangles,
        memory: options.memory,
        ..SurfaceParams::default()
    };
    let Report { value, findings } = build(map, &params, progress)?;
    let mut findings = first_causes(findings);
    let bounds = Rect::new((core[0], core[1]), (core[2], core[3]));
    findings.retain(|finding| {
        // It is the window that reaches beyond the map, and nobody asked for it.
        finding.kind != FindingKind::FrameBeyondMap && finding.place.is_none_or(|p| holds(&bounds, p))
    });
    Ok(Report { value, findings })
}

/// Whether a tile holds a place. Each place belongs to one tile: not to those on its west and south.
fn holds(tile: &Rect<f64>, p: DVec2) -> bool {
    (tile.min().x..tile.max().x).contains(&p.x) && (tile.min().y..tile.max().y).contains(&p.y)
}
