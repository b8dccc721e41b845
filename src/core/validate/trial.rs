//! A part of a map with every second level hidden, and the residuals of a surface from the other levels at the hidden
//! ones.

use glam::DVec2;
use rayon::prelude::*;
use rstar::RTree;

use super::builder::TrialParams;
use crate::base::{Grid, parallel};
use crate::contour::{Contour, ContourMap, Interval, clip};
use crate::geometry::tolerance;
use crate::skeleton::SkeletonLine;
use crate::spline::{HyperParameters, Wanted, WorkingGrid, slopes, spline, working_grid};
use crate::subdivision::{Subdivision, subdivide};
use crate::subdomains::Frame;
use crate::subdomains::MapExtent;
use crate::tin::NONE;
use crate::tuning::TrialTuning;

/// Largest number of nodes of a trial's grid. It limits time. The other levels may lie in a sliver of the map, whose
/// mean spacing asks for very small cells.
const MOST_TRIAL_NODES: usize = 1_500_000;
/// Places nearer to a mended place than this many spacings are left out: the first number of which enough places stay.
const MENDED_REACH: [f64; 2] = [3.0, 1.0];
/// Tolerance of rounding: the contour interval may differ from twice the map's by this share.
const INTERVAL_SHARE: f64 = 1e-3;

/// A part of a map with some of its levels hidden.
pub struct Trial {
    /// The map of the other levels, with ridge and canyon lines.
    pub subdivision: Subdivision,
    /// Its ridge and canyon lines.
    pub skeleton_lines: Vec<SkeletonLine>,
    /// Places on hidden contours, whose level is known.
    pub places: Vec<HiddenPlace>,
    /// The working grid.
    pub grid: Grid,
}

/// The middle of a segment of a hidden contour.
pub struct HiddenPlace {
    /// Map position.
    pub at: DVec2,
    /// Elevation of the hidden contour.
    pub level: f64,
    /// Length of the segment, map units.
    pub length: f64,
}

/// The levels that a trial keeps: one in so many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LevelSubset {
    /// One level in so many is kept.
    pub every: i64,
    /// Which one, 0 to `every - 1`.
    pub phase: i64,
}

/// The residual of a surface at a place on a hidden contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialResidual {
    /// Height of the surface above the contour, metres.
    pub by: f64,
    /// Area of the ground that the place stands for, square map units.
    pub weight: f64,
    /// Curvature gain at the place, for a standard error of one metre half-way between contours
    /// ([`unit_gain`](crate::spline::curvature_gain::unit_gain)).
    pub unit_gain: f64,
    /// Relative variance of the surface at the place.
    pub relative_variance: f64,
}

/// The residuals of surfaces with these hyper-parameters at hidden contours. The odd and the even levels are hidden in
/// turn. Parts without a surface are left out.
///
/// The parts are small. So each is one task.
pub fn trials<const N: usize>(
    extent: &MapExtent<'_>,
    params: &TrialParams<'_>,
    hyper_parameters: [HyperParameters; N],
) -> [Vec<TrialResidual>; N] {
    let cell = cell(extent, params, 2);
    let mut parts = parts(extent, params, cell);
    let shortest = params.tuning.trials.min_ring_cells * cell;
    for (map, _) in &mut parts {
        // Level ground may have many knolls. Their few vertices would decide the shape of the surface around.
        map.contours.retain(|c| !(c.is_closed() && c.length() < shortest));
    }
    let both: Vec<_> = parts.iter().flat_map(|(map, frame)| [0, 1].map(|phase| (map, frame, phase))).collect();
    let residuals = both.into_par_iter().filter_map(|(map, frame, phase)| {
        let kept = LevelSubset { every: 2, phase };
        Some(trial((map, frame), kept, extent.interval, cell, params)?.residuals(hyper_parameters, params))
    });
    let each: Vec<[Vec<TrialResidual>; N]> = residuals.collect();
    std::array::from_fn(|k| each.iter().flat_map(|residuals| residuals[k].iter().copied()).collect())
}

/// Size of the cells of a trial that keeps one level in `every`, map units.
///
/// Contours twice as far apart need cells twice as large. Cells are larger still where the grid is finer than the
/// contours need.
pub fn cell(extent: &MapExtent<'_>, params: &TrialParams<'_>, every: i64) -> f64 {
    let tuning = &params.tuning;
    let cell = working_grid(extent, params.wanted, &tuning.spline.grid).cell;
    every as f64 * (cell.x * cell.y).sqrt().max(extent.spacing / tuning.trials.nodes_per_spacing)
}

/// The whole map, or squares of a large one.
pub fn parts(extent: &MapExtent<'_>, params: &TrialParams<'_>, cell: f64) -> Vec<(ContourMap, Frame)> {
    let TrialTuning { whole_map_size, squares: most_squares, square_nodes, square_vertices, .. } = params.tuning.trials;
    let points = || extent.map.contours.iter().flat_map(|c| c.points.iter().copied());
    let (lo, hi) = points().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let size = hi - lo;
    let area = size.x * size.y;
    let vertices = points().count() as f64;
    if area / (cell * cell) <= whole_map_size && vertices <= whole_map_size {
        return vec![(extent.map.clone(), params.frame.clone().in_hull())];
    }
    let side = (square_nodes.sqrt() * cell).min((square_vertices * area / vertices).sqrt());
    let count = (size / side).floor().max(DVec2::ONE);
    let step = size / count;
    // At most as many squares as vertices, however long and narrow the map is.
    let mut in_square = std::collections::BTreeMap::<[u32; 2], usize>::new();
    for p in points() {
        let place = ((p - lo) / step).floor().min(count - 1.0);
        *in_square.entry([place.x as u32, place.y as u32]).or_default() += 1;
    }
    // Squares are ordered by their number of vertices. So level and steep ground are both among the chosen ones.
    let mut squares: Vec<(usize, [u32; 2])> = in_square.into_iter().map(|(at, count)| (count, at)).collect();
    squares.sort_unstable();
    let take = squares.len().min(most_squares);
    let chosen = (0..take).map(|k| squares[(2 * k + 1) * squares.len() / (2 * take)].1);
    chosen.map(|[col, row]| square(extent.map, lo + step * DVec2::new(f64::from(col), f64::from(row)), step)).collect()
}

/// The part of the map in a rectangle.
fn square(map: &ContourMap, lo: DVec2, size: DVec2) -> (ContourMap, Frame) {
    let hi = lo + size;
    let area = geo::Rect::new((lo.x, lo.y), (hi.x, hi.y)).to_polygon().into();
    let margin = 2.0 * tolerance(&area);
    let near = parallel::flat_map_each(&map.contours, |contour| stretches(contour, lo - margin, hi + margin));
    let (spots, mended) = (map.spots.clone(), map.mended.clone());
    let cut = clip(ContourMap { contours: near, spots, mended, ..ContourMap::default() }, &area);
    (cut.map, Frame::PolygonInHull(cut.area))
}

/// The stretches of a contour whose segments come near a rectangle. A ring that comes near it as a whole stays a ring.
fn stretches(contour: &Contour, lo: DVec2, hi: DVec2) -> Vec<Contour> {
    let points = &contour.points;
    let count = points.len().saturating_sub(1);
    let is_near = |k: usize| {
        let (a, b) = (points[k], points[k + 1]);
        a.min(b).cmple(hi).all() && a.max(b).cmpge(lo).all()
    };
    let first_far = (0..count).find(|&k| !is_near(k));
    let Some(first_far) = first_far else { return vec![contour.clone()] };
    let start = if contour.is_closed() { first_far } else { 0 };
    let mut found: Vec<Contour> = Vec::new();
    let mut last = None;
    for (n, k) in (start..start + count).map(|k| k % count).enumerate().filter(|&(_, k)| is_near(k)) {
        match found.last_mut().filter(|_| last == n.checked_sub(1)) {
            Some(stretch) => stretch.points.push(points[k + 1]),
            None => found.push(Contour { points: vec![points[k], points[k + 1]], ..contour.clone() }),
        }
        last = Some(n);
    }
    found
}

/// A part of a map with some levels hidden. `None` if the kept levels give no surface. `interval` is that of the whole
/// map.
pub fn trial(
    (map, frame): (&ContourMap, &Frame),
    kept: LevelSubset,
    interval: Interval,
    cell: f64,
    params: &TrialParams<'_>,
) -> Option<Trial> {
    if params.are_needless() {
        return None;
    }
    let is_kept = |c: &&Contour| interval.index_of(c.elevation).rem_euclid(kept.every) == kept.phase;
    // Auxiliary contours are left out of the map and of the places. They lie where they help most.
    let (known, hidden): (Vec<&Contour>, Vec<&Contour>) =
        map.contours.iter().filter(|c| interval.is_level(c.elevation)).partition(is_kept);
    let places = hidden.iter().flat_map(|c| c.points.windows(2).map(|ends| (c.elevation, ends)));
    let places = places
        .map(|(level, ends)| HiddenPlace { at: (ends[0] + ends[1]) / 2.0, level, length: ends[0].distance(ends[1]) })
        .collect();
    let mended = &map.mended;
    let known = |spacing: f64| ContourMap {
        contours: known.iter().map(|c| with_fewer_vertices(c, spacing)).collect(),
        spots: map.spots.clone(),
        ..ContourMap::default()
    };
    // With fewer vertices, lines that run close to each other may cross.
    let spacings = [cell / params.tuning.trials.vertices_per_cell, 0.0];
    let subdivision = spacings.into_iter().find_map(|spacing| subdivide(known(spacing), frame, &()).ok())?.value;
    if (subdivision.interval.step / (kept.every as f64 * interval.step) - 1.0).abs() > INTERVAL_SHARE {
        return None;
    }
    let places = without_mended(places, mended, subdivision.extent().spacing);
    let (subdivision, skeleton_lines) = params.builder.with_lines(subdivision)?;
    let grid = working_grid(&subdivision.extent(), Some(Wanted::Cell(cell)), &params.tuning.spline.grid);
    if grid.len() > MOST_TRIAL_NODES {
        return None;
    }
    Some(Trial { subdivision, skeleton_lines, places, grid })
}

/// A contour without the vertices that are nearer than `spacing` to the one before, along the contour. Its ends stay.
fn with_fewer_vertices(contour: &Contour, spacing: f64) -> Contour {
    let Some((last, rest)) = contour.points.split_last() else { return contour.clone() };
    let fewest = if contour.is_closed() { 3 } else { 1 };
    let mut points: Vec<DVec2> = Vec::new();
    let (mut along, mut before) = (f64::INFINITY, None);
    for &p in rest {
        along += before.map_or(0.0, |before| p.distance(before));
        before = Some(p);
        if along >= spacing || points.len() < fewest {
            points.push(p);
            along = 0.0;
        }
    }
    points.push(*last);
    Contour { points, ..contour.clone() }
}

/// Places without those that are near a mended place: nearer than three mean spacings of the contours, or than one where that
/// would leave a minority. Residuals at broken lines show nothing about other ground. If one spacing too leaves a minority, all
/// places are kept.
fn without_mended(places: Vec<HiddenPlace>, mended: &[DVec2], spacing: f64) -> Vec<HiddenPlace> {
    let mended = RTree::bulk_load(mended.iter().map(|p| p.to_array()).collect());
    let distance = |place: &HiddenPlace| {
        let nearest = mended.nearest_neighbor(&place.at.to_array());
        nearest.map_or(f64::INFINITY, |m| place.at.distance(DVec2::from_array(*m)))
    };
    let distances: Vec<f64> = parallel::map_each(&places, distance);
    let is_majority = |least: &f64| 2 * distances.iter().filter(|d| *d >= least).count() >= places.len();
    let Some(least) = MENDED_REACH.map(|reach| reach * spacing).into_iter().find(is_majority) else { return places };
    places.into_iter().zip(distances).filter_map(|(place, d)| (d >= least).then_some(place)).collect()
}

impl Trial {
    /// The residuals of surfaces with these hyper-parameters at hidden contours that lie between two levels. All
    /// surfaces have the same places.
    fn residuals<const N: usize>(
        &self,
        hyper_parameters: [HyperParameters; N],
        params: &TrialParams<'_>,
    ) -> [Vec<TrialResidual>; N] {
        let tuning = &params.tuning.spline;
        let [nearest, furthest] = params.tuning.trials.spacing_limits;
        let grid = &self.grid;
        let conditions = params.builder.conditions(&self.subdivision, &self.skeleton_lines, grid);
        let triangles = &conditions.triangles;
        let slopes = slopes(&conditions.reference, grid);
        let spacing = conditions.spacing;
        let asked = |place: &HiddenPlace| {
            let DVec2 { x: col, y: row } = grid.place(place.at);
            let (col, row) = (col.round(), row.round());
            if col < 0.0 || row < 0.0 || col >= grid.cols as f64 || row >= grid.rows as f64 {
                return None;
            }
            let n = row as usize * grid.cols + col as usize;
            let region = if triangles[n] == NONE { None } else { self.subdivision.regions.region(triangles[n]) }?;
            let inside = region.levels.len() == 2 && region.band.lo < place.level && place.level < region.band.hi;
            let local = self.subdivision.interval.step / f64::from(slopes[n]) / spacing;
            let local = if local.is_nan() { 1.0 } else { local.clamp(nearest, furthest) };
            inside.then_some(place.length * local * spacing)
        };
        let weights: Vec<Option<f64>> = self.places.iter().map(asked).collect();
        hyper_parameters.map(|hyper_parameters| {
            if params.are_needless() {
                return Vec::new();
            }
            let surface = spline(&conditions, &hyper_parameters, tuning, &());
            let [unit_gain, relative] = conditions.unit_curvature_gain(&surface.heights, tuning);
            let all = self.places.iter().zip(&weights);
            let residual = |(place, weight): (&HiddenPlace, &Option<f64>)| {
                let by = f64::from(bilinear(&surface, place.at)?) - place.level;
                let [unit_gain, relative_variance] =
                    [&unit_gain, &relative].map(|values| between(grid, values, place.at));
                let (unit_gain, relative_variance) = (f64::from(unit_gain?), f64::from(relative_variance?));
                let weight = weight.filter(|w| *w > 0.0 && by.is_finite())?;
                Some(TrialResidual { by, weight, unit_gain, relative_variance })
            };
            all.filter_map(residual).collect()
        })
    }
}

/// The height at a position, bilinear between four nodes; `None` off the grid.
fn bilinear(surface: &WorkingGrid, p: DVec2) -> Option<f32> {
    between(&surface.grid, &surface.heights, p)
}

/// The value at a position, bilinear between four nodes; `None` off the grid.
pub fn between(grid: &Grid, values: &[f32], p: DVec2) -> Option<f32> {
    let DVec2 { x, y } = grid.place(p);
    if x < 0.0 || y < 0.0 || x >= grid.cols as f64 - 1.0 || y >= grid.rows as f64 - 1.0 {
        return None;
    }
    let (u, v) = (x.fract() as f32, y.fract() as f32);
    let n = y as usize * grid.cols + x as usize;
    let row = |n: usize| values[n] * (1.0 - u) + values[n + 1] * u;
    Some(row(n) * (1.0 - v) + row(n + grid.cols) * v)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::spline::Conditions;
    use crate::tuning::Tuning;
    use crate::validate::SurfaceBuilder;

    struct ContoursAlone;

    impl SurfaceBuilder for ContoursAlone {
        fn with_lines(&self, subdivision: Subdivision) -> Option<(Subdivision, Vec<SkeletonLine>)> {
            Some((subdivision, Vec::new()))
        }

        fn conditions<'a>(&self, _: &'a Subdivision, _: &[SkeletonLine], _: &Grid) -> Conditions<'a> {
            unimplemented!("no smooth surface is drawn here")
        }
    }

    fn line(elevation: f64, points: impl IntoIterator<Item = (f64, f64)>) -> Contour {
        Contour { elevation, points: points.into_iter().map(DVec2::from).collect(), feature: 1.into() }
    }

    #[test]
    fn a_line_keeps_its_ends_and_a_ring_its_shape() {
        let dense = line(10.0, (0..=100).map(|i| (f64::from(i) * 0.1, 0.0)));
        let thin = with_fewer_vertices(&dense, 1.0);
        assert_eq!((thin.points.first(), thin.points.last()), (dense.points.first(), dense.points.last()));
        assert!((10..=12).contains(&thin.points.len()), "{}", thin.points.len());
        assert!(thin.points.iter().all(|p| dense.points.contains(p)));
        assert_eq!(with_fewer_vertices(&dense, 0.0), dense);
        let ring = line(10.0, [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1), (0.0, 0.1), (0.0, 0.0)]);
        let thin = with_fewer_vertices(&ring, 1.0);
        assert!(thin.is_closed() && thin.points.len() == 4, "{:?}", thin.points);
    }

    #[test]
    fn lines_that_would_cross_with_fewer_vertices_keep_all_of_theirs() {
        // Two contours go around the same narrow spur, much closer to each other than a trial's cell is wide.
        let around = |first: f64, off: f64| {
            (0..=800).map(move |i| {
                let x = first + f64::from(i) * 0.05;
                (x, off + 4.0 * (-((x - 20.05) / 0.3).powi(2)).exp())
            })
        };
        let map = ContourMap {
            contours: vec![
                line(0.0, [(0.0, -10.0), (40.0, -10.0)]),
                line(10.0, [(0.0, -5.0), (40.0, -5.0)]),
                line(20.0, around(0.0, 0.0)),
                // This line begins elsewhere. So it keeps other vertices.
                line(40.0, around(1.0, 0.1)),
            ],
            ..ContourMap::default()
        };
        let cell = 10.0;
        let thin = |c: &Contour| with_fewer_vertices(c, cell / 4.0);
        let thinned = ContourMap { contours: map.contours.iter().map(thin).collect(), ..ContourMap::default() };
        assert!(subdivide(thinned, &Frame::Hull, &()).is_err(), "the case must be one where lines come to cross");
        let interval = Interval { step: 10.0, base: 0.0, rounding: 0.0 };
        let kept = LevelSubset { every: 2, phase: 0 };
        let tuning = Tuning::default();
        let params =
            TrialParams { frame: &Frame::Hull, wanted: None, builder: &ContoursAlone, tuning: &tuning, needless: None };
        let trial = trial((&map, &Frame::Hull), kept, interval, cell, &params).expect("all vertices are kept then");
        assert!(trial.subdivision.map.contours.iter().any(|c| c.points.len() > 400));
        assert!(trial.places.iter().all(|p| p.level == 10.0));
        let needless = AtomicBool::new(true);
        let params = TrialParams { needless: Some(&needless), ..params };
        assert!(self::trial((&map, &Frame::Hull), kept, interval, cell, &params).is_none(), "nobody needs it");
    }
}
