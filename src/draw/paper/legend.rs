//! What stands around a map on paper: the title, the scale, the kinds of line, the tint, the source.

use glam::DVec2;

use super::fonts::Fonts;
use super::page::{COORDINATES, LEGEND, MARGIN, Page, Placed};
use super::shapes::{Look, Shape, Text};
use super::shown::Shown;
use crate::preview::color::{INK, PAPER, Rgb, Tint};
use crate::preview::legend::keys;
use crate::preview::plan::Plan;
use crate::preview::skeleton_lines::Chosen;
use crate::preview::text::Align;
use crate::scale::{self, number};
use tokosen_core::base::ElevationUnit;

/// Sizes of the title, of the scale, of texts, and of the source.
const TITLE: f64 = 7.0;
const SCALE: f64 = 5.0;
const TEXT: f64 = 2.9;
const SOURCE: f64 = 2.4;
/// Height of a row of text.
const ROW: f64 = 4.6;
/// Rows of a column of the legend.
const ROWS: usize = 3;
/// Space between blocks.
const GAP: f64 = 10.0;
/// Length of a line's sample, and where its text starts.
const SAMPLE: [f64; 2] = [8.0, 10.0];
/// Width and height of the tint.
const RAMP: [f64; 2] = [48.0, 3.5];
/// Steps of colour of the tint.
const STEPS: usize = 64;
/// A pixel of the scale bar of a screen, millimetres.
const BAR_PIXEL: f64 = 0.25;

/// What the legend is about.
pub(super) struct Content<'a> {
    pub page: &'a Page,
    pub placed: &'a Placed,
    pub plan: &'a Plan,
    pub chosen: &'a Chosen,
    /// Lowest and highest height.
    pub tint: Option<&'a Tint>,
    pub shown: &'a Shown<'a>,
    /// What the contours are, and the coordinate reference system.
    pub note: [Option<String>; 2],
}

/// A part of the legend: its width, and its shapes from its upper left corner.
pub(super) type Block = (f64, Vec<Shape>);

/// The shapes around the map.
pub(super) fn shapes(content: &Content<'_>, fonts: &Fonts) -> Vec<Shape> {
    let note = content.note.iter().flatten().cloned().collect::<Vec<_>>().join("  ·  ");
    around(content.page, content.placed, &note, blocks(content, fonts), fonts)
}

/// The title and a note above a map, and the parts of its legend and the source below.
pub(super) fn around(page: &Page, placed: &Placed, note: &str, blocks: Vec<Block>, fonts: &Fonts) -> Vec<Shape> {
    let [from, to] = placed.frame;
    let mut out = Vec::new();
    let base = from.y - COORDINATES - 1.5;
    match &page.title {
        Some(title) => {
            // A long title is set smaller.
            let size = TITLE.min((to.x - from.x) / fonts.width(title).max(1e-9));
            out.push(text(title, DVec2::new(from.x, base - 5.0), size, Align::Left));
            out.push(text(note, DVec2::new(from.x, base), TEXT, Align::Left));
        }
        None => out.push(text(note, DVec2::new(from.x, base), TEXT, Align::Left)),
    }
    // The legend begins below the corner of the map, or further to the left if it needs the room.
    let [first, last] = [MARGIN + COORDINATES, placed.paper.x - MARGIN - COORDINATES];
    let width = blocks.iter().map(|(width, _)| width + GAP).sum::<f64>() - GAP;
    let left = from.x.min(last - width).max(first);
    let mut at = DVec2::new(left, to.y + COORDINATES + LEGEND[1]);
    for (width, shapes) in blocks {
        if at.x > left && at.x + width > last {
            at = DVec2::new(left, at.y + LEGEND[0]);
        }
        out.extend(shapes.into_iter().map(|shape| moved(shape, at)));
        at.x += width + GAP;
    }
    if let Some(source) = &page.source {
        let size = SOURCE.min((last - first) / fonts.width(source).max(1e-9));
        let room = last - fonts.width(source) * size;
        out.push(text(source, DVec2::new(from.x.min(room).max(first), at.y + LEGEND[0] + 3.0), size, Align::Left));
    }
    out
}

fn blocks(content: &Content<'_>, fonts: &Fonts) -> Vec<Block> {
    let Content { plan, chosen, tint, shown, .. } = content;
    let units = shown.preview.units;
    let mut blocks = vec![scale_block(content.placed, units.heights, fonts)];
    let keys = keys(plan, chosen, units);
    for column in keys.chunks(ROWS) {
        let mut shapes = Vec::new();
        let mut width: f64 = 0.0;
        for (row, (style, name)) in column.iter().enumerate() {
            let base = ROW * row as f64 + TEXT;
            if let Some(style) = style {
                let sample = vec![DVec2::new(0.0, base - 1.0), DVec2::new(SAMPLE[0], base - 1.0)];
                shapes.push(Shape::Lines { lines: vec![sample], look: Look::of(*style, 0.12) });
            }
            shapes.push(text(name, DVec2::new(SAMPLE[1], base), TEXT, Align::Left));
            width = width.max(SAMPLE[1] + fonts.width(name) * TEXT);
        }
        blocks.push((width, shapes));
    }
    let present = shown.preview.patches.map(|patches| patches.present());
    for column in present.iter().flatten().collect::<Vec<_>>().chunks(ROWS) {
        let mut shapes = Vec::new();
        let mut width: f64 = 0.0;
        for (row, (color, name)) in column.iter().enumerate() {
            let base = ROW * row as f64 + TEXT;
            shapes.push(area(DVec2::new(0.0, base - 2.4), DVec2::new(SAMPLE[0], base + 0.4), *color));
            shapes.push(text(name, DVec2::new(SAMPLE[1], base), TEXT, Align::Left));
            width = width.max(SAMPLE[1] + fonts.width(name) * TEXT);
        }
        blocks.push((width, shapes));
    }
    blocks.extend(tint.filter(|_| present.is_none()).map(|tint| {
        let (least, most) = tint.range;
        let range = [least, most].map(|z| units.heights.about(z));
        let color = |share: f64| tint.of(least + share * (most - least));
        ramp(&format!("Elevation, {}", units.heights.symbol()), range, color)
    }));
    blocks
}

/// Rows of text below each other, three in a column.
pub(super) fn columns(rows: &[String], fonts: &Fonts) -> Vec<Block> {
    let column = |rows: &[String]| {
        let texts = rows.iter().enumerate();
        let texts = texts.map(|(k, row)| text(row, DVec2::new(0.0, ROW * k as f64 + TEXT), TEXT, Align::Left));
        let width = rows.iter().map(|row| fonts.width(row) * TEXT).fold(0.0, f64::max);
        (width, texts.collect())
    };
    rows.chunks(ROWS).map(column).collect()
}

/// The scale as a number and as a bar, which is in feet where heights are, and an arrow to grid north.
pub(super) fn scale_block(placed: &Placed, heights: ElevationUnit, fonts: &Fonts) -> Block {
    let mut shapes = arrow();
    let left = 10.0;
    let mut width: f64 = left;
    if let Some(scale) = placed.scale {
        let name = format!("1:{}", grouped(scale));
        shapes.push(text(&name, DVec2::new(left, SCALE * 0.8), SCALE, Align::Left));
        width = width.max(left + fonts.width(&name) * SCALE);
    }
    let units = placed.unit * BAR_PIXEL;
    let metres = placed.scale.map(|scale| scale / 1000.0 * BAR_PIXEL);
    let across = (placed.frame[1].x - placed.frame[0].x) / BAR_PIXEL;
    if let Some(bar) = scale::bar(across, metres, units, heights) {
        let length = bar.pixels * BAR_PIXEL;
        let top = 11.0;
        for k in 0..4 {
            let [from, to] = [k, k + 1].map(|k| left + length * f64::from(k) / 4.0);
            let (from, to) = (DVec2::new(from, top), DVec2::new(to, top + 1.2));
            shapes.push(area(from, to, if k % 2 == 0 { INK } else { PAPER }));
        }
        let (from, to) = (DVec2::new(left, top), DVec2::new(left + length, top + 1.2));
        let ring = vec![from, DVec2::new(to.x, from.y), to, DVec2::new(from.x, to.y), from];
        shapes.push(Shape::Lines { lines: vec![ring], look: Look { color: INK, width: 0.2, dashes: None } });
        shapes.push(text("0", DVec2::new(left, top - 1.0), TEXT, Align::Center));
        let number = fonts.width(&bar.number) * TEXT;
        shapes.push(text(&bar.label, DVec2::new(left + length - number / 2.0, top - 1.0), TEXT, Align::Left));
        width = width.max(left + length + fonts.width(&bar.label) * TEXT);
    }
    (width, shapes)
}

fn arrow() -> Vec<Shape> {
    let (tip, foot, middle) = (4.0, 12.5, 3.0);
    let half = |side: f64| {
        let outer = DVec2::new(middle + side * 2.2, foot);
        vec![DVec2::new(middle, tip), outer, DVec2::new(middle, foot - 2.0), DVec2::new(middle, tip)]
    };
    let lines =
        Shape::Lines { lines: vec![half(1.0), half(-1.0)], look: Look { color: INK, width: 0.2, dashes: None } };
    let filled = Shape::Area { rings: vec![half(-1.0)], color: INK };
    vec![text("N", DVec2::new(middle, TEXT), TEXT, Align::Center), filled, lines]
}

/// Colours with round numbers below them. `color` gives that of a share of the way from the lowest number to the highest.
pub(super) fn ramp(title: &str, [low, high]: [f64; 2], color: impl Fn(f64) -> Rgb) -> Block {
    let [width, height] = RAMP;
    let mut shapes = vec![text(title, DVec2::new(0.0, TEXT), TEXT, Align::Left)];
    let top = ROW;
    for step in 0..STEPS {
        let [from, to] = [step, step + 1].map(|step| width * step as f64 / STEPS as f64);
        let color = color((step as f64 + 0.5) / STEPS as f64);
        // Neighbours overlap, so that no light line shows between them.
        let to = (to + 0.1).min(width);
        shapes.push(area(DVec2::new(from, top), DVec2::new(to, top + height), color));
    }
    for z in scale::ticks(low, high) {
        let share = if high > low { (z - low) / (high - low) } else { 0.5 };
        let at = DVec2::new(width * share, top + height);
        let tick = vec![at, at + DVec2::new(0.0, 1.0)];
        shapes.push(Shape::Lines { lines: vec![tick], look: Look { color: INK, width: 0.2, dashes: None } });
        shapes.push(text(&number(z), at + DVec2::new(0.0, 1.4 + 0.7 * TEXT), TEXT, Align::Center));
    }
    (width + 6.0, shapes)
}

fn text(text: &str, at: DVec2, size: f64, align: Align) -> Shape {
    Shape::Text(Text { text: text.to_owned(), at, size, color: INK, align, turn: None, rim: 0.0 })
}

fn area(from: DVec2, to: DVec2, color: Rgb) -> Shape {
    let ring = vec![from, DVec2::new(to.x, from.y), to, DVec2::new(from.x, to.y)];
    Shape::Area { rings: vec![ring], color }
}

fn moved(shape: Shape, by: DVec2) -> Shape {
    let each = |lines: Vec<Vec<DVec2>>| -> Vec<Vec<DVec2>> {
        lines.into_iter().map(|line| line.into_iter().map(|p| p + by).collect()).collect()
    };
    match shape {
        Shape::Picture { from, to, image } => Shape::Picture { from: from + by, to: to + by, image },
        Shape::Lines { lines, look } => Shape::Lines { lines: each(lines), look },
        Shape::Area { rings, color } => Shape::Area { rings: each(rings), color },
        Shape::Text(text) => Shape::Text(Text { at: text.at + by, ..text }),
    }
}

/// A whole number with a narrow space between thousands, as scales are written.
fn grouped(value: f64) -> String {
    let digits = number(value);
    if digits.contains('.') || digits.len() <= 4 {
        return digits;
    }
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            out.push(' ');
        }
        out.push(digit);
    }
    out
}
