//! A chart as the text of an SVG. Letters stay text, so that they can be searched and edited.

use maud::{PreEscaped, html};

use super::shapes::{Drawing, Shape};
use crate::preview::color::{INK, Rgb};
use crate::preview::text::Align;

pub(super) fn draw(drawing: &Drawing) -> String {
    let [width, height] = drawing.size.map(f64::ceil);
    let drawn = html! {
        svg xmlns="http://www.w3.org/2000/svg" width=(width) height=(height) viewBox={ "0 0 " (width) " " (height) }
            font-family="Noto Sans, Noto Sans CJK JP, Meiryo, Hiragino Sans, Arial, sans-serif" {
            (PreEscaped("<!-- made by tokosen -->"))
            rect width=(width) height=(height) fill="white" {}
            @for shape in &drawing.shapes {
                @match shape {
                    Shape::Line { points, color, width } => {
                        polyline points=(list(points)) fill="none" stroke=(hex(*color)) stroke-width=(width)
                            stroke-linejoin="round" {}
                    }
                    Shape::Area { points, color, alpha } => {
                        polygon points=(list(points)) fill=(hex(*color)) fill-opacity=(alpha) {}
                    }
                    Shape::Text { text, at: [x, y], size, align } => {
                        text x=(number(*x)) y=(number(*y)) font-size=(size) fill=(hex(INK)) text-anchor=(anchor(*align)) { (text) }
                    }
                }
            }
        }
    };
    drawn.into_string()
}

fn list(points: &[[f64; 2]]) -> String {
    let points: Vec<String> = points.iter().map(|[x, y]| format!("{},{}", number(*x), number(*y))).collect();
    points.join(" ")
}

/// A hundredth of a pixel is finer than any printer.
fn number(value: f64) -> String {
    crate::scale::number((value * 100.0).round() / 100.0)
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn anchor(align: Align) -> &'static str {
    match align {
        Align::Left => "start",
        Align::Center => "middle",
        Align::Right => "end",
    }
}
