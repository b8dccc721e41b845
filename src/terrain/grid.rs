//! Where the cells of a height map are: [`GridSpec`], and the grid that it gives over a surface.

use std::path::PathBuf;

use glam::DVec2;

use super::outline::Outline;
use super::samples::{MOST_CELLS, Samples};
use tokosen_core::base::Grid;
use tokosen_core::base::error::{CrsNeed, Error, Result};
use tokosen_core::base::memory;
use tokosen_core::base::progress::Progress;
use tokosen_core::crs::{Crs, Reprojection, Transform};
use tokosen_core::drain::Pit;
use tokosen_core::raster::Dem;
use tokosen_core::spline::Wanted;
use tokosen_core::subdomains::FrameRing;
use tokosen_core::surface::{InOther, Surface, height_map, pits_of, standard_errors, standard_errors_on};

/// The cells that a height map is wanted at.
#[derive(Debug, Clone, PartialEq)]
pub enum GridSpec {
    /// Square cells of this size, units of the working coordinate reference system, on multiples of it over the frame. Over
    /// the plane of a drawing in another unit than metres: units of the drawing, in its coordinates.
    Cell(f64),
    /// Square cells of this size in degrees, in the geographic system of the contours, on multiples of it over the
    /// frame.
    Degrees(f64),
    /// Square cells of this size in another coordinate reference system, on multiples of it over the frame.
    CellIn {
        /// The size, units of that system: degrees if it is geographic.
        size: f64,
        /// The system.
        crs: Crs,
    },
    /// Square cells of the working coordinate reference system whose centres are the samples of a height map for a game engine or
    /// the like. The samples at the edges lie on the box around the frame, or beyond it.
    Samples {
        /// How many samples a side may have, in ascending order; any number if empty. The fewest that cover the frame are taken. If
        /// there are still too few, the cells are those of several such squares side by side, with common samples at the borders.
        sides: Vec<usize>,
        /// The largest distance of samples, units of that system; where `sides` are given, samples are so much nearer to each other
        /// that they fill the longer side of the frame. If `None`, `sides` has one number.
        cell: Option<f64>,
    },
    /// These cells.
    Cells {
        /// Size, place and number of the cells.
        grid: Grid,
        /// Their coordinate reference system; that of the contours if `None`.
        crs: Option<Crs>,
        /// The raster that they are from, for messages.
        file: Option<PathBuf>,
    },
}

/// Bytes per cell while the height map is computed and written: the height, the triangle, the share of the file.
const BYTES_PER_CELL: f64 = 12.0;
/// The same with a base: its heights, and the corrections on all grids.
const BYTES_PER_JOINED_CELL: f64 = 40.0;

impl GridSpec {
    /// Checks the size of the cells.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if it is not a positive number.
    pub fn check(&self) -> Result<()> {
        let (name, size) = match self {
            Self::Cell(size) => ("cell size", *size),
            Self::Degrees(size) => ("cell size in degrees", *size),
            Self::CellIn { size, crs } if crs.is_geographic() => ("cell size in degrees", *size),
            Self::CellIn { size, .. } => ("cell size", *size),
            Self::Samples { sides, cell } => match (sides.as_slice(), *cell) {
                ([one], None) if *one >= 2 => return Ok(()),
                (_, Some(size)) => ("distance of samples", size),
                _ => return Err(Error::Parameter("samples need their distance, or their number on a side".into())),
            },
            Self::Cells { .. } => return Ok(()),
        };
        if size.is_finite() && size > 0.0 { Ok(()) } else { Err(Error::out_of_range(name, size, "more than 0")) }
    }

    /// The cells over contours with this reprojection.
    ///
    /// # Errors
    /// As [`GridSpec::check`]. [`Error::UnknownCrs`] for cells in degrees or in another system over contours of an unknown
    /// system. [`Error::Data`] for a system in grads. As [`Transform::between`] from the cells' system to the working
    /// one.
    pub(crate) fn over(&self, reprojection: &Reprojection) -> Result<Cells> {
        self.check()?;
        match self {
            Self::Cell(size) => {
                let of_drawing = reprojection.plane_of_drawing().zip(reprojection.working_crs());
                let apart = of_drawing.map(|(crs, working)| Apart::of(crs, working)).transpose()?.flatten();
                Ok(Cells { size: Size::Square(*size), apart })
            }
            Self::Samples { sides, cell } => {
                Ok(Cells { size: Size::Samples(Samples { sides: sides.clone(), cell: *cell }), apart: None })
            }
            Self::Degrees(size) => {
                let known = reprojection.input_crs().and_then(Crs::geographic).zip(reprojection.working_crs());
                let (crs, working) = known.ok_or(Error::UnknownCrs { needed_for: CrsNeed::CellsInDegrees })?;
                Ok(Cells { size: Size::Square(*size), apart: Apart::of(&crs, working)? })
            }
            Self::CellIn { size, crs } => {
                let working = reprojection.input_crs().and(reprojection.working_crs());
                let working = working.filter(|working| crs.is_local() || !working.is_unnamed_plane());
                let working = working.ok_or(Error::UnknownCrs { needed_for: CrsNeed::OtherOutput })?;
                Ok(Cells { size: Size::Square(*size), apart: Apart::of(crs, working)? })
            }
            Self::Cells { grid, crs, file } => {
                let size = Size::Given(*grid);
                // A raster without a system is assumed to be in that of the contours.
                let known = reprojection.of_side(crs.as_ref()).zip(reprojection.working_crs());
                let Some((crs, working)) = known else { return Ok(Cells { size, apart: None }) };
                let apart = Apart::between(crs, working).map_err(|error| match file {
                    Some(file) => error.in_file(file),
                    None => error,
                })?;
                Ok(Cells { size, apart })
            }
        }
    }
}

/// The cells of a height map over contours, before the extent of the surface is known.
pub(crate) struct Cells {
    size: Size,
    /// The system of the cells, if it is not the working one.
    apart: Option<Apart>,
}

/// How the cells are laid.
enum Size {
    /// Square, on multiples of their size.
    Square(f64),
    /// Square, around samples.
    Samples(Samples),
    /// These.
    Given(Grid),
}

impl Size {
    /// The side of a square as large as a cell at `place`, on the working plane. `way` leads there.
    fn on_plane(&self, way: &Transform, place: DVec2) -> Option<f64> {
        let cell = match self {
            Self::Square(size) => DVec2::splat(*size),
            Self::Samples(samples) => DVec2::splat(samples.cell?),
            Self::Given(grid) => grid.cell,
        };
        let centre = way.inverse(place)?;
        let across = |half: DVec2| Some(way.forward(centre + half)? - way.forward(centre - half)?);
        let (east, north) = (across(DVec2::new(cell.x / 2.0, 0.0))?, across(DVec2::new(0.0, cell.y / 2.0))?);
        Some(east.perp_dot(north).abs().sqrt()).filter(|side| side.is_finite() && *side > 0.0)
    }
}

/// A system that is not the working one, and the conversion from it to the working one.
struct Apart {
    crs: Crs,
    way: Transform,
}

impl Apart {
    /// `None` if both are the same system.
    fn between(crs: &Crs, working: &Crs) -> Result<Option<Self>> {
        let way = Transform::between(crs, working)?;
        Ok((!way.is_identity()).then(|| Self { crs: crs.clone(), way }))
    }

    /// The same for square cells, which are measured in degrees in every geographic system.
    fn of(crs: &Crs, working: &Crs) -> Result<Option<Self>> {
        if crs.is_in_other_angles() {
            let name = crs.name().unwrap_or_default();
            return Err(Error::Data(format!(
                "{name} has another unit than degrees, so cells cannot be measured in degrees"
            )));
        }
        Self::between(crs, working)
    }

    /// The box around a frame in this system.
    fn extent(&self, frame: &FrameRing) -> Result<(DVec2, DVec2)> {
        let outline = Outline::of(frame, &self.way);
        let name = || self.crs.name().unwrap_or_default();
        if outline.is_empty() {
            return Err(Error::Data(format!("no part of the frame has a place in {}", name())));
        }
        match outline.cut(self.crs.is_geographic()) {
            Some(cut) => Err(Error::AcrossCut { crs: name(), cut }),
            None => Ok(outline.extent()),
        }
    }
}

impl Cells {
    /// The grid over a frame.
    pub fn grid(&self, frame: &FrameRing) -> Result<Grid> {
        let cell = match &self.size {
            Size::Given(grid) => return Ok(*grid),
            Size::Samples(samples) => return samples.grid(frame),
            Size::Square(cell) => *cell,
        };
        let (lo, hi) = match &self.apart {
            None => frame.extent(),
            Some(apart) => apart.extent(frame)?,
        };
        if lo.cmpgt(hi).any() {
            return Err(Error::NoContours { in_polygon: true });
        }
        let in_degrees = self.apart.as_ref().is_some_and(|apart| apart.crs.is_geographic());
        let count = ((hi - lo) / cell).ceil();
        if !count.is_finite() || count.x * count.y > MOST_CELLS {
            return Err(Error::TooManyCells { cell, cols: count.x, rows: count.y, in_degrees, because: String::new() });
        }
        let grid = Grid::on_multiples(lo, hi, cell);
        let (first, last) = (grid.place(DVec2::new(lo.x, hi.y)).ceil(), grid.place(DVec2::new(hi.x, lo.y)).floor());
        if first.cmpgt(last).any() {
            if lo.cmpeq(hi).any() {
                return Err(Error::NoArea);
            }
            let [width, height] = (hi - lo).to_array();
            return Err(Error::CellTooLarge { cell, width, height, in_degrees });
        }
        Ok(grid)
    }

    /// Refuses a height map of some ground that does not fit into memory, before the surface is built. `is_joined`: whether
    /// it is joined with a base.
    pub fn check_room(&self, ground: &FrameRing, is_joined: bool, memory: Option<u64>) -> Result<()> {
        let Grid { cols, rows, .. } = self.grid(ground)?;
        let what = format!("a height map of {cols} x {rows} cells");
        let (bytes, remedy) = match is_joined {
            true => (BYTES_PER_JOINED_CELL, "choose a larger cell or a smaller part of the map"),
            false => (BYTES_PER_CELL, "choose a larger cell or a smaller frame"),
        };
        memory::check(bytes * cols as f64 * rows as f64, memory, what, remedy)
    }

    /// The system that the cells are in, where `working` is that of the surface.
    pub fn crs<'a>(&'a self, working: Option<&'a Crs>) -> Option<&'a Crs> {
        self.apart.as_ref().map_or(working, |apart| Some(&apart.crs))
    }

    /// What the smooth surface needs to know about the cells. In another system, their centres are no nodes. Then its nodes
    /// are as close as the cells are at `place`, on the working plane.
    pub fn wanted(&self, place: DVec2) -> Option<Wanted> {
        match (&self.apart, &self.size) {
            (Some(Apart { way, .. }), size) => {
                let Some(metres) = way.factor() else {
                    return size.on_plane(way, place).map(Wanted::Cell);
                };
                Some(match size {
                    Size::Square(cell) => Wanted::Cell(cell * metres),
                    Size::Samples(samples) => Wanted::Cell(samples.cell? * metres),
                    Size::Given(Grid { corner, cell, cols, rows }) => {
                        Wanted::Grid(Grid { corner: *corner * metres, cell: *cell * metres, cols: *cols, rows: *rows })
                    }
                })
            }
            (None, Size::Square(cell)) => Some(Wanted::Cell(*cell)),
            (None, Size::Samples(samples)) => samples.cell.map(Wanted::Cell),
            (None, Size::Given(grid)) => Some(Wanted::Grid(*grid)),
        }
    }

    /// Whether the cells have no extent of their own.
    pub fn are_open(&self) -> bool {
        !matches!(self.size, Size::Given(_))
    }

    /// The heights of a surface at the centres of the cells over some ground.
    pub fn heights(&self, surface: &Surface, ground: &FrameRing, progress: &dyn Progress) -> Result<Dem> {
        let grid = self.grid(ground)?;
        let crs = self.crs(surface.map.crs.as_ref());
        Ok(self.in_other(|other| height_map(surface, &grid, crs, other, progress)))
    }

    /// The pits of a height map of these cells, on the working plane.
    pub fn pits(&self, surface: &Surface, dem: &Dem) -> Vec<Pit> {
        self.in_other(|other| pits_of(surface, dem, other))
    }

    /// Calls `work` with the conversion between the cells' system and the working one, if they differ.
    fn in_other<T>(&self, work: impl FnOnce(Option<InOther<'_>>) -> T) -> T {
        let Some(Apart { way, .. }) = &self.apart else { return work(None) };
        work(Some(InOther { to_surface: &|p| way.forward(p), from_surface: &|p| way.inverse(p) }))
    }

    /// The place of a centre of a cell on the working plane, if it has one.
    pub fn on_plane(&self, centre: DVec2) -> Option<DVec2> {
        self.apart.as_ref().map_or(Some(centre), |apart| apart.way.forward(centre))
    }

    /// The standard errors of such heights; `None` if the surface has none.
    pub fn standard_errors(&self, surface: &Surface, dem: &Dem) -> Option<Vec<f32>> {
        match &self.apart {
            Some(Apart { way, .. }) => standard_errors_on(surface, dem, &|p| way.forward(p)),
            None => standard_errors(surface, dem),
        }
    }
}
