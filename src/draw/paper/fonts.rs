//! The fonts of a sheet: Ubuntu Light, and a font of the user for letters that it does not have.

use std::borrow::Cow;

use ttf_parser::{Face, GlyphId};

use tokosen_core::base::error::{Error, Result};

/// Fonts, in the order in which they are asked for a letter.
#[derive(Debug, Clone)]
pub struct Fonts(Vec<Font>);

#[derive(Debug, Clone)]
struct Font {
    data: Cow<'static, [u8]>,
    /// Which of the fonts of a collection it is.
    index: u32,
}

/// Letters of one font that follow each other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    /// Number of the font.
    pub font: usize,
    /// Its glyphs, with the letters that they show.
    pub glyphs: Vec<(u16, char)>,
    /// Width, as a share of the size of the font.
    pub width: f64,
}

impl Default for Fonts {
    fn default() -> Self {
        Self(vec![Font { data: Cow::Borrowed(epaint_default_fonts::UBUNTU_LIGHT), index: 0 }])
    }
}

impl Fonts {
    /// These fonts and another one, a file in TrueType or OpenType; of a collection, the first font.
    ///
    /// # Errors
    /// [`Error::Data`] if it is no such font, or may not be embedded.
    pub fn with(mut self, data: Vec<u8>) -> Result<Self> {
        let face = Face::parse(&data, 0).map_err(|e| Error::Data(format!("is no TrueType or OpenType font: {e}")))?;
        if face.permissions() == Some(ttf_parser::Permissions::Restricted) {
            return Err(Error::Data("its maker does not allow that it is embedded in documents".into()));
        }
        self.0.push(Font { data: Cow::Owned(data), index: 0 });
        Ok(self)
    }

    /// The first letter of a text that no font has.
    pub fn lacks(&self, text: &str) -> Option<char> {
        let faces = self.faces();
        text.chars().find(|c| !faces.iter().any(|face| face.glyph_index(*c).is_some()))
    }

    /// How many fonts there are.
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// The bytes of a font, and which of a collection it is.
    pub(super) fn data(&self, font: usize) -> (&[u8], u32) {
        self.0.get(font).map_or((&[], 0), |font| (&font.data, font.index))
    }

    /// The fonts, ready for questions.
    pub(super) fn faces(&self) -> Vec<Face<'_>> {
        self.0.iter().filter_map(|font| Face::parse(&font.data, font.index).ok()).collect()
    }

    /// A text, split where the font changes. A letter that no font has is the sign for unknown letters.
    pub(super) fn runs(&self, text: &str) -> Vec<Run> {
        let faces = self.faces();
        let mut runs: Vec<Run> = Vec::new();
        for letter in text.chars() {
            let found = faces.iter().enumerate().find_map(|(k, face)| Some((k, face.glyph_index(letter)?)));
            let (font, glyph) = found.unwrap_or((0, GlyphId(0)));
            let width = faces.get(font).map_or(0.0, |face| {
                f64::from(face.glyph_hor_advance(glyph).unwrap_or(0)) / f64::from(face.units_per_em())
            });
            match runs.last_mut().filter(|run| run.font == font) {
                Some(run) => {
                    run.glyphs.push((glyph.0, letter));
                    run.width += width;
                }
                None => runs.push(Run { font, glyphs: vec![(glyph.0, letter)], width }),
            }
        }
        runs
    }

    /// Width of a line of text, as a share of the size of the font.
    pub(super) fn width(&self, text: &str) -> f64 {
        self.runs(text).iter().map(|run| run.width).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_that_are_missing_are_named() {
        let fonts = Fonts::default();
        assert_eq!((fonts.lacks("Höhe 1:5000 m²"), fonts.lacks("急傾斜地")), (None, Some('急')));
        assert!(fonts.width("WW") > fonts.width("ii") && fonts.width("") == 0.0);
        assert!(fonts.clone().with(vec![0; 100]).is_err());
        let twice = fonts.with(epaint_default_fonts::HACK_REGULAR.to_vec()).unwrap();
        // The first font has these letters, the second one has a box.
        let runs = twice.runs("ab\u{2588}c");
        assert_eq!(runs.iter().map(|run| (run.font, run.glyphs.len())).collect::<Vec<_>>(), [(0, 2), (1, 1), (0, 1)]);
    }
}
