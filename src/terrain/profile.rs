//! Heights of one or several sides along lines and along sections across them.

use std::collections::BTreeSet;
use std::path::Path;

use glam::DVec2;

use super::compare::Side;
use super::sample::Sample;
#[cfg(feature = "io")]
use tokosen_core::base::error::Report;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::{Crs, converted};
use tokosen_core::dem::profile::{sections, stations};
use tokosen_core::raster::GroundScale;
#[cfg(feature = "io")]
use tokosen_io::{Paths, ReadOptions, VectorSource, read_paths};

/// Places along a line if nothing else is said: a step is this share of the longest line.
const STEP_SHARE: f64 = 1.0 / 500.0;

/// Where heights are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProfileParams {
    /// Greatest distance between places, metres. If `None`, a 500th of the longest line.
    pub step: Option<f64>,
    /// Distance between sections across the line, and their width, metres. If `None`, heights are those along the line.
    pub sections: Option<[f64; 2]>,
}

/// A place of a profile with the height of each side.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfilePoint {
    /// Distance along the line from its start, or along a section from its middle; metres.
    pub distance: f64,
    /// The place, in the coordinates of the line.
    pub place: DVec2,
    /// What each side has there.
    pub samples: Vec<Sample>,
}

/// A line or a section.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileRun {
    /// Number of the line's feature.
    pub feature: u64,
    /// Distance of a section from the start of the line, metres. `None` along the line itself.
    pub section: Option<f64>,
    /// Its places.
    pub points: Vec<ProfilePoint>,
}

/// Heights along lines.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    /// The lines and sections, in the order of the file.
    pub runs: Vec<ProfileRun>,
}

impl Profile {
    /// Number of places, and how many of them have a height on every side.
    pub fn counts(&self) -> [usize; 2] {
        let points = || self.runs.iter().flat_map(|run| &run.points);
        let is_known = |point: &&ProfilePoint| point.samples.iter().all(|sample| sample.height.is_finite());
        [points().count(), points().filter(is_known).count()]
    }

    /// The features of runs along which no side has a height, each once.
    pub fn without_heights(&self) -> BTreeSet<u64> {
        let has_height = |point: &ProfilePoint| point.samples.iter().any(|sample| sample.height.is_finite());
        self.runs.iter().filter(|run| !run.points.iter().any(has_height)).map(|run| run.feature).collect()
    }
}

/// Heights of sides along lines, which are in the system `crs`; in that of the first side's file if it is `None`. Distances are
/// measured on the plane of the first side. `path` is the file of the lines, for errors.
///
/// # Errors
/// As [`stations`](fn@stations) and [`sections`](fn@sections). If a line has no place on the plane of a side, or a side has no height on any line.
pub fn profile(
    sides: &[&Side],
    lines: &[(Vec<DVec2>, u64)],
    crs: Option<&Crs>,
    params: &ProfileParams,
    path: &Path,
) -> Result<Profile> {
    let first = *sides.first().ok_or_else(|| Error::Parameter("a profile needs a height map or contours".into()))?;
    let transform = first.transform_from(crs, path)?;
    let on_plane = |p: DVec2, feature: u64| {
        let there = converted(transform.as_ref(), p);
        let message = || {
            format!("{} {} of feature {feature} has no place in the coordinates of {}", p.x, p.y, first.source.title())
        };
        there.ok_or_else(|| Error::file(path, message()))
    };
    let mut placed: Vec<(Vec<DVec2>, u64)> = Vec::new();
    for (line, feature) in lines {
        placed.push((line.iter().map(|p| on_plane(*p, *feature)).collect::<Result<_>>()?, *feature));
    }
    let scale = scale_at(first, placed.iter().flat_map(|(line, _)| line));
    let length = |(line, _): &(Vec<DVec2>, u64)| -> f64 {
        line.windows(2).map(|ends| ((ends[1] - ends[0]) * scale).length()).sum()
    };
    let longest = placed.iter().map(length).fold(0.0, f64::max);
    let mut runs = Vec::new();
    for (line, feature) in &placed {
        match params.sections {
            Some([every, width]) => {
                let step = params.step.unwrap_or(width / 100.0);
                for section in sections(line, [every, width, step], scale)? {
                    runs.push((*feature, Some(section.at), section.stations));
                }
            }
            None => runs.push((*feature, None, stations(line, params.step.unwrap_or(longest * STEP_SHARE), scale)?)),
        }
    }
    // All places at once: a height map is read row by row.
    let back = |p: DVec2| transform.as_ref().map_or(Some(p), |transform| transform.inverse(p)).unwrap_or(DVec2::NAN);
    let places: Vec<DVec2> =
        runs.iter().flat_map(|(_, _, stations)| stations).map(|station| back(station.place)).collect();
    let samples: Vec<Vec<Sample>> = sides.iter().map(|side| side.sample(&places, crs, path)).collect::<Result<_>>()?;
    let mut next = 0..places.len();
    let found: Vec<ProfileRun> = runs
        .into_iter()
        .map(|(feature, section, stations)| {
            let point = |(k, distance): (usize, f64)| ProfilePoint {
                distance,
                place: places[k],
                samples: samples.iter().map(|of_side| of_side[k]).collect(),
            };
            let points = stations.into_iter().filter_map(|station| Some((next.next()?, station.distance))).map(point);
            ProfileRun { feature, section, points: points.collect() }
        })
        .collect();
    for (k, side) in sides.iter().enumerate() {
        let mut heights = found.iter().flat_map(|run| &run.points).map(|point| point.samples[k].height);
        if !heights.any(f64::is_finite) {
            let message = "no line lies where there are heights: do the files overlap, and do they name the right coordinate \
                           reference systems?";
            return Err(Error::file(&side.source.file, message));
        }
    }
    Ok(Profile { runs: found })
}

/// Metres in a unit of the plane of a side, east and north, at the middle of some places.
fn scale_at<'a>(side: &Side, places: impl Iterator<Item = &'a DVec2>) -> DVec2 {
    let (sum, count) = places.fold((DVec2::ZERO, 0.0), |(sum, count), p| (sum + *p, count + 1.0));
    let middle = sum / f64::max(count, 1.0);
    // A cell about the middle.
    let cell = tokosen_core::base::Grid {
        corner: middle + DVec2::new(-0.5, 0.5) * 1e-6,
        cell: DVec2::splat(1e-6),
        cols: 1,
        rows: 1,
    };
    GroundScale::on(&cell, side.crs()).row(0)
}

/// Reads the lines of a file and gives the heights of sides along them. `memory` is the memory that reading may take, bytes; no
/// limit if `None`.
///
/// # Errors
/// As [`read_paths`] and [`profile`].
#[cfg(feature = "io")]
pub fn read_profile(
    sides: &[&Side],
    source: &VectorSource,
    params: &ProfileParams,
    memory: Option<u64>,
) -> Result<Report<Profile>> {
    let path = &source.path;
    let read = read_paths(path, &ReadOptions { memory, ..source.reading() })?;
    let Paths { lines, crs } = read.value;
    Ok(Report { value: profile(sides, &lines, crs.as_ref(), params, path)?, findings: read.findings })
}
