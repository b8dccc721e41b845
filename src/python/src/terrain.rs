//! The ground between contours.

use glam::DVec2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tokosen::bands::bands_of_surface;
use tokosen::base::error::{Finding, Severity};
use tokosen::base::progress::Progress;
use tokosen::cartography::{for_map, slope_between};
use tokosen::contour::{ContourLayer, Target, distinct_levels};
use tokosen::crs::FromWorking;
use tokosen::dem::profile::stations;
use tokosen::draw::Scene;
use tokosen::io::layer::{
    bands_layer, break_lines, labels_layer, of_bands, of_conflicts, of_contours, of_findings, of_labels, pit_points,
    stream_lines,
};
use tokosen::io::raster::Quantity;
use tokosen::layers::LayerParams;
use tokosen::mesh::{Keep, Light, MeshParams};
use tokosen::slice::label_layers;
use tokosen::surface::{Triangles, working_pits};
use tokosen::terrain::{HeightMap, HtmlParams};
use tokosen::{Input, Interval, Options};

use crate::error::Warned;
use crate::error::{exception, parameter};
use crate::input::{Recipe, failed};
use crate::layer::{Layer, crs_text};
use crate::model::Model;
use crate::options::{Cells, Given, Levels, settled};
use crate::raster::Raster;
use crate::source::Source;
use crate::tiles::Shown;
use crate::unit::{one_of, unit};
use crate::work::work;

/// The ground between contours, and the findings about them.
#[pyclass(frozen, module = "tokosen._tokosen")]
pub struct Terrain {
    pub terrain: tokosen::Terrain,
    /// The name of the contours in messages.
    pub name: std::path::PathBuf,
}

/// Findings that are errors or warnings, with their places in the input's coordinates in the message.
pub fn warned<'a>(findings: impl IntoIterator<Item = &'a Finding>, back: &FromWorking) -> Vec<Warned> {
    let told = findings.into_iter().filter(|finding| finding.kind.severity() > Severity::Note);
    told.map(|finding| {
        let placed = Finding { place: finding.place.and_then(|p| back.place(p)), ..finding.clone() };
        (finding.kind.severity().name(), finding.kind.code(), placed.with_place_in_words().message)
    })
    .collect()
}

/// Why a terrain was not built, and what was found about the input until then: lines that were left out may be the cause.
pub struct Unbuilt(pub tokosen::Error, pub Vec<Warned>);

/// Reads and builds a terrain.
pub fn built(recipe: &Recipe, options: &Options, progress: &dyn Progress) -> Result<tokosen::Terrain, Unbuilt> {
    let mut input = recipe.contours(progress).map_err(|error| Unbuilt(error, Vec::new()))?;
    let built = built_of(recipe, &mut input, options, progress);
    built.map_err(|error| {
        let back = input.reprojection.from_working(None);
        Unbuilt(error, back.map(|back| warned(&input.findings, &back)).unwrap_or_default())
    })
}

fn built_of(
    recipe: &Recipe,
    input: &mut Input,
    options: &Options,
    progress: &dyn Progress,
) -> tokosen::Result<tokosen::Terrain> {
    options.sea.into_iter().for_each(|sea| input.expect_level(sea));
    input.prepare(&options.preparation, progress)?;
    recipe.base(input, progress)?;
    recipe.surface(input)?;
    tokosen::Terrain::build_with(input, options, progress)
}

/// Findings that are told with an error.
const TOLD: usize = 10;

impl Unbuilt {
    /// The exception, with the findings as notes.
    fn exception(self, py: Python<'_>) -> PyErr {
        let Self(error, findings) = self;
        let raised = exception(py, &error);
        for (severity, _, message) in findings.iter().take(TOLD) {
            // The exception is told without it, if there is no room for a note.
            let _ = raised.add_note(py, format!("{severity}: {message}"));
        }
        raised
    }
}

/// Places along a line if no step is given.
const STEPS: f64 = 500.0;

impl Terrain {
    /// Places in the coordinates of the contours on the working plane.
    fn on_plane(&self, points: &[[f64; 2]]) -> tokosen::Result<Vec<DVec2>> {
        let way = self.terrain.reprojection.bring(None)?;
        points.iter().map(|&p| Ok(way.point(DVec2::from(p).extend(0.0))?.truncate())).collect()
    }
}

#[pymethods]
impl Terrain {
    /// Builds the surface. `cells` are those of the height map that will be asked for; `only_dem` leaves out what only contours
    /// and models need.
    #[staticmethod]
    #[pyo3(signature = (contours, given, cells, to_unit, only_dem, progress))]
    fn build(
        py: Python<'_>,
        contours: Vec<PyRef<'_, Source>>,
        given: Given,
        cells: Cells,
        to_unit: &str,
        only_dem: bool,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let triangles = if only_dem { Triangles::Reference } else { Triangles::Smooth };
        let options = given.options(py, cells.spec(py)?, triangles, unit(py, to_unit)?)?;
        let recipe = Recipe::new(py, &contours, &given)?;
        let terrain = work(py, progress, |progress| Ok(built(&recipe, &options, progress)))?;
        let terrain = terrain.map_err(|unbuilt| unbuilt.exception(py))?;
        Ok(Self { terrain, name: recipe.name() })
    }

    /// Contours at intervals, or at levels: a layer each, and a layer of labels behind each if the height of their text is given (0 for
    /// the usual one).
    #[pyo3(signature = (levels, simplify, keep_input, progress))]
    fn contours(
        &self,
        py: Python<'_>,
        levels: Levels,
        simplify: Option<f64>,
        keep_input: bool,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<Layer>> {
        if let Some(bad) = simplify.filter(|t| !(t.is_finite() && *t >= 0.0)) {
            return Err(parameter(py, format!("simplify is {bad}, it must be 0 or more")));
        }
        let (targets, unit) = (levels.targets(py)?, levels.unit(py)?);
        let back = levels.heights_of(py, failed(py, self.terrain.to_output(levels.crs(py)?.as_ref()))?)?;
        let plan = levels.map_plan(py)?;
        let map = settled(plan, levels.base_level, || slope_between(&self.terrain.surface.map));
        let targets = map.map_or(targets, |map| vec![map.kinds.levels()]);
        let index_every = levels.index;
        let params = LayerParams { targets: targets.clone(), unit, index_every, simplify, keep_input, memory: None };
        work(py, progress, |progress| {
            let mut layers = self.terrain.contours_with(params, progress)?;
            if let (Some(map), Some(layer)) = (map, layers.first_mut()) {
                let of_input = self.terrain.of_input(map.kinds.interval, unit, keep_input);
                for_map(layer, &map, of_input, &self.terrain.map_ground());
            }
            with_labels(&layers, &targets, &levels, self.terrain.surface.frame.extent(), &back)
        })
    }

    /// The areas between contours at intervals, or at levels: a layer each. Then what to warn of.
    fn bands(
        &self,
        py: Python<'_>,
        levels: Levels,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(Vec<Layer>, Vec<Warned>)> {
        let (targets, unit) = (levels.targets(py)?, levels.unit(py)?);
        let back = levels.heights_of(py, failed(py, self.terrain.to_output(levels.crs(py)?.as_ref()))?)?;
        let params = LayerParams { targets: targets.clone(), unit, ..LayerParams::default() };
        work(py, progress, |progress| {
            let lines = self.terrain.contours_with(params, progress)?;
            let (mut layers, mut findings) = (Vec::new(), Vec::new());
            for (target, lines) in targets.iter().zip(&lines) {
                let areas = bands_of_surface(&self.terrain.surface, lines, target, unit).collect(&mut findings);
                layers.extend(Layer::all(&[of_bands(&bands_layer(&lines.name), &areas)], &back)?);
            }
            Ok((layers, warned(&findings, &self.terrain.to_output(None)?)))
        })
    }

    /// A height map, with standard errors if the terrain has them.
    #[pyo3(signature = (cells, progress))]
    fn dem(&self, py: Python<'_>, cells: Cells, progress: Option<&Bound<'_, PyAny>>) -> PyResult<Raster> {
        let grid = cells.needed(py)?;
        let report = work(py, progress, |progress| self.terrain.height_map(&grid, progress))?;
        let HeightMap { dem, errors, .. } = report.value;
        Raster::new(py, dem, errors, Quantity::Height, &report.findings)
    }

    /// Heights and standard errors at places in the coordinates of the contours.
    #[pyo3(signature = (points))]
    fn sample(&self, py: Python<'_>, points: Vec<[f64; 2]>) -> PyResult<[Vec<f64>; 2]> {
        work(py, None, |_| {
            let samples = self.terrain.sample(&self.on_plane(&points)?);
            Ok([
                samples.iter().map(|sample| sample.height).collect(),
                samples.iter().map(|sample| sample.error).collect(),
            ])
        })
    }

    /// Distances, x, y, heights and standard errors along a line in the coordinates of the contours.
    #[pyo3(signature = (line, step))]
    fn profile(&self, py: Python<'_>, line: Vec<[f64; 2]>, step: Option<f64>) -> PyResult<[Vec<f64>; 5]> {
        work(py, None, |_| {
            let line = self.on_plane(&line)?;
            let length: f64 = line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
            let stations = stations(&line, step.unwrap_or(length / STEPS), DVec2::ONE)?;
            let places: Vec<DVec2> = stations.iter().map(|station| station.place).collect();
            let samples = self.terrain.sample(&places);
            let reprojection = &self.terrain.reprojection;
            let back = |p: &DVec2| if reprojection.are_unmoved() { Some(*p) } else { reprojection.in_input(*p) };
            let there: Vec<DVec2> = places.iter().map(|p| back(p).unwrap_or(DVec2::NAN)).collect();
            Ok([
                stations.iter().map(|station| station.distance).collect(),
                there.iter().map(|p| p.x).collect(),
                there.iter().map(|p| p.y).collect(),
                samples.iter().map(|sample| sample.height).collect(),
                samples.iter().map(|sample| sample.error).collect(),
            ])
        })
    }

    /// A 3-D model; a solid if the height of its bottom is given.
    #[pyo3(signature = (base, tolerance, cell, keep, progress))]
    fn mesh(
        &self,
        py: Python<'_>,
        base: Option<f64>,
        tolerance: Option<f64>,
        cell: Option<f64>,
        keep: &str,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Model> {
        let keep = match keep {
            "contours" => Keep::Contours,
            "breaklines" => Keep::BreakLines,
            "none" => Keep::Nothing,
            other => return Err(one_of(py, "keep", other, "contours, breaklines or none")),
        };
        let light = tolerance.map(|tolerance| Light { tolerance, cell, keep });
        work(py, progress, |_| {
            let mesh = self.terrain.mesh(&MeshParams { base, light })?;
            Ok(mesh.in_drawing(&self.terrain.reprojection).unwrap_or(mesh))
        })
        .map(Model)
    }

    /// A page that shows the terrain in 3-D.
    #[pyo3(signature = (title, interval, tolerance, cell, progress))]
    fn html(
        &self,
        py: Python<'_>,
        title: String,
        interval: Option<f64>,
        tolerance: Option<f64>,
        cell: Option<f64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let target = interval.map(|step| Interval::every(step).into());
        let params = HtmlParams { title, target, tolerance, cell, ..HtmlParams::default() };
        work(py, progress, |progress| self.terrain.to_html(&params, progress))
    }

    /// The pits that are left in the smooth surface or, if cells are given, in the height map of these cells.
    #[pyo3(signature = (cells, progress))]
    fn pits(&self, py: Python<'_>, cells: Cells, progress: Option<&Bound<'_, PyAny>>) -> PyResult<Layer> {
        let grid = cells.spec(py)?;
        work(py, progress, |progress| {
            let pits = match &grid {
                Some(grid) => self.terrain.pits_of(&self.terrain.dem_with(grid, progress)?, grid)?,
                None => working_pits(&self.terrain.surface).unwrap_or_default(),
            };
            one(Layer::all(&[pit_points(&pits)], &self.terrain.to_output(None)?))
        })
    }

    /// The streams as they are used.
    fn streams(&self, py: Python<'_>) -> PyResult<Layer> {
        failed(py, self.layer(stream_lines(&self.terrain.surface.streams)))
    }

    /// The break lines as they are used.
    fn breaklines(&self, py: Python<'_>) -> PyResult<Layer> {
        failed(py, self.layer(break_lines(&self.terrain.surface.break_lines)))
    }

    /// The findings about the input.
    fn findings(&self, py: Python<'_>) -> PyResult<Layer> {
        failed(py, self.about_findings(of_findings))
    }

    /// The findings about inputs that contradict each other.
    fn conflicts(&self, py: Python<'_>) -> PyResult<Layer> {
        failed(py, self.about_findings(of_conflicts))
    }

    /// The errors and warnings among the findings.
    fn warned(&self, py: Python<'_>) -> PyResult<Vec<Warned>> {
        Ok(warned(&self.terrain.findings, &failed(py, self.terrain.to_output(None))?))
    }

    /// Figures about the contours and the surface.
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let surface = &self.terrain.surface;
        let levels = distinct_levels(&surface.map.contours);
        let figures = PyDict::new(py);
        figures.set_item("lines", surface.map.contours.len())?;
        figures.set_item("vertices", surface.map.vertex_count())?;
        figures.set_item("levels", (levels.first(), levels.last(), levels.len()))?;
        figures.set_item("interval", surface.interval.step)?;
        figures.set_item("crs", self.terrain.reprojection.input_crs().and_then(crs_text))?;
        figures.set_item("work_crs", self.terrain.reprojection.working_crs().and_then(crs_text))?;
        let implied = surface.chosen.as_ref().and_then(|chosen| chosen.implied.as_ref());
        figures.set_item("accuracy", implied.map(|accuracy| (accuracy.rmse, accuracy.le90)))?;
        Ok(figures)
    }

    /// A picture of the terrain with its contours, as PNG.
    fn picture(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        work(py, None, |_| {
            let lines = self.terrain.input_contours()?.lines;
            let units = self.terrain.units();
            let scene = Scene::of_surface(&self.terrain.surface, &lines, &self.terrain.reprojection, units);
            tokosen::io::raster::picture_bytes(&scene.within(self.terrain.part()).image()?)
        })
    }
}

impl Terrain {
    fn about_findings(
        &self,
        of: for<'a> fn(&'a [Finding], &FromWorking) -> tokosen::io::layer::Layer<'a>,
    ) -> tokosen::Result<Layer> {
        let back = self.terrain.to_output(None)?;
        one(Layer::all(&[of(&self.terrain.findings, &back)], &back))
    }

    fn layer(&self, layer: tokosen::io::layer::Layer<'_>) -> tokosen::Result<Layer> {
        one(Layer::all(&[layer], &self.terrain.to_output(None)?))
    }
}

/// Layers of contours at `targets`, each followed by that of its labels if there are any.
pub fn with_labels(
    layers: &[ContourLayer],
    targets: &[Target],
    levels: &Levels,
    extent: (DVec2, DVec2),
    back: &FromWorking,
) -> tokosen::Result<Vec<Layer>> {
    let unit = back.unit();
    let height = levels.labels.map(|height| (height != 0.0).then_some(height));
    let mut placed = height.map(|height| label_layers(layers, height, extent, unit)).transpose()?.map(Vec::into_iter);
    let mut all = Vec::new();
    for (layer, target) in layers.iter().zip(targets) {
        let interval = match *target {
            Target::Interval { step, base } => Some(Interval { step, base, rounding: 0.0 }),
            Target::Levels(_) => None,
        };
        let shown = Some(Shown { interval, index: levels.index, unit });
        all.extend(Layer::all(&[of_contours(layer)], back)?.into_iter().map(|made| Layer { shown, ..made }));
        if let Some(labels) = placed.as_mut().and_then(Iterator::next) {
            let name = labels_layer(&layer.name, layers.len() == 1);
            all.extend(Layer::all(&[of_labels(&name, &labels, back)], back)?);
        }
    }
    Ok(all)
}

/// The only layer of several.
pub fn one(layers: tokosen::Result<Vec<Layer>>) -> tokosen::Result<Layer> {
    layers?.pop().ok_or_else(|| tokosen::Error::Data("there is no layer".into()))
}
