//! Pixels, colours and paint as the drawing library has them.

use image::RgbImage;
use tiny_skia::{Color, Paint, Pixmap, Shader};

use super::color::Rgb;
use tokosen_core::base::error::{Error, Result};

pub(crate) fn pixmap(width: usize, height: usize) -> Result<Pixmap> {
    let size = u32::try_from(width).ok().zip(u32::try_from(height).ok());
    size.and_then(|(width, height)| Pixmap::new(width, height))
        .ok_or_else(|| Error::Parameter(format!("a picture of {width} x {height} pixels cannot be made")))
}

pub(crate) fn color_of([r, g, b]: Rgb, alpha: f32) -> Color {
    Color::from_rgba8(r, g, b, (alpha.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// Anti-aliased paint of one colour.
pub(crate) fn paint(color: Rgb, alpha: f32) -> Paint<'static> {
    Paint { shader: Shader::SolidColor(color_of(color, alpha)), anti_alias: true, ..Paint::default() }
}

pub(crate) fn image_of(sheet: &Pixmap) -> RgbImage {
    let pixels = sheet.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    RgbImage::from_raw(sheet.width(), sheet.height(), pixels).expect("three bytes a pixel were collected")
}
