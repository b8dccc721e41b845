//! Where the cells of a raster lie.

use glam::DVec2;

/// A raster's placement: north is up, row 0 is the northernmost, column 0 the westernmost.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
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
    /// Square cells that cover a box. Their edges lie on multiples of the cell size.
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

    /// Column and row of a map position as fractions: (0, 0) is the centre of the north-west cell, rows grow southwards.
    pub fn place(&self, p: DVec2) -> DVec2 {
        let first = self.center(0, 0);
        DVec2::new((p.x - first.x) / self.cell.x, (first.y - p.y) / self.cell.y)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_of_a_centre_is_its_column_and_row() {
        let grid = Grid { corner: DVec2::new(100.0, 50.0), cell: DVec2::new(2.0, 4.0), cols: 5, rows: 3 };
        assert_eq!(grid.place(grid.center(0, 0)), DVec2::ZERO);
        assert_eq!(grid.place(grid.center(4, 2)), DVec2::new(4.0, 2.0));
        assert_eq!(grid.place(grid.corner), DVec2::splat(-0.5));
        assert_eq!(grid.place(DVec2::new(102.0, 45.0)), DVec2::new(0.5, 0.75));
    }
}
