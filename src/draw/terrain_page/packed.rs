//! Numbers in the page: as differences, in integers of variable length (LEB128), deflated, in base 64.
//!
//! `page/data.js` reads them.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use glam::DVec3;

/// Numbers that are being packed.
#[derive(Default)]
pub(super) struct Packed {
    bytes: Vec<u8>,
    at: [i64; 3],
}

impl Packed {
    /// A number that is not negative.
    pub fn push(&mut self, mut value: u64) {
        while value >= 128 {
            self.bytes.push(value as u8 | 128);
            value >>= 7;
        }
        self.bytes.push(value as u8);
    }

    /// A number with a sign.
    pub fn push_signed(&mut self, value: i64) {
        self.push(zigzag(value));
    }

    /// A place, as the difference from the one before, in units of `step`.
    pub fn push_place(&mut self, place: DVec3, step: f64) {
        let steps = (place / step).round().to_array().map(|v| v as i64);
        for (k, value) in steps.into_iter().enumerate() {
            self.push_signed(value - self.at[k]);
        }
        self.at = steps;
    }

    /// Values of cells in rows of `cols`, in units of `step`. A value is the difference from what its neighbours let expect;
    /// 0 stands for none.
    pub fn cells(values: impl IntoIterator<Item = f32>, cols: usize, step: f64) -> Self {
        let mut packed = Self::default();
        let mut cells: Vec<Option<i64>> = Vec::new();
        for (k, value) in values.into_iter().enumerate() {
            let own = value.is_finite().then(|| (f64::from(value) / step).round() as i64);
            let left = if k % cols > 0 { cells[k - 1] } else { None };
            let up = if k >= cols { cells[k - cols] } else { None };
            let corner = if k % cols > 0 && k >= cols { cells[k - cols - 1] } else { None };
            let expected = match (left, up, corner) {
                (Some(left), Some(up), Some(corner)) => left + up - corner,
                _ => left.or(up).unwrap_or(0),
            };
            packed.push(own.map_or(0, |own| zigzag(own - expected) + 1));
            cells.push(own);
        }
        packed
    }

    /// The text in the page.
    pub fn text(self) -> String {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
        let written = encoder.write_all(&self.bytes).and_then(|()| encoder.finish());
        STANDARD.encode(written.expect("a vector takes all bytes"))
    }
}

/// Small numbers for those near zero, whatever their sign.
fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_near_zero_are_short() {
        assert_eq!([0, -1, 1, -2, 2].map(zigzag), [0, 1, 2, 3, 4]);
        let mut packed = Packed::default();
        packed.push(300);
        packed.push_signed(-1);
        assert_eq!(packed.bytes, [0xac, 2, 1]);
    }

    #[test]
    fn cells_on_a_plane_need_a_byte_each_and_gaps_none_of_their_neighbours() {
        let plane = |k: usize| if k == 12 { f32::NAN } else { 100.0 + 3.0 * (k % 5) as f32 - 2.0 * (k / 5) as f32 };
        let packed = Packed::cells((0..25).map(plane), 5, 0.5);
        assert_eq!(packed.bytes.len(), 26, "the first one needs two");
        assert_eq!(packed.bytes[1 + 12], 0);
        assert!(packed.bytes[1 + 6..1 + 10].iter().all(|byte| *byte == 1), "{:?}", packed.bytes);
    }
}
