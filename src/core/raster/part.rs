//! Parts of a height map: the cells inside an area, and the rows and columns around it.

use geo::{BoundingRect, MultiPolygon};
use glam::DVec2;

use super::Dem;
use crate::base::error::{Error, Result};
use crate::base::{Grid, parallel};
use crate::geometry::Border;

/// Leaves out the heights of cells whose centres lie outside of an area. `on_plane` leads from a centre to the plane of
/// the area.
pub fn mask(dem: &mut Dem, area: &MultiPolygon<f64>, on_plane: &(dyn Fn(DVec2) -> Option<DVec2> + Sync)) {
    let border = Border::new(area);
    let is_in = |p: DVec2| border.contains(p) || border.edge_at(p).is_some();
    let grid = dem.grid;
    parallel::update(&mut dem.values, |k, value| {
        if value.is_nan() {
            return;
        }
        let centre = grid.center(k % grid.cols, k / grid.cols);
        if !on_plane(centre).is_some_and(is_in) {
            *value = f32::NAN;
        }
    });
}

impl Dem {
    /// The box around the cells: its lower left and its upper right corner.
    pub fn corners(&self) -> [DVec2; 2] {
        let Grid { corner, cell, cols, rows } = self.grid;
        let opposite = corner + cell * DVec2::new(cols as f64, -(rows as f64));
        [corner.min(opposite), corner.max(opposite)]
    }

    /// The same with the ground ending at the border of an area: cells whose centres lie outside have no height. The area is in
    /// the coordinates of the height map.
    ///
    /// # Errors
    /// [`Error::Data`] if no cell with a height is left.
    pub fn inside(mut self, frame: &MultiPolygon<f64>) -> Result<Self> {
        mask(&mut self, frame, &Some);
        match self.values.iter().all(|height| height.is_nan()) {
            true => Err(Error::Data("no cell of the height map with a height lies inside the polygon".into())),
            false => Ok(self),
        }
    }

    /// The rows and columns that meet the box around an area, which is in the coordinates of the height map. All of them if the
    /// area lies elsewhere.
    pub fn around(&self, area: &MultiPolygon<f64>) -> Self {
        self.with_margin(area, 0.0)
    }

    /// [`Dem::around`] with one more row and column on each side: the cells that heights at the border of the area are interpolated
    /// from.
    pub fn beyond(&self, area: &MultiPolygon<f64>) -> Self {
        self.with_margin(area, 1.0)
    }

    /// The rows and columns that meet the box around an area, and some more on each side.
    fn with_margin(&self, area: &MultiPolygon<f64>, margin: f64) -> Self {
        let grid = self.grid;
        let Some(around) = area.bounding_rect() else { return self.clone() };
        // A place has the centre of its cell as the nearest whole number.
        let first = grid.place(DVec2::new(around.min().x, around.max().y)).round() - margin;
        let last = grid.place(DVec2::new(around.max().x, around.min().y)).round() + margin;
        let first = first.max(DVec2::ZERO);
        let last = last.min(DVec2::new(grid.cols as f64, grid.rows as f64) - 1.0);
        if !first.cmple(last).all() {
            return self.clone();
        }
        let [(left, top), (right, bottom)] = [first, last].map(|place| (place.x as usize, place.y as usize));
        let corner = grid.corner + grid.cell * DVec2::new(left as f64, -(top as f64));
        let row = |row: usize| &self.values[row * grid.cols..][left..=right];
        Self {
            grid: Grid { corner, cols: right - left + 1, rows: bottom - top + 1, ..grid },
            values: (top..=bottom).flat_map(row).copied().collect(),
            crs: self.crs.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use geo::polygon;

    use super::*;

    /// Five columns and four rows of cells of 2 by 3; heights are their numbers.
    fn dem() -> Dem {
        let grid = Grid { corner: DVec2::new(100.0, 50.0), cell: DVec2::new(2.0, 3.0), cols: 5, rows: 4 };
        Dem { grid, values: (0_u8..20).map(f32::from).collect(), crs: None }
    }

    fn rectangle(west: f64, south: f64, east: f64, north: f64) -> MultiPolygon<f64> {
        polygon![(x: west, y: south), (x: east, y: south), (x: east, y: north), (x: west, y: north)].into()
    }

    #[test]
    fn cells_whose_centres_lie_outside_have_no_height() {
        assert_eq!(dem().corners(), [DVec2::new(100.0, 38.0), DVec2::new(110.0, 50.0)]);
        let found = dem().inside(&rectangle(102.5, 44.0, 107.0, 60.0)).unwrap();
        let left: Vec<f32> = found.values.iter().copied().filter(|height| !height.is_nan()).collect();
        // A centre on the border is inside.
        assert_eq!((found.grid, left), (dem().grid, vec![1.0, 2.0, 3.0, 6.0, 7.0, 8.0]));
        let error = dem().inside(&rectangle(0.0, 0.0, 1.0, 1.0)).unwrap_err();
        assert!(error.to_string().contains("inside the polygon"), "{error}");
    }

    #[test]
    fn the_rows_and_columns_around_an_area_keep_their_places() {
        let found = dem().around(&rectangle(102.5, 43.0, 105.5, 46.0));
        assert_eq!(found.grid, Grid { corner: DVec2::new(102.0, 47.0), cols: 2, rows: 2, ..dem().grid });
        assert_eq!(found.values, [6.0, 7.0, 11.0, 12.0]);
        assert_eq!(dem().around(&rectangle(0.0, 0.0, 1000.0, 1000.0)), dem());
        assert_eq!(dem().around(&rectangle(0.0, 0.0, 1.0, 1.0)), dem());
    }
}
