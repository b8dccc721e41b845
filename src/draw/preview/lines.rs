//! Contours, ridge and canyon lines on the map.

use tiny_skia::{Mask, Pixmap};

use super::plan::{Class, Plan, drawn_as, is_inferred};
use super::skeleton_lines::Chosen;
use super::stroke::{dashed, path, skeleton_style, stroke};
use tokosen_core::base::Grid;
use tokosen_core::contour::{ContourLine, Source};
use tokosen_core::skeleton::SkeletonKind;

/// Draws the contours of the plan, the interpolated ones below the input's, and the break lines above both. The mask is
/// closed where labels are.
pub(super) fn draw(
    map: &mut Pixmap,
    grid: &Grid,
    contours: &[ContourLine],
    plan: &Plan,
    skeleton_lines: &Chosen,
    mask: Option<&Mask>,
) {
    for (kind, style) in &plan.supplementary {
        let lines = contours.iter().filter(|line| line.kind == Some(*kind));
        stroke(map, path(grid, lines.map(|c| c.points.iter().copied())), *style, mask);
    }
    for source in [Source::Interpolated, Source::Input] {
        let Some(class) = plan.class(source) else { continue };
        let faded = mask.filter(|_| class.fades).map(|mask| faded(mask, class, grid));
        for (index, style, mask) in [(false, class.style, faded.as_ref().or(mask)), (true, class.index_style, mask)] {
            for (inferred, style) in [(false, style), (true, dashed(style))] {
                let lines = contours.iter().filter(|c| {
                    drawn_as(c) == source && plan.draws(c) && plan.is_index(c) == index && is_inferred(c) == inferred
                });
                stroke(map, path(grid, lines.map(|c| c.points.iter().copied())), style, mask);
            }
        }
    }
    for kind in [SkeletonKind::Canyon, SkeletonKind::Ridge] {
        let lines = skeleton_lines.of(kind);
        stroke(
            map,
            path(grid, lines.map(|line| line.iter().map(|p| p.truncate()))),
            skeleton_style(kind, skeleton_lines.width),
            mask,
        );
    }
}

/// The mask, less open where the lines of a class are crowded.
fn faded(mask: &Mask, class: &Class, grid: &Grid) -> Mask {
    let mut faded = mask.clone();
    for (row, pixels) in faded.data_mut().chunks_exact_mut(grid.cols).enumerate() {
        for (col, pixel) in pixels.iter_mut().enumerate() {
            *pixel = (f64::from(*pixel) * class.strength_at(col, row)).round() as u8;
        }
    }
    faded
}
