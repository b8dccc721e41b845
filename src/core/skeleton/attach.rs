//! Lines that cross a contour away from the tip of a bend are connected with the lines beyond it.
//!
//! Where such a line arrives, the bend beyond may have been dropped by elimination, or its tip may be too far away. A
//! side line then leads from there through the chords of the dropped branch to the nearest line that was kept.

use std::collections::{HashMap, HashSet, VecDeque};

use super::axis_builder::{AxisBuilder, beyond};
use super::eliminate::Elimination;
use super::pieces::End;
use crate::subdomains::Regions;
use crate::tin::{NONE, Tin, TriangleKind};

/// Most triangles that are searched per arrival. It limits the time.
const TRIALS: usize = 256;

/// Adds side lines from arrivals at which no line beyond ends. `removed` are pieces that no longer count.
///
/// Long because each arrival must see the lines that earlier arrivals added.
pub(super) fn attach(
    tin: &Tin,
    kinds: &[TriangleKind],
    regions: &Regions,
    elimination: &Elimination,
    builder: &mut AxisBuilder,
    removed: &[bool],
) {
    let mut live = vec![false; builder.axis.points.len()];
    let mut taken: HashSet<(u32, u32)> = HashSet::new();
    for (id, [from, to]) in builder.axis.pieces.iter().enumerate() {
        if removed.get(id).copied().unwrap_or(false) {
            continue;
        }
        let End::Axis(p) = *from else { continue };
        live[p as usize] = true;
        match *to {
            End::Axis(q) => live[q as usize] = true,
            End::Vertex(v) => {
                taken.insert((v, builder.axis.points[p as usize].region));
            }
        }
    }
    for arrival in std::mem::take(&mut builder.arrivals) {
        let way = beyond(tin, regions, &arrival);
        let level = tin.heights[arrival.vertex as usize];
        let fan: Vec<u32> = fan(tin, arrival.triangle, arrival.vertex)
            .into_iter()
            .filter(|&t| {
                let region = regions.of_triangle[t as usize];
                region != arrival.region && regions.regions[region as usize].side(level) == way
            })
            .collect();
        if fan.iter().any(|&t| taken.contains(&(arrival.vertex, regions.of_triangle[t as usize]))) {
            continue;
        }
        let flat = |t: u32| tin.corner_heights(t).iter().all(|&h| h == level);
        let mut queue = VecDeque::new();
        for &t in fan.iter().filter(|&&t| flat(t)) {
            let Some(j) = tin.triangles[t as usize].iter().position(|&v| v == arrival.vertex) else { continue };
            let edge = (j + 1) % 3;
            let p = builder.of_edge[t as usize][edge];
            if p == NONE {
                continue;
            }
            let kept_fork = kinds[t as usize] == TriangleKind::Junction && builder.piece_of[t as usize] == NONE;
            let kept_fork = kept_fork && !elimination.dropped[t as usize];
            // In a triangle with a line, only the ends of that line can be reached without crossing it.
            let free = builder.piece_of[t as usize] == NONE || live[p as usize];
            if free && !kept_fork && !builder.crossed.contains(&t) {
                queue.push_back((t, edge));
            }
        }
        let Some(path) = way_to_line(tin, elimination, builder, &live, queue, flat) else { continue };
        builder.axis.pieces.push([End::Axis(path[0].1), End::Vertex(arrival.vertex)]);
        builder.axis.pieces.extend(path.windows(2).map(|w| [End::Axis(w[0].1), End::Axis(w[1].1)]));
        taken.insert((arrival.vertex, regions.of_triangle[path[0].0 as usize]));
        for (t, p) in path {
            live[p as usize] = true;
            builder.crossed.insert(t);
        }
    }
}

/// The way from the edges in `queue`, through triangles without a line, to the nearest line. Each step is the triangle
/// that it crosses and the axis point to which it leads.
fn way_to_line(
    tin: &Tin,
    elimination: &Elimination,
    builder: &AxisBuilder,
    live: &[bool],
    mut queue: VecDeque<(u32, usize)>,
    flat: impl Fn(u32) -> bool,
) -> Option<Vec<(u32, u32)>> {
    let mut before: HashMap<u32, Option<(u32, u32)>> = HashMap::new();
    let point = |t: u32, edge: usize| builder.of_edge[t as usize][edge];
    queue.iter().for_each(|&(t, edge)| {
        before.insert(point(t, edge), None);
    });
    let back = |before: &HashMap<u32, Option<(u32, u32)>>, last: (u32, u32)| {
        let mut path = vec![last];
        while let Some(Some(step)) = before.get(&path[path.len() - 1].1) {
            path.push(*step);
        }
        path.reverse();
        path
    };
    for _ in 0..TRIALS {
        let (t, edge) = queue.pop_front()?;
        let here = point(t, edge);
        if live[here as usize] {
            return Some(back(&before, (t, here)));
        }
        let Some(n) = tin.across(t, edge).filter(|&n| flat(n) && !builder.crossed.contains(&n)) else { continue };
        let piece = builder.piece_of[n as usize];
        if piece != NONE {
            let position = |p: u32| builder.axis.points[p as usize].position;
            let ends = builder.axis.pieces[piece as usize].into_iter().filter_map(|end| match end {
                End::Axis(p) if live[p as usize] => Some(p),
                _ => None,
            });
            let distance = |p: &u32| position(*p).distance_squared(position(here));
            if let Some(end) = ends.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                let mut path = back(&before, (t, here));
                path.push((n, end));
                return Some(path);
            }
            continue;
        }
        if !elimination.dropped[n as usize] {
            continue;
        }
        for i in 0..3 {
            let p = point(n, i);
            if p != NONE && p != here && !before.contains_key(&p) {
                before.insert(p, Some((t, here)));
                queue.push_back((n, i));
            }
        }
    }
    None
}

/// The triangles inside the frame around a vertex, on both sides of contours.
fn fan(tin: &Tin, first: u32, vertex: u32) -> Vec<u32> {
    let mut seen = HashSet::from([first]);
    let mut found = vec![first];
    let mut next = 0;
    while let Some(&t) = found.get(next) {
        next += 1;
        for i in (0..3).filter(|&i| tin.edge(t, i).contains(&vertex)) {
            if let Some(n) = tin.inner_neighbour(t, i)
                && seen.insert(n)
            {
                found.push(n);
            }
        }
    }
    found
}
