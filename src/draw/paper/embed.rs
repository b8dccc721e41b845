//! Fonts in a PDF: of each font, the glyphs that the sheet uses, with the letters that they stand for, so that text can be
//! searched and copied.

use std::collections::BTreeMap;

use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use subsetter::{GlyphRemapper, subset};
use ttf_parser::{Face, GlyphId, Tag};

use super::compress::compressed;
use super::fonts::{Fonts, Run};
use tokosen_core::base::error::{Error, Result};

/// How glyphs are numbered: as in the font.
const IDENTITY: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The used glyphs of the fonts.
pub(super) struct Embedded<'a> {
    fonts: &'a Fonts,
    used: Vec<Used>,
}

#[derive(Default)]
struct Used {
    glyphs: GlyphRemapper,
    /// The letter that a glyph stands for, by its new number.
    letters: BTreeMap<u16, char>,
}

impl<'a> Embedded<'a> {
    /// The glyphs of these texts.
    pub fn new<'t>(fonts: &'a Fonts, texts: impl Iterator<Item = &'t str>) -> Self {
        let mut used: Vec<Used> = (0..fonts.count()).map(|_| Used::default()).collect();
        for run in texts.flat_map(|text| fonts.runs(text)) {
            let Some(used) = used.get_mut(run.font) else { continue };
            for (glyph, letter) in run.glyphs {
                let number = used.glyphs.remap(glyph);
                used.letters.entry(number).or_insert(letter);
            }
        }
        Self { fonts, used }
    }

    /// The name of a font on the page.
    pub fn name(font: usize) -> String {
        format!("F{font}")
    }

    /// The bytes of a run.
    pub fn encoded(&self, run: &Run) -> Vec<u8> {
        let number = |glyph: u16| self.used.get(run.font).and_then(|used| used.glyphs.get(glyph)).unwrap_or(0);
        run.glyphs.iter().flat_map(|(glyph, _)| number(*glyph).to_be_bytes()).collect()
    }

    /// Writes the fonts, and returns their names and places.
    pub fn write(&self, pdf: &mut Pdf, next: &mut Ref) -> Result<Vec<(String, Ref)>> {
        let faces = self.fonts.faces();
        let mut written = Vec::new();
        for (k, (used, face)) in
            self.used.iter().zip(&faces).enumerate().filter(|(_, (used, _))| !used.letters.is_empty())
        {
            let (data, index) = self.fonts.data(k);
            written.push((Self::name(k), font(pdf, next, used, face, (data, index))?));
        }
        Ok(written)
    }
}

fn font(pdf: &mut Pdf, next: &mut Ref, used: &Used, face: &Face<'_>, (data, index): (&[u8], u32)) -> Result<Ref> {
    let failed = |what: &dyn std::fmt::Display| Error::Data(format!("a font cannot be embedded: {what}"));
    let part = subset(data, index, &used.glyphs).map_err(|e| failed(&e))?;
    let outlines = Face::parse(&part, 0).ok().and_then(|part| part.raw_face().table(Tag::from_bytes(b"CFF ")));
    let [whole, glyphs, about, file, letters] = [(); 5].map(|()| next.bump());
    // Six letters before the name say that the font is a part of one.
    let own = face.names().into_iter().find(|name| name.name_id == ttf_parser::name_id::POST_SCRIPT_NAME);
    let own = own.and_then(|name| name.to_string()).unwrap_or_else(|| "Font".into());
    let name = format!("{}+{own}", tag(used));
    let name = Name(name.as_bytes());
    let unit = 1000.0 / f32::from(face.units_per_em());
    pdf.type0_font(whole)
        .base_font(name)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(glyphs)
        .to_unicode(letters);
    let mut cid = pdf.cid_font(glyphs);
    cid.subtype(if outlines.is_some() { CidFontType::Type0 } else { CidFontType::Type2 });
    cid.base_font(name).system_info(IDENTITY).font_descriptor(about).default_width(0.0);
    if outlines.is_none() {
        cid.cid_to_gid_map_predefined(Name(b"Identity"));
    }
    let widths =
        used.glyphs.remapped_gids().map(|glyph| f32::from(face.glyph_hor_advance(GlyphId(glyph)).unwrap_or(0)) * unit);
    cid.widths().consecutive(0, widths);
    cid.finish();
    let bounds = face.global_bounding_box();
    let [left, low, right, high] =
        [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|v| f32::from(v) * unit);
    let mut descriptor = pdf.font_descriptor(about);
    descriptor.name(name).flags(FontFlags::SYMBOLIC).bbox(Rect::new(left, low, right, high)).italic_angle(0.0);
    descriptor.ascent(f32::from(face.ascender()) * unit).descent(f32::from(face.descender()) * unit);
    descriptor.cap_height(f32::from(face.capital_height().unwrap_or(face.ascender())) * unit).stem_v(80.0);
    match outlines {
        Some(_) => descriptor.font_file3(file),
        None => descriptor.font_file2(file),
    };
    descriptor.finish();
    let outline_data = compressed(outlines.unwrap_or(&part))?;
    let mut stream = pdf.stream(file, &outline_data);
    stream.filter(Filter::FlateDecode);
    if outlines.is_some() {
        stream.pair(Name(b"Subtype"), Name(b"CIDFontType0C"));
    }
    stream.finish();
    let mut cmap = UnicodeCmap::new(Name(b"tokosen"), IDENTITY);
    used.letters.iter().for_each(|(number, letter)| cmap.pair(*number, *letter));
    let map = compressed(&cmap.finish())?;
    pdf.stream(letters, &map).filter(Filter::FlateDecode);
    Ok(whole)
}

/// Six capital letters that stand for the glyphs of a part of a font.
fn tag(used: &Used) -> String {
    let mix = |sum: u32, number: u32| sum.wrapping_mul(31).wrapping_add(number);
    let mut sum = used.letters.values().fold(17_u32, |sum, letter| mix(sum, u32::from(*letter)));
    let mut letter = || {
        let letter = char::from(b'A' + (sum % 26) as u8);
        sum /= 26;
        letter
    };
    (0..6).map(|_| letter()).collect()
}
