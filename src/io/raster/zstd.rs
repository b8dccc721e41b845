//! GeoTIFFs with Zstandard compression (50000, as GDAL writes it): the strips and tiles are unpacked here, because the `tiff`
//! crate does so only with a library in C. The predictor is undone here too (TIFF 6.0, section 14; Adobe Photoshop TIFF
//! Technical Note 3).

use std::io::{Read, Seek, SeekFrom};

use ruzstd::decoding::StreamingDecoder;
use tiff::decoder::DecodingResult;
use tiff::tags::ByteOrder;

/// The number of the compression.
pub(super) const ZSTD: u16 = 50000;

/// How the values of strips and tiles are stored.
#[derive(Debug, Clone, Copy)]
pub(super) struct Storage {
    /// Bytes of a value.
    pub bytes: usize,
    /// Whole numbers without a sign are 1, those with a sign 2, floating point 3.
    pub format: u16,
    /// None is 1, differences between neighbours 2, those of floating point 3.
    pub predictor: u16,
    pub order: ByteOrder,
    /// Values per cell that are interleaved.
    pub samples: usize,
}

/// Unpacks the values of a strip or tile of `width` x `height` cells.
///
/// # Errors
/// A sentence if the bytes are broken or the kind of values is not read.
pub(super) fn unpack(
    source: &mut (impl Read + Seek),
    (offset, length): (u64, u64),
    (width, height): (usize, usize),
    storage: Storage,
) -> Result<DecodingResult, String> {
    let broken = |e: &dyn std::fmt::Display| format!("its Zstandard data are broken: {e}");
    source.seek(SeekFrom::Start(offset)).map_err(|e| broken(&e))?;
    let row = width * storage.samples * storage.bytes;
    let mut bytes = vec![0; row * height];
    let mut decoder = StreamingDecoder::new(source.take(length)).map_err(|e| broken(&e))?;
    decoder.read_exact(&mut bytes).map_err(|e| broken(&e))?;
    for line in bytes.chunks_exact_mut(row.max(1)) {
        match storage.predictor {
            1 => {}
            2 => add_up(line, storage),
            3 if storage.format == 3 => join_planes(line, storage),
            other => return Err(format!("has the predictor {other}, which is not read")),
        }
    }
    // The planes of the third predictor begin with the most significant bytes, whatever the file's order.
    let order = if storage.predictor == 3 { ByteOrder::BigEndian } else { storage.order };
    values(&bytes, storage, order)
}

/// Undoes the differences between neighbours: each value is a difference to the one before it, of the same sample.
fn add_up(line: &mut [u8], storage: Storage) {
    let (size, step) = (storage.bytes, storage.bytes * storage.samples);
    for at in (step..line.len()).step_by(size) {
        // Addition with carry, from the least significant byte.
        let mut carry = 0;
        for k in 0..size {
            let byte = match storage.order {
                ByteOrder::LittleEndian => k,
                ByteOrder::BigEndian => size - 1 - k,
            };
            let sum = u16::from(line[at + byte]) + u16::from(line[at - step + byte]) + carry;
            line[at + byte] = sum as u8;
            carry = sum >> 8;
        }
    }
}

/// Undoes the predictor of floating point: bytes are differences, and all first bytes of the values come first.
fn join_planes(line: &mut [u8], storage: Storage) {
    for at in storage.samples..line.len() {
        line[at] = line[at].wrapping_add(line[at - storage.samples]);
    }
    let count = line.len() / storage.bytes;
    let joined: Vec<u8> = (0..count)
        .flat_map(|value| (0..storage.bytes).map(move |plane| plane * count + value))
        .map(|at| line[at])
        .collect();
    line.copy_from_slice(&joined);
}

/// The values of the bytes.
fn values(bytes: &[u8], storage: Storage, order: ByteOrder) -> Result<DecodingResult, String> {
    macro_rules! of {
        ($kind:ident, $number:ty) => {
            DecodingResult::$kind(
                bytes
                    .as_chunks::<{ size_of::<$number>() }>()
                    .0
                    .iter()
                    .map(|&bytes| match order {
                        ByteOrder::LittleEndian => <$number>::from_le_bytes(bytes),
                        ByteOrder::BigEndian => <$number>::from_be_bytes(bytes),
                    })
                    .collect(),
            )
        };
    }
    Ok(match (storage.format, storage.bytes) {
        (1, 1) => of!(U8, u8),
        (1, 2) => of!(U16, u16),
        (1, 4) => of!(U32, u32),
        (1, 8) => of!(U64, u64),
        (2, 1) => of!(I8, i8),
        (2, 2) => of!(I16, i16),
        (2, 4) => of!(I32, i32),
        (2, 8) => of!(I64, i64),
        (3, 4) => of!(F32, f32),
        (3, 8) => of!(F64, f64),
        (format, bytes) => return Err(format!("has values of {bytes} bytes and format {format}, which are not read")),
    })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use ruzstd::encoding::{CompressionLevel, compress_to_vec};

    use super::*;

    fn packed(bytes: &[u8], size: (usize, usize), storage: Storage) -> Result<DecodingResult, String> {
        let mut file = vec![9; 5];
        file.extend(compress_to_vec(bytes, CompressionLevel::Fastest));
        let length = file.len() as u64 - 5;
        unpack(&mut Cursor::new(file), (5, length), size, storage)
    }

    #[test]
    fn differences_are_added_up_in_both_orders() {
        let values: [i16; 6] = [10, 300, -7, 1, 2, i16::MIN];
        for order in [ByteOrder::LittleEndian, ByteOrder::BigEndian] {
            let bytes = |number: i16| match order {
                ByteOrder::LittleEndian => number.to_le_bytes(),
                ByteOrder::BigEndian => number.to_be_bytes(),
            };
            let plain: Vec<u8> = values.iter().flat_map(|&v| bytes(v)).collect();
            let differences = [10, 290, -307, 1, 1, i16::MIN.wrapping_sub(2)];
            let differences: Vec<u8> = differences.iter().flat_map(|&v| bytes(v)).collect();
            for (predictor, stored) in [(1, plain), (2, differences)] {
                let storage = Storage { bytes: 2, format: 2, predictor, order, samples: 1 };
                let DecodingResult::I16(found) = packed(&stored, (3, 2), storage).unwrap() else {
                    panic!("other values")
                };
                assert_eq!(found, values, "{predictor} {order:?}");
            }
        }
    }

    #[test]
    fn planes_of_floating_point_are_joined() {
        let values = [518.44_f32, -1.5, 518.5];
        let mut line: Vec<u8> = (0..4).flat_map(|plane| values.map(|v| v.to_be_bytes()[plane])).collect();
        for at in (1..line.len()).rev() {
            line[at] = line[at].wrapping_sub(line[at - 1]);
        }
        let storage = Storage { bytes: 4, format: 3, predictor: 3, order: ByteOrder::LittleEndian, samples: 1 };
        let DecodingResult::F32(found) = packed(&line, (3, 1), storage).unwrap() else { panic!("other values") };
        assert_eq!(found, values);
    }

    #[test]
    fn what_is_broken_is_refused() {
        let storage = Storage { bytes: 4, format: 3, predictor: 1, order: ByteOrder::LittleEndian, samples: 1 };
        assert!(packed(&[0; 8], (3, 1), storage).is_err_and(|e| e.contains("broken")));
        assert!(
            packed(&[0; 12], (3, 1), Storage { predictor: 7, ..storage }).is_err_and(|e| e.contains("predictor 7"))
        );
        assert!(packed(&[0; 12], (6, 1), Storage { bytes: 2, ..storage }).is_err_and(|e| e.contains("format 3")));
        let mut junk = Cursor::new(vec![1; 50]);
        assert!(unpack(&mut junk, (0, 50), (3, 1), storage).is_err());
        assert!(unpack(&mut junk, (500, 50), (3, 1), storage).is_err());
    }
}
