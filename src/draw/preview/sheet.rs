//! The sheet of paper: where the map, the title and the legend are, and how large they may be.

use glam::DVec2;
use tiny_skia::{Pixmap, PixmapPaint, Transform};

use super::canvas::{color_of, pixmap};
use super::color::{INK, PAPER};
use super::legend;
use super::text::{Align, Typesetter};
use crate::base::Grid;
use crate::base::error::{Error, Result};

/// The longest side of the whole picture, pixels.
pub const MAX_SIDE: usize = 1600;

/// Paper around the map.
pub(super) const MARGIN: usize = 28;
/// Room for the title above the map.
pub(super) const TITLE: usize = 44;
/// Text size of the title.
pub(super) const TITLE_TEXT: f32 = 23.0;
/// The map's largest width.
pub(super) const MAX_COLS: usize = MAX_SIDE - 2 * MARGIN;
/// From this width on, the legend is one row.
pub(super) const ONE_ROW: usize = 1260;
/// Largest heights of the map, above a legend of one row and above a stacked one.
pub(super) const MAX_ROWS: [usize; 2] = [MAX_SIDE - MARGIN - TITLE - 100, MAX_SIDE - MARGIN - TITLE - 310];
/// A narrow map still needs a legend this wide.
pub(super) const MIN_LEGEND: usize = 430;
/// The grid of square cells that covers an extent with as many pixels as the picture has room for.
///
/// # Errors
/// An extent without area, or without finite corners.
pub fn map_grid(min: DVec2, max: DVec2) -> Result<Grid> {
    let size = max - min;
    if !(size.is_finite() && size.min_element() > 0.0) {
        return Err(Error::Parameter(format!(
            "no picture can be drawn of the extent from {}, {} to {}, {}",
            min.x, min.y, max.x, max.y
        )));
    }
    // The extent never needs more cells than `room`; rounding up could give one more, hence the minimum.
    let fit = |rows: usize| {
        let room = DVec2::new(MAX_COLS as f64, rows as f64);
        let cell = (size / room).max_element();
        let count = (size / cell).ceil().max(DVec2::ONE).min(room);
        Grid {
            corner: DVec2::new(min.x, max.y),
            cell: DVec2::splat(cell),
            cols: count.x as usize,
            rows: count.y as usize,
        }
    };
    let [above_row, above_stack] = MAX_ROWS;
    let wide = fit(above_row);
    Ok(if wide.cols >= ONE_ROW { wide } else { fit(above_stack) })
}

/// A sheet of paper with a picture, centred in the room, the title above and the legend below it; and where the picture
/// starts from above.
pub(super) fn sheet(
    picture: &Pixmap,
    blocks: &[legend::Block],
    room: usize,
    title: Option<&str>,
    setter: &Typesetter,
) -> Result<(Pixmap, usize)> {
    // Sizes are below MAX_SIDE, far inside the range of all whole numbers.
    let (cols, rows) = (picture.width() as usize, picture.height() as usize);
    let (places, legend_height) = legend::arrange(blocks, room as f32, setter);
    let top = MARGIN + if title.is_some() { TITLE - MARGIN / 2 } else { 0 };
    let legend_top = top + rows + 20;
    let mut sheet = pixmap(room + 2 * MARGIN, legend_top + legend_height.ceil() as usize + MARGIN / 2)?;
    sheet.fill(color_of(PAPER, 1.0));
    if let Some(title) = title {
        let base = top as f32 - 14.0;
        setter.draw(&mut sheet, title, (MARGIN as f32, base), TITLE_TEXT, INK, Align::Left);
    }
    let left = MARGIN + (room - cols) / 2;
    let paint = PixmapPaint::default();
    sheet.draw_pixmap(left as i32, top as i32, picture.as_ref(), &paint, Transform::identity(), None);
    for (block, (x, y)) in blocks.iter().zip(places) {
        block.draw(&mut sheet, setter, (MARGIN as f32 + x, legend_top as f32 + y));
    }
    Ok((sheet, top))
}
