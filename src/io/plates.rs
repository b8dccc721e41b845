//! Writes the sheets of a model in layers, as SVG and as DXF: what a laser cutter reads, in millimetres.
//!
//! Red lines are cut, blue ones are engraved: the outline of the next plate, and the numbers. All are hairlines without fill, and
//! numbers are strokes, so no program needs a font. An SVG has a group for each plate, which Inkscape shows as a layer. A DXF has
//! the layers `CUT`, `ENGRAVE` and `NUMBERS`.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::DVec2;

use super::StagedOutput;
use super::dxf::{Drawing, Look, write_level};
use super::layer::file_name;
use super::maker::MADE_BY;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::LengthUnit;
use tokosen_core::plates::{Plate, Plates, Sheet};

/// The extensions of [`write_plates`].
pub const PLATE_EXTENSIONS: [&str; 2] = ["dxf", "svg"];

/// Width of lines, millimetres. Drivers of laser cutters take lines up to 0.01 mm (Trotec) or 0.025 mm (Epilog) for cuts, and wider
/// ones for pictures.
const HAIRLINE: f64 = 0.01;

/// The files of so many sheets: the target for one, otherwise its name with the number of the sheet.
pub fn sheet_files(target: &Path, sheets: usize) -> Vec<PathBuf> {
    (1..=sheets).map(|sheet| target.with_file_name(file_name(target, &sheet.to_string(), sheets))).collect()
}

/// Writes each sheet into a file, and returns the files.
///
/// # Errors
/// If the operating system reports one.
pub fn write_plates(out: &StagedOutput, plates: &Plates) -> Result<Vec<PathBuf>> {
    let files = sheet_files(out.target(), plates.sheets.len());
    for (sheet, file) in plates.sheets.iter().zip(&files) {
        let path = out.sibling(file.file_name().unwrap_or_default());
        let written = match file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("dxf")) {
            true => write_dxf(&path, sheet),
            false => std::fs::write(&path, svg(sheet)).map_err(|e| Error::io("write", &path, e)),
        };
        written.map_err(|e| out.with_final_name(e))?;
    }
    Ok(files)
}

/// The colours of lines that are cut and engraved, as most cutters know them.
const RED: &str = "#ff0000";
const BLUE: &str = "#0000ff";

/// Lines of one kind on a plate.
struct Part<'a> {
    layer: &'static str,
    look: Look,
    color: &'static str,
    lines: &'a [Vec<DVec2>],
}

/// The lines of a plate. Those that are engraved come first, while the plate is still a part of its sheet.
fn parts(plate: &Plate) -> [Part<'_>; 3] {
    let engraved = |layer, lines| Part { layer, look: Look::ENGRAVE, color: BLUE, lines };
    let cut = Part { layer: "CUT", look: Look::CUT, color: RED, lines: &plate.cut };
    [engraved("ENGRAVE", &plate.outline), engraved("NUMBERS", &plate.numbers), cut]
}

fn write_dxf(path: &Path, sheet: &Sheet) -> Result<()> {
    let parts = || sheet.plates.iter().flat_map(parts);
    let looks: BTreeMap<&str, Look> = parts().map(|part| (part.layer, part.look)).collect();
    let drawing = Drawing {
        looks: &looks,
        handles: parts().map(|part| part.lines.len() as u64).sum(),
        bounds: [0.0, sheet.size.x, 0.0, sheet.size.y],
        unit: Some(LengthUnit { name: "millimetre".into(), metres: 1e-3 }),
    };
    drawing.write(path, |out| {
        let mut all = parts().flat_map(|part| part.lines.iter().map(move |line| (part.layer, line)));
        all.try_for_each(|(layer, line)| write_level(out, layer, line, 0.0))
    })
}

fn svg(sheet: &Sheet) -> String {
    let [width, height] = sheet.size.to_array().map(number);
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" \
         xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"{width}mm\" height=\"{height}mm\" \
         viewBox=\"0 0 {width} {height}\">\n<!-- {MADE_BY} -->\n"
    );
    for plate in &sheet.plates {
        let (number, level) = (plate.number, (plate.level * 100.0).round() / 100.0);
        text.push_str(&format!(
            "<g id=\"plate{number}\" inkscape:groupmode=\"layer\" inkscape:label=\"plate {number}, {level} m\" fill=\"none\" \
             stroke-width=\"{HAIRLINE}\">\n"
        ));
        for Part { layer, color, lines, .. } in parts(plate) {
            text.push_str(&format!("<g id=\"plate{number}-{}\" stroke=\"{color}\">\n", layer.to_lowercase()));
            lines.iter().for_each(|line| text.push_str(&path_of(line, sheet.size.y)));
            text.push_str("</g>\n");
        }
        text.push_str("</g>\n");
    }
    text + "</svg>\n"
}

/// A path along points. In an SVG, y is downwards.
fn path_of(line: &[DVec2], height: f64) -> String {
    let is_closed = line.len() > 3 && line.first() == line.last();
    let points = &line[..line.len() - usize::from(is_closed)];
    let mut text = "<path d=\"M".to_owned();
    for p in points {
        // Writing to a text does not fail.
        let _ = write!(text, "{} {} ", number(p.x), number(height - p.y));
    }
    text.truncate(text.trim_end().len());
    text.push_str(if is_closed { "Z\"/>\n" } else { "\"/>\n" });
    text
}

/// A number of millimetres, to a thousandth.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
