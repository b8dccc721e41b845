//! Cells of height maps in square cells on a plane in metres, for models and pages.

use glam::DVec2;

use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::{Crs, Transform, working_crs};
use tokosen_core::dem::compare::heights_between;
use tokosen_core::raster::Dem;

/// The plane in metres for places in some system: that of contours in this system. The system itself if nobody knows what it is.
pub(super) fn plane_of(crs: Option<&Crs>, places: Vec<DVec2>) -> Result<Option<Crs>> {
    let Some(crs) = crs else { return Ok(None) };
    let is_known = crs.kind().is_some() || crs.local_in_metres().is_some();
    Ok(Some(if is_known { working_crs(crs, places.into_iter())? } else { crs.clone() }))
}

/// The heights of height maps, which are on one grid, in square cells on a plane in metres: those in a window, in at most so many
/// cells. Cells that are square and on the plane stay, or every second, third, … of them. From others, heights are interpolated.
///
/// # Errors
/// [`Error::Data`] if the cells have no places on the plane.
pub(super) fn cells_on_plane<const N: usize>(
    dems: [&Dem; N],
    window: &Window,
    (plane, to_plane): (Option<&Crs>, Option<&Transform>),
    most: f64,
) -> Result<[Dem; N]> {
    let grid = dems[0].grid;
    let count = window.size.element_product();
    let is_square = (grid.cell.x - grid.cell.y).abs() <= 1e-9 * grid.cell.x;
    let Some(way) = to_plane else {
        if is_square {
            let every = (count / most).sqrt().ceil().max(1.0) as usize;
            return Ok(dems.map(|dem| window.picked(dem, every)));
        }
        let (lo, hi) = window.corners(&grid);
        let cells = Grid::on_multiples(lo, hi, (grid.cell.element_product() * (count / most).max(1.0)).sqrt());
        let values = |dem: &Dem| heights_between(dem, &cells, &Some);
        return Ok(dems.map(|dem| Dem { grid: cells, values: values(dem), crs: plane.cloned() }));
    };
    let bounds = window.border(&grid).into_iter().filter_map(|p| way.forward(p));
    let (lo, hi) = bounds.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let area = (hi - lo).element_product();
    if !area.is_finite() {
        return Err(Error::Data("the cells have no places on a plane".into()));
    }
    let cells = Grid::on_multiples(lo, hi, (area / count.min(most)).sqrt());
    let values = |dem: &Dem| heights_between(dem, &cells, &|p| way.inverse(p));
    Ok(dems.map(|dem| Dem { grid: cells, values: values(dem), crs: plane.cloned() }))
}

/// Columns and rows of a grid.
pub(super) struct Window {
    first: [usize; 2],
    size: DVec2,
}

impl Window {
    /// The box around the cells that have heights in all height maps, which are on one grid.
    pub fn of<const N: usize>(dems: [&Dem; N]) -> Option<Self> {
        let cols = dems[0].grid.cols;
        let in_all = |k: &usize| dems.iter().all(|dem| dem.values[*k].is_finite());
        let none = ([usize::MAX; 2], [0; 2]);
        let (first, last) = (0..dems[0].values.len()).filter(in_all).fold(none, |(first, last), k| {
            let at = [k % cols, k / cols];
            (std::array::from_fn(|i| first[i].min(at[i])), std::array::from_fn(|i| last[i].max(at[i])))
        });
        let size = (first[0] <= last[0]).then(|| [0, 1].map(|i| (last[i] - first[i] + 1) as f64))?;
        Some(Self { first, size: size.into() })
    }

    /// The lower left and the upper right corner.
    pub fn corners(&self, grid: &Grid) -> (DVec2, DVec2) {
        let [col, row] = self.first.map(|at| at as f64);
        let upper_left = grid.corner + DVec2::new(col, -row) * grid.cell;
        let size = self.size * grid.cell;
        (upper_left - DVec2::new(0.0, size.y), upper_left + DVec2::new(size.x, 0.0))
    }

    /// Places along its border.
    pub fn border(&self, grid: &Grid) -> Vec<DVec2> {
        const STEPS: u32 = 20;
        let (lo, hi) = self.corners(grid);
        let shares = || (0..=STEPS).map(|k| f64::from(k) / f64::from(STEPS));
        let sides = shares().flat_map(|s| [(s, 0.0), (s, 1.0), (0.0, s), (1.0, s)]);
        sides.map(|share| lo + (hi - lo) * DVec2::from(share)).collect()
    }

    /// Every so many of its cells of a height map.
    fn picked(&self, dem: &Dem, every: usize) -> Dem {
        let Grid { cell, cols: width, .. } = dem.grid;
        let [cols, rows] = self.size.to_array().map(|size| (size as usize).div_ceil(every));
        let [col, row] = self.first;
        let values = (0..rows).flat_map(|r| (0..cols).map(move |c| (row + r * every) * width + col + c * every));
        let cell = cell * every as f64;
        let corner = dem.grid.center(col, row) + DVec2::new(-0.5, 0.5) * cell;
        let values = values.map(|k| dem.values[k]).collect();
        Dem { grid: Grid { corner, cell, cols, rows }, values, crs: dem.crs.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_picked_around_those_that_both_have() {
        let grid = Grid { corner: DVec2::new(1000.0, 2000.0), cell: DVec2::splat(10.0), cols: 9, rows: 8 };
        let values = (0..72).map(|k| k as f32).collect();
        let a = Dem { grid, values, crs: None };
        // B begins at the second column and the third row, and has a gap.
        let missing = |k: usize| k % 9 < 1 || k / 9 < 2 || k == 40;
        let b = Dem { values: (0..72).map(|k| if missing(k) { f32::NAN } else { 0.0 }).collect(), ..a.clone() };
        let window = Window::of([&a, &b]).unwrap();
        assert_eq!((window.first, window.size), ([1, 2], DVec2::new(8.0, 6.0)));
        assert_eq!(window.corners(&grid), (DVec2::new(1010.0, 1920.0), DVec2::new(1090.0, 1980.0)));
        for (every, cols, rows) in [(1, 8, 6), (3, 3, 2)] {
            let picked = window.picked(&a, every);
            assert_eq!((picked.grid.cols, picked.grid.rows), (cols, rows));
            for (k, height) in picked.values.iter().enumerate() {
                let at = grid.place(picked.grid.center(k % cols, k / cols));
                assert_eq!(f64::from(*height), at.x + 9.0 * at.y, "every {every}");
            }
        }
        let nowhere = Dem { values: vec![f32::NAN; 72], ..a.clone() };
        assert!(Window::of([&a, &nowhere]).is_none());
    }
}
