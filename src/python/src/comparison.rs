//! Comparison of two height maps or surfaces.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::prelude::*;
use tokosen::GridSpec;
use tokosen::base::ElevationUnit;
use tokosen::base::error::Finding;
use tokosen::dem::compare::difference;
use tokosen::draw::report::{difference_map, table};
use tokosen::io::raster::Quantity;
use tokosen::io::{StagedOutput, VectorSource, check_paths};
use tokosen::raster::Dem;
use tokosen::surface::Triangles;
use tokosen::terrain::{
    MeasureOptions, Nodes, Pair, Side, comparison_json, measure, page, read_check_points, sentences,
};

use crate::error::{exception, parameter};
use crate::input::Recipe;
use crate::options::{Cells, Given, HeightMap};
use crate::raster::Raster;
use crate::source::Source;
use crate::terrain::{Terrain, built};
use crate::work::work;

/// Two height maps or surfaces, and the figures of their differences.
#[pyclass(frozen, module = "tokosen._tokosen")]
pub struct Comparison {
    pair: Pair,
    found: tokosen::dem::compare::Comparison,
    findings: Vec<Finding>,
}

/// A side as it is given.
#[derive(FromPyObject)]
pub enum GivenSide {
    Terrain(Py<Terrain>),
    HeightMap(HeightMap),
    Contours(Vec<Py<Source>>),
}

/// A side without Python's objects.
enum SideRecipe {
    Ready(Option<Box<Side>>),
    File(PathBuf),
    Contours(Box<Recipe>),
}

impl SideRecipe {
    fn new(py: Python<'_>, given: &GivenSide, options: &Given, name: &str) -> PyResult<Self> {
        Ok(match given {
            GivenSide::Terrain(terrain) => {
                let Terrain { terrain, name } = terrain.get();
                Self::Ready(Some(Box::new(Side::of_terrain(name, options.kind(py)?, terrain.clone()))))
            }
            GivenSide::HeightMap(HeightMap::InMemory(raster)) => {
                let dem: Dem = raster.get().dem(py)?;
                Self::Ready(Some(Box::new(Side::of_dem(Path::new(name), Arc::new(dem), None))))
            }
            GivenSide::HeightMap(HeightMap::File(path)) => Self::File(path.clone()),
            GivenSide::Contours(sources) => {
                let sources: Vec<PyRef<'_, Source>> = sources.iter().map(|source| source.borrow(py)).collect();
                Self::Contours(Box::new(Recipe::new(py, &sources, options)?))
            }
        })
    }
}

/// Compares A with B, the reference. `numbers` are the stated accuracy and the interval for terraces.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "each is an argument of the package's function")]
#[pyo3(signature = (a, b, given, cells, numbers, points, progress))]
pub fn compare(
    py: Python<'_>,
    a: GivenSide,
    b: GivenSide,
    given: Given,
    cells: Cells,
    numbers: [Option<f64>; 2],
    points: Option<Py<Source>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Comparison> {
    let [sigma, interval] = numbers;
    for (name, value) in [("sigma", sigma), ("interval", interval)] {
        if let Some(bad) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(parameter(py, format!("{name} is {bad}, it must be more than 0")));
        }
    }
    let spec = cells.spec(py)?;
    let has_dem = |side: &GivenSide| matches!(side, GivenSide::HeightMap(_));
    match (has_dem(&a) || has_dem(&b), &spec) {
        (true, Some(_)) => return Err(parameter(py, "the grid is that of the height map: leave out cell and like")),
        (false, None) => return Err(parameter(py, "two surfaces need a common grid: give cell or like")),
        _ => {}
    }
    let options = given.options(py, None, Triangles::Reference, ElevationUnit::Metre)?;
    let kind = given.kind(py)?;
    let sides = [SideRecipe::new(py, &a, &given, "A")?, SideRecipe::new(py, &b, &given, "B")?];
    let points: Option<VectorSource> = points.map(|source| source.get().vector(py, "points")).transpose()?;
    let unit = given.unit.as_deref().map(|name| crate::unit::unit(py, name)).transpose()?;
    work(py, progress, |progress| {
        let mut findings = Vec::new();
        let mut label = |letter: &str, about: Vec<Finding>| {
            let told = |finding: Finding| Finding { message: format!("{letter}: {}", finding.message), ..finding };
            findings.extend(about.into_iter().map(told));
        };
        // Height maps come first, because a surface is built for their cells.
        let [mut a, mut b] = sides;
        for (letter, side) in [("A", &mut a), ("B", &mut b)] {
            if let SideRecipe::File(path) = side {
                let report = Side::read_height_map(path, progress)?;
                label(letter, report.findings);
                *side = SideRecipe::Ready(Some(Box::new(report.value)));
            }
        }
        let ready = |side: &SideRecipe| match side {
            SideRecipe::Ready(Some(side)) => side.nodes().map(|(grid, _)| (grid, side.crs().cloned())),
            _ => None,
        };
        let crs = [&b, &a].into_iter().find_map(|side| ready(side).and_then(|(_, crs)| crs));
        let mut nodes: Option<Nodes> = ready(&b).or_else(|| ready(&a)).map(|(grid, _)| (grid, crs));
        let mut made = Vec::new();
        for (letter, side) in [("B", b), ("A", a)] {
            made.push(match side {
                SideRecipe::Ready(Some(side)) => *side,
                SideRecipe::Ready(None) | SideRecipe::File(_) => {
                    return Err(tokosen::Error::Data("a side of the comparison is missing".into()));
                }
                SideRecipe::Contours(recipe) => {
                    let grid = match &nodes {
                        Some((grid, crs)) => {
                            Some(GridSpec::Cells { grid: *grid, crs: crs.clone(), file: Some(recipe.name()) })
                        }
                        None => spec.clone(),
                    };
                    let mut terrain =
                        built(&recipe, &tokosen::Options { grid: grid.clone(), ..options.clone() }, progress)
                            .map_err(|unbuilt| unbuilt.0)?;
                    for finding in &mut terrain.findings {
                        finding.place = finding.place.and_then(|p| terrain.reprojection.in_input(p));
                    }
                    label(letter, std::mem::take(&mut terrain.findings));
                    if let (None, Some(grid)) = (&nodes, &grid) {
                        nodes = Some(terrain.cells(grid)?);
                    }
                    Side::of_terrain(&recipe.name(), kind, terrain)
                }
            });
        }
        let (Some(a), Some(b)) = (made.pop(), made.pop()) else {
            return Err(tokosen::Error::Data("a side of the comparison is missing".into()));
        };
        let nodes = match (nodes, &spec) {
            (Some(nodes), _) => nodes,
            (None, Some(GridSpec::Cells { grid, crs, .. })) => (*grid, crs.clone()),
            (None, _) => {
                return Err(tokosen::Error::Parameter("two terrains need the cells of a raster: give like".into()));
            }
        };
        Pair::refuse_degrees(&nodes, &b.source.file)?;
        let pair = Pair::on(a, b, nodes, progress)?;
        let mut found = measure(&pair, &MeasureOptions { sigma, interval, ..MeasureOptions::default() }, progress)?;
        for (letter, side) in [("A", &pair.a), ("B", &pair.b)] {
            label(letter, side.late_findings());
        }
        if let Some(source) = &points {
            read_check_points(&mut found, &pair, (source, unit), tokosen::cli::available_memory(), &mut findings)?;
        }
        Ok(Comparison { pair, found, findings })
    })
}

#[pymethods]
impl Comparison {
    /// All figures as JSON.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        comparison_json(&self.pair, &self.found, &self.findings).map_err(|error| exception(py, &error))
    }

    /// The table of figures, and what they mean, as lines of text.
    fn text(&self) -> Vec<String> {
        let titles = [("A", &self.pair.a), ("B", &self.pair.b)]
            .map(|(letter, side)| format!("{letter}  {}", side.source.title()));
        let mut lines: Vec<String> = titles.into_iter().collect();
        lines.push(String::new());
        lines.extend(table(&self.found));
        lines.push(String::new());
        lines.extend(sentences(&self.pair, &self.found));
        lines
    }

    /// A minus B, metres.
    fn difference(&self, py: Python<'_>) -> PyResult<Raster> {
        let found = work(py, None, |_| difference(&*self.pair.a_heights, &*self.pair.b_heights))?;
        Raster::new(py, found, None, Quantity::Difference, &[])
    }

    /// The map of the differences, as PNG in a data URI.
    fn picture(&self, py: Python<'_>) -> PyResult<String> {
        let Pair { a_heights, b_heights, .. } = &self.pair;
        work(py, None, |_| difference_map(&**a_heights, &**b_heights, &self.found, self.pair.metres_per_unit()))
    }

    /// The report: a page of HTML.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        work(py, None, |_| page(&self.pair, &self.found))
    }

    /// Writes the report.
    fn write_page(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm")) {
            return Err(parameter(py, format!("{}: the report is written as .html", path.display())));
        }
        work(py, None, |_| {
            check_paths(&[], &[path.as_path().into()], overwrite)?;
            let staged = StagedOutput::create(&path)?;
            let text = page(&self.pair, &self.found)?;
            let written = std::fs::write(staged.path(), text).map_err(|source| tokosen::Error::Io {
                action: "write",
                path: path.clone(),
                source,
            });
            written?;
            staged.commit().map(drop)
        })
    }
}
