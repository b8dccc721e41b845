//! What needs no surface: the check of contours, sub-domains, ridge and canyon lines, contours of a height map, and what is
//! derived from one.

use pyo3::prelude::*;
use tokosen::bands::bands_of_height_map;
use tokosen::base::ElevationUnit;
use tokosen::base::error::Severity;
use tokosen::cartography::{self, OfInput, for_map, mean_slope};
use tokosen::crs::{Crs, Reprojection};
use tokosen::dem::contour::{ContourParams, contours};
use tokosen::dem::derive::{HeightsFrom, SteepParams, aspect, check as check_dem, shade, slope, steep, steep_note};
use tokosen::dem::shade::{Light, ShadeParams};
use tokosen::io::layer::{
    bands_layer, of_bands, of_findings, of_landforms, of_map, of_spots, skeleton_lines, steep_areas,
};
use tokosen::io::raster::Quantity;
use tokosen::raster::GroundScale;
use tokosen::skeleton::skeleton as skeleton_of;
use tokosen::subdomains::landforms;
use tokosen::surface::Triangles;
use tokosen::terrain::{all_right, check_json, clip_areas, clip_skeleton, clip_streams};
use tokosen::tuning::SkeletonTuning;

use crate::derived::Derived;
use crate::error::Warned;
use crate::error::parameter;
use crate::flow::{self, Water};
use crate::input::{Ground, Recipe, failed};
use crate::layer::Layer;
use crate::options::{Given, Levels, settled};
use crate::raster::Raster;
use crate::source::{Source, crs};
use crate::terrain::{one, warned, with_labels};
use crate::unit::unit;
use crate::work::work;

/// A check: the findings, their description as JSON, the repaired contours and spot heights, what to warn of.
type Checked = (Layer, String, Vec<Layer>, Vec<Warned>);

/// What is read and how, for work that needs no surface. Without Python's objects.
struct Plan {
    recipe: Recipe,
    options: tokosen::Options,
    unit: ElevationUnit,
    to_crs: Option<Crs>,
}

impl Plan {
    fn new(
        py: Python<'_>,
        contours: &[PyRef<'_, Source>],
        given: &Given,
        to_crs: Option<&str>,
        to_unit: &str,
    ) -> PyResult<Self> {
        let unit = unit(py, to_unit)?;
        let options = given.options(py, None, Triangles::Reference, unit)?;
        Ok(Self { recipe: Recipe::new(py, contours, given)?, options, unit, to_crs: crs(py, to_crs)? })
    }
}

/// Checks contours, and compares lakes, streams and break lines with them.
#[pyfunction]
#[pyo3(signature = (contours, given, to_crs, to_unit, progress))]
pub fn check(
    py: Python<'_>,
    contours: Vec<PyRef<'_, Source>>,
    given: Given,
    to_crs: Option<&str>,
    to_unit: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Checked> {
    let Plan { recipe, options, unit, to_crs } = Plan::new(py, &contours, &given, to_crs, to_unit)?;
    let strict = given.strict;
    work(py, progress, |progress| {
        let mut input = recipe.contours(progress)?;
        options.sea.into_iter().for_each(|sea| input.expect_level(sea));
        input.clean(&options.preparation, progress)?;
        let back = input.reprojection.from_working(to_crs.as_ref())?;
        let map = input.map.clone();
        recipe.surface(&mut input)?;
        let judged = input.judge(&options, progress)?;
        input.findings.sort_by_key(|finding| (std::cmp::Reverse(finding.kind.severity()), finding.kind));
        if strict {
            all_right(&input.name(), &input.findings)?;
        }
        let findings = one(Layer::all(&[of_findings(&input.findings, &back)], &back))?;
        let json = check_json(&input, &judged).to_string();
        let layers = [of_map(&map), of_spots(&map)];
        let some = if map.spots.is_empty() { &layers[..1] } else { &layers[..] };
        let repaired = Layer::all(some, &back.clone().with_heights_in(unit))?;
        let warned = warned(&input.findings, &input.reprojection.from_working(None)?);
        Ok((findings, json, repaired, warned))
    })
}

/// The sub-domains between contours as areas, and what to warn of.
#[pyfunction]
#[pyo3(signature = (contours, given, to_crs, to_unit, progress))]
pub fn regions(
    py: Python<'_>,
    contours: Vec<PyRef<'_, Source>>,
    given: Given,
    to_crs: Option<&str>,
    to_unit: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Layer, Vec<Warned>)> {
    let Plan { recipe, options, unit, to_crs } = Plan::new(py, &contours, &given, to_crs, to_unit)?;
    work(py, progress, |progress| {
        let mut input = recipe.contours(progress)?;
        options.sea.into_iter().for_each(|sea| input.expect_level(sea));
        input.prepare(&options.preparation, progress)?;
        recipe.surface(&mut input)?;
        let back = input.reprojection.from_working(to_crs.as_ref())?.with_heights_in(unit);
        let (subdivision, part) = input.subdivide(options.sea, progress)?;
        let forms = landforms(&subdivision.tin, &subdivision.regions);
        let areas = of_landforms(&forms, &subdivision.tin, &subdivision.regions);
        let layer = one(Layer::all(&[part.iter().fold(areas, clip_areas)], &back))?;
        Ok((layer, warned(&input.findings, &input.reprojection.from_working(None)?)))
    })
}

/// Ridge and canyon lines, and what to warn of.
#[pyfunction]
#[pyo3(signature = (contours, given, to_crs, to_unit, progress))]
pub fn skeleton(
    py: Python<'_>,
    contours: Vec<PyRef<'_, Source>>,
    given: Given,
    to_crs: Option<&str>,
    to_unit: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Layer, Vec<Warned>)> {
    let resolution = given.resolution;
    if !resolution.is_finite() || resolution < 0.0 {
        return Err(parameter(py, format!("resolution is {resolution}, it must be 0 or more")));
    }
    let Plan { recipe, options, unit, to_crs } = Plan::new(py, &contours, &given, to_crs, to_unit)?;
    work(py, progress, |progress| {
        let mut input = recipe.contours(progress)?;
        options.sea.into_iter().for_each(|sea| input.expect_level(sea));
        input.prepare(&options.preparation, progress)?;
        let back = input.reprojection.from_working(to_crs.as_ref())?.with_heights_in(unit);
        recipe.surface(&mut input)?;
        let (subdivision, part) = input.subdivide(options.sea, progress)?;
        let mut streams = input.settle_streams(&subdivision, options.stream_tolerance, progress)?;
        progress.start("ridge and canyon lines", 0);
        let mut found = skeleton_of(&subdivision.tin, &subdivision.regions, resolution, &SkeletonTuning::default());
        progress.finish();
        if let Some(area) = &part {
            clip_skeleton(&mut found, area);
            clip_streams(&mut streams, area);
        }
        let layer = one(Layer::all(&[skeleton_lines(&found, &streams)], &back))?;
        Ok((layer, warned(&input.findings, &input.reprojection.from_working(None)?)))
    })
}

/// Contours of a height map, as those of a terrain, and what to warn of. `given` says which part of the height map is wanted.
#[pyfunction]
#[pyo3(signature = (dem, given, levels, tolerance, smooth, progress))]
pub fn contour(
    py: Python<'_>,
    dem: &Raster,
    given: Given,
    levels: Levels,
    tolerance: Option<f64>,
    smooth: Option<f64>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Vec<Layer>, Vec<Warned>)> {
    for (name, value) in [("tolerance", tolerance), ("smooth", smooth)] {
        if let Some(bad) = value.filter(|v| !(v.is_finite() && *v >= 0.0)) {
            return Err(parameter(py, format!("{name} is {bad}, it must be 0 or more")));
        }
    }
    let (targets, unit) = (levels.targets(py)?, levels.unit(py)?);
    let dem = dem.dem(py)?;
    let unmoved = Reprojection::unmoved(dem.crs.clone());
    let back = levels.heights_of(py, failed(py, unmoved.from_working(levels.crs(py)?.as_ref()))?)?;
    let ground = Ground::new(py, &given)?;
    let memory = tokosen::cli::available_memory();
    let plan = levels.map_plan(py)?;
    let mut params = ContourParams { targets, unit, index_every: levels.index, tolerance, smooth, part: None, memory };
    work(py, progress, move |progress| {
        let dem = ground.of(dem, &mut params)?;
        let [low, high] = params.part.as_ref().map_or_else(|| dem.corners(), |part| dem.around(part).corners());
        let map = settled(plan, levels.base_level, || mean_slope(&dem));
        if let Some(map) = map {
            params.targets = vec![map.kinds.levels()];
        }
        let mut found = contours(&dem, &params, progress)?;
        if let (Some(map), Some(layer)) = (map, found.layers.first_mut()) {
            for_map(layer, &map, OfInput::AsNew, &cartography::Ground::of_dem(&dem, params.part.as_ref()));
        }
        let raised = tolerance.and_then(|asked| found.raised_from(asked));
        let warned = raised.map(|why| (Severity::Warning.name(), "tolerance-raised", format!("tolerance {why}")));
        let layers = with_labels(&found.layers, &params.targets, &levels, (low, high), &back)?;
        Ok((layers, warned.into_iter().collect()))
    })
}

/// The areas between the contours of a height map, as those of a terrain, and what to warn of.
#[pyfunction]
pub fn bands(
    py: Python<'_>,
    dem: &Raster,
    given: Given,
    levels: Levels,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Vec<Layer>, Vec<Warned>)> {
    let (targets, unit) = (levels.targets(py)?, levels.unit(py)?);
    let dem = dem.dem(py)?;
    let unmoved = Reprojection::unmoved(dem.crs.clone());
    let back = levels.heights_of(py, failed(py, unmoved.from_working(levels.crs(py)?.as_ref()))?)?;
    let ground = Ground::new(py, &given)?;
    let memory = tokosen::cli::available_memory();
    let mut params = ContourParams { targets, unit, memory, ..ContourParams::default() };
    work(py, progress, move |progress| {
        let dem = ground.of(dem, &mut params)?;
        let found = contours(&dem, &params, progress)?;
        let (mut layers, mut findings) = (Vec::new(), Vec::new());
        for (target, lines) in params.targets.iter().zip(&found.layers) {
            let areas = bands_of_height_map(&dem, lines, target, unit, params.part.as_ref()).collect(&mut findings);
            layers.extend(Layer::all(&[of_bands(&bands_layer(&lines.name), &areas)], &back)?);
        }
        Ok((layers, warned(&findings, &unmoved.from_working(None)?)))
    })
}

/// Derives a raster or areas from a height map. `numbers` are those of the light: azimuth, altitude, factor on heights; and
/// those of steep places: angle, height. The second value is what to warn of.
#[pyfunction]
#[pyo3(signature = (dem, what, multidirectional, numbers, interval, water, progress))]
#[allow(clippy::too_many_arguments, reason = "each is an argument of the package's function")]
pub fn derive(
    py: Python<'_>,
    dem: &Raster,
    what: &str,
    multidirectional: bool,
    numbers: [f64; 5],
    interval: Option<f64>,
    water: Water,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Derived, Vec<Warned>)> {
    let [azimuth, altitude, z_factor, angle, height] = numbers;
    let ranges = [
        ("azimuth", azimuth, 0.0..=360.0),
        ("altitude", altitude, 0.0..=90.0),
        ("z_factor", z_factor, f64::MIN_POSITIVE..=f64::MAX),
        ("steep_angle", angle, f64::MIN_POSITIVE..=90.0),
        ("steep_height", height, 0.0..=10_000.0),
    ];
    if let Some((name, value, range)) = ranges.iter().find(|(_, value, range)| !range.contains(value)) {
        return Err(parameter(py, format!("{name} is {value}, it must be from {} to {}", range.start(), range.end())));
    }
    let dem = dem.dem(py)?;
    failed(py, check_dem(&dem))?;
    let scale = GroundScale::of(&dem);
    let light = match multidirectional {
        true => ShadeParams::multidirectional(altitude),
        false => ShadeParams { lights: vec![Light { azimuth, altitude, weight: 1.0 }], ..ShadeParams::default() },
    };
    let light = ShadeParams { exaggeration: z_factor, ..light };
    let raster = |quantity, make: &(dyn Fn() -> tokosen::Result<tokosen::raster::Dem> + Sync)| {
        let made = work(py, progress, |progress| {
            progress.start("deriving", 0);
            make()
        })?;
        Ok((Derived::Raster(Raster::new(py, made, None, quantity, &[])?), Vec::new()))
    };
    let memory = tokosen::cli::available_memory();
    match what {
        "slope" => raster(Quantity::Slope, &|| Ok(slope(&dem, &scale))),
        "aspect" => raster(Quantity::Aspect, &|| Ok(aspect(&dem, &scale))),
        "hillshade" => raster(Quantity::Shade, &|| Ok(shade(&dem, &light, &scale))),
        "steep" => {
            let source = interval.map_or(HeightsFrom::HeightMap, |step| HeightsFrom::Contours(Some(step)));
            let note = steep_note(source, height);
            let params = SteepParams { angle, height, memory };
            let layer = work(py, progress, |_| {
                Layer::new(&steep_areas(&steep(&dem, &scale, &params)?, &note), dem.crs.as_ref())
            })?;
            Ok((Derived::Layer(layer), Vec::new()))
        }
        of_water => flow::derive(py, &dem, of_water, &water, progress),
    }
}
