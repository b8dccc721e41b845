//! The charts of the page, as SVG.
//!
//! They are small and have large letters, so that they can be read on a phone.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::profile::Profile;
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::dem::compare::{Comparison, LevelHistogram};

/// Width and height, in units that are pixels at full size.
const SIZE: (u32, u32) = (540, 360);
/// Height of letters in the same units.
const LETTERS: f64 = 18.0;
/// A's colour and B's.
const A: RGBColor = RGBColor(178, 60, 30);
const B: RGBColor = RGBColor(30, 80, 150);
const BARS: RGBColor = RGBColor(112, 128, 144);
/// Bars of the histogram of differences; an odd number, so that one bar is centred on 0.
const BARS_COUNT: usize = 51;
/// Cells of the scatter plot along each axis.
const SCATTER: usize = 72;

/// Counts for the histogram of the differences. Those beyond 1.5 times LE95 are counted in the outermost bars.
pub(super) struct Bars {
    limit: f64,
    width: f64,
    counts: [usize; BARS_COUNT],
}

impl Bars {
    pub fn new(found: &Comparison) -> Self {
        let limit = (1.5 * found.overall.le95).max(1e-3);
        Self { limit, width: 2.0 * limit / BARS_COUNT as f64, counts: [0; BARS_COUNT] }
    }

    /// Counts a difference.
    pub fn add(&mut self, difference: f32) {
        let bar = ((f64::from(difference) + self.limit) / self.width).floor().clamp(0.0, BARS_COUNT as f64 - 1.0);
        self.counts[bar as usize] += 1;
    }
}

/// Histogram of the differences.
pub(super) fn difference_histogram(&Bars { limit, width, counts: bars }: &Bars, found: &Comparison) -> Result<String> {
    let share = |n: usize| 100.0 * n as f64 / found.overall.cells as f64;
    let top = share(bars.iter().copied().max().unwrap_or(0)).max(1e-3) * 1.08;
    draw(|root| {
        let mut chart = frame(&root)?.build_cartesian_2d(-limit..limit, 0.0..top)?;
        let label = format!("A − B [{}]; outer bars: and beyond", found.unit.symbol());
        mesh(&mut chart, &label, "cells [%]")?;
        let bar = |(i, &n): (usize, &usize)| {
            let left = -limit + i as f64 * width;
            Rectangle::new([(left, 0.0), (left + width * 0.94, share(n))], BARS.filled())
        };
        chart.draw_series(bars.iter().enumerate().map(bar))?;
        chart.draw_series(LineSeries::new([(0.0, 0.0), (0.0, top)], BLACK.mix(0.5)))?;
        let bias = found.overall.bias.clamp(-limit, limit);
        chart.draw_series(LineSeries::new([(bias, 0.0), (bias, top)], A.stroke_width(2)))?;
        Ok(())
    })
}

/// Counts of cells by their heights in A and in B.
pub(super) struct Pairs {
    lo: f64,
    hi: f64,
    size: f64,
    counts: Vec<u64>,
}

impl Pairs {
    /// Counts for heights from the first to the second.
    pub fn new(heights: (f32, f32)) -> Self {
        let (lo, hi) = range([heights.0, heights.1].into_iter().map(f64::from));
        Self { lo, hi, size: (hi - lo) / SCATTER as f64, counts: vec![0; SCATTER * SCATTER] }
    }

    /// Counts a cell.
    pub fn add(&mut self, a: f32, b: f32) {
        let bin = |v: f32| (((f64::from(v) - self.lo) / self.size) as usize).min(SCATTER - 1);
        let i = bin(a) * SCATTER + bin(b);
        self.counts[i] += 1;
    }
}

/// Heights of A against heights of B; darker means more cells.
pub(super) fn scatter(Pairs { lo, hi, size, counts }: &Pairs, unit: ElevationUnit) -> Result<String> {
    let (lo, hi, size) = (*lo, *hi, *size);
    let most = counts.iter().copied().max().unwrap_or(1).max(2) as f64;
    draw(|root| {
        let mut chart = frame(&root)?.build_cartesian_2d(lo..hi, lo..hi)?;
        let [b, a] = ["B", "A"].map(|side| format!("height of {side} [{}]", unit.symbol()));
        mesh(&mut chart, &b, &a)?;
        let filled = counts.iter().enumerate().filter(|(_, n)| **n > 0);
        chart.draw_series(filled.map(|(i, &n)| {
            let (x, y) = (lo + (i % SCATTER) as f64 * size, lo + (i / SCATTER) as f64 * size);
            // By logarithm, so that single cells are seen beside thousands.
            let ink = 0.25 + 0.75 * (n as f64).ln() / most.ln();
            Rectangle::new([(x, y), (x + size, y + size)], B.mix(ink.clamp(0.0, 1.0)).filled())
        }))?;
        chart.draw_series(LineSeries::new([(lo, lo), (hi, hi)], A))?;
        Ok(())
    })
}

/// Heights of both along a line.
pub(super) fn profile(profile: &Profile, unit: ElevationUnit) -> Result<String> {
    let length = profile.points.last().map_or(0.0, |p| p.0).max(1e-3);
    let (lo, hi) = range(profile.points.iter().flat_map(|p| p.1));
    draw(|root| {
        let mut chart = frame(&root)?.build_cartesian_2d(0.0..length, lo..hi)?;
        let unit = unit.symbol();
        mesh(&mut chart, &format!("from west to east [{unit}]"), &format!("height [{unit}]"))?;
        for (side, color) in [(1, B), (0, A)] {
            for run in profile.points.split(|p| p.1[side].is_nan()).filter(|run| run.len() > 1) {
                chart.draw_series(LineSeries::new(run.iter().map(|p| (p.0, p.1[side])), color.stroke_width(2)))?;
            }
        }
        Ok(())
    })
}

/// Heights modulo the contour interval, of one side or both.
pub(super) fn levels(a: Option<&LevelHistogram>, b: Option<&LevelHistogram>, unit: ElevationUnit) -> Result<String> {
    let interval = a.or(b).map_or(1.0, |h| h.interval);
    let sides = [(a, A), (b, B)].into_iter().filter_map(|(side, color)| Some((side?, color)));
    let sides: Vec<_> = sides.filter(|(side, _)| side.interval == interval).collect();
    let interval = unit.about(interval);
    let top = sides.iter().flat_map(|(side, _)| &side.shares).fold(0.06, |top: f64, &s| top.max(s)) * 108.0;
    draw(|root| {
        let mut chart = frame(&root)?.build_cartesian_2d(0.0..interval, 0.0..top)?;
        mesh(&mut chart, &format!("height above the level [{}]", unit.symbol()), "cells [%]")?;
        chart.draw_series(LineSeries::new([(0.0, 5.0), (interval, 5.0)], BLACK.mix(0.5)))?;
        for (side, color) in &sides {
            let width = interval / side.shares.len() as f64;
            let steps = side.shares.iter().enumerate().flat_map(|(i, share)| {
                let left = i as f64 * width;
                [(left, 100.0 * share), (left + width, 100.0 * share)]
            });
            chart.draw_series(LineSeries::new(steps, color.stroke_width(2)))?;
        }
        Ok(())
    })
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Calls `content` to draw on white, and returns the SVG.
fn draw(content: impl FnOnce(Area<'_>) -> Drawn) -> Result<String> {
    let mut svg = String::new();
    let drawn = {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        content(root)
    };
    drawn.map_err(|e| Error::Data(format!("a chart of the report cannot be drawn: {e}")))?;
    Ok(svg)
}

fn frame<'a, 'b>(root: &'a Area<'b>) -> Drawn<ChartBuilder<'a, 'b, SVGBackend<'b>>> {
    let mut builder = ChartBuilder::on(root);
    builder.margin(12).margin_right(24).x_label_area_size(54).y_label_area_size(78);
    Ok(builder)
}

fn mesh(
    chart: &mut ChartContext<
        '_,
        SVGBackend<'_>,
        Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
    >,
    x: &str,
    y: &str,
) -> Drawn {
    let letters = ("sans-serif", LETTERS).into_font().color(&BLACK.mix(0.8));
    chart
        .configure_mesh()
        .x_desc(x)
        .y_desc(y)
        .x_labels(6)
        .y_labels(6)
        .x_label_formatter(&|v| label(*v))
        .y_label_formatter(&|v| label(*v))
        .label_style(letters.clone())
        .axis_desc_style(letters)
        .axis_style(BLACK.mix(0.5))
        .bold_line_style(BLACK.mix(0.12))
        .light_line_style(TRANSPARENT)
        .draw()?;
    Ok(())
}

/// A label without the rounding errors of a sum of steps.
fn label(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded }).replace('-', "−")
}

/// The range of numbers, a little widened, never empty.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|v| v.is_finite());
    let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    if lo > hi {
        return (0.0, 1.0);
    }
    let margin = (0.03 * (hi - lo)).max(1e-6 * hi.abs().max(lo.abs())).max(0.1);
    (lo - margin, hi + margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_never_empty() {
        for values in [vec![], vec![5.0, 5.0], vec![f64::NAN], vec![1e9, 1e9], vec![-3.0, 900.0]] {
            let (lo, hi) = range(values.iter().copied());
            assert!(lo < hi, "{values:?}");
        }
    }

    #[test]
    fn an_empty_profile_is_a_chart_without_lines() {
        let svg = profile(&Profile { ends: [glam::DVec2::ZERO; 2], points: Vec::new() }, ElevationUnit::Metre).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("viewBox"), "{svg}");
    }
}
