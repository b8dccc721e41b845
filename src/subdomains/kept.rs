//! Keeps the bands of sub-domains when points are added to the triangulation.
//!
//! The finer triangulation has the same sub-domains. Heights were already computed for their bands, so the bands must
//! stay. A second search for the bands could give others.

use rayon::prelude::*;

use super::{Region, Regions};
use crate::tin::Tin;

/// The sub-domains of a triangulation, known by their borders.
///
/// Every finer triangulation holds the border edges too, between vertices with the same numbers.
#[derive(Debug, Clone)]
pub struct KeptBands {
    /// Directed edges, as pairs of vertices, with the sub-domain on the left; ascending.
    borders: Vec<([u32; 2], u32)>,
    regions: Vec<Region>,
}

impl KeptBands {
    /// Takes those of `regions`.
    pub fn new(tin: &Tin, regions: Regions) -> Self {
        let of_triangle = &regions.of_triangle;
        let inside = (0..tin.len() as u32).into_par_iter().filter(|&t| tin.is_inside(t));
        let of_triangle = |t: u32| borders_of(tin, t).map(move |edge| (edge, of_triangle[t as usize]));
        let mut borders: Vec<_> = inside.flat_map_iter(of_triangle).collect();
        borders.par_sort_unstable();
        Self { borders, regions: regions.regions }
    }

    /// The sub-domains of a finer triangulation, `regions`, with the levels and bands of this one. Also whether all of
    /// them were found.
    pub fn applied(&self, tin: &Tin, mut regions: Regions) -> (Regions, bool) {
        let mut is_known = vec![false; regions.regions.len()];
        for (t, edge) in borders(tin) {
            let id = regions.of_triangle[t as usize] as usize;
            if is_known[id] {
                continue;
            }
            if let Ok(k) = self.borders.binary_search_by(|(e, _)| e.cmp(&edge)) {
                is_known[id] = true;
                let kept = self.regions[self.borders[k].1 as usize].clone();
                regions.regions[id] = Region { triangle: regions.regions[id].triangle, ..kept };
            }
        }
        (regions, is_known.into_iter().all(|is_known| is_known))
    }
}

/// Triangles with an edge on the border of their sub-domain, and that edge.
fn borders(tin: &Tin) -> impl Iterator<Item = (u32, [u32; 2])> + '_ {
    let inside = (0..tin.len() as u32).filter(|&t| tin.is_inside(t));
    inside.flat_map(move |t| borders_of(tin, t).map(move |edge| (t, edge)))
}

/// The edges of a triangle on the border of its sub-domain.
fn borders_of(tin: &Tin, t: u32) -> impl Iterator<Item = [u32; 2]> + '_ {
    (0..3).filter(move |&i| tin.across(t, i).is_none()).map(move |i| tin.edge(t, i))
}
