//! Limits on what a document may unpack to, so that a small archive cannot fill the memory.

use std::io::{self, BufRead, Read};

/// The largest document that is accepted, bytes. The largest published ones have about 20 MB.
pub(crate) const MAX_DOCUMENT_LENGTH: u64 = 4 << 30;

/// The longest tag or text that is accepted, bytes.
const MAX_ITEM_LENGTH: u64 = 256 << 20;

/// A limited reader of a document, from any origin.
pub(crate) type DocumentReader<'s> = LimitedReader<&'s mut dyn BufRead>;

/// A reader that stops with an error if a document, or an item in it, exceeds its limit.
pub(crate) struct LimitedReader<R> {
    inner: R,
    document: u64,
    item: u64,
}

impl<R: BufRead> LimitedReader<R> {
    /// A reader that gives at most `limit` bytes.
    pub fn new(inner: R, limit: u64) -> Self {
        Self { inner, document: limit, item: MAX_ITEM_LENGTH }
    }

    /// Starts a new item of the document.
    pub fn next_item(&mut self) {
        self.item = MAX_ITEM_LENGTH;
    }

    /// Bytes that may still be read.
    pub fn remaining(&self) -> u64 {
        self.document
    }
}

impl<R: BufRead> BufRead for LimitedReader<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let bytes = self.inner.fill_buf()?;
        let limit = self.document.min(self.item);
        if limit == 0 && !bytes.is_empty() {
            let what =
                if self.document == 0 { "it unpacks to more than is allowed" } else { "a text in it is too long" };
            return Err(io::Error::other(what));
        }
        let length = usize::try_from(limit).map_or(bytes.len(), |limit| limit.min(bytes.len()));
        Ok(&bytes[..length])
    }

    fn consume(&mut self, amount: usize) {
        self.inner.consume(amount);
        self.document = self.document.saturating_sub(amount as u64);
        self.item = self.item.saturating_sub(amount as u64);
    }
}

impl<R: BufRead> Read for LimitedReader<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let mut bytes = self.fill_buf()?;
        let length = bytes.read(out)?;
        self.consume(length);
        Ok(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_within_its_limit_is_read_whole_and_a_longer_one_refused() {
        let mut text = String::new();
        let mut reader = LimitedReader::new(&b"0123456789"[..], 10);
        reader.read_to_string(&mut text).unwrap();
        assert_eq!((text.as_str(), reader.remaining()), ("0123456789", 0));
        let error = LimitedReader::new(&b"0123456789"[..], 9).read_to_string(&mut text).unwrap_err();
        assert!(error.to_string().contains("more than is allowed"), "{error}");
    }

    #[test]
    fn an_item_has_its_own_limit() {
        let mut reader = LimitedReader { inner: io::repeat(b'x').take(20), document: 100, item: 4 }.into_buffered();
        let mut out = [0; 20];
        assert!(reader.read_exact(&mut out).is_err());
        reader.next_item();
        reader.read_exact(&mut out[..16]).unwrap();
    }

    impl<R: Read> LimitedReader<R> {
        fn into_buffered(self) -> LimitedReader<io::BufReader<R>> {
            LimitedReader { inner: io::BufReader::new(self.inner), document: self.document, item: self.item }
        }
    }
}
