//! A height map in 3-D as a page: [`DemModel::to_html`].

use super::dem_model::DemModel;
use super::grid::GridSpec;
use super::html::{HtmlParams, MOST_CELLS, TOLERANCE, exaggeration, of_relief};
use super::part::box_area;
use super::plane_cells::{Window, cells_on_plane};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::base::{Grid, Units};
use tokosen_core::contour::Target;
use tokosen_core::crs::Reprojection;
use tokosen_core::dem::compare::heights_between;
use tokosen_core::dem::contour::{ContourParams, contours};
use tokosen_core::mesh::height_mesh;
use tokosen_core::raster::{Dem, mask};
use tokosen_core::slice::label_layers;
use tokosen_core::subdomains::FrameRing;
use tokosen_draw::terrain_page::{TerrainPage, terrain_page};

impl DemModel {
    /// A page that shows the height map in 3-D, with its contours if levels are given: one HTML file, which needs no other file and
    /// no network.
    ///
    /// Square cells are those of the page, or every second, third, … of them if there are more than a million. In others, and in
    /// cells of a size that is given, heights are interpolated. Without a tolerance, triangles are within a twentieth of the contour
    /// interval, or a five-hundredth of the relief.
    ///
    /// # Errors
    /// As [`DemModel::mesh`] and [`contours`]. [`Error::TooManyCells`] for cells that are too small.
    pub fn to_html(&self, params: &HtmlParams, progress: &dyn Progress) -> Result<String> {
        let (mut heights, part) = (self.page_cells(params.cell)?, self.part());
        let tolerance = params.tolerance.unwrap_or_else(|| match params.target {
            Some(Target::Interval { step, .. }) => TOLERANCE * params.unit.metres(step),
            _ => of_relief(&heights),
        });
        let mesh = step(progress, "triangles", || height_mesh(&heights, part, Some(tolerance)))?;
        let traced = |target: &Target| {
            let part = part.cloned();
            let params =
                ContourParams { targets: vec![target.clone()], unit: params.unit, part, ..ContourParams::default() };
            Ok::<_, Error>(contours(&heights, &params, progress)?.layers)
        };
        let layers = params.target.as_ref().map(traced).transpose()?.unwrap_or_default();
        if let Some(area) = part {
            mask(&mut heights, area, &Some);
        }
        let [lo, hi] = heights.corners();
        let units = Units { heights: params.unit, ..Units::METRES };
        let labels = label_layers(&layers, None, (lo, hi), units.heights)?.pop().unwrap_or_default();
        Ok(terrain_page(&TerrainPage {
            title: &params.title,
            tolerance,
            contours: layers.first().map_or(&[], |layer| &layer.lines),
            labels: &labels,
            exaggeration: exaggeration(hi - lo, &mesh),
            units,
            ..TerrainPage::of_heights(&heights, &mesh)
        }))
    }

    /// The heights in square cells of a size, or in at most a million.
    fn page_cells(&self, size: Option<f64>) -> Result<Dem> {
        let own = self.heights();
        let none = || Error::Data("the height map has no heights in this part of the map".into());
        let window = Window::of([own]).ok_or_else(none)?;
        let Some(size) = size else {
            let [cells] = cells_on_plane([own], &window, (own.crs.as_ref(), None), MOST_CELLS)?;
            return Ok(cells);
        };
        let (lo, hi) = window.corners(&own.grid);
        let covered = FrameRing { area: box_area([lo.x, lo.y, hi.x, hi.y])? };
        GridSpec::Cell(size).over(&Reprojection::default())?.check_room(&covered, false, self.memory)?;
        let grid = Grid::on_multiples(lo, hi, size);
        Ok(Dem { grid, values: heights_between(own, &grid, &Some), crs: own.crs.clone() })
    }
}
