//! Carries the sub-domains over to a finer triangulation.
//!
//! A finer triangulation has more vertices and other triangles, but the borders of the sub-domains are edges of it too.
//! Each border edge knows the sub-domain on its left. So the triangles along the borders know theirs, and the others
//! take that of their neighbours. Nothing is searched again: a second search for bands or for the frame could give
//! others, because flat triangles along the frame change.

use rayon::prelude::*;

use super::{Region, Regions};
use crate::base::rows::Rows;
use crate::tin::{EDGE_FLAGS, NONE, Tin};

/// The sub-domains of a triangulation, known by their borders.
///
/// Every finer triangulation must hold the border edges too, between vertices with the same numbers. See
/// [`loose_frame_edges`] for those that it holds only if they are added.
#[derive(Debug, Clone)]
pub struct CarriedRegions {
    /// By the vertex that they start from.
    borders: Rows<BorderEdge>,
    regions: Regions,
    /// The lake of each sub-domain, [`NONE`] on land; empty without lakes.
    lakes: Vec<u32>,
}

impl Regions {
    /// The sub-domains after triangles were split: `parents` gives for each the one that it lies in.
    pub fn of_parts(self, parents: &[u32]) -> Self {
        by_first_triangle(parents.iter().map(|&t| self.of_triangle[t as usize]).collect(), self)
    }
}

/// A directed edge on the border of a sub-domain or of the frame.
#[derive(Debug, Clone, Copy, Default)]
struct BorderEdge {
    ends: [u32; 2],
    /// The sub-domain on the left, [`NONE`] outside the frame.
    region: u32,
    /// The flags of the edge, as those of a triangle's first edge.
    flags: u16,
}

impl CarriedRegions {
    /// Takes those of a triangulation.
    pub fn new(tin: &Tin, mut regions: Regions) -> Self {
        let of_triangle = std::mem::take(&mut regions.of_triangle);
        let borders = tin.flat_map_inside(|t| borders_of(tin, t, of_triangle[t as usize]));
        let borders =
            Rows::new(tin.positions.len(), || borders.iter().map(|border| (border.ends[0] as usize, *border)));
        let lakes = match regions.regions.iter().any(|region| tin.lake(region.triangle).is_some()) {
            true => regions.regions.iter().map(|region| tin.lake(region.triangle).unwrap_or(NONE)).collect(),
            false => Vec::new(),
        };
        Self { borders, regions, lakes }
    }

    /// The finer triangulation with the frame, the border edges and the lakes of this one, and its sub-domains.
    pub fn on(self, mut tin: Tin) -> (Tin, Regions) {
        let mut carried = vec![NONE; tin.len()];
        // One bit for each edge of a triangle.
        let mut on_border = vec![0_u8; tin.len()];
        let Tin { triangles, edges, .. } = &mut tin;
        let all = triangles.par_iter().zip(edges).zip(&mut carried).zip(&mut on_border);
        all.for_each(|(((corners, edges), carried), on_border)| {
            for i in 0..3 {
                if let Some(border) = self.border([corners[i], corners[(i + 1) % 3]]) {
                    *edges = *edges & !(EDGE_FLAGS << i) | (border.flags << i);
                    *carried = border.region;
                    *on_border |= 1 << i;
                }
            }
        });
        let mut stack: Vec<u32> = (0..tin.len() as u32).filter(|&t| carried[t as usize] != NONE).collect();
        while let Some(t) = stack.pop() {
            for i in 0..3 {
                let n = tin.neighbours[t as usize][i];
                if n != NONE && carried[n as usize] == NONE && on_border[t as usize] >> i & 1 == 0 {
                    carried[n as usize] = carried[t as usize];
                    stack.push(n);
                }
            }
        }
        tin.inside = carried.iter().map(|&region| region != NONE).collect();
        if !self.lakes.is_empty() {
            let lake = |&region: &u32| if region == NONE { NONE } else { self.lakes[region as usize] };
            tin.lakes = carried.iter().map(lake).collect();
        }
        let regions = by_first_triangle(carried, self.regions);
        (tin, regions)
    }

    fn border(&self, ends: [u32; 2]) -> Option<&BorderEdge> {
        self.borders.get(ends[0] as usize).iter().find(|border| border.ends == ends)
    }
}

/// The border edges of a triangle in the frame, seen from the sub-domain that it lies in. Those of the frame are seen from
/// outside too.
fn borders_of(tin: &Tin, t: u32, region: u32) -> impl Iterator<Item = BorderEdge> + '_ {
    (0..3).filter(move |&i| tin.across(t, i).is_none()).flat_map(move |i| {
        let ([u, v], flags) = (tin.edge(t, i), tin.edge_flags(t, i));
        let outside = BorderEdge { ends: [v, u], region: NONE, flags };
        [Some(BorderEdge { ends: [u, v], region, flags }), tin.inner_neighbour(t, i).is_none().then_some(outside)]
            .into_iter()
            .flatten()
    })
}

/// Numbers sub-domains by their first triangle.
fn by_first_triangle(mut of_triangle: Vec<u32>, before: Regions) -> Regions {
    let mut number = vec![NONE; before.regions.len()];
    let mut regions = Vec::with_capacity(before.regions.len());
    for (t, region) in of_triangle.iter_mut().enumerate().filter(|(_, region)| **region != NONE) {
        let number = &mut number[*region as usize];
        if *number == NONE {
            *number = regions.len() as u32;
            regions.push(Region { triangle: t as u32, ..before.regions[*region as usize].clone() });
        }
        *region = *number;
    }
    Regions { of_triangle, regions, interval: before.interval }
}

/// The edges between the frame and triangles outside it that are no constraints, ascending. A finer triangulation holds
/// them only if they are added to it.
///
/// Flat triangles along the outer border lie outside the frame. Without these edges, a finer triangulation would have
/// other triangles there, some of them less flat. They would join sub-domains that were separate.
pub fn loose_frame_edges(tin: &Tin) -> Vec<[u32; 2]> {
    let ends_at = |t: u32, i: usize| tin.neighbours[t as usize][i] != NONE && tin.inner_neighbour(t, i).is_none();
    let is_loose = |t: u32, i: usize| ends_at(t, i) && !tin.is_constraint(t, i);
    let of_triangle = |t: u32| (0..3).filter(move |&i| is_loose(t, i)).map(move |i| tin.edge(t, i));
    let mut edges = tin.flat_map_inside(of_triangle);
    edges.par_sort_unstable();
    edges
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::contour::Interval;
    use crate::subdomains::regions;
    use crate::tin::{TinInput, VertexKind, triangulate};

    const TEN: Interval = Interval { step: 10.0, base: 0.0, rounding: 0.0 };

    /// A square whose lower side is not quite straight, without the triangle below it.
    fn square() -> TinInput {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(10.0)], 1e-6);
        for p in [(0.0, 0.0), (5.0, 1e-8), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)] {
            input.push(p.into(), 1.0, VertexKind::Contour);
        }
        input
    }

    #[test]
    fn the_frame_of_a_finer_triangulation_ends_where_it_ended() {
        let coarse = triangulate(square()).unwrap();
        let loose = loose_frame_edges(&coarse);
        assert_eq!(loose.len(), 2);
        let mut finer = square();
        loose.iter().for_each(|&[u, v]| finer.push_edge(u, v));
        // The triangle between this vertex and the side is as flat as the one below.
        finer.push(DVec2::new(2.5, 6e-9), 2.0, VertexKind::Axis);
        let found = regions(&coarse, &TEN);
        let (finer, _) = CarriedRegions::new(&coarse, found).on(triangulate(finer).unwrap());
        let outside: Vec<u32> = (0..finer.len() as u32).filter(|&t| !finer.is_inside(t)).collect();
        assert_eq!(outside.len(), 1);
        assert_eq!(finer.triangles[outside[0] as usize].iter().sum::<u32>(), 3, "the corners 0, 1 and 2");
        assert!((0..finer.len() as u32).all(|t| (0..3).all(|i| !finer.is_constraint(t, i))));
    }

    #[test]
    fn every_triangle_of_a_finer_triangulation_lies_in_the_sub_domain_around_it() {
        let rings = || {
            let mut input = TinInput::new([DVec2::splat(-100.0), DVec2::splat(100.0)], 1e-7);
            for (h, z) in [(90.0, 100.0), (60.0, 110.0), (30.0, 120.0)] {
                let ring = [(-h, -h), (h, -h), (h, h), (-h, h), (-h, -h)].map(DVec2::from);
                input.push_line(&ring, z, VertexKind::Contour);
            }
            input
        };
        let coarse = triangulate(rings()).unwrap();
        let mut found = regions(&coarse, &TEN);
        // A height that no search would give again.
        found.regions[0].band.lo = 7.0;
        let changed = found.regions[0].levels.clone();
        let mut finer = rings();
        for (x, y) in [(0.0, 0.0), (75.0, 10.0), (-45.0, 3.0), (2.0, 77.0)] {
            finer.push(DVec2::new(x, y), 115.0, VertexKind::Axis);
        }
        let (finer, carried) = CarriedRegions::new(&coarse, found).on(triangulate(finer).unwrap());
        assert_eq!(finer.validate(), Ok(()));
        assert_eq!(carried.regions.len(), 3);
        let mut first = vec![NONE; 3];
        for t in 0..finer.len() as u32 {
            let [a, b, c] = finer.corners(t);
            let middle = ((a + b + c) / 3.0).abs().max_element();
            let levels: Vec<f64> = carried.region(t).unwrap().levels.iter().map(|(level, _)| *level).collect();
            let expected: &[f64] = match middle {
                m if m < 30.0 => &[120.0],
                m if m < 60.0 => &[110.0, 120.0],
                _ => &[100.0, 110.0],
            };
            assert_eq!(levels, expected);
            let id = carried.of_triangle[t as usize] as usize;
            first[id] = first[id].min(t);
        }
        assert!(first.is_sorted(), "numbered by the first triangle");
        assert!(carried.regions.iter().zip(&first).all(|(region, &t)| region.triangle == t));
        let kept = carried.regions.iter().find(|region| region.levels == changed).unwrap();
        assert_eq!(kept.band.lo, 7.0);
    }
}
