//! Reads heights as plain text (`.xyz`): one line `x y height` per cell, in any order, for the centres of a regular grid.
//!
//! The numbers are separated by spaces, tabs, commas or semicolons. A first line of names and lines that begin with `#` are
//! passed over. Cells without a line have no data. The distances between the coordinates give the size of the cells. Points
//! that are no grid are refused: they are spot heights.

use std::collections::HashSet;
use std::path::Path;

use glam::DVec2;

use super::heights::{Coding, Heights, room};
use super::sidecar::read_prj;
use crate::text;
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Report, Result};
use tokosen_core::raster::Dem;

/// The largest distance of a point from the centre of its cell, cells. Coordinates are rounded.
const OFF_CENTRE: f64 = 0.1;
/// The largest number of columns or rows.
const MAX_LINES: usize = 1 << 20;
/// In a raster, most cells with data have one beside them; among points, few have.
const LEAST_BESIDE: f64 = 0.5;

/// What to do with points that are no raster.
const NOT_A_RASTER: &str = "they are no raster: take them as spot heights (points), or make a raster of them first";

pub(super) fn read(path: &Path) -> Result<Report<Dem>> {
    let bytes = text::read(path, None, |_| None)?;
    let text = String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes));
    let (mut x, mut y) = (Axis::default(), Axis::default());
    for_each_point(path, &text, |_, p| {
        x.note(p[0]);
        y.note(p[1]);
        if x.seen.len().max(y.seen.len()) > MAX_LINES {
            return Err(Error::file(
                path,
                format!("its points have more than {MAX_LINES} different coordinates; {NOT_A_RASTER}"),
            ));
        }
        Ok(())
    })?;
    let (x, y) = (x.spaced(path, "x")?, y.spaced(path, "y")?);
    let (x, y) = match (x, y) {
        (Some(x), Some(y)) => (x, y),
        // A single row or column has square cells.
        (Some(x), None) => (x, Spaced { step: x.step, ..Spaced::one(&y_of(&text, path)?) }),
        (None, Some(y)) => (Spaced { step: y.step, ..Spaced::one(&x_of(&text, path)?) }, y),
        (None, None) => return Err(Error::file(path, format!("has a single point; {NOT_A_RASTER}"))),
    };
    let mut values = room(path, x.count as u64, y.count as u64, bytes.len() as u64)?;
    let mut heights = Heights::new(Coding { nodata: None, scale: 1.0, offset: 0.0 });
    for_each_point(path, &text, |line, p| {
        let (Some(col), Some(row)) = (x.index(p[0]), y.index(p[1])) else {
            let message = format!(
                "line {line}: the point {} {} is not on the grid of {} x {} that the other points are on; {NOT_A_RASTER}",
                p[0], p[1], x.step, y.step
            );
            return Err(Error::file(path, message));
        };
        let cell = &mut values[(y.count - 1 - row) * x.count + col];
        let height = heights.height(p[2]);
        if !cell.is_nan() && cell.to_bits() != height.to_bits() {
            let message =
                format!("line {line}: the point {} {} has a second height, {} beside {}", p[0], p[1], p[2], cell);
            return Err(Error::file(path, message));
        }
        *cell = height;
        Ok(())
    })?;
    check_neighbours(path, &values, x.count)?;
    let cell = DVec2::new(x.step, y.step);
    let corner = DVec2::new(x.first - 0.5 * x.step, y.first + (y.count as f64 - 0.5) * y.step);
    let grid = Grid { corner, cell, cols: x.count, rows: y.count };
    Ok(Report { value: Dem { grid, values, crs: read_prj(path)? }, findings: heights.finding().into_iter().collect() })
}

/// Calls `visit` with the number of each line and its point.
fn for_each_point(path: &Path, text: &str, mut visit: impl FnMut(usize, [f64; 3]) -> Result<()>) -> Result<()> {
    let mut is_first = true;
    for (number, line) in (1..).zip(text.lines()) {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let mut words = line.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|word| !word.is_empty());
        let mut next = || words.next().and_then(|word| word.parse::<f64>().ok());
        let point = [next(), next(), next()];
        let is_header = std::mem::replace(&mut is_first, false) && point == [None; 3];
        match point {
            _ if is_header => {}
            [Some(x), Some(y), Some(z)] if x.is_finite() && y.is_finite() => visit(number, [x, y, z])?,
            _ => {
                let message = format!(
                    "line {number}: {:?} is not x, y and height",
                    line.trim().chars().take(40).collect::<String>()
                );
                return Err(Error::file(path, message));
            }
        }
    }
    if is_first { Err(Error::empty(path)) } else { Ok(()) }
}

fn x_of(text: &str, path: &Path) -> Result<f64> {
    coordinate(text, path, 0)
}

fn y_of(text: &str, path: &Path) -> Result<f64> {
    coordinate(text, path, 1)
}

/// A coordinate that all points share.
fn coordinate(text: &str, path: &Path, which: usize) -> Result<f64> {
    let mut found = 0.0;
    for_each_point(path, text, |_, p| {
        found = p[which];
        Ok(())
    })?;
    Ok(found)
}

/// The different coordinates along one axis, by their bits.
#[derive(Default)]
struct Axis {
    seen: HashSet<u64>,
    last: u64,
}

/// Coordinates with one step between them.
#[derive(Debug, Clone, Copy)]
struct Spaced {
    first: f64,
    step: f64,
    count: usize,
}

impl Axis {
    fn note(&mut self, value: f64) {
        // -0 and 0 are one place.
        let bits = (value + 0.0).to_bits();
        // Lines are mostly in rows: the last coordinate comes again and again.
        if bits != self.last || self.seen.is_empty() {
            self.last = bits;
            self.seen.insert(bits);
        }
    }

    /// The coordinates with their step; `None` if there is only one.
    fn spaced(self, path: &Path, name: &str) -> Result<Option<Spaced>> {
        let mut values: Vec<f64> = self.seen.into_iter().map(f64::from_bits).collect();
        values.sort_by(f64::total_cmp);
        let (Some(&first), Some(&last)) = (values.first(), values.last()) else { return Ok(None) };
        let least = values.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        if !least.is_finite() {
            return Ok(None);
        }
        // Rounded coordinates have steps that differ in their last digits: each is counted by itself, and the whole length
        // gives the step.
        let count: f64 = values.windows(2).map(|pair| ((pair[1] - pair[0]) / least).round()).sum();
        let step = (last - first) / count;
        if count >= MAX_LINES as f64 || !step.is_finite() || step <= 0.0 {
            let message =
                format!("its points are {least} apart in {name} at the least, over {}; {NOT_A_RASTER}", last - first);
            return Err(Error::file(path, message));
        }
        Ok(Some(Spaced { first, step, count: count as usize + 1 }))
    }
}

impl Spaced {
    fn one(value: &f64) -> Self {
        Self { first: *value, step: 0.0, count: 1 }
    }

    fn index(&self, value: f64) -> Option<usize> {
        let place = (value - self.first) / self.step;
        let index = place.round();
        ((place - index).abs() <= OFF_CENTRE && (0.0..self.count as f64).contains(&index)).then_some(index as usize)
    }
}

/// Refuses points that happen to lie on a fine grid: coordinates in whole centimetres, for instance.
fn check_neighbours(path: &Path, values: &[f32], cols: usize) -> Result<()> {
    let rows: Vec<&[f32]> = values.chunks_exact(cols).collect();
    let (mut with_data, mut beside) = (0_u64, 0_u64);
    for (k, row) in rows.iter().enumerate() {
        let has = |row: Option<&&[f32]>, col: usize| row.is_some_and(|row| row.get(col).is_some_and(|v| !v.is_nan()));
        for col in (0..cols).filter(|&col| !row[col].is_nan()) {
            with_data += 1;
            let left = col.checked_sub(1).is_some_and(|col| has(Some(row), col));
            let above = k.checked_sub(1).is_some_and(|k| has(rows.get(k), col));
            beside += u64::from(left || above || has(Some(row), col + 1) || has(rows.get(k + 1), col));
        }
    }
    if (beside as f64) < LEAST_BESIDE * with_data as f64 {
        let message =
            format!("{} of its {with_data} points have no point beside them; {NOT_A_RASTER}", with_data - beside);
        return Err(Error::file(path, message));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::tests::sample;
    use super::super::write_dem;
    use super::*;

    fn of(text: &str) -> Result<Dem> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.xyz");
        std::fs::write(&path, text).unwrap();
        Ok(read(&path)?.value)
    }

    #[test]
    fn what_is_written_comes_back() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.xyz");
        let dem = sample(17, 11);
        write_dem(&path, &dem).unwrap();
        let back = read(&path).unwrap().value;
        assert_eq!((back.grid.cols, back.grid.rows), (17, 11));
        assert!(back.grid.corner.distance(dem.grid.corner) < 1e-6 && back.grid.cell.distance(dem.grid.cell) < 1e-9);
        assert!(
            back.values.iter().zip(&dem.values).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
        );
    }

    #[test]
    fn any_order_separator_and_header() {
        let expected = [1.0_f32, 2.0, f32::NAN, 4.0, 5.0, 6.0];
        for text in [
            "0 10 1\n5 10 2\n0 5 4\n5 5 5\n10 5 6\n",
            "X,Y,Z\r\n10,5,6\r\n5,5,5\r\n0,5,4\r\n5,10,2\r\n0,10,1\r\n",
            "# made by hand\n0;10;1\n5;10;2\n\n0\t5\t4\n5 5 5 255 0 0\n1e1 5 6\n10 10 -9999\n",
        ] {
            let dem = of(text).unwrap();
            assert_eq!(dem.grid, Grid { corner: DVec2::new(-2.5, 12.5), cell: DVec2::splat(5.0), cols: 3, rows: 2 });
            assert!(dem.values.iter().zip(&expected).all(|(a, b)| a == b || a.is_nan() && b.is_nan()), "{text}");
        }
        // Rounded degrees.
        let text: String = (0..60)
            .map(|i| format!("{:.5} {:.5} 7\n", 11.0 + f64::from(i % 10) / 3600.0, 47.0 + f64::from(i / 10) / 3600.0))
            .collect();
        let dem = of(&text).unwrap();
        assert_eq!((dem.grid.cols, dem.grid.rows), (10, 6));
        assert!((dem.grid.cell.x * 3600.0 - 1.0).abs() < 0.01);
        let row = of("0 0 1\n2 0 2\n").unwrap().grid;
        assert_eq!((row.cols, row.rows, row.cell), (2, 1, DVec2::splat(2.0)));
    }

    #[test]
    fn what_is_no_raster_is_refused_with_the_reason() {
        // Points in whole metres.
        let scattered: String = (0..200_u32)
            .map(|i| format!("{} {} 5\n", i * 7919 % 1009, i * 104_729 % 997))
            .chain(["2000 2000 5\n2001 2001 5\n".to_owned()])
            .collect();
        for (text, words) in [
            ("", "empty"),
            ("0 0 1\n", "a single point"),
            ("0 0 1\n5 0\n", "line 2"),
            ("0 0 1\nx y z\n", "line 2"),
            ("0 0 1\n5 0 1\n7 0 1\n0 5 1\n", "spot heights"),
            ("0 0 1\n5 0 1\n0 5 1\n5 0 2\n", "line 4: the point 5 0 has a second height, 2 beside 1"),
            (&scattered, "no point beside them"),
            ("0 0 1\n1e-9 0 1\n1e9 0 1\n0 1 1\n", "apart in x"),
        ] {
            let error = of(text).map(|dem| dem.grid).unwrap_err().to_string();
            assert!(error.contains(words), "{words}: {error}");
        }
    }
}
