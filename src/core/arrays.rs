//! Lines as ragged arrays: one array of coordinates, one of offsets, one of elevations. Triangles as two arrays.
//!
//! This is how numerical libraries hold lines of different length, and what a binding to another language takes and
//! gives. Line `k` has the coordinates from `offsets[k]` to before `offsets[k + 1]`, so there is one offset more than
//! there are lines; the first is 0, the last is the number of coordinates.

use glam::DVec2;

use crate::base::error::{ArrayFault, Error, Result};
use crate::contour::{Contour, ContourLayer, ContourLine};
use crate::crs::FromWorking;
use crate::mesh::Mesh;

/// Lines as ragged arrays.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RaggedLines {
    /// x (east) and y (north) of the vertices of all lines, one line after the other.
    pub coords: Vec<[f64; 2]>,
    /// Where each line starts in `coords`, and at the end the number of coordinates.
    pub offsets: Vec<usize>,
    /// The elevation of each line, metres; in an output with another unit, in that.
    pub elevations: Vec<f64>,
}

impl RaggedLines {
    /// Checks that the arrays fit each other.
    ///
    /// # Errors
    /// [`Error::Arrays`] with the first fault.
    pub fn validate(&self) -> Result<()> {
        validate(self.coords.len(), &self.offsets, self.elevations.len())
    }

    /// Number of lines.
    pub fn len(&self) -> usize {
        self.elevations.len()
    }

    /// Whether there is no line.
    pub fn is_empty(&self) -> bool {
        self.elevations.is_empty()
    }

    /// The coordinates of a line.
    pub fn line(&self, k: usize) -> &[[f64; 2]] {
        &self.coords[self.offsets[k]..self.offsets[k + 1]]
    }

    /// Lines whose vertices are converted by `place`.
    fn of(lines: &[ContourLine], mut place: impl FnMut(&ContourLine, DVec2) -> Result<DVec2>) -> Result<Self> {
        let vertices = lines.iter().map(|line| line.points.len()).sum();
        let mut coords = Vec::with_capacity(vertices);
        let mut offsets = Vec::with_capacity(lines.len() + 1);
        offsets.push(0);
        for line in lines {
            for &p in &line.points {
                coords.push(place(line, p)?.to_array());
            }
            offsets.push(coords.len());
        }
        Ok(Self { coords, offsets, elevations: lines.iter().map(|line| line.elevation).collect() })
    }
}

impl ContourLayer {
    /// The lines as ragged arrays, in their order, on the working plane. Every coordinate is copied once.
    pub fn to_arrays(&self) -> RaggedLines {
        RaggedLines::of(&self.lines, |_, p| Ok(p)).unwrap_or_default()
    }

    /// The same in the coordinates and the unit of heights of an output. Vertices of the input get their original
    /// coordinates, bit for bit.
    ///
    /// # Errors
    /// [`Error::Data`] if a vertex has no place in the output's coordinate reference system.
    pub fn to_arrays_in(&self, output: &FromWorking) -> Result<RaggedLines> {
        let mut arrays = RaggedLines::of(&self.lines, |line, p| {
            output.place(p).ok_or_else(|| {
                let name = output.crs().and_then(|crs| crs.name()).unwrap_or_default();
                let elevation = line.elevation;
                Error::Data(format!("contour {elevation} m: {:.3} {:.3} has no place in {name}", p.x, p.y))
            })
        })?;
        arrays.elevations.iter_mut().for_each(|elevation| *elevation = output.height(*elevation));
        Ok(arrays)
    }
}

/// Triangles as arrays.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriangleArrays {
    /// x (east), y (north) and z (up, metres) of the vertices, map coordinates.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of the triangles, as indices of vertices.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The vertices and triangles as arrays. Vertices are copied once, as the origin is added to them; triangles are
    /// moved.
    pub fn into_arrays(self) -> TriangleArrays {
        let vertices = self.vertices.iter().map(|v| (*v + self.origin).to_array()).collect();
        TriangleArrays { vertices, triangles: self.triangles }
    }
}

/// Ragged arrays as contours. Every coordinate is copied once.
#[doc(hidden)]
pub fn contours(coords: &[[f64; 2]], offsets: &[usize], elevations: &[f64]) -> Result<Vec<Contour>> {
    validate(coords.len(), offsets, elevations.len())?;
    let lines = offsets.windows(2).zip(elevations).zip(0..);
    let contour = |((ends, &elevation), feature): ((&[usize], &f64), u64)| {
        let points = coords[ends[0]..ends[1]].iter().map(|p| DVec2::from_array(*p)).collect();
        Contour { elevation, points, feature: feature.into() }
    };
    Ok(lines.map(contour).collect())
}

fn validate(coordinates: usize, offsets: &[usize], elevations: usize) -> Result<()> {
    let fault = match offsets {
        _ if offsets.len() != elevations + 1 => ArrayFault::Lengths { offsets: offsets.len(), elevations },
        [first, ..] if *first != 0 => ArrayFault::Start(*first),
        [.., last] if offsets.is_sorted() && *last == coordinates => return Ok(()),
        [.., last] if offsets.is_sorted() => ArrayFault::End { last: *last, coordinates },
        _ => ArrayFault::Descending(1 + offsets.windows(2).take_while(|w| w[0] <= w[1]).count()),
    };
    Err(fault.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Source;

    #[test]
    fn lines_come_back_from_their_arrays() {
        let coords = [[0.0, 1.0], [2.0, 3.0], [4.0, 5.0], [6.0, 7.0], [8.0, 9.0]];
        let lines = contours(&coords, &[0, 2, 2, 5], &[10.0, 20.0, 30.0]).unwrap();
        assert_eq!(lines.iter().map(|line| line.points.len()).collect::<Vec<_>>(), [2, 0, 3]);
        assert_eq!(lines.iter().map(|line| line.feature).collect::<Vec<_>>(), [0, 1, 2]);
        let line = |c: &Contour| ContourLine {
            elevation: c.elevation,
            points: c.points.clone(),
            source: Source::Input,
            index: false,
            kind: None,
            depression: false,
            expected: None,
        };
        let layer = ContourLayer { lines: lines.iter().map(line).collect(), ..ContourLayer::default() };
        let arrays = layer.to_arrays();
        assert_eq!((&arrays.coords[..], &arrays.offsets[..]), (&coords[..], &[0, 2, 2, 5][..]));
        assert_eq!(arrays.elevations, [10.0, 20.0, 30.0]);
        assert_eq!((arrays.len(), arrays.line(2)), (3, &coords[2..]));
        arrays.validate().unwrap();
        assert_eq!(ContourLayer::default().to_arrays().offsets, [0]);
    }

    #[test]
    fn arrays_that_do_not_fit_are_refused_with_what_is_wrong() {
        let coords = [[0.0; 2]; 4];
        let fault = |offsets: &[usize], elevations: &[f64]| match contours(&coords, offsets, elevations) {
            Err(Error::Arrays(fault)) => fault,
            other => panic!("{other:?}"),
        };
        assert_eq!(fault(&[], &[]), ArrayFault::Lengths { offsets: 0, elevations: 0 });
        assert_eq!(fault(&[0, 4], &[1.0, 2.0]), ArrayFault::Lengths { offsets: 2, elevations: 2 });
        assert_eq!(fault(&[1, 4], &[1.0]), ArrayFault::Start(1));
        assert_eq!(fault(&[0, 3, 2, 4], &[1.0; 3]), ArrayFault::Descending(2));
        assert_eq!(fault(&[0, 3, 5], &[1.0; 2]), ArrayFault::End { last: 5, coordinates: 4 });
        assert_eq!(fault(&[0, 3], &[1.0]), ArrayFault::End { last: 3, coordinates: 4 });
    }
}
