//! Bands of single triangles, where that of their sub-domain is too wide to tell much.
//!
//! A contour that is broken lets the ground on both of its sides be one sub-domain, and a line with a wrong elevation gives
//! the one that it lies in another level: either way all of it gets a wide band, also kilometres away. But a triangle with
//! corners on two levels lies between those, and ground beside it most likely does too.

use std::collections::{HashMap, VecDeque};

use rayon::prelude::*;

use super::regions::WIDE;
use super::{Band, Regions, Tin, VertexKind};

/// The bands of the triangles of all sub-domains whose band is wider than one interval, as far as they are narrower than that:
/// between the levels at the corners, or those of the triangle with corners on two levels that is the fewest triangles away.
pub fn local_bands(tin: &Tin, regions: &Regions) -> HashMap<u32, Band> {
    let near = WIDE * regions.interval.step;
    let is_wide = |t: u32| {
        tin.is_inside(t)
            && regions
                .region(t)
                .is_some_and(|r| r.water.is_none() && r.levels.len() > 2 && r.band.hi - r.band.lo > near)
    };
    let told = |t: u32| Some((t, corner_band(tin, t)?));
    let wide = (0..tin.len() as u32).into_par_iter().filter(|&t| is_wide(t));
    let told: Vec<(u32, Band)> = wide.filter_map(told).collect();
    let mut bands: HashMap<u32, Band> = told.iter().copied().collect();
    let mut open: VecDeque<(u32, Band)> = told.into();
    while let Some((t, band)) = open.pop_front() {
        for n in (0..3).filter_map(|i| tin.across(t, i)) {
            bands.entry(n).or_insert_with(|| {
                open.push_back((n, band));
                band
            });
        }
    }
    bands.retain(|t, band| {
        let Some(whole) = regions.region(*t).map(|r| r.band) else { return false };
        *band = Band { lo: band.lo.max(whole.lo), hi: band.hi.min(whole.hi) };
        band.lo < band.hi && *band != whole
    });
    bands
}

/// Between the lowest and the highest of the levels at a triangle's corners, if there are two.
fn corner_band(tin: &Tin, t: u32) -> Option<Band> {
    let corners = tin.triangles[t as usize].into_iter();
    let levels = corners.filter(|&v| tin.kinds[v as usize] == VertexKind::Contour).map(|v| tin.heights[v as usize]);
    let none = Band { lo: f64::INFINITY, hi: f64::NEG_INFINITY };
    let band = levels.fold(none, |band, level| Band { lo: band.lo.min(level), hi: band.hi.max(level) });
    (band.lo < band.hi).then_some(band)
}
