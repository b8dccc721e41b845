//! A height map as the ground of 3-D models: [`DemModel`].

use geo::MultiPolygon;
use glam::DVec2;

use super::dem_area::area_on;
use super::plane_cells::{Window, cells_on_plane, plane_of};
use tokosen_core::bands::bands_of_height_map;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Error, Report, Result};
use tokosen_core::base::memory;
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::contour::Target;
use tokosen_core::crs::{Reprojection, Transform};
use tokosen_core::dem::contour::{ContourParams, contours};
use tokosen_core::dem::derive::{check, square_outlines};
use tokosen_core::geometry::Bounds;
use tokosen_core::mesh::{Mesh, height_mesh};
use tokosen_core::plates::{PlateParams, Plates, plates};
use tokosen_core::raster::Dem;

/// Bytes of memory per cell that all triangles between cells take, with their vertices and normals.
const BYTES_PER_CELL: f64 = 320.0;

/// A height map as the ground of 3-D models, on a plane in metres.
///
/// Cells on such a plane stay as they are. Heights of others, such as cells in degrees, are interpolated (bilinear) in about as many
/// square cells on the plane that contours in the same coordinates are worked on. The ground reaches to the centres of the outermost
/// cells. Cells without heights are no ground.
#[derive(Debug, Clone)]
pub struct DemModel {
    heights: Dem,
    part: Option<MultiPolygon<f64>>,
    pub(super) memory: Option<u64>,
    is_interpolated: bool,
    /// The conversion between the plane and the coordinates of the height map, if these are a drawing in another unit than metres.
    pub reprojection: Reprojection,
}

impl DemModel {
    /// The ground of a height map, or of a part of it, which is in the coordinates of the height map. `memory` is the memory that the
    /// work may take, bytes; no limit if `None`.
    ///
    /// # Errors
    /// [`Error::Data`] if no cell has a height, if the coordinates look like degrees and no coordinate reference system is named, or
    /// if there is no plane for them.
    pub fn new(dem: Dem, part: Option<MultiPolygon<f64>>, memory: Option<u64>) -> Result<Self> {
        check(&dem)?;
        let window = Window::of([&dem]).ok_or_else(|| Error::Data("has no cell with a height".into()))?;
        let plane = plane_of(dem.crs.as_ref(), window.border(&dem.grid))?;
        let way = Transform::between_known(dem.crs.as_ref(), plane.as_ref())?;
        let mut reprojection = Reprojection::unmoved(plane.clone());
        let (mut heights, mut is_interpolated) = (Dem { crs: plane.clone(), ..dem.clone() }, false);
        if let (Some(crs), Some(to_plane), Some(way)) = (&dem.crs, &plane, &way) {
            if let Some(unit) = crs.length_unit().filter(|_| crs.local_in_metres().is_some()) {
                heights.grid.corner *= unit.metres;
                heights.grid.cell *= unit.metres;
                reprojection = Reprojection::project(&mut [], &mut [], crs, to_plane)?.value;
            } else {
                [heights] = cells_on_plane([&dem], &window, (Some(to_plane), Some(way)), f64::INFINITY)?;
                is_interpolated = true;
            }
        }
        let on_plane = |area: MultiPolygon<f64>| match &way {
            Some(_) => area_on(&heights, &area, dem.crs.as_ref()),
            None => Ok(area),
        };
        let part = part.map(on_plane).transpose()?;
        if let Some(area) = &part {
            heights = heights.beyond(area);
        }
        Ok(Self { heights, part, memory, is_interpolated, reprojection })
    }

    /// The heights on the plane, around the part.
    pub fn heights(&self) -> &Dem {
        &self.heights
    }

    /// Whether the heights are interpolated in other cells than those of the height map.
    pub fn is_interpolated(&self) -> bool {
        self.is_interpolated
    }

    /// The part of the map that results cover, on the plane, if it is not the whole.
    pub fn part(&self) -> Option<&MultiPolygon<f64>> {
        self.part.as_ref()
    }

    /// The triangles between the centres of cells, as an open shell in metres: few of them if there is a `tolerance`, the largest
    /// distance from the height of a cell in metres; otherwise two between each four cells. [`Mesh::closed`] makes a solid of it,
    /// [`Mesh::in_drawing`] gives the model of a drawing in feet in feet.
    ///
    /// # Errors
    /// As [`height_mesh`]. [`Error::OutOfMemory`] if all triangles need more memory than there is.
    pub fn mesh(&self, tolerance: Option<f64>) -> Result<Mesh> {
        if tolerance.is_none() {
            let bytes = self.heights.grid.len() as f64 * BYTES_PER_CELL;
            let what = format!("a model of all {} cells", self.heights.grid.len());
            memory::check(
                bytes,
                self.memory,
                what,
                "ask for few triangles, with a tolerance, or for a part of the map",
            )?;
        }
        height_mesh(&self.heights, self.part(), tolerance)
    }

    /// Millimetres of a model in layers for each metre.
    ///
    /// # Errors
    /// [`Error::Data`] if no four neighbouring cells have heights, or none in the part.
    pub fn plate_scale(&self, params: &PlateParams) -> Result<f64> {
        let corners: Vec<DVec2> = square_outlines(&self.heights).into_iter().flatten().flatten().collect();
        let mut ground = Bounds::around(&corners);
        if let Some(part) = &self.part {
            let corners = part.iter().flat_map(|area| area.exterior().coords()).map(|c| DVec2::new(c.x, c.y));
            let part = Bounds::around(&corners.collect::<Vec<_>>());
            ground = Bounds { min: ground.min.max(part.min), max: ground.max.min(part.max) };
        }
        let size = ground.max - ground.min;
        if !size.cmpgt(DVec2::ZERO).all() {
            let place = if self.part.is_some() { " in this part of the map" } else { "" };
            return Err(Error::Data(format!("no four neighbouring cells have heights{place} to make plates of")));
        }
        Ok(params.size / size.max_element())
    }

    /// The plates of a model in layers: the ground at or above each level, between contours of the height map.
    ///
    /// # Errors
    /// As [`DemModel::plate_scale`], [`plates`], [`PlateParams::steps`] and [`contours`].
    pub fn plates(&self, params: &PlateParams, progress: &dyn Progress) -> Result<Report<Plates>> {
        let scale = self.plate_scale(params)?;
        let (interval, _) = params.steps(scale)?;
        let (target, unit, memory) = (Target::from(interval), ElevationUnit::Metre, self.memory);
        let traced = ContourParams {
            targets: vec![target.clone()],
            part: self.part.clone(),
            memory,
            ..ContourParams::default()
        };
        let found = contours(&self.heights, &traced, progress)?;
        let mut findings = Vec::new();
        let made = step(progress, "plates", || {
            let areas = bands_of_height_map(&self.heights, &found.layers[0], &target, unit, self.part());
            plates(&areas.collect(&mut findings), interval, scale, params.sheet)
        });
        Ok(Report { value: made?, findings })
    }
}
