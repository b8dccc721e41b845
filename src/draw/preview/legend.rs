//! The legend below the map: scale bar and coordinate reference system, the kinds of line, the tint with its heights.

use tiny_skia::{Pixmap, Rect, Transform};

use super::canvas::paint;
use super::color::{INK, PAPER, Rgb, Tint};
use super::lines::{self, CANYON_STYLE, Class, Plan, RIDGE_STYLE, Style};
use super::scale;
use super::text::{Align, Typesetter};
use super::view::Preview;
use crate::dem::Dem;
use crate::skeleton::{BreakKind, BreakLine};

/// Size of the legend's text, pixels.
const TEXT: f32 = 15.0;
/// Height of a row of text.
const ROW: f32 = 21.0;
/// Space between neighbouring blocks and between rows of blocks.
const GAP: (f32, f32) = (40.0, 22.0);
/// Length of a line's sample, and where its text starts.
const SAMPLE: (f32, f32) = (34.0, 44.0);
/// Rows of a column of line samples.
const KEY_ROWS: usize = 3;
/// Rows of a column of area samples.
const SWATCH_ROWS: usize = 4;
/// Height of an area's sample.
const SWATCH: f32 = 12.0;
/// Width and height of the tint's bar.
const RAMP: (f32, f32) = (240.0, 14.0);
/// Names are cut so that this many letters remain.
const NAME_LETTERS: usize = 50;

/// A part of the legend that stays together.
pub(super) enum Block {
    /// The scale bar and the name of the coordinate reference system.
    Scale { bar: Option<scale::Bar>, name: Option<String> },
    /// Samples of lines; one without a style is a remark.
    Keys { keys: Vec<(Option<Style>, String)>, rows: usize },
    /// The tint and the lowest and highest height.
    Ramp { low: f64, high: f64 },
}

/// The blocks that this map needs, given the range of its heights and the room for them.
pub(super) fn blocks(
    input: &Preview<'_>,
    plan: &Plan,
    range: Option<(f64, f64)>,
    room: f32,
    setter: &Typesetter,
) -> Vec<Block> {
    let mut blocks = vec![Block::Scale { bar: scale::bar(input.dem), name: crs_label(input.dem) }];
    let swatch = |(color, name)| (Some(Style { color, width: SWATCH, alpha: 1.0, dashes: None }), name);
    let swatches = input.patches.map(|patches| patches.present().into_iter().map(swatch).collect::<Vec<_>>());
    let tint = if swatches.is_some() { None } else { range };
    let keys = [(keys(plan, input.break_lines), KEY_ROWS), (swatches.unwrap_or_default(), SWATCH_ROWS)];
    for (keys, rows) in keys.into_iter().filter(|(keys, _)| !keys.is_empty()) {
        let wide = Block::Keys { keys, rows };
        let (width, _) = wide.size(setter);
        // If two columns are too wide for the picture, there is one.
        blocks.push(match wide {
            Block::Keys { keys, .. } if width > room => Block::Keys { rows: keys.len(), keys },
            fits => fits,
        });
    }
    blocks.extend(tint.map(|(low, high)| Block::Ramp { low, high }));
    blocks
}

fn crs_label(dem: &Dem) -> Option<String> {
    let crs = dem.crs.as_ref()?;
    let name = crs.name()?;
    let cut = name.char_indices().nth(NAME_LETTERS).map_or(name.len(), |(at, _)| at);
    let short = if cut < name.len() { format!("{}...", &name[..cut]) } else { name };
    Some(match crs.epsg.map(|code| format!("EPSG:{code}")) {
        Some(code) if code != short => format!("{short} ({code})"),
        _ => short,
    })
}

fn keys(plan: &Plan, break_lines: &[BreakLine]) -> Vec<(Option<Style>, String)> {
    let mut keys = Vec::new();
    let mut contours = |class: &Option<Class>, kind: &str| {
        let Some(class) = class else { return };
        let step = |every: u32| class.interval().map(|interval| scale::number(interval * f64::from(every)));
        match (class.every, step(1)) {
            (Some(1), Some(interval)) => keys.push((Some(class.style), format!("{kind}, {interval} m"))),
            (Some(1), None) => keys.push((Some(class.style), kind.to_owned())),
            (Some(every), interval) => {
                let (all, drawn) = (interval.unwrap_or_default(), step(every).unwrap_or_default());
                keys.push((Some(class.style), format!("{kind}, {all} m, drawn every {drawn} m")));
            }
            (None, Some(interval)) => keys.push((None, format!("{kind}, {interval} m: too dense to draw"))),
            (None, None) => keys.push((None, format!("{kind}: too dense to draw"))),
        }
    };
    contours(&plan.input, if plan.of_height_map { "Contours" } else { "Input contours" });
    contours(&plan.interpolated, "Interpolated contours");
    let drawn = [&plan.input, &plan.interpolated].into_iter().flatten().filter(|c| c.has_index && c.every.is_some());
    keys.extend(drawn.take(1).map(|class| (Some(class.index_style), "Index contours".to_owned())));
    if let Some(class) = plan.interpolated.as_ref().filter(|class| class.has_inferred) {
        keys.push((Some(lines::dashed(class.style)), "Inferred: hardly known from the input".to_owned()));
    }
    for (kind, style, name) in
        [(BreakKind::Ridge, RIDGE_STYLE, "Ridge lines"), (BreakKind::Canyon, CANYON_STYLE, "Canyon lines")]
    {
        if break_lines.iter().any(|line| line.kind == kind) {
            keys.push((Some(style), name.to_owned()));
        }
    }
    keys
}

/// Places the blocks in rows no wider than `room`: the corner of each, and the height of all.
///
/// A single row is spread over the whole room, so that its ends lie below the map's corners.
pub(super) fn arrange(blocks: &[Block], room: f32, setter: &Typesetter) -> (Vec<(f32, f32)>, f32) {
    let sizes: Vec<(f32, f32)> = blocks.iter().map(|block| block.size(setter)).collect();
    let (mut x, mut y, mut row_height) = (0.0, 0.0, 0.0_f32);
    let mut places = Vec::with_capacity(blocks.len());
    for &(width, height) in &sizes {
        if x > 0.0 && x + width > room {
            (x, y, row_height) = (0.0, y + row_height + GAP.1, 0.0);
        }
        places.push((x, y));
        x += width + GAP.0;
        row_height = row_height.max(height);
    }
    if y == 0.0 && places.len() > 1 {
        let spare = (room - (x - GAP.0)).max(0.0) / (places.len() - 1) as f32;
        for (i, place) in places.iter_mut().enumerate() {
            place.0 += spare * i as f32;
        }
    }
    (places, y + row_height)
}

impl Block {
    /// Width and height, pixels.
    pub fn size(&self, setter: &Typesetter) -> (f32, f32) {
        match self {
            Self::Scale { bar, name } => {
                let label = bar.as_ref().map_or(0.0, |bar| setter.width(&bar.label, TEXT));
                let bar = bar.as_ref().map_or(0.0, |bar| bar.pixels + label);
                let name = name.as_ref().map_or(0.0, |name| setter.width(name, TEXT));
                (bar.max(name), ROW * 3.0)
            }
            Self::Keys { keys, rows } => {
                let columns = keys.chunks(*rows).map(|column| column_width(column, setter) + GAP.0);
                (columns.sum::<f32>() - GAP.0, ROW * (*rows).min(keys.len()).max(KEY_ROWS) as f32)
            }
            Self::Ramp { .. } => (RAMP.0, ROW * 3.0),
        }
    }

    /// Draws the block with its upper left corner at a place.
    pub fn draw(&self, pixmap: &mut Pixmap, setter: &Typesetter, (x, y): (f32, f32)) {
        // The base line of a row's text.
        let base = |row: usize| y + ROW * row as f32 + 15.0;
        match self {
            Self::Scale { bar, name } => {
                if let Some(bar) = bar {
                    draw_bar(pixmap, setter, bar, (x, base(0)));
                }
                if let Some(name) = name {
                    setter.draw(pixmap, name, (x, base(2)), TEXT, INK, Align::Left);
                }
            }
            Self::Keys { keys, rows } => {
                let mut left = x;
                for column in keys.chunks(*rows) {
                    for (row, (style, text)) in column.iter().enumerate() {
                        if let Some(style) = style {
                            let middle = base(row).floor() - 4.5;
                            // Lines that are faint on the dark map would be lost on white paper.
                            let style = Style { alpha: style.alpha.max(0.8), ..*style };
                            let mut path = tiny_skia::PathBuilder::new();
                            path.move_to(left + 1.0, middle);
                            path.line_to(left + SAMPLE.0, middle);
                            lines::stroke(pixmap, path.finish(), style);
                        }
                        setter.draw(pixmap, text, (left + SAMPLE.1, base(row)), TEXT, INK, Align::Left);
                    }
                    left += column_width(column, setter) + GAP.0;
                }
            }
            Self::Ramp { low, high } => draw_ramp(pixmap, setter, (*low, *high), (x, y)),
        }
    }
}

fn column_width(column: &[(Option<Style>, String)], setter: &Typesetter) -> f32 {
    column.iter().map(|(_, text)| SAMPLE.1 + setter.width(text, TEXT)).fold(0.0, f32::max)
}

/// A bar in black and white halves with its ends labelled above.
fn draw_bar(pixmap: &mut Pixmap, setter: &Typesetter, bar: &scale::Bar, (x, base): (f32, f32)) {
    setter.draw(pixmap, "0", (x, base), TEXT, INK, Align::Left);
    let (top, height) = (base + 6.0, 7.0);
    fill(pixmap, (x, top, bar.pixels, height), INK);
    let cell = bar.pixels / 4.0;
    for white in [1.0, 3.0] {
        fill(pixmap, (x + cell * white, top + 1.2, cell - if white > 2.0 { 1.2 } else { 0.0 }, height - 2.4), PAPER);
    }
    // The number is centred on the end of the bar; the unit follows it.
    let number = setter.width(&bar.number, TEXT);
    setter.draw(pixmap, &bar.label, (x + bar.pixels - number / 2.0, base), TEXT, INK, Align::Left);
}

/// The tint from the lowest to the highest ground with round heights below it.
fn draw_ramp(pixmap: &mut Pixmap, setter: &Typesetter, (low, high): (f64, f64), (x, y): (f32, f32)) {
    let left = x;
    setter.draw(pixmap, "Elevation, m", (left, y + 15.0), TEXT, INK, Align::Left);
    let top = y + ROW + 1.0;
    let tint = Tint::new();
    let columns = RAMP.0 as usize;
    fill(pixmap, (left - 1.0, top - 1.0, RAMP.0 + 2.0, RAMP.1 + 2.0), INK);
    for column in 0..columns {
        let share = column as f64 / (columns - 1) as f64;
        fill(pixmap, (left + column as f32, top, 1.0, RAMP.1), tint.at(share));
    }
    for height in scale::ticks(low, high) {
        let share = if high > low { (height - low) / (high - low) } else { 0.5 };
        let at = left + (share * f64::from(RAMP.0)) as f32;
        fill(pixmap, (at - 0.5, top + RAMP.1, 1.0, 4.0), INK);
        setter.draw(pixmap, &scale::number(height), (at, y + ROW * 2.0 + 15.0), TEXT, INK, Align::Center);
    }
}

fn fill(pixmap: &mut Pixmap, (x, y, width, height): (f32, f32, f32, f32), color: Rgb) {
    if let Some(rect) = Rect::from_xywh(x, y, width, height) {
        pixmap.fill_rect(rect, &paint(color, 1.0), Transform::identity(), None);
    }
}
