//! Few triangles within a tolerance of the heights of cells: greedy insertion (Garland and Heckbert 1995, *Fast polygonal
//! approximation of terrains and height fields*, CMU-CS-95-181), in rounds.
//!
//! 1. It begins with the outline of the ground and the lines that are kept, triangulated (`ground`). Lines get a vertex where they
//!    cross (`noded`).
//! 2. Each triangle that has changed looks through its cells, row by row, for the one that is furthest from it (`errors`). All cores
//!    do so at the same time.
//! 3. Where the error is at least half of the largest one, the cell becomes a vertex (`network`). So cells with large errors come
//!    first, as if they were looked for one by one. A triangle that another vertex has changed in this round waits for the next one.
//! 4. When no cell is further than the tolerance, all triangles look once more, and it goes on if one is too far from a cell.
//!
//! All places are in cells: x is the column, y the negative row. So the centres of cells have whole numbers.

mod errors;
mod ground;
mod network;
mod noded;

use glam::{DVec2, DVec3};

use super::outline::Outline;
use crate::base::error::{Error, Result};
use crate::base::parallel;
use crate::raster::Dem;
use crate::tin::{NONE, Tin};
use network::Network;

/// A place that is nearer to a cell's centre or to an edge than this lies on it, in cells: a tolerance of rounding.
const ON: f64 = 1e-6;

/// The triangles of the ground inside an outline, none of them further than `tolerance` (metres) from the height of a
/// cell whose centre it covers. The outline keeps its corners; between them, its heights are within half of the tolerance.
///
/// # Errors
/// [`Error::OutOfRange`] for a tolerance that is not above 0. [`Error::Data`] if the triangles do not come within the tolerance. As
/// [`triangulate`](crate::tin::triangulate).
pub(super) fn light(outline: &Outline, dem: &Dem, tolerance: f64) -> Result<Tin> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(Error::out_of_range("tolerance", tolerance, "more than 0"));
    }
    if dem.grid.len() >= u32::MAX as usize {
        return Err(Error::Data("the height map has more cells than 32-bit indices can count".into()));
    }
    let (mut network, vertices) = ground::triangles(outline, dem, tolerance)?;
    // The second pass only finds something if a cell changed its triangle unseen.
    while refine(&mut network, dem, tolerance)? {
        network.forget();
    }
    Ok(tin(network, vertices, dem, outline.origin))
}

/// Makes vertices of cells until no triangle is known to be above the tolerance. Whether one was.
fn refine(network: &mut Network, dem: &Dem, tolerance: f64) -> Result<bool> {
    let cols = dem.grid.cols;
    let (mut open, mut is_refined) = (Vec::new(), false);
    loop {
        let changed = network.take_changed();
        let found = parallel::map_each(&changed, |&t| errors::worst(network, t, dem, tolerance));
        for (t, worst) in changed.into_iter().zip(found) {
            network.note(t, worst);
            open.extend((worst.error > 0.0).then_some(t));
        }
        let known = open.iter().filter_map(|&t| network.known(t));
        let limit = known.fold(0.0, |largest: f32, worst| largest.max(worst.error)) / 2.0;
        if open.is_empty() {
            return Ok(is_refined);
        }
        for &t in &open {
            let Some(worst) = network.known(t).filter(|worst| worst.error >= limit) else { continue };
            let (col, row) = (worst.cell as usize % cols, worst.cell as usize / cols);
            let place = DVec3::new(col as f64, -(row as f64), f64::from(dem.values[worst.cell as usize]));
            if !network.insert(t, place) {
                let place = dem.grid.center(col, row);
                return Err(Error::Data(format!(
                    "the triangles do not come within {tolerance} m of the surface at {:.3} {:.3}: choose another cell",
                    place.x, place.y
                )));
            }
        }
        open.retain(|&t| network.known(t).is_some());
        is_refined = true;
    }
}

/// The triangles as a triangulation. The first vertices are those that it began with, relative to the origin; the others are cells.
fn tin(network: Network, first: Vec<DVec3>, dem: &Dem, origin: DVec2) -> Tin {
    let cells = network.places[first.len()..].iter().map(|place| {
        let (col, row) = (place.x as usize, (-place.y) as usize);
        (dem.grid.center(col, row) - origin).extend(place.z)
    });
    let vertices: Vec<DVec3> = first.iter().copied().chain(cells).collect();
    let triangle = |side: u32| if side == NONE { NONE } else { side / 3 };
    let count = network.corners.len();
    Tin {
        origin,
        positions: vertices.iter().map(|v| v.truncate()).collect(),
        heights: vertices.iter().map(|v| v.z).collect(),
        neighbours: network.beyond.into_iter().map(|sides| sides.map(triangle)).collect(),
        triangles: network.corners,
        edges: vec![0; count],
        inside: vec![true; count],
        ..Tin::default()
    }
}

#[cfg(test)]
mod tests;
