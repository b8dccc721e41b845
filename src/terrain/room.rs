//! Refuses height maps that are too large before the lines are prepared, which takes most of the time on a large map.

use geo::{BooleanOps, BoundingRect, Coord, MultiPolygon, Rect};
use glam::DVec2;

use super::grid::{Cells, GridSpec};
use super::input::Input;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::check::far_lines;
use tokosen_core::clean::is_place;
use tokosen_core::geometry::contains_area;
use tokosen_core::subdomains::FrameRing;

/// Share of all vertices that may lie far off to one side by mistake. The preparation can leave them out, and the map is
/// then smaller.
const ASTRAY: f64 = 0.01;

impl Input {
    /// Refuses a height map over the map as it was read, if it can be made neither of all lines nor of all but some stray
    /// ones. [`Terrain::build`](super::Terrain::build) checks the exact size after the preparation.
    ///
    /// # Errors
    /// [`Error::TooManyCells`], and [`Error::OutOfMemory`] if it needs more than `memory` bytes.
    pub fn check_room(&self, grid: &GridSpec, memory: Option<u64>) -> Result<()> {
        // Other errors come from the steps that they belong to.
        let Ok(cells) = grid.over(&self.reprojection) else { return Ok(()) };
        let checked = check(&cells, self.covered(0.0), memory);
        if checked.is_ok() || check(&cells, self.covered(ASTRAY), memory).is_ok() {
            return Ok(());
        }
        checked.map_err(|error| {
            let mut far = far_lines(&self.map);
            far.iter_mut().for_each(|finding| finding.message = self.units().message(&finding.message));
            error.because_of_far_lines(&far)
        })
    }

    /// The ground that a height map covers at least, without a share of the vertices at each side of the map.
    fn covered(&self, share: f64) -> Option<FrameRing> {
        let places = || self.map.places().filter(|p| is_place(*p));
        let [x, y] = [DVec2::X, DVec2::Y].map(|axis| range(places().map(|p| p.dot(axis)).collect(), share));
        let ((west, east), (south, north)) = (x?, y?);
        let rect = Rect::new(Coord { x: west, y: south }, Coord { x: east, y: north });
        let mut area: MultiPolygon<f64> = rect.to_polygon().into();
        for other in self.frame.polygon().into_iter().chain(&self.part) {
            area = if contains_area(&area, other) { other.clone() } else { area.intersection(other) };
        }
        area.bounding_rect().map(|_| FrameRing { area })
    }
}

/// The least and the greatest number, without a share of them at each end.
fn range(mut numbers: Vec<f64>, share: f64) -> Option<(f64, f64)> {
    let last = numbers.len().checked_sub(1)?;
    let off = (share * last as f64).ceil() as usize;
    let mut at = |k: usize| *numbers.select_nth_unstable_by(k, f64::total_cmp).1;
    (2 * off <= last).then(|| (at(off), at(last - off)))
}

fn check(cells: &Cells, ground: Option<FrameRing>, memory: Option<u64>) -> Result<()> {
    let Some(ground) = ground else { return Ok(()) };
    match cells.check_room(&ground, false, memory) {
        Err(error) if matches!(error.root(), Error::TooManyCells { .. } | Error::OutOfMemory { .. }) => Err(error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::InputOptions;
    use tokosen_core::contour::{Contour, ContourMap};
    use tokosen_core::subdomains::Frame;

    /// Rings of 1 km around the origin, and a line with these points.
    fn input(others: &[(f64, f64)]) -> Input {
        let ring = |k: u32| {
            let at =
                |j: u32| f64::from(500 - 10 * k) * DVec2::from_angle(f64::from(j % 90) * std::f64::consts::TAU / 90.0);
            Contour { elevation: f64::from(k), points: (0..=90).map(at).collect(), feature: 0.into() }
        };
        let mut contours: Vec<Contour> = (0..10).map(ring).collect();
        contours.push(Contour {
            elevation: 0.0,
            points: others.iter().map(|&p| p.into()).collect(),
            feature: 1.into(),
        });
        Input::from_map(ContourMap { contours, ..ContourMap::default() }, &InputOptions::default()).unwrap()
    }

    #[test]
    fn too_many_cells_are_refused_before_the_lines_are_prepared() {
        let plain = input(&[]);
        let refused = |input: &Input, size: f64, memory: Option<u64>| input.check_room(&GridSpec::Cell(size), memory);
        assert!(refused(&plain, 1.0, None).is_ok());
        assert!(matches!(refused(&plain, 1e-3, None), Err(Error::TooManyCells { cols, .. }) if cols == 1e6));
        assert!(matches!(refused(&plain, 1.0, Some(1_000_000)), Err(Error::OutOfMemory { .. })));
        // A size that is no size, and cells larger than the map, are errors of other steps.
        assert!(refused(&plain, -1.0, None).is_ok() && refused(&plain, 1e9, None).is_ok());
    }

    #[test]
    fn a_stray_vertex_does_not_count() {
        let far = input(&[(400.0, 0.0), (1e9, 1e9), (401.0, 0.0)]);
        assert!(far.check_room(&GridSpec::Cell(1.0), None).is_ok());
        assert!(far.check_room(&GridSpec::Cell(1e-3), None).is_err());
    }

    #[test]
    fn only_the_ground_that_is_asked_for_counts() {
        let mut part = input(&[]);
        let square = |half: f64| {
            let [lo, hi] = [-half, half].map(|v| Coord { x: v, y: v });
            MultiPolygon::from(Rect::new(lo, hi).to_polygon())
        };
        part.frame = Frame::Polygon(square(5.0));
        assert!(part.check_room(&GridSpec::Cell(1e-3), None).is_ok());
        part.frame = Frame::Polygon(square(50.0));
        assert!(part.check_room(&GridSpec::Cell(1e-3), None).is_err());
        part.set_part(&square(5.0), None).unwrap();
        assert!(part.check_room(&GridSpec::Cell(1e-3), None).is_ok());
    }
}
