//! A map that is computed in tiles: what all tiles take from the whole map, and the surface of one tile.

use geo::{BoundingRect, MultiPolygon, Rect};
use glam::DVec2;

use super::beside::Beside;
use super::grid::GridSpec;
use super::input::{Input, surface_params};
use super::options::Options;
use super::part::{Part, box_area};
use tokosen_core::base::error::{Error, FindingKind, Report, Result, Severity};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::base::{Grid, Units};
use tokosen_core::check::first_causes;
use tokosen_core::contour::{ContourMap, Lake};
use tokosen_core::spline::Wanted;
use tokosen_core::subdivision::{SAME_LEVEL, Water, subdivide_with_water};
use tokosen_core::subdomains::{Frame, frame_ring};
use tokosen_core::surface::{Given, Surface, SurfaceParams, Uncertainty, Whole, build, whole_map};

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
    /// The levels of coasts, metres.
    pub coast: Vec<f64>,
    /// How far contours that end beside a cliff end because of it, map units.
    pub cliff_reach: f64,
    /// The units in which messages speak.
    pub units: Units,
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
    /// What lies beside the contours and meets the window.
    pub beside: Beside,
}

impl TileParams {
    /// The tile, as a part of the whole map.
    fn part(&self) -> Result<Part> {
        let around = box_area(self.window)?.bounding_rect().ok_or(Error::NoContours { in_polygon: false })?;
        Ok(Part::with_window(box_area(self.core)?, around, self.planned.ground.area().clone()))
    }

    /// The frame of the surface over its window.
    fn frame(&self, part: &Part) -> Frame {
        part.frame(self.planned.ground.frame())
    }
}

impl Input {
    /// What the tiles of a map take from the whole map, and what lies beside its contours. Lines that were not prepared are
    /// prepared first. The map stays in the input.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what tiles cannot take. As [`Input::prepare`] and [`whole_map`].
    pub(crate) fn plan(&mut self, options: &Options, progress: &dyn Progress) -> Result<(Planned, Beside)> {
        self.check_plannable(options)?;
        if !self.is_prepared {
            options.sea.into_iter().for_each(|sea| self.expect_level(sea));
            self.prepare(&options.preparation, progress)?;
        }
        let cells = options.cells(&self.reprojection)?;
        let frame = self.frame.clone();
        let beside = Beside {
            features: self.features.clone(),
            excluded: std::mem::take(&mut self.excluded),
            at_cliffs: std::mem::take(&mut self.at_cliffs),
        };
        let (params, given) = (self.surface_params(options, cells.as_ref()), self.given(options));
        let figures = step(progress, "the whole map", || whole_map(&self.map, &given, &params));
        let whole = figures.map_err(|error| self.named_error(error))?.ok_or_else(|| {
            Error::Parameter(
                "the map falls into groups of ground far from each other, which tiles cannot take: make each group by itself \
                 with --extent"
                    .into(),
            )
        })?;
        let ring = frame_ring(&self.map, &frame);
        let cells = cells.map(|cells| cells.grid(&ring)).transpose()?;
        let (ground, coast) = (Ground::of(&self.map, &frame), self.coast.clone());
        Ok((Planned { whole, ground, cells, coast, cliff_reach: self.cliff_reach, units: self.units() }, beside))
    }

    /// Refuses what tiles cannot take yet.
    fn check_plannable(&self, options: &Options) -> Result<()> {
        let is_elsewhere = !matches!(options.grid, None | Some(GridSpec::Cell(_)));
        let what = [
            (is_elsewhere, "cells of another grid than square ones in the working CRS: warp the joined height map"),
            (self.part.is_some(), "a part of the map: tiles cover the whole map, so cut the contours first"),
            (self.base.is_some(), "a base height map: fill the joined height map afterwards"),
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
    let TileParams { options, planned, core, beside, .. } = tile;
    let wanted = planned.cells.map(|cells| Wanted::Cell(cells.cell.x));
    let frame = tile.frame(&tile.part()?);
    // A window may lie far from the coast.
    let is_at_sea = |sea: &f64| map.contours.iter().any(|line| (line.elevation - sea).abs() <= SAME_LEVEL);
    let sea = options.sea.filter(is_at_sea);
    let params = SurfaceParams { whole: Some(planned.whole.clone()), ..surface_params(options, frame, wanted) };
    let given = Given::new(beside.features.clone(), sea, planned.coast.clone());
    let Report { value, findings } = build(map, &given, &params, progress)?;
    let mut findings = first_causes(findings);
    beside.explain(&mut findings, planned.cliff_reach);
    findings.iter_mut().for_each(|finding| finding.message = planned.units.message(&finding.message));
    let bounds = Rect::new((core[0], core[1]), (core[2], core[3]));
    findings.retain(|finding| {
        // It is the window that reaches beyond the map, and nobody asked for it.
        finding.kind != FindingKind::FrameBeyondMap
            // Windows overlap. So a note that counts something in a window says nothing about the map.
            && finding.place.map_or(finding.kind.severity() > Severity::Note, |p| holds(&bounds, p))
    });
    Ok(Report { value, findings })
}

/// The height of a lake that has none in the data, from the lines that meet a window around it; `None` if there is no ground of known
/// height at its shore.
///
/// # Errors
/// As [`subdivide_with_water`].
pub(crate) fn lake_height(map: ContourMap, tile: &TileParams, lake: &Lake) -> Result<Option<f64>> {
    let frame = tile.frame(&tile.part()?);
    let water = Water { lakes: vec![lake.clone()], ..Water::default() };
    let found = subdivide_with_water(map, &frame, &water, &())?;
    Ok(found.value.lake_heights().next())
}

/// Whether a tile holds a place. Each place belongs to one tile: not to those on its west and south.
fn holds(tile: &Rect<f64>, p: DVec2) -> bool {
    (tile.min().x..tile.max().x).contains(&p.x) && (tile.min().y..tile.max().y).contains(&p.y)
}
