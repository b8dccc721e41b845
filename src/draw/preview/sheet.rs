//! The sheet of paper: where the map, the title and the legend are, and how large they may be.

use glam::DVec2;
use tiny_skia::{Pixmap, PixmapPaint, Transform};

use super::canvas::{color_of, pixmap};
use super::color::{INK, PAPER};
use super::legend;
use super::text::{Align, Typesetter};
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Result};

/// The longest side of the whole picture, pixels.
pub const MAX_SIDE: usize = 1600;

/// Paper around the map, with the coordinates.
pub(super) const MARGIN: usize = 28;
/// Room for a title above the map, and for a note alone.
const HEAD: (usize, usize) = (30, 20);
/// Text sizes of the title and of the note.
const HEAD_TEXT: (f32, f32) = (23.0, 15.0);
/// Space between map and legend, with the coordinates.
const FOOT: usize = 34;
/// The map's largest width.
pub(super) const MAX_COLS: usize = MAX_SIDE - 2 * MARGIN;
/// From this width on, the legend is one row.
pub(super) const ONE_ROW: usize = 1260;
/// Largest heights of the map, above a legend of one row and above a stacked one.
pub(super) const MAX_ROWS: [usize; 2] =
    [MAX_SIDE - MARGIN - HEAD.0 - FOOT - 98, MAX_SIDE - MARGIN - HEAD.0 - FOOT - 306];
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

/// What stands above the map: a title, and what the map shows.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Head<'a> {
    pub title: Option<&'a str>,
    pub note: Option<String>,
}

impl Head<'_> {
    /// Where the map starts from above, pixels.
    pub fn top(&self) -> usize {
        MARGIN
            + match (self.title, &self.note) {
                (Some(_), _) => HEAD.0,
                (None, Some(_)) => HEAD.1,
                (None, None) => 0,
            }
    }

    /// Whether a note fits into the room besides the title.
    pub fn has_room_for(&self, note: &str, room: usize, setter: &Typesetter) -> bool {
        let title = self.title.map_or(0.0, |title| setter.width(title, HEAD_TEXT.0) + HEAD_TEXT.0);
        title + setter.width(note, HEAD_TEXT.1) <= room as f32
    }

    fn draw(&self, sheet: &mut Pixmap, room: usize, setter: &Typesetter) {
        let (left, base) = (MARGIN as f32, (self.top() - MARGIN) as f32);
        if let Some(title) = self.title {
            setter.draw(sheet, title, (left, base), HEAD_TEXT.0, INK, Align::Left);
        }
        if let Some(note) = &self.note {
            let beside = self.title.map_or(0.0, |_| room as f32 - setter.width(note, HEAD_TEXT.1));
            setter.draw(sheet, note, (left + beside, base), HEAD_TEXT.1, INK, Align::Left);
        }
    }
}

/// A sheet of paper with a picture, centred in the room, the head above and the legend below it.
pub(super) fn sheet(
    picture: &Pixmap,
    blocks: &[legend::Block],
    room: usize,
    head: &Head<'_>,
    setter: &Typesetter,
) -> Result<Pixmap> {
    // Sizes are below MAX_SIDE, far inside the range of all whole numbers.
    let (cols, rows) = (picture.width() as usize, picture.height() as usize);
    let (places, legend_height) = legend::arrange(blocks, room as f32, setter);
    let top = head.top();
    let legend_top = top + rows + FOOT;
    let mut sheet = pixmap(room + 2 * MARGIN, legend_top + legend_height.ceil() as usize + MARGIN / 2)?;
    sheet.fill(color_of(PAPER, 1.0));
    head.draw(&mut sheet, room, setter);
    let left = MARGIN + (room - cols) / 2;
    let paint = PixmapPaint::default();
    sheet.draw_pixmap(left as i32, top as i32, picture.as_ref(), &paint, Transform::identity(), None);
    for (block, (x, y)) in blocks.iter().zip(places) {
        block.draw(&mut sheet, setter, (MARGIN as f32 + x, legend_top as f32 + y));
    }
    Ok(sheet)
}
