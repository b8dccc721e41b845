//! What a terrain is built from: [`Input`], a map on its working plane with the findings about it.
//!
//! An input reads a file or takes lines in memory. It names their coordinate reference system, converts elevations to
//! metres and reprojects the lines to the working plane. Spot heights, lakes and a frame can be added, each in a
//! coordinate reference system of its own.

mod base;
mod cliffs;
mod coast;
mod exclude;
#[cfg(feature = "io")]
mod files;
mod part;
mod surface_params;

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::PathBuf;

use geo::{BoundingRect, MultiPolygon};
use glam::{DVec2, DVec3};

use crate::arrays;
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::base::{ElevationUnit, FeatureId};
use crate::contour::{ContourMap, Lake, SoftSpot, StatedUnit, UnitHint, unite_levels};
use crate::creases::CreaseLine;
use crate::crs::{Crs, Reprojection};
use crate::drain::{Sink, SinkShape};
use crate::resample::{Fitted, Sampled};
use crate::streams::{RiverArea, StreamLine};
use crate::subdomains::Frame;
use crate::terrain::base::Base;
use crate::terrain::part::Part;
use crate::terrain::plane::{Plane, named, on_plane, settle};
use crate::terrain::units::Elevations;
use tokosen_core::geometry::{thinned, tolerance};

/// Vertices of a frame that are closer to each other than this share of its diagonal are left out where the border stays in
/// its place without them.
const DENSE: f64 = 1e-4;
/// How far the border may move, as a share of its tolerance. Rounding of coordinates takes most of it.
const STRAIGHT: f64 = 0.25;

/// How contours are read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InputOptions {
    /// The attribute of a file that holds the elevation, by its name.
    pub elevation_field: Option<String>,
    /// The layer of a file with several, by its name.
    pub layer: Option<String>,
    /// Unit of the elevations of contours, spot heights and lakes. Inside the program they are metres. If `None`: the unit
    /// that an attribute of the file states beside them; else that of the vertical part of the coordinate reference
    /// system, each file's own; else, for spot heights and lakes, that of the contours; else metres.
    pub unit: Option<ElevationUnit>,
    /// Unit of x and y of contours without a coordinate reference system. If `None`: that of the drawing (DXF), else metres.
    /// Files beside the contours that name no system are in the same plane.
    pub plane_unit: Option<ElevationUnit>,
    /// Whether the named attribute, or else attributes with names of depths, hold depths. They are read as negative
    /// elevations.
    pub depths: bool,
    /// The coordinate reference system of the contours, if the file names none or a wrong one.
    pub crs: Option<Crs>,
    /// The projected system in metres to work in. If `None`: the contours' own or, for degrees and feet, the one that
    /// [`working_crs`](crate::crs::working_crs) chooses.
    pub work_crs: Option<Crs>,
    /// Memory that reading may take, bytes. No limit if `None`.
    pub memory: Option<u64>,
}

/// A map on its working plane, and the findings about it.
///
/// When a step fails, the findings up to then stay here: lines that were left out may be the cause.
#[derive(Debug, Clone, Default)]
pub struct Input {
    /// Contours and spot heights, in the working coordinate reference system. Empty once a terrain was made of it.
    pub map: ContourMap,
    /// The findings, in a fixed order; places are in the working coordinate reference system.
    pub findings: Vec<Finding>,
    /// Number of findings outside of the frame polygon or the part; they are not in `findings`.
    pub findings_outside: usize,
    /// The conversion between the working plane and the coordinates of the contours.
    pub reprojection: Reprojection,
    /// Where the ground ends.
    pub frame: Frame,
    /// Lakes, on the working plane.
    pub lakes: Vec<Lake>,
    /// The levels of coasts, metres.
    pub coast: Vec<f64>,
    /// Rivers and streams, on the working plane.
    pub streams: Vec<StreamLine>,
    /// River areas, on the working plane.
    pub river_areas: Vec<RiverArea>,
    /// Break lines, on the working plane; heights in metres.
    pub creases: Vec<CreaseLine>,
    /// Cliffs, on the working plane.
    pub cliffs: Vec<Vec<DVec2>>,
    /// Places where water may stay, on the working plane.
    pub sinks: Vec<Sink>,
    /// Figures of the fit, if the lines were fitted; its map is empty.
    pub fitted: Option<Fitted>,
    /// Figures of the sampling, if the lines were sampled; its map is empty.
    pub sampled: Option<Sampled>,
    /// The files of the contours.
    pub(super) files: Vec<PathBuf>,
    /// The unit that the elevations of the contours had.
    pub(super) unit: ElevationUnit,
    /// Whether x and y are taken as metres although heights are in feet and nothing states the unit of x and y.
    pub(super) is_plane_guessed: bool,
    /// Whether the working plane is in metres, as far as is known: nothing may state the unit of x and y.
    pub(super) is_plane_in_metres: bool,
    /// The unit that the caller asks for.
    pub(super) asked_unit: Option<ElevationUnit>,
    /// Memory that reading may take, bytes.
    pub(super) memory: Option<u64>,
    /// Whether depths are read as negative elevations.
    pub(super) depths: bool,
    /// Levels that are real, whatever they look like; metres.
    pub(super) known_levels: Vec<f64>,
    /// The part of the map that is asked for.
    pub(super) part: Option<Part>,
    /// The height map that gives the heights outside the frame.
    pub(super) base: Option<Base>,
    /// The parts of the map that were left out, on the working plane. They may overlap.
    pub(super) excluded: Vec<MultiPolygon<f64>>,
    /// How far contours that end beside a cliff end because of it, map units.
    pub(super) cliff_reach: f64,
    /// The features of contours that end beside a cliff.
    pub(super) at_cliffs: BTreeSet<FeatureId>,
    pub(super) is_prepared: bool,
    pub(super) is_strict: bool,
}

/// What a file says about the unit of its heights.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Signs<'a> {
    /// What it states beside them.
    pub stated: Option<&'a StatedUnit>,
    /// What it lets suppose.
    pub hint: Option<&'a UnitHint>,
}

impl Input {
    /// Takes a map in memory. It is moved, its lines are not copied.
    ///
    /// # Errors
    /// [`LooksLikeDegrees`](crate::base::error::Error::LooksLikeDegrees) if the coordinates do and no system is named.
    /// [`NotProjectedInMetres`](crate::base::error::Error::NotProjectedInMetres) and
    /// [`UnknownCrs`](crate::base::error::Error::UnknownCrs) for a system to work in. As [`Reprojection::project`] if a
    /// coordinate has no place on the plane.
    pub fn from_map(map: ContourMap, options: &InputOptions) -> Result<Self> {
        Self::from_report(Report { value: map, findings: Vec::new() }, options)
    }

    /// Takes lines as ragged arrays: line `k` has the coordinates from `offsets[k]` to before `offsets[k + 1]` (x east,
    /// y north) and `elevations[k]`. It becomes feature `k` in findings.
    ///
    /// Coordinates are copied once, into a list for each line.
    ///
    /// # Errors
    /// [`Arrays`](crate::base::error::Error::Arrays) if the arrays do not fit each other. As [`Input::from_map`].
    pub fn from_arrays(
        coords: &[[f64; 2]],
        offsets: &[usize],
        elevations: &[f64],
        options: &InputOptions,
    ) -> Result<Self> {
        let contours = arrays::contours(coords, offsets, elevations)?;
        Self::from_map(ContourMap { contours, ..ContourMap::default() }, options)
    }

    pub(super) fn from_report(read: Report<ContourMap>, options: &InputOptions) -> Result<Self> {
        let (read, unit) = in_metres(read, options);
        Self::from_metres(read, unit, options)
    }

    /// Takes a map with its elevations in metres; they were in `unit`.
    pub(super) fn from_metres(read: Report<ContourMap>, unit: ElevationUnit, options: &InputOptions) -> Result<Self> {
        let mut findings = Vec::new();
        let mut map = read.collect(&mut findings);
        findings.extend(unite_levels(&mut map, unit));
        let Plane { map, is_guessed: is_plane_guessed } = settle(map, options.plane_unit, unit, &mut findings)?;
        let (map, reprojection) = on_plane(map, options.work_crs.as_ref(), &mut findings)?;
        let InputOptions { unit: asked_unit, memory, depths, .. } = *options;
        // A drawing in metres has no system, and states its unit all the same.
        let is_plane_in_metres = match &map.crs {
            Some(crs) => crs.length_unit().is_some_and(|unit| unit.metres == 1.0),
            None => map.plane_unit.is_some(),
        };
        Ok(Self {
            map,
            findings,
            reprojection,
            unit,
            is_plane_guessed,
            is_plane_in_metres,
            asked_unit,
            memory,
            depths,
            ..Self::default()
        })
    }

    /// Refuses a map whose heights are in feet and of which nothing states the unit of x and y. For what depends on the ratio
    /// of heights to distances, such as slopes.
    ///
    /// # Errors
    /// [`Error::PlaneUnitUnknown`].
    pub fn check_plane_unit(&self) -> Result<()> {
        if self.is_plane_guessed { Err(self.named_error(Error::PlaneUnitUnknown)) } else { Ok(()) }
    }

    /// Names a level that contours have, in metres, such as that of the sea. Without it, contours at 0 m are left out where
    /// no other level lies near them. Call it before [`Input::prepare`].
    pub fn expect_level(&mut self, level: f64) {
        self.known_levels.push(level);
    }

    /// The unit that the elevations of the contours had before they became metres.
    pub fn unit(&self) -> ElevationUnit {
        self.unit
    }

    /// The files of the contours, if they are from files. Features name them by their number, from 1.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The name of the input in messages.
    pub fn name(&self) -> Cow<'_, str> {
        match self.files.as_slice() {
            [] => "the contours".into(),
            [file] => file.display().to_string().into(),
            [first, others @ ..] => format!("{} and {} more", first.display(), others.len()).into(),
        }
    }

    /// Adds spot heights (x, y, height), which the surface then passes through. They are in the contours' coordinate
    /// reference system if `crs` is `None`. [`InputOptions::unit`] says in which unit heights are.
    ///
    /// # Errors
    /// If their system cannot be converted to the working one, or a point has no place on the working plane.
    pub fn add_spots(&mut self, spots: impl IntoIterator<Item = DVec3>, crs: Option<&Crs>) -> Result<()> {
        self.add_spots_with(spots.into_iter().map(|spot| (spot, None)), crs, Signs::default())
    }

    /// Adds spot heights with standard errors. The surface comes near them. As [`Input::add_spots`]; standard errors are
    /// in the unit of the heights. A spot height with the standard error 0 is one that the surface passes through.
    ///
    /// # Errors
    /// As [`Input::add_spots`].
    pub fn add_soft_spots(&mut self, spots: impl IntoIterator<Item = SoftSpot>, crs: Option<&Crs>) -> Result<()> {
        self.add_spots_with(spots.into_iter().map(|spot| (spot.place, Some(spot.sigma))), crs, Signs::default())
    }

    /// [`Input::add_spots`] with what their file says about the unit.
    pub(super) fn add_spots_with(
        &mut self,
        spots: impl IntoIterator<Item = (DVec3, Option<f64>)>,
        crs: Option<&Crs>,
        signs: Signs<'_>,
    ) -> Result<()> {
        let to_working = self.reprojection.bring(crs)?;
        let unit = self.unit_beside("the spot heights", crs, signs);
        let before = [self.map.spots.len(), self.map.soft_spots.len()];
        for (spot, sigma) in spots {
            let place = to_working.point(spot.truncate().extend(unit.metres(spot.z)))?;
            match sigma.filter(|sigma| *sigma > 0.0) {
                Some(sigma) => self.map.soft_spots.push(SoftSpot { place, sigma: unit.metres(sigma) }),
                None => self.map.spots.push(place),
            }
        }
        let exact = self.map.spots[before[0]..].iter().map(|spot| spot.truncate());
        let added: Vec<DVec2> =
            exact.chain(self.map.soft_spots[before[1]..].iter().map(|spot| spot.place.truncate())).collect();
        self.report_spots_elsewhere(added.into_iter());
        Ok(())
    }

    /// The unit of heights that come with the contours.
    pub(super) fn unit_beside(&mut self, what: &str, crs: Option<&Crs>, signs: Signs<'_>) -> ElevationUnit {
        // A plane in feet was told of for the contours.
        let crs = crs.filter(|crs| crs.height_unit().is_some());
        let Signs { stated, hint } = signs;
        let heights = Elevations { what, asked: self.asked_unit, otherwise: self.unit, crs, stated, hint };
        heights.unit(&mut self.findings)
    }

    /// Adds lakes: level ground at their height, otherwise at the height of their shore. They are in the contours'
    /// coordinate reference system if `crs` is `None`. [`InputOptions::unit`] says in which unit heights are.
    ///
    /// # Errors
    /// As [`Input::add_spots`].
    pub fn add_lakes(&mut self, lakes: impl IntoIterator<Item = Lake>, crs: Option<&Crs>) -> Result<()> {
        self.add_lakes_with(lakes, crs, Signs::default())
    }

    /// [`Input::add_lakes`] with what their file says about the unit.
    pub(super) fn add_lakes_with(
        &mut self,
        lakes: impl IntoIterator<Item = Lake>,
        crs: Option<&Crs>,
        signs: Signs<'_>,
    ) -> Result<()> {
        let to_working = self.reprojection.bring(crs)?;
        let mut lakes = lakes.into_iter().peekable();
        let unit = match lakes.peek() {
            Some(_) => self.unit_beside("the heights of the lakes", crs, signs),
            None => self.unit,
        };
        for lake in lakes {
            let polygon = to_working.polygon(&lake.polygon)?;
            self.lakes.push(Lake { polygon, ..lake }.in_metres(unit));
        }
        Ok(())
    }

    /// Adds lines of rivers and streams, in any direction. They are in the contours' coordinate reference system if `crs`
    /// is `None`.
    ///
    /// A line with a vertex that has no place on the working plane is left out, with a finding.
    ///
    /// # Errors
    /// If their system cannot be converted to the working one.
    pub fn add_streams(&mut self, lines: impl IntoIterator<Item = StreamLine>, crs: Option<&Crs>) -> Result<()> {
        let to_working = self.reprojection.bring(crs)?;
        for line in lines {
            let points = line.points.iter().map(|p| Ok(to_working.point(p.extend(0.0))?.truncate()));
            match points.collect::<Result<_>>() {
                Ok(points) => self.streams.push(StreamLine { points, ..line }),
                Err(error) => {
                    let message = format!("stream {} is left out: {error}", line.feature);
                    let finding = Finding::general(FindingKind::StreamOutside, message);
                    self.findings.push(finding.of_feature(line.feature));
                }
            }
        }
        Ok(())
    }

    /// Adds river areas: they are level across and fall along, as the streams through them. As [`Input::add_streams`].
    ///
    /// # Errors
    /// If their system cannot be converted to the working one.
    pub fn add_river_areas(&mut self, areas: impl IntoIterator<Item = RiverArea>, crs: Option<&Crs>) -> Result<()> {
        let to_working = self.reprojection.bring(crs)?;
        for area in areas {
            match to_working.polygon(&area.polygon) {
                Ok(polygon) => self.river_areas.push(RiverArea { polygon, ..area }),
                Err(error) => {
                    let message = format!("river area {} is left out: {error}", area.feature);
                    let finding = Finding::general(FindingKind::StreamOutside, message);
                    self.findings.push(finding.of_feature(area.feature));
                }
            }
        }
        Ok(())
    }

    /// Adds break lines. They are in the contours' coordinate reference system if `crs` is `None`.
    /// [`InputOptions::unit`] says in which unit heights are.
    ///
    /// A line with a vertex that has no place on the working plane is left out, with a finding.
    ///
    /// # Errors
    /// If their system cannot be converted to the working one.
    pub fn add_break_lines(&mut self, lines: impl IntoIterator<Item = CreaseLine>, crs: Option<&Crs>) -> Result<()> {
        let to_working = self.reprojection.bring(crs)?;
        let mut lines = lines.into_iter().peekable();
        let unit = match lines.peek() {
            Some(_) => self.unit_beside("the heights of the break lines", crs, Signs::default()),
            None => self.unit,
        };
        for line in lines {
            let CreaseLine { points, heights, feature, .. } = &line;
            let height = |k: usize| unit.metres(heights.get(k).copied().unwrap_or(0.0));
            let vertices = points.iter().enumerate().map(|(k, p)| to_working.point(p.extend(height(k))));
            match vertices.collect::<Result<Vec<DVec3>>>() {
                Ok(vertices) => self.creases.push(CreaseLine {
                    points: vertices.iter().map(|p| p.truncate()).collect(),
                    heights: vertices.iter().take(heights.len()).map(|p| p.z).collect(),
                    ..line
                }),
                Err(error) => {
                    let message = format!("break line {feature} is left out: {error}");
                    let finding = Finding::general(FindingKind::BreakLineLeftOut, message);
                    self.findings.push(finding.of_feature(*feature));
                }
            }
        }
        Ok(())
    }

    /// Adds places where water may stay: the surface keeps their pits. They are in the contours' coordinate reference system
    /// if `crs` is `None`.
    ///
    /// A sink that has no place on the working plane is left out, with a finding.
    ///
    /// # Errors
    /// If their system cannot be converted to the working one.
    pub fn add_sinks(&mut self, sinks: impl IntoIterator<Item = Sink>, crs: Option<&Crs>) -> Result<()> {
        let to_working = self.reprojection.bring(crs)?;
        for sink in sinks {
            let shape = match &sink.shape {
                SinkShape::Point(p) => to_working.point(p.extend(0.0)).map(|p| SinkShape::Point(p.truncate())),
                SinkShape::Area(area) => to_working.boundary(area).map(SinkShape::Area),
            };
            match shape {
                Ok(shape) => self.sinks.push(Sink { shape, ..sink }),
                Err(error) => {
                    let message = format!("the sink of feature {} is left out: {error}", sink.feature);
                    let finding = Finding::general(FindingKind::SinkOutside, message);
                    self.findings.push(finding.of_feature(sink.feature));
                }
            }
        }
        Ok(())
    }

    /// Ends the ground at a polygon. It is in the contours' coordinate reference system if `crs` is `None`.
    ///
    /// # Errors
    /// As [`Input::add_spots`].
    pub fn set_boundary(&mut self, area: &MultiPolygon<f64>, crs: Option<&Crs>) -> Result<()> {
        let area = self.reprojection.bring(crs)?.boundary(area)?;
        // Vertices within the tolerance of the border lie on it. So lines that end on the frame still do.
        let diagonal = area.bounding_rect().map_or(0.0, |rect| rect.width().hypot(rect.height()));
        self.frame = Frame::Polygon(thinned(&area, STRAIGHT * tolerance(&area), DENSE * diagonal));
        Ok(())
    }
}

/// A map as it was read with its elevations in metres and the system that the caller names, and the unit that its
/// elevations had.
pub(super) fn in_metres(read: Report<ContourMap>, options: &InputOptions) -> (Report<ContourMap>, ElevationUnit) {
    let mut findings = Vec::new();
    let map = read.collect(&mut findings);
    let unit = unit_of(&map, options, &mut findings);
    let value = named(map.in_metres(unit), options.crs.as_ref(), &mut findings);
    (Report { value, findings }, unit)
}

/// The unit of the elevations of a map as it was read. Elevations in the findings about it become metres.
fn unit_of(map: &ContourMap, options: &InputOptions, findings: &mut Vec<Finding>) -> ElevationUnit {
    // A system that is named in place of the file's may say nothing about heights.
    let named = options.crs.as_ref();
    let stating = [named, map.crs.as_ref()].into_iter().flatten().find(|crs| crs.height_unit().is_some());
    let plane = options.plane_unit.map(Crs::of_plane_in);
    let elevations = Elevations {
        what: "the elevations",
        asked: options.unit,
        otherwise: ElevationUnit::Metre,
        crs: stating.or(named).or(map.crs.as_ref()).or(plane.as_ref()),
        stated: map.stated_unit.as_ref(),
        hint: map.unit_hint.as_ref(),
    };
    let mut about_unit = Vec::new();
    let unit = elevations.unit(&mut about_unit);
    findings.iter_mut().flat_map(|finding| &mut finding.elevations).for_each(|z| *z = unit.metres(*z));
    findings.append(&mut about_unit);
    unit
}
