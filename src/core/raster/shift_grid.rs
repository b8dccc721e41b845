//! Differences between two height systems, or heights of the geoid, on a grid of longitudes and latitudes.

use std::path::PathBuf;

use glam::DVec2;

use super::height_map::Dem;
use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::base::parallel;
use crate::crs::{Crs, Transform};

/// Places beside the border by no more than this share of a step count as on it.
const ON_BORDER: f64 = 1e-9;

/// Values at the nodes of a grid in degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct ShiftGrid {
    /// The file that it is from, for messages.
    pub file: PathBuf,
    /// Longitude and latitude of the south-west node, degrees.
    pub south_west: DVec2,
    /// Distance between nodes, degrees, both positive.
    pub step: DVec2,
    /// Number of nodes from west to east.
    pub cols: usize,
    /// Metres, row by row from the south-west; NaN where there is none.
    pub values: Vec<f32>,
    /// The EPSG codes of the height systems before and after the values are added, as far as the file names them.
    pub systems: [Option<u32>; 2],
}

/// What is done with the values of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShiftWay {
    /// They are added to heights.
    Add,
    /// They are taken off heights.
    Subtract,
}

impl ShiftGrid {
    /// The value at a longitude and a latitude, degrees: bilinear between the four nodes around, as PROJ does. Of nodes without
    /// a value, the others are averaged by their weights. `None` outside of the grid, and where no node has a value.
    pub fn at(&self, place: DVec2) -> Option<f64> {
        let rows = self.values.len() / self.cols.max(1);
        let mut x = (place.x - self.south_west.x) / self.step.x;
        let turn = 360.0 / self.step.x;
        // Longitudes may be counted from 0 to 360 degrees.
        if x < -ON_BORDER {
            x += turn;
        } else if x > (self.cols - 1) as f64 + ON_BORDER {
            x -= turn;
        }
        let at = DVec2::new(x, (place.y - self.south_west.y) / self.step.y);
        let last = DVec2::new(self.cols as f64 - 1.0, rows as f64 - 1.0);
        if !(at.cmpge(DVec2::splat(-ON_BORDER)).all() && at.cmple(last + ON_BORDER).all()) {
            return None;
        }
        let at = at.clamp(DVec2::ZERO, last);
        let first = at.floor().min(last - 1.0).max(DVec2::ZERO);
        let share = at - first;
        let (mut sum, mut weights) = (0.0, 0.0);
        for (row, up) in [(0, 1.0 - share.y), (1, share.y)] {
            for (col, right) in [(0, 1.0 - share.x), (1, share.x)] {
                let (row, col) = (first.y as usize + row, first.x as usize + col);
                let value = if row < rows && col < self.cols { self.values[row * self.cols + col] } else { f32::NAN };
                if !value.is_nan() {
                    sum += up * right * f64::from(value);
                    weights += up * right;
                }
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }

    /// Shifts the heights of a height map. Its system of coordinates then names the height system that they are in, if the file
    /// does. The findings tell how many cells outside of the grid lost their heights, and whether the system is not known.
    ///
    /// # Errors
    /// If the system of the cells is not known, and if no cell with a height lies on the grid.
    pub fn shift(&self, dem: &mut Dem, way: ShiftWay) -> Result<Vec<Finding>> {
        let unknown = || {
            let message = "the height map names no coordinate reference system, so nobody knows where it lies on the grid of \
                           shifts";
            Error::Data(message.into())
        };
        let degrees = dem.crs.as_ref().and_then(Crs::geographic).ok_or_else(unknown)?;
        let horizontal = dem.crs.as_ref().map(Crs::horizontal);
        let to_degrees = Transform::between_known(horizontal.as_ref(), Some(&degrees))?;
        let (grid, sign) = (dem.grid, if way == ShiftWay::Add { 1.0 } else { -1.0 });
        let before = dem.values.iter().filter(|height| !height.is_nan()).count();
        parallel::update(&mut dem.values, |cell, height| {
            if !height.is_nan() {
                let place = grid.center(cell % grid.cols, cell / grid.cols);
                let place = to_degrees.as_ref().map_or(Some(place), |way| way.forward(place));
                let shift = place.and_then(|place| self.at(place)).unwrap_or(f64::NAN);
                *height = (f64::from(*height) + sign * shift) as f32;
            }
        });
        let after = dem.values.iter().filter(|height| !height.is_nan()).count();
        if after == 0 && before > 0 {
            return Err(Error::file(&self.file, "the grid of shifts does not cover the height map"));
        }
        let [from, to] = self.systems;
        dem.crs = horizontal.map(|crs| crs.with_vertical(if way == ShiftWay::Add { to } else { from }));
        let (lost, file) = (before - after, self.file.display());
        let mut findings = Vec::new();
        if lost > 0 {
            let message = format!("{lost} cells lie outside of the grid {file}; they have no height");
            findings.push(Finding::general(FindingKind::NoHeight, message));
        }
        if dem.crs.as_ref().and_then(Crs::height_system).is_none() {
            let message = format!(
                "{file} does not name the height system that heights are in after the shift, so no output names it"
            );
            findings.push(Finding::general(FindingKind::UnknownHeights, message));
        }
        Ok(findings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;

    /// Values of 3 by 3 nodes at steps of half a degree and one degree.
    fn grid() -> ShiftGrid {
        let values = vec![0.0, 1.0, 2.0, 10.0, 11.0, 12.0, 20.0, 21.0, f32::NAN];
        ShiftGrid {
            file: "a.gtx".into(),
            south_west: DVec2::new(138.0, 35.0),
            step: DVec2::new(0.5, 1.0),
            cols: 3,
            values,
            systems: [Some(5728), Some(5729)],
        }
    }

    #[test]
    fn values_between_nodes_are_bilinear() {
        let at = |x: f64, y: f64| grid().at(DVec2::new(x, y));
        assert_eq!(at(138.0, 35.0), Some(0.0));
        assert_eq!(at(138.125, 35.5), Some(5.25));
        assert_eq!(at(139.0, 36.0), Some(12.0), "on the eastern border");
        assert_eq!(at(138.0, 37.0), Some(20.0), "on the northern border");
        assert_eq!(at(138.75, 36.5), Some((11.0 + 12.0 + 21.0) / 3.0), "a node without a value has no weight");
        assert_eq!((at(139.0, 37.0), at(137.99, 36.0), at(138.5, 37.01), at(f64::NAN, 36.0)), (None, None, None, None));
        let west = ShiftGrid { south_west: DVec2::new(-222.0, 35.0), ..grid() };
        assert_eq!(west.at(DVec2::new(138.125, 35.5)), Some(5.25), "longitudes of the other turn");
    }

    #[test]
    fn heights_are_shifted_both_ways() {
        let cells = Grid { corner: DVec2::new(137.75, 36.5), cell: DVec2::new(0.5, 1.0), cols: 3, rows: 2 };
        let dem = Dem { grid: cells, values: vec![100.0; 6], crs: Crs::from_name("EPSG:6668+5728") };
        let mut shifted = dem.clone();
        assert_eq!(grid().shift(&mut shifted, ShiftWay::Add).unwrap(), []);
        assert_eq!(shifted.values, [110.0, 111.0, 112.0, 100.0, 101.0, 102.0]);
        assert_eq!(shifted.crs, Crs::from_name("EPSG:6668+5729"));
        grid().shift(&mut shifted, ShiftWay::Subtract).unwrap();
        assert_eq!(shifted, dem);
        let nameless = ShiftGrid { systems: [None; 2], ..grid() };
        let found = nameless.shift(&mut shifted, ShiftWay::Add).unwrap();
        assert_eq!((found.len(), found[0].kind), (1, FindingKind::UnknownHeights));
        assert_eq!(shifted.crs, Some(Crs::from_epsg(6668)), "not the system that the heights were in before");
        let mut nowhere = Dem { crs: None, ..dem.clone() };
        assert!(grid().shift(&mut nowhere, ShiftWay::Add).is_err());
        let mut elsewhere = Dem { grid: Grid { corner: DVec2::ZERO, ..cells }, ..dem };
        assert!(grid().shift(&mut elsewhere, ShiftWay::Add).is_err_and(|error| error.to_string().contains("a.gtx")));
    }
}
