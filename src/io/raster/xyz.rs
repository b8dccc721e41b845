//! Heights as plain text (`.xyz`): one line `x y height` for the centre of every cell with data, row by row from the
//! north-west. There is no header. Cells without data have no line.

use std::io::Write;
use std::path::Path;

use super::output::create;
use super::quantity::Values;
use tokosen_core::base::error::Result;
use tokosen_core::raster::Dem;

/// Writes `dem` to `path`. All numbers have enough digits to give exactly the same number again.
pub(super) fn write(path: &Path, dem: &Dem, _: Values) -> Result<()> {
    let grid = dem.grid;
    let x: Vec<f64> = (0..grid.cols).map(|col| grid.center(col, 0).x).collect();
    create(path, |out| {
        for (row, heights) in dem.values.chunks_exact(grid.cols).enumerate() {
            let y = grid.center(0, row).y;
            for (x, height) in x.iter().zip(heights).filter(|(_, height)| height.is_finite()) {
                writeln!(out, "{x} {y} {height}")?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::super::quantity::Quantity;
    use super::super::tests::sample;
    use super::*;

    #[test]
    fn every_cell_with_data_has_a_line_with_its_centre() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.xyz");
        let dem = sample(7, 5);
        write(&path, &dem, Quantity::Height.into()).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<Vec<f64>> =
            text.lines().map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect();
        assert_eq!(lines.len(), 34);
        let cells = (0..35).filter(|&i| i != 8);
        for (line, i) in lines.iter().zip(cells) {
            let center = dem.grid.center(i % 7, i / 7);
            assert_eq!(line[..], [center.x, center.y, dem.values[i].into()]);
        }
    }
}
