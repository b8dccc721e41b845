//! Heights outside the bands of the contours: there, a height map certainly contradicts the contours.

use serde::Serialize;

use super::Extreme;
use super::statistics::sum;
use crate::base::{ElevationUnit, parallel};
use crate::raster::Dem;
use crate::subdomains::Band;

/// The cells of a height map whose heights lie outside the band of their sub-domain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BandShare {
    /// Cells with a height and a band.
    pub cells: usize,
    /// Number of these cells whose height is outside their band.
    pub outside: usize,
    /// Their share of the cells.
    pub share: f64,
    /// Mean distance of the heights outside from their band, metres; 0 if there are none.
    pub mean_excess: f64,
    /// The height farthest outside its band: distance (metres, below 0 if it is below the band) and position.
    pub furthest: Option<Extreme>,
}

impl BandShare {
    /// The same with its distances in a unit.
    pub fn in_unit(self, unit: ElevationUnit) -> Self {
        let furthest = self.furthest.map(|furthest| Extreme { value: unit.about(furthest.value), ..furthest });
        Self { mean_excess: unit.about(self.mean_excess), furthest, ..self }
    }
}

/// Counts the cells of `dem` outside their band. `band_of` gives the band of a cell by its index. `None` if no cell has
/// a band.
pub fn outside_bands(dem: &Dem, band_of: impl Fn(usize) -> Option<Band> + Sync) -> Option<BandShare> {
    let excess = |i: usize| {
        let height = f64::from(dem.values[i]);
        let band = if height.is_finite() { band_of(i) } else { None };
        band.map_or(f64::NAN, |band| height - height.max(band.lo).min(band.hi))
    };
    let excess: Vec<f64> = parallel::values(dem.grid.len(), excess);
    let cells = parallel::count(excess.len(), |i| excess[i].is_finite());
    if cells == 0 {
        return None;
    }
    let outside: Vec<usize> =
        parallel::flat_map(excess.len(), |i| (excess[i].is_finite() && excess[i] != 0.0).then_some(i));
    let size = |i: usize| excess[i].abs();
    let furthest = outside.iter().copied().max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a)));
    let sizes: Vec<f64> = parallel::values_each(&outside, |&i| size(i));
    Some(BandShare {
        cells,
        outside: outside.len(),
        share: outside.len() as f64 / cells as f64,
        mean_excess: sum(&sizes, |e| e) / outside.len().max(1) as f64,
        furthest: furthest
            .map(|i| Extreme { value: excess[i], place: dem.grid.center(i % dem.grid.cols, i / dem.grid.cols) }),
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::base::Grid;

    #[test]
    fn cells_outside_are_counted_with_their_excess() {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: 5, rows: 1 };
        let dem = Dem { grid, values: vec![10.0, 20.5, 7.0, f32::NAN, 99.0], crs: None };
        let share = outside_bands(&dem, |i| (i < 4).then_some(Band { lo: 10.0, hi: 20.0 })).unwrap();
        assert_eq!((share.cells, share.outside), (3, 2));
        assert!((share.share - 2.0 / 3.0).abs() < 1e-12 && (share.mean_excess - 1.75).abs() < 1e-12);
        assert_eq!(share.furthest, Some(Extreme { value: -3.0, place: DVec2::new(2.5, -0.5) }));
        assert_eq!(outside_bands(&dem, |_| None), None);
        let none = outside_bands(&dem, |_| Some(Band { lo: f64::NEG_INFINITY, hi: f64::INFINITY })).unwrap();
        assert_eq!((none.outside, none.mean_excess, none.furthest), (0, 0.0, None));
    }
}
