//! Hillshade: how bright each cell of a height map is under one or more distant lights.
//!
//! The gradient is that of Horn (1981), as in GDAL: eight neighbours, the four nearest with double weight. Where a
//! neighbour is missing, at the border or beside nodata, heights are extrapolated linearly (at the border as in GDAL).
//! So every cell with a height has a brightness.

use glam::{DVec2, DVec3};

use crate::base::parallel;
use crate::raster::Dem;
use crate::raster::GroundScale;
use crate::raster::gradient::gradients;

/// A distant light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Its azimuth, degrees clockwise from north.
    pub azimuth: f64,
    /// Its altitude above the horizon, degrees.
    pub altitude: f64,
    /// Its share of the brightness, relative to the sum of all shares.
    pub weight: f64,
}

impl Light {
    /// Unit vector towards the light: east, north, up.
    fn direction(&self) -> DVec3 {
        let (azimuth, altitude) = (self.azimuth.to_radians(), self.altitude.to_radians());
        DVec3::new(azimuth.sin() * altitude.cos(), azimuth.cos() * altitude.cos(), altitude.sin())
    }
}

/// How several lights share in the brightness of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shares {
    /// Everywhere the same, by their weights.
    #[default]
    Same,
    /// By their weights times the square of the sine of the angle between their azimuth and the aspect of the slope. So
    /// a slope is mostly lit from the side, which shows its shape. On level ground as [`Shares::Same`].
    FromTheSide,
}

/// Parameters of the hillshade.
#[derive(Debug, Clone, PartialEq)]
pub struct ShadeParams {
    /// The lights. Without lights everything is dark.
    pub lights: Vec<Light>,
    /// How they share in the brightness.
    pub shares: Shares,
    /// Factor on the heights (vertical exaggeration).
    pub exaggeration: f64,
    /// Metres per map unit in x and y, for maps in feet or degrees.
    pub metres_per_unit: DVec2,
}

impl Default for ShadeParams {
    /// One light from the north-west, 45 degrees above the horizon.
    fn default() -> Self {
        let light = Light { azimuth: 315.0, altitude: 45.0, weight: 1.0 };
        Self { lights: vec![light], shares: Shares::Same, exaggeration: 1.0, metres_per_unit: DVec2::ONE }
    }
}

impl ShadeParams {
    /// A main light from the north-west and two weak ones beside it. They show the shape of slopes that the main light
    /// only grazes.
    pub fn soft() -> Self {
        let light = |azimuth, weight| Light { azimuth, altitude: 45.0, weight };
        Self { lights: vec![light(315.0, 0.6), light(255.0, 0.2), light(15.0, 0.2)], ..Self::default() }
    }

    /// Lights from the south-west, the west, the north-west and the north, which light slopes from the side. The method
    /// is that of Mark (1992, USGS Open-File Report 92-422), as in GDAL. `altitude` is that of the lights, degrees.
    pub fn multidirectional(altitude: f64) -> Self {
        let lights = [225.0, 270.0, 315.0, 360.0].map(|azimuth| Light { azimuth, altitude, weight: 1.0 });
        Self { lights: lights.to_vec(), shares: Shares::FromTheSide, ..Self::default() }
    }

    /// The brightness of level ground.
    pub fn level(&self) -> f64 {
        self.sum().z.max(0.0)
    }

    /// Mean direction of the lights, weighted by their shares.
    fn sum(&self) -> DVec3 {
        let total: f64 = self.lights.iter().map(|l| l.weight).sum();
        if total > 0.0 {
            self.lights.iter().map(|l| l.direction() * l.weight).sum::<DVec3>() / total
        } else {
            DVec3::ZERO
        }
    }
}

/// The brightness of every cell, 0 (facing away from all lights) to 1 (facing them), row by row. NaN without a height.
///
/// GDAL's 8-bit hillshade is 1 + 254 times this value for a single light.
pub fn hillshade(dem: &Dem, params: &ShadeParams) -> Vec<f32> {
    hillshade_on(dem, params, &GroundScale::Uniform(params.metres_per_unit))
}

/// [`hillshade`] with the metres per map unit from `scale` and not from `params`.
pub fn hillshade_on(dem: &Dem, params: &ShadeParams, scale: &GroundScale) -> Vec<f32> {
    let lights = Lights::new(params);
    map_gradients(dem, |row| scale.row(row), |gradient| lights.of_slope(gradient, params))
}

/// The directions towards the lights, and their shares of the brightness.
pub struct Lights {
    lights: Vec<(DVec3, f64)>,
    shares: Shares,
}

impl Lights {
    /// The lights of these parameters.
    pub fn new(params: &ShadeParams) -> Self {
        let total: f64 = params.lights.iter().map(|l| l.weight).sum();
        let lights = params.lights.iter().map(|l| (l.direction(), l.weight / total)).collect();
        Self { lights, shares: params.shares }
    }

    /// Brightness of ground with this gradient.
    pub fn of_slope(&self, gradient: DVec2, params: &ShadeParams) -> f32 {
        let slope = gradient * params.exaggeration;
        self.on(DVec3::new(-slope.x, -slope.y, 1.0).normalize()) as f32
    }

    /// Brightness of ground with this unit normal.
    pub fn on(&self, normal: DVec3) -> f64 {
        // The normal leans in the direction that the slope faces.
        let facing = normal.truncate().try_normalize().filter(|_| self.shares == Shares::FromTheSide);
        let Some(facing) = facing else {
            return self.lights.iter().map(|(light, weight)| weight * normal.dot(*light).max(0.0)).sum();
        };
        let (mut sum, mut total) = (0.0, 0.0);
        for (light, weight) in &self.lights {
            let weight = weight * facing.perp_dot(light.truncate().normalize_or_zero()).powi(2);
            sum += weight * normal.dot(*light).max(0.0);
            total += weight;
        }
        if total > 0.0 { sum / total } else { 0.0 }
    }
}

/// The slope of every cell as rise over run, row by row. NaN without a height.
pub fn steepness(dem: &Dem, metres_per_unit: DVec2) -> Vec<f32> {
    map_gradients(dem, |_| metres_per_unit, |gradient| gradient.length() as f32)
}

/// Calls `value` with the gradient (per metre east and north) of every cell that has a height. Other cells are NaN.
/// `metres_per_unit` takes a row.
pub(super) fn map_gradients(
    dem: &Dem,
    metres_per_unit: impl Fn(usize) -> DVec2 + Sync,
    value: impl Fn(DVec2) -> f32 + Sync,
) -> Vec<f32> {
    let (cols, rows) = (dem.grid.cols, dem.grid.rows);
    let mut out = vec![f32::NAN; dem.values.len()];
    if cols == 0 {
        return out;
    }
    parallel::chunks(&mut out, cols, |row, line| {
        let line_of = |row: usize| (row < rows).then(|| &dem.values[row * cols..(row + 1) * cols]);
        let lines = [row.checked_sub(1).and_then(line_of), line_of(row), line_of(row + 1)];
        gradients(lines, dem.grid.cell * metres_per_unit(row), |col, gradient, _| line[col] = value(gradient));
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;

    /// A plane that rises by `slope` per map unit.
    fn plane(slope: DVec2, cell: DVec2) -> Dem {
        let grid = Grid { corner: DVec2::new(500.0, 900.0), cell, cols: 9, rows: 7 };
        let values = (0..63).map(|i| grid.center(i % 9, i / 9).dot(slope) as f32).collect();
        Dem { grid, values, crs: None }
    }

    #[test]
    fn a_plane_is_equally_bright_up_to_its_border() {
        let mut dem = plane(DVec2::new(0.5, -0.25), DVec2::new(2.0, 4.0));
        dem.values[30] = f32::NAN;
        let normal = DVec3::new(-0.5, 0.25, 1.0).normalize();
        let half = 0.5_f64.sqrt();
        let expected = normal.dot(DVec3::new(-0.5, 0.5, half)) as f32;
        for (i, value) in hillshade(&dem, &ShadeParams::default()).into_iter().enumerate() {
            assert_eq!(value.is_nan(), i == 30);
            assert!(i == 30 || (value - expected).abs() < 1e-6, "{i}: {value} {expected}");
        }
        for (i, value) in steepness(&dem, DVec2::ONE).into_iter().enumerate() {
            assert!(i == 30 || (value - 0.5_f32.hypot(0.25)).abs() < 1e-6);
        }
    }

    #[test]
    fn level_ground_has_the_brightness_that_is_promised() {
        for params in [ShadeParams::default(), ShadeParams::soft()] {
            let value = hillshade(&plane(DVec2::ZERO, DVec2::ONE), &params)[10];
            assert!((f64::from(value) - params.level()).abs() < 1e-6);
        }
    }

    #[test]
    fn slopes_towards_the_light_are_bright_and_away_from_it_dark() {
        let shade = |x, y| hillshade(&plane(DVec2::new(x, y), DVec2::ONE), &ShadeParams::default())[31];
        assert!((shade(0.5_f64.sqrt(), -(0.5_f64.sqrt())) - 1.0).abs() < 1e-6);
        assert_eq!(shade(-9.0, 9.0), 0.0);
    }

    #[test]
    fn lights_from_many_sides_follow_the_formula_of_their_definition() {
        // By angles: aspect and slope of the ground, azimuth and zenith of the lights (Mark 1992; Horn 1981).
        for altitude in [20.0_f64, 45.0, 80.0] {
            for (x, y) in [(0.3, 0.1), (-0.8, 0.05), (0.2, -1.5), (-0.4, -0.4), (0.0, 0.6), (0.7, 0.0)] {
                let aspect = f64::atan2(-x, -y);
                let slope = f64::hypot(x, y).atan();
                let zenith = (90.0 - altitude).to_radians();
                let expected: f64 = [225.0_f64, 270.0, 315.0, 360.0]
                    .map(|azimuth| {
                        let angle = azimuth.to_radians() - aspect;
                        let bright = zenith.cos() * slope.cos() + zenith.sin() * slope.sin() * angle.cos();
                        0.5 * angle.sin().powi(2) * bright.max(0.0)
                    })
                    .iter()
                    .sum();
                let params = ShadeParams::multidirectional(altitude);
                let value = hillshade(&plane(DVec2::new(x, y), DVec2::ONE), &params)[31];
                assert!((f64::from(value) - expected).abs() < 1e-4, "{altitude} {x} {y}: {value} {expected}");
            }
            let level = hillshade(&plane(DVec2::ZERO, DVec2::ONE), &ShadeParams::multidirectional(altitude))[31];
            assert!((f64::from(level) - altitude.to_radians().sin()).abs() < 1e-6);
        }
    }

    #[test]
    fn the_factor_on_heights_is_that_of_a_steeper_plane() {
        let params = ShadeParams { exaggeration: 3.0, ..ShadeParams::default() };
        let steep = hillshade(&plane(DVec2::new(0.3, -0.6), DVec2::ONE), &ShadeParams::default())[31];
        let raised = hillshade(&plane(DVec2::new(0.1, -0.2), DVec2::ONE), &params)[31];
        assert!((steep - raised).abs() < 1e-4);
    }

    #[test]
    fn a_lone_cell_is_level() {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: 1, rows: 1 };
        let dem = Dem { grid, values: vec![5.0], crs: None };
        assert!((hillshade(&dem, &ShadeParams::default())[0] - 0.5_f32.sqrt()).abs() < 1e-6);
        let empty = Dem { grid: Grid { cols: 0, rows: 0, ..grid }, values: vec![], crs: None };
        assert!(hillshade(&empty, &ShadeParams::default()).is_empty());
    }
}
