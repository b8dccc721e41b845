//! Reads the groups of a DXF: two lines per group, a code and a value.

use std::path::Path;

use tokosen_core::base::error::{Error, Result};

/// The code of comments.
const COMMENT: i32 = 999;

/// A code with its value.
#[derive(Clone, Copy)]
pub(super) struct Group<'a> {
    pub code: i32,
    /// The value without its line end, in the encoding of the file.
    pub value: &'a [u8],
    /// The line number of the value, counted from 1.
    line: usize,
}

impl<'a> Group<'a> {
    /// Whether this group has code 0 and this word.
    pub fn begins(&self, word: &str) -> bool {
        self.code == 0 && self.word() == word.as_bytes()
    }

    /// The value without the spaces around it.
    pub fn word(&self) -> &'a [u8] {
        self.value.trim_ascii()
    }

    /// The value as a number; NaN and infinities are accepted.
    pub fn number(&self, path: &Path) -> Result<f64> {
        let number = std::str::from_utf8(self.word()).ok().and_then(|text| text.parse().ok());
        number.ok_or_else(|| self.no_number(path))
    }

    /// The value as flags; some programs write them with a decimal point.
    pub fn flags(&self, path: &Path) -> Result<i64> {
        let number = self.number(path)?;
        if number.fract() != 0.0 || number.abs() > f64::from(i32::MAX) {
            return Err(self.no_number(path));
        }
        Ok(number as i64)
    }

    fn no_number(&self, path: &Path) -> Error {
        let shown: String = String::from_utf8_lossy(self.word()).chars().take(40).collect();
        let message =
            format!("line {}: {shown:?} is not a number for the group {}; the file is broken", self.line, self.code);
        Error::file(path, message)
    }
}

/// The rest of a file.
pub(super) struct GroupReader<'a> {
    pub path: &'a Path,
    rest: &'a [u8],
    line: usize,
    next: Option<Group<'a>>,
}

impl<'a> GroupReader<'a> {
    /// The groups of a file's text.
    pub fn new(path: &'a Path, text: &'a [u8]) -> Self {
        Self { path, rest: text, line: 0, next: None }
    }

    /// The next group; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<Group<'a>>> {
        if let Some(group) = self.next.take() {
            return Ok(Some(group));
        }
        loop {
            let Some(code) = self.take_line() else { return Ok(None) };
            let code = code.trim_ascii();
            if code.is_empty() && self.rest.trim_ascii().is_empty() {
                return Ok(None);
            }
            let Some(code) = std::str::from_utf8(code).ok().and_then(|code| code.parse::<i32>().ok()) else {
                let shown: String = String::from_utf8_lossy(code).chars().take(40).collect();
                let message = format!(
                    "line {}: {shown:?} is not a group code; the file is not a DXF, or it is broken",
                    self.line
                );
                return Err(Error::file(self.path, message));
            };
            let Some(value) = self.take_line() else {
                return Err(Error::file(self.path, "the file ends within a group; it is not complete"));
            };
            if code != COMMENT {
                return Ok(Some(Group { code, value, line: self.line }));
            }
        }
    }

    /// Puts a group back; it is the next one again.
    pub fn put_back(&mut self, group: Group<'a>) {
        self.next = Some(group);
    }

    /// The next group, at a place where the file must not end.
    pub fn must(&mut self, within: &str) -> Result<Group<'a>> {
        let path = self.path;
        self.next()?.ok_or_else(|| Error::file(path, format!("the file ends within its {within}; it is not complete")))
    }

    fn take_line(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.line += 1;
        let (line, rest) = match self.rest.iter().position(|&byte| byte == b'\n') {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &[][..]),
        };
        self.rest = rest;
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }
}
