//! The energy of a surface on a lattice: bending, tension and distance from the contours (minimum curvature: Briggs
//! 1974, Geophysics 39; with tension: Smith and Wessel 1990, Geophysics 55).
//!
//! It is the sum of four terms, which are quadratic in the heights:
//!
//! * Bending, `Σ w δ²`: second differences δ, eastwards, southwards, and the mixed one twice.
//! * Tension, `Σ t (Δz - f Δg)²`: first differences of the surface z against a share f of those of the reference
//!   surface g.
//! * Contours, `Σ λ (z at crossing - level)²`: crossings of contours with edges of the lattice. Along an edge, z is
//!   linear.
//! * Pull to zero, `Σ p z²`.

use std::borrow::Cow;
use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::lattice::{Crossing, CrossingKind, Lattice};
use crate::base::parallel;

/// Rows per task: enough to be worth a task.
const BLOCK: usize = 32;
/// The position of the first term is stored for every node of this number: a balance of memory and a short search.
const STRIDE: usize = 32;

/// Weight of the square at a crossing, against that of a second difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossingWeight {
    /// At a [`CrossingKind::Vertex`].
    pub at_vertex: f64,
    /// On a [`CrossingKind::Chord`].
    pub on_chord: f64,
}

impl CrossingWeight {
    /// One weight for all kinds of crossings.
    pub fn even(weight: f64) -> Self {
        Self { at_vertex: weight, on_chord: weight }
    }

    /// Applies the same change to all weights.
    pub fn map(self, change: impl Fn(f64) -> f64) -> Self {
        Self { at_vertex: change(self.at_vertex), on_chord: change(self.on_chord) }
    }

    fn of(self, kind: CrossingKind) -> f64 {
        match kind {
            CrossingKind::Vertex => self.at_vertex,
            CrossingKind::Chord => self.on_chord,
        }
    }
}

/// All crossings on one edge, summed up. They add `a u² + 2 b u v + c v² - 2 p u - 2 q v` to the energy, where u and v
/// are the heights at the ends of the edge.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EdgeTerm {
    /// First node of the edge; its height is u.
    pub node: u32,
    /// Coefficient of u².
    pub a: f32,
    /// Half of the coefficient of u v.
    pub b: f32,
    /// Coefficient of v².
    pub c: f32,
    p: f64,
    q: f64,
}

/// The terms of all eastward or of all southward edges, one per edge, ordered by first node.
#[derive(Debug, Clone, Default)]
pub struct EdgeTerms {
    terms: Vec<EdgeTerm>,
    /// Number of terms before every [`STRIDE`]th node.
    before: Vec<u32>,
}

impl EdgeTerms {
    /// Sums up crossings and their levels per edge.
    pub fn new(crossings: &[(Crossing, f64)], weight: CrossingWeight, lattice: &Lattice) -> Self {
        let key = |i: usize| u64::from(crossings[i].0.node) << 32 | i as u64;
        let mut order: Vec<u64> = parallel::values(crossings.len(), key);
        order.par_sort_unstable();
        let mut terms: Vec<EdgeTerm> = Vec::with_capacity(order.len());
        for key in order {
            let (crossing, level) = crossings[key as u32 as usize];
            let weight = weight.of(crossing.kind);
            let (v, u) = (crossing.along, 1.0 - crossing.along);
            if terms.last().is_none_or(|last| last.node != crossing.node) {
                terms.push(EdgeTerm { node: crossing.node, ..EdgeTerm::default() });
            }
            if let Some(term) = terms.last_mut() {
                term.a += (weight * u * u) as f32;
                term.b += (weight * u * v) as f32;
                term.c += (weight * v * v) as f32;
                term.p += weight * u * level;
                term.q += weight * v * level;
            }
        }
        let mut before = vec![0; lattice.len() / STRIDE + 2];
        terms.iter().for_each(|t| before[t.node as usize / STRIDE + 1] += 1);
        for k in 1..before.len() {
            before[k] += before[k - 1];
        }
        Self { terms, before }
    }

    /// The terms of all edges that contours cross, ordered by first node.
    pub fn all(&self) -> &[EdgeTerm] {
        &self.terms
    }

    /// The terms of the edges whose first nodes lie in a range.
    pub fn starting_in(&self, nodes: Range<usize>) -> &[EdgeTerm] {
        &self.terms[self.place(nodes.start)..self.place(nodes.end)]
    }

    fn place(&self, node: usize) -> usize {
        let near = self.before[node / STRIDE] as usize;
        near + self.terms[near..].iter().take_while(|t| (t.node as usize) < node).count()
    }
}

/// The coefficients of the energy. A weight of zero switches a difference off.
#[derive(Debug, Clone)]
pub struct Energy<'a> {
    /// Columns and rows of the lattice.
    pub size: [usize; 2],
    /// Weights of the second differences: eastwards and southwards at their middle node, mixed at the north-western
    /// one. All three are empty for a membrane, which bends without energy.
    pub bending: [Vec<f32>; 3],
    /// Weights of the first differences to the eastern and to the southern neighbour.
    pub tension: [Vec<f32>; 2],
    /// Heights of the reference surface, whose first differences the tension draws to. Where they are NaN, and everywhere
    /// if there are none, it draws to level ground.
    pub reference: Cow<'a, [f32]>,
    /// Share of the reference surface's differences that the tension draws to, at each node. An edge has the smaller
    /// one of its ends.
    pub follows: Vec<f32>,
    /// Crossings on eastward and on southward edges, summed up.
    pub contours: [EdgeTerms; 2],
    /// Weight of the squared height at every node. It pulls the surface to 0.
    pub pull: f32,
}

impl Energy<'_> {
    /// Whether this is the energy of a membrane: without weights of second differences.
    pub fn is_membrane(&self) -> bool {
        self.bending.iter().all(Vec::is_empty)
    }

    /// Half of the negative gradient of the energy at `z`.
    ///
    /// Differences are taken first. This keeps precision where large heights nearly cancel.
    pub fn downhill(&self, z: &[f64], out: &mut [f64]) {
        parallel::chunks(out, self.size[0] * BLOCK, |k, out| {
            Arch::new().dispatch(Block { energy: self, z, first: k * BLOCK, out });
        });
    }

    /// [`Energy::downhill`] for the rows from `first` on. Differences are formed once per row and kept while a row
    /// below needs them. Each row of differences has a 0 at both ends, for the differences beyond the lattice. So all
    /// nodes of a row are alike.
    ///
    /// Long because all differences of a row are formed in one pass over memory.
    #[inline(always)]
    fn downhill_block(&self, z: &[f64], first: usize, block: &mut [f64]) {
        let [cols, rows] = self.size;
        let (bends, row_of) = (!self.is_membrane(), |j: usize| j * cols..(j + 1) * cols);
        let blank = || vec![0.0; cols + 2];
        let (mut xx, mut east, mut out) = (blank(), blank(), vec![0.0; cols]);
        let mut yy = [blank(), blank(), blank()];
        let mut mixed = [blank(), blank()];
        let mut south = [blank(), blank()];
        // These closures count rows from one, so that the row above the first one can be asked for.
        let fill_yy = |j: usize, out: &mut [f64]| {
            if !bends || j < 2 || j > rows - 1 {
                return out.fill(0.0);
            }
            let rows = z[row_of(j - 2)].iter().zip(&z[row_of(j - 1)]).zip(&z[row_of(j)]);
            for (out, (((&n, &m), &s), &w)) in out[1..].iter_mut().zip(rows.zip(&self.bending[1][row_of(j - 1)])) {
                *out = f64::from(w) * (n - m - m + s);
            }
        };
        let fill_pairs = |j: usize, mixed: &mut [f64], south: &mut [f64]| {
            if j < 1 || j > rows - 1 {
                mixed.fill(0.0);
                return south.fill(0.0);
            }
            let (n, s) = (&z[row_of(j - 1)], &z[row_of(j)]);
            if bends {
                let pairs = n.windows(2).zip(s.windows(2)).zip(&self.bending[2][row_of(j - 1)]);
                for (out, ((n, s), &w)) in mixed[1..].iter_mut().zip(pairs) {
                    *out = f64::from(w) * (n[0] - n[1] - s[0] + s[1]);
                }
            }
            let pairs = n.iter().zip(s).zip(&self.tension[1][row_of(j - 1)]);
            for (out, ((&n, &s), &t)) in south[1..].iter_mut().zip(pairs) {
                *out = f64::from(t) * (n - s);
            }
        };
        fill_yy(first, &mut yy[0]);
        fill_yy(first + 1, &mut yy[1]);
        fill_pairs(first, &mut mixed[0], &mut south[0]);
        let pull = f64::from(self.pull);
        for (dj, block) in block.chunks_exact_mut(cols).enumerate() {
            let j = first + dj;
            fill_yy(j + 2, &mut yy[2]);
            fill_pairs(j + 1, &mut mixed[1], &mut south[1]);
            let m = &z[row_of(j)];
            if bends {
                for (out, (m, &w)) in xx[2..].iter_mut().zip(m.windows(3).zip(&self.bending[0][row_of(j)][1..])) {
                    *out = f64::from(w) * (m[0] - m[1] - m[1] + m[2]);
                }
            }
            for (out, (m, &t)) in east[1..].iter_mut().zip(m.windows(2).zip(&self.tension[0][row_of(j)])) {
                *out = f64::from(t) * (m[0] - m[1]);
            }
            let rows = (&yy[0][1..], &yy[1][1..], &yy[2][1..], &south[0][1..], &south[1][1..]);
            let (y0, y1, y2) = (&rows.0[..cols], &rows.1[..cols], &rows.2[..cols]);
            let (s0, s1) = (&rows.3[..cols], &rows.4[..cols]);
            let (x0, x1, x2) = (&xx[..cols], &xx[1..=cols], &xx[2..cols + 2]);
            let (a0, a1) = (&mixed[0][..cols], &mixed[0][1..=cols]);
            let (b0, b1) = (&mixed[1][..cols], &mixed[1][1..=cols]);
            let (e0, e1) = (&east[..cols], &east[1..=cols]);
            let m = &m[..cols];
            let out = &mut out[..cols];
            for i in 0..cols {
                let bend = y0[i] - y1[i] - y1[i] + y2[i] + x0[i] - x1[i] - x1[i] + x2[i];
                let twist = b1[i] - b0[i] - a1[i] + a0[i];
                out[i] = bend + twist + s1[i] - s0[i] + e1[i] - e0[i] + pull * m[i];
            }
            for e in self.contours[0].starting_in(row_of(j)) {
                let i = e.node as usize - j * cols;
                out[i] += f64::from(e.a) * m[i] + f64::from(e.b) * m[i + 1];
                out[i + 1] += f64::from(e.b) * m[i] + f64::from(e.c) * m[i + 1];
            }
            for e in self.contours[1].starting_in(row_of(j)) {
                let i = e.node as usize - j * cols;
                out[i] += f64::from(e.a) * m[i] + f64::from(e.b) * z[e.node as usize + cols];
            }
            if j > 0 {
                for e in self.contours[1].starting_in(row_of(j - 1)) {
                    let i = e.node as usize - (j - 1) * cols;
                    out[i] += f64::from(e.b) * z[e.node as usize] + f64::from(e.c) * m[i];
                }
            }
            block.iter_mut().zip(&*out).for_each(|(down, out)| *down -= out);
            yy.rotate_left(1);
            mixed.swap(0, 1);
            south.swap(0, 1);
        }
    }

    /// The constant part of half of the negative gradient, for the rows from `first` on.
    #[inline(always)]
    fn constant(&self, first: usize, out: &mut [f64]) {
        let cols = self.size[0];
        let start = first * cols;
        out.fill(0.0);
        if !self.reference.is_empty() {
            self.pull_to_reference(first, out);
        }
        let [eastward, southward] = &self.contours;
        let nodes = start..start + out.len();
        for e in eastward.starting_in(nodes.clone()) {
            out[e.node as usize - start] += e.p;
            out[e.node as usize + 1 - start] += e.q;
        }
        for e in southward.starting_in(nodes.clone()) {
            out[e.node as usize - start] += e.p;
        }
        for e in southward.starting_in(start.saturating_sub(cols)..nodes.end - cols) {
            out[e.node as usize + cols - start] += e.q;
        }
    }

    /// The part of [`Energy::constant`] that comes from the reference surface. Pulls along edges are formed once per row.
    #[inline(always)]
    fn pull_to_reference(&self, first: usize, out: &mut [f64]) {
        let [cols, rows] = self.size;
        let row_of = |j: usize| j * cols..(j + 1) * cols;
        // The pull along an edge with this weight, from the heights and shares at its ends.
        let pull = |weight: f32, from: f32, to: f32, follows: f32| {
            let fall = f64::from(from) - f64::from(to);
            if weight == 0.0 || fall.is_nan() { 0.0 } else { f64::from(weight) * fall * f64::from(follows) }
        };
        let fill_east = |j: usize, out: &mut [f64]| {
            let (heights, follows) = (&self.reference[row_of(j)], &self.follows[row_of(j)]);
            let pairs = heights.windows(2).zip(follows.windows(2)).zip(&self.tension[0][row_of(j)]);
            for (out, ((z, f), &weight)) in out[1..].iter_mut().zip(pairs) {
                *out = pull(weight, z[0], z[1], f[0].min(f[1]));
            }
        };
        // This closure counts rows from one, so that the row above the first one can be asked for.
        let fill_south = |j: usize, out: &mut [f64]| {
            if j < 1 || j > rows - 1 {
                return out.fill(0.0);
            }
            let (n, s) = (row_of(j - 1), row_of(j));
            let heights = self.reference[n.clone()].iter().zip(&self.reference[s.clone()]);
            let follows = self.follows[n.clone()].iter().zip(&self.follows[s]);
            let pairs = heights.zip(follows).zip(&self.tension[1][n]);
            for (out, (((&a, &b), (&f, &g)), &weight)) in out.iter_mut().zip(pairs) {
                *out = pull(weight, a, b, f.min(g));
            }
        };
        // A 0 at both ends stands for the edges beyond the lattice.
        let mut east = vec![0.0; cols + 1];
        let mut south = [vec![0.0; cols], vec![0.0; cols]];
        fill_south(first, &mut south[0]);
        for (dj, out) in out.chunks_exact_mut(cols).enumerate() {
            fill_east(first + dj, &mut east);
            fill_south(first + dj + 1, &mut south[1]);
            let (e0, e1) = (&east[..cols], &east[1..=cols]);
            let (s0, s1) = (&south[0][..cols], &south[1][..cols]);
            let out = &mut out[..cols];
            for i in 0..cols {
                out[i] = e1[i] - e0[i] + s1[i] - s0[i];
            }
            south.swap(0, 1);
        }
    }

    /// The second difference of `z` that belongs to the bending weight of `kind` at `node`. The weight must not be 0.
    pub fn second_difference(&self, kind: usize, node: usize, z: &[f64]) -> f64 {
        let cols = self.size[0];
        match kind {
            0 => z[node - 1] - 2.0 * z[node] + z[node + 1],
            1 => z[node - cols] - 2.0 * z[node] + z[node + cols],
            _ => z[node] - z[node + 1] - z[node + cols] + z[node + cols + 1],
        }
    }
}

/// Arguments of [`Energy::downhill`] for a block of rows. A closure would not be compiled for the processor's widest
/// instructions.
struct Block<'a> {
    energy: &'a Energy<'a>,
    z: &'a [f64],
    first: usize,
    out: &'a mut [f64],
}

impl WithSimd for Block<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.energy.constant(self.first, self.out);
        self.energy.downhill_block(self.z, self.first, self.out);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use glam::DVec2;

    use super::super::stencil::{LANES, REACH, Stencil};
    use super::*;

    /// Random coefficients on a small lattice. Weights are 0 where their difference would cross the border.
    pub fn energy(cols: usize, rows: usize) -> Energy<'static> {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) as f32 / 65_536.0
        };
        let mut weights = |keep: &dyn Fn(usize, usize) -> bool| -> Vec<f32> {
            (0..cols * rows).map(|n| if keep(n % cols, n / cols) { random() } else { 0.0 }).collect()
        };
        let bending = [
            weights(&|i, _| i > 0 && i + 1 < cols),
            weights(&|_, j| j > 0 && j + 1 < rows),
            weights(&|i, j| i + 1 < cols && j + 1 < rows),
        ];
        let tension = [weights(&|i, _| i + 1 < cols), weights(&|_, j| j + 1 < rows)];
        let reference = weights(&|_, _| true).into();
        let lattice = Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols, rows };
        let crossing =
            |node: usize, along: f64| (Crossing { node: node as u32, along, kind: CrossingKind::Chord }, 100.0 * along);
        let contours = [
            EdgeTerms::new(
                &[crossing(cols, 0.25), crossing(cols, 0.5), crossing(0, 1.0)],
                CrossingWeight::even(3.0),
                &lattice,
            ),
            EdgeTerms::new(&[crossing(cols + 1, 0.75), crossing(1, 0.1)], CrossingWeight::even(3.0), &lattice),
        ];
        let follows = weights(&|_, _| true);
        Energy { size: [cols, rows], bending, tension, reference, follows, contours, pull: 0.25 }
    }

    /// The energy by its definition.
    fn value(e: &Energy<'_>, z: &[f64]) -> f64 {
        let cols = e.size[0];
        let mut sum = 0.0;
        for n in 0..z.len() {
            sum += f64::from(e.pull) * z[n] * z[n];
            for k in 0..3 {
                if e.bending[k][n] > 0.0 {
                    sum += f64::from(e.bending[k][n]) * e.second_difference(k, n, z).powi(2);
                }
            }
            for (k, step) in [1, cols].into_iter().enumerate() {
                if e.tension[k][n] > 0.0 {
                    let fall = f64::from(e.reference[n]) - f64::from(e.reference[n + step]);
                    let follows = f64::from(e.follows[n].min(e.follows[n + step]));
                    sum += f64::from(e.tension[k][n]) * (z[n] - z[n + step] - follows * fall).powi(2);
                }
            }
        }
        for (k, step) in [1, cols].into_iter().enumerate() {
            for t in &e.contours[k].terms {
                let (u, v) = (z[t.node as usize], z[t.node as usize + step]);
                sum += f64::from(t.a) * u * u + 2.0 * f64::from(t.b) * u * v + f64::from(t.c) * v * v;
                sum -= 2.0 * (t.p * u + t.q * v);
            }
        }
        sum
    }

    #[test]
    fn a_membrane_is_a_surface_whose_second_differences_weigh_nothing() {
        let (cols, rows) = (37, BLOCK + 3);
        let membrane = Energy { bending: Default::default(), ..energy(cols, rows) };
        let nothing = || vec![0.0; cols * rows];
        let plate = Energy { bending: [nothing(), nothing(), nothing()], ..membrane.clone() };
        assert!(membrane.is_membrane() && !plate.is_membrane());
        let z: Vec<f64> = (0..cols * rows).map(|n| ((n * 37) % 23) as f64).collect();
        let downhill = |energy: &Energy<'_>| {
            let mut downhill = vec![0.0; z.len()];
            energy.downhill(&z, &mut downhill);
            downhill
        };
        assert_eq!(downhill(&membrane), downhill(&plate));
        let image = |energy: &Energy<'_>| {
            let mut stencil = Stencil::default();
            let size = [cols + 2 * REACH, rows + 2 * REACH];
            stencil.take(energy, [0, 0], size);
            let count = (size[0] * size[1]).next_multiple_of(LANES);
            stencil.scale(&vec![0.5; count]);
            let direction: Vec<f32> = (0..count + 2 * stencil.pad()).map(|n| ((n * 29) % 31) as f32).collect();
            let mut image = vec![0.0; count];
            stencil.apply(&direction, &mut image);
            (image, stencil.diagonal().to_vec())
        };
        assert_eq!(image(&membrane), image(&plate));
        assert!(image(&membrane).0.iter().any(|v| *v != 0.0));
    }

    #[test]
    fn the_gradient_is_that_of_the_energy() {
        // More rows than a block has.
        let (cols, rows) = (5, BLOCK + 3);
        let e = energy(cols, rows);
        let z: Vec<f64> = (0..cols * rows).map(|n| ((n * 37) % 23) as f64).collect();
        let (mut downhill, mut constant) = (vec![0.0; z.len()], vec![0.0; z.len()]);
        e.downhill(&z, &mut downhill);
        e.constant(0, &mut constant);
        // The window is as large as the lattice.
        let mut stencil = Stencil::default();
        let size = [cols + 2 * REACH, rows + 2 * REACH];
        stencil.take(&e, [0, 0], size);
        let place = |n: usize| (n / cols + REACH) * size[0] + n % cols + REACH;
        let (count, pad) = ((size[0] * size[1]).next_multiple_of(LANES), stencil.pad());
        let mut padded = vec![0.0; count + 2 * pad];
        z.iter().enumerate().for_each(|(n, z)| padded[pad + place(n)] = *z as f32);
        let mut image = vec![0.0; count];
        stencil.apply(&padded, &mut image);
        for n in 0..z.len() {
            let at = |step: f64| {
                let mut moved = z.clone();
                moved[n] += step;
                value(&e, &moved)
            };
            // Exact for a quadratic function, up to rounding.
            let slope = (at(1.0) - at(-1.0)) / 4.0;
            let curve = (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / 2.0;
            assert!((slope + downhill[n]).abs() < 1e-6 * slope.abs().max(100.0), "node {n}");
            assert!((curve / f64::from(stencil.diagonal()[place(n)]) - 1.0).abs() < 1e-4, "node {n}: {curve}");
            let slope = constant[n] - downhill[n];
            assert!((f64::from(image[place(n)]) - slope).abs() < 1e-4 * slope.abs().max(100.0), "node {n}");
        }
    }
}
