//! The list of a height map's cells: one `kind,height` per line.
//!
//! Lists have up to a million lines. Therefore they are read directly from the document's bytes, without a copy of the
//! text. The kind is in Japanese and is ignored. Only the height shows whether a cell has one, because water has a
//! height in some products and none in others.

/// A height of this value or less means no data, metres.
const NO_DATA: f64 = -9999.0;

/// A longer line cannot be a cell, bytes.
const MAX_LINE_LENGTH: usize = 200;

/// A list that is not read completely.
pub(super) struct TupleList {
    /// Heights in the order of the list, metres; NaN where there is none.
    pub heights: Vec<f32>,
    /// The largest number of heights.
    limit: usize,
    /// The beginning of a line that the last piece of text cut off.
    rest: Vec<u8>,
    line: u64,
}

impl TupleList {
    /// An empty list that may grow to `limit` cells.
    pub fn new(limit: usize) -> Self {
        Self { heights: Vec::new(), limit, rest: Vec::new(), line: 0 }
    }

    /// Reads a piece of the text, which may begin and end inside a line. The error states what is wrong and in which
    /// line.
    pub fn read(&mut self, mut text: &[u8]) -> Result<(), String> {
        if !self.rest.is_empty() {
            let end = text.iter().position(|&b| b <= b' ').unwrap_or(text.len());
            self.rest.extend(&text[..end]);
            text = &text[end..];
            if text.is_empty() {
                return self.check_length(self.rest.len());
            }
            let rest = std::mem::take(&mut self.rest);
            self.push(&rest)?;
            self.rest = rest;
            self.rest.clear();
        }
        let mut start = 0;
        for (i, &byte) in text.iter().enumerate() {
            // Any white space separates cells. The bytes of the Japanese kinds are all larger.
            if byte <= b' ' {
                if start < i {
                    self.push(&text[start..i])?;
                }
                start = i + 1;
                self.line += u64::from(byte == b'\n');
            }
        }
        self.rest.extend(&text[start..]);
        self.check_length(self.rest.len())
    }

    /// Ends the list. Its last line may have no line end.
    pub fn finish(&mut self) -> Result<(), String> {
        let rest = std::mem::take(&mut self.rest);
        if rest.is_empty() { Ok(()) } else { self.push(&rest) }
    }

    fn check_length(&self, length: usize) -> Result<(), String> {
        if length > MAX_LINE_LENGTH {
            return Err(format!("line {} of the tuple list is too long for a cell", self.line));
        }
        Ok(())
    }

    fn push(&mut self, tuple: &[u8]) -> Result<(), String> {
        // Line 1 of the list is the line of the start tag.
        let comma = tuple.iter().rposition(|&b| b == b',');
        let height = comma.and_then(|comma| number(&tuple[comma + 1..]));
        let Some(height) = height else {
            self.check_length(tuple.len())?;
            let shown = String::from_utf8_lossy(tuple);
            return Err(format!(
                "line {} of the tuple list is {shown:?}; a cell is a kind, a comma and a height",
                self.line
            ));
        };
        if self.heights.len() == self.limit {
            return Err(format!("the tuple list has more cells than the grid, which has {}", self.limit));
        }
        self.heights.push(if height <= NO_DATA { f32::NAN } else { height as f32 });
        Ok(())
    }
}

/// A finite decimal number.
pub(super) fn number(text: &[u8]) -> Option<f64> {
    let digits = match text {
        [b'-' | b'+', digits @ ..] => digits,
        digits => digits,
    };
    let (mut mantissa, mut decimals, mut count, mut has_point) = (0_u64, 0_i32, 0, false);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => {
                mantissa = mantissa * 10 + u64::from(byte - b'0');
                count += 1;
                decimals += i32::from(has_point);
                // With this many digits the quotient below is no longer the nearest number.
                if count > 15 {
                    return slow_number(text);
                }
            }
            b'.' if !has_point => has_point = true,
            _ => return slow_number(text),
        }
    }
    if count == 0 {
        return None;
    }
    let value = mantissa as f64 / 10_f64.powi(decimals);
    Some(if text[0] == b'-' { -value } else { value })
}

fn slow_number(text: &[u8]) -> Option<f64> {
    let value: f64 = std::str::from_utf8(text).ok()?.parse().ok()?;
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &[u8], piece: usize, limit: usize) -> Result<Vec<Option<f32>>, String> {
        let mut list = TupleList::new(limit);
        text.chunks(piece).try_for_each(|piece| list.read(piece))?;
        list.finish()?;
        Ok(list.heights.iter().map(|&h| (!h.is_nan()).then_some(h)).collect())
    }

    #[test]
    fn any_kind_any_line_end_and_any_pieces() {
        let text = "\r\n地表面,145.30\r\n内水面,396.63\r\n海水面,-9999.\r\nデータなし,-9999.00\r\n\r\nその他,-0.10\r\n表層面,12";
        let expected = [Some(145.3), Some(396.63), None, None, Some(-0.1), Some(12.0)];
        for piece in 1..text.len() {
            assert_eq!(list(text.as_bytes(), piece, 6).unwrap(), expected, "pieces of {piece} bytes");
        }
        let legacy = encoding_rs::SHIFT_JIS.encode(text).0;
        assert_eq!(list(&legacy, 7, 6).unwrap(), expected);
        assert_eq!(list(b"a,1 b,2\ta,3\n", 100, 6).unwrap(), [Some(1.0), Some(2.0), Some(3.0)]);
        assert_eq!(list(b" \n\n", 1, 6).unwrap(), []);
    }

    #[test]
    fn what_is_no_cell_is_told_with_its_line() {
        for text in [
            "\na,1\nb\n",
            "\na,1\nb,\n",
            "\na,1\nb,x\n",
            "\na,1\nb,nan\n",
            "\na,1\nb,inf\n",
            "\na,1\nb,1.2.3\n",
            "\na,1\nb,-",
        ] {
            for piece in [1, 3, 100] {
                let message = list(text.as_bytes(), piece, 9).unwrap_err();
                assert!(message.starts_with("line 2 of the tuple list is \"b"), "{message}");
            }
        }
        assert!(list(b"a,1\na,1\na,1", 4, 2).unwrap_err().contains("more cells than the grid, which has 2"));
        assert!(list(&[b'a'; 5000], 50, 2).unwrap_err().contains("too long"));
    }

    #[test]
    fn numbers_are_the_nearest_ones() {
        for text in ["0.1", "-0.10", "2385.50", "+3.", ".5", "123456789.012345", "1e3", "0.30000000000000004", "-9999."]
        {
            assert_eq!(number(text.as_bytes()), text.parse().ok(), "{text}");
        }
        for text in ["", "-", ".", "+.", "--1", "1-", " 1", "nan", "1e999", "１"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }
}
