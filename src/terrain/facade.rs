//! The ground between contours, and what it gives: contours, height maps, errors, meshes.

use geo::MultiPolygon;
use glam::DVec3;

use super::base::Background;
use super::clipped::clip_courses;
use super::grid::{Cells, GridSpec};
use super::input::Input;
use super::options::Options;
use super::part::{Part, drop_outside};
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::base::{ElevationUnit, Units};
use tokosen_core::cartography::{Ground, OfInput};
use tokosen_core::contour::{ContourLayer, Interval, Target, clip_lines};
use tokosen_core::crs::{Crs, FromWorking, Reprojection};
use tokosen_core::layers::{LayerParams, contour_layers};
use tokosen_core::mesh::{Light, Mesh, MeshParams, mesh};
use tokosen_core::subdomains::{FrameRing, MapExtent, frame_ring};
use tokosen_core::surface::{Surface, build, whole_map};

/// The ground between contours, and the findings about them.
///
/// All coordinates, also of results, are on the working plane. [`Terrain::to_output`] gives the conversion back.
#[derive(Debug, Clone)]
pub struct Terrain {
    /// The surface: triangles, sub-domains, ridge and canyon lines, the smooth surface.
    pub surface: Surface,
    /// The findings about the input, one per fault; places are on the working plane.
    pub findings: Vec<Finding>,
    /// The conversion between the working plane and the coordinates of the input.
    pub reprojection: Reprojection,
    /// The unit that the elevations of the contours had.
    pub(super) unit: ElevationUnit,
    /// Whether x and y are taken as metres although heights are in feet and nothing states the unit of x and y.
    pub(super) is_plane_guessed: bool,
    /// The part of the map that results cover, if it is not the whole.
    pub(super) part: Option<MultiPolygon<f64>>,
    /// The height map that gives the heights outside the frame.
    pub(super) background: Option<Background>,
    /// Number of findings outside of the frame polygon or the part; they are not in `findings`.
    pub findings_outside: usize,
    memory: Option<u64>,
}

impl Terrain {
    /// The part of the map that results cover, on the working plane, if it is not the whole.
    pub fn part(&self) -> Option<&MultiPolygon<f64>> {
        self.part.as_ref()
    }

    /// Prepares the lines of an input (see [`Input::prepare`]) and builds the surface between them.
    ///
    /// # Errors
    /// As [`Input::prepare`], [`GridSpec::check`](super::GridSpec::check) and [`build`](fn@build). [`Error::OutOfRange`](crate::Error::OutOfRange) for
    /// the fade of the base. [`Error::NoOverlap`](crate::Error::NoOverlap) for a base elsewhere. [`Error::OutOfMemory`](crate::Error::OutOfMemory) if the height map or
    /// the surface needs more memory than the options allow.
    pub fn build(mut input: Input, options: &Options) -> Result<Self> {
        Self::build_with(&mut input, options, &())
    }

    /// [`Terrain::build`] that shows its progress. The map and the findings are moved out of the input; when it fails,
    /// the findings stay there. Lines that were prepared already are not prepared again.
    ///
    /// # Errors
    /// As [`Terrain::build`].
    pub fn build_with(input: &mut Input, options: &Options, progress: &dyn Progress) -> Result<Self> {
        if !input.is_prepared {
            options.sea.into_iter().for_each(|sea| input.expect_level(sea));
            options.grid.iter().try_for_each(|grid| input.check_room(grid, options.memory))?;
            input.prepare(&options.preparation, progress)?;
        }
        let cells = options.cells(&input.reprojection)?;
        options.check()?;
        if input.map.contours.is_empty() {
            return Err(Error::NoContours { in_polygon: false });
        }
        let is_whole = input.part.is_none() && input.frame.polygon().is_none();
        let (mut params, given) = (input.surface_params(options, cells.as_ref()), input.given(options));
        let part = input.part.take().map(|area| Part::new(area, &input.map)).transpose()?;
        if let Some(part) = &part {
            let figures = step(progress, "the whole map", || whole_map(&input.map, &given, &params));
            params.whole = figures.map_err(|error| input.named_error(error))?;
            params.frame = part.frame(std::mem::take(&mut params.frame));
            input.cut_to(part)?;
        }
        // A height map covers the part alone, not the window around it. A part without ground is told before the work.
        let ground = || frame_ring(&input.map, &params.frame);
        let part_of_ground = part.as_ref().map(|part| part.of(&ground().area)).transpose()?;
        let is_open = cells.as_ref().is_none_or(Cells::are_open);
        let whole_part = part.as_ref().map(|part| part.area().clone());
        let background =
            input.base.take().map(|base| Background::new(base, ground(), whole_part, is_open)).transpose()?;
        if let Some(cells) = &cells {
            let of_surface = || part_of_ground.map_or_else(ground, |area| FrameRing { area });
            let covered = background.as_ref().map_or_else(of_surface, |background| background.ground.clone());
            let room = cells.check_room(&covered, background.is_some(), params.memory);
            room.map_err(|error| error.because_of_far_lines(&input.findings))?;
        }
        let built = build(std::mem::take(&mut input.map), &given, &params, progress);
        let mut surface = input.found(built)?;
        input.check_strict()?;
        if let Some(elsewhere) = input.findings.iter().find(|finding| finding.kind == FindingKind::StreamsElsewhere) {
            return Err(Error::StreamsElsewhere(elsewhere.message.clone()));
        }
        let mut findings = std::mem::take(&mut input.findings);
        let part = part.map(|part| part.of(&surface.frame.area)).transpose()?;
        if let Some(area) = &part {
            // It is the window that reaches beyond the map, and nobody asked for it.
            findings.retain(|finding| finding.kind != FindingKind::FrameBeyondMap);
            surface.frame = FrameRing { area: area.clone() };
        }
        let background = background.map(|background| {
            let spacing = || MapExtent::new(&surface.map, &surface.frame, surface.interval).spacing;
            background.with_fade(options.base_fade.unwrap_or_else(|| options.tuning.join.fade * spacing()))
        });
        let findings_outside = if is_whole { 0 } else { drop_outside(&mut findings, &surface.frame.area) };
        let (reprojection, unit, memory) = (input.reprojection.clone(), input.unit, options.memory);
        let is_plane_guessed = input.is_plane_guessed;
        Ok(Self { surface, findings, reprojection, unit, is_plane_guessed, part, background, findings_outside, memory })
    }

    /// The units in which a picture of it speaks: the unit that the elevations of the contours had, and metres.
    pub fn units(&self) -> Units {
        Units { heights: self.unit, ..Units::METRES }
    }

    /// The contours of the input and new ones between them, a layer for each of the targets:
    /// [`Interval`](tokosen_core::contour::Interval)s or [`Target`]s. Every fifth level is an index contour.
    ///
    /// # Errors
    /// As [`contour_layers`].
    pub fn contours<T: Clone + Into<Target>>(&self, targets: &[T]) -> Result<Vec<ContourLayer>> {
        let targets = targets.iter().cloned().map(Into::into).collect();
        self.contours_with(LayerParams { targets, ..LayerParams::default() }, &())
    }

    /// [`Terrain::contours`] with all its parameters; it shows its progress. The limit of memory is that of the terrain.
    ///
    /// # Errors
    /// As [`contour_layers`].
    pub fn contours_with(&self, params: LayerParams, progress: &dyn Progress) -> Result<Vec<ContourLayer>> {
        let mut layers = contour_layers(&self.surface, &LayerParams { memory: self.memory, ..params }, progress)?;
        if let Some(area) = &self.part {
            layers.iter_mut().for_each(|layer| clip_lines(&mut layer.lines, area));
        }
        Ok(layers)
    }

    /// The ground under its contours, for [`for_map`](tokosen_core::cartography::for_map).
    pub fn map_ground(&self) -> Ground {
        Ground::within([&self.surface.frame.area].into_iter().chain(&self.part), self.surface.map.crs.as_ref())
    }

    /// What becomes of its contours on a map with an interval, in `unit`: those of a coarser interval are chosen from them as new
    /// ones are, unless all of them are to be kept.
    pub fn of_input(&self, interval: Interval, unit: ElevationUnit, keep_input: bool) -> OfInput {
        match !keep_input && Target::from(interval).is_coarser(unit, self.surface.interval.step) {
            true => OfInput::AsNew,
            false => OfInput::Whole,
        }
    }

    /// The contours of the input alone, as a layer.
    ///
    /// # Errors
    /// As [`contour_layers`].
    pub fn input_contours(&self) -> Result<ContourLayer> {
        let layers = self.contours(&[Target::Levels(Vec::new())])?;
        Ok(layers.into_iter().next().unwrap_or_default())
    }

    /// The surface as triangles in space, open or closed to a solid, in metres. [`Mesh::in_drawing`] gives the model of a
    /// drawing in feet in feet.
    ///
    /// # Errors
    /// As [`mesh`](fn@mesh). [`Error::TooManyCells`] for cells that are too small. [`Error::PlaneUnitUnknown`] if heights are in feet and nothing states the unit of x and y.
    pub fn mesh(&self, params: &MeshParams) -> Result<Mesh> {
        self.check_plane_unit()?;
        params.light.iter().try_for_each(|light| self.check_light(light))?;
        let mut made = mesh(&self.surface, self.part.as_ref(), params)?;
        let mut break_lines: Vec<Vec<DVec3>> =
            self.surface.break_lines.iter().map(|line| line.points.clone()).collect();
        if let Some(area) = &self.part {
            clip_courses(&mut break_lines, area);
        }
        let origin = made.origin;
        let relative = |line: Vec<DVec3>| line.into_iter().map(|p| p - origin).collect();
        made.break_lines = break_lines.into_iter().map(relative).collect();
        Ok(made)
    }

    /// Refuses cells that are too many for the memory.
    pub(super) fn check_light(&self, light: &Light) -> Result<()> {
        let Some(cell) = light.cell else { return Ok(()) };
        let cells = GridSpec::Cell(cell).over(&Reprojection::default())?;
        cells.check_room(&self.surface.frame, false, self.memory)
    }

    /// [`Input::check_plane_unit`], for the terrain of an input.
    ///
    /// # Errors
    /// [`Error::PlaneUnitUnknown`].
    pub fn check_plane_unit(&self) -> Result<()> {
        if self.is_plane_guessed { Err(Error::PlaneUnitUnknown) } else { Ok(()) }
    }

    /// The conversion from the working plane to the coordinates of the input, or to those of another system. Heights
    /// stay in metres, unless [`FromWorking::with_heights_in`] says otherwise.
    ///
    /// # Errors
    /// As [`Reprojection::from_working`].
    pub fn to_output(&self, crs: Option<&Crs>) -> Result<FromWorking> {
        self.reprojection.from_working(crs)
    }
}
