//! The coast: lines that become contours at the level of the sea.

use glam::DVec2;

use super::Input;
use crate::base::ElevationUnit;
use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::contour::{CoastLine, Contour};
use crate::crs::Crs;

/// A level and contours that differ from it by no more are the same, metres.
const SAME_LEVEL: f64 = 1e-3;

impl Input {
    /// Adds lines of a coast, which become contours at their level. The ground on one side is level sea, on the other land;
    /// the contours show which. The lines are in the contours' coordinate reference system if `crs` is `None`. Call it
    /// before [`Input::prepare`] and [`Input::set_part`].
    ///
    /// A line with a vertex that has no place on the working plane is left out, with a finding.
    ///
    /// # Errors
    /// If their system cannot be converted to the working one.
    pub fn add_coast(&mut self, lines: impl IntoIterator<Item = CoastLine>, crs: Option<&Crs>) -> Result<()> {
        self.add_coast_in(self.unit, lines, crs)
    }

    /// [`Input::add_coast`] with levels in a unit.
    pub(super) fn add_coast_in(
        &mut self,
        unit: ElevationUnit,
        lines: impl IntoIterator<Item = CoastLine>,
        crs: Option<&Crs>,
    ) -> Result<()> {
        let to_working = self.reprojection.bring(crs)?;
        // The number of their file comes after those of the contours.
        let file = self.files.len().max(1) as u32 + 1;
        for line in lines {
            let elevation = unit.metres(line.level.unwrap_or(0.0));
            let feature = line.feature.in_file(file);
            let points = line.points.iter().map(|p| Ok(to_working.point(p.extend(0.0))?.truncate()));
            match points.collect::<Result<Vec<DVec2>>>() {
                Ok(points) => {
                    self.map.contours.push(Contour { elevation, points, feature });
                    self.note_coast(elevation);
                }
                Err(error) => {
                    let message = format!("the coast of feature {feature} is left out: {error}");
                    self.findings.push(Finding::general(FindingKind::CoastOutside, message).of_feature(feature));
                }
            }
        }
        Ok(())
    }

    /// Takes the contours of a level as the coast; the level is in the unit of the contours.
    ///
    /// # Errors
    /// [`Error::Parameter`] if no contour has that level.
    pub fn set_coast_level(&mut self, level: f64) -> Result<()> {
        let wanted = self.unit.metres(level);
        let levels = self.map.contours.iter().map(|contour| contour.elevation);
        let nearest = levels.min_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs()));
        match nearest.filter(|level| (level - wanted).abs() <= SAME_LEVEL) {
            Some(level) => {
                self.note_coast(level);
                Ok(())
            }
            None => {
                let nearest = nearest.map_or(String::new(), |level| format!("; the nearest level is {level} m"));
                Err(Error::Parameter(format!("no contour has the level of the coast, {level}{nearest}")))
            }
        }
    }

    fn note_coast(&mut self, level: f64) {
        if !self.coast.contains(&level) {
            self.coast.push(level);
        }
    }
}
