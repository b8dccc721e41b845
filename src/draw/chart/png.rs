//! A chart as pixels.

use image::RgbImage;
use tiny_skia::{FillRule, Path, PathBuilder, Transform};

use super::shapes::{Drawing, Shape};
use crate::preview::canvas::{color_of, image_of, paint, pixmap};
use crate::preview::color::{INK, PAPER};
use crate::preview::stroke::{Style, stroke};
use crate::preview::text::Typesetter;
use tokosen_core::base::error::Result;

pub(super) fn draw(drawing: &Drawing) -> Result<RgbImage> {
    let [width, height] = drawing.size.map(|side| side.ceil() as usize);
    let mut sheet = pixmap(width, height)?;
    sheet.fill(color_of(PAPER, 1.0));
    let setter = Typesetter::new();
    for shape in &drawing.shapes {
        match shape {
            Shape::Line { points, color, width } => {
                let style = Style { color: *color, width: *width, alpha: 1.0, dashes: None };
                stroke(&mut sheet, path(points), style, None);
            }
            Shape::Area { points, color, alpha } => {
                if let Some(path) = path(points) {
                    let paint = paint(*color, *alpha);
                    sheet.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
                }
            }
            Shape::Text { text, at: [x, y], size, align } => {
                setter.draw(&mut sheet, text, (*x as f32, *y as f32), *size, INK, *align);
            }
        }
    }
    Ok(image_of(&sheet))
}

fn path(points: &[[f64; 2]]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (k, [x, y]) in points.iter().enumerate() {
        let (x, y) = (*x as f32, *y as f32);
        if k == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path.finish()
}
