//! A sheet as the text of an SVG. Letters are text, with the font in the file; lines have their widths in millimetres.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;
use maud::{PreEscaped, html};

use super::compress::png;
use super::fonts::Fonts;
use super::shapes::{HALF_FIGURE, Look, Shape, Sheet, Text};
use crate::preview::color::{PAPER, Rgb};
use crate::preview::text::Align;
use tokosen_core::base::error::Result;

/// Fonts with Japanese letters on usual systems, behind the one in the file.
const FAMILIES: &str = "tokosen, 'Noto Sans CJK JP', 'Yu Gothic', Meiryo, 'Hiragino Sans', IPAexGothic, sans-serif";

impl Sheet {
    /// The sheet as the text of an SVG. The first font is in the file; others are named, because theirs are large.
    ///
    /// # Errors
    /// If the relief cannot be compressed.
    pub fn svg(&self, fonts: &Fonts) -> Result<String> {
        let [width, height] = self.size.to_array().map(number);
        let [from, to] = self.frame;
        let inside = to - from;
        let font = STANDARD.encode(fonts.data(0).0);
        let face = format!(
            "@font-face{{font-family:tokosen;src:url(data:font/ttf;base64,{font})}} text{{font-family:{FAMILIES}}} \
             path,polyline{{fill:none;stroke-linejoin:round;stroke-linecap:round}}"
        );
        let shapes = |shapes: &[Shape]| -> Result<String> { shapes.iter().map(shape).collect() };
        let (map, around) = (shapes(&self.map)?, shapes(&self.around)?);
        let drawn = html! {
            svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"
                width={ (width) "mm" } height={ (height) "mm" } viewBox={ "0 0 " (width) " " (height) } {
                (PreEscaped("<!-- made by tokosen -->"))
                @if let Some(title) = &self.title { title { (title) } }
                defs {
                    style { (PreEscaped(&face)) }
                    clipPath id="map" {
                        rect x=(number(from.x)) y=(number(from.y)) width=(number(inside.x)) height=(number(inside.y)) {}
                    }
                }
                rect width=(width) height=(height) fill="white" {}
                g clip-path="url(#map)" { (PreEscaped(map)) }
                g { (PreEscaped(around)) }
            }
        };
        Ok(format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}", drawn.into_string()))
    }
}

fn shape(shape: &Shape) -> Result<String> {
    Ok(match shape {
        Shape::Picture { from, to, image } => {
            let (size, data) = (*to - *from, STANDARD.encode(png(image)?));
            html! {
                image x=(number(from.x)) y=(number(from.y)) width=(number(size.x)) height=(number(size.y))
                    preserveAspectRatio="none" xlink:href={ "data:image/png;base64," (data) } {}
            }
        }
        Shape::Lines { lines, look } => lines_of(lines, *look),
        Shape::Area { rings, color } => {
            let path = rings.iter().map(|ring| path(ring) + "Z").collect::<String>();
            html! { path d=(path) style={ "fill:" (hex(*color)) ";fill-rule:evenodd" } {} }
        }
        Shape::Text(text) => text_of(text),
    }
    .into_string())
}

fn lines_of(lines: &[Vec<DVec2>], Look { color, width, dashes }: Look) -> maud::Markup {
    let dashes = dashes.map(|[dash, gap]| format!("{} {}", number(dash), number(gap)));
    html! {
        g stroke=(hex(color)) stroke-width=(number(width)) stroke-dasharray=[dashes] {
            @for line in lines { path d=(path(line)) {} }
        }
    }
}

fn text_of(text: &Text) -> maud::Markup {
    let Text { text, at, size, color, align, turn, rim } = text;
    let anchor = match align {
        Align::Left => "start",
        Align::Center => "middle",
        Align::Right => "end",
    };
    let (y, turned) = match turn {
        Some(turn) => {
            let turned = format!("translate({} {}) rotate({})", number(at.x), number(at.y), number(*turn));
            (HALF_FIGURE * size, Some(turned))
        }
        None => (at.y, None),
    };
    let x = if turn.is_some() { 0.0 } else { at.x };
    // A light text below the text: not all programs can draw the outline of a text first.
    let halo = format!("stroke:{0};stroke-width:{1};stroke-linejoin:round", hex(PAPER), number(2.0 * rim));
    html! {
        @if *rim > 0.0 {
            text x=(number(x)) y=(number(y)) font-size=(number(*size)) fill=(hex(PAPER)) text-anchor=(anchor)
                transform=[&turned] style=(halo) aria-hidden="true" { (text) }
        }
        text x=(number(x)) y=(number(y)) font-size=(number(*size)) fill=(hex(*color)) text-anchor=(anchor)
            transform=[&turned] { (text) }
    }
}

/// A path along points, each relative to the one before.
fn path(line: &[DVec2]) -> String {
    let rounded = |p: &DVec2| (*p * 1000.0).round() / 1000.0;
    let mut out = String::new();
    let mut last = DVec2::ZERO;
    for (k, p) in line.iter().map(rounded).enumerate() {
        let (sign, step) = if k == 0 { ("M", p) } else { ("l", p - last) };
        let _ = write!(out, "{sign}{} {}", number(step.x), number(step.y));
        last = p;
    }
    out
}

/// A thousandth of a millimetre is finer than any printer.
fn number(value: f64) -> String {
    crate::scale::number((value * 1000.0).round() / 1000.0)
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
