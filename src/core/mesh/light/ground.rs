//! The triangles that few triangles begin with: those between the outline of the ground and the lines that are kept.

use std::collections::{HashMap, HashSet};

use glam::{DVec2, DVec3};

use super::ON;
use super::network::Network;
use super::noded::Noded;
use crate::base::Key;
use crate::base::bits::bits;
use crate::base::error::Result;
use crate::mesh::check_heights;
use crate::mesh::outline::{Outline, height_at};
use crate::raster::Dem;
use crate::tin::{NONE, Tin, TinInput, VertexKind, triangulate};

/// The triangles of an outline and of the lines that are kept, and their vertices relative to the origin of the outline. The outline
/// has corners where lines end.
pub(super) fn triangles(outline: &Outline, dem: &Dem, tolerance: f64) -> Result<(Network, Vec<DVec3>)> {
    let grid = &dem.grid;
    let place = |v: DVec3| grid.place(v.truncate() + outline.origin) * DVec2::new(1.0, -1.0);
    check_heights(&outline.vertices, outline.origin)?;
    let (mut places, mut vertices, mut edges) = (Vec::new(), Vec::new(), Vec::new());
    let ends: HashSet<[u64; 2]> = outline.kept.iter().flatten().map(|end| bits(end.truncate())).collect();
    let mut numbers: HashMap<[u64; 2], u32> = HashMap::new();
    for ring in rings(outline, &place, tolerance / 2.0, &ends) {
        let (first, count) = (vertices.len() as u32, ring.len() as u32);
        for v in ring {
            // A vertex at a cell's centre has the height of the cell, unless a line ends there.
            let (at, number) = (place(v), vertices.len() as u32);
            let is_end = ends.contains(&bits(v.truncate()));
            let of_cell = height_at(dem, at.round()).filter(|_| !is_end && (at - at.round()).abs().max_element() < ON);
            numbers.insert(bits(v.truncate()), number);
            places.push(if of_cell.is_some() { at.round() } else { at });
            vertices.push(v.truncate().extend(of_cell.unwrap_or(v.z)));
        }
        edges.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
    }
    let of_outline = edges.len();
    for segment in &outline.kept {
        edges.push(segment.map(|end| {
            *numbers.entry(bits(end.truncate())).or_insert_with(|| {
                places.push(place(end));
                vertices.push(end);
                vertices.len() as u32 - 1
            })
        }));
    }
    let mut noded = Noded::new(places, vertices, edges);
    outline.lines.iter().for_each(|line| noded.add(line, place));
    let (border, kept) = (noded.pieces(0..of_outline), noded.pieces(of_outline..noded.edges.len()));
    let Noded { places, vertices, .. } = noded;
    let mut input = TinInput::new([DVec2::ZERO, DVec2::new(grid.cols as f64, grid.rows as f64)], -1.0);
    for (at, v) in places.iter().zip(&vertices) {
        input.push_local(*at, v.z, VertexKind::Axis);
    }
    border.iter().chain(&kept).for_each(|[a, b]| input.push_edge(*a, *b));
    let border: Vec<[DVec2; 2]> = border.iter().map(|ends| ends.map(|v| places[v as usize])).collect();
    let base = triangulate(&input)?;
    // The ground lies on the left of the outline.
    let inside = inside(&base, &border);
    let mut number = vec![NONE; base.len()];
    let ground: Vec<usize> = (0..base.len()).filter(|&t| inside[t]).collect();
    (0..).zip(&ground).for_each(|(k, &t)| number[t] = k);
    let numbered = |n: &u32| if *n == NONE { NONE } else { number[*n as usize] };
    let corners = ground.iter().map(|&t| base.triangles[t]).collect();
    let neighbours: Vec<[u32; 3]> = ground.iter().map(|&t| base.neighbours[t].each_ref().map(numbered)).collect();
    let vertices: Vec<DVec3> = base.source.iter().map(|&v| vertices[v as usize]).collect();
    let places = base.positions.iter().zip(&vertices).map(|(at, v)| at.extend(v.z)).collect();
    let is_kept = |t: usize, i: usize| base.is_constraint(ground[t] as u32, i);
    Ok((Network::new(places, corners, &neighbours, is_kept), vertices))
}

/// Which triangles lie on the left of the edges between these places.
fn inside(base: &Tin, edges: &[[DVec2; 2]]) -> Vec<bool> {
    let vertices: HashMap<[u64; 2], u32> = (0..).zip(&base.positions).map(|(v, p)| (bits(*p), v)).collect();
    let vertex = |p: DVec2| vertices.get(&bits(p)).copied().unwrap_or(NONE);
    let left: HashSet<[u32; 2]> = edges.iter().map(|ends| ends.map(vertex)).collect();
    let mut inside = vec![false; base.len()];
    let begins = |t: &u32| (0..3).any(|i| left.contains(&base.edge(*t, i)));
    let mut open: Vec<u32> = (0..base.len() as u32).filter(begins).collect();
    while let Some(t) = open.pop() {
        if !std::mem::replace(&mut inside[t as usize], true) {
            let is_border = |i: &usize| left.contains(&base.edge(t, *i));
            let beyond = (0..3).filter(|i| !is_border(i)).map(|i| base.neighbours[t as usize][i]);
            open.extend(beyond.filter(|&n| n != NONE));
        }
    }
    inside
}

/// The rings of the outline, without the vertices between two corners that the heights and the `ends` of lines do not need.
pub(super) fn rings(
    outline: &Outline,
    place: &impl Fn(DVec3) -> DVec2,
    tolerance: f64,
    ends: &HashSet<[u64; 2]>,
) -> Vec<Vec<DVec3>> {
    let Outline { vertices, edges, .. } = outline;
    let mut next = vec![NONE; vertices.len()];
    edges.iter().for_each(|&[u, v]| next[u as usize] = v);
    let mut rings = Vec::new();
    for &[start, _] in edges {
        let mut ring = Vec::new();
        let mut v = start;
        while v != NONE {
            ring.push(vertices[v as usize]);
            v = std::mem::replace(&mut next[v as usize], NONE);
        }
        if ring.len() > 3 {
            // The ring ends where it began.
            let at: Vec<DVec2> = ring.iter().map(|v| place(*v)).collect();
            let far =
                (0..at.len()).fold(0, |far, k| if at[k].distance(at[0]) > at[far].distance(at[0]) { k } else { far });
            let mut kept: Vec<bool> = ring.iter().map(|v| ends.contains(&bits(v.truncate()))).collect();
            let last = ring.len() - 1;
            [0, far, last].into_iter().for_each(|k| kept[k] = true);
            let corners: Vec<usize> = (0..=last).filter(|&k| kept[k]).collect();
            for part in corners.windows(2) {
                keep(&ring, &at, part[0], part[1], tolerance, &mut kept);
            }
            kept[last] = false;
            let mut flags = kept.into_iter();
            ring.retain(|_| flags.next().unwrap_or(false));
            rings.push(ring);
        }
    }
    rings
}

/// Marks what Douglas and Peucker (1973) keep between two vertices: corners on the map, and heights.
fn keep(ring: &[DVec3], at: &[DVec2], first: usize, last: usize, tolerance: f64, kept: &mut [bool]) {
    let mut open = vec![(first, last)];
    while let Some((first, last)) = open.pop() {
        let (from, to) = (at[first], at[last]);
        let squared = from.distance_squared(to);
        let needed = |k: usize| {
            let share = if squared > 0.0 { ((at[k] - from).dot(to - from) / squared).clamp(0.0, 1.0) } else { 0.0 };
            let aside = at[k].distance(from.lerp(to, share)) / ON;
            let height = ring[first].z + share * (ring[last].z - ring[first].z);
            aside.max((ring[k].z - height).abs() / tolerance)
        };
        let furthest = (first + 1..last).map(|k| (Key(needed(k)), k)).max();
        if let Some((Key(needed), k)) = furthest
            && needed > 1.0
        {
            kept[k] = true;
            open.extend([(first, k), (k, last)]);
        }
    }
}
