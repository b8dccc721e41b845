//! The events of one XML document: 基盤地図情報, GML, KML, LandXML. The parts that all readers share are here: errors that name the document, a check
//! that the document is complete, and texts in the declared encoding.

use std::io::BufRead;
use std::path::Path;

use encoding_rs::{Encoding, UTF_8};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::meter::DocumentReader;
use tokosen_core::base::error::{Cause, Error, Result};

/// The largest nesting depth of elements. Published documents reach about 12.
const MAX_DEPTH: usize = 100;

/// The attributes that a reader may ask for, by their local names.
const ATTRIBUTES: [&str; 10] =
    ["srsName", "srsDimension", "order", "name", "orientation", "elev", "linearUnit", "epsgCode", "id", "i"];

/// The next event of a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// An element begins.
    Start,
    /// An element ends.
    End,
    /// A piece of text. The text of one element may come in several pieces.
    Text,
    /// The document has ended, and it is complete.
    Over,
}

/// A document that is read from start to end.
pub(crate) struct Xml<'a, 's> {
    reader: Reader<&'a mut DocumentReader<'s>>,
    buffer: Vec<u8>,
    encoding: &'static Encoding,
    path: &'a Path,
    depth: usize,
    seen_root: bool,
    name: String,
    text: String,
    attributes: [Option<String>; ATTRIBUTES.len()],
}

impl<'a, 's> Xml<'a, 's> {
    /// Starts a document; `path` is its name for messages.
    pub fn new(path: &'a Path, source: &'a mut DocumentReader<'s>) -> Result<Self> {
        let start = source.fill_buf().map_err(|e| unreadable(path, e))?;
        if start.starts_with(b"\xfe\xff") || start.starts_with(b"\xff\xfe") {
            return Err(Error::file(path, "the document is encoded in UTF-16; convert it to UTF-8"));
        }
        if start.is_empty() {
            return Err(Error::file(path, "the document is empty"));
        }
        let mut reader = Reader::from_reader(source);
        reader.config_mut().expand_empty_elements = true;
        Ok(Self {
            reader,
            buffer: Vec::new(),
            encoding: UTF_8,
            path,
            depth: 0,
            seen_root: false,
            name: String::new(),
            text: String::new(),
            attributes: Default::default(),
        })
    }

    /// The document's name for messages.
    pub fn path(&self) -> &'a Path {
        self.path
    }

    /// How many elements are open, including the one that began last.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Local name of the element that began or ended last.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The last text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// One of the known attributes of the element that began last.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let index = ATTRIBUTES.iter().position(|known| *known == name)?;
        self.attributes[index].as_deref()
    }

    /// Goes to the next event that matters.
    ///
    /// Long because it has one arm per kind of XML event.
    pub fn next(&mut self) -> Result<Step> {
        loop {
            self.reader.get_mut().next_item();
            self.buffer.clear();
            let event = self.reader.read_event_into(&mut self.buffer).map_err(|e| match e {
                quick_xml::Error::Io(e) => unreadable(self.path, e),
                quick_xml::Error::Syntax(e) => {
                    Error::file_cause(self.path, "the XML is broken or cut off; download the file again", e)
                }
                e => Error::file_cause(self.path, "the XML is broken", e),
            })?;
            match event {
                Event::Start(start) => {
                    self.depth += 1;
                    self.seen_root = true;
                    if self.depth > MAX_DEPTH {
                        return Err(Error::file(self.path, "its elements are nested too deep for this format"));
                    }
                    set(&mut self.name, start.local_name().as_ref());
                    self.attributes = attributes(&start);
                    return Ok(Step::Start);
                }
                Event::End(end) => {
                    self.depth = self.depth.saturating_sub(1);
                    set(&mut self.name, end.local_name().as_ref());
                    return Ok(Step::End);
                }
                Event::Text(text) => {
                    decode(self.encoding, &text, &mut self.text);
                    return Ok(Step::Text);
                }
                Event::CData(text) => {
                    decode(self.encoding, &text, &mut self.text);
                    return Ok(Step::Text);
                }
                Event::GeneralRef(reference) => {
                    let named = match &reference[..] {
                        b"lt" => Some('<'),
                        b"gt" => Some('>'),
                        b"amp" => Some('&'),
                        b"quot" => Some('"'),
                        b"apos" => Some('\''),
                        _ => reference.resolve_char_ref().ok().flatten(),
                    };
                    self.text.clear();
                    self.text.extend(named);
                    return Ok(Step::Text);
                }
                Event::Decl(declaration) => {
                    if let Some(label) = declaration.encoding().and_then(Result::ok) {
                        self.encoding = Encoding::for_label(&label).ok_or_else(|| {
                            let label = String::from_utf8_lossy(&label);
                            Error::file(self.path, format!("the encoding {label:?} is not known; convert it to UTF-8"))
                        })?;
                    }
                }
                Event::Eof if !self.seen_root => {
                    let message = "it has no XML element: the file is not XML, or it is cut off";
                    return Err(Error::file(self.path, message));
                }
                Event::Eof if self.depth > 0 => {
                    let message = "the document is cut off; download the file again";
                    return Err(Error::file(self.path, message));
                }
                Event::Eof => return Ok(Step::Over),
                Event::Empty(_) | Event::Comment(_) | Event::PI(_) | Event::DocType(_) => {}
            }
        }
    }

    /// Passes the raw bytes up to the next tag to `take`, in pieces. For texts that are too long to be kept in memory.
    pub fn raw_text(&mut self, mut take: impl FnMut(&[u8]) -> Result<()>) -> Result<()> {
        let mut stream = self.reader.stream();
        loop {
            // The document's limit applies here, because a text of any length is allowed.
            stream.get_mut().next_item();
            let bytes = stream.fill_buf().map_err(|e| unreadable(self.path, e))?;
            let end = bytes.iter().position(|&b| b == b'<');
            let length = end.unwrap_or(bytes.len());
            take(&bytes[..length])?;
            stream.consume(length);
            if end.is_some() || length == 0 {
                return Ok(());
            }
        }
    }

    /// An error that names the document.
    pub fn error(&self, message: impl Into<String>) -> Error {
        Error::file(self.path, message)
    }
}

/// The error for a document that cannot be read to its end.
pub(crate) fn unreadable(path: &Path, cause: impl Into<Cause>) -> Error {
    Error::file_cause(path, "it cannot be read to its end", cause)
}

fn set(name: &mut String, bytes: &[u8]) {
    name.clear();
    name.push_str(&String::from_utf8_lossy(bytes));
}

fn decode(encoding: &'static Encoding, bytes: &[u8], text: &mut String) {
    text.clear();
    text.push_str(&encoding.decode_without_bom_handling(bytes).0);
}

fn attributes(start: &BytesStart<'_>) -> [Option<String>; ATTRIBUTES.len()] {
    let mut found: [Option<String>; ATTRIBUTES.len()] = Default::default();
    for attribute in start.attributes().with_checks(false).flatten() {
        let name = attribute.key.local_name();
        if let Some(index) = ATTRIBUTES.iter().position(|known| known.as_bytes() == name.as_ref()) {
            found[index] = Some(String::from_utf8_lossy(&attribute.value).trim().to_owned());
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meter::LimitedReader;

    fn steps(text: &[u8]) -> Result<Vec<String>> {
        let mut bytes = text;
        let mut source: DocumentReader<'_> = LimitedReader::new(&mut bytes, 1 << 20);
        let mut xml = Xml::new(Path::new("a.zip!b.xml"), &mut source)?;
        let mut steps = Vec::new();
        loop {
            match xml.next()? {
                Step::Start => steps.push(format!("+{}", xml.name())),
                Step::End => steps.push(format!("-{}", xml.name())),
                Step::Text => steps.push(xml.text().to_owned()),
                Step::Over => return Ok(steps),
            }
        }
    }

    #[test]
    fn names_lose_their_prefix_and_empty_elements_end() {
        let text = "\u{feff}<?xml version=\"1.0\"?><!-- x --><g:a><b/>1 &lt; 2</g:a>";
        assert_eq!(steps(text.as_bytes()).unwrap(), ["+a", "+b", "-b", "1 ", "<", " 2", "-a"]);
    }

    #[test]
    fn texts_are_decoded_as_declared() {
        let mut text = b"<?xml version=\"1.0\" encoding=\"Shift_JIS\"?><a>".to_vec();
        text.extend(encoding_rs::SHIFT_JIS.encode("凹地等高線").0.iter());
        text.extend(b"</a>");
        assert_eq!(steps(&text).unwrap()[1], "凹地等高線");
    }

    #[test]
    fn broken_documents_are_errors_with_their_name() {
        for (text, word) in [
            (&b""[..], "empty"),
            (b"<a><b></b>", "document is cut off"),
            (b"<a></b>", "broken"),
            (b"<a", "broken or cut off"),
            (b"no tag at all", "no XML element"),
            (b"\xff\xfe<\0", "UTF-16"),
            (b"<?xml version=\"1.0\" encoding=\"klingon\"?><a/>", "klingon"),
        ] {
            let error = steps(text).unwrap_err().to_string();
            assert!(error.starts_with("a.zip!b.xml: ") && error.contains(word), "{error}");
        }
        let deep = "<a>".repeat(200);
        assert!(steps(deep.as_bytes()).unwrap_err().to_string().contains("too deep"));
    }
}
