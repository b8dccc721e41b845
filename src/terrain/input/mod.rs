//! What a terrain is built from: [`Input`], a map on its working plane with the findings about it.
//!
//! An input reads a file or takes lines in memory. It names their coordinate reference system, converts elevations to
//! metres and reprojects the lines to the working plane. Spot heights, lakes and a frame can be added, each in a
//! coordinate reference system of its own.

mod base;
mod border;
mod cliffs;
mod coast;
mod exclude;
mod features;
#[cfg(feature = "io")]
mod files;
mod part;
mod sides;
mod surface_params;

#[cfg(feature = "io")]
pub(super) use {cliffs::explain_by_cliffs, exclude::drop_expected, surface_params::surface_params};

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::PathBuf;

use geo::{BoundingRect, MultiPolygon};
use glam::{DVec2, DVec3};

use crate::terrain::base::Base;
use crate::terrain::plane::{Plane, named, on_plane, settle};
use crate::terrain::units::Elevations;
use tokosen_core::arrays;
use tokosen_core::base::error::{Error, Finding, Report, Result};
use tokosen_core::base::{ElevationUnit, FeatureId};
use tokosen_core::contour::{ContourMap, SoftSpot, StatedUnit, UnitHint, distinct_levels, unite_levels};
use tokosen_core::crs::{Crs, Reprojection};
use tokosen_core::features::Features;
use tokosen_core::geometry::{thinned, tolerance};
use tokosen_core::resample::{Fitted, Sampled};
use tokosen_core::subdomains::Frame;

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
    /// [`working_crs`](tokosen_core::crs::working_crs) chooses.
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
    /// What there is besides contours and spot heights, on the working plane; heights in metres. Lines of coasts have become
    /// contours.
    pub features: Features,
    /// The levels of coasts, metres.
    pub coast: Vec<f64>,
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
    pub(super) part: Option<MultiPolygon<f64>>,
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
    /// [`LooksLikeDegrees`](tokosen_core::base::error::Error::LooksLikeDegrees) if the coordinates do and no system is named.
    /// [`NotProjectedInMetres`](tokosen_core::base::error::Error::NotProjectedInMetres) and
    /// [`UnknownCrs`](tokosen_core::base::error::Error::UnknownCrs) for a system to work in. As [`Reprojection::project`] if a
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
    /// [`Arrays`](tokosen_core::base::error::Error::Arrays) if the arrays do not fit each other. As [`Input::from_map`].
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
        let InMetres { read, unit, heights } = in_metres(read, options);
        Self::from_metres(read, (unit, heights), options)
    }

    /// Takes a map with its elevations in metres; they were in a unit, and were these heights there.
    pub(super) fn from_metres(
        read: Report<ContourMap>,
        (unit, heights): (ElevationUnit, Vec<f64>),
        options: &InputOptions,
    ) -> Result<Self> {
        let mut findings = Vec::new();
        let mut map = read.collect(&mut findings);
        let named = map.height_system.take();
        map.height_system = named.or_else(|| map.crs.as_ref().and_then(Crs::height_system));
        findings.extend(unite_levels(&mut map, unit));
        let Plane { map, is_guessed: is_plane_guessed } = settle(map, options.plane_unit, unit, &mut findings)?;
        let (map, reprojection) = on_plane(map, options.work_crs.as_ref(), &mut findings)?;
        let reprojection = reprojection.with_heights(unit, heights);
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
        self.report_elsewhere("spot heights", added.into_iter());
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

    /// Ends the ground at a polygon. It is in the contours' coordinate reference system if `crs` is `None`.
    ///
    /// # Errors
    /// As [`Input::add_spots`].
    pub fn set_boundary(&mut self, area: &MultiPolygon<f64>, crs: Option<&Crs>) -> Result<()> {
        let area = self.border_through_ends(area, crs)?;
        // Vertices within the tolerance of the border lie on it. So lines that end on the frame still do.
        let diagonal = area.bounding_rect().map_or(0.0, |rect| rect.width().hypot(rect.height()));
        self.frame = Frame::Polygon(thinned(&area, STRAIGHT * tolerance(&area), DENSE * diagonal));
        Ok(())
    }
}

/// A map as it was read with its elevations in metres and the system that the caller names.
pub(super) struct InMetres {
    /// The map.
    pub read: Report<ContourMap>,
    /// The unit that its elevations had.
    pub unit: ElevationUnit,
    /// Its heights in this unit, if it is not the metre.
    pub heights: Vec<f64>,
}

/// Converts the elevations of a map as it was read to metres.
pub(super) fn in_metres(read: Report<ContourMap>, options: &InputOptions) -> InMetres {
    let mut findings = Vec::new();
    let map = read.collect(&mut findings);
    let unit = unit_of(&map, options, &mut findings);
    let mut heights = Vec::new();
    if unit.is_foot() {
        heights = distinct_levels(&map.contours);
        heights.extend(map.spots.iter().map(|spot| spot.z));
    }
    let value = named(map.in_metres(unit), options.crs.as_ref(), &mut findings);
    InMetres { read: Report { value, findings }, unit, heights }
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
