//! Map layers: the contours of the input as they are, and new contours between them.

use std::collections::{HashMap, HashSet};

use glam::DVec2;
use rayon::prelude::*;

use crate::base::bits::bits;
use crate::base::error::{Error, Result};
use crate::base::memory;
use crate::base::progress::Progress;
use crate::base::{ElevationUnit, parallel};
use crate::contour::{ContourLayer, ContourLine, ContourMap, LineError, Source, Target};
use crate::slice::{Bends, Simplification, as_given, ascends_right, signed_area, slice};
use crate::subdomains::MapExtent;
use crate::surface::Surface;
use crate::tin::Tin;
use crate::validate::line_error;

/// Largest distance between a new contour and its simplified course, as a share of the mean spacing of the contours. A
/// hundredth is far less than the error of the line: a tenth of the spacing or more.
pub const SIMPLIFIED: f64 = 0.01;

/// Bytes of memory per vertex of a new contour: while it is traced, in its layer, and while the layer is written.
const BYTES_PER_VERTEX: f64 = 64.0;

/// Parameters of [`contour_layers`].
#[derive(Debug, Clone, PartialEq)]
pub struct LayerParams {
    /// The levels of each layer.
    pub targets: Vec<Target>,
    /// The unit of these levels. The lines have their elevations in metres all the same.
    pub unit: ElevationUnit,
    /// One level in so many is an index contour, counted from the base; 0 for none.
    pub index_every: u32,
    /// Largest distance between a new contour and its simplified course, map units; 0 keeps all vertices. If `None`,
    /// [`SIMPLIFIED`] times the mean spacing of the contours.
    pub simplify: Option<f64>,
    /// Whether a layer at a coarser interval than that of the input has the contours of the input at all levels. Without
    /// it, such a layer has only its own levels.
    pub keep_input: bool,
    /// Memory that the layers may take, bytes. Layers that need more are an error. No limit if `None`.
    pub memory: Option<u64>,
}

impl Default for LayerParams {
    /// No targets, levels in metres, every fifth level an index contour, lines simplified, no limit of memory.
    fn default() -> Self {
        Self {
            targets: Vec::new(),
            unit: ElevationUnit::Metre,
            index_every: 5,
            simplify: None,
            keep_input: false,
            memory: None,
        }
    }
}

/// Whether a map has contours at all levels of the targets from its lowest level to its highest. Then lines are new only where
/// contours are missing.
///
/// # Errors
/// When the levels of a target are out of range (see [`Target::levels`]).
pub fn are_given(map: &ContourMap, targets: &[Target], unit: ElevationUnit) -> Result<bool> {
    let given = levels_of(map);
    let [Some(&lowest), Some(&highest)] = [given.first(), given.last()] else { return Ok(false) };
    for target in targets {
        let levels = target.levels(unit, lowest, highest)?;
        if !levels.into_iter().all(|level| given.contains(&as_given(&given, level))) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The levels of a map, ascending.
fn levels_of(map: &ContourMap) -> Vec<f64> {
    let mut levels: Vec<f64> = map.contours.iter().map(|c| c.elevation).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    levels
}

/// The contour lines of each target: the input contours unchanged, and new contours at the other levels.
///
/// * All input contours are in a layer, unless its interval is coarser than theirs: then those at its levels
///   ([`LayerParams::keep_input`]).
/// * A level of the input is not traced again where the input contours are complete.
/// * Where such a contour ends inside the map, a new line goes on from its end. A gap closure is a line too.
/// * New lines that would run into a closed contour of their own level are left out and counted (dead ends).
/// * Lines are ordered by elevation, input before interpolated.
/// * Lines have an expected error if the surface has one.
///
/// Long because all targets share one trace of their levels, and then take their own lines from it.
///
/// # Errors
/// When the levels of a target or the tolerance are out of range (see [`Target::levels`]), when there is no target, or when the layers
/// need more memory than they may take.
pub fn contour_layers(surface: &Surface, params: &LayerParams, progress: &dyn Progress) -> Result<Vec<ContourLayer>> {
    let map = &surface.map;
    let bands = || surface.regions.regions.iter().map(|r| r.band);
    let lowest = bands().map(|b| b.lo).filter(|l| l.is_finite()).fold(f64::INFINITY, f64::min);
    let highest = bands().map(|b| b.hi).filter(|h| h.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    if params.targets.is_empty() {
        return Err(Error::Parameter("no interval and no levels are given".into()));
    }
    let given = levels_of(map);
    let wanted: Vec<Vec<f64>> = params
        .targets
        .iter()
        .map(|t| Ok(t.levels(params.unit, lowest, highest)?.into_iter().map(|l| as_given(&given, l)).collect()))
        .collect::<Result<_>>()?;
    let mut levels: Vec<f64> = wanted.iter().flatten().copied().collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let crossings = crossings(&surface.tin, &levels);
    let what = format!("new contours at {} levels with about {crossings:.0} vertices", levels.len());
    let remedy = "choose a larger interval, or fewer levels, or a smaller frame";
    memory::check(BYTES_PER_VERTEX * crossings, params.memory, what, remedy)?;
    let spacing = || MapExtent::new(map, &surface.frame, surface.interval).spacing;
    let tolerance = params.simplify.unwrap_or_else(|| SIMPLIFIED * spacing());
    if !(tolerance.is_finite() && tolerance >= 0.0) {
        return Err(Error::out_of_range("tolerance of simplified lines", tolerance, "0 or more"));
    }
    let bends = surface.working.as_ref().map(|working| Bends::new(&surface.tin, working));
    let simplification = Simplification { tolerance };
    let traced = slice(&surface.tin, &surface.regions, &levels, simplification, bends.as_ref(), progress);
    let mut rings: HashMap<u64, HashSet<[u64; 2]>> = HashMap::new();
    for ring in map.contours.iter().filter(|c| c.is_closed()) {
        let is_traced = |k: usize| !traced[k].lines.is_empty();
        if levels.binary_search_by(|l| l.total_cmp(&ring.elevation)).is_ok_and(is_traced) {
            rings.entry(ring.elevation.to_bits()).or_default().extend(ring.points.iter().map(|&p| bits(p)));
        }
    }
    let right = ascends_right(map, &surface.tin, &surface.regions);
    let layers = params.targets.iter().zip(&wanted).map(|(target, wanted)| {
        let index = |level: f64| target.is_index(surface.interval.step, params.unit, params.index_every, level);
        let is_coarser = !params.keep_input && target.is_coarser(params.unit, surface.interval.step);
        let is_kept = |level: f64| !is_coarser || wanted.contains(&level);
        let input = map.contours.par_iter().zip(&right).filter(|(c, _)| is_kept(c.elevation)).map(|(c, &right)| {
            let mut points = c.points.clone();
            if !right {
                points.reverse();
            }
            line(c.elevation, points, Source::Input, index(c.elevation))
        });
        let mut lines: Vec<ContourLine> = input.collect();
        let (mut artefact_rings, mut dead_ends) = (0, 0);
        for level in wanted {
            let Ok(k) = levels.binary_search_by(|l| l.total_cmp(level)) else { continue };
            let closures = surface.closures.iter().filter(|(l, _)| l == level);
            lines.extend(closures.map(|(l, ends)| line(*l, ends.to_vec(), Source::Interpolated, index(*l))));
            artefact_rings += traced[k].artefact_rings;
            let ring = rings.get(&level.to_bits());
            let is_on_ring = |p: DVec2| ring.is_some_and(|vertices| vertices.contains(&bits(p)));
            let is_dead_end = |points: &&Vec<DVec2>| {
                let (first, last) = (points[0], points[points.len() - 1]);
                first != last && (is_on_ring(first) || is_on_ring(last))
            };
            dead_ends += traced[k].lines.iter().filter(is_dead_end).count();
            let whole = traced[k].lines.iter().filter(|points| !is_dead_end(points));
            lines.extend(whole.map(|p| line(*level, p.clone(), Source::Interpolated, index(*level))));
        }
        lines.sort_by(|a, b| a.elevation.total_cmp(&b.elevation));
        if let Some(field) = &surface.errors {
            parallel::update(&mut lines, |_, line| {
                line.expected = match line.source {
                    Source::Input => Some(LineError { vertical: 0.0, horizontal: 0.0, inferred: false }),
                    Source::Interpolated | Source::HeightMap => line_error(field, &line.points),
                };
            });
        }
        ContourLayer { name: target.layer_name(params.unit), lines, artefact_rings, dead_ends }
    });
    Ok(layers.collect())
}

/// How often levels cross triangles. This is about the number of vertices of their lines.
fn crossings(tin: &Tin, levels: &[f64]) -> f64 {
    let through = |t: u32| {
        let heights = tin.corner_heights(t);
        let lo = heights.into_iter().fold(f64::INFINITY, f64::min);
        let hi = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
        levels.partition_point(|&l| l <= hi).saturating_sub(levels.partition_point(|&l| l <= lo))
    };
    tin.flat_map_inside(|t| Some(through(t))).into_iter().sum::<usize>() as f64
}

fn line(elevation: f64, points: Vec<DVec2>, source: Source, index: bool) -> ContourLine {
    let mut line = ContourLine { elevation, points, source, index, kind: None, depression: false, expected: None };
    // Higher ground is on the right. So it lies outside a counter-clockwise ring.
    line.depression = line.is_closed() && signed_area(&line.points) > 0.0;
    line
}
