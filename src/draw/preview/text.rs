//! Text as filled outlines.
//!
//! The font is Ubuntu Light, which the `epaint_default_fonts` crate embeds. The Ubuntu Font Licence 1.0 allows that,
//! and says that pictures made with the font are free of it.

use ab_glyph::{Font, FontRef, OutlineCurve, Point, PxScale, ScaleFont};
use tiny_skia::{FillRule, LineJoin, Path, PathBuilder, Pixmap, Stroke, Transform};

use super::canvas::paint;
use super::color::{PAPER, Rgb};

/// Where a text lies relative to the given place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Align {
    /// Starts there.
    Left,
    /// Is centred there.
    Center,
    /// Ends there.
    Right,
}

/// Extra stroke width, pixels, because small text in a light face is pale.
const EMBOLDEN: f32 = 0.35;

/// The same for turned text, whose pixels are blurred more.
const EMBOLDEN_TURNED: f32 = 0.55;
/// Height of capitals and figures, as a share of the size of the font.
const CAPITALS: f32 = 0.62;
/// Opacity of the rim around letters.
const RIM_ALPHA: f32 = 0.55;

/// Where a turned text is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turned {
    /// Its centre, pixels.
    pub at: (f32, f32),
    /// Degrees clockwise.
    pub turn: f32,
    /// Width of the light rim around the letters, pixels.
    pub rim: f32,
}

/// Sets text.
pub(crate) struct Typesetter {
    font: FontRef<'static>,
}

impl Typesetter {
    pub fn new() -> Self {
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT);
        Self { font: font.expect("the embedded font is a font") }
    }

    /// Width of a line of text, pixels.
    pub fn width(&self, text: &str, size: f32) -> f32 {
        self.place(text, size, |_, _| {})
    }

    /// Draws a line of text with its base line at `y`.
    pub fn draw(&self, pixmap: &mut Pixmap, text: &str, (x, y): (f32, f32), size: f32, color: Rgb, align: Align) {
        let left = match align {
            Align::Left => x,
            Align::Center => x - self.width(text, size) / 2.0,
            Align::Right => x - self.width(text, size),
        };
        let Some(path) = self.outline(text, size) else { return };
        fill(pixmap, &path, Transform::from_translate(left, y), color, EMBOLDEN);
    }

    /// Draws a line of text around a centre, turned clockwise by some degrees, with a light rim if `rim` has a width.
    pub fn draw_turned(&self, pixmap: &mut Pixmap, text: &str, place: Turned, size: f32, color: Rgb) {
        let Some(path) = self.outline(text, size) else { return };
        let Turned { at: (x, y), turn, rim } = place;
        // Figures stand on the base line and reach up to the height of capitals.
        let to_centre = Transform::from_translate(-self.width(text, size) / 2.0, size * CAPITALS / 2.0);
        let transform = to_centre.post_rotate(turn).post_translate(x, y);
        if rim > 0.0 {
            let stroke = Stroke { width: 2.0 * rim, line_join: LineJoin::Round, ..Stroke::default() };
            pixmap.stroke_path(&path, &paint(PAPER, RIM_ALPHA), &stroke, transform, None);
        }
        fill(pixmap, &path, transform, color, EMBOLDEN_TURNED);
    }

    /// The outlines of a line of text that starts at the origin.
    fn outline(&self, text: &str, size: f32) -> Option<Path> {
        let mut path = PathBuilder::new();
        self.place(text, size, |glyph, advance| {
            let Some(outline) = self.font.outline(glyph) else { return };
            let scale = self.font.as_scaled(PxScale::from(size)).scale_factor();
            let at = |p: Point| (advance + p.x * scale.horizontal, -p.y * scale.vertical);
            let mut last = None;
            for curve in &outline.curves {
                let (OutlineCurve::Line(start, end)
                | OutlineCurve::Quad(start, _, end)
                | OutlineCurve::Cubic(start, _, _, end)) = *curve;
                // The curves of all loops of a letter come in one list; a jump starts the next loop.
                if last != Some(start) {
                    let (x, y) = at(start);
                    path.move_to(x, y);
                }
                last = Some(end);
                let (ex, ey) = at(end);
                match *curve {
                    OutlineCurve::Line(..) => path.line_to(ex, ey),
                    OutlineCurve::Quad(_, c, _) => {
                        let (cx, cy) = at(c);
                        path.quad_to(cx, cy, ex, ey);
                    }
                    OutlineCurve::Cubic(_, c, d, _) => {
                        let ((cx, cy), (dx, dy)) = (at(c), at(d));
                        path.cubic_to(cx, cy, dx, dy, ex, ey);
                    }
                }
            }
        });
        path.finish()
    }

    /// Calls `each` with every glyph and its distance from the start; gives the width of the whole.
    fn place(&self, text: &str, size: f32, mut each: impl FnMut(ab_glyph::GlyphId, f32)) -> f32 {
        let font = self.font.as_scaled(PxScale::from(size));
        let (mut advance, mut last) = (0.0, None);
        for letter in text.chars().filter(|c| !c.is_control()) {
            let glyph = font.glyph_id(letter);
            advance += last.map_or(0.0, |last| font.kern(last, glyph));
            each(glyph, advance);
            advance += font.h_advance(glyph);
            last = Some(glyph);
        }
        advance
    }
}

/// Fills outlines of letters, a little bolder.
fn fill(pixmap: &mut Pixmap, path: &Path, transform: Transform, color: Rgb, bolder: f32) {
    let paint = paint(color, 1.0);
    pixmap.fill_path(path, &paint, FillRule::Winding, transform, None);
    let bolder = Stroke { width: bolder, ..Stroke::default() };
    pixmap.stroke_path(path, &paint, &bolder, transform, None);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_a_legend_needs() {
        let setter = Typesetter::new();
        for letter in "0123456789.,-()/:%°−·'\"AZaz äé".chars() {
            assert_ne!(setter.font.glyph_id(letter).0, 0, "{letter}");
        }
        assert!(setter.width("1200 m", 15.0) > setter.width("120 m", 15.0));
        assert_eq!(setter.width("", 15.0), 0.0);
    }

    #[test]
    fn text_leaves_ink_where_it_is_put() {
        let mut pixmap = Pixmap::new(100, 30).unwrap();
        Typesetter::new().draw(&mut pixmap, "Ridge 漢字 \u{7}", (50.0, 20.0), 15.0, [0, 0, 0], Align::Center);
        let inked = |x: u32| (0..30).any(|y| pixmap.pixel(x, y).unwrap().alpha() > 0);
        assert!((20..80).filter(|&x| inked(x)).count() > 25);
        assert!(!inked(0) && !inked(99));
    }
}
