//! A model in layers, to cut with a laser: `mesh -o plates.svg --thickness 3mm`.

use std::path::{Path, PathBuf};

use clap::Args;
use glam::DVec2;
use tokosen::io::{PlannedOutput, StagedOutput, check_paths, sheet_files, write_plates};
use tokosen::plates::{Plate, PlateParams, Plates, Rise, SMALLEST};

use super::console::Console;
use super::failure::Failure;

/// The arguments about plates.
#[derive(Debug, Clone, Args)]
pub struct PlateArgs {
    /// Thickness of the material of a model in layers [mm]. Each plate is the ground at or above its level, to be cut along red
    /// lines, with the outline of the next plate and a number to be engraved. With --interval, there is a plate every so many
    /// metres; otherwise the interval follows from --size and --exaggeration
    #[arg(long, value_name = "LENGTH", value_parser = millimetres)]
    pub thickness: Option<f64>,
    /// Width and height of a sheet of the material, such as 600x400 [mm]; each sheet becomes a file. [default: one sheet, as
    /// large as needed]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = sheet)]
    pub sheet: Option<DVec2>,
}

/// A length such as 180 or 180mm.
pub fn millimetres(text: &str) -> Result<f64, String> {
    let number = text.trim().strip_suffix("mm").unwrap_or(text).trim().parse::<f64>();
    number.ok().filter(|size| size.is_finite() && *size > 0.0).ok_or_else(|| "it must be a length such as 180mm".into())
}

/// Width and height such as 600x400 or 600x400mm.
fn sheet(text: &str) -> Result<DVec2, String> {
    let sides = text.split_once(['x', 'X', '×']).and_then(|(width, height)| {
        let width = width.trim().strip_suffix("mm").unwrap_or(width);
        Some(DVec2::new(millimetres(width).ok()?, millimetres(height).ok()?))
    });
    sides.ok_or_else(|| "it must be a width and a height such as 600x400".into())
}

/// Plates that were made, with their parameters.
pub struct Made {
    plates: Plates,
    params: PlateParams,
    scale: f64,
}

/// Writes plates under temporary names: what was made, what was asked for, and the scale in millimetres for each metre.
///
/// Files of these names are not replaced if another program made them, or if they are `inputs`.
pub fn write(
    (plates, params, scale): (Plates, PlateParams, f64),
    staged: &StagedOutput,
    inputs: &[PathBuf],
    console: &Console,
) -> Result<Made, Failure> {
    // How many files there are is known only now.
    let files = sheet_files(staged.target(), plates.sheets.len());
    let outputs: Vec<PlannedOutput<'_>> = files.iter().map(|file| file.as_path().into()).collect();
    let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    check_paths(&inputs, &outputs, console.overwrite)?;
    console.step("writing", || write_plates(staged, &plates))?;
    Ok(Made { plates, params, scale })
}

impl Made {
    /// Gives the files their names, and prints what is in them.
    pub fn commit(&self, staged: StagedOutput, console: &Console) -> Result<(), Failure> {
        let Self { plates: Plates { sheets, size, left_out }, params, scale } = self;
        let (interval, factor) = params.steps(*scale)?;
        let files = sheet_files(&staged.commit()?, sheets.len());
        for (file, sheet) in files.iter().zip(sheets) {
            console.say(&format!(
                "written    {} ({}, sheet of {:.1} x {:.1} mm)",
                file.display(),
                numbers(&sheet.plates),
                sheet.size.x,
                sheet.size.y
            ));
        }
        let count = sheets.iter().map(|sheet| sheet.plates.len()).sum::<usize>();
        console.say(&format!(
            "           {count} plates of {} mm, one every {} m, {:.1} x {:.1} mm; scale 1 : {:.0}, heights {:.2} times",
            params.thickness,
            (interval.step * 100.0).round() / 100.0,
            size.x,
            size.y,
            1000.0 / scale,
            factor
        ));
        if *left_out > 0 {
            let pieces = if *left_out == 1 { "piece is" } else { "pieces are" };
            console.say(&format!(
                "           {left_out} {pieces} left out, because a circle of {SMALLEST} mm does not fit into them"
            ));
        }
        Ok(())
    }
}

/// The numbers of the plates on a sheet, which ascend.
fn numbers(plates: &[Plate]) -> String {
    let numbers: Vec<u32> = plates.iter().map(|plate| plate.number).collect();
    match numbers[..] {
        [alone] => format!("plate {alone}"),
        [first, .., last] if (last - first) as usize == numbers.len() - 1 => format!("plates {first} to {last}"),
        _ => format!("plates {}", numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// What plates are asked for. An interval and a factor on heights cannot be given together: each follows from the other.
pub fn params(
    thickness: f64,
    sheet: Option<DVec2>,
    size: Option<f64>,
    (interval, exaggeration): (Option<f64>, Option<f64>),
) -> Result<PlateParams, Failure> {
    let usual = PlateParams::of(thickness);
    let rise = match (interval, exaggeration) {
        (Some(_), Some(_)) => {
            let message =
                "--interval and --exaggeration: one of them follows from the other and --thickness. Leave out one";
            return Err(Failure::Usage(message.into()));
        }
        (Some(step), None) => Rise::Interval(step),
        (None, factor) => factor.map_or(usual.rise, Rise::Exaggeration),
    };
    Ok(PlateParams { size: size.unwrap_or(usual.size), rise, sheet, ..usual })
}
