//! Height maps: the [`Grid`] of cells, the [`Dem`] of heights on it.

pub mod compare;
pub mod derive;
mod ground;
mod rasterise;
pub mod shade;

pub use ground::{GroundScale, looks_like_degrees};
pub(crate) use rasterise::{height, heights_at};
pub use rasterise::{locate, rasterise};

use glam::DVec2;

use crate::crs::Crs;

/// A raster's placement: north is up, row 0 is the northernmost, column 0 the westernmost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Outer corner of the north-west cell, map units.
    pub corner: DVec2,
    /// Cell size in x and y, map units, both positive.
    pub cell: DVec2,
    /// Number of columns.
    pub cols: usize,
    /// Number of rows.
    pub rows: usize,
}

impl Grid {
    /// Square cells on multiples of their size that cover a box.
    pub fn on_multiples(lo: DVec2, hi: DVec2, cell: f64) -> Self {
        let (west_south, east_north) = ((lo / cell).floor(), (hi / cell).ceil());
        let count = (east_north - west_south).max(DVec2::ONE);
        let corner = DVec2::new(west_south.x, east_north.y) * cell;
        Self { corner, cell: DVec2::splat(cell), cols: count.x as usize, rows: count.y as usize }
    }

    /// Centre of a cell, map units.
    pub fn center(&self, col: usize, row: usize) -> DVec2 {
        DVec2::new(self.corner.x + (col as f64 + 0.5) * self.cell.x, self.corner.y - (row as f64 + 0.5) * self.cell.y)
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cols * self.rows
    }

    /// Whether the grid has no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Heights at the cell centres of a [`Grid`].
#[derive(Debug, Clone, PartialEq)]
pub struct Dem {
    /// Where the cells are.
    pub grid: Grid,
    /// Heights in metres, row by row from the north-west; NaN where there is no data.
    pub values: Vec<f32>,
    /// The coordinate reference system, if known.
    pub crs: Option<Crs>,
}

impl Dem {
    /// Metres on the ground in a map unit, east and north, in the middle row; `None` if the unit is not known.
    pub fn metres_per_unit(&self) -> Option<DVec2> {
        let crs = self.crs.as_ref()?;
        let is_known = crs.is_geographic() || crs.length_unit().is_some();
        is_known.then(|| GroundScale::of(self).row(self.grid.rows / 2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_is_as_long_as_on_the_ellipsoid() {
        let of = |epsg: Option<u32>, north: f64| {
            let grid = Grid { corner: DVec2::new(138.0, north), cell: DVec2::splat(0.5), cols: 4, rows: 2 };
            Dem { grid, values: vec![], crs: epsg.map(Crs::from_epsg) }.metres_per_unit()
        };
        // The middle of the second row is at 36 degrees: 1' of latitude is 1849.32 m there.
        let degree = of(Some(6668), 36.75).unwrap();
        assert!((degree.y / 60.0 - 1849.3).abs() < 0.2 && (degree.x / 60.0 - 1502.8).abs() < 0.5, "{degree}");
        let equator = of(Some(4326), 0.75).unwrap();
        assert!((equator.x - 111_319.49).abs() < 0.01 && (equator.y - 110_574.28).abs() < 0.02, "{equator}");
        assert_eq!(of(Some(6690), 36.0), Some(DVec2::ONE));
        assert_eq!(of(None, 36.0), None);
    }
}
