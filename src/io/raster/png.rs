//! 16-bit grey PNG height maps: **height = offset + scale * value**, metres, or feet if those are asked for.
//!
//! The scale is the smallest step of the series 1, 2, 5, 10 ... with which the heights fit into 16 bits. The offset is
//! a multiple of one metre, or of the scale if that is coarser. Therefore whole metres are exact, and every other
//! height is off by at most half a step. If the map has cells without data, the value 0 marks them and heights start at
//! 1.
//!
//! Scale, offset and nodata value are in the file's text chunks (`Scale`, `Offset`, `NoData`, with the formula under
//! `Description`). For GDAL and QGIS they are also in `.png.aux.xml`, together with the coordinate reference system and
//! the placement. The world file `.pgw` repeats the placement for programs that read nothing else.

use std::io::Write;
use std::path::Path;

use png::{BitDepth, ColorType, Encoder, EncodingError};

use super::output::{Filled, create, geo_transform};
use super::pam::{self, Band};
use super::quantity::Values;
use crate::maker::PROGRAM;
use tokosen_core::base::error::Result;
use tokosen_core::raster::Dem;

/// The finest step, metres. Finer steps would only reproduce the rounding of 32-bit heights.
const FINEST_EXPONENT: i32 = -4;

/// Writes `dem` to `path`, and `.png.aux.xml` and `.pgw` beside it.
pub(super) fn write(path: &Path, dem: &Dem, values: Values) -> Result<()> {
    let coding = Coding::of(&dem.values);
    create(path, |out| encode(out, dem, &coding, values).map_err(filled))?;
    pam::write_aux_xml(
        path,
        dem,
        &[Band {
            name: values.name(),
            unit: values.unit(),
            offset: coding.offset,
            scale: coding.scale,
            nodata: coding.holes.then_some("0"),
        }],
    )?;
    pam::write_world(path, "pgw", dem)
}

/// How the values of the file become those of the map, in words.
pub(super) fn formula(dem: &Dem, values: Values) -> String {
    Coding::of(&dem.values).formula(values)
}

pub(super) fn filled(error: EncodingError) -> Filled {
    match error {
        EncodingError::IoError(error) => Filled::Io(error),
        other => Filled::Format(other.into()),
    }
}

fn encode(out: impl Write, dem: &Dem, coding: &Coding, values: Values) -> std::result::Result<(), EncodingError> {
    // The caller has checked that both fit into 31 bits.
    let mut encoder = Encoder::new(out, dem.grid.cols as u32, dem.grid.rows as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    describe(&mut encoder, dem, coding.formula(values))?;
    let mut text = |key: &str, value: String| encoder.add_text_chunk(key.to_owned(), value);
    text("Scale", coding.scale.to_string())?;
    text("Offset", coding.offset.to_string())?;
    if let (Some(_), Some((unit, _))) = (values.factor(), values.unit()) {
        text("Unit", unit.into())?;
    }
    if coding.holes {
        text("NoData", "0".into())?;
    }
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    let mut line = Vec::with_capacity(dem.grid.cols * 2);
    for row in dem.values.chunks_exact(dem.grid.cols) {
        line.clear();
        line.extend(row.iter().flat_map(|&height| coding.value(height).to_be_bytes()));
        stream.write_all(&line)?;
    }
    stream.finish()?;
    writer.finish()
}

/// Adds the text chunks that all height maps have: the meaning of the values and the placement of the cells.
pub(super) fn describe<W: Write>(
    encoder: &mut Encoder<'_, W>,
    dem: &Dem,
    formula: String,
) -> std::result::Result<(), EncodingError> {
    encoder.set_compression(png::Compression::Balanced);
    let mut text = |key: &str, value: String| encoder.add_text_chunk(key.to_owned(), value);
    text("Software", PROGRAM.into())?;
    text("Description", formula)?;
    text("GeoTransform", geo_transform(&dem.grid).map(|v| v.to_string()).join(", "))?;
    if let Some(crs) = &dem.crs {
        if let Some(code) = crs.horizontal().epsg {
            text("EPSG", code.to_string())?;
        }
        // Well-known text may contain any script, which only the international chunk can store.
        if let Some(wkt) = crs.header_wkt() {
            encoder.add_itxt_chunk("WKT".into(), wkt.into_owned())?;
        }
    }
    Ok(())
}

/// How heights become 16-bit values.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Coding {
    scale: f64,
    offset: f64,
    /// Whether there are cells without data, for which the value 0 is reserved.
    holes: bool,
}

impl Coding {
    fn of(values: &[f32]) -> Self {
        let (mut low, mut high, mut holes) = (f64::INFINITY, f64::NEG_INFINITY, false);
        for &value in values {
            if value.is_finite() {
                (low, high) = (low.min(f64::from(value)), high.max(f64::from(value)));
            } else {
                holes = true;
            }
        }
        if low > high {
            return Self { scale: 1.0, offset: 0.0, holes };
        }
        let reserved = if holes { 1.0 } else { 0.0 };
        let mut steps = (FINEST_EXPONENT..).flat_map(|exponent| [1.0, 2.0, 5.0].map(|digit| decimal(digit, exponent)));
        let fitting = |scale: f64| {
            let unit = scale.max(1.0);
            let offset = ((low - reserved * scale) / unit).floor() * unit;
            // The last half step is not used: rounding must not exceed the largest value.
            let fits = (high - offset) / scale <= f64::from(u16::MAX) - 0.5;
            fits.then_some(Self { scale, offset, holes })
        };
        steps.find_map(fitting).expect("steps grow beyond any 32-bit height")
    }

    fn value(&self, height: f32) -> u16 {
        if !height.is_finite() {
            return 0;
        }
        ((f64::from(height) - self.offset) / self.scale).round() as u16
    }

    fn formula(&self, values: Values) -> String {
        let holes = if self.holes { "; value 0: no data" } else { "" };
        format!("{} = {} + {} * value{holes}", values.words(), self.offset, self.scale)
    }
}

/// `digit` times ten to the `exponent`, as the nearest double. Negative powers of ten are not exact, but their inverses
/// are.
fn decimal(digit: f64, exponent: i32) -> f64 {
    if exponent < 0 { digit / 10_f64.powi(-exponent) } else { digit * 10_f64.powi(exponent) }
}

#[cfg(test)]
mod tests {
    use super::super::quantity::Quantity;
    use super::super::tests::sample;
    use super::*;

    fn read(path: &Path) -> (Vec<u16>, png::Info<'static>) {
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let values = bytes.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect();
        (values, reader.info().clone())
    }

    #[test]
    fn heights_come_back_within_half_a_step() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.png");
        let dem = sample(41, 29);
        write(&path, &dem, Quantity::Height.into()).unwrap();
        let (values, info) = read(&path);
        assert_eq!((info.width, info.height), (41, 29));
        let number = |key: &str| -> f64 {
            info.uncompressed_latin1_text.iter().find(|c| c.keyword == key).unwrap().text.parse().unwrap()
        };
        let (scale, offset) = (number("Scale"), number("Offset"));
        for (&value, &height) in values.iter().zip(&dem.values) {
            if height.is_nan() {
                assert_eq!(value, 0);
            } else {
                assert!(value > 0);
                let back = offset + scale * f64::from(value);
                assert!((back - f64::from(height)).abs() <= scale * 0.500_001, "{back} {height}");
            }
        }
        let world = std::fs::read_to_string(dir.path().join("dem.pgw")).unwrap();
        assert_eq!(world, "10\n0\n0\n-12.5\n735603.7399796944\n4033362.25\n");
        let aux = std::fs::read_to_string(dir.path().join("dem.png.aux.xml")).unwrap();
        assert!(aux.contains("<NoDataValue>0</NoDataValue>") && aux.contains("JGD2011 / UTM zone 53N"), "{aux}");
    }

    #[test]
    fn steps_are_round_and_whole_metres_exact() {
        let coding = Coding::of(&[903.2, 3190.0, f32::NAN]);
        assert_eq!(coding, Coding { scale: 0.05, offset: 903.0, holes: true });
        for metres in [904.0_f32, 1000.0, 3190.0] {
            assert_eq!(coding.offset + coding.scale * f64::from(coding.value(metres)), f64::from(metres));
        }
        assert_eq!(Coding::of(&[5.0, 5.0]), Coding { scale: 1e-4, offset: 5.0, holes: false });
        assert_eq!(Coding::of(&[-10.5, 65_000.0]).scale, 1.0);
        assert_eq!(Coding::of(&[0.0, f32::NAN]).value(0.0), 10_000);
    }

    #[test]
    fn every_range_fits() {
        for (low, high) in
            [(0.0, 65_535.0), (-1.0, 6.5534), (f32::MIN, f32::MAX), (-0.0, f32::MIN_POSITIVE), (8848.0, 8849.0)]
        {
            for holes in [false, true] {
                let values = if holes { vec![low, high, f32::INFINITY] } else { vec![low, high] };
                let coding = Coding::of(&values);
                for height in [low, high] {
                    let value = coding.value(height);
                    assert!(!holes || value > 0);
                    let back = coding.offset + coding.scale * f64::from(value);
                    assert!((back - f64::from(height)).abs() <= coding.scale * 0.500_001, "{coding:?} {height} {back}");
                }
            }
        }
        let nothing = Coding::of(&[f32::NAN]);
        assert_eq!((nothing.value(f32::NAN), nothing.scale), (0, 1.0));
    }
}
