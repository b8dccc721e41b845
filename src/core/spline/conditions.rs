//! What the smooth surface on a grid has to meet, whatever the hyper-parameters are.

use glam::{DVec2, DVec3};

use super::curvature_gain;
use super::density::contour_density;
use super::fold::Fold;
use super::lattice::{Crossing, CrossingKind, Lattice};
use super::shrinkage::{HalfWay, Relative};
use super::wide::WidePlaces;
use crate::base::{Grid, KnownLine, Sure, parallel};
use crate::contour::SoftSpot;
use crate::drain::{Drain, Placed, Sink, mark_sinks};
use crate::streams::Stream;
use crate::tin::Tin;
use crate::tuning::SplineTuning;

/// What the smooth surface on a grid has to meet. Arrays have one value per node, row by row from the north-west. NaN
/// marks nodes outside the frame.
pub struct Conditions<'a> {
    /// The working grid. The centres of its cells are the nodes.
    pub grid: Grid,
    /// The triangulation with ridge and canyon lines.
    pub tin: &'a Tin,
    /// The triangle that each node lies in, [`NONE`](crate::tin::NONE) outside the frame.
    pub triangles: Vec<u32>,
    /// The levels of the contours at the vertices of the triangulation, metres; NaN at other vertices, and on contours whose
    /// elevations are wrong.
    pub levels: Vec<f32>,
    /// Level (metres) and vertices (map coordinates) of the contours.
    pub contours: Vec<(f64, &'a [DVec2])>,
    /// Spot heights: map position and height, metres.
    pub spots: Vec<DVec3>,
    /// Spot heights with a standard error. The surface comes near them.
    pub soft_spots: &'a [SoftSpot],
    /// Lines across which the surface may bend sharply, map coordinates.
    pub creases: Vec<(Fold, Vec<DVec2>)>,
    /// Contour interval, metres.
    pub interval: f64,
    /// Mean spacing of neighbouring contours, map units.
    pub spacing: f64,
    /// Lowest and highest height that each node may have, metres.
    pub bounds: [Vec<f32>; 2],
    /// Heights of the reference surface, metres. The tension draws the slopes of the smooth surface towards its slopes.
    pub reference: Vec<f32>,
    /// Whether water may stay at a node.
    pub hollows: Vec<bool>,
    /// Cliffs, map coordinates.
    pub cliffs: &'a [Vec<DVec2>],
    /// Whether a node is so near to a cliff that the ground on its own side alone counts; empty without cliffs.
    pub beside_cliffs: Vec<bool>,
    /// Lines with heights, such as streams and break lines.
    pub known: Vec<KnownLine<'a>>,
    /// Streams: the ground along them gains no curvature.
    pub streams: &'a [Stream],
    /// What happens to pits.
    pub drainage: Drainage<'a>,
}

/// What happens to pits of the smooth surface.
#[derive(Debug, Clone, Copy, Default)]
pub struct Drainage<'a> {
    /// Which pits get a way out. The solution treats [`Drain::All`] as [`Drain::Safe`].
    pub drain: Drain,
    /// Where water may stay, map coordinates.
    pub sinks: &'a [Sink],
}

impl Drainage<'_> {
    /// Whether nodes lie in sinks, for pits as the heights have them now. Empty without sinks.
    pub(super) fn given(&self, grid: &Grid, heights: &[f32]) -> Vec<bool> {
        if self.sinks.is_empty() {
            return Vec::new();
        }
        let mut given = vec![false; heights.len()];
        mark_sinks(heights, &Placed { grid, to_map: &Some, from_map: &Some }, self.sinks, &mut given);
        given
    }
}

impl Conditions<'_> {
    /// Curvature gain at each node ([`curvature_gain::unit_gain`]), for a standard error of one metre half-way between
    /// contours, and the [relative variance](Relative) there.
    pub fn unit_curvature_gain(&self, heights: &[f32], tuning: &SplineTuning) -> [Vec<f32>; 2] {
        let Conditions { grid, spacing, interval, bounds: [lo, hi], reference, .. } = self;
        let lattice = Lattice::of_grid(grid);
        let contour_density = contour_density(reference, grid, *spacing, *interval, tuning.density_rounds);
        let spots = self.surveyed();
        let relative = Relative::new(heights, &contour_density, *spacing, &lattice, &tuning.shrinkage);
        let at_nodes = relative.variance.clone();
        let half_way = HalfWay { error: 1.0, relative: 0.0 };
        let density = (contour_density.as_slice(), *spacing);
        let variances = relative.variances(half_way, heights, density, &lattice, &spots, &tuning.shrinkage);
        let wide = WidePlaces::new(&contour_density, lo, grid.cols, &tuning.wide).share;
        let gain = curvature_gain::unit_gain(
            heights,
            [lo, hi],
            (&variances, &wide),
            *spacing,
            &lattice,
            *interval,
            &tuning.gain,
        );
        [gain, at_nodes]
    }

    /// Spot heights as crossings of the edges between nodes.
    pub(super) fn spot_crossings(&self) -> Vec<(Crossing, f64)> {
        spot_crossings(&self.spots, &Lattice::of_grid(&self.grid), &self.reference)
    }

    /// Spot heights and surveyed lines, as crossings of the edges between nodes.
    pub(super) fn surveyed(&self) -> Vec<(Crossing, f64)> {
        let lattice = Lattice::of_grid(&self.grid);
        let mut found = self.spot_crossings();
        let lines = self.known.iter().flat_map(|line| line_crossings(*line, Sure::Surveyed, 0.0, &lattice));
        found.extend(lines.flatten());
        found
    }
}

/// The crossings of each contour (level and vertices) with eastward and with southward edges of a lattice, with its level.
pub(super) fn contour_crossings(contours: &[(f64, &[DVec2])], lattice: &Lattice) -> [Vec<Vec<(Crossing, f64)>>; 2] {
    let crossings = |&(level, points): &(f64, &[DVec2])| {
        let (mut east, mut south) = (Vec::new(), Vec::new());
        lattice.cross(points, |c| east.push((c, level)), |c| south.push((c, level)));
        (east, south)
    };
    let (east, south) = parallel::map_each(contours, crossings).into_iter().unzip();
    [east, south]
}

/// The crossings of a line with eastward and with southward edges of a lattice, with the heights of the line there.
/// Only where they are at least as sure as `least`. What is known only from contours counts on ways of at least `reach`
/// (map units) from one contour to the next.
pub(super) fn line_crossings(
    line: KnownLine<'_>,
    least: Sure,
    reach: f64,
    lattice: &Lattice,
) -> [Vec<(Crossing, f64)>; 2] {
    let (mut east, mut south) = (Vec::new(), Vec::new());
    let lengths = ways_between_contours(line);
    let sure = line.sure.windows(2).map(|w| w[0].min(w[1]));
    for ((w, sure), length) in line.points.windows(2).zip(sure).zip(lengths) {
        if sure < least || sure == Sure::Between && length < reach {
            continue;
        }
        let (a, b) = (w[0].truncate(), w[1].truncate());
        let height = |crossing: Crossing, step: DVec2| {
            let node = crossing.node as usize;
            let at = DVec2::new((node % lattice.cols) as f64, (node / lattice.cols) as f64) + crossing.along * step;
            let at = lattice.first + at * lattice.step * DVec2::new(1.0, -1.0);
            let share = ((at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            (crossing, w[0].z + share * (w[1].z - w[0].z))
        };
        lattice.cross(&[a, b], |c| east.push(height(c, DVec2::X)), |c| south.push(height(c, DVec2::Y)));
    }
    [east, south]
}

/// For each segment of a line: the length of the way that it is part of, between two contours or to an end, map units.
fn ways_between_contours(line: KnownLine<'_>) -> Vec<f64> {
    let lengths: Vec<f64> = line.points.windows(2).map(|w| w[0].truncate().distance(w[1].truncate())).collect();
    let mut found = Vec::with_capacity(lengths.len());
    let is_contour = |vertex: usize| line.sure.get(vertex) == Some(&Sure::Exact);
    let mut first = 0;
    for end in 1..=lengths.len() {
        if end == lengths.len() || is_contour(end) {
            let length: f64 = lengths[first..end].iter().sum();
            found.resize(end, length);
            first = end;
        }
    }
    found
}

/// Spot heights as crossings. The slope of the reference surface carries each height to the edges north and south of
/// it.
pub(super) fn spot_crossings(spots: &[DVec3], lattice: &Lattice, reference: &[f32]) -> Vec<(Crossing, f64)> {
    let mut found = Vec::new();
    for spot in spots {
        let place = lattice.place(spot.truncate());
        let (col, row) = (place.x.floor(), place.y.floor());
        if col < 0.0 || row < 0.0 || col as usize + 1 >= lattice.cols || row as usize + 1 >= lattice.rows {
            continue;
        }
        let (u, v) = (place.x - col, place.y - row);
        let node = row as usize * lattice.cols + col as usize;
        let below = node + lattice.cols;
        let g = |n: usize| f64::from(reference[n]);
        let north = g(node) * (1.0 - u) + g(node + 1) * u;
        let south = g(below) * (1.0 - u) + g(below + 1) * u;
        let here = north * (1.0 - v) + south * v;
        if here.is_finite() {
            // The reference surface passes through the spot. Its slope carries the height to the edges north and south.
            found.push((Crossing { node: node as u32, along: u, kind: CrossingKind::Chord }, spot.z + north - here));
            found.push((Crossing { node: below as u32, along: u, kind: CrossingKind::Chord }, spot.z + south - here));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_of_lines_between_contours_count_on_long_ways_from_one_to_the_next() {
        let lattice = Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols: 12, rows: 3 };
        let points: Vec<DVec3> = (0..=10).map(|k| DVec3::new(f64::from(k) + 0.5, -0.5, 20.0 - f64::from(k))).collect();
        let crossings = |sure: Sure, reach: f64| {
            let sure = vec![sure; points.len()];
            let [east, south] = line_crossings(
                KnownLine { points: &points, is_stream: false, sure: &sure },
                Sure::Between,
                reach,
                &lattice,
            );
            assert!(east.is_empty() && south.iter().all(|(c, z)| (z - (20.5 - f64::from(c.node))).abs() < 1e-9));
            south.len()
        };
        assert_eq!([crossings(Sure::Between, 10.0), crossings(Sure::Between, 11.0)], [10, 0]);
        assert_eq!([crossings(Sure::Surveyed, 11.0), crossings(Sure::Guessed, 0.0)], [10, 0]);
    }
}
