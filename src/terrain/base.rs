//! A height map under the contours: it gives the heights that the surface does not cover.

use std::path::{Path, PathBuf};

use geo::{BoundingRect, Coord, Intersects, MultiPolygon, Rect};
use glam::DVec2;

use super::grid::Cells;
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::contour::Interval;
use tokosen_core::crs::{Reprojection, Transform, converted};
use tokosen_core::dem::compare::heights_between;
use tokosen_core::dem::join::{Join, join};
use tokosen_core::raster::{Dem, looks_like_degrees};
use tokosen_core::subdomains::FrameRing;

/// A base that is further from the surface along the border than this is doubtful, in contour intervals. Contours of
/// usual accuracy are nearly all within it.
const DOUBTFUL: f64 = 0.5;

/// A height map that gives the heights outside the frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Base {
    dem: Dem,
    /// The file that it is from, for messages.
    file: PathBuf,
    /// The box around the centres of its cells, on the working plane. `None` if a part of it has no place there.
    outline: Option<MultiPolygon<f64>>,
}

/// A base under a surface.
#[derive(Debug, Clone)]
pub(super) struct Background {
    base: Base,
    /// The ground that height maps cover.
    pub ground: FrameRing,
    /// The part of the map that is asked for, if it is not the whole.
    pub part: Option<MultiPolygon<f64>>,
    /// Distance at which a twentieth of the difference at the border is left, units of the working plane.
    fade: f64,
}

/// What a base gave to a height map.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseJoin {
    /// The file of the base.
    pub file: PathBuf,
    /// How it fits the surface. The place is on the working plane.
    pub join: Join,
    /// Distance at which a twentieth of the difference at the border is left, units of the working plane.
    pub fade: f64,
}

impl Base {
    pub fn new(dem: Dem, file: &Path, reprojection: &Reprojection) -> Result<Self> {
        let crs = reprojection.of_side(dem.crs.as_ref()).cloned();
        if looks_like_degrees(&dem.grid, crs.as_ref()) || is_degrees_by_itself(&dem, reprojection) {
            let message = "the coordinates look like degrees, but the file names no coordinate reference system; name it first, for \
                           example with 'gdal_translate -a_srs EPSG:6668'";
            return Err(Error::file(file, message));
        }
        let to_working = reprojection.bring(crs.as_ref()).map_err(|error| error.in_file(file))?;
        let grid = dem.grid;
        let [first, last] = [grid.center(0, 0), grid.center(grid.cols.max(1) - 1, grid.rows.max(1) - 1)];
        let centres = Rect::new(Coord { x: first.x, y: first.y }, Coord { x: last.x, y: last.y });
        let outline = to_working.boundary(&centres.to_polygon().into()).ok();
        Ok(Self { dem: Dem { crs, ..dem }, file: file.to_owned(), outline })
    }

    /// The ground that height maps cover: the part that is asked for, otherwise the frame and the base. `is_open`:
    /// whether the cells have their extent from it.
    ///
    /// # Errors
    /// [`Error::NoOverlap`] if the base does not touch the box around the frame. [`Error::Data`] if a part of it has no
    /// place on the working plane and the extent is needed.
    fn ground(&self, frame: FrameRing, part: Option<&MultiPolygon<f64>>, is_open: bool) -> Result<FrameRing> {
        let boxes = |outline: &MultiPolygon<f64>| Some((outline.bounding_rect()?, frame.area.bounding_rect()?));
        match (&self.outline, part) {
            (Some(outline), _) if boxes(outline).is_some_and(|(base, frame)| !base.intersects(&frame)) => {
                Err(Error::NoOverlap.in_file(&self.file))
            }
            (_, Some(part)) => Ok(FrameRing { area: part.clone() }),
            (Some(outline), None) => Ok(FrameRing { area: frame.area.iter().chain(outline.iter()).cloned().collect() }),
            (None, None) if is_open => {
                let message = "reaches beyond the places that the working coordinate reference system has; ask for a part \
                               of the map, or for given cells";
                Err(Error::file(&self.file, message))
            }
            (None, None) => Ok(frame),
        }
    }
}

/// Whether a height map that names no system can only be in degrees while the contours are in none.
fn is_degrees_by_itself(dem: &Dem, reprojection: &Reprojection) -> bool {
    looks_like_degrees(&dem.grid, dem.crs.as_ref()) && !reprojection.input_crs().is_some_and(|crs| crs.is_geographic())
}

impl Background {
    /// A base under the ground inside a frame. `is_open` as for [`Base::ground`]. The fade is set with the surface.
    ///
    /// # Errors
    /// As [`Base::ground`].
    pub fn new(base: Base, frame: FrameRing, part: Option<MultiPolygon<f64>>, is_open: bool) -> Result<Self> {
        let ground = base.ground(frame, part.as_ref(), is_open)?;
        Ok(Self { base, ground, part, fade: 0.0 })
    }

    /// The same with this fade.
    pub fn with_fade(self, fade: f64) -> Self {
        Self { fade, ..self }
    }

    /// Fills the cells of a height map that the surface left without a height.
    ///
    /// # Errors
    /// If the system of the cells cannot be converted to that of the base.
    pub fn fill(
        &self,
        dem: &mut Dem,
        cells: &Cells,
        interval: &Interval,
        progress: &dyn Progress,
    ) -> Result<Report<BaseJoin>> {
        let to_base = Transform::between_known(dem.crs.as_ref(), self.base.dem.crs.as_ref());
        let to_base = to_base.map_err(|error| error.in_file(&self.base.file))?;
        let cell = dem.metres_per_unit().unwrap_or(DVec2::ONE) * dem.grid.cell;
        let empty = dem.values.iter().filter(|height| height.is_nan()).count();
        let mut join = step(progress, "joining the base", || {
            let heights = heights_between(&self.base.dem, &dem.grid, &|p| converted(to_base.as_ref(), p));
            join(dem, &heights, self.fade / cell)
        });
        join.place = join.place.and_then(|centre| cells.on_plane(centre));
        let found = BaseJoin { file: self.base.file.clone(), join, fade: self.fade };
        let findings = if empty > 0 { found.finding(interval).into_iter().collect() } else { Vec::new() };
        Ok(Report { value: found, findings })
    }
}

impl BaseJoin {
    /// What is wrong with the base, if it is.
    fn finding(&self, interval: &Interval) -> Option<Finding> {
        let Join { filled, border, median, place, looks_like_feet, .. } = self.join;
        let file = self.file.display();
        if filled == 0 {
            let message = format!("{file} has no height at the cells outside the surface; they stay without data");
            return Some(Finding::general(FindingKind::BaseUnused, message));
        }
        if border == 0 {
            let message = format!(
                "{file} has no heights along the border of the surface; its other heights are used as they are"
            );
            return Some(Finding::general(FindingKind::BaseApart, message));
        }
        if median.abs() <= DOUBTFUL * interval.step {
            return None;
        }
        let side = if median > 0.0 { "below" } else { "above" };
        let cause = match looks_like_feet {
            true => "its heights seem to be in feet, which the file does not state",
            false => "it may have another vertical datum or unit, or be the height of roofs and trees",
        };
        let message = format!(
            "{file} lies {:.1} m {side} the surface along their border (median of {border} cells), more than half a \
             contour interval; {cause}; the largest difference is",
            median.abs()
        );
        Some(Finding::new(FindingKind::BaseDiffers, place, message))
    }
}
