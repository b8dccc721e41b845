//! Height maps: the [`Dem`] of heights on a [`Grid`] of cells.

pub mod compare;
pub mod derive;
mod ground;
mod rasterise;
pub mod shade;

pub use ground::{GroundScale, looks_like_degrees};
pub(crate) use rasterise::{height, heights_at};
pub use rasterise::{locate, rasterise};

use glam::DVec2;

use crate::base::Grid;
use crate::crs::Crs;

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
