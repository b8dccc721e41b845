//! The ground between contours, and what it gives: contours, height maps, errors, meshes.

use geo::MultiPolygon;

use super::grid::GridSpec;
use super::input::Input;
use super::options::Options;
use super::part::{clip_lines, drop_outside, mask};
use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::base::progress::Progress;
use crate::base::{ElevationUnit, Grid};
use crate::contour::ContourLayer;
use crate::crs::{Crs, FromWorking, Reprojection};
use crate::dem::Dem;
use crate::drain::Pit;
use crate::mesh::{Mesh, MeshParams, mesh};
use crate::slice::{LayerParams, Target, contour_layers};
use crate::subdomains::{Frame, FrameRing, frame_ring};
use crate::surface::{Surface, build};

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
    /// The part of the map that results cover, if it is not the whole.
    pub(super) part: Option<MultiPolygon<f64>>,
    /// Number of findings outside of the frame polygon or the part; they are not in `findings`.
    pub findings_outside: usize,
    memory: Option<u64>,
}

impl Terrain {
    /// Prepares the lines of an input (see [`Input::prepare`]) and builds the surface between them.
    ///
    /// # Errors
    /// As [`Input::prepare`], [`GridSpec::check`] and [`build`](fn@build). [`Error::OutOfMemory`] if the height map or
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
            input.prepare(&options.preparation, progress)?;
        }
        let cells = options.cells(&input.reprojection)?;
        let part = input.part.take();
        if let Some(part) = &part {
            input.frame = part.frame(std::mem::take(&mut input.frame));
        }
        let is_whole = part.is_none() && !matches!(input.frame, Frame::Polygon(_));
        let params = options.surface(input, cells.as_ref());
        // A height map covers the part alone, not the window around it. A part without ground is told before the work.
        let ground = || frame_ring(&input.map, &params.frame);
        let part_of_ground = part.as_ref().map(|part| part.of(&ground().area)).transpose()?;
        if let Some(cells) = &cells {
            let ground = part_of_ground.map_or_else(ground, |area| FrameRing { area });
            cells.check_room(&ground, params.memory)?;
        }
        let built = build(std::mem::take(&mut input.map), &params, progress);
        let mut surface = input.found(built)?;
        input.check_strict()?;
        let mut findings = std::mem::take(&mut input.findings);
        let part = part.map(|part| part.of(&surface.frame.area)).transpose()?;
        if let Some(area) = &part {
            // It is the window that reaches beyond the map, and nobody asked for it.
            findings.retain(|finding| finding.kind != FindingKind::FrameBeyondMap);
            surface.frame = FrameRing { area: area.clone() };
        }
        let findings_outside = if is_whole { 0 } else { drop_outside(&mut findings, &surface.frame.area) };
        let (reprojection, unit) = (input.reprojection.clone(), input.unit);
        Ok(Self { surface, findings, reprojection, unit, part, findings_outside, memory: options.memory })
    }

    /// The contours of the input and new ones between them, a layer for each of the targets:
    /// [`Interval`](crate::contour::Interval)s or [`Target`]s. Every fifth level is an index contour.
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

    /// The contours of the input alone, as a layer.
    ///
    /// # Errors
    /// As [`contour_layers`].
    pub fn input_contours(&self) -> Result<ContourLayer> {
        let layers = self.contours(&[Target::Levels(Vec::new())])?;
        Ok(layers.into_iter().next().unwrap_or_default())
    }

    /// The height map at the centres of cells.
    ///
    /// # Errors
    /// As [`GridSpec::check`]. [`Error::TooManyCells`] for cells that are too small,
    /// [`Error::CellTooLarge`] if no centre of a cell lies on the map. [`Error::NoOverlap`] if cells that
    /// were given all lie outside the frame. [`Error::UnknownCrs`] for cells in degrees over contours of an unknown
    /// system.
    pub fn dem(&self, grid: &GridSpec) -> Result<Dem> {
        self.dem_with(grid, &())
    }

    /// [`Terrain::dem`] that shows its progress.
    ///
    /// # Errors
    /// As [`Terrain::dem`].
    pub fn dem_with(&self, grid: &GridSpec, progress: &dyn Progress) -> Result<Dem> {
        let cells = grid.over(&self.reprojection)?;
        let mut dem = cells.heights(&self.surface, progress)?;
        if let Some(area) = &self.part {
            mask(&mut dem, area, &|p| cells.on_plane(p));
        }
        match grid {
            GridSpec::Cells { file, .. } if dem.values.iter().all(|height| height.is_nan()) => match file {
                Some(file) => Err(Error::NoOverlap.in_file(file)),
                None => Err(Error::NoOverlap),
            },
            _ => Ok(dem),
        }
    }

    /// Standard errors of the heights of [`Terrain::dem`], metres, as a raster. `None` if the options did not ask for
    /// them.
    ///
    /// # Errors
    /// As [`Terrain::dem`].
    pub fn errors(&self, grid: &GridSpec) -> Result<Option<Dem>> {
        if self.surface.errors.is_none() {
            return Ok(None);
        }
        let dem = self.dem(grid)?;
        Ok(self.errors_of(&dem, grid)?.map(|values| Dem { values, ..dem }))
    }

    /// The standard errors of a height map that [`Terrain::dem`] gave, cell by cell, metres.
    ///
    /// # Errors
    /// As [`Terrain::dem`].
    pub fn errors_of(&self, dem: &Dem, grid: &GridSpec) -> Result<Option<Vec<f32>>> {
        Ok(grid.over(&self.reprojection)?.standard_errors(&self.surface, dem))
    }

    /// The pits of a height map that [`Terrain::dem`] gave, with the reasons why they stay.
    ///
    /// # Errors
    /// As [`Terrain::dem`].
    pub fn pits_of(&self, dem: &Dem, grid: &GridSpec) -> Result<Vec<Pit>> {
        Ok(grid.over(&self.reprojection)?.pits(&self.surface, dem))
    }

    /// The cells that a specification gives over this terrain, and the coordinate reference system that they are in.
    ///
    /// # Errors
    /// As [`Terrain::dem`].
    pub fn cells(&self, grid: &GridSpec) -> Result<(Grid, Option<Crs>)> {
        let cells = grid.over(&self.reprojection)?;
        let crs = cells.crs(self.surface.map.crs.as_ref()).cloned();
        Ok((cells.grid(&self.surface.frame)?, crs))
    }

    /// The surface as triangles in space, open or closed to a solid.
    ///
    /// # Errors
    /// As [`mesh`](fn@mesh).
    pub fn mesh(&self, params: &MeshParams) -> Result<Mesh> {
        mesh(&self.surface, params)
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
