//! What must hold of every surface and of the lines and heights cut from it, whatever it was made of:
//!
//! 1. an input contour comes out vertex for vertex, bit for bit;
//! 2. lines of different levels do not meet, no line crosses itself;
//! 3. a line's elevation is exactly its level;
//! 4. every height lies in the band of its sub-domain;
//! 5. new lines end at the frame, or on an input line of their level that does not divide the ground.
#![allow(dead_code, unused_imports, reason = "every test uses its own part of this module")]

mod refusal;

use std::collections::HashSet;

use glam::DVec2;
pub use refusal::{Refusal, Tally};
use tokosen::base::Grid;
use tokosen::base::error::Result;
use tokosen::clean::validate;
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::Target;
use tokosen::contour::{Contour, ContourLayer, ContourMap, Source};
use tokosen::layers::{LayerParams, contour_layers};
use tokosen::mesh::{MeshParams, mesh};
use tokosen::resample::{FitParams, SampleParams, fit, sample};
use tokosen::subdomains::{Band, landforms};
use tokosen::surface::{Given, Surface, SurfaceParams, build, heights};
use tokosen::tin::VertexKind;

use crate::common;

/// A map of lines with their elevations.
pub fn map_of(lines: &[(f64, Vec<DVec2>)]) -> ContourMap {
    let contours = lines.iter().enumerate().map(|(i, (elevation, points))| Contour {
        elevation: *elevation,
        points: points.clone(),
        feature: (i as u64).into(),
    });
    ContourMap { contours: contours.collect(), ..ContourMap::default() }
}

/// A map made sound.
pub fn clean_map(map: ContourMap) -> ContourMap {
    clean(map, &CleanParams::default()).expect("the terrain's contours are no heap of crossings").value
}

/// The lines at all multiples of `step`.
pub fn layer_of(surface: &Surface, step: f64) -> ContourLayer {
    let targets = vec![Target::Interval { step, base: 0.0 }];
    let params = LayerParams { targets, keep_input: true, ..LayerParams::default() };
    contour_layers(surface, &params, &()).expect("the step is sound").remove(0)
}

/// Elevations and points of lines.
pub fn pairs(layer: &ContourLayer) -> Vec<(f64, Vec<DVec2>)> {
    layer.lines.iter().map(|l| (l.elevation, l.points.clone())).collect()
}

/// A point as a key.
pub fn bits(p: DVec2) -> [u64; 2] {
    [p.x.to_bits(), p.y.to_bits()]
}

/// All that must hold for a surface and the lines cut from it. Gives the number of new lines that were checked.
pub fn check(map: &ContourMap, surface: &Surface, step: f64, what: &str) -> usize {
    surface.tin.validate().unwrap_or_else(|e| panic!("{what}: {e}"));
    let layer = layer_of(surface, step);

    // 1 and 3: input lines in the order of the map's, forward or backward.
    let kept: Vec<_> = layer.lines.iter().filter(|l| l.source == Source::Input).collect();
    let mut wanted: Vec<&Contour> = map.contours.iter().collect();
    wanted.sort_by(|a, b| a.elevation.total_cmp(&b.elevation));
    assert_eq!(kept.len(), wanted.len(), "{what}: number of input lines");
    for (line, contour) in kept.iter().zip(wanted) {
        assert_eq!(line.elevation.to_bits(), contour.elevation.to_bits(), "{what}");
        let forward = line.points.iter().map(|p| bits(*p)).eq(contour.points.iter().map(|p| bits(*p)));
        let backward = line.points.iter().rev().map(|p| bits(*p)).eq(contour.points.iter().map(|p| bits(*p)));
        assert!(forward || backward, "{what}: an input line changed");
    }
    let input_levels: HashSet<u64> = map.contours.iter().map(|c| c.elevation.to_bits()).collect();
    for line in layer.lines.iter().filter(|l| l.source == Source::Interpolated) {
        // One that differs from a level of the input by rounding is that, bit for bit.
        let rounding = if input_levels.contains(&line.elevation.to_bits()) { 1e-6 } else { 1e-9 };
        let k = line.elevation / step;
        assert!((k - k.round()).abs() < rounding, "{what}: {} is no level", line.elevation);
    }

    // 2
    let lines = pairs(&layer);
    let bad = common::crossings(&lines);
    assert!(bad.is_empty(), "{what}: {} crossings, the first: {}", bad.len(), bad[0]);
    let new: Vec<_> = layer
        .lines
        .iter()
        .filter(|l| l.source == Source::Interpolated && !input_levels.contains(&l.elevation.to_bits()))
        .map(|l| (l.elevation, l.points.clone()))
        .collect();
    let bad = common::same_level_crossings(&new);
    assert!(bad.is_empty(), "{what}: {} crossings of one level, the first: {}", bad.len(), bad[0]);

    // 4
    let tin = &surface.tin;
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let band = surface.regions.region(t).expect("inside triangles have a region").band;
        for v in tin.triangles[t as usize] {
            let height = tin.heights[v as usize];
            let (kind, place) = (tin.kinds[v as usize], tin.point(v).truncate());
            assert!(band.contains(height), "{what}: {height} of a {kind:?} at {place} is not in {band:?}");
            let is_water = band.lo == band.hi;
            if tin.kinds[v as usize] == VertexKind::Axis && !is_water {
                assert!(band.lo < height && height < band.hi, "{what}: {height} is on the edge of {band:?}");
            }
        }
    }

    // 5
    let frame: Vec<[DVec2; 2]> = surface.frame.edges().collect();
    let tolerance = rounding(surface);
    let is_on = |end: DVec2, line: &[DVec2]| line.windows(2).any(|w| distance(end, w[0], w[1]) <= tolerance);
    for line in layer.lines.iter().filter(|l| l.source == Source::Interpolated && !l.is_closed()) {
        for end in [line.points[0], line.points[line.points.len() - 1]] {
            let at_frame = frame.iter().any(|edge| is_on(end, edge));
            // At a vertex of it, or at one that a shore added to it, which lies on it but for rounding.
            let at_input = || kept.iter().any(|l| l.elevation == line.elevation && is_on(end, &l.points));
            assert!(at_frame || at_input(), "{what}: a line of level {} ends in the open at {end}", line.elevation);
        }
    }
    lines.len() - kept.len()
}

fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t)
}

/// How far a place may be off by rounding. Coordinates have so many digits: on a small map far from zero that is more than
/// a share of its size.
fn rounding(surface: &Surface) -> f64 {
    let (lo, hi) = extent(surface);
    2e-9 * surface.frame.diagonal() + 4.0 * f64::EPSILON * lo.abs().max(hi.abs()).max_element()
}

/// The box around the frame.
fn extent(surface: &Surface) -> (DVec2, DVec2) {
    let points = surface.frame.rings().flatten();
    points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

/// Heights on a grid over the whole frame, which must be those of some band; and wherever a cell centre lies in a triangle,
/// one of its sub-domain's. A frame narrower than a cell may hold no centre at all.
pub fn check_dem(surface: &Surface, cell: f64, what: &str) {
    let (lo, hi) = extent(surface);
    let size = ((hi - lo) / cell).ceil();
    let corner = DVec2::new(lo.x, hi.y);
    let grid = Grid { corner, cell: DVec2::splat(cell), cols: size.x as usize, rows: size.y as usize };
    let dem = heights(surface, &grid, &());
    let within = |band: Band, height: f32| (band.lo as f32..=band.hi as f32).contains(&height);
    let bands = surface.regions.regions.iter().map(|r| r.band);
    let (lowest, highest) = bands.fold((f64::INFINITY, f64::NEG_INFINITY), |m, b| (m.0.min(b.lo), m.1.max(b.hi)));
    let all = Band { lo: lowest, hi: highest };
    assert!(dem.values.iter().all(|&v| v.is_nan() || within(all, v)), "{what}: a height is out of range");

    let tin = &surface.tin;
    // What lies on an edge but for rounding may be taken for either side of it.
    let margin = rounding(surface);
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let band = surface.regions.region(t).expect("inside triangles have a region").band;
        let corners = tin.corners(t);
        let is_deep = |p: DVec2| {
            let ahead = |i: usize| (corners[i], corners[(i + 1) % 3] - corners[i]);
            (0..3).map(ahead).all(|(from, along)| along.perp_dot(p - from) > margin * along.length())
        };
        let [first, last] = [corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2])]
            .map(|p| (p + tin.origin - corner) / cell);
        for row in (-last.y).max(0.0) as usize..=(-first.y).max(0.0) as usize {
            for col in first.x.max(0.0) as usize..=last.x.max(0.0) as usize {
                if col < grid.cols && row < grid.rows && is_deep(grid.center(col, row) - tin.origin) {
                    let value = dem.values[row * grid.cols + col];
                    assert!(within(band, value), "{what}: {value} at {} is not in {band:?}", grid.center(col, row));
                }
            }
        }
    }
}

/// What is done to the lines of a map before a surface is made of it.
#[derive(Debug, Clone, Default)]
pub struct Lines {
    /// Smooth lines within a tolerance.
    pub fit: Option<FitParams>,
    /// Vertices as dense as the lines around ask.
    pub sample: Option<SampleParams>,
    /// The widest gap that is closed.
    pub snap: f64,
    /// Whether coordinates have digits enough for new lines not to meet by rounding.
    pub is_exact: bool,
}

/// The most levels that are cut.
const LEVELS: f64 = 60.0;
/// Cells of the height map along its longer side.
const CELLS: f64 = 40.0;

/// Runs all steps on a map that may be anything, and asks all guarantees of what comes out.
///
/// # Errors
/// Those of the steps: a map that no surface can be made of is no failure.
pub fn hold(map: ContourMap, lines: &Lines, (given, params): (&Given, &SurfaceParams), what: &str) -> Result<()> {
    let near = CleanParams { snap: lines.snap, ..CleanParams::default() };
    let mut map = clean(map, &near)?.value;
    validate(&map, &near).unwrap_or_else(|e| panic!("{what}: what clean makes is not clean: {e}"));
    if let Some(params) = &lines.fit {
        map = fit(map, params, &near)?.value.map;
        validate(&map, &near).unwrap_or_else(|e| panic!("{what}: what fit makes is not clean: {e}"));
    }
    if let Some(params) = &lines.sample {
        map = sample(map, params, &near)?.value.map;
        validate(&map, &near).unwrap_or_else(|e| panic!("{what}: what sample makes is not clean: {e}"));
    }
    let surface = build(map, given, params, &())?.value;
    let levels = surface.map.contours.iter().map(|c| c.elevation);
    let (low, high) = levels.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), l| (lo.min(l), hi.max(l)));
    let step = (surface.interval.step / 5.0).max((high - low) / LEVELS);
    if lines.is_exact {
        check(&surface.map, &surface, step, what);
    } else {
        surface.tin.validate().unwrap_or_else(|e| panic!("{what}: {e}"));
        layer_of(&surface, step);
    }
    let (lo, hi) = extent(&surface);
    let cell = (hi - lo).max_element() / CELLS;
    if cell > 0.0 && cell.is_finite() {
        check_dem(&surface, cell, what);
    }
    let forms = landforms(&surface.tin, &surface.regions);
    assert_eq!(forms.len(), surface.regions.regions.len(), "{what}: a landform a sub-domain");
    // A frame so narrow that no triangle fits in has no mesh.
    if (0..surface.tin.len() as u32).any(|t| surface.tin.is_inside(t)) {
        let sound = |base| {
            let mesh = mesh(&surface, None, &MeshParams { base, ..MeshParams::default() })
                .unwrap_or_else(|e| panic!("{what}: {e}"));
            mesh.validate().unwrap_or_else(|e| panic!("{what}: {e}"));
            mesh.extent().0.z
        };
        let lowest = sound(None);
        // Ground so low that a kilometre less is the same number has no base below it.
        if low - 1e3 < lowest {
            sound(Some(low - 1e3));
        }
    }
    Ok(())
}
