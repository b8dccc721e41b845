//! Lines, polygons and points beside the contours, brought to the working plane.

use geo::{CoordsIter, Polygon};
use glam::{DVec2, DVec3};

use super::{Input, Signs};
use tokosen_core::base::error::{Finding, Result};
use tokosen_core::base::{ElevationUnit, FeatureId};
use tokosen_core::break_lines::BreakLine;
use tokosen_core::contour::{CliffLine, CoastLine, Lake};
use tokosen_core::crs::{Crs, ToWorking};
use tokosen_core::drain::{Sink, SinkShape};
use tokosen_core::features::{Features, Role};
use tokosen_core::streams::{RiverArea, StreamLine};

impl Input {
    /// Adds lines, polygons and points beside the contours, each in its role. They are in the contours' coordinate reference
    /// system if `crs` is `None`. [`InputOptions::unit`](super::InputOptions::unit) says in which unit heights are.
    ///
    /// * Coasts become contours at their level. The ground on one side is level sea, on the other land; the contours show
    ///   which.
    /// * Contours and spot heights inside excluded polygons are left out, and the surface bridges them. Contours are cut at
    ///   the borders and keep all other vertices; their new ends are no gaps. What each polygon took away is a finding.
    /// * Ends of contours beside cliffs are no gaps.
    ///
    /// Call it before [`Input::prepare`] and [`Input::set_part`]. A feature with a vertex that has no place on the working
    /// plane is left out, with a finding; a lake or an excluded polygon is an error.
    ///
    /// # Errors
    /// If their system cannot be converted to the working one. If a lake or an excluded polygon has no place on the working
    /// plane.
    pub fn add(&mut self, features: Features, crs: Option<&Crs>) -> Result<()> {
        self.add_from("memory", features, crs, Signs::default())
    }

    /// [`Input::add`] for the features of a file, with what the file says about the unit. `file` names it in findings.
    pub(super) fn add_from(
        &mut self,
        file: &str,
        features: Features,
        crs: Option<&Crs>,
        signs: Signs<'_>,
    ) -> Result<()> {
        let Features { coast, excluded, cliffs, lakes, streams, river_areas, break_lines, sinks } = features;
        // The lines of a coast become contours of the output.
        if !coast.is_empty() {
            self.reprojection.keep(coast.iter().flat_map(|line| line.points.iter().copied()), crs)?;
        }
        let coast = self.bring(coast, crs, signs)?;
        self.take_coast(coast);
        if !excluded.is_empty() {
            self.exclude(&excluded, crs, file)?;
        }
        let cliffs = self.bring(cliffs, crs, signs)?;
        self.take_cliffs(cliffs);
        let lakes = self.bring(lakes, crs, signs)?;
        self.features.lakes.extend(lakes);
        let streams = self.bring(streams, crs, signs)?;
        self.features.streams.extend(streams);
        let river_areas = self.bring(river_areas, crs, signs)?;
        self.features.river_areas.extend(river_areas);
        let break_lines = self.bring(break_lines, crs, signs)?;
        self.features.break_lines.extend(break_lines);
        let sinks = self.bring(sinks, crs, signs)?;
        self.features.sinks.extend(sinks);
        Ok(())
    }

    /// Features on the working plane, with heights in metres. Those without a place there are findings, or an error if they
    /// must not be missing.
    fn bring<T: Bring>(&mut self, features: Vec<T>, crs: Option<&Crs>, signs: Signs<'_>) -> Result<Vec<T>> {
        if features.is_empty() {
            return Ok(features);
        }
        let to_working = self.reprojection.bring(crs)?;
        let (one, many) = T::WORDS;
        let unit = match features.iter().any(T::has_heights) {
            true => self.unit_beside(&format!("the heights of the {many}"), crs, signs),
            false => self.unit(),
        };
        let mut brought = Vec::with_capacity(features.len());
        for feature in features {
            let number = feature.number();
            match feature.brought(&to_working, unit) {
                Ok(feature) => brought.push(feature),
                Err(error) if T::IS_NEEDED => return Err(error),
                Err(error) => {
                    let finding = Finding::general(T::ROLE.outside(), format!("{one} {number} is left out: {error}"));
                    self.findings.push(finding.of_feature(number));
                }
            }
        }
        self.report_elsewhere(many, brought.iter().flat_map(T::places));
        Ok(brought)
    }
}

/// A feature beside the contours.
trait Bring: Sized {
    const ROLE: Role;
    /// One feature, and several, for messages.
    const WORDS: (&'static str, &'static str) = (Self::ROLE.one(), Self::ROLE.many());
    /// Whether the map would be wrong without it.
    const IS_NEEDED: bool = false;

    /// Its number in the file.
    fn number(&self) -> FeatureId;

    /// Whether it has heights of its own.
    fn has_heights(&self) -> bool {
        false
    }

    /// Places on it that show where it lies.
    fn places(&self) -> Vec<DVec2>;

    /// The same on the working plane, with its heights, which are in `unit`, in metres.
    fn brought(self, to_working: &ToWorking, unit: ElevationUnit) -> Result<Self>;
}

fn corners(polygon: &Polygon<f64>) -> impl Iterator<Item = DVec2> {
    polygon.exterior_coords_iter().map(|c| DVec2::new(c.x, c.y))
}

fn course(points: &[DVec2], to_working: &ToWorking) -> Result<Vec<DVec2>> {
    points.iter().map(|p| Ok(to_working.point(p.extend(0.0))?.truncate())).collect()
}

impl Bring for CoastLine {
    const ROLE: Role = Role::Coast;

    fn number(&self) -> FeatureId {
        self.feature
    }

    fn has_heights(&self) -> bool {
        self.level.is_some()
    }

    fn places(&self) -> Vec<DVec2> {
        self.points.clone()
    }

    fn brought(self, to_working: &ToWorking, unit: ElevationUnit) -> Result<Self> {
        let level = self.level.map(|level| unit.metres(level));
        Ok(Self { points: course(&self.points, to_working)?, level, ..self })
    }
}

impl Bring for CliffLine {
    const ROLE: Role = Role::Cliffs;

    fn number(&self) -> FeatureId {
        self.feature
    }

    fn places(&self) -> Vec<DVec2> {
        self.points.clone()
    }

    fn brought(self, to_working: &ToWorking, _: ElevationUnit) -> Result<Self> {
        Ok(Self { points: course(&self.points, to_working)?, ..self })
    }
}

impl Bring for Lake {
    const ROLE: Role = Role::Water;
    const IS_NEEDED: bool = true;

    fn number(&self) -> FeatureId {
        self.feature
    }

    fn has_heights(&self) -> bool {
        self.height.is_some()
    }

    fn places(&self) -> Vec<DVec2> {
        corners(&self.polygon).collect()
    }

    fn brought(self, to_working: &ToWorking, unit: ElevationUnit) -> Result<Self> {
        Ok(Self { polygon: to_working.polygon(&self.polygon)?, ..self }.in_metres(unit))
    }
}

impl Bring for StreamLine {
    const ROLE: Role = Role::Streams;

    fn number(&self) -> FeatureId {
        self.feature
    }

    fn places(&self) -> Vec<DVec2> {
        self.points.clone()
    }

    fn brought(self, to_working: &ToWorking, _: ElevationUnit) -> Result<Self> {
        Ok(Self { points: course(&self.points, to_working)?, ..self })
    }
}

impl Bring for RiverArea {
    const ROLE: Role = Role::Streams;
    const WORDS: (&'static str, &'static str) = ("river area", "river areas");

    fn number(&self) -> FeatureId {
        self.feature
    }

    fn places(&self) -> Vec<DVec2> {
        corners(&self.polygon).collect()
    }

    fn brought(self, to_working: &ToWorking, _: ElevationUnit) -> Result<Self> {
        Ok(Self { polygon: to_working.polygon(&self.polygon)?, ..self })
    }
}

impl Bring for BreakLine {
    const ROLE: Role = Role::BreakLines;

    fn number(&self) -> FeatureId {
        self.feature
    }

    fn has_heights(&self) -> bool {
        !self.heights.is_empty()
    }

    fn places(&self) -> Vec<DVec2> {
        self.points.clone()
    }

    fn brought(self, to_working: &ToWorking, unit: ElevationUnit) -> Result<Self> {
        let height = |k: usize| unit.metres(self.heights.get(k).copied().unwrap_or(0.0));
        let vertices = self.points.iter().enumerate().map(|(k, p)| to_working.point(p.extend(height(k))));
        let vertices = vertices.collect::<Result<Vec<DVec3>>>()?;
        let heights = vertices.iter().take(self.heights.len()).map(|p| p.z).collect();
        Ok(Self { points: vertices.iter().map(|p| p.truncate()).collect(), heights, ..self })
    }
}

impl Bring for Sink {
    const ROLE: Role = Role::Sinks;

    fn number(&self) -> FeatureId {
        self.feature
    }

    fn places(&self) -> Vec<DVec2> {
        match &self.shape {
            SinkShape::Point(p) => vec![*p],
            SinkShape::Area(area) => area.iter().flat_map(corners).collect(),
        }
    }

    fn brought(self, to_working: &ToWorking, _: ElevationUnit) -> Result<Self> {
        let shape = match &self.shape {
            SinkShape::Point(p) => SinkShape::Point(to_working.point(p.extend(0.0))?.truncate()),
            SinkShape::Area(area) => SinkShape::Area(to_working.boundary(area)?),
        };
        Ok(Self { shape, ..self })
    }
}
