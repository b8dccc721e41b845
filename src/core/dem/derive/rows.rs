//! Slope, aspect and hillshade that are computed when their rows are read. So they need little memory, however large the height
//! map is.

use super::slope::{aspect_of, brightness, slope_of};
use crate::base::error::{Finding, Result};
use crate::base::{Grid, parallel};
use crate::crs::Crs;
use crate::dem::shade::{Lights, ShadeParams};
use crate::raster::gradient::gradients;
use crate::raster::{GroundScale, RasterRows, uniform};

/// What is computed of each cell.
#[derive(Debug, Clone, Copy)]
pub enum Derivative<'a> {
    /// As [`slope`](super::slope()).
    Slope,
    /// As [`aspect`](super::aspect()).
    Aspect,
    /// As [`shade`](super::shade()).
    Shade(&'a ShadeParams),
}

/// A raster that follows from a height map.
#[derive(Debug)]
pub struct Derived<'a> {
    /// The heights.
    pub heights: &'a dyn RasterRows,
    /// Metres per map unit.
    pub scale: &'a GroundScale,
    /// What is computed.
    pub derivative: Derivative<'a>,
}

impl Derived<'_> {
    /// Computes rows. `held` are the heights of these rows, and those of the rows beside them, from the row `from` on.
    fn compute(
        &self,
        (from, held): (usize, &[f32]),
        first: usize,
        values: &mut [f32],
        value: impl Fn(glam::DVec2) -> f32 + Sync,
    ) {
        let Grid { cols, cell, .. } = self.heights.grid();
        let line = |row: usize| row.checked_sub(from).and_then(|k| held.get(k * cols..(k + 1) * cols));
        parallel::chunks(values, cols, |k, out| {
            let row = first + k;
            out.fill(f32::NAN);
            let lines = [row.checked_sub(1).and_then(line), line(row), line(row + 1)];
            gradients(lines, cell * self.scale.row(row), |col, gradient, _| out[col] = value(gradient));
        });
    }
}

impl RasterRows for Derived<'_> {
    fn grid(&self) -> Grid {
        self.heights.grid()
    }

    fn crs(&self) -> Option<&Crs> {
        self.heights.crs()
    }

    fn read(&self, first: usize, values: &mut [f32]) -> Result<()> {
        let Grid { cols, rows, .. } = self.grid();
        let end = rows.min(first + values.len() / cols.max(1) + 1);
        let from = first.saturating_sub(1);
        let mut held = uniform((end - from) * cols, f32::NAN)?;
        self.heights.read(from, &mut held)?;
        let held = (from, held.as_slice());
        match self.derivative {
            Derivative::Slope => self.compute(held, first, values, slope_of),
            Derivative::Aspect => self.compute(held, first, values, aspect_of),
            Derivative::Shade(params) => {
                let lights = Lights::new(params);
                self.compute(held, first, values, |gradient| brightness(lights.of_slope(gradient, params)));
            }
        }
        Ok(())
    }

    fn findings(&self) -> Vec<Finding> {
        self.heights.findings()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::{aspect, shade, slope};
    use super::*;
    use crate::raster::Dem;

    #[test]
    fn rows_are_those_of_the_whole() {
        let grid = Grid { corner: DVec2::new(138.0, 36.0), cell: DVec2::splat(1e-4), cols: 9, rows: 11 };
        let mut values: Vec<f32> = (0..99).map(|i| ((i * i) % 37) as f32).collect();
        [0, 12, 13, 40, 98].into_iter().for_each(|i| values[i] = f32::NAN);
        let dem = Dem { grid, values, crs: Some(Crs::from_epsg(6668)) };
        let scale = GroundScale::of(&dem);
        let params = ShadeParams::multidirectional(40.0);
        let derivatives = [Derivative::Slope, Derivative::Aspect, Derivative::Shade(&params)];
        let whole = [slope(&dem, &scale), aspect(&dem, &scale), shade(&dem, &params, &scale)];
        for (derivative, whole) in derivatives.into_iter().zip(whole) {
            let derived = Derived { heights: &dem, scale: &scale, derivative };
            let mut found = vec![0.0; grid.len()];
            found.chunks_mut(4 * 9).enumerate().for_each(|(k, part)| derived.read(4 * k, part).unwrap());
            let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&found), bits(&whole.values), "{derivative:?}");
        }
    }
}
