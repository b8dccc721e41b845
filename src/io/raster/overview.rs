//! Overviews of a raster: the same map with cells of twice the side, four times the side, and so on.
//!
//! A cell of an overview is the mean of the cells with data among the two by two below it. It has data if one of them
//! has. The mean of directions is the direction of the sum of their unit vectors: the mean of 350 and 10 degrees is 0.
//! Codes and numbers of catchments have no mean: one of them is taken. Of flow accumulations, the largest is taken, so that
//! streams stay visible.

use std::borrow::Cow;

use super::quantity::Quantity;
use tokosen_core::base::parallel;

/// A raster's values and its size.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Image<'a> {
    /// The values of each band, row by row.
    pub bands: Vec<Cow<'a, [f32]>>,
    pub cols: usize,
    pub rows: usize,
}

/// The overviews of a raster, the largest first. The smallest has at most `side` columns and rows.
pub(super) fn overviews(map: &Image<'_>, side: usize, quantity: Quantity) -> Vec<Image<'static>> {
    let mut levels: Vec<Image<'static>> = Vec::new();
    loop {
        let finer = levels.last().unwrap_or(map);
        if finer.cols.max(finer.rows) <= side {
            return levels;
        }
        let (cols, rows) = (finer.cols.div_ceil(2), finer.rows.div_ceil(2));
        let band = |band: &Cow<'_, [f32]>| Cow::Owned(halved(band, finer.cols, finer.rows, quantity));
        let bands = finer.bands.iter().map(band).collect();
        levels.push(Image { bands, cols, rows });
    }
}

/// The values for cells of twice the side. Where the number of columns or rows is odd, the last cells have no partners.
fn halved(values: &[f32], cols: usize, rows: usize, quantity: Quantity) -> Vec<f32> {
    let across = cols.div_ceil(2);
    let summary = match quantity {
        Quantity::Aspect => mean_direction,
        Quantity::FlowDirection | Quantity::Catchment => first,
        Quantity::FlowAccumulation | Quantity::UpstreamArea => largest,
        _ => mean,
    };
    let mut coarse = vec![f32::NAN; across * rows.div_ceil(2)];
    parallel::chunks(&mut coarse, across, |row, line| {
        let of = |row: usize| if row < rows { &values[row * cols..(row + 1) * cols] } else { &[] };
        let pair = [of(row * 2), of(row * 2 + 1)];
        for (col, out) in line.iter_mut().enumerate() {
            let [[a, b], [c, d]] = pair.map(|line| [line.get(col * 2).copied(), line.get(col * 2 + 1).copied()]);
            *out = summary([a, b, c, d].map(|value| value.filter(|value| !value.is_nan())));
        }
    });
    coarse
}

/// The mean of those that are there; NaN if none is.
fn mean(values: [Option<f32>; 4]) -> f32 {
    let known = values.into_iter().flatten();
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), value| (sum + f64::from(value), count + 1.0));
    if count > 0.0 { (sum / count) as f32 } else { f32::NAN }
}

/// The mean of directions in degrees; NaN if there are none, or if they cancel each other out.
fn mean_direction(values: [Option<f32>; 4]) -> f32 {
    let vectors = values.into_iter().flatten().map(|angle| f64::from(angle).to_radians().sin_cos());
    let (sin, cos) = vectors.fold((0.0, 0.0), |sum, vector| (sum.0 + vector.0, sum.1 + vector.1));
    if f64::hypot(sin, cos) < 1e-9 {
        return f32::NAN;
    }
    // Rounding makes the largest angles below a full turn a full turn.
    let angle = sin.atan2(cos).to_degrees().rem_euclid(360.0) as f32;
    if angle < 360.0 { angle } else { 0.0 }
}

/// The first of those that are there; NaN if none is.
fn first(values: [Option<f32>; 4]) -> f32 {
    values.into_iter().flatten().next().unwrap_or(f32::NAN)
}

/// The largest of those that are there; NaN if none is.
fn largest(values: [Option<f32>; 4]) -> f32 {
    values.into_iter().flatten().fold(f32::NAN, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(values: &[f32]) -> Vec<u32> {
        values.iter().map(|value| value.to_bits()).collect()
    }

    #[test]
    fn a_cell_is_the_mean_of_those_below_it_that_have_data() {
        let n = f32::NAN;
        let values = [[1.0, 2.0, 5.0, 3.0, 6.0], [n, n, n, n, 4.0], [10.0, n, n, 7.5, n]].concat();
        let map = Image { bands: vec![Cow::Owned(values)], cols: 5, rows: 3 };
        let levels = overviews(&map, 1, Quantity::Height);
        let found: Vec<_> = levels.iter().map(|level| (level.cols, level.rows, bits(&level.bands[0]))).collect();
        let expected = [(3, 2, vec![1.5, 4.0, 5.0, 10.0, 7.5, n]), (2, 1, vec![5.75, 5.0]), (1, 1, vec![5.375])];
        assert_eq!(found, expected.map(|(cols, rows, values)| (cols, rows, bits(&values))));
        assert!(overviews(&map, 5, Quantity::Height).is_empty());
    }

    #[test]
    fn directions_have_a_mean_around_north() {
        let mean = |values: [f32; 4]| mean_direction(values.map(|v| Some(v).filter(|v| !v.is_nan())));
        let n = f32::NAN;
        for (values, expected) in [([350.0, 10.0, n, n], 0.0), ([350.0, 20.0, n, n], 5.0), ([90.0, 180.0, n, n], 135.0)]
        {
            let off = (mean(values) - expected + 180.0).rem_euclid(360.0) - 180.0;
            assert!(off.abs() < 1e-4 && mean(values) < 360.0, "{values:?}: {}", mean(values));
        }
        assert!(mean([0.0, 180.0, n, n]).is_nan() && mean([n; 4]).is_nan());
    }

    #[test]
    fn codes_are_chosen_and_not_averaged() {
        let n = f32::NAN;
        let map = Image { bands: vec![Cow::Owned(vec![n, 4.0, n, 64.0, 1.0, n])], cols: 3, rows: 2 };
        for (quantity, expected) in [
            (Quantity::FlowDirection, [4.0, n]),
            (Quantity::Catchment, [4.0, n]),
            (Quantity::FlowAccumulation, [64.0, n]),
            (Quantity::Height, [23.0, n]),
        ] {
            assert_eq!(bits(&overviews(&map, 2, quantity)[0].bands[0]), bits(&expected), "{quantity:?}");
        }
    }
}
