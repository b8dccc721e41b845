//! Numbers as single strokes: a laser follows them as it follows other lines, and no program needs a font.

use glam::DVec2;

use super::widest::Circle;

/// Largest height of figures, millimetres.
const LARGEST: f64 = 5.0;
/// Share of the circle that the number takes.
const FILLS: f64 = 0.85;
/// A figure is as wide as 1, and this high.
const HEIGHT: f64 = 2.0;
/// From the beginning of a figure to that of the next one.
const ADVANCE: f64 = 1.6;
/// A line below the number tells 6 from 9, and 12 from 21, on a loose piece.
const UNDERLINE: f64 = -0.6;

/// The strokes of the figures.
const STROKES: [&[&[(f64, f64)]]; 10] = [
    &[&[(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0), (0.0, 0.0)]],
    &[&[(0.2, 1.6), (0.6, 2.0), (0.6, 0.0)]],
    &[&[(0.0, 2.0), (1.0, 2.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0), (1.0, 0.0)]],
    &[&[(0.0, 2.0), (1.0, 2.0), (1.0, 0.0), (0.0, 0.0)], &[(0.2, 1.0), (1.0, 1.0)]],
    &[&[(0.0, 2.0), (0.0, 1.0), (1.0, 1.0)], &[(1.0, 2.0), (1.0, 0.0)]],
    &[&[(1.0, 2.0), (0.0, 2.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)]],
    &[&[(1.0, 2.0), (0.0, 2.0), (0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]],
    &[&[(0.0, 2.0), (1.0, 2.0), (0.4, 0.0)]],
    &[&[(0.0, 1.0), (0.0, 2.0), (1.0, 2.0), (1.0, 0.0), (0.0, 0.0), (0.0, 1.0), (1.0, 1.0)]],
    &[&[(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0), (0.0, 1.0), (1.0, 1.0)]],
];

/// The strokes of a number in the middle of a circle, as large as the circle allows.
pub(super) fn numeral(number: u32, circle: Circle) -> Vec<Vec<DVec2>> {
    let figures: Vec<usize> = number.to_string().bytes().map(|byte| usize::from(byte - b'0')).collect();
    let width = ADVANCE * (figures.len() - 1) as f64 + 1.0;
    let (low, high) = (DVec2::new(0.0, UNDERLINE), DVec2::new(width, HEIGHT));
    let scale = (LARGEST / HEIGHT).min(FILLS * 2.0 * circle.radius / low.distance(high));
    let place = |p: DVec2| circle.middle + scale * (p - low.midpoint(high));
    let of_figure = |(k, figure): (usize, usize)| {
        let offset = DVec2::new(ADVANCE * k as f64, 0.0);
        STROKES[figure].iter().map(move |stroke| stroke.iter().map(|p| place(DVec2::from(*p) + offset)).collect())
    };
    let underline = [low, DVec2::new(width, UNDERLINE)].map(place).to_vec();
    figures.into_iter().enumerate().flat_map(of_figure).chain([underline]).collect()
}
