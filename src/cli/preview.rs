//! `--preview`: a picture of the surface and its lines.

use std::path::Path;

use glam::DVec2;
use tokosen::contour::{Contour, ContourLine, Interval, Source};
use tokosen::dem::rasterise;
use tokosen::io::StagedOutput;
use tokosen::io::raster::write_picture;
use tokosen::preview::{Preview, map_grid, render};
use tokosen::skeleton::BreakLine;
use tokosen::surface::{Surface, Tiling};

use super::Failure;
use super::console::Console;
use super::output;

/// Opens the picture's file, if one is asked for.
pub fn open(path: Option<&Path>) -> Result<Option<StagedOutput>, Failure> {
    let Some(path) = path else { return Ok(None) };
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return Err(Failure::Usage(format!("{}: pictures are written as .png", path.display())));
    }
    output::open(path).map(Some)
}

/// Draws the picture, still under its temporary name.
pub fn write(
    staged: &StagedOutput,
    surface: &Surface,
    lines: &[ContourLine],
    console: &Console,
) -> Result<(), Failure> {
    let (lo, hi) = output::extent(surface);
    let grid = map_grid(lo, hi)?;
    console.step("drawing", || {
        let dem = rasterise(&surface.tin, &grid, surface.map.crs.clone(), &());
        let picture = render(&Preview { dem: &dem, contours: lines, break_lines: &surface.break_lines, title: None })?;
        write_picture(&staged.path(), &picture).map_err(|e| staged.with_final_name(e))
    })?;
    Ok(())
}

/// Draws the triangulated map with its contours and with lines on it, still under the picture's temporary name.
pub fn write_lines(
    staged: &StagedOutput,
    tiling: &Tiling,
    lines: &[BreakLine],
    console: &Console,
) -> Result<(), Failure> {
    let corners = tiling.frame.rings().flatten();
    let (lo, hi) = corners.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let grid = map_grid(lo, hi)?;
    let contours: Vec<ContourLine> = tiling.map.contours.iter().map(|c| contour_line(c, &tiling.interval)).collect();
    console.step("drawing", || {
        let dem = rasterise(&tiling.tin, &grid, tiling.map.crs.clone(), &());
        let picture = render(&Preview { dem: &dem, contours: &contours, break_lines: lines, title: None })?;
        write_picture(&staged.path(), &picture).map_err(|e| staged.with_final_name(e))
    })?;
    Ok(())
}

/// Every fifth level is drawn as an index contour.
fn contour_line(contour: &Contour, interval: &Interval) -> ContourLine {
    let number = ((contour.elevation - interval.base) / interval.step).round();
    ContourLine {
        elevation: contour.elevation,
        points: contour.points.clone(),
        source: Source::Input,
        index: number % 5.0 == 0.0,
        depression: false,
    }
}

/// Puts the picture in its place.
pub fn commit(picture: Option<StagedOutput>, console: &Console) -> Result<(), Failure> {
    if let Some(staged) = picture {
        let path = staged.target().to_owned();
        staged.commit()?;
        console.say(&format!("written    {}", path.display()));
    }
    Ok(())
}
