//! The lines of all tiles as layers, and the findings of all tiles.

use std::collections::BTreeMap;

use glam::DVec2;
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::contour::{Contour, ContourLayer, ContourLine, Source};
use tokosen_core::crs::Reprojection;
use tokosen_core::slice::signed_area;

use super::bytes::In;
use super::chains::{Chains, chains};
use super::cut::Piece;
use super::findings::{Stored, once};
use super::folder::{Folder, LINES, RESULT};
use super::manifest::Levels;
use super::result::{LinePiece, TileResult};
use super::stored;

/// Ends at a seam that are further apart than this many mean spacings of the contours are not joined.
const MOST: f64 = 2.0;
/// Levels that differ by less than this share are one level: feet that became metres and back have rounding errors.
const ROUNDING: f64 = 1e-9;

/// What the tiles of a plan give together, besides the height map.
#[derive(Debug)]
pub struct Joined {
    /// A layer for each of the targets.
    pub layers: Vec<ContourLayer>,
    /// The conversion between the working plane and the coordinates of the input.
    pub reprojection: Reprojection,
    /// The findings about the input and in all tiles; places are on the working plane.
    pub findings: Vec<Finding>,
    /// Number of places at seams where a line goes on.
    pub seams: usize,
    /// The largest distance, at such a place, between the ends in the two tiles, map units.
    pub furthest: f64,
}

/// Joins the lines of all tiles. The contours of the input come back vertex for vertex.
///
/// # Errors
/// Tasks are not done. A file is missing or damaged.
pub fn joined_lines(folder: &Folder, progress: &dyn Progress) -> Result<Joined> {
    folder.check_done()?;
    step(progress, "joining lines", || {
        let manifest = &folder.manifest;
        let mut results = Vec::with_capacity(manifest.tasks.len());
        for task in &manifest.tasks {
            let source = manifest.source(task)?;
            if let Some(file) = folder.result(task, RESULT) {
                let bytes = stored::read(&file, source, "'tokosen work' does the task again")?;
                results.push(TileResult::decode(&bytes, &file)?);
            }
        }
        let stored = manifest.findings.iter().cloned().filter_map(Stored::finding);
        let mut findings: Vec<Finding> = stored.collect();
        findings.extend(results.iter_mut().flat_map(|result| std::mem::take(&mut result.findings)));
        let (input, reprojection) = input_lines(folder)?;
        let mut joined = Joined { layers: Vec::new(), reprojection, findings, seams: 0, furthest: 0.0 };
        if let Some(levels) = &manifest.shared.levels {
            let input = with_sides(input, &results, &mut joined.findings);
            for k in 0..levels.targets.len() {
                let layer = layer(folder, levels, k, &input, &mut results, &mut joined);
                joined.layers.push(layer?);
            }
        }
        joined.findings = once(std::mem::take(&mut joined.findings));
        Ok(joined)
    })
}

/// The contours of the input on the working plane; none if the plan has no new contours.
fn input_lines(folder: &Folder) -> Result<(Vec<Contour>, Reprojection)> {
    let manifest = &folder.manifest;
    let mut lines = Vec::new();
    if let Some(checksum) = &manifest.lines {
        let file = folder.file(LINES);
        let bytes = stored::read_known(&file, checksum)?;
        let mut bytes = In::new(&bytes, &file);
        for _ in 0..bytes.count(16)? {
            lines.push(Contour { elevation: bytes.number()?, points: bytes.points()?, feature: 0.into() });
        }
    }
    let known = manifest.input_crs.as_ref().zip(manifest.shared.working_crs.as_ref());
    let Some((input, working)) = known.filter(|(input, _)| input.kind().is_some()) else {
        return Ok((lines, Reprojection::unmoved(manifest.input_crs.clone())));
    };
    let mut points: Vec<&mut [DVec2]> = lines.iter_mut().map(|line| line.points.as_mut_slice()).collect();
    // What is to be said about coordinates was said when the plan was made.
    let reprojection = Reprojection::project(&mut points, &mut [], input, working)?.value;
    Ok((lines, reprojection))
}

/// The contours of the input with higher ground on their right, as most of their length says.
fn with_sides(mut lines: Vec<Contour>, results: &[TileResult], findings: &mut Vec<Finding>) -> Vec<Contour> {
    let mut right_and_left = vec![[0.0; 2]; lines.len()];
    for &(line, length) in results.iter().flat_map(|result| &result.sides) {
        if let Some(sums) = right_and_left.get_mut(line as usize) {
            sums[usize::from(length < 0.0)] += length.abs();
        }
    }
    for (line, [right, left]) in lines.iter_mut().zip(right_and_left) {
        if right > 0.0 && left > 0.0 {
            let message = format!(
                "the contour {} m: tiles disagree on which of its sides is higher; look for a wrong elevation near it, or make larger \
                 tiles",
                line.elevation
            );
            let place = line.points[line.points.len() / 2];
            findings.push(Finding::at(FindingKind::SeamSides, place, message).of_elevations([line.elevation]));
        }
        if right < left {
            line.points.reverse();
        }
    }
    lines
}

/// The new lines of a level, as pieces with the number of their tile.
struct Level {
    elevation: f64,
    index: bool,
    pieces: Vec<(usize, Piece)>,
}

/// One layer.
fn layer(
    folder: &Folder,
    levels: &Levels,
    number: usize,
    input: &[Contour],
    results: &mut [TileResult],
    joined: &mut Joined,
) -> Result<ContourLayer> {
    let (target, whole) = (&levels.targets[number], &folder.manifest.shared.whole);
    let mut layer = ContourLayer { name: target.layer_name(folder.manifest.unit()), ..ContourLayer::default() };
    let elevations = || input.iter().map(|line| line.elevation);
    let (lowest, highest) = elevations().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), z| (lo.min(z), hi.max(z)));
    let wanted = target.levels(folder.manifest.unit(), lowest, highest)?;
    let is_wanted = |z: f64| wanted.iter().any(|level| (level - z).abs() <= ROUNDING * level.abs().max(1.0));
    let is_coarser = !levels.keep_input && target.is_coarser(folder.manifest.unit(), whole.interval.step);
    for line in input.iter().filter(|line| !is_coarser || is_wanted(line.elevation)) {
        let index = target.is_index(whole.interval.step, folder.manifest.unit(), levels.index_every, line.elevation);
        layer.lines.push(new_line(line.elevation, line.points.clone(), Source::Input, index));
    }
    let mut by_level: BTreeMap<u64, Level> = BTreeMap::new();
    for (tile, result) in results.iter_mut().enumerate() {
        let Some(of_tile) = result.layers.get_mut(number) else { continue };
        layer.artefact_rings += of_tile.artefact_rings;
        layer.dead_ends += of_tile.dead_ends;
        for LinePiece { elevation, index, piece } in std::mem::take(&mut of_tile.pieces) {
            let new = || Level { elevation, index, pieces: Vec::new() };
            by_level.entry(elevation.to_bits()).or_insert_with(new).pieces.push((tile, piece));
        }
    }
    for Level { elevation, index, pieces } in by_level.into_values() {
        let Chains { lines, joined: seams, furthest, left } = chains(pieces, MOST * whole.spacing);
        joined.seams += seams;
        joined.furthest = joined.furthest.max(furthest);
        let end = |place| {
            let message = format!(
                "a new contour {elevation} m ends at the border of a tile: the tiles disagree about the ground here; look for a wrong \
                 elevation nearby, or make larger tiles"
            );
            Finding::at(FindingKind::SeamEnd, place, message).of_elevations([elevation])
        };
        joined.findings.extend(left.into_iter().map(end));
        layer.lines.extend(lines.into_iter().map(|line| new_line(elevation, line, Source::Interpolated, index)));
    }
    layer.lines.sort_by(|a, b| a.elevation.total_cmp(&b.elevation));
    Ok(layer)
}

fn new_line(elevation: f64, points: Vec<DVec2>, source: Source, index: bool) -> ContourLine {
    let mut line = ContourLine { elevation, points, source, index, kind: None, depression: false, expected: None };
    // Higher ground is on the right. So it lies outside a counter-clockwise ring.
    line.depression = line.is_closed() && signed_area(&line.points) > 0.0;
    line
}

impl Folder {
    /// Checks that there is nothing that cannot be joined: new contours or a height map that the plan does not have.
    ///
    /// # Errors
    /// [`Error::Parameter`] says what the plan does not have.
    pub fn check_wanted(&self, lines: bool, heights: bool) -> Result<()> {
        let shared = &self.manifest.shared;
        let missing = [
            (lines && shared.levels.is_none(), "new contours: name their interval when the plan is made"),
            (heights && shared.cells.is_none(), "a height map: name the size of its cells when the plan is made"),
        ];
        match missing.iter().find(|(is_missing, _)| *is_missing) {
            Some((_, what)) => Err(Error::Parameter(format!("this plan does not have {what}"))),
            None => Ok(()),
        }
    }
}
