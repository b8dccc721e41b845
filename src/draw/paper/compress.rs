//! Compression of what a sheet holds: the relief as PNG, and bytes as PDF has them.

use std::io::{Cursor, Write};

use flate2::write::ZlibEncoder;
use image::RgbImage;
use png::{BitDepth, ColorType, Compression, Encoder, Filter};

use tokosen_core::base::error::{Error, Result};

/// A picture as PNG.
pub(super) fn png(image: &RgbImage) -> Result<Vec<u8>> {
    let mut out = Vec::new();
    let failed = |e: png::EncodingError| Error::Data(format!("the relief cannot be compressed: {e}"));
    let mut encoder = Encoder::new(Cursor::new(&mut out), image.width(), image.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder.set_filter(Filter::Paeth);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(image.as_raw()).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(out)
}

/// The compressed rows of a PNG: what its chunks `IDAT` hold. PDF reads the same.
pub(super) fn rows_of(png: &[u8]) -> Vec<u8> {
    let mut rows = Vec::new();
    // The signature has eight bytes. A chunk has its length, its name, its data and a checksum.
    let mut rest = png.get(8..).unwrap_or_default();
    while let Some((head, after)) = rest.split_first_chunk::<8>() {
        let [a, b, c, d, name @ ..] = *head;
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        let Some(data) = after.get(..length) else { break };
        if &name == b"IDAT" {
            rows.extend_from_slice(data);
        }
        rest = after.get(length + 4..).unwrap_or_default();
    }
    rows
}

/// Bytes in the compression of PDF.
pub(super) fn compressed(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut out = ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    let written = out.write_all(bytes).and_then(|()| out.finish());
    written.map_err(|e| Error::Data(format!("the sheet cannot be compressed: {e}")))
}
