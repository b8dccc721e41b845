//! The part of the map that results cover.

use geo::{Area, MultiPolygon};
use glam::DVec2;

use super::Input;
use crate::terrain::part::{box_area, check_on_map};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

impl Input {
    /// Limits results to an area of the map: lines end at its border, height maps cover it. The contours around it still
    /// count, unlike with [`Input::set_boundary`]. The area is in the contours' coordinate reference system if `crs` is
    /// `None`.
    ///
    /// # Errors
    /// As [`Input::add_spots`]. [`Error::PartOutside`] if the area lies outside of the map.
    pub fn set_part(&mut self, area: &MultiPolygon<f64>, crs: Option<&Crs>) -> Result<()> {
        let area = self.border_through_ends(area, crs)?;
        if area.unsigned_area() == 0.0 {
            let message =
                "the part of the map has no area: coordinates are rounded to micrometres; choose a larger part";
            return Err(Error::Parameter(message.into()));
        }
        check_on_map(&area, &self.map).map_err(|error| self.in_input_coordinates(error))?;
        self.part = Some(area);
        Ok(())
    }

    /// The error with its places in the coordinates of the contours.
    fn in_input_coordinates(&self, error: Error) -> Error {
        let there = |corners: [DVec2; 2]| corners.map(|corner| self.reprojection.in_input(corner).unwrap_or(corner));
        match error {
            Error::PartOutside { part, map, of } => Error::PartOutside { part: there(part), map: there(map), of },
            error => error,
        }
    }

    /// [`Input::set_part`] for an upright box: least x, least y, greatest x, greatest y.
    ///
    /// # Errors
    /// As [`Input::set_part`], and [`Error::Parameter`] if the box has no width or no height.
    pub fn set_extent(&mut self, extent: [f64; 4], crs: Option<&Crs>) -> Result<()> {
        self.set_part(&box_area(extent)?, crs)
    }
}
