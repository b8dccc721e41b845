//! The coast: lines that become contours at the level of the sea.

use super::Input;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::contour::{CoastLine, Contour};

/// A level and contours that differ from it by no more are the same, metres.
const SAME_LEVEL: f64 = 1e-3;

impl Input {
    /// Makes contours of lines of a coast, which are on the working plane.
    pub(super) fn take_coast(&mut self, lines: Vec<CoastLine>) {
        // The number of their file comes after those of the contours.
        let file = self.files.len().max(1) as u32 + 1;
        for CoastLine { points, level, feature } in lines {
            let elevation = level.unwrap_or(0.0);
            self.map.contours.push(Contour { elevation, points, feature: feature.in_file(file) });
            self.note_coast(elevation);
        }
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
                Err(Error::Parameter(format!("no contour has the level of the coast, {level} m{nearest}")))
            }
        }
    }

    fn note_coast(&mut self, level: f64) {
        if !self.coast.contains(&level) {
            self.coast.push(level);
        }
    }
}
