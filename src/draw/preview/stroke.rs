//! Strokes: lines in map units as paths in pixels.

use glam::DVec2;
use tiny_skia::{LineCap, LineJoin, Mask, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use super::canvas::paint;
use super::color::{CANYON, RIDGE, Rgb};
use tokosen_core::base::Grid;
use tokosen_core::skeleton::SkeletonKind;

/// Lines are cut off this far beyond the map, so that no cut end shows, pixels.
const BLEED: f64 = 8.0;
/// Vertices closer than this to the last one are left out, pixels.
pub(crate) const FINE: f64 = 0.3;
/// Dashes of inferred lines, where the contours say little about the height.
const DASHES: [f32; 2] = [4.0, 3.0];

/// The look of a kind of line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Style {
    pub color: Rgb,
    /// Pixels.
    pub width: f32,
    /// 0 to 1.
    pub alpha: f32,
    /// Lengths of dashes and of the gaps between them, pixels.
    pub dashes: Option<[f32; 2]>,
}

/// The look of ridge or canyon lines.
pub(crate) const fn skeleton_style(kind: SkeletonKind, width: f32) -> Style {
    let color = match kind {
        SkeletonKind::Ridge => RIDGE,
        SkeletonKind::Canyon => CANYON,
    };
    Style { color, width, alpha: 0.9, dashes: None }
}

/// The style of lines that are only inferred.
pub(crate) fn dashed(style: Style) -> Style {
    Style { dashes: Some(DASHES), ..style }
}

/// Strokes a path, if there is one, as strongly as the mask says.
pub(crate) fn stroke(pixmap: &mut Pixmap, path: Option<Path>, style: Style, mask: Option<&Mask>) {
    let Some(path) = path else { return };
    // Round ends would fill the gaps between dashes.
    let line_cap = if style.dashes.is_some() { LineCap::Butt } else { LineCap::Round };
    let dash = style.dashes.and_then(|[line, gap]| StrokeDash::new(vec![line, gap], 0.0));
    let stroke = Stroke { width: style.width, line_cap, line_join: LineJoin::Round, dash, ..Stroke::default() };
    pixmap.stroke_path(&path, &paint(style.color, style.alpha), &stroke, Transform::identity(), mask);
}

/// The lines as one path in pixels, cut off a little outside the map and no finer than the eye can see.
pub(crate) fn path<P: Iterator<Item = DVec2>>(grid: &Grid, lines: impl Iterator<Item = P>) -> Option<Path> {
    let rim = rim(grid);
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
pub(crate) fn to_pixels(grid: &Grid, point: DVec2) -> DVec2 {
    DVec2::new(point.x - grid.corner.x, grid.corner.y - point.y) / grid.cell
}

/// The right and the lower limit of what is drawn, pixels.
pub(crate) fn rim(grid: &Grid) -> DVec2 {
    DVec2::new(grid.cols as f64, grid.rows as f64) + BLEED
}

/// The part of a segment between -[`BLEED`] and `rim` in both axes (Liang and Barsky 1984).
pub(crate) fn clip(a: DVec2, b: DVec2, rim: DVec2) -> Option<(DVec2, DVec2)> {
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
