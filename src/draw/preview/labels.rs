//! Elevations on contours.

use glam::DVec2;
use tiny_skia::{FillRule, Mask, PathBuilder, Pixmap, Transform};

use super::color::INPUT;
use super::plan::{Plan, drawn_as};
use super::stroke::{FINE, to_pixels};
use super::text::{Turned, Typesetter};
use tokosen_core::base::{ElevationUnit, Grid};
use tokosen_core::contour::{ContourLine, Source};
use tokosen_core::slice::{Label, LabelParams, place_labels};

/// Size of the text, pixels.
const TEXT: f32 = 13.0;
/// Height of the figures, pixels.
const FIGURES: f64 = 9.0;
/// Free space around a label, pixels.
const CLEARANCE: f64 = 3.0;
/// Lines are interrupted this far around a label, pixels.
const GAP: f64 = 2.0;
/// About this much of a line has one label, pixels.
const SPACING: f64 = 700.0;
/// With fewer levels of index contours than this, all contours of the input have labels.
const FEW_LEVELS: usize = 3;
/// Width of the light rim around the letters, pixels.
const RIM: f32 = 1.0;

/// The labels of the contours that are drawn.
pub(super) fn place(
    contours: &[ContourLine],
    plan: &Plan,
    grid: &Grid,
    unit: ElevationUnit,
    setter: &Typesetter,
) -> Vec<Label> {
    let has_input = plan.input.as_ref().is_some_and(|class| class.every.is_some());
    let is_labelled = |line: &ContourLine| match plan.index_levels < FEW_LEVELS {
        true => drawn_as(line) == Source::Input || !has_input,
        false => plan.is_index(line),
    };
    let drawn: Vec<ContourLine> = contours
        .iter()
        .filter(|line| plan.draws(line))
        .map(|line| ContourLine { index: is_labelled(line), points: coarse(line, grid), ..*line })
        .collect();
    let pixel = grid.cell.x;
    let size = DVec2::new(grid.cols as f64, grid.rows as f64) * pixel;
    let (low, high) =
        (DVec2::new(grid.corner.x, grid.corner.y - size.y), DVec2::new(grid.corner.x + size.x, grid.corner.y));
    let params = LabelParams {
        char_width: f64::from(setter.width("0", TEXT)) * pixel,
        clearance: CLEARANCE * pixel,
        spacing: SPACING * pixel,
        unit,
        within: Some([low + CLEARANCE * pixel, high - CLEARANCE * pixel]),
        ..LabelParams::new(FIGURES * pixel)
    };
    place_labels(&drawn, &params)
}

/// The vertices that make a difference in the picture.
fn coarse(line: &ContourLine, grid: &Grid) -> Vec<DVec2> {
    let fine = FINE * grid.cell.x;
    let mut kept: Vec<DVec2> = Vec::new();
    let last = line.points.len().saturating_sub(1);
    for (k, &point) in line.points.iter().enumerate() {
        if k == 0 || k == last || kept.last().is_none_or(|kept| kept.distance_squared(point) > fine * fine) {
            kept.push(point);
        }
    }
    kept
}

/// A mask that is open everywhere but on the labels.
pub(super) fn gaps(labels: &[Label], grid: &Grid) -> Option<Mask> {
    let mut mask = Mask::new(grid.cols as u32, grid.rows as u32)?;
    for label in labels {
        let mut path = PathBuilder::new();
        for (k, corner) in label.corners(GAP * grid.cell.x).into_iter().enumerate() {
            let at = to_pixels(grid, corner);
            if k == 0 { path.move_to(at.x as f32, at.y as f32) } else { path.line_to(at.x as f32, at.y as f32) }
        }
        path.close();
        if let Some(path) = path.finish() {
            mask.fill_path(&path, FillRule::Winding, true, Transform::identity());
        }
    }
    mask.invert();
    Some(mask)
}

/// Draws the labels.
pub(super) fn draw(map: &mut Pixmap, labels: &[Label], grid: &Grid, setter: &Typesetter) {
    for label in labels {
        let at = to_pixels(grid, label.position);
        let place = Turned { at: (at.x as f32, at.y as f32), turn: -label.angle as f32, rim: RIM };
        setter.draw_turned(map, &label.text, place, TEXT, INPUT);
    }
}

#[cfg(test)]
mod tests {
    use super::super::plan::plan;
    use super::*;

    const GRID: Grid = Grid { corner: DVec2::new(5000.0, 9000.0), cell: DVec2::splat(2.0), cols: 800, rows: 600 };

    /// Rings of a hill every 10 m.
    fn hill(rings: i32) -> Vec<ContourLine> {
        let ring = |k: i32| {
            let angle = |i: i32| -f64::from(i % 360).to_radians();
            let radius = 1000.0 - 60.0 * f64::from(k);
            let points = (0..=360).map(|i| DVec2::new(5800.0, 8400.0) + radius * DVec2::from_angle(angle(i))).collect();
            let (index, elevation) = (k % 5 == 0, f64::from(k) * 10.0);
            ContourLine {
                elevation,
                points,
                source: Source::Input,
                index,
                kind: None,
                depression: false,
                expected: None,
            }
        };
        (0..rings).map(ring).collect()
    }

    #[test]
    fn labels_are_on_index_contours_inside_of_the_map() {
        let contours = hill(15);
        let labels = place(&contours, &plan(&contours, &GRID), &GRID, ElevationUnit::Metre, &Typesetter::new());
        assert!(labels.len() >= 3, "{labels:?}");
        for label in &labels {
            assert!(label.elevation % 50.0 == 0.0 && label.angle > -90.0 && label.angle <= 90.0, "{label:?}");
            for corner in label.corners(0.0) {
                let at = to_pixels(&GRID, corner);
                assert!(at.cmpgt(DVec2::ZERO).all() && at.cmplt(DVec2::new(800.0, 600.0)).all(), "{at}");
            }
        }
        let few = hill(4);
        let labels = place(&few, &plan(&few, &GRID), &GRID, ElevationUnit::Metre, &Typesetter::new());
        assert!(labels.iter().any(|label| label.elevation == 20.0), "few contours are all labelled: {labels:?}");
    }

    #[test]
    fn lines_are_interrupted_under_labels_only() {
        let contours = hill(15);
        let labels = place(&contours, &plan(&contours, &GRID), &GRID, ElevationUnit::Metre, &Typesetter::new());
        let mask = gaps(&labels, &GRID).unwrap();
        let at = |p: DVec2| mask.data()[p.y as usize * 800 + p.x as usize];
        assert!(labels.iter().all(|label| at(to_pixels(&GRID, label.position)) == 0));
        let closed = mask.data().iter().filter(|v| **v < 255).count();
        assert!(closed < labels.len() * 60 * 30, "{closed}");
    }
}
