//! Random terrain on small grids for property tests: every kind of ground that contour lines have trouble with.
//!
//! All kinds take a seed and the size of the grid. The same arguments give the same heights.

use std::f64::consts::TAU;

use glam::DVec2;

use super::random::Random;
use super::tracer::contours_of;

/// Heights at the nodes of a grid, row by row from the north-west.
#[derive(Debug, Clone, PartialEq)]
pub struct Terrain {
    /// The kind of terrain, for messages.
    pub kind: &'static str,
    /// Number of columns.
    pub cols: usize,
    /// Number of rows.
    pub rows: usize,
    /// Distance between nodes, metres.
    pub cell: f64,
    /// Contour interval, metres.
    pub interval: f64,
    /// Position of the first node. Far from zero, as map coordinates are.
    pub origin: DVec2,
    /// Heights, metres.
    pub heights: Vec<f64>,
}

impl Terrain {
    /// The contour lines at all multiples of the interval.
    pub fn contours(&self) -> Vec<(f64, Vec<DVec2>)> {
        contours_of(&self.heights, self.cols, self.rows, self.cell, self.interval, self.origin)
    }

    fn of(kind: &'static str, cols: usize, rows: usize, height: impl Fn(f64, f64) -> f64) -> Self {
        let heights = (0..cols * rows).map(|n| height((n % cols) as f64, (n / cols) as f64)).collect();
        Self { kind, cols, rows, cell: 10.0, interval: 10.0, origin: DVec2::new(36_480.0, -27_250.0), heights }
    }

    /// Shifts and scales the heights so that they run from `low` to `high`.
    fn spread(mut self, low: f64, high: f64) -> Self {
        let least = self.heights.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let scale = if most > least { (high - low) / (most - least) } else { 0.0 };
        for z in &mut self.heights {
            *z = low + (*z - least) * scale;
        }
        self
    }
}

/// One terrain of every kind, of random sizes from 40 to 120 nodes a side.
pub fn all_kinds(seed: u64) -> Vec<Terrain> {
    let mut random = Random::new(seed);
    let mut side = || random.whole(40, 120);
    vec![
        hills(seed, side(), side()),
        fractal(seed, side(), side()),
        plateaus(seed, side(), side()),
        saddles(seed, side(), side()),
        cliffs(seed, side(), side(), 0.05),
        plane(seed, side(), side()),
        volcano(seed, side(), side()),
        spiral_valley(seed, side(), side()),
        meanders(seed, side(), side()),
    ]
}

/// Round hills and hollows: a sum of Gaussians.
pub fn hills(seed: u64, cols: usize, rows: usize) -> Terrain {
    let mut random = Random::new(seed);
    let side = cols.min(rows) as f64;
    let bumps: Vec<[f64; 4]> = (0..random.whole(5, 14))
        .map(|_| {
            let (x, y) = (random.between(0.0, cols as f64), random.between(0.0, rows as f64));
            [x, y, random.between(0.05, 0.25) * side, random.between(-0.5, 1.0)]
        })
        .collect();
    let height = |x: f64, y: f64| {
        bumps.iter().map(|b| b[3] * (-((x - b[0]).powi(2) + (y - b[1]).powi(2)) / (2.0 * b[2] * b[2])).exp()).sum()
    };
    let relief = random.between(40.0, 150.0);
    Terrain::of("hills", cols, rows, height).spread(203.0, 203.0 + relief)
}

/// Rough ground: the diamond-square fractal.
pub fn fractal(seed: u64, cols: usize, rows: usize) -> Terrain {
    let mut random = Random::new(seed);
    let size = (cols.max(rows) - 1).next_power_of_two();
    let width = size + 1;
    let mut z = vec![0.0; width * width];
    for corner in [0, size, size * width, size * width + size] {
        z[corner] = random.between(-1.0, 1.0);
    }
    let fade = random.between(0.45, 0.65);
    let (mut step, mut rough) = (size, 1.0);
    while step > 1 {
        let half = step / 2;
        // Centres of squares, then centres of their sides; a side on the border has three neighbours.
        for (first, odd) in [(half, true), (0, false)] {
            for y in (first..width).step_by(if odd { step } else { half }) {
                let start = if odd || (y / half).is_multiple_of(2) { half } else { 0 };
                for x in (start..width).step_by(step) {
                    let around: [(isize, isize); 4] =
                        if odd { [(-1, -1), (1, -1), (1, 1), (-1, 1)] } else { [(0, -1), (1, 0), (0, 1), (-1, 0)] };
                    let (mut sum, mut count) = (0.0, 0.0);
                    for (dx, dy) in around {
                        let at = |v: usize, d: isize| v.checked_add_signed(d * half as isize).filter(|&v| v < width);
                        if let (Some(u), Some(v)) = (at(x, dx), at(y, dy)) {
                            sum += z[v * width + u];
                            count += 1.0;
                        }
                    }
                    z[y * width + x] = sum / count + rough * random.between(-1.0, 1.0);
                }
            }
        }
        step = half;
        rough *= fade;
    }
    let relief = random.between(40.0, 120.0);
    Terrain::of("fractal", cols, rows, |x, y| z[y as usize * width + x as usize]).spread(398.0, 398.0 + relief)
}

/// Hills whose heights near some levels are put exactly on them: flat areas, ledges, ridges and single nodes at a level.
pub fn plateaus(seed: u64, cols: usize, rows: usize) -> Terrain {
    let mut random = Random::new(seed ^ 1);
    let mut terrain = if random.whole(0, 1) == 0 { hills(seed, cols, rows) } else { fractal(seed, cols, rows) };
    terrain.kind = "plateaus";
    let (interval, reach) = (terrain.interval, random.between(0.1, 0.45));
    let phase = random.whole(0, 1) as i64;
    for z in &mut terrain.heights {
        let k = (*z / interval).round();
        if (k as i64 + phase) % 2 == 0 && (*z / interval - k).abs() < reach {
            *z = k * interval;
        }
    }
    terrain
}

/// Hills and hollows like a chessboard, with all saddles, and whole lines of nodes between them, exactly at one level.
pub fn saddles(seed: u64, cols: usize, rows: usize) -> Terrain {
    let mut random = Random::new(seed);
    let (p, q) = (random.whole(5, 14) as i64, random.whole(5, 14) as i64);
    let (shift_x, shift_y) = (random.whole(0, 9) as i64, random.whole(0, 9) as i64);
    // Whole numbers and a power of two, so that the heights are exact.
    let wave = |x: f64, shift: i64, period: i64| {
        let x = (x as i64 + shift).rem_euclid(4 * period);
        (if x < 2 * period { period - x } else { x - 3 * period }) as f64
    };
    let scale = [0.125, 0.25, 0.5, 1.0][random.whole(0, 3)];
    Terrain::of("saddles", cols, rows, |x, y| 500.0 + scale * wave(x, shift_x, p) * wave(y, shift_y, q))
}

/// A gentle slope with cliffs along winding lines, soft in some places and within one cell in others. Where a cliff is
/// sharpest its contour lines are `closest` cells apart (such as 1e-3; its height is the interval divided by that).
pub fn cliffs(seed: u64, cols: usize, rows: usize, closest: f64) -> Terrain {
    let mut random = Random::new(seed);
    let (w, h) = (cols as f64, rows as f64);
    let path = [
        random.between(0.3, 0.7) * h,
        random.between(0.05, 0.2) * h,
        random.between(0.0, TAU),
        random.between(0.5, 2.0),
    ];
    let soft = random.between(0.0, TAU);
    let height = 10.0 / closest;
    Terrain::of("cliffs", cols, rows, |x, y| {
        let away = path[0] + path[1] * (path[3] * TAU * x / w + path[2]).sin() - y;
        // The width of the step runs from far under a cell to a few cells along the cliff.
        let width = 0.02 * 200f64.powf(0.5 + 0.5 * (TAU * x / w + soft).cos());
        107.0 + 0.35 * (h - y) + 0.1 * x + height / (1.0 + (-away / width).exp())
    })
}

/// A tilted plane: open lines only.
pub fn plane(seed: u64, cols: usize, rows: usize) -> Terrain {
    let mut random = Random::new(seed);
    let (turn, steep) = (random.between(0.0, TAU), random.between(0.8, 4.0));
    let base = random.between(0.0, 1000.0);
    Terrain::of("plane", cols, rows, |x, y| base + steep * (turn.cos() * x + turn.sin() * y))
}

/// A cone with a crater: depression contours inside closed contours of the same levels.
pub fn volcano(seed: u64, cols: usize, rows: usize) -> Terrain {
    let mut random = Random::new(seed);
    let side = cols.min(rows) as f64;
    let (x0, y0) = (random.between(0.45, 0.55) * cols as f64, random.between(0.45, 0.55) * rows as f64);
    let rim = random.between(0.15, 0.22) * side;
    let depth = random.between(0.5, 0.9);
    let (lobes, wobble) = (random.whole(2, 5) as f64, random.between(0.0, 0.1));
    Terrain::of("volcano", cols, rows, |x, y| {
        let (dx, dy) = (x - x0, y - y0);
        let r = dx.hypot(dy) * (1.0 + wobble * (lobes * dy.atan2(dx)).cos());
        let (inside, outside) = (((rim - r) / rim).max(0.0), ((r - rim) / side).max(0.0));
        -depth * inside.powf(1.5) - 3.0 * outside.min(1.0)
    })
    .spread(812.0, 812.0 + random.between(80.0, 160.0))
}

/// A valley that winds around the middle in a spiral and falls outwards.
pub fn spiral_valley(seed: u64, cols: usize, rows: usize) -> Terrain {
    let mut random = Random::new(seed);
    let (x0, y0) = (cols as f64 / 2.0, rows as f64 / 2.0);
    let pitch = random.between(9.0, 16.0);
    let (deep, fall) = (random.between(10.0, 30.0), random.between(0.2, 1.0));
    Terrain::of("spiral valley", cols, rows, |x, y| {
        let (dx, dy) = (x - x0, y - y0);
        let r = dx.hypot(dy);
        350.0 - fall * r - deep * (TAU * r / pitch - dy.atan2(dx)).cos()
    })
}

/// A valley that meanders down a slope, its sides steep.
pub fn meanders(seed: u64, cols: usize, rows: usize) -> Terrain {
    let mut random = Random::new(seed);
    let (w, h) = (cols as f64, rows as f64);
    let (swing, bends) = (random.between(0.15, 0.3) * w, random.between(1.5, 3.5));
    let (start, sides, fall) = (random.between(0.0, TAU), random.between(2.0, 6.0), random.between(0.1, 0.6));
    Terrain::of("meanders", cols, rows, |x, y| {
        let middle = 0.5 * w + swing * (bends * TAU * y / h + start).sin();
        let away = (x - middle).hypot(1.5) - 1.5;
        600.0 + fall * (h - y) + 30.0 * (1.0 - (-sides * away / 30.0).exp()) + 0.1 * away
    })
}
