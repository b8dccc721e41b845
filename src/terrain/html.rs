//! A terrain in 3-D as a page: [`Terrain::to_html`].

use glam::{DVec2, DVec3};

use super::clipped::clip_courses;
use super::facade::Terrain;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::Result;
use tokosen_core::base::progress::Progress;
use tokosen_core::contour::Target;
use tokosen_core::layers::LayerParams;
use tokosen_core::mesh::{Keep, Light, Mesh, MeshParams};
use tokosen_core::raster::{Dem, mask};
use tokosen_core::skeleton::SkeletonKind;
use tokosen_core::slice::label_layers;
use tokosen_core::surface::{standard_errors, water_cells};
use tokosen_draw::terrain_page::{TerrainPage, terrain_page};

/// Most cells of a page, if no size of cells is given: they are read within a second, and take some megabytes.
pub(super) const MOST_CELLS: f64 = 1e6;
/// Largest distance of the triangles from the heights, in contour intervals: less than the width of a contour on most screens.
pub(super) const TOLERANCE: f64 = 0.05;
/// Largest distance of the triangles from the heights, as a share of the relief, if no contours say more.
const TOLERANCE_OF_RELIEF: f64 = 1.0 / 500.0;
/// Height of the terrain that a page shows, at least: as a share of the diagonal of the map.
const TALL: f64 = 0.12;
/// Largest factor on heights that a page begins with.
const MOST_TIMES: f64 = 5.0;

/// What a page shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HtmlParams {
    /// What the terrain is called.
    pub title: String,
    /// The levels of new contours, if there are to be any.
    pub target: Option<Target>,
    /// The unit of these levels.
    pub unit: ElevationUnit,
    /// Size of the cells, metres. If `None`, that of the smooth surface, or what gives a million cells.
    pub cell: Option<f64>,
    /// Largest distance of the triangles from the heights of the cells, metres. A twentieth of the contour interval if `None`.
    pub tolerance: Option<f64>,
}

impl Terrain {
    /// A page that shows the terrain in 3-D: one HTML file, which needs no other file and no network. It has expected errors if
    /// the options asked for them.
    ///
    /// # Errors
    /// As [`Terrain::mesh`] and [`Terrain::contours`].
    pub fn to_html(&self, params: &HtmlParams, progress: &dyn Progress) -> Result<String> {
        let surface = &self.surface;
        let tolerance = params.tolerance.unwrap_or(TOLERANCE * surface.interval.step);
        let (lo, hi) = surface.frame.extent();
        let size = hi - lo;
        let own = Light { tolerance, cell: params.cell, keep: Keep::Nothing }.grid(surface).cell.x;
        let cell = params.cell.unwrap_or_else(|| own.max((size.x * size.y / MOST_CELLS).sqrt()));
        let light = Light { tolerance, cell: Some(cell), keep: Keep::Nothing };
        self.check_light(&light)?;
        let mut heights = light.heights(surface);
        if let Some(area) = self.part() {
            mask(&mut heights, area, &Some);
        }
        let mesh = self.mesh(&MeshParams { light: Some(light), ..MeshParams::default() })?;
        let target = params.target.clone().unwrap_or(Target::Levels(Vec::new()));
        let layers = LayerParams { targets: vec![target], unit: params.unit, ..LayerParams::default() };
        let layers = self.contours_with(layers, progress)?;
        let units = self.units();
        let labels = label_layers(&layers, None, (lo, hi), units.heights)?;

        let of_kind = |kind| surface.skeleton_lines.iter().filter(move |line| line.kind == kind);
        let courses = |kind| of_kind(kind).map(|line| line.points.clone()).collect();
        let mut lines: Vec<(&str, Vec<Vec<DVec3>>)> = vec![
            ("ridges", courses(SkeletonKind::Ridge)),
            ("canyons", courses(SkeletonKind::Canyon)),
            ("streams", surface.streams.iter().map(|stream| stream.points.clone()).collect()),
            ("breaks", surface.break_lines.iter().map(|line| line.points.clone()).collect()),
        ];
        if let Some(area) = self.part() {
            lines.iter_mut().for_each(|(_, lines)| clip_courses(lines, area));
        }
        let mut spots = surface.map.spots.clone();
        spots.extend(surface.map.soft_spots.iter().map(|spot| spot.place));
        Ok(terrain_page(&TerrainPage {
            title: &params.title,
            errors: standard_errors(surface, &heights),
            differences: None,
            water: water_cells(surface, &heights.grid),
            heights: &heights,
            mesh: &mesh,
            tolerance,
            contours: &layers[0].lines,
            labels: &labels[0],
            lines,
            spots,
            findings: &self.findings,
            exaggeration: exaggeration(size, &mesh),
            units,
        }))
    }
}

/// The tolerance of triangles over heights without contours, metres.
pub(super) fn of_relief(heights: &Dem) -> f64 {
    let relief = heights.values.iter().filter(|height| height.is_finite());
    let (low, high) = relief.fold((f32::MAX, f32::MIN), |(low, high), z| (low.min(*z), high.max(*z)));
    f64::from(high - low).max(1e-3) * TOLERANCE_OF_RELIEF
}

/// The factor on heights that a page of a map of some size begins with.
pub(super) fn exaggeration(size: DVec2, mesh: &Mesh) -> f64 {
    let (lowest, highest) = mesh.extent();
    let times = (TALL * size.length() / (highest.z - lowest.z)).clamp(1.0, MOST_TIMES);
    if times.is_finite() { (times * 10.0).round() / 10.0 } else { 1.0 }
}
