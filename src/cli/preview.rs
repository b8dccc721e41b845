//! `--preview`: a picture of the surface and its lines.

use std::path::Path;

use tokosen::base::Grid;
use tokosen::contour::{Contour, ContourLine, Interval, Source};
use tokosen::dem::{Dem, rasterise};
use tokosen::draw::preview::{Model, Patches, Preview, map_grid, render, render_model};
use tokosen::io::StagedOutput;
use tokosen::io::raster::write_picture;
use tokosen::mesh::Mesh;
use tokosen::skeleton::BreakLine;
use tokosen::slice::{LayerParams, Target, contour_layers};
use tokosen::subdivision::Subdivision;
use tokosen::subdomains::FrameRing;
use tokosen::surface::{Surface, heights};

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
    let scene = Scene { frame: &surface.frame, lines, breaks: &surface.break_lines, patches: None };
    draw(staged, &scene, |grid| heights(surface, grid, &()), console)
}

/// What a picture shows.
struct Scene<'a> {
    frame: &'a FrameRing,
    lines: &'a [ContourLine],
    breaks: &'a [BreakLine],
    patches: Option<&'a Patches>,
}

/// Draws a picture of anything that has heights on a grid, still under its temporary name.
fn draw(
    staged: &StagedOutput,
    scene: &Scene<'_>,
    heights: impl FnOnce(&Grid) -> Dem,
    console: &Console,
) -> Result<(), Failure> {
    let (lo, hi) = output::extent(scene.frame);
    let grid = map_grid(lo, hi)?;
    console.step("drawing", || {
        let dem = heights(&grid);
        let Scene { lines: contours, breaks: break_lines, patches, .. } = *scene;
        let picture = render(&Preview { dem: &dem, contours, break_lines, patches, title: None })?;
        write_picture(&staged.path(), &picture).map_err(|e| staged.with_final_name(e))
    })?;
    Ok(())
}

/// Draws the model in space, with the input's contours, still under its temporary name.
pub fn write_model(staged: &StagedOutput, surface: &Surface, model: &Mesh, console: &Console) -> Result<(), Failure> {
    let params = LayerParams { targets: vec![Target::Levels(Vec::new())], index_every: 5 };
    let layers = contour_layers(surface, &params, &())?;
    console.step("drawing", || {
        let lines = &layers[0].lines;
        let model = Model { mesh: model, contours: lines, break_lines: &surface.break_lines, title: None };
        write_picture(&staged.path(), &render_model(&model)?).map_err(|e| staged.with_final_name(e))
    })?;
    Ok(())
}

/// Draws the triangulated map with its contours, and areas and lines on it, still under the picture's temporary name.
pub fn write_tiling(
    staged: &StagedOutput,
    subdivision: &Subdivision,
    breaks: &[BreakLine],
    patches: Option<&Patches>,
    console: &Console,
) -> Result<(), Failure> {
    let lines: Vec<ContourLine> =
        subdivision.map.contours.iter().map(|c| contour_line(c, &subdivision.interval)).collect();
    let scene = Scene { frame: &subdivision.frame, lines: &lines, breaks, patches };
    draw(staged, &scene, |grid| rasterise(&subdivision.tin, grid, subdivision.map.crs.clone(), &()), console)
}

/// Every fifth level is drawn as an index contour.
fn contour_line(contour: &Contour, interval: &Interval) -> ContourLine {
    ContourLine {
        elevation: contour.elevation,
        points: contour.points.clone(),
        source: Source::Input,
        index: interval.index_of(contour.elevation) % 5 == 0,
        depression: false,
        expected: None,
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
