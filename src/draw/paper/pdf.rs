//! A sheet as a PDF of one page: lines are lines, text is text in fonts that are embedded.

use glam::DVec2;
use image::RgbImage;
use pdf_writer::types::{LineCapStyle, LineJoinStyle, Predictor, TextRenderingMode};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};

use super::compress::{compressed, png, rows_of};
use super::embed::Embedded;
use super::fonts::Fonts;
use super::shapes::{HALF_FIGURE, Look, Shape, Sheet, Text};
use crate::preview::color::{PAPER, Rgb};
use crate::preview::text::Align;
use tokosen_core::base::error::Result;

/// Points in a millimetre.
const POINT: f64 = 72.0 / 25.4;
/// Letters of a light face are pale in print: they get an outline of this width, as a share of the size of the font.
const EMBOLDEN: f64 = 0.018;

impl Sheet {
    /// The sheet as a PDF with these fonts.
    ///
    /// # Errors
    /// If a font cannot be embedded.
    pub fn pdf(&self, fonts: &Fonts) -> Result<Vec<u8>> {
        let mut pdf = Pdf::new();
        let [info, catalog, pages, page, content] = [1, 2, 3, 4, 5].map(Ref::new);
        let mut next = Ref::new(6);
        // The maker comes first, so that the head of the file shows it.
        let mut about = pdf.document_info(info);
        about.producer(TextStr("tokosen"));
        self.title.iter().for_each(|title| {
            about.title(TextStr(title));
        });
        about.finish();
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page]).count(1);

        let embedded = Embedded::new(fonts, self.texts().map(|text| text.text.as_str()));
        let mut out =
            Out { content: Content::new(), height: self.size.y, fonts, embedded: &embedded, pictures: Vec::new() };
        out.sheet(self);
        let Out { content: drawn, pictures, .. } = out;
        pdf.stream(content, &compressed(&drawn.finish())?).filter(Filter::FlateDecode);

        let mut named = Vec::new();
        for (k, image) in pictures.into_iter().enumerate() {
            let id = next.bump();
            picture(&mut pdf, id, image)?;
            named.push((format!("I{k}"), id));
        }
        let fonts = embedded.write(&mut pdf, &mut next)?;
        let [width, height] = (self.size * POINT).to_array().map(rounded);
        let mut leaf = pdf.page(page);
        leaf.media_box(Rect::new(0.0, 0.0, width, height)).parent(pages).contents(content);
        let mut resources = leaf.resources();
        let mut list = resources.x_objects();
        named.iter().for_each(|(name, id)| {
            list.pair(Name(name.as_bytes()), *id);
        });
        list.finish();
        let mut list = resources.fonts();
        fonts.iter().for_each(|(name, id)| {
            list.pair(Name(name.as_bytes()), *id);
        });
        list.finish();
        resources.finish();
        leaf.finish();
        Ok(pdf.finish())
    }
}

/// The content of the page.
struct Out<'a> {
    content: Content,
    /// Height of the sheet, millimetres.
    height: f64,
    fonts: &'a Fonts,
    embedded: &'a Embedded<'a>,
    pictures: Vec<&'a RgbImage>,
}

impl<'a> Out<'a> {
    fn sheet(&mut self, sheet: &'a Sheet) {
        let [from, to] = sheet.frame;
        let ([left, bottom], [right, top]) = (self.at(DVec2::new(from.x, to.y)), self.at(DVec2::new(to.x, from.y)));
        self.content.set_line_join(LineJoinStyle::RoundJoin).save_state();
        self.content.rect(left, bottom, right - left, top - bottom).clip_nonzero().end_path();
        sheet.map.iter().for_each(|shape| self.shape(shape));
        self.content.restore_state();
        sheet.around.iter().for_each(|shape| self.shape(shape));
    }

    fn shape(&mut self, shape: &'a Shape) {
        match shape {
            Shape::Picture { from, to, image } => {
                let ([left, bottom], size) = (self.at(DVec2::new(from.x, to.y)), (*to - *from) * POINT);
                let name = format!("I{}", self.pictures.len());
                self.pictures.push(image);
                self.content.save_state();
                self.content.transform([rounded(size.x), 0.0, 0.0, rounded(size.y), left, bottom]);
                self.content.x_object(Name(name.as_bytes())).restore_state();
            }
            Shape::Lines { lines, look } => self.lines(lines, *look),
            Shape::Area { rings, color } => {
                self.fill(*color);
                for ring in rings {
                    self.path(ring);
                    self.content.close_path();
                }
                self.content.fill_even_odd();
            }
            Shape::Text(text) => self.text(text),
        }
    }

    fn lines(&mut self, lines: &[Vec<DVec2>], Look { color, width, dashes }: Look) {
        self.stroke(color, width);
        let dashes = dashes.map_or_else(Vec::new, |lengths| lengths.map(|length| rounded(length * POINT)).to_vec());
        // Round ends would fill the gaps between dashes.
        let cap = if dashes.is_empty() { LineCapStyle::RoundCap } else { LineCapStyle::ButtCap };
        self.content.set_line_cap(cap).set_dash_pattern(dashes, 0.0);
        for line in lines {
            self.path(line);
            self.content.stroke();
        }
    }

    fn path(&mut self, line: &[DVec2]) {
        for (k, p) in line.iter().enumerate() {
            let [x, y] = self.at(*p);
            if k == 0 {
                self.content.move_to(x, y)
            } else {
                self.content.line_to(x, y)
            };
        }
    }

    fn text(&mut self, text: &Text) {
        let runs = self.fonts.runs(&text.text);
        let width: f64 = runs.iter().map(|run| run.width).sum::<f64>() * text.size;
        let before = match text.align {
            Align::Left => 0.0,
            Align::Center => width / 2.0,
            Align::Right => width,
        };
        let along = DVec2::from_angle(text.turn.unwrap_or(0.0).to_radians());
        let down = DVec2::new(-along.y, along.x);
        let below = if text.turn.is_some() { HALF_FIGURE * text.size } else { 0.0 };
        let start = text.at - along * before + down * below;
        let [x, y] = self.at(start);
        let [cos, sin] = [along.x as f32, -along.y as f32];
        let rim = (text.rim > 0.0).then_some((PAPER, 2.0 * text.rim));
        let letters = (text.color, EMBOLDEN * text.size);
        self.fill(text.color);
        self.content.set_dash_pattern([], 0.0).set_line_cap(LineCapStyle::RoundCap);
        for (color, width) in rim.into_iter().chain([letters]) {
            self.stroke(color, width);
            let mode = if color == text.color { TextRenderingMode::FillStroke } else { TextRenderingMode::Stroke };
            self.content.begin_text().set_text_rendering_mode(mode).set_text_matrix([cos, sin, -sin, cos, x, y]);
            for run in &runs {
                let name = Embedded::name(run.font);
                self.content.set_font(Name(name.as_bytes()), rounded(text.size * POINT));
                self.content.show(Str(&self.embedded.encoded(run)));
            }
            self.content.end_text();
        }
    }

    fn stroke(&mut self, color: Rgb, width: f64) {
        let [r, g, b] = color.map(|byte| f32::from(byte) / 255.0);
        self.content.set_stroke_rgb(r, g, b).set_line_width((width * POINT) as f32);
    }

    fn fill(&mut self, color: Rgb) {
        let [r, g, b] = color.map(|byte| f32::from(byte) / 255.0);
        self.content.set_fill_rgb(r, g, b);
    }

    /// A place in points from the lower left corner.
    fn at(&self, p: DVec2) -> [f32; 2] {
        [rounded(p.x * POINT), rounded((self.height - p.y) * POINT)]
    }
}

/// A hundredth of a point is finer than any printer.
fn rounded(points: f64) -> f32 {
    ((points * 100.0).round() / 100.0) as f32
}

fn picture(pdf: &mut Pdf, id: Ref, image: &RgbImage) -> Result<()> {
    let rows = rows_of(&png(image)?);
    let [width, height] = [image.width() as i32, image.height() as i32];
    let mut object = pdf.image_xobject(id, &rows);
    object.filter(Filter::FlateDecode);
    object.width(width).height(height).bits_per_component(8).color_space().device_rgb();
    // Each row is stored as its difference from what the pixels around let expect, as in a PNG.
    object.decode_parms().predictor(Predictor::PngOptimum).colors(3).bits_per_component(8).columns(width);
    object.finish();
    Ok(())
}
