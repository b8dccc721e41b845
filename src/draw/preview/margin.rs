//! The margin of the map: frame, ticks and coordinates.

use tiny_skia::{PathBuilder, Pixmap, Rect, Transform};

use super::canvas::paint;
use super::color::INK;
use super::stroke::{Style, stroke};
use super::text::{Align, Turned, Typesetter};
use crate::coordinates::{Tick, Ticks};

/// Size of the coordinates, pixels.
const TEXT: f32 = 12.5;
/// Length of a tick.
const TICK: f32 = 5.0;
/// From the frame to the middle of the figures.
const OFF: f32 = 14.0;
/// Space between neighbouring coordinates.
const GAP: f32 = 14.0;

/// Draws the frame of a map whose upper left corner is given, and the coordinates around it.
pub(super) fn draw(
    sheet: &mut Pixmap,
    (left, top): (usize, usize),
    (cols, rows): (usize, usize),
    ticks: &Ticks,
    setter: &Typesetter,
) {
    let (left, top) = (left as f32, top as f32);
    let (right, bottom) = (left + cols as f32, top + rows as f32);
    if let Some(rect) = Rect::from_xywh(left - 0.5, top - 0.5, right - left + 1.0, bottom - top + 1.0) {
        let style = Style { color: INK, width: 1.0, alpha: 1.0, dashes: None };
        stroke(sheet, Some(PathBuilder::from_rect(rect)), style, None);
    }
    let across = sheet.width() as f32;
    for (edge, y, out) in [(&ticks.top, top - 0.5, -1.0), (&ticks.bottom, bottom + 0.5, 1.0)] {
        let mut free = 2.0;
        for Tick { at, text } in edge {
            let x = left + *at as f32;
            mark(sheet, (x - 0.5, y.min(y + out * TICK), 1.0, TICK));
            let half = setter.width(text, TEXT) / 2.0;
            if x - half >= free && x + half <= across - 2.0 {
                setter.draw(sheet, text, (x, y + out * OFF + 4.0), TEXT, INK, Align::Center);
                free = x + half + GAP;
            }
        }
    }
    for (edge, x, out) in [(&ticks.left, left - 0.5, -1.0), (&ticks.right, right + 0.5, 1.0)] {
        // The corners belong to the coordinates above and below.
        let mut free = top;
        for Tick { at, text } in edge {
            let y = top + *at as f32;
            mark(sheet, (x.min(x + out * TICK), y - 0.5, TICK, 1.0));
            let half = setter.width(text, TEXT) / 2.0;
            if y - half >= free && y + half <= bottom {
                // From bottom to top, as on printed sheets.
                setter.draw_turned(sheet, text, Turned { at: (x + out * OFF, y), turn: -90.0, rim: 0.0 }, TEXT, INK);
                free = y + half + GAP;
            }
        }
    }
}

fn mark(sheet: &mut Pixmap, (x, y, width, height): (f32, f32, f32, f32)) {
    if let Some(rect) = Rect::from_xywh(x, y, width, height) {
        sheet.fill_rect(rect, &paint(INK, 1.0), Transform::identity(), None);
    }
}
