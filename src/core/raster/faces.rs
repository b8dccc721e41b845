//! The height map of triangles that somebody else made: a design surface, a survey.

use glam::{DVec2, DVec3};

use super::height_map::Dem;
use super::rasterise::rasterise;
use crate::base::Grid;
use crate::base::error::{Error, Result};
use crate::base::progress::Progress;
use crate::tin::{NONE, Tin, VertexKind};

/// The most cells that are made without a cell size being asked for.
const MOST_CELLS: f64 = 25e6;
/// The fewest cells, about. Surfaces of few large triangles have exact edges only in small cells.
const FEWEST_CELLS: f64 = 1e6;
/// Cells for a triangle of median size.
const CELLS_PER_TRIANGLE: f64 = 4.0;

/// Heights of triangles at the centres of square cells; NaN where there is no triangle. Where triangles lie upon each other, the
/// first one counts.
///
/// A triangle of median size gets about four cells, and the box around all triangles at least a million. The size of a cell is 1, 2
/// or 5 times a power of ten, and it is larger if there were more than 25 million cells.
///
/// # Errors
/// No triangle has an area, or they reach too far.
pub fn rasterise_faces(points: &[DVec3], faces: &[[u32; 3]], progress: &dyn Progress) -> Result<Dem> {
    let origin = points.first().map_or(DVec2::ZERO, |point| point.truncate());
    let positions: Vec<DVec2> = points.iter().map(|point| point.truncate() - origin).collect();
    let area = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|v| positions[v as usize]);
        (b - a).perp_dot(c - a) / 2.0
    };
    // Of walls, which have no area, a height map cannot tell.
    let triangles: Vec<[u32; 3]> = faces
        .iter()
        .filter(|face| area(face) != 0.0)
        .map(|face| if area(face) > 0.0 { *face } else { [face[0], face[2], face[1]] })
        .collect();
    let mut areas: Vec<f64> = triangles.iter().map(area).collect();
    areas.sort_by(f64::total_cmp);
    let corners = || triangles.iter().flatten().map(|v| positions[*v as usize] + origin);
    let Some(median) = areas.get(areas.len() / 2) else {
        return Err(Error::Data("no triangle has an area".into()));
    };
    let (lo, hi) = corners().fold((DVec2::MAX, DVec2::MIN), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let area = (median / CELLS_PER_TRIANGLE).min((hi - lo).element_product() / FEWEST_CELLS);
    let cell = cell_size(area.sqrt(), hi - lo)
        .ok_or_else(|| Error::Data("the triangles reach further than a map can: a coordinate is wrong".into()))?;
    let tin = Tin {
        origin,
        heights: points.iter().map(|point| point.z).collect(),
        kinds: vec![VertexKind::Spot; points.len()],
        source: (0..points.len() as u32).collect(),
        neighbours: vec![[NONE; 3]; triangles.len()],
        edges: vec![0; triangles.len()],
        inside: vec![true; triangles.len()],
        lakes: Vec::new(),
        positions,
        triangles,
    };
    Ok(rasterise(&tin, &Grid::on_multiples(lo, hi, cell), None, progress))
}

/// The largest round size that is at most `wanted`, or the smallest one that keeps the number of cells. `None` if none does.
fn cell_size(wanted: f64, extent: DVec2) -> Option<f64> {
    let round = || (-9..10).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(power)));
    let smallest = round().find(|size| (extent / *size).ceil().element_product() <= MOST_CELLS)?;
    round().take_while(|size| *size <= wanted).last().into_iter().chain([smallest]).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_those_of_the_triangles() {
        let of_plane = |x: f64, y: f64| DVec3::new(x, y, 100.0 + 0.1 * x - 0.2 * y);
        let points = [of_plane(0.0, 0.0), of_plane(100.0, 0.0), of_plane(100.0, 60.0), of_plane(0.0, 60.0)];
        // One clockwise, one the other way, and one without area.
        let dem = rasterise_faces(&points, &[[0, 1, 2], [0, 3, 2], [0, 0, 1]], &()).unwrap();
        assert_eq!((dem.grid.cell, dem.grid.cols, dem.grid.rows), (DVec2::splat(0.05), 2000, 1200));
        for (k, height) in dem.values.iter().enumerate() {
            let p = dem.grid.center(k % dem.grid.cols, k / dem.grid.cols);
            assert!((f64::from(*height) - of_plane(p.x, p.y).z).abs() < 1e-4, "{p} {height}");
        }
        assert!(rasterise_faces(&points, &[[0, 1, 1]], &()).is_err());
        assert!(rasterise_faces(&[], &[], &()).is_err());
    }

    #[test]
    fn outside_the_triangles_there_is_no_height() {
        let points = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(100.0, 0.0, 1.0), DVec3::new(0.0, 100.0, 1.0)];
        let dem = rasterise_faces(&points, &[[0, 1, 2]], &()).unwrap();
        let known = dem.values.iter().filter(|height| !height.is_nan()).count();
        assert_eq!((dem.grid.len(), known), (1_000_000, 500_500));
    }

    #[test]
    fn many_small_triangles_do_not_make_too_many_cells() {
        assert_eq!(cell_size(0.3, DVec2::splat(100.0)), Some(0.2));
        assert_eq!(cell_size(0.001, DVec2::splat(10_000.0)), Some(2.0));
        assert_eq!(cell_size(0.001, DVec2::splat(1e20)), None);
        assert_eq!(cell_size(f64::NAN, DVec2::splat(10.0)), Some(0.002));
    }
}
