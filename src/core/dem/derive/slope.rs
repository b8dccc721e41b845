//! Slope, aspect and hillshade as rasters.
//!
//! The gradient is that of Horn (1981) over the eight neighbours, as in GDAL. At the border and beside cells without
//! data, heights are extrapolated linearly. So every cell with a height has a value.

use glam::DVec2;

use crate::dem::shade::{ShadeParams, hillshade_on, map_gradients};
use crate::raster::{Dem, GroundScale};

/// The slope of every cell, degrees from level (0) to vertical (90). NaN without a height.
pub fn slope(dem: &Dem, scale: &GroundScale) -> Dem {
    with(dem, map_gradients(dem, |row| scale.row(row), slope_of))
}

/// The aspect of every cell: the direction of steepest descent, degrees clockwise from north, 0 to less than 360. NaN
/// on level ground and without a height.
pub fn aspect(dem: &Dem, scale: &GroundScale) -> Dem {
    with(dem, map_gradients(dem, |row| scale.row(row), aspect_of))
}

/// The hillshade of every cell under the lights of `params`, 1 (dark) to 255 (bright) as in GDAL. NaN without a height.
/// `scale` replaces the metres per unit in `params`.
pub fn shade(dem: &Dem, params: &ShadeParams, scale: &GroundScale) -> Dem {
    let mut values = hillshade_on(dem, params, scale);
    values.iter_mut().for_each(|value| *value = brightness(*value));
    with(dem, values)
}

/// The slope of a gradient, degrees.
pub(super) fn slope_of(gradient: DVec2) -> f32 {
    gradient.length().atan().to_degrees() as f32
}

/// The direction of steepest descent of a gradient, degrees clockwise from north. NaN on level ground.
pub(super) fn aspect_of(gradient: DVec2) -> f32 {
    if gradient == DVec2::ZERO {
        return f32::NAN;
    }
    let degrees = (-gradient.x).atan2(-gradient.y).to_degrees().rem_euclid(360.0) as f32;
    // Rounding may give 360, which is north again.
    if degrees >= 360.0 { 0.0 } else { degrees }
}

/// GDAL's number for a brightness from 0 to 1.
pub(super) fn brightness(light: f32) -> f32 {
    1.0 + 254.0 * light
}

fn with(dem: &Dem, values: Vec<f32>) -> Dem {
    Dem { grid: dem.grid, values, crs: dem.crs.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;

    fn plane(rise: DVec2) -> Dem {
        let grid = Grid { corner: DVec2::new(1000.0, 2000.0), cell: DVec2::new(5.0, 4.0), cols: 7, rows: 6 };
        let values = (0..42).map(|i| (grid.center(i % 7, i / 7) - grid.corner).dot(rise) as f32).collect();
        Dem { grid, values, crs: None }
    }

    #[test]
    fn planes_have_their_slope_and_face_downhill() {
        let scale = GroundScale::Uniform(DVec2::ONE);
        for (rise, facing) in [
            (DVec2::new(0.0, -0.5), 0.0),
            (DVec2::new(-0.5, -0.5), 45.0),
            (DVec2::new(-1.0, 0.0), 90.0),
            (DVec2::new(0.0, 2.0), 180.0),
            (DVec2::new(1.0, 0.0), 270.0),
            (DVec2::new(0.25, -0.25), 315.0),
        ] {
            let dem = plane(rise);
            let steepness = rise.length().atan().to_degrees() as f32;
            for (slope, aspect) in slope(&dem, &scale).values.iter().zip(aspect(&dem, &scale).values) {
                assert!((slope - steepness).abs() < 1e-4, "{rise}: {slope} {steepness}");
                let turn = (aspect - facing).rem_euclid(360.0);
                assert!((0.0..360.0).contains(&aspect) && turn.min(360.0 - turn) < 1e-4, "{rise}: {aspect} {facing}");
            }
        }
    }

    #[test]
    fn level_ground_faces_nowhere() {
        let scale = GroundScale::Uniform(DVec2::ONE);
        let mut dem = plane(DVec2::ZERO);
        dem.values[10] = f32::NAN;
        assert!(aspect(&dem, &scale).values.iter().all(|v| v.is_nan()));
        let slopes = slope(&dem, &scale).values;
        assert!(slopes.iter().enumerate().all(|(i, v)| if i == 10 { v.is_nan() } else { *v == 0.0 }));
    }

    #[test]
    fn the_scale_counts_row_by_row() {
        let dem = plane(DVec2::new(1.0, 0.0));
        let scale = GroundScale::Rows((0..6).map(|row| DVec2::new(1.0 + row as f64, 1.0)).collect());
        let slopes = slope(&dem, &scale).values;
        for row in 0..6 {
            let expected = (1.0 / (1.0 + row as f32)).atan().to_degrees();
            assert!((slopes[row * 7 + 3] - expected).abs() < 1e-4);
        }
    }
}
