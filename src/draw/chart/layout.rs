//! Where the axes, lines and texts of a chart lie.

use super::shapes::{Drawing, Shape};
use super::{Chart, Panel, Series};
use crate::preview::color::{INK, Rgb};
use crate::preview::text::{Align, Typesetter};
use crate::scale;

/// Width of a panel's field in the only column, and in one of several; pixels.
const WIDTHS: [f64; 2] = [1200.0, 520.0];
/// Its height if nothing else is said, and the least and the greatest.
const USUAL: [f64; 2] = [460.0, 260.0];
const HEIGHTS: [f64; 2] = [120.0, 2000.0];
/// Space on the left, above, on the right and below a field.
const MARGINS: [f64; 4] = [84.0, 48.0, 30.0, 58.0];
/// So many panels stand below each other before there are two columns.
const ONE_COLUMN: usize = 2;
const LETTERS: f32 = 16.0;
const TITLE: f32 = 21.0;
const GRID: Rgb = [222, 220, 216];
/// Colours of the lines: of A, B and further ones.
const COLORS: [Rgb; 4] = [[178, 60, 30], [30, 80, 170], [20, 120, 70], [120, 60, 140]];
/// Share of the range of heights that is left free above and below.
const FREE: f64 = 0.06;

/// The range of the finite values; never empty.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [lo, hi] = values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], value| [lo.min(value), hi.max(value)]);
    match (lo.is_finite(), hi > lo) {
        (false, _) => [0.0, 1.0],
        (true, false) => [lo - 0.5, hi + 0.5],
        (true, true) => [lo, hi],
    }
}

pub(super) fn layout(chart: &Chart) -> Drawing {
    let columns = if chart.panels.len() > ONE_COLUMN { 2 } else { 1 };
    let width = WIDTHS[columns - 1];
    let mut shapes = Vec::new();
    let setter = Typesetter::new();
    let across = width + MARGINS[0] + MARGINS[2];
    let mut top = 16.0;
    if !chart.title.is_empty() {
        top += 26.0;
        shapes.push(Shape::Text { text: chart.title.clone(), at: [20.0, top], size: TITLE, align: Align::Left });
    }
    top = legend(&chart.panels, top, across * columns as f64, &setter, &mut shapes);
    for row in chart.panels.chunks(columns) {
        let tallest = row.iter().map(|panel| Field::of(panel, width, columns).height).fold(0.0, f64::max);
        for (k, panel) in row.iter().enumerate() {
            let field = Field::of(panel, width, columns);
            field.draw(panel, [k as f64 * across + MARGINS[0], top + MARGINS[1]], &mut shapes);
        }
        top += tallest + MARGINS[1] + MARGINS[3];
    }
    Drawing { size: [across * columns as f64, top], shapes }
}

/// The legend, if there is more than one line, or a band. Gives where the panels start.
fn legend(panels: &[Panel], top: f64, across: f64, setter: &Typesetter, shapes: &mut Vec<Shape>) -> f64 {
    let Some(panel) = panels.iter().max_by_key(|panel| panel.series.len()) else { return top };
    let mut keys: Vec<(String, Rgb, bool)> = Vec::new();
    for (series, color) in panel.series.iter().zip(COLORS.iter().cycle()) {
        keys.push((series.name.clone(), *color, false));
        if !series.band.is_empty() {
            keys.push(("standard error".into(), *color, true));
        }
    }
    let (mut x, mut y) = (20.0, top + 26.0);
    for (name, color, is_band) in keys.into_iter().filter(|(name, ..)| !name.is_empty()) {
        let width = f64::from(setter.width(&name, LETTERS)) + 70.0;
        if x > 20.0 && x + width > across {
            (x, y) = (20.0, y + 24.0);
        }
        let [left, right, middle] = [x, x + 32.0, y - 5.0];
        shapes.push(if is_band {
            let points = vec![[left, middle - 6.0], [right, middle - 6.0], [right, middle + 6.0], [left, middle + 6.0]];
            Shape::Area { points, color, alpha: 0.25 }
        } else {
            Shape::Line { points: vec![[left, middle], [right, middle]], color, width: 2.5 }
        });
        shapes.push(Shape::Text { text: name, at: [x + 40.0, y], size: LETTERS, align: Align::Left });
        x += width;
    }
    y
}

/// The field of a panel: what it shows, and its size in pixels.
struct Field {
    x: [f64; 2],
    y: [f64; 2],
    width: f64,
    height: f64,
}

impl Field {
    fn of(panel: &Panel, width: f64, columns: usize) -> Self {
        let points = || panel.series.iter().flat_map(|series| &series.points);
        let x = range(points().map(|point| point[0]));
        let [lo, hi] = range(panel.series.iter().flat_map(|series| {
            let band = |k: usize| series.band.get(k).copied().filter(|band| band.is_finite()).unwrap_or(0.0);
            series.points.iter().enumerate().flat_map(move |(k, point)| [point[1] - band(k), point[1] + band(k)])
        }));
        let free = FREE * (hi - lo);
        let mut y = [lo - free, hi + free];
        let per_unit = width / (x[1] - x[0]);
        let height = panel.exaggeration.map_or(USUAL[columns - 1], |factor| factor * per_unit * (y[1] - y[0]));
        if height < HEIGHTS[0] {
            // A low field shows more above and below, so that all fields have the same exaggeration.
            let (middle, half) = ((y[0] + y[1]) / 2.0, (y[1] - y[0]) / 2.0 * HEIGHTS[0] / height);
            y = [middle - half, middle + half];
        }
        Self { x, y, width, height: height.clamp(HEIGHTS[0], HEIGHTS[1]) }
    }

    /// Draws it with its upper left corner at a place.
    fn draw(&self, panel: &Panel, corner: [f64; 2], shapes: &mut Vec<Shape>) {
        let [left, top] = corner;
        let (right, bottom) = (left + self.width, top + self.height);
        let at = |[x, y]: [f64; 2]| {
            [
                left + (x - self.x[0]) / (self.x[1] - self.x[0]) * self.width,
                bottom - (y - self.y[0]) / (self.y[1] - self.y[0]) * self.height,
            ]
        };
        let text = |text: String, at: [f64; 2], align| Shape::Text { text, at, size: LETTERS, align };
        for tick in ticks(self.x, self.width / 90.0) {
            let x = at([tick, self.y[0]])[0];
            shapes.push(Shape::Line { points: vec![[x, top], [x, bottom]], color: GRID, width: 1.0 });
            shapes.push(text(scale::number(tick), [x, bottom + 20.0], Align::Center));
        }
        for tick in ticks(self.y, self.height / 32.0) {
            let y = at([self.x[0], tick])[1];
            shapes.push(Shape::Line { points: vec![[left, y], [right, y]], color: GRID, width: 1.0 });
            shapes.push(text(scale::number(tick), [left - 8.0, y + 5.0], Align::Right));
        }
        for (series, color) in panel.series.iter().zip(COLORS.iter().cycle()) {
            draw_series(series, *color, &at, shapes);
        }
        let frame = vec![[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
        shapes.push(Shape::Line { points: frame, color: INK, width: 1.2 });
        shapes.push(text(panel.labels[0].clone(), [left + self.width / 2.0, bottom + 42.0], Align::Center));
        // What the field shows, not what was asked for: its height has limits.
        let shown = self.height / (self.y[1] - self.y[0]) / (self.width / (self.x[1] - self.x[0]));
        let factor =
            panel.exaggeration.map(|_| format!("heights x {}", scale::number((shown * 100.0).round() / 100.0)));
        let above = [panel.labels[1].clone(), panel.title.clone()].into_iter().chain(factor);
        let above: Vec<String> = above.filter(|text| !text.is_empty()).collect();
        shapes.push(text(above.join("  ·  "), [left, top - 10.0], Align::Left));
    }
}

/// A line and its band, interrupted where there is no number.
fn draw_series(series: &Series, color: Rgb, at: &impl Fn([f64; 2]) -> [f64; 2], shapes: &mut Vec<Shape>) {
    let is_known = |point: &[f64; 2]| point.iter().all(|number| number.is_finite());
    let mut start = 0;
    while start < series.points.len() {
        let length = series.points[start..].iter().take_while(|point| is_known(point)).count();
        let run = &series.points[start..start + length];
        let bands = series.band.get(start..start + length).unwrap_or_default();
        if run.len() > 1 {
            let edge = |sign: f64| {
                run.iter()
                    .zip(bands)
                    .map(move |([x, y], band)| [*x, y + sign * if band.is_finite() { *band } else { 0.0 }])
            };
            if bands.len() == run.len() {
                let points = edge(1.0).chain(edge(-1.0).rev()).map(at).collect();
                shapes.push(Shape::Area { points, color, alpha: 0.25 });
            }
            shapes.push(Shape::Line { points: run.iter().copied().map(at).collect(), color, width: 2.2 });
        }
        start += length + 1;
    }
}

/// Round numbers in a range, about `count` of them.
fn ticks([lo, hi]: [f64; 2], count: f64) -> Vec<f64> {
    let Some(step) = scale::round_up((hi - lo) / count.max(1.0)) else { return Vec::new() };
    let (first, last) = ((lo / step).ceil(), (hi / step).floor());
    (0..=(last - first).max(0.0) as usize).map(|k| (first + k as f64) * step).collect()
}
