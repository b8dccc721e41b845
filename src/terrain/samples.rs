//! The samples of height maps for game engines: squares of fixed sizes.

use glam::DVec2;
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::subdomains::FrameRing;

/// Cells that a height map may have, whatever the memory.
pub(super) const MOST_CELLS: f64 = 4e9;
/// Rounding of the number of samples along a frame.
const ROUNDING: f64 = 1e-9;

/// How many samples there are, and how far apart; see [`GridSpec::Samples`](super::GridSpec::Samples).
pub(super) struct Samples {
    pub sides: Vec<usize>,
    pub cell: Option<f64>,
}

impl Samples {
    /// The cells whose centres are the samples over a frame, in its middle.
    pub fn grid(&self, frame: &FrameRing) -> Result<Grid> {
        let (lo, hi) = frame.extent();
        let size = hi - lo;
        let largest = self.sides.last().copied();
        let cell = match (self.cell, largest) {
            (Some(cell), _) => cell,
            (None, side) => size.max_element() / (side.unwrap_or(2).max(2) - 1) as f64,
        };
        // Intervals between samples.
        let wanted = (size / cell - ROUNDING).ceil().max(DVec2::ONE);
        if !wanted.is_finite() || wanted.x * wanted.y > MOST_CELLS {
            let (cols, rows, because) = (wanted.x, wanted.y, String::new());
            return Err(Error::TooManyCells { cell, cols, rows, in_degrees: false, because });
        }
        let fits = |side: &&usize| (**side - 1) as f64 >= wanted.max_element();
        let (intervals, cell) = match (self.sides.iter().find(fits), largest) {
            (Some(side), _) => (DVec2::splat((side - 1) as f64), size.max_element() / (side - 1) as f64),
            // Whole squares side by side.
            (None, Some(side)) => {
                let intervals = (wanted / (side - 1) as f64).ceil() * (side - 1) as f64;
                (intervals, (size / intervals).max_element())
            }
            (None, None) => (wanted, cell),
        };
        let first =
            DVec2::new(lo.midpoint(hi).x - intervals.x * cell / 2.0, lo.midpoint(hi).y + intervals.y * cell / 2.0);
        let corner = first + DVec2::new(-0.5, 0.5) * cell;
        let [cols, rows] = intervals.to_array().map(|n| n as usize + 1);
        Ok(Grid { corner, cell: DVec2::splat(cell), cols, rows })
    }
}

#[cfg(test)]
mod tests {
    use geo::{Coord, Rect};

    use super::*;

    fn frame(width: f64, height: f64) -> FrameRing {
        FrameRing {
            area: Rect::new(Coord { x: 10.0, y: 20.0 }, Coord { x: 10.0 + width, y: 20.0 + height })
                .to_polygon()
                .into(),
        }
    }

    #[test]
    fn samples_lie_on_the_edges_or_beyond_them() {
        let of = |sides: &[usize], cell| Samples { sides: sides.to_vec(), cell }.grid(&frame(640.0, 300.0)).unwrap();
        let by_number = of(&[65], None);
        assert_eq!((by_number.cols, by_number.rows, by_number.cell), (65, 65, DVec2::splat(10.0)));
        assert_eq!(by_number.center(0, 32), DVec2::new(10.0, 170.0));
        assert_eq!(by_number.center(64, 32), DVec2::new(650.0, 170.0));
        // The smallest that covers 64 intervals, with samples as near as it takes; and 2 x 1 squares where none does.
        assert_eq!(of(&[33, 65, 129], Some(10.0)).cols, 65);
        let finer = of(&[33, 65, 129], Some(9.9));
        assert_eq!((finer.cols, finer.cell.x), (129, 5.0));
        let tiles = of(&[33], Some(10.0));
        assert_eq!((tiles.cols, tiles.rows), (65, 33));
        let any = of(&[], Some(10.0));
        assert_eq!((any.cols, any.rows), (65, 31));
    }
}
