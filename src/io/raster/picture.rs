//! Writes pictures of the map: 8-bit PNG in colour, or in grey with georeferencing.

use std::path::Path;

use image::RgbImage;
use png::{BitDepth, ColorType, Encoder};

use super::output::{check_grid, create};
use super::pam;
use super::png::filled;
use crate::maker::PROGRAM;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::raster::{Blocks, Dem, RasterRows, uniform};

/// Writes a picture as PNG. The name must end in `.png`.
///
/// # Errors
/// The extension is another one, or the operating system reports an error.
pub fn write_picture(path: &Path, picture: &RgbImage) -> Result<()> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return Err(Error::file(path, "pictures are written as .png"));
    }
    encode(path, picture.dimensions(), ColorType::Rgb, picture.as_raw())
}

/// A picture as the bytes of a PNG file.
///
/// # Errors
/// [`Error::Data`] if the picture has no pixels.
pub fn picture_bytes(picture: &RgbImage) -> Result<Vec<u8>> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let written = picture.write_to(&mut bytes, image::ImageFormat::Png);
    written.map_err(|e| Error::Data(format!("the picture cannot be written: {e}")))?;
    Ok(bytes.into_inner())
}

/// Writes a hillshade as 8-bit grey PNG: brightness from 1 to 255, 0 for no data. `.pgw` and `.png.aux.xml` beside it
/// give its placement. The name must end in `.png`.
///
/// # Errors
/// The extension is another one, the grid has no cells or an invalid placement, or the operating system reports an
/// error. As [`RasterRows::read`].
pub fn write_shade(path: &Path, shade: &dyn RasterRows) -> Result<()> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return Err(Error::file(path, "pictures are written as .png"));
    }
    let grid = shade.grid();
    check_grid(path, &grid)?;
    let mut grey = uniform(grid.len(), 0)?;
    let mut blocks = Blocks::of(shade);
    while let Some(block) = blocks.next()? {
        let pixels = grey[block.rows.start * grid.cols..].iter_mut().zip(block.heights());
        pixels.filter(|(_, v)| !v.is_nan()).for_each(|(pixel, v)| *pixel = v.round().clamp(1.0, 255.0) as u8);
    }
    // The check above ensures that both fit into 31 bits.
    encode(path, (grid.cols as u32, grid.rows as u32), ColorType::Grayscale, &grey)?;
    let placed = Dem { grid, values: Vec::new(), crs: shade.crs().cloned() };
    pam::write_aux_placement(path, &placed, &[])?;
    pam::write_world(path, "pgw", &placed)
}

fn encode(path: &Path, (width, height): (u32, u32), color: ColorType, bytes: &[u8]) -> Result<()> {
    create(path, |out| {
        let mut encoder = Encoder::new(out, width, height);
        encoder.set_color(color);
        encoder.set_depth(BitDepth::Eight);
        encoder.add_text_chunk("Software".to_owned(), PROGRAM.to_owned()).map_err(filled)?;
        let mut writer = encoder.write_header().map_err(filled)?;
        writer.write_image_data(bytes).map_err(filled)?;
        writer.finish().map_err(filled)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_comes_back() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("map.PNG");
        let picture = RgbImage::from_fn(13, 7, |x, y| image::Rgb([x as u8, y as u8, 200]));
        write_picture(&path, &picture).unwrap();
        assert_eq!(image::open(&path).unwrap().to_rgb8(), picture);
        assert!(write_picture(&dir.path().join("map.jpg"), &picture).is_err());
        assert!(write_picture(&dir.path().join("nowhere/map.png"), &picture).is_err());
    }
}
