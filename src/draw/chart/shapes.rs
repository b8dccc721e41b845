//! What a chart consists of when its layout is done: lines, areas and texts, in pixels.

use crate::preview::color::Rgb;
use crate::preview::text::Align;

/// One thing that is drawn.
pub(super) enum Shape {
    Line { points: Vec<[f64; 2]>, color: Rgb, width: f32 },
    Area { points: Vec<[f64; 2]>, color: Rgb, alpha: f32 },
    Text { text: String, at: [f64; 2], size: f32, align: Align },
}

/// All of them on a sheet of a size.
pub(super) struct Drawing {
    pub size: [f64; 2],
    pub shapes: Vec<Shape>,
}
