//! Landforms: every sub-domain with its outline, its class and its place in the nesting tree (paper, section 3.2).
//!
//! The paper requires one exterior boundary and N_IB interior ones, all of them closed contours. On a real map contours
//! run off the map. There the frame closes the outline, and the sub-domain is *open*.

mod class;
mod rings;

pub use class::{LandformClass, Mixture};
pub use rings::{Border, BorderKind, Ring};

use std::collections::HashMap;

use super::Regions;
use crate::tin::{NONE, Tin};
use rings::{Outlines, outlines};

/// A sub-domain as a piece of terrain.
#[derive(Debug, Clone, PartialEq)]
pub struct Landform {
    /// The exterior boundary, counter-clockwise, then the interior ones, clockwise. They touch in single points only,
    /// so together they are a valid polygon.
    pub rings: Vec<Ring>,
    /// The landform class.
    pub class: LandformClass,
    /// The branches of a branching sub-domain by kind.
    pub mixture: Mixture,
    /// Whether the frame or a barrier edge is part of a boundary.
    pub is_open: bool,
    /// Area, square map units.
    pub area: f64,
    /// The number of the sub-domain that encloses it: its interior boundary is this one's exterior boundary. Where
    /// contours touch there may be several; then it is the one with the longest common border. None where the exterior
    /// boundary is open, or where nothing but the frame and the ground outside the outermost contour lies beyond.
    pub parent: Option<u32>,
    /// How many sub-domains enclose it: 0 without a parent.
    pub depth: u32,
}

impl Landform {
    /// Number of interior boundaries, the paper's N_IB.
    pub fn interior_count(&self) -> usize {
        self.rings.len().saturating_sub(1)
    }
}

/// The landform of each sub-domain, in the order of [`Regions::regions`].
pub fn landforms(tin: &Tin, regions: &Regions) -> Vec<Landform> {
    let count = regions.regions.len();
    let outlines = outlines(tin, &regions.of_triangle);
    let exterior = exteriors(tin, &outlines, count);
    let parents = parents(tin, regions, &outlines, &exterior);
    let depths = depths(&parents);
    let mut areas = vec![0.0; count];
    for t in 0..tin.len() as u32 {
        if let Some(area) = areas.get_mut(regions.of_triangle[t as usize] as usize) {
            let [a, b, c] = tin.corners(t);
            *area += 0.5 * (b - a).perp_dot(c - a);
        }
    }
    let mut rings: Vec<Vec<Ring>> = vec![Vec::new(); count];
    for (id, (region, ring)) in outlines.rings.into_iter().enumerate() {
        let own = &mut rings[region as usize];
        let at = if exterior[region as usize] == id as u32 { 0 } else { own.len() };
        own.insert(at, ring);
    }
    let all = rings.into_iter().zip(&regions.regions).zip(areas).zip(parents.into_iter().zip(depths));
    all.map(|(((rings, region), area), (parent, depth))| {
        let (class, mixture) = class::classify(region, &rings);
        let is_open = rings.iter().any(|ring| !ring.is_closed());
        Landform { rings, class, mixture, is_open, area, parent, depth }
    })
    .collect()
}

/// The exterior ring of each sub-domain: the one with the largest signed area, since rings around holes are negative.
fn exteriors(tin: &Tin, outlines: &Outlines, count: usize) -> Vec<u32> {
    let mut best = vec![(f64::NEG_INFINITY, NONE); count];
    for (id, (region, ring)) in outlines.rings.iter().enumerate() {
        let area = ring.signed_area(tin);
        if area > best[*region as usize].0 {
            best[*region as usize] = (area, id as u32);
        }
    }
    best.into_iter().map(|(_, id)| id).collect()
}

/// The sub-domain that encloses each one.
///
/// The interior boundaries of a sub-domain lie inside its exterior one. So a parent is always larger than its child,
/// and the chain of parents has no cycle.
fn parents(tin: &Tin, regions: &Regions, outlines: &Outlines, exterior: &[u32]) -> Vec<Option<u32>> {
    let is_exterior = |ring: u32| exterior[outlines.rings[ring as usize].0 as usize] == ring;
    let mut common: HashMap<(u32, u32), f64> = HashMap::new();
    for t in 0..tin.len() as u32 {
        for i in 0..3 {
            let ring = outlines.of_edge[t as usize][i];
            if ring == NONE || !is_exterior(ring) || !outlines.rings[ring as usize].1.is_closed() {
                continue;
            }
            let Some(n) = tin.inner_neighbour(t, i) else { continue };
            let Some(back) = tin.edge_towards(n, t) else { continue };
            let beyond = outlines.of_edge[n as usize][back];
            if beyond != NONE && !is_exterior(beyond) {
                let pair = (regions.of_triangle[t as usize], regions.of_triangle[n as usize]);
                *common.entry(pair).or_default() += tin.edge_length(t, i);
            }
        }
    }
    let mut best: Vec<Option<(f64, u32)>> = vec![None; exterior.len()];
    for ((child, parent), length) in common {
        let best = &mut best[child as usize];
        if best.is_none_or(|(longest, other)| length > longest || (length == longest && parent < other)) {
            *best = Some((length, parent));
        }
    }
    best.into_iter().map(|b| b.map(|(_, parent)| parent)).collect()
}

/// How many parents are above each sub-domain.
fn depths(parents: &[Option<u32>]) -> Vec<u32> {
    let mut depths = vec![NONE; parents.len()];
    for first in 0..parents.len() {
        let mut chain = Vec::new();
        let mut at = Some(first as u32);
        let mut depth = 0;
        while let Some(id) = at {
            if depths[id as usize] != NONE {
                depth = depths[id as usize] + 1;
                break;
            }
            chain.push(id);
            at = parents[id as usize];
        }
        for id in chain.into_iter().rev() {
            depths[id as usize] = depth;
            depth += 1;
        }
    }
    depths
}
