//! OpenEXR height maps: one 32-bit floating point channel `Y`, losslessly compressed.
//!
//! Image programs show a channel of that name as grey, and GDAL uses it as its grey band. NaN marks cells without data.
//! The placement is the attribute `gdal:geoTransform`, a 3 x 3 matrix of doubles. Its first two rows are (cell width,
//! 0, corner x) and (0, minus cell height, corner y). The coordinate reference system is the text `gdal:crsWkt`. GDAL
//! reads no EXR attribute for nodata, therefore the nodata value is in `.exr.aux.xml`.

use std::io::BufReader;
use std::path::Path;

use exr::meta::MetaData;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, ReadChannels, ReadLayers, Text, WritableImage,
};

use super::height_unit::height_unit;
use super::heights::{Coding, Heights, check_size};
use super::output::{Filled, create, geo_transform};
use super::pam::{self, Band};
use super::placement;
use super::quantity::{STANDARD_ERROR, Values};
use super::sidecar;
use crate::maker::PROGRAM;
use crate::ordinary::open_to_read;
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::crs::Crs;
use tokosen_core::raster::Dem;

/// The channel of heights.
const HEIGHTS: &str = "Y";
/// The channel of standard errors. The format sorts channels by name, so it comes after the heights.
const ERRORS: &str = "standard_error";

/// Blocks are rows of scan lines in increasing order. Then the bytes do not depend on the number of threads.
const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: exr::image::Blocks::ScanLines,
    line_order: LineOrder::Increasing,
};

/// Writes `dem` to `path` and its nodata value to `path` + `.aux.xml`.
///
/// The standard errors, if there are any, are a second channel.
pub(super) fn write(path: &Path, dem: &Dem, values: Values, errors: Option<&[f32]>) -> Result<()> {
    let heights = AnyChannel::new(HEIGHTS, FlatSamples::F32(dem.values.clone()));
    let second = errors.map(|errors| AnyChannel::new(ERRORS, FlatSamples::F32(errors.to_vec())));
    let mut attributes = LayerAttributes {
        comments: Some(Text::from(format!("{}; NaN where there is no data", values.words()).as_str())),
        software_name: Some(Text::from(PROGRAM)),
        ..LayerAttributes::default()
    };
    if let Some(wkt) = dem.crs.as_ref().and_then(Crs::header_wkt) {
        // GDAL reads the bytes of a text as UTF-8, so the text is stored unchanged.
        let text = Text::from_slice_unchecked(wkt.as_bytes());
        attributes.other.insert(Text::from("gdal:crsWkt"), AttributeValue::Text(text));
    }
    let layer = Layer::new(
        (dem.grid.cols, dem.grid.rows),
        attributes,
        ENCODING,
        AnyChannels::sort(std::iter::once(heights).chain(second).collect()),
    );
    let mut image = Image::from_layer(layer);
    // Readers refuse ratios beyond this range.
    image.attributes.pixel_aspect = (dem.grid.cell.x / dem.grid.cell.y).clamp(1e-6, 1e6) as f32;
    let [x, width, _, y, _, height] = geo_transform(&dem.grid);
    let matrix = [width, 0.0, x, 0.0, height, y, 0.0, 0.0, 1.0];
    let bytes = matrix.iter().flat_map(|v| v.to_le_bytes()).collect();
    // The attributes of image and layer are hash maps. With one entry in each, their order in the file is fixed.
    let matrix = AttributeValue::Custom { kind: Text::from("m33d"), bytes };
    image.attributes.other.insert(Text::from("gdal:geoTransform"), matrix);

    create(path, |out| {
        image.write().to_buffered(out).map_err(|error| match error {
            exr::error::Error::Io(error) => Filled::Io(error),
            other => Filled::Format(other.into()),
        })
    })?;
    let band = Band { name: values.name(), unit: values.unit(), offset: 0.0, scale: 1.0, nodata: Some("nan") };
    let second = Band { name: STANDARD_ERROR, ..band };
    let bands = [band, second];
    pam::write_aux_xml(path, dem, &bands[..1 + usize::from(errors.is_some())])
}

/// Reads a height map: the first channel, with the attributes that [`write`] stores.
pub(super) fn read(path: &Path) -> Result<Report<Dem>> {
    read_channel(path, |_| true)?.ok_or_else(|| Error::file(path, "has no channel"))
}

/// Reads the channel of standard errors, if there is one.
pub(super) fn read_errors(path: &Path) -> Result<Option<Dem>> {
    Ok(read_channel(path, |name| name == ERRORS)?.map(|report| report.value))
}

/// Reads the first channel whose name is wanted.
///
/// Long because each attribute of the header is checked before the pixels are read.
fn read_channel(path: &Path, is_wanted: impl Fn(&str) -> bool) -> Result<Option<Report<Dem>>> {
    let wrong = |error: exr::error::Error| match error {
        exr::error::Error::Io(e) if e.raw_os_error().is_some() => Error::io("read", path, e),
        other => Error::file_cause(path, "is not an OpenEXR file that can be read, or it is cut off", other),
    };
    let file = open_to_read(path)?;
    let length = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
    // The sizes in the header are checked before the library allocates memory for them.
    let meta = MetaData::read_from_buffered(BufReader::new(&file), true).map_err(wrong)?;
    for header in &meta.headers {
        let (cols, rows) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        let channels = header.channels.list.len() as u64;
        check_size(path, cols.saturating_mul(channels.max(1)), rows, length)?;
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .pedantic()
        .from_file(path)
        .map_err(wrong)?;
    let layer = image.layer_data;
    let size = (layer.size.width(), layer.size.height());
    let attribute = |name: &str| {
        let name = Text::new_or_none(name)?;
        image.attributes.other.get(&name).or_else(|| layer.attributes.other.get(&name))
    };
    let aux = sidecar::read_aux_xml(path)?.unwrap_or_default();
    let matrix = match attribute("gdal:geoTransform") {
        Some(AttributeValue::Custom { bytes, .. }) => matrix(bytes),
        _ => None,
    };
    let placement = match matrix.or(aux.transform) {
        Some(numbers) => placement::by_transform(numbers, size).map_err(|message| Error::file(path, message))?,
        None => {
            let message = "has no attribute gdal:geoTransform and no .aux.xml beside it, so its cells have no place on \
                           a map";
            return Err(Error::file(path, message));
        }
    };
    let crs = match attribute("gdal:crsWkt") {
        // GDAL writes UTF-8, though the format says Latin-1.
        Some(AttributeValue::Text(text)) => Some(Crs::from_wkt(&String::from_utf8_lossy(text.as_slice()))),
        _ => aux.crs,
    };
    let mut findings = Vec::new();
    let channels = layer.channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    let wanted = channels.into_iter().zip(&names).find(|(_, name)| is_wanted(name));
    let Some((channel, _)) = wanted else { return Ok(None) };
    if names.len() > 1 && names != [HEIGHTS, ERRORS] {
        let message = format!("the file has the channels {}; the first is taken for the heights", names.join(", "));
        findings.push(Finding::general(FindingKind::OtherBands, message));
    }
    let unit = height_unit([aux.unit.as_deref()], crs.as_ref());
    findings.extend(unit.finding);
    let [scale, offset] = [aux.scale.unwrap_or(1.0), aux.offset.unwrap_or(0.0)].map(|steps| steps * unit.metres);
    let coding = Coding { nodata: aux.nodata, scale, offset };
    let mut heights = Heights::new(coding);
    let mut values: Vec<f32> = match channel.sample_data {
        FlatSamples::F32(samples) => samples.into_iter().map(|v| heights.height(v.into())).collect(),
        FlatSamples::F16(samples) => samples.into_iter().map(|v| heights.height(v.to_f64())).collect(),
        FlatSamples::U32(samples) => samples.into_iter().map(|v| heights.height(v.into())).collect(),
    };
    findings.extend(heights.finding());
    let grid = placement.grid;
    if values.len() != grid.len() {
        let message = format!("its channel has {} values for {} x {} cells", values.len(), grid.cols, grid.rows);
        return Err(Error::file(path, message));
    }
    if placement.south_up {
        flip(&mut values, grid.cols);
    }
    Ok(Some(Report { value: Dem { grid, values, crs }, findings }))
}

/// GDAL's six numbers, from the matrix of doubles in the attribute.
fn matrix(bytes: &[u8]) -> Option<[f64; 6]> {
    let (numbers, []) = bytes.as_chunks::<8>() else { return None };
    let numbers: Vec<f64> = numbers.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let [a, b, x, d, e, y, ..] = numbers[..] else { return None };
    (numbers.len() == 9).then_some([x, a, b, y, d, e])
}

/// Reverses the order of the rows.
pub(super) fn flip(values: &mut [f32], cols: usize) {
    let rows = values.len() / cols.max(1);
    for row in 0..rows / 2 {
        let (north, south) = values.split_at_mut((rows - 1 - row) * cols);
        north[row * cols..][..cols].swap_with_slice(&mut south[..cols]);
    }
}

#[cfg(test)]
mod tests {
    use exr::prelude::{ReadChannels, ReadLayers, read};

    use super::super::quantity::Quantity;
    use super::super::tests::sample;
    use super::*;

    #[test]
    fn heights_come_back_bit_for_bit_with_their_place() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.exr");
        let mut dem = sample(37, 53);
        dem.crs = Some(Crs { epsg: None, wkt: Some("LOCAL_CS[\"平面\"]".into()) });
        write(&path, &dem, Quantity::Height.into(), None).unwrap();
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(&path)
            .unwrap();
        let channel = &image.layer_data.channel_data.list[0];
        assert_eq!(channel.name, Text::from("Y"));
        let FlatSamples::F32(values) = &channel.sample_data else { panic!("not 32-bit floating point") };
        assert!(values.iter().zip(&dem.values).all(|(a, b)| a.to_bits() == b.to_bits()));
        let attribute = |name: &str| {
            let name = Text::from(name);
            image.attributes.other.get(&name).or_else(|| image.layer_data.attributes.other.get(&name)).unwrap().clone()
        };
        let AttributeValue::Text(wkt) = attribute("gdal:crsWkt") else { panic!("not a text") };
        assert_eq!(wkt.as_slice(), "LOCAL_CS[\"平面\"]".as_bytes());
        let AttributeValue::Custom { kind, bytes } = attribute("gdal:geoTransform") else { panic!("not a matrix") };
        assert_eq!(kind, Text::from("m33d"));
        let numbers: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
        let corner = dem.grid.corner;
        assert_eq!(numbers, [10.0, 0.0, corner.x, 0.0, -12.5, corner.y, 0.0, 0.0, 1.0]);
    }
}
