//! The legend below the map: arrow and scale bar, the kinds of line, the tint with its heights.

use tiny_skia::{FillRule, PathBuilder, Pixmap, Rect, Transform};

use super::canvas::paint;
use super::color::{INK, PAPER, Rgb, Tint};
use super::patches::Patches;
use super::plan::{Class, Plan};
use super::skeleton_lines::{Chosen, Shown};
use super::stroke::{self, Style, skeleton_style};
use super::text::{Align, Typesetter};
use crate::scale;
use tokosen_core::base::Units;
use tokosen_core::contour::ContourKind;
use tokosen_core::crs::Crs;
use tokosen_core::skeleton::SkeletonKind;

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
/// Width of the arrow to the north with the space beside it.
const ARROW: f32 = 40.0;
/// Names are cut so that this many letters remain.
const NAME_LETTERS: usize = 50;

/// A part of the legend that stays together.
pub(super) enum Block {
    /// The scale bar, an arrow to grid north, and a remark.
    Scale { bar: Option<scale::Bar>, arrow: Option<Arrow>, remark: Option<String> },
    /// Samples of lines; one without a style is a remark.
    Keys { keys: Vec<(Option<Style>, String)>, rows: usize },
    /// The tint with its heights.
    Ramp { tint: Tint, units: Units },
}

/// An arrow to grid north: up.
pub(super) struct Arrow;

/// What the legend explains.
pub(super) struct Content<'a> {
    pub scale: Block,
    pub plan: &'a Plan,
    pub skeleton_lines: &'a Chosen,
    pub patches: Option<&'a Patches>,
    /// The tint of the heights.
    pub tint: Option<&'a Tint>,
    pub units: Units,
}

/// The blocks of the legend, given the room for them.
pub(super) fn blocks(content: Content<'_>, room: f32, setter: &Typesetter) -> Vec<Block> {
    let Content { scale, plan, skeleton_lines, patches, tint, units } = content;
    let mut blocks = vec![scale];
    let swatch = |(color, name)| (Some(Style { color, width: SWATCH, alpha: 1.0, dashes: None }), name);
    let swatches = patches.map(|patches| patches.present().into_iter().map(swatch).collect::<Vec<_>>());
    let tint = tint.filter(|_| swatches.is_none());
    let keys = [(keys(plan, skeleton_lines, units), KEY_ROWS), (swatches.unwrap_or_default(), SWATCH_ROWS)];
    for (keys, rows) in keys.into_iter().filter(|(keys, _)| !keys.is_empty()) {
        let wide = Block::Keys { keys, rows };
        let (width, _) = wide.size(setter);
        // If two columns are too wide for the picture, there is one.
        blocks.push(match wide {
            Block::Keys { keys, .. } if width > room => Block::Keys { rows: keys.len(), keys },
            fits => fits,
        });
    }
    blocks.extend(tint.map(|tint| Block::Ramp { tint: tint.clone(), units }));
    blocks
}

/// The name of a coordinate reference system with its code.
pub(super) fn crs_label(crs: &Crs) -> Option<String> {
    let name = crs.name()?;
    let cut = name.char_indices().nth(NAME_LETTERS).map_or(name.len(), |(at, _)| at);
    let short = if cut < name.len() { format!("{}...", &name[..cut]) } else { name };
    Some(match crs.epsg.map(|code| format!("EPSG:{code}")) {
        Some(code) if code != short => format!("{short} ({code})"),
        _ => short,
    })
}

pub(crate) fn keys(plan: &Plan, skeleton_lines: &Chosen, units: Units) -> Vec<(Option<Style>, String)> {
    let mut keys = Vec::new();
    let mut contours = |class: &Option<Class>, kind: &str| {
        let Some(class) = class else { return };
        let step = |every: u32| class.interval().map(|interval| units.height(interval * f64::from(every)));
        // Steep slopes have index contours alone.
        let room = if class.fades { ", where there is room" } else { "" };
        match (class.every, step(1)) {
            (Some(1), Some(interval)) => keys.push((Some(class.style), format!("{kind}, {interval}{room}"))),
            (Some(1), None) => keys.push((Some(class.style), format!("{kind}{room}"))),
            (Some(every), interval) => {
                let (all, drawn) = (interval.unwrap_or_default(), step(every).unwrap_or_default());
                keys.push((Some(class.style), format!("{kind}, {all}, drawn every {drawn}{room}")));
            }
            (None, interval) => {
                let interval = interval.map_or_else(String::new, |interval| format!(", {interval}"));
                let larger = class.larger.map_or_else(String::new, |size| format!(" below {size} times this size"));
                keys.push((None, format!("{kind}{interval}: too dense to draw{larger}")));
            }
        }
    };
    contours(&plan.input, if plan.of_height_map { "Contours" } else { "Input contours" });
    contours(&plan.interpolated, "Interpolated contours");
    let drawn = [&plan.input, &plan.interpolated].into_iter().flatten().filter(|c| c.has_index && c.every.is_some());
    let index = plan.index_interval.map(|interval| format!(", {}", units.height(interval))).unwrap_or_default();
    keys.extend(drawn.take(1).map(|class| (Some(class.index_style), format!("Index contours{index}"))));
    keys.extend(plan.supplementary.iter().map(|(kind, style)| {
        let quarter = if *kind == ContourKind::SupplementaryQuarter { ", a quarter of the interval" } else { "" };
        (Some(*style), format!("Supplementary contours{quarter}"))
    }));
    if let Some(class) = plan.interpolated.as_ref().filter(|class| class.has_inferred) {
        keys.push((Some(stroke::dashed(class.style)), "Inferred: hardly known from the input".to_owned()));
    }
    let some = if skeleton_lines.shown == Shown::Longest { ", the longest" } else { "" };
    for (kind, name) in [(SkeletonKind::Ridge, "Ridge lines"), (SkeletonKind::Canyon, "Canyon lines")] {
        if skeleton_lines.of(kind).next().is_some() {
            keys.push((Some(skeleton_style(kind, skeleton_lines.width)), format!("{name}{some}")));
        }
    }
    if skeleton_lines.shown == Shown::Nothing {
        keys.push((None, "Ridge and canyon lines: too dense to draw".to_owned()));
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
            Self::Scale { bar, arrow, remark } => {
                let label = bar.as_ref().map_or(0.0, |bar| setter.width(&bar.label, TEXT));
                let bar = bar.as_ref().map_or(0.0, |bar| bar.pixels as f32 + label);
                let remark = remark.as_ref().map_or(0.0, |remark| setter.width(remark, TEXT));
                (if arrow.is_some() { ARROW } else { 0.0 } + bar.max(remark), ROW * 3.0)
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
            Self::Scale { bar, arrow, remark } => {
                let mut left = x;
                if arrow.is_some() {
                    draw_arrow(pixmap, setter, (x, y));
                    left += ARROW;
                }
                if let Some(bar) = bar {
                    draw_bar(pixmap, setter, bar, (left, base(0)));
                }
                if let Some(remark) = remark {
                    setter.draw(pixmap, remark, (left, base(2)), TEXT, INK, Align::Left);
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
                            let mut path = PathBuilder::new();
                            path.move_to(left + 1.0, middle);
                            path.line_to(left + SAMPLE.0, middle);
                            stroke::stroke(pixmap, path.finish(), style, None);
                        }
                        setter.draw(pixmap, text, (left + SAMPLE.1, base(row)), TEXT, INK, Align::Left);
                    }
                    left += column_width(column, setter) + GAP.0;
                }
            }
            Self::Ramp { tint, units } => draw_ramp(pixmap, setter, (tint, *units), (x, y)),
        }
    }
}

fn column_width(column: &[(Option<Style>, String)], setter: &Typesetter) -> f32 {
    column.iter().map(|(_, text)| SAMPLE.1 + setter.width(text, TEXT)).fold(0.0, f32::max)
}

/// An arrow upwards below the letter N.
fn draw_arrow(pixmap: &mut Pixmap, setter: &Typesetter, (x, y): (f32, f32)) {
    let middle = x + 9.0;
    setter.draw(pixmap, "N", (middle, y + 15.0), TEXT, INK, Align::Center);
    // The eastern half is white, as on compass needles.
    let (tip, foot) = (y + 20.0, y + 52.0);
    let half = |side: f32| {
        let mut path = PathBuilder::new();
        path.move_to(middle, tip);
        path.line_to(middle + side * 8.0, foot);
        path.line_to(middle, foot - 7.0);
        path.close();
        path.finish()
    };
    if let Some(west) = half(-1.0) {
        pixmap.fill_path(&west, &paint(INK, 1.0), FillRule::Winding, Transform::identity(), None);
    }
    let outline = Style { color: INK, width: 1.0, alpha: 1.0, dashes: None };
    [-1.0, 1.0].into_iter().for_each(|side| stroke::stroke(pixmap, half(side), outline, None));
}

/// A bar in black and white halves with its ends labelled above.
fn draw_bar(pixmap: &mut Pixmap, setter: &Typesetter, bar: &scale::Bar, (x, base): (f32, f32)) {
    setter.draw(pixmap, "0", (x, base), TEXT, INK, Align::Left);
    let (top, height) = (base + 6.0, 7.0);
    let pixels = bar.pixels as f32;
    fill(pixmap, (x, top, pixels, height), INK);
    let cell = pixels / 4.0;
    for white in [1.0, 3.0] {
        fill(pixmap, (x + cell * white, top + 1.2, cell - if white > 2.0 { 1.2 } else { 0.0 }, height - 2.4), PAPER);
    }
    // The number is centred on the end of the bar; the unit follows it.
    let number = setter.width(&bar.number, TEXT);
    setter.draw(pixmap, &bar.label, (x + pixels - number / 2.0, base), TEXT, INK, Align::Left);
}

/// The tint from the lowest to the highest ground with round heights below it.
fn draw_ramp(pixmap: &mut Pixmap, setter: &Typesetter, (tint, units): (&Tint, Units), (x, y): (f32, f32)) {
    let (least, most) = tint.range;
    let [low, high] = [least, most].map(|z| units.heights.about(z));
    let left = x;
    setter.draw(pixmap, &format!("Elevation, {}", units.heights.symbol()), (left, y + 15.0), TEXT, INK, Align::Left);
    let top = y + ROW + 1.0;
    let columns = RAMP.0 as usize;
    fill(pixmap, (left - 1.0, top - 1.0, RAMP.0 + 2.0, RAMP.1 + 2.0), INK);
    for column in 0..columns {
        let share = column as f64 / (columns - 1) as f64;
        fill(pixmap, (left + column as f32, top, 1.0, RAMP.1), tint.of(least + share * (most - least)));
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

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::plan::plan;
    use super::*;
    use tokosen_core::base::Grid;
    use tokosen_core::contour::{ContourLine, Source};

    const GRID: Grid = Grid { corner: DVec2::new(0.0, 400.0), cell: DVec2::ONE, cols: 400, rows: 400 };

    /// Level lines across the whole map, `apart` pixels and `step` metres apart.
    fn lines(apart: f64, step: f64, source: Source) -> impl Iterator<Item = ContourLine> {
        (0..=(400.0 / apart) as usize).map(move |i| {
            let points = [0.0, 400.0].map(|x| DVec2::new(x, i as f64 * apart)).to_vec();
            let index = source == Source::Input && i % 5 == 0;
            ContourLine {
                elevation: i as f64 * step,
                points,
                source,
                index,
                kind: None,
                depression: false,
                expected: None,
            }
        })
    }

    fn told(contours: &[ContourLine], shown: Shown) -> Vec<String> {
        let skeleton_lines = Chosen { lines: Vec::new(), shown, width: 1.0 };
        keys(&plan(contours, &GRID), &skeleton_lines, Units::METRES).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn the_legend_says_which_lines_are_left_out() {
        let sparse: Vec<_> = lines(40.0, 20.0, Source::Input).chain(lines(10.0, 5.0, Source::Interpolated)).collect();
        assert_eq!(
            told(&sparse, Shown::All),
            ["Input contours, 20 m", "Interpolated contours, 5 m", "Index contours, 100 m"]
        );
        let dense: Vec<_> = lines(20.0, 20.0, Source::Input).chain(lines(1.0, 1.0, Source::Interpolated)).collect();
        assert_eq!(
            told(&dense, Shown::Nothing),
            [
                "Input contours, 20 m",
                "Interpolated contours, 1 m, drawn every 5 m",
                "Index contours, 100 m",
                "Ridge and canyon lines: too dense to draw"
            ]
        );
        let denser: Vec<_> = lines(1.5, 10.0, Source::Input).chain(lines(0.3, 2.0, Source::Interpolated)).collect();
        assert_eq!(
            told(&denser, Shown::All),
            [
                "Input contours, 10 m, drawn every 50 m",
                "Interpolated contours, 2 m: too dense to draw below 13 times this size",
                "Index contours, 250 m"
            ]
        );
    }
}
