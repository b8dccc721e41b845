//! What a sheet of paper consists of, in millimetres from its upper left corner.

use glam::DVec2;
use image::RgbImage;

use crate::preview::color::Rgb;
use crate::preview::stroke::Style;
use crate::preview::text::Align;

/// From the middle of figures down to their base line, as a share of the size of the font.
pub(super) const HALF_FIGURE: f64 = 0.31;

/// A sheet with a map on it.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Width and height.
    pub(super) size: DVec2,
    /// Upper left and lower right corner of the map. Its shapes are cut off there.
    pub(super) frame: [DVec2; 2],
    /// The shapes of the map, from bottom to top.
    pub(super) map: Vec<Shape>,
    /// The shapes around it.
    pub(super) around: Vec<Shape>,
    /// The title, for the properties of the file.
    pub(super) title: Option<String>,
    /// The scale, 1 to this number, if the map has one.
    pub(super) scale: Option<f64>,
}

/// A part of a sheet.
#[derive(Debug, Clone)]
pub(super) enum Shape {
    /// A picture between two corners.
    Picture { from: DVec2, to: DVec2, image: RgbImage },
    /// Lines of one look.
    Lines { lines: Vec<Vec<DVec2>>, look: Look },
    /// An area by its rings.
    Area { rings: Vec<Vec<DVec2>>, color: Rgb },
    /// A line of text.
    Text(Text),
}

/// How lines look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    pub color: Rgb,
    pub width: f64,
    /// Lengths of dashes and of the gaps between them.
    pub dashes: Option<[f64; 2]>,
}

impl Look {
    /// The look of a line on a screen with pixels of some millimetres.
    pub fn of(style: Style, pixel: f64) -> Self {
        let dashes = style.dashes.map(|lengths| lengths.map(|length| f64::from(length) * pixel * 2.0));
        Self { color: style.color, width: f64::from(style.width) * pixel, dashes }
    }
}

/// A line of text. Its place is on the base line; that of a turned text is in the middle of its figures.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Text {
    pub text: String,
    pub at: DVec2,
    /// Size of the font.
    pub size: f64,
    pub color: Rgb,
    pub align: Align,
    /// Degrees clockwise, if it is turned.
    pub turn: Option<f64>,
    /// Width of the light rim around the letters.
    pub rim: f64,
}

impl Sheet {
    /// Width and height, millimetres.
    pub fn size(&self) -> [f64; 2] {
        self.size.to_array()
    }

    /// The scale, 1 to this number.
    pub fn scale(&self) -> Option<f64> {
        self.scale
    }

    /// All texts.
    pub(super) fn texts(&self) -> impl Iterator<Item = &Text> {
        self.map.iter().chain(&self.around).filter_map(|shape| match shape {
            Shape::Text(text) => Some(text),
            _ => None,
        })
    }
}
