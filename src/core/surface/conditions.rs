//! The conditions of the smooth surface on a grid: bands, reference heights, contours, spot heights and creases.

use glam::DVec2;

use super::known_lines::heights_by_place;
use super::lakeside::{keep_above_lakes, keep_off_water, lowest_known};
use crate::base::bits::bits;
use crate::base::{Grid, KnownLine, Sure, parallel};
use crate::contour::ContourMap;
use crate::raster::{heights_at, locate};
use crate::skeleton::SkeletonLine;
use crate::spline::{Conditions, Drainage, Fold, Lattice, beside};
use crate::subdivision::Subdivision;
use crate::subdomains::{Regions, Side, line_at, line_starts, local_bands};
use crate::tin::{NONE, Tin, VertexKind};

/// Looks up bands and reference heights at the nodes of a grid. `subdivision` holds the triangulation with ridge and
/// canyon lines, and `known` are the streams and break lines in it. Of the cliffs, the reach (map units) says how far they
/// act.
pub(crate) fn conditions<'a>(
    subdivision: &'a Subdivision,
    skeleton_lines: &[SkeletonLine],
    known: &[KnownLine<'_>],
    grid: &Grid,
    (cliffs, cliff_reach): (&'a [Vec<DVec2>], f64),
) -> Conditions<'a> {
    let (wrong, starts) = (subdivision.wrong_lines(), line_starts(&subdivision.map));
    let is_wrong = |v: u32| {
        !wrong.is_empty()
            && line_at(&subdivision.tin, &starts, v).is_some_and(|line| wrong.binary_search(&line).is_ok())
    };
    let tin = &subdivision.tin;
    let on_lines = heights_by_place(known.iter().copied(), tin.origin, |sure| sure > Sure::Guessed);
    let given = |v: u32| match tin.kinds[v as usize] {
        VertexKind::Spot => Some((tin.heights[v as usize], Sure::Surveyed)),
        VertexKind::Axis => on_lines.get(&bits(tin.positions[v as usize])).copied(),
        _ => None,
    };
    // The search for local bands keeps one thread busy. Meanwhile another one rasterises.
    let (local, (triangles, reference)) = rayon::join(
        || local_bands(tin, &subdivision.regions, is_wrong, given),
        || {
            let triangles = locate(tin, grid, &());
            let reference = heights_at(tin, grid, &triangles);
            (triangles, reference)
        },
    );
    let of_region = |t: u32| subdivision.regions.region(t).map(|r| r.band);
    let beside = beside(cliffs, grid, cliff_reach);
    // Beside a cliff, the corners of a triangle may lie on both sides of it and tell nothing.
    let is_local = |n: usize| beside.get(n) != Some(&true);
    let band = |n: usize| match triangles[n] {
        NONE => None,
        t => local.get(&t).copied().filter(|_| is_local(n)).or_else(|| of_region(t)),
    };
    let mut lo = parallel::values(triangles.len(), |n| band(n).map_or(f32::NAN, |b| b.lo as f32));
    let mut hi = parallel::values(triangles.len(), |n| band(n).map_or(f32::NAN, |b| b.hi as f32));
    for (node, level) in on_contours(&subdivision.map, grid) {
        if !lo[node].is_nan() {
            (lo[node], hi[node]) = (level as f32, level as f32);
        }
    }
    if subdivision.regions.regions.iter().any(|region| region.water.is_some()) {
        let is_water = |&t: &u32| subdivision.regions.region(t).is_some_and(|region| region.water.is_some());
        let is_water = parallel::values_each(&triangles, |t| *t != NONE && is_water(t));
        let lowest = lowest_known(grid, subdivision.used_spots(), known);
        keep_above_lakes([&mut lo, &mut hi], &is_water, &lowest, grid.cols);
        let levels = subdivision.regions.regions.iter().filter_map(|region| region.water);
        keep_off_water(&mut lo, &hi, levels, subdivision.interval.step);
    }
    let is_hollow = is_hollow(&subdivision.regions);
    let hollows: Vec<bool> = parallel::values_each(&triangles, |&t| {
        t != NONE && is_hollow[subdivision.regions.of_triangle[t as usize] as usize]
    });
    let flat = |line: &SkeletonLine| (Fold::Found, line.points.iter().map(|p| p.truncate()).collect());
    Conditions {
        grid: *grid,
        tin,
        levels: levels_of_vertices(tin, &subdivision.map, &wrong),
        triangles,
        contours: subdivision.map.contours.iter().map(|c| (c.elevation, c.points.as_slice())).collect(),
        spots: subdivision.used_spots().collect(),
        creases: skeleton_lines.iter().map(flat).collect(),
        interval: subdivision.interval.step,
        spacing: subdivision.extent().spacing,
        bounds: [lo, hi],
        reference,
        hollows,
        soft_spots: &[],
        cliffs,
        beside_cliffs: beside,
        known: Vec::new(),
        streams: &[],
        drainage: Drainage::default(),
    }
}

/// The levels of the contours at the vertices of a triangulation; NaN at other vertices, and on the `wrong` contours.
pub(crate) fn levels_of_vertices(tin: &Tin, map: &ContourMap, wrong: &[u32]) -> Vec<f32> {
    let starts = line_starts(map);
    parallel::values(tin.positions.len(), |v| {
        let is_wrong = || line_at(tin, &starts, v as u32).is_some_and(|line| wrong.binary_search(&line).is_ok());
        match tin.kinds[v] {
            VertexKind::Contour if wrong.is_empty() || !is_wrong() => tin.heights[v] as f32,
            _ => f32::NAN,
        }
    })
}

/// The nodes of a grid at vertices of contours, with the level of the contour. The band on either side of the contour
/// would be too wide for them.
pub(crate) fn on_contours<'a>(map: &'a ContourMap, grid: &Grid) -> impl Iterator<Item = (usize, f64)> + 'a {
    let lattice = Lattice::of_grid(grid);
    map.contours.iter().flat_map(move |contour| {
        let node = move |p: &DVec2| lattice.node_at(*p).map(|node| (node, contour.elevation));
        contour.points.iter().filter_map(node)
    })
}

/// For each sub-domain: whether the ground lies, or may lie, in a hollow inside contours. This is so if all its levels
/// are above it.
pub(crate) fn is_hollow(regions: &Regions) -> Vec<bool> {
    regions.regions.iter().map(|r| r.levels.iter().all(|(_, side)| *side == Side::Below)).collect()
}
