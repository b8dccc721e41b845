//! The names of layers: their encoding in the file, and the user's selection.

use std::borrow::Cow;

use encoding_rs::{Encoding, UTF_8, WINDOWS_1252};

use crate::shapefile::encoding;

/// The first version of the format whose text is always UTF-8 (AutoCAD 2007).
const FIRST_IN_UTF_8: u32 = 1021;

/// The header's statements about the encoding of text.
#[derive(Default)]
pub(super) struct TextEncoding {
    /// The version number.
    version: Option<u32>,
    code_page: Option<&'static Encoding>,
}

impl TextEncoding {
    /// Records `$ACADVER`, such as `AC1015`.
    pub fn note_version(&mut self, word: &[u8]) {
        self.version = std::str::from_utf8(word).ok().and_then(|w| w.strip_prefix("AC")).and_then(|w| w.parse().ok());
    }

    /// Records `$DWGCODEPAGE`, such as `ANSI_932`.
    pub fn note_code_page(&mut self, word: &[u8]) {
        self.code_page = std::str::from_utf8(word).ok().and_then(encoding::of_label);
    }

    /// Decodes bytes of the file.
    pub fn text(&self, bytes: &[u8]) -> String {
        let page = self.code_page.unwrap_or(WINDOWS_1252);
        // Old files name their code page. Files without a version or with a wrong one are often UTF-8 too.
        let is_utf_8 = self.version.is_none_or(|v| v >= FIRST_IN_UTF_8) && std::str::from_utf8(bytes).is_ok();
        let encoding = if is_utf_8 { UTF_8 } else { page };
        unescaped(&encoding.decode_without_bom_handling(bytes).0).into_owned()
    }
}

/// The text with each `\U+XXXX` replaced by its character.
fn unescaped(text: &str) -> Cow<'_, str> {
    if !text.contains("\\U+") {
        return Cow::Borrowed(text);
    }
    let mut parts = text.split("\\U+");
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let code = part.get(..4).and_then(|digits| u32::from_str_radix(digits, 16).ok()).and_then(char::from_u32);
        match code {
            Some(letter) => {
                whole.push(letter);
                whole.push_str(&part[4..]);
            }
            None => {
                whole.push_str("\\U+");
                whole.push_str(part);
            }
        }
    }
    Cow::Owned(whole)
}

/// The layers that the user named, separated by commas, which layer names cannot contain. Letter case is ignored.
pub(super) struct LayerFilter(Option<Vec<String>>);

impl LayerFilter {
    /// Selects all layers if none is named.
    pub fn new(named: Option<&str>) -> Self {
        Self(named.map(|named| named.split(',').map(|name| name.trim().to_lowercase()).collect()))
    }

    /// Whether the user named layers.
    pub fn is_named(&self) -> bool {
        self.0.is_some()
    }

    /// Whether a layer of this name is selected.
    pub fn has(&self, layer: &str) -> bool {
        self.0.as_ref().is_none_or(|names| names.contains(&layer.to_lowercase()))
    }

    /// The first selected name that the drawing does not have.
    pub fn missing<'a>(&self, layers: impl Iterator<Item = &'a String>) -> Option<&str> {
        let layers: Vec<String> = layers.map(|layer| layer.to_lowercase()).collect();
        self.0.iter().flatten().find(|name| !layers.contains(name)).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_in_every_encoding() {
        let mut encoding = TextEncoding::default();
        assert_eq!(encoding.text("等高線".as_bytes()), "等高線");
        assert_eq!(encoding.text(b"H\xF6he"), "Höhe");
        encoding.note_version(b"AC1015");
        encoding.note_code_page(b"ANSI_932");
        assert_eq!(encoding.text(b"\x93\x99\x8D\x82\x90\xFC"), "等高線");
        encoding.note_version(b"AC1032");
        assert_eq!(encoding.text("等高線".as_bytes()), "等高線");
        assert_eq!(encoding.text(b"A\\U+7B49\\U+9AD8 \\U+zz \\U+D800 \\U+00e"), "A等高 \\U+zz \\U+D800 \\U+00e");
    }

    #[test]
    fn layers_are_named_with_commas() {
        let wanted = LayerFilter::new(Some("Kontur , INDEX"));
        assert!(wanted.has("KONTUR") && wanted.has("index") && !wanted.has("0"));
        let layers = ["0".to_owned(), "Kontur".to_owned()];
        assert_eq!(wanted.missing(layers.iter()), Some("index"));
        assert!(LayerFilter::new(None).has("anything") && !LayerFilter::new(None).is_named());
    }
}
