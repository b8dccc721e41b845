//! The choice of the lines that are drawn, their strength and their strokes.
//!
//! Lines closer together than a few pixels would blacken the picture. The mean spacing of a set of lines is the map's
//! area divided by their length. The narrower it is, the fainter the lines; if it is too narrow, only every second,
//! fifth, tenth ... level is drawn. For interpolated levels the step must divide the input's interval evenly; if no
//! such step exists, none of them is drawn. The legend says what is drawn.

use glam::DVec2;
use tiny_skia::{LineCap, LineJoin, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use super::canvas::paint;
use super::color::{CANYON, CONTOUR, RIDGE, Rgb};
use crate::base::Grid;
use crate::contour::{ContourLine, Source};
use crate::skeleton::{BreakKind, BreakLine};

/// Input contours are thinned out below this mean spacing, pixels.
const INPUT_SPACING: f64 = 3.0;
/// Interpolated contours are thinned out below this mean spacing of all lines, pixels.
const ALL_SPACING: f64 = 2.0;
/// From this mean spacing on, lines are drawn at full strength, pixels.
const EASY_SPACING: f64 = 12.0;
/// Interpolated levels are thinned out by this factor at most.
const MOST_PARTS: u32 = 50;
/// Levels closer than this are the same, metres.
const SAME_LEVEL: f64 = 1e-6;
/// Lines are cut off this far beyond the map, so that no cut end shows, pixels.
const BLEED: f64 = 8.0;
/// Vertices closer than this to the last one are left out, pixels.
const FINE: f64 = 0.3;

/// The look of a kind of line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Style {
    pub color: Rgb,
    /// Pixels.
    pub width: f32,
    /// 0 to 1.
    pub alpha: f32,
    /// Lengths of dashes and of the gaps between them, pixels.
    pub dashes: Option<[f32; 2]>,
}

/// Dashes of inferred lines, where the contours say little about the height.
const DASHES: [f32; 2] = [4.0, 3.0];

pub(super) const RIDGE_STYLE: Style = Style { color: RIDGE, width: 1.7, alpha: 0.92, dashes: None };
pub(super) const CANYON_STYLE: Style = Style { color: CANYON, width: 1.7, alpha: 0.92, dashes: None };

/// What is drawn of one source of contours.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Class {
    /// How the levels follow each other, if there is more than one.
    spacing: Option<Spacing>,
    /// Every n-th level is drawn; `None` if the lines are too dense and none is drawn.
    pub every: Option<u32>,
    /// Whether any of the drawn lines is an index contour.
    pub has_index: bool,
    pub style: Style,
    pub index_style: Style,
    /// Whether any of the drawn lines is only inferred.
    pub has_inferred: bool,
}

/// What is drawn of the contours; `None` where there are none of the kind.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plan {
    /// The contours of the input, or those of a height map.
    pub input: Option<Class>,
    pub interpolated: Option<Class>,
    /// Whether the contours are those of a height map.
    pub of_height_map: bool,
}

/// The kind of line that a line is drawn as. Lines of a height map are drawn like those of the input.
pub(super) fn drawn_as(line: &ContourLine) -> Source {
    match line.source {
        Source::Input | Source::HeightMap => Source::Input,
        Source::Interpolated => Source::Interpolated,
    }
}

/// Chooses the levels to draw on a map of `area` pixels.
pub(super) fn plan(contours: &[ContourLine], grid: &Grid, area: f64) -> Plan {
    let levels = |source| levels(contours.iter().filter(|c| drawn_as(c) == source), grid);
    let (input, new) = (levels(Source::Input), levels(Source::Interpolated));
    let spacing = self::spacing(&input);
    let mut drawn = 0.0;
    let input_class = (!input.is_empty()).then(|| {
        let every = steps().find(|&every| length(&input, spacing, every) * INPUT_SPACING <= area);
        drawn = every.map_or(0.0, |every| length(&input, spacing, every));
        let strength = strength(area / drawn, INPUT_SPACING);
        let style = Style { color: CONTOUR, width: 0.95 + 0.55 * strength, alpha: 0.72 + 0.2 * strength, dashes: None };
        let index_style = Style { width: style.width * 1.45, alpha: 0.95, ..style };
        Class { spacing, every, has_index: false, style, index_style, has_inferred: false }
    });
    let new_class = (!new.is_empty()).then(|| {
        let mut all: Vec<(f64, f64)> = input.iter().chain(&new).copied().collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all = self::spacing(&all);
        let even = |every: &u32| match (all, spacing) {
            (Some(all), Some(input)) => {
                let parts = input.interval / (all.interval * f64::from(*every));
                *every == 1 || (parts > 1.5 && (parts - parts.round()).abs() < 1e-6)
            }
            _ => *every == 1,
        };
        let fits = |every: &u32| (drawn + length(&new, all, *every)) * ALL_SPACING <= area;
        let every = (1..=MOST_PARTS).filter(even).find(fits);
        let total = drawn + every.map_or(0.0, |every| length(&new, all, every));
        let strength = strength(area / total, ALL_SPACING);
        let style =
            Style { color: CONTOUR, width: 0.55 + 0.35 * strength, alpha: 0.36 + 0.36 * strength, dashes: None };
        let index_style = Style { width: style.width * 1.5, alpha: (style.alpha + 0.15).min(1.0), ..style };
        Class { spacing: all, every, has_index: false, style, index_style, has_inferred: false }
    });
    let of_height_map = contours.iter().any(|line| line.source == Source::HeightMap);
    let mut plan = Plan { input: input_class, interpolated: new_class, of_height_map };
    for line in contours.iter().filter(|line| line.index || is_inferred(line)) {
        let class = match line.source {
            Source::Input | Source::HeightMap => plan.input.as_mut(),
            Source::Interpolated => plan.interpolated.as_mut(),
        };
        if let Some(class) = class {
            let draws = class.draws(line.elevation);
            class.has_index |= draws && line.index;
            class.has_inferred |= draws && is_inferred(line);
        }
    }
    plan
}

impl Class {
    /// The usual step between neighbouring levels, metres.
    pub fn interval(&self) -> Option<f64> {
        self.spacing.map(|spacing| spacing.interval)
    }

    /// Whether lines of this elevation are drawn.
    pub fn draws(&self, elevation: f64) -> bool {
        self.every.is_some_and(|every| keeps(elevation, self.spacing, every))
    }
}

/// 0 at the narrowest spacing that is drawn, 1 from the spacing of full strength on.
fn strength(spacing: f64, narrowest: f64) -> f32 {
    ((spacing - narrowest) / (EASY_SPACING - narrowest)).clamp(0.0, 1.0) as f32
}

/// 1, 2, 5, 10, 20 ...
fn steps() -> impl Iterator<Item = u32> {
    (0..6).flat_map(|exponent| [1, 2, 5].map(|digit| digit * 10_u32.pow(exponent)))
}

/// The levels in increasing order with the length of their lines on the map, pixels.
fn levels<'a>(lines: impl Iterator<Item = &'a ContourLine>, grid: &Grid) -> Vec<(f64, f64)> {
    let rim = DVec2::new(grid.cols as f64, grid.rows as f64) + BLEED;
    let mut all: Vec<(f64, f64)> = lines
        .filter(|line| line.elevation.is_finite())
        .map(|line| {
            let pixels = |p: DVec2| to_pixels(grid, p);
            let clipped = line.points.windows(2).filter_map(|w| clip(pixels(w[0]), pixels(w[1]), rim));
            (line.elevation, clipped.map(|(a, b)| a.distance(b)).sum())
        })
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.dedup_by(|next, kept| {
        let same = next.0 - kept.0 < SAME_LEVEL;
        if same {
            kept.1 += next.1;
        }
        same
    });
    all
}

/// The commonest step between neighbouring levels; of equally common ones the smallest.
fn spacing(levels: &[(f64, f64)]) -> Option<Spacing> {
    let gap = |w: &[(f64, f64)]| w[1].0 - w[0].0;
    let mut gaps: Vec<f64> = levels.windows(2).map(gap).collect();
    gaps.sort_by(f64::total_cmp);
    let runs = gaps.chunk_by(|a, b| b - a < SAME_LEVEL);
    let longest = runs.clone().map(<[f64]>::len).max()?;
    let interval = runs.into_iter().find(|run| run.len() == longest)?[0];
    let base = levels.windows(2).find(|w| (gap(w) - interval).abs() < SAME_LEVEL)?[0].0.rem_euclid(interval);
    let base = if interval - base < SAME_LEVEL { 0.0 } else { base };
    Some(Spacing { interval, base })
}

/// Levels that are whole multiples of an interval above a base.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Spacing {
    interval: f64,
    base: f64,
}

/// Whether a level is among every `every`-th of the spaced levels.
fn keeps(elevation: f64, spacing: Option<Spacing>, every: u32) -> bool {
    match spacing {
        _ if every == 1 => true,
        Some(Spacing { interval, base }) => {
            let step = interval * f64::from(every);
            let count = (elevation - base) / step;
            (count - count.round()).abs() * step < interval * 1e-3
        }
        None => false,
    }
}

fn length(levels: &[(f64, f64)], spacing: Option<Spacing>, every: u32) -> f64 {
    levels.iter().filter(|(level, _)| keeps(*level, spacing, every)).map(|(_, length)| length).sum()
}

/// Draws the contours of the plan, the interpolated ones below the input's, and the break lines above both.
pub(super) fn draw(map: &mut Pixmap, grid: &Grid, contours: &[ContourLine], plan: &Plan, break_lines: &[BreakLine]) {
    for (source, class) in [(Source::Interpolated, &plan.interpolated), (Source::Input, &plan.input)] {
        let Some(class) = class else { continue };
        for (index, style) in [(false, class.style), (true, class.index_style)] {
            for (inferred, style) in [(false, style), (true, dashed(style))] {
                let lines = contours.iter().filter(|c| {
                    drawn_as(c) == source && c.index == index && is_inferred(c) == inferred && class.draws(c.elevation)
                });
                stroke(map, path(grid, lines.map(|c| c.points.iter().copied())), style);
            }
        }
    }
    for (kind, style) in [(BreakKind::Canyon, CANYON_STYLE), (BreakKind::Ridge, RIDGE_STYLE)] {
        let lines = break_lines.iter().filter(|line| line.kind == kind);
        stroke(map, path(grid, lines.map(|line| line.points.iter().map(|p| p.truncate()))), style);
    }
}

/// Whether a line is inferred: the contours say little about the height there.
pub(super) fn is_inferred(line: &ContourLine) -> bool {
    line.expected.is_some_and(|expected| expected.inferred)
}

/// The style of lines that are only inferred.
pub(super) fn dashed(style: Style) -> Style {
    Style { dashes: Some(DASHES), ..style }
}

/// Strokes a path, if there is one.
pub(super) fn stroke(pixmap: &mut Pixmap, path: Option<Path>, style: Style) {
    let Some(path) = path else { return };
    // Round ends would fill the gaps between dashes.
    let line_cap = if style.dashes.is_some() { LineCap::Butt } else { LineCap::Round };
    let dash = style.dashes.and_then(|[line, gap]| StrokeDash::new(vec![line, gap], 0.0));
    let stroke = Stroke { width: style.width, line_cap, line_join: LineJoin::Round, dash, ..Stroke::default() };
    pixmap.stroke_path(&path, &paint(style.color, style.alpha), &stroke, Transform::identity(), None);
}

/// The lines as one path in pixels, cut off a little outside the map and no finer than the eye can see.
fn path<P: Iterator<Item = DVec2>>(grid: &Grid, lines: impl Iterator<Item = P>) -> Option<Path> {
    let rim = DVec2::new(grid.cols as f64, grid.rows as f64) + BLEED;
    let mut path = PathBuilder::new();
    for line in lines {
        let (mut start, mut pen): (Option<DVec2>, Option<DVec2>) = (None, None);
        let mut points = line.map(|p| to_pixels(grid, p)).peekable();
        while let Some(point) = points.next() {
            let Some(from) = start else {
                start = Some(point);
                continue;
            };
            if from.distance_squared(point) < FINE * FINE && points.peek().is_some() {
                continue;
            }
            start = Some(point);
            let Some((a, b)) = clip(from, point, rim) else {
                pen = None;
                continue;
            };
            if pen != Some(a) {
                path.move_to(a.x as f32, a.y as f32);
            }
            path.line_to(b.x as f32, b.y as f32);
            pen = Some(b);
        }
    }
    path.finish()
}

/// Map units to pixels of the map, the y axis downwards.
pub(super) fn to_pixels(grid: &Grid, point: DVec2) -> DVec2 {
    DVec2::new(point.x - grid.corner.x, grid.corner.y - point.y) / grid.cell
}

/// The part of a segment between -[`BLEED`] and `rim` in both axes (Liang and Barsky 1984).
fn clip(a: DVec2, b: DVec2, rim: DVec2) -> Option<(DVec2, DVec2)> {
    if !(a.is_finite() && b.is_finite()) {
        return None;
    }
    let along = b - a;
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (start, step, high) in [(a.x, along.x, rim.x), (a.y, along.y, rim.y)] {
        if step == 0.0 {
            if start < -BLEED || start > high {
                return None;
            }
            continue;
        }
        let (low, high) = ((-BLEED - start) / step, (high - start) / step);
        (first, last) = (first.max(low.min(high)), last.min(low.max(high)));
    }
    // The ends stay bit for bit what they were where nothing is cut off.
    let at = |share: f64, end: DVec2, whole: f64| if share == whole { end } else { a + along * share };
    (first <= last).then(|| (at(first, a, 0.0), at(last, b, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { corner: DVec2::new(0.0, 100.0), cell: DVec2::ONE, cols: 100, rows: 100 };
    const AREA: f64 = 10_000.0;

    /// Level lines across the whole map, at heights equal to their y.
    fn lines(step: f64, source: Source) -> Vec<ContourLine> {
        (0..=(100.0 / step) as usize)
            .map(|i| {
                let y = i as f64 * step;
                let points = vec![DVec2::new(0.0, y), DVec2::new(100.0, y)];
                ContourLine { elevation: y, points, source, index: false, depression: false, expected: None }
            })
            .collect()
    }

    #[test]
    fn sparse_lines_are_all_drawn() {
        let mut all = lines(20.0, Source::Input);
        all.extend(lines(10.0, Source::Interpolated));
        all[0].index = true;
        let plan = plan(&all, &GRID, AREA);
        let (input, new) = (plan.input.unwrap(), plan.interpolated.unwrap());
        assert_eq!((input.interval(), input.every, input.has_index), (Some(20.0), Some(1), true));
        assert_eq!((new.interval(), new.every, new.has_index), (Some(10.0), Some(1), false));
    }

    #[test]
    fn dense_lines_are_thinned_by_levels_and_at_last_left_out() {
        let mut all = lines(20.0, Source::Input);
        all.extend(lines(1.0, Source::Interpolated));
        let new = plan(&all, &GRID, AREA).interpolated.unwrap();
        assert_eq!((new.interval(), new.every), (Some(1.0), Some(4)));
        assert!(new.draws(32.0) && !new.draws(30.0));
        let mut all = lines(2.0, Source::Input);
        all.extend(lines(1.0, Source::Interpolated));
        let plan = plan(&all, &GRID, AREA);
        assert_eq!(plan.input.unwrap().every, Some(2));
        assert_eq!(plan.interpolated.unwrap().every, None);
    }

    #[test]
    fn the_commonest_step_is_the_interval() {
        let levels = [0.0, 5.0, 10.0, 20.0, 30.0, 40.0].map(|level| (level, 1.0));
        assert_eq!(spacing(&levels), Some(Spacing { interval: 10.0, base: 0.0 }));
        assert_eq!(spacing(&levels[..1]), None);
        assert_eq!(spacing(&[]), None);
        let shifted = spacing(&[-8.5, 1.5, 11.5, 21.5].map(|level| (level, 1.0)));
        assert_eq!(shifted, Some(Spacing { interval: 10.0, base: 1.5 }));
        assert!(keeps(-18.5, shifted, 2) && !keeps(-8.5, shifted, 2) && keeps(1.5, shifted, 2));
    }

    #[test]
    fn segments_are_cut_at_the_rim() {
        let rim = DVec2::splat(108.0);
        let cut = |a, b| clip(a, b, rim);
        let inside = (DVec2::new(0.1, 0.7), DVec2::new(99.3, 50.0));
        assert_eq!(cut(inside.0, inside.1), Some(inside));
        assert_eq!(
            cut(DVec2::new(-1e9, 50.0), DVec2::new(1e9, 50.0)),
            Some((DVec2::new(-8.0, 50.0), DVec2::new(108.0, 50.0)))
        );
        assert_eq!(cut(DVec2::new(-20.0, 0.0), DVec2::new(0.0, -20.0)), None);
        assert_eq!(cut(DVec2::new(f64::NAN, 0.0), DVec2::ZERO), None);
        assert_eq!(cut(DVec2::new(200.0, 3.0), DVec2::new(200.0, 5.0)), None);
    }
}
