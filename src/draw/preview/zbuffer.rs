//! Hidden-surface removal for triangles and lines: a depth buffer with several samples per pixel.
//!
//! The picture is drawn in bands of rows. Each band holds its own samples, so bands can be drawn in parallel. Within a
//! band, triangles and lines are drawn in the order of their numbers, and of equal depths the first one stays. The
//! picture therefore does not depend on the number of threads.
//!
//! A line only marks the samples that it covers. Colours are mixed at the end, so overlapping lines are not darker.

use glam::{DVec2, DVec3};

use super::color::{PAPER, Rgb};
use super::stroke::Style;
use tokosen_core::base::parallel;
use tokosen_core::base::rows::Rows;

/// Samples along each side of a pixel.
const FINE: usize = 3;
/// Rows of pixels in a band.
const BAND: usize = 32;
/// Lines are visible down to this depth below the ground, pixels, because they are wider than the edge that they
/// follow.
const BIAS: f64 = 2.5;
/// Spans reach this far beyond their ends, samples, so that rounding leaves no gap between neighbours.
const OVERLAP: f64 = 1e-6;
/// Triangles of less than half this area are seen edge-on and left out, square samples.
const FLAT: f64 = 1e-9;

/// A corner of a triangle on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    /// Pixels to the right, pixels down, and pixels towards the eye.
    pub at: DVec3,
    /// Share of the height range.
    pub height: f64,
    /// Brightness, 1 on level ground.
    pub light: f64,
}

/// A piece of a line on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// The ends, as those of [`Corner::at`].
    pub ends: [DVec3; 2],
    /// The number of its style, counted from 1. The higher one lies on top.
    pub style: u8,
}

/// The scene: numbered triangles and pieces of lines.
pub(super) struct Scene<'a, C, P> {
    /// Width and height, pixels.
    pub size: (usize, usize),
    /// How many triangles there are.
    pub triangles: u32,
    /// The corners of a triangle; `None` if it cannot be seen.
    pub corners: C,
    /// The colour of a triangle at a share of the height range under a brightness.
    pub paint: P,
    /// Pieces of lines.
    pub pieces: &'a [Piece],
    /// The styles of lines; number 1 is the first.
    pub styles: &'a [Style],
}

/// Draws the scene as rows of RGBA bytes, with paper as the background.
pub(super) fn draw<C, P>(scene: &Scene<'_, C, P>) -> Vec<u8>
where
    C: Fn(u32) -> Option<[Corner; 3]> + Sync,
    P: Fn(u32, f64, f64) -> Rgb + Sync,
{
    let (width, height) = scene.size;
    let bands = height.div_ceil(BAND);
    let reached = |ys: &[f64], margin: f64| {
        let (lo, hi) = ys.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &y| (lo.min(y), hi.max(y)));
        // Conversion to whole numbers saturates; NaN becomes zero.
        let band = |y: f64| (y / BAND as f64).max(0.0) as usize;
        let outside = hi + margin < 0.0 || lo - margin > height as f64;
        let last = if outside { 0 } else { (band(hi + margin) + 1).min(bands) };
        band(lo - margin)..last
    };
    let (reached, corners) = (&reached, &scene.corners);
    let triangles = Rows::new(bands, || {
        (0..scene.triangles).flat_map(move |t| {
            let bands = corners(t).map_or(0..0, |c| reached(&c.map(|c| c.at.y), 1.0));
            bands.map(move |band| (band, t))
        })
    });
    let pieces = Rows::new(bands, || {
        scene.pieces.iter().enumerate().flat_map(move |(i, piece)| {
            let margin = f64::from(style_of(scene.styles, piece).width);
            reached(&piece.ends.map(|e| e.y), margin).map(move |band| (band, i as u32))
        })
    });
    let mut pixels = vec![0; width * height * 4];
    parallel::chunks(&mut pixels, (width * BAND * 4).max(1), |band, pixels| {
        let mut samples = Samples::new(width, pixels.len() / (width * 4), band * BAND);
        for &t in triangles.of(band) {
            if let Some(corners) = corners(t) {
                samples.triangle(&corners, |height, light| (scene.paint)(t, height, light));
            }
        }
        for &i in pieces.of(band) {
            let piece = &scene.pieces[i as usize];
            samples.piece(piece, f64::from(style_of(scene.styles, piece).width) / 2.0);
        }
        samples.resolve(scene.styles, pixels);
    });
    pixels
}

fn style_of(styles: &[Style], piece: &Piece) -> Style {
    styles[usize::from(piece.style) - 1]
}

/// The samples of one band.
struct Samples {
    cols: usize,
    rows: usize,
    /// First row of samples, counted over the whole picture.
    top: usize,
    depth: Vec<f32>,
    color: Vec<Rgb>,
    line: Vec<u8>,
}

impl Samples {
    fn new(width: usize, height: usize, top: usize) -> Self {
        let (cols, rows) = (width * FINE, height * FINE);
        let count = cols * rows;
        Self {
            cols,
            rows,
            top: top * FINE,
            depth: vec![f32::NEG_INFINITY; count],
            color: vec![PAPER; count],
            line: vec![0; count],
        }
    }

    /// The whole numbers n for which n + 1/2 lies between two numbers, within 0 to `count`.
    fn span(lo: f64, hi: f64, count: usize) -> std::ops::Range<usize> {
        let first = (lo - 0.5).ceil().max(0.0) as usize;
        let last = ((hi - 0.5).floor() + 1.0).clamp(0.0, count as f64) as usize;
        first..last
    }

    /// Rows of the band between two heights on the picture, in samples from the top of the picture.
    fn rows_between(&self, lo: f64, hi: f64) -> std::ops::Range<usize> {
        let top = self.top as f64;
        Self::span(lo - top, hi - top, self.rows)
    }

    fn triangle(&mut self, corners: &[Corner; 3], paint: impl Fn(f64, f64) -> Rgb) {
        let fine = FINE as f64;
        let [a, b, c] = corners.map(|c| c.at.truncate() * fine);
        let double_area = (b - a).perp_dot(c - a);
        if !corners.iter().all(|c| c.at.is_finite()) || double_area.abs() < FLAT {
            return;
        }
        // A linear function on the triangle: its value in the first corner, and its steps to the right and down.
        let plane = |values: [f64; 3]| {
            let [u, v] = [values[1] - values[0], values[2] - values[0]];
            let right = (u * (c.y - a.y) - v * (b.y - a.y)) / double_area;
            let down = (v * (b.x - a.x) - u * (c.x - a.x)) / double_area;
            (values[0], DVec2::new(right, down))
        };
        let depths = corners.map(|c| c.at.z);
        let (nearest, farthest) =
            (depths.iter().fold(f64::MIN, |m, z| m.max(*z)), depths.iter().fold(f64::MAX, |m, z| m.min(*z)));
        let (depth, height, light) = (plane(depths), plane(corners.map(|c| c.height)), plane(corners.map(|c| c.light)));
        let at = |(value, steps): (f64, DVec2), p: DVec2| value + steps.dot(p - a);
        let turn = double_area.signum();
        for row in self.rows_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)) {
            let y = (self.top + row) as f64 + 0.5;
            let (mut lo, mut hi) = (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
            for (u, v) in [(a, b), (b, c), (c, a)] {
                let along = (v - u) * turn;
                // Inside lies where along x (p - u) >= 0: left or right of where the edge meets the row.
                if along.y != 0.0 {
                    let x = u.x + (y - u.y) * along.x / along.y;
                    if along.y < 0.0 { lo = lo.max(x) } else { hi = hi.min(x) }
                } else if along.x * (y - u.y) < 0.0 {
                    hi = lo - 1.0;
                }
            }
            for col in Self::span(lo - OVERLAP, hi + OVERLAP, self.cols) {
                let p = DVec2::new(col as f64 + 0.5, y);
                let z = at(depth, p).clamp(farthest, nearest) as f32;
                let i = row * self.cols + col;
                if z > self.depth[i] {
                    self.depth[i] = z;
                    self.color[i] = paint(at(height, p), at(light, p));
                }
            }
        }
    }

    /// Marks the samples nearer than `reach`, pixels, to a piece of line that is not hidden.
    fn piece(&mut self, piece: &Piece, reach: f64) {
        let fine = FINE as f64;
        let reach = reach * fine;
        let [a, b] = piece.ends.map(|e| e.truncate() * fine);
        let [near, far] = piece.ends.map(|e| e.z);
        let along = b - a;
        let length = along.length_squared();
        for row in self.rows_between(a.y.min(b.y) - reach, a.y.max(b.y) + reach) {
            let y = (self.top + row) as f64 + 0.5;
            // The part of the piece within reach of this row.
            let share = |y: f64| if along.y == 0.0 { f64::INFINITY } else { (y - a.y) / along.y };
            let (s, e) = (share(y - reach), share(y + reach));
            let (s, e) = if along.y == 0.0 { (0.0, 1.0) } else { (s.min(e).clamp(0.0, 1.0), s.max(e).clamp(0.0, 1.0)) };
            let (x, x2) = (a.x + along.x * s, a.x + along.x * e);
            for col in Self::span(x.min(x2) - reach, x.max(x2) + reach, self.cols) {
                let p = DVec2::new(col as f64 + 0.5, y);
                let share = if length > 0.0 { ((p - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
                let i = row * self.cols + col;
                let depth = near + (far - near) * share + BIAS;
                if p.distance_squared(a + along * share) <= reach * reach && depth >= f64::from(self.depth[i]) {
                    self.line[i] = self.line[i].max(piece.style);
                }
            }
        }
    }

    /// Lays the lines over the triangles and takes the mean of each pixel's samples.
    fn resolve(&self, styles: &[Style], pixels: &mut [u8]) {
        let width = self.cols / FINE;
        for (n, pixel) in pixels.chunks_exact_mut(4).enumerate() {
            let (col, row) = (n % width * FINE, n / width * FINE);
            let mut sum = [0.0f32; 3];
            for i in (0..FINE * FINE).map(|k| (row + k / FINE) * self.cols + col + k % FINE) {
                let style = usize::from(self.line[i]).checked_sub(1).map(|s| styles[s]);
                let (ink, alpha) = style.map_or((PAPER, 0.0), |s| (s.color, s.alpha));
                for k in 0..3 {
                    let base = f32::from(self.color[i][k]);
                    sum[k] += base + (f32::from(ink[k]) - base) * alpha;
                }
            }
            let mean = sum.map(|s| (s / (FINE * FINE) as f32).round() as u8);
            pixel[..3].copy_from_slice(&mean);
            pixel[3] = 255;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = [255, 0, 0];
    const BLUE: Rgb = [0, 0, 255];

    /// A square of two triangles from the corner (10, 10) to (90, 90) at a depth; `height` 0 is red, 1 is blue.
    fn square(depth: f64, height: f64) -> [[Corner; 3]; 2] {
        let corner = |x: f64, y: f64| Corner { at: DVec3::new(x, y, depth), height, light: 1.0 };
        let [a, b, c, d] = [corner(10.0, 10.0), corner(90.0, 10.0), corner(90.0, 90.0), corner(10.0, 90.0)];
        // One each way round.
        [[a, b, c], [a, d, c]]
    }

    fn picture(triangles: &[[Corner; 3]], pieces: &[Piece]) -> Vec<u8> {
        let styles = [Style { color: [0, 0, 0], width: 2.0, alpha: 1.0, dashes: None }];
        draw(&Scene {
            size: (100, 100),
            triangles: triangles.len() as u32,
            corners: |t: u32| Some(triangles[t as usize]),
            paint: |_: u32, height: f64, _: f64| if height < 0.5 { RED } else { BLUE },
            pieces,
            styles: &styles,
        })
    }

    fn at(picture: &[u8], x: usize, y: usize) -> Rgb {
        let i = (y * 100 + x) * 4;
        [picture[i], picture[i + 1], picture[i + 2]]
    }

    #[test]
    fn the_nearer_one_is_seen_whatever_comes_first() {
        let far: Vec<_> = [square(0.0, 0.0), square(5.0, 1.0)].concat();
        let near: Vec<_> = [square(5.0, 1.0), square(0.0, 0.0)].concat();
        assert!(picture(&far, &[]) == picture(&near, &[]));
        let seen = picture(&far, &[]);
        // All of the square, its diagonal too, and nothing beside it.
        for y in 0..100 {
            for x in 0..100 {
                let inside = (10..90).contains(&x) && (10..90).contains(&y);
                assert_eq!(at(&seen, x, y), if inside { BLUE } else { PAPER }, "{x} {y}");
            }
        }
    }

    #[test]
    fn lines_are_hidden_by_what_lies_in_front() {
        let line =
            |depth: f64| Piece { ends: [DVec3::new(0.0, 50.0, depth), DVec3::new(100.0, 50.0, depth)], style: 1 };
        let in_front = picture(&square(10.0, 0.0), &[line(10.0)]);
        assert_eq!((at(&in_front, 50, 50), at(&in_front, 5, 50), at(&in_front, 50, 53)), ([0; 3], [0; 3], RED));
        let behind = picture(&square(10.0, 0.0), &[line(0.0)]);
        assert_eq!((at(&behind, 50, 50), at(&behind, 5, 50)), (RED, [0; 3]));
    }

    #[test]
    fn what_cannot_be_drawn_is_passed_over() {
        let mut odd = square(0.0, 0.0);
        odd[0][1].at = DVec3::NAN;
        odd[1][0].at = DVec3::new(-1e12, -1e12, 0.0);
        let far = DVec3::new(1e300, -1e300, 0.0);
        let pieces = [DVec3::NAN, far].map(|end| Piece { ends: [end, DVec3::splat(50.0)], style: 1 });
        assert_eq!(picture(&odd, &pieces).len(), 40_000);
    }
}
