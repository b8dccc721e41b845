//! Reads grids of shifts between height systems: GTX, GeoTIFF as in PROJ-data, ISG, and the parameters of the Geospatial
//! Information Authority of Japan (`.par`).

use std::path::Path;

use glam::DVec2;

use super::geotiff_read;
use super::read::{extension, read_dem};
use crate::ordinary::read_small;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;
use tokosen_core::raster::ShiftGrid;

/// The extensions of grids of shifts.
pub const SHIFT_EXTENSIONS: [&str; 5] = ["gtx", "tif", "tiff", "isg", "par"];

/// Larger files are no grid of shifts, bytes.
const MOST_BYTES: u64 = 1 << 30;
/// The most nodes of a grid.
const MOST_NODES: usize = 1 << 28;
/// The value of GTX files where there is none.
const GTX_NO_DATA: f32 = -88.8888;
/// Bytes before the values of a GTX file.
const GTX_HEADER: usize = 40;

/// Reads a grid of shifts, metres.
///
/// # Errors
/// If the extension is not in [`SHIFT_EXTENSIONS`], if the file cannot be read or contradicts itself, and if it is not in degrees.
pub fn read_shift_grid(path: &Path) -> Result<ShiftGrid> {
    let bytes = || read_small(path, MOST_BYTES, "grid of shifts");
    let text = || Ok::<_, Error>(String::from_utf8_lossy(&bytes()?).into_owned());
    let grid = match extension(path).as_str() {
        "gtx" => gtx(&bytes()?),
        "tif" | "tiff" => return geotiff(path),
        "isg" => isg(&text()?),
        "par" => par(&text()?),
        _ => Err(format!("grids of shifts are read as .{}", SHIFT_EXTENSIONS.join(", ."))),
    };
    let grid = grid.map_err(|message| Error::file(path, message))?;
    let is_sound = grid.step.cmpgt(DVec2::ZERO).all() && grid.step.is_finite() && grid.south_west.is_finite();
    match is_sound && grid.cols > 0 && grid.values.len().is_multiple_of(grid.cols) && !grid.values.is_empty() {
        true => Ok(ShiftGrid { file: path.to_owned(), ..grid }),
        false => Err(Error::file(path, "the grid of shifts has no nodes, or no distance between them")),
    }
}

fn grid(south_west: DVec2, step: DVec2, cols: usize, values: Vec<f32>) -> ShiftGrid {
    ShiftGrid { file: Path::new("").into(), south_west, step, cols, values, systems: [None; 2] }
}

/// Big-endian: latitude and longitude of the south-west node, their steps, rows, columns, then the values from there.
fn gtx(bytes: &[u8]) -> std::result::Result<ShiftGrid, String> {
    let cut = || "the file is cut off".to_owned();
    let number =
        |at: usize| bytes.get(at..at + 8).and_then(|b| b.try_into().ok()).map(f64::from_be_bytes).ok_or_else(cut);
    let count =
        |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_be_bytes).ok_or_else(cut);
    let (south, west, dy, dx) = (number(0)?, number(8)?, number(16)?, number(24)?);
    let (rows, cols) = (count(32)? as usize, count(36)? as usize);
    let length = rows.checked_mul(cols).filter(|nodes| *nodes <= MOST_NODES).map(|nodes| 4 * nodes);
    let values = length.and_then(|length| bytes.get(GTX_HEADER..GTX_HEADER + length)).ok_or_else(cut)?;
    let value = |b: &[u8]| {
        let value = f32::from_be_bytes([b[0], b[1], b[2], b[3]]);
        if (value - GTX_NO_DATA).abs() < 1e-4 || !value.is_finite() { f32::NAN } else { value }
    };
    Ok(grid(DVec2::new(west, south), DVec2::new(dx, dy), cols, values.chunks_exact(4).map(value).collect()))
}

/// Values at the centres of cells. Those of PROJ-data name the height systems.
///
/// Source: PROJ documentation, Geodetic TIFF grids (GTG).
fn geotiff(path: &Path) -> Result<ShiftGrid> {
    let dem = read_dem(path)?.value.dem;
    if !dem.crs.as_ref().is_some_and(Crs::is_geographic) {
        return Err(Error::file(path, "the grid of shifts is not in degrees of longitude and latitude"));
    }
    let rows = dem.values.chunks(dem.grid.cols).rev();
    let found =
        grid(dem.grid.center(0, dem.grid.rows - 1), dem.grid.cell, dem.grid.cols, rows.flatten().copied().collect());
    let items = geotiff_read::metadata(path)?;
    let item = |name: &str| items.iter().find(|(own, _)| own == name).map(|(_, text)| text.as_str());
    let code = |name: &str| item(name).and_then(|text| text.parse().ok());
    let target = code("target_crs_epsg_code");
    // Heights of the geoid are added to heights above it, those of the target; the sum is a height above the ellipsoid.
    let systems = match item("TYPE") {
        Some("VERTICAL_OFFSET_GEOGRAPHIC_TO_VERTICAL") => [target, None],
        Some("VERTICAL_OFFSET_VERTICAL_TO_VERTICAL") => [code("source_crs_epsg_code"), target],
        _ => [None; 2],
    };
    Ok(ShiftGrid { file: path.to_owned(), systems, ..found })
}

/// The format of the International Service for the Geoid: a head of names and values, then rows from north to south.
///
/// The bounds are those of the nodes, or of cells around them; the number of nodes tells.
///
/// Source: ISG Format Specifications, versions 1.0 and 2.0, International Service for the Geoid.
fn isg(text: &str) -> std::result::Result<ShiftGrid, String> {
    let (head, body) = text.split_once("end_of_head").ok_or("there is no line end_of_head")?;
    let body = body.split_once('\n').map_or("", |(_, body)| body);
    let entry = |name: &str| {
        let named = |line: &str| {
            let (own, value) = line.split_once([':', '=']).filter(|(own, _)| own.trim().eq_ignore_ascii_case(name))?;
            let _ = own;
            Some(value.trim().to_owned())
        };
        head.lines().find_map(named)
    };
    let needed = |name: &str| entry(name).ok_or_else(|| format!("the head does not state {name}"));
    let angle = |name: &str| angle(&needed(name)?).ok_or_else(|| format!("{name} is no angle"));
    let count = |name: &str| needed(name)?.parse::<usize>().map_err(|_| format!("{name} is no number"));
    if entry("data ordering").is_some_and(|order| !order.to_ascii_uppercase().starts_with("N-TO-S, W-TO-E")) {
        return Err("the data ordering is not N-to-S, W-to-E".into());
    }
    let (rows, cols) = (count("nrows")?, count("ncols")?);
    let no_data: Option<f32> = entry("nodata").and_then(|text| text.parse().ok());
    let step = DVec2::new(angle("delta lon")?, angle("delta lat")?);
    let (low, high) =
        (DVec2::new(angle("lon min")?, angle("lat min")?), DVec2::new(angle("lon max")?, angle("lat max")?));
    let steps = (high - low) / step - DVec2::new(cols as f64, rows as f64);
    let south_west = match () {
        () if (steps + 1.0).abs().max_element() < 0.01 => low,
        () if steps.abs().max_element() < 0.01 => low + step / 2.0,
        () => return Err("the bounds, the steps and the numbers of rows and columns contradict each other".into()),
    };
    let number = |word: &str| {
        let value: f32 = word.parse().map_err(|_| format!("{word:?} is no number"))?;
        Ok(if Some(value) == no_data || !value.is_finite() { f32::NAN } else { value })
    };
    let values = body.split_whitespace().map(number).collect::<std::result::Result<Vec<f32>, String>>()?;
    if rows.checked_mul(cols) != Some(values.len()) || cols == 0 {
        return Err(format!("there are {} values for {rows} rows and {cols} columns", values.len()));
    }
    Ok(grid(south_west, step, cols, values.chunks(cols).rev().flatten().copied().collect()))
}

/// Degrees, or degrees, minutes and seconds such as `15°00'30"`.
fn angle(text: &str) -> Option<f64> {
    let mut parts = text.split(['°', '\'', '"', '′', '″']).map(str::trim).filter(|part| !part.is_empty());
    let first = parts.next()?;
    let degrees: f64 = first.parse().ok()?;
    let mut size = degrees.abs();
    for unit in [60.0, 3600.0] {
        if let Some(part) = parts.next() {
            size += part.parse::<f64>().ok()? / unit;
        }
    }
    Some(if first.starts_with('-') { -size } else { size }).filter(|_| parts.next().is_none())
}

/// Lines of an eight-digit mesh code and values, of which the last is that of heights, metres. A value stands at the south-west
/// corner of its mesh of 45 by 30 seconds. Lines before the first such line are the head.
fn par(text: &str) -> std::result::Result<ShiftGrid, String> {
    let is_code = |word: &str| word.len() == 8 && word.bytes().all(|b| b.is_ascii_digit());
    let mut nodes: Vec<(usize, usize, f32)> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let mut words = line.split_whitespace();
        let Some(code) = words.next().filter(|word| is_code(word)) else {
            if nodes.is_empty() || line.trim().is_empty() {
                continue;
            }
            return Err(format!("line {number} has no mesh code of eight digits"));
        };
        let digit = |k: usize| usize::from(code.as_bytes()[k] - b'0');
        let value = words
            .next_back()
            .and_then(|word| word.parse().ok())
            .ok_or_else(|| format!("line {number} has no value"))?;
        let row = 80 * (10 * digit(0) + digit(1)) + 10 * digit(4) + digit(6);
        let col = 80 * (100 + 10 * digit(2) + digit(3)) + 10 * digit(5) + digit(7);
        nodes.push((row, col, value));
    }
    let ends = |of: fn(&(usize, usize, f32)) -> usize| Some((nodes.iter().map(of).min()?, nodes.iter().map(of).max()?));
    let ((south, north), (west, east)) =
        ends(|node| node.0).zip(ends(|node| node.1)).ok_or("there is no line with a mesh code of eight digits")?;
    let cols = east - west + 1;
    let mut values = vec![f32::NAN; (north - south + 1) * cols];
    nodes.iter().for_each(|(row, col, value)| values[(row - south) * cols + col - west] = *value);
    Ok(grid(DVec2::new(west as f64 / 80.0, south as f64 / 120.0), DVec2::new(1.0 / 80.0, 1.0 / 120.0), cols, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gtx_is_read_from_the_south_west() {
        let mut bytes = Vec::new();
        [35.0f64, 138.0, 0.5, 0.25].iter().for_each(|number| bytes.extend(number.to_be_bytes()));
        [2u32, 3].iter().for_each(|count| bytes.extend(count.to_be_bytes()));
        [1.0f32, 2.0, 3.0, 4.0, 5.0, -88.8888].iter().for_each(|value| bytes.extend(value.to_be_bytes()));
        let found = gtx(&bytes).unwrap();
        assert_eq!((found.south_west, found.step), (DVec2::new(138.0, 35.0), DVec2::new(0.25, 0.5)));
        assert_eq!(found.at(DVec2::new(138.125, 35.0)), Some(1.5));
        assert_eq!(found.at(DVec2::new(138.5, 35.5)), None);
        assert!(gtx(&bytes[..60]).is_err_and(|message| message.contains("cut off")));
        assert!(gtx(&[0xff; 64]).is_err());
    }

    const ISG: &str = "begin_of_head ====\nmodel name : X\ndata ordering : N-to-S, W-to-E\nlat min = 35°00'00\"\nlat max = 35°01'00\"\n\
                       lon min = 138°00'00\"\nlon max = 138°01'30\"\ndelta lat = 0°00'30\"\ndelta lon = 0°00'45\"\nnrows = 3\nncols = 3\n\
                       nodata = -9999.0000\nISG format = 2.0\nend_of_head ====\n 7 8 9\n4 5 6\n1 2 -9999.0000\n";

    #[test]
    fn isg_has_bounds_of_nodes_or_of_cells() {
        let found = isg(ISG).unwrap();
        assert_eq!(found.at(DVec2::new(138.0, 35.0)), Some(1.0));
        assert!(found.at(DVec2::new(138.0125, 35.0 + 1.0 / 60.0)).is_some_and(|value| (value - 8.0).abs() < 1e-9));
        let of_cells = ISG
            .replace("lat max = 35°01'00\"", "lat max = 35.025")
            .replace("lon max = 138°01'30\"", "lon max = 138.0375");
        let found = isg(&of_cells).unwrap();
        assert!(found.at(DVec2::new(138.00625, 35.0 + 1.0 / 240.0)).is_some_and(|value| (value - 1.0).abs() < 1e-9));
        for (from, to) in [("nrows = 3", "nrows = 4"), ("7 8 9", "7 8"), ("end_of_head", "x"), ("delta lat", "delta")] {
            assert!(isg(&ISG.replace(from, to)).is_err(), "{from}");
        }
    }

    #[test]
    fn parameters_stand_at_the_corners_of_meshes() {
        let text =
            "JGD2011-JGD2024 Ver.1\nMeshCode dH(m)\n53394500 0.10\n53394501 0.30\n53394510 0.20\n53394511 0.40\n";
        let found = par(text).unwrap();
        // 5339-45: 35 degrees 40 minutes north, 139 degrees 37.5 minutes east.
        let corner = DVec2::new(139.625, 35.0 + 2.0 / 3.0);
        assert!(found.at(corner).is_some_and(|value| (value - 0.1).abs() < 1e-6));
        assert!(found.at(corner + found.step / 2.0).is_some_and(|value| (value - 0.25).abs() < 1e-6));
        assert!(par("no code").is_err() && par("53394500 0.1\nx y\n").is_err());
        let with_place = par("53394500 0.01 0.02 0.5\n").unwrap();
        assert_eq!(with_place.values, [0.5]);
    }

    #[test]
    fn angles_are_decimal_or_in_parts() {
        assert_eq!((angle("35.5"), angle("-0°30'00\""), angle("15°00'36\"")), (Some(35.5), Some(-0.5), Some(15.01)));
        assert_eq!((angle("x"), angle("1°2'3\"4"), angle("")), (None, None, None));
    }
}
