//! From coarse to fine: each lattice starts from the solution on one with half as many rows and columns.

use std::borrow::Cow;

use glam::DVec2;

use super::border::carry_on;
use super::cliffs::Walls;
use super::conditions::{Drainage, contour_crossings, line_crossings};
use super::energy::{CrossingWeight, EdgeTerms, Energy};
use super::fold::{Fold, Folds};
use super::inside::Inside;
use super::lattice::{Crossing, Lattice};
use super::minimise::{Effort, Minimiser};
use super::pits::{Limits, breach};
use super::reweight::{near_contours, raise_tension_at_bounds, reweight_bending};
use crate::base::Grid;
use crate::base::progress::Progress;
use crate::base::{KnownLine, Sure, parallel};
use crate::drain::Drain;
use crate::tuning::SplineTuning;

/// Name of this step in reports of progress.
pub const STEP: &str = "smooth surface";

/// The coarsest lattice has at most this many rows and columns. It is one tile, and its steps solve it completely.
const COARSEST: usize = 12;
/// Largest weight of a crossing on coarse lattices, unless it is larger on the finest one. What lies between
/// their nodes is averaged.
const COARSE_CONTOUR_WEIGHT: f64 = 20.0;

/// What the surface has to meet, on the finest lattice. NaN marks nodes outside the frame.
pub struct Problem<'a> {
    /// The finest lattice.
    pub lattice: Lattice,
    /// Level and vertices of the contours.
    pub contours: &'a [(f64, &'a [DVec2])],
    /// Spot heights as crossings with heights.
    pub spots: Vec<(Crossing, f64)>,
    /// Lines across which the surface may bend sharply.
    pub creases: &'a [(Fold, Vec<DVec2>)],
    /// Cliffs.
    pub cliffs: &'a [Vec<DVec2>],
    /// Lines with heights.
    pub known: &'a [KnownLine<'a>],
    /// IRLS threshold across the lines where it may bend, as a share of the threshold elsewhere.
    pub crease_threshold: f64,
    /// Lowest and highest height that each node may have, metres.
    pub bounds: [Cow<'a, [f32]>; 2],
    /// Heights of the reference surface, metres. The tension draws the slopes towards its slopes.
    pub reference: &'a [f32],
    /// Tension at each node, per square of the step eastwards.
    pub tension: Vec<f32>,
    /// How far each node is a wide place, 0 to 1.
    pub wide: Vec<f32>,
    /// Weight of the square at a crossing, against that of a second difference, on the finest lattice.
    pub contour_weight: CrossingWeight,
    /// Contour interval, metres.
    pub interval: f64,
    /// Mean spacing of neighbouring contours, map units.
    pub spacing: f64,
    /// Nodes where water may stay, because the contours show a hollow.
    pub hollows: &'a [bool],
    /// What happens to pits elsewhere.
    pub drainage: Drainage<'a>,
    /// The grid whose cells have their centres at the nodes.
    pub grid: &'a Grid,
    /// The tuned numbers.
    pub tuning: &'a SplineTuning,
}

impl Problem<'_> {
    /// The mean level of the contours, metres.
    fn mean_level(&self) -> f64 {
        let levels = self.contours.iter().map(|c| c.0);
        levels.sum::<f64>() / self.contours.len().max(1) as f64
    }

    /// The crossings of each contour with the eastward and with the southward edges of a lattice, with their heights, and of
    /// each line where its height is at least as sure as `least`.
    pub(super) fn crossings(&self, lattice: &Lattice, least: Sure) -> [Vec<Vec<(Crossing, f64)>>; 2] {
        let [mut east, mut south] = contour_crossings(self.contours, lattice);
        let reach = self.tuning.least_line_nodes * lattice.step.max_element();
        for [of_east, of_south] in self.known.iter().map(|line| line_crossings(*line, least, reach, lattice)) {
            east.push(of_east);
            south.push(of_south);
        }
        [east, south]
    }

    /// Breaches pits where no contour speaks for them and no sink is given, if pits are to be drained at all.
    pub(super) fn breach(&self, heights: &mut [f32], limits: &Limits<'_>) {
        if self.drainage.drain == Drain::None {
            return;
        }
        let given = self.drainage.given(self.grid, heights);
        let stays = |n: usize| self.hollows[n] || given.get(n).is_some_and(|given| *given);
        breach(heights, &self.lattice, limits, stays);
    }
}

/// Values at the nodes of one lattice.
struct Stage<'a> {
    lattice: Lattice,
    /// 0 for the finest lattice, 1 for the next coarser one, and so on.
    depth: i32,
    bounds: [Cow<'a, [f32]>; 2],
    reference: Cow<'a, [f32]>,
    tension: Cow<'a, [f32]>,
    wide: Cow<'a, [f32]>,
}

/// The solution on a lattice.
struct Solved {
    lattice: Lattice,
    z: Vec<f64>,
    /// Factors on the tension.
    factors: Vec<f32>,
}

/// An energy with its first weights. The arrays mark the second differences across lines where the surface may bend.
type Weighed<'a> = (Energy<'a>, Folds);

/// The heights at the nodes of the finest lattice. Those outside the frame are meaningless.
pub fn solve(problem: &Problem<'_>, progress: &dyn Progress) -> Vec<f64> {
    let mut finest = Stage {
        lattice: problem.lattice,
        depth: 0,
        bounds: problem.bounds.each_ref().map(|bound| Cow::Borrowed(&**bound)),
        reference: Cow::Borrowed(problem.reference),
        tension: Cow::Borrowed(&problem.tension),
        wide: Cow::Borrowed(&problem.wide),
    };
    let mut coarser: Vec<Stage<'_>> = std::iter::successors(finest.coarser(), Stage::coarser).collect();
    // Each from its own nodes: what the finest nodes show of a slope does not reach far.
    for stage in coarser.iter_mut().chain([&mut finest]) {
        carry_on(stage.reference.to_mut(), stage.lattice.cols);
    }
    let all: usize = finest.lattice.len() + coarser.iter().map(|s| s.lattice.len()).sum::<usize>();
    progress.start(STEP, all as u64);
    let solved = |stage: &Stage<'_>, energy: Weighed<'_>, before: Option<Solved>| {
        let solved = stage.solve(problem, energy, before);
        progress.advance(stage.lattice.len() as u64);
        solved
    };
    // The coarsest lattices keep only one thread busy. Meanwhile another one prepares the finest, which takes as long.
    let (before, energy) = rayon::join(
        || {
            let stages = coarser.into_iter().rev();
            stages.fold(None, |before, stage| Some(solved(&stage, stage.energy(problem), before)))
        },
        || finest.energy(problem),
    );
    let Solved { z, .. } = solved(&finest, energy, before);
    progress.finish();
    z
}

impl Stage<'_> {
    /// The stage with every second row and column; `None` if there are few already.
    fn coarser(&self) -> Option<Stage<'static>> {
        if self.lattice.cols.max(self.lattice.rows) <= COARSEST {
            return None;
        }
        let lattice = self.lattice.coarser();
        let take = |values: &[f32]| {
            let at = |i: usize, j: usize| {
                let (col, row) = (2 * i, 2 * j);
                let inside = col < self.lattice.cols && row < self.lattice.rows;
                if inside { values[row * self.lattice.cols + col] } else { f32::NAN }
            };
            parallel::cells(lattice.cols, lattice.rows, at)
        };
        // Steps are twice as long. So first differences count four times as much against second ones.
        let tension: Vec<f32> = take(&self.tension).into_iter().map(|t| 4.0 * t).collect();
        let bounds = self.bounds.each_ref().map(|bound| take(bound).into());
        Some(Stage {
            lattice,
            depth: self.depth + 1,
            bounds,
            reference: take(&self.reference).into(),
            tension: tension.into(),
            wide: take(&self.wide).into(),
        })
    }

    /// Index into the arrays of [`SplineTuning`].
    fn kind(&self) -> usize {
        (self.depth as usize).min(2)
    }

    /// Largest number of steps of the first solution. A stage without a coarser lattice to start from takes them all.
    fn steps(&self, problem: &Problem<'_>, has_start: bool) -> usize {
        let step = problem.lattice.step;
        let SplineTuning { steps, steps_on_fine_grids, fine_grid_nodes_per_spacing, .. } = problem.tuning;
        let is_fine = problem.spacing / (step.x * step.y).sqrt() > *fine_grid_nodes_per_spacing;
        (if is_fine && has_start { steps_on_fine_grids } else { steps })[self.kind()]
    }

    /// Starts from the heights and factors of a coarser lattice and improves them. Without further rounds, the weights
    /// follow the heights of the coarser lattice.
    fn solve(&self, problem: &Problem<'_>, energy: Weighed<'_>, before: Option<Solved>) -> Solved {
        let tuning = problem.tuning;
        let [lo, hi] = self.bounds.each_ref().map(|bound| &**bound);
        let (mut energy, folds) = energy;
        let steps = self.steps(problem, before.is_some());
        // A lattice without a coarser one has nothing to start from. It takes the rounds of the second lattice.
        let rounds = tuning.reweighting_rounds[if before.is_none() { 1 } else { self.kind() }];
        let (mut z, mut factors) = match before {
            None => (vec![problem.mean_level(); self.lattice.len()], vec![1.0; self.lattice.len()]),
            Some(Solved { lattice, z, factors }) => {
                let mut z = refined(&z, &lattice, &self.lattice);
                Walls::new(problem.cliffs, &self.lattice).iter().for_each(|walls| walls.mend(&mut z));
                (z, spread(&factors, &lattice, &self.lattice))
            }
        };
        let effort = Effort { steps, tolerance: tuning.convergence * problem.interval };
        let later = Effort { steps: tuning.further_steps[self.kind()], ..effort };
        // Later rounds start from these weights. The finest lattice has no later rounds; there, the copies would take
        // much of the memory.
        let first = (rounds > 0).then(|| (energy.bending.clone(), energy.tension.clone(), near_contours(&energy)));
        scale(&mut energy, &factors);
        if first.is_none() {
            reweight_bending(&mut energy, &folds, tuning, problem.crease_threshold, &z);
        }
        let mut minimiser = Minimiser::default();
        minimiser.minimise(&energy, lo, hi, &mut z, effort);
        for (bending, tension, near_contours) in first.iter().cycle().take(rounds) {
            energy.bending.clone_from(bending);
            reweight_bending(&mut energy, &folds, tuning, problem.crease_threshold, &z);
            raise_tension_at_bounds(
                &mut factors,
                near_contours,
                [lo, hi],
                &z,
                self.lattice.cols,
                problem.interval,
                tuning,
            );
            energy.tension.clone_from(tension);
            scale(&mut energy, &factors);
            minimiser.minimise(&energy, lo, hi, &mut z, later);
        }
        if self.depth == 0 {
            let upper = self.breached_bounds(problem, [lo, hi], &z);
            minimiser.minimise(&energy, lo, &upper, &mut z, later);
        }
        Solved { lattice: self.lattice, z, factors }
    }

    /// Upper bounds with breached pits. Ground beside a cut then falls towards it.
    fn breached_bounds(&self, problem: &Problem<'_>, [lo, hi]: [&[f32]; 2], z: &[f64]) -> Vec<f32> {
        let mut after: Vec<f32> = parallel::values(z.len(), |n| if lo[n].is_nan() { f32::NAN } else { z[n] as f32 });
        let limits = Limits { lo, depth: problem.interval as f32 };
        problem.breach(&mut after, &limits);
        parallel::values(z.len(), |n| if after[n] < z[n] as f32 { hi[n].min(after[n]).max(lo[n]) } else { hi[n] })
    }

    /// The energy with its first weights, and the second differences across lines where the surface may bend.
    ///
    /// Long because the weights of bending and tension share what is inside, on a crease, and the step ratio.
    fn energy(&self, problem: &Problem<'_>) -> Weighed<'_> {
        let lattice = &self.lattice;
        let (cols, rows) = (lattice.cols, lattice.rows);
        let walls = Walls::new(problem.cliffs, lattice);
        let [east, south] = problem.crossings(lattice, Sure::Between);
        let SplineTuning { crease_weight, wide, .. } = *problem.tuning;
        let weight =
            problem.contour_weight.map(|full| (full * 8f64.powi(self.depth)).min(full.max(COARSE_CONTOUR_WEIGHT)));
        let spots: &[(Crossing, f64)] = if self.depth == 0 { &problem.spots } else { &[] };
        // The crossings of a line are freed once they are copied, because all of them together are large.
        let terms = |side: usize, found: Vec<Vec<_>>, more: &[(Crossing, f64)]| {
            let mut all = Vec::with_capacity(found.iter().map(Vec::len).sum::<usize>() + more.len());
            found.into_iter().for_each(|of_line| all.extend(of_line));
            all.extend_from_slice(more);
            if let Some(walls) = &walls {
                all.retain(|(crossing, _)| !walls.is_between(side, crossing.node as usize));
            }
            EdgeTerms::new(&all, weight, lattice)
        };
        let (east, south) = rayon::join(|| terms(0, east, spots), || terms(1, south, &[]));
        let contours = [east, south];

        let mut cut = [vec![Fold::None; lattice.len()], vec![Fold::None; lattice.len()]];
        for (fold, line) in problem.creases {
            let [east, south] = &mut cut;
            let mark = |edges: &mut [Fold], c: Crossing| {
                let edge = &mut edges[c.node as usize];
                *edge = (*edge).max(*fold);
            };
            lattice.cross(line, |c| mark(east, c), |c| mark(south, c));
        }
        let inside = Inside::new(&self.bounds[0], cols);
        // For cells that are not square: second differences count per squared step, the mixed one per product of both
        // steps.
        let ratio = (lattice.step.y / lattice.step.x) as f32;
        let is_bent = |kind: usize, i: usize, j: usize| {
            let n = j * cols + i;
            let is_inside = match kind {
                0 => i > 0 && i + 1 < cols && inside.all(&[n - 1, n, n + 1]),
                1 => j > 0 && j + 1 < rows && inside.all(&[n - cols, n, n + cols]),
                _ => i + 1 < cols && j + 1 < rows && inside.all(&[n, n + 1, n + cols, n + cols + 1]),
            };
            is_inside && walls.as_ref().is_none_or(|walls| !walls.is_among(kind, n))
        };
        let fold = |kind: usize, i: usize, j: usize| {
            let ([east, south], n) = (&cut, j * cols + i);
            let fold = match kind {
                _ if !is_bent(kind, i, j) => Fold::None,
                0 => east[n - 1].max(east[n]),
                1 => south[n - cols].max(south[n]),
                // A mixed difference does not tell a ridge from a valley.
                _ => east[n].max(south[n]).max(south[n + 1]).max(east[n + cols]).min(Fold::Given),
            };
            if fold == Fold::Found && self.wide[n] > wide.crease_limit { Fold::None } else { fold }
        };
        let weights = [ratio * ratio, 1.0 / (ratio * ratio), 2.0];
        let folds: Folds = std::array::from_fn(|kind| inside.values(|i, j| fold(kind, i, j)));
        let bending = |kind: usize, i: usize, j: usize| match (folds[kind][j * cols + i], is_bent(kind, i, j)) {
            (_, false) => 0.0,
            (Fold::None, true) => weights[kind],
            (_, true) => crease_weight * weights[kind],
        };
        let tension = |side: usize, i: usize, j: usize| {
            let n = j * cols + i;
            let (has_next, next, per) =
                if side == 0 { (i + 1 < cols, n + 1, ratio) } else { (j + 1 < rows, n + cols, 1.0 / ratio) };
            let is_cut = || walls.as_ref().is_some_and(|walls| walls.is_between(side, n));
            if !has_next || !inside.all(&[n, next]) || is_cut() {
                return 0.0;
            }
            let product = self.tension[n] * self.tension[next];
            if product.is_nan() { 0.0 } else { product.sqrt() * per }
        };
        let energy = Energy {
            size: [cols, rows],
            bending: std::array::from_fn(|kind| inside.values(|i, j| bending(kind, i, j))),
            tension: std::array::from_fn(|side| inside.values(|i, j| tension(side, i, j))),
            reference: Cow::Borrowed(&self.reference),
            follows: parallel::values_each(&self.wide, |share| 1.0 - wide.level_share * share),
            contours,
            pull: 0.0,
        };
        (energy, folds)
    }
}

/// Multiplies the tension of each edge by the factors at both ends.
fn scale(energy: &mut Energy<'_>, factors: &[f32]) {
    let steps = [1, energy.size[0]];
    for (side, step) in steps.into_iter().enumerate() {
        parallel::update(&mut energy.tension[side], |n, tension| {
            if *tension > 0.0 {
                *tension *= (factors[n] * factors[n + step]).sqrt();
            }
        });
    }
}

/// Cubic interpolation in the middle between nodes `k` and `k + 1`. Values beyond the ends follow a straight line.
fn middle(k: usize, count: usize, value: impl Fn(usize) -> f64) -> f64 {
    let at = |i: usize, offset: isize| -> f64 {
        let i = i as isize + offset;
        if i < 0 {
            2.0 * value(0) - value(1)
        } else if i as usize >= count {
            let beyond = (i as usize - count + 1) as f64;
            value(count - 1) + beyond * (value(count - 1) - value(count - 2))
        } else {
            value(i as usize)
        }
    };
    (9.0 * (at(k, 0) + at(k, 1)) - at(k, -1) - at(k, 2)) / 16.0
}

/// Heights on a finer lattice, by cubic interpolation.
fn refined(z: &[f64], coarse: &Lattice, fine: &Lattice) -> Vec<f64> {
    let mut wide = vec![0.0; coarse.rows * fine.cols];
    parallel::chunks(&mut wide, fine.cols, |j, row| {
        let node = |i: usize| z[j * coarse.cols + i];
        for (i, out) in row.iter_mut().enumerate() {
            *out = if i % 2 == 0 { node(i / 2) } else { middle(i / 2, coarse.cols, node) };
        }
    });
    let mut out = vec![0.0; fine.len()];
    parallel::chunks(&mut out, fine.cols, |j, row| {
        for (i, out) in row.iter_mut().enumerate() {
            let node = |j: usize| wide[j * fine.cols + i];
            *out = if j % 2 == 0 { node(j / 2) } else { middle(j / 2, coarse.rows, node) };
        }
    });
    out
}

/// Factors on a finer lattice, linear between nodes.
fn spread(factors: &[f32], coarse: &Lattice, fine: &Lattice) -> Vec<f32> {
    let at = |i: usize, j: usize| {
        let row = |j: usize| factors[j * coarse.cols + i / 2] + factors[j * coarse.cols + i.div_ceil(2)];
        (row(j / 2) + row(j.div_ceil(2))) / 4.0
    };
    parallel::cells(fine.cols, fine.rows, at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_only_lattice_takes_its_steps_however_far_apart_contours_are() {
        let (cols, rows) = (COARSEST, COARSEST);
        let lattice = Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols, rows };
        let lines = [1.3, 9.6].map(|x| [DVec2::new(x, 1.0), DVec2::new(x, -12.0)]);
        let hollows = vec![false; lattice.len()];
        let reference = vec![0.0; lattice.len()];
        let tuning = SplineTuning::default();
        let heights = |spacing: f64| {
            let problem = Problem {
                lattice,
                contours: &[(10.0, &lines[0]), (20.0, &lines[1])],
                spots: Vec::new(),
                creases: &[],
                cliffs: &[],
                known: &[],
                crease_threshold: 0.1,
                bounds: [0.0, 30.0].map(|bound| vec![bound; lattice.len()].into()),
                reference: &reference,
                tension: vec![0.0; lattice.len()],
                wide: vec![0.0; lattice.len()],
                contour_weight: CrossingWeight::even(100.0),
                interval: 10.0,
                spacing,
                hollows: &hollows,
                drainage: Drainage::default(),
                grid: &Grid { corner: DVec2::new(-0.5, 0.5), cell: DVec2::ONE, cols, rows },
                tuning: &tuning,
            };
            solve(&problem, &())
        };
        let found = heights(100.0 * tuning.fine_grid_nodes_per_spacing);
        assert_eq!(found, heights(1.0));
        let middle = found[rows / 2 * cols + cols / 2];
        assert!((middle - (10.0 + 10.0 * (6.0 - 1.3) / 8.3)).abs() < 0.5, "{middle}");
    }
}
