//! Areas: rings with the holes in them.

use std::collections::HashMap;

use glam::DVec2;

use super::graph::{Graph, Side};
use crate::base::union_find::UnionFind;
use crate::geometry::{Segment, nearest_east};
use crate::slice::signed_area;

/// A connected area.
pub(super) struct Area {
    /// The outer ring, counter-clockwise, then the holes.
    pub rings: Vec<Vec<DVec2>>,
    /// What the lines on its border know about it.
    pub side: Side,
}

/// All areas that are bounded. A graph without bridges has one area on the left of each walk.
pub(super) fn areas(graph: &Graph) -> Vec<Area> {
    let (walks, of_step) = graph.walks();
    let rings: Vec<Vec<Vec<DVec2>>> = walks.iter().map(|walk| rings(graph, walk)).collect();
    // The walk around the outside of a component is clockwise as a whole. All others are around areas.
    let sizes: Vec<f64> = rings.iter().map(|rings| rings.iter().map(|ring| signed_area(ring)).sum()).collect();
    let around = holders(graph, &walks, &of_step, &sizes);
    let mut areas: Vec<Option<Area>> = (0..walks.len()).map(|_| None).collect();
    let side = |w: usize| walks[w].iter().fold(Side::NOTHING, |side, &step| side.and(graph.left(step)));
    let (holes, outer): (Vec<_>, Vec<_>) = rings.into_iter().enumerate().partition(|(w, _)| sizes[*w] <= 0.0);
    for (w, mut rings) in outer {
        // Rings that the walk touches itself in are holes.
        rings.sort_by(|a, b| signed_area(b).total_cmp(&signed_area(a)));
        areas[w] = Some(Area { rings, side: side(w) });
    }
    for (w, rings) in holes {
        if let Some(area) = around[w].and_then(|holder| areas[holder].as_mut()) {
            area.rings.extend(rings);
            area.side = area.side.and(side(w));
        }
    }
    areas.into_iter().flatten().collect()
}

/// The rings of a walk. Each passes a vertex once.
fn rings(graph: &Graph, walk: &[usize]) -> Vec<Vec<DVec2>> {
    let (mut rings, mut path): (Vec<Vec<DVec2>>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut place: HashMap<u32, usize> = HashMap::new();
    for &step in walk {
        place.insert(graph.start(step), path.len());
        path.push(step);
        if let Some(&from) = place.get(&graph.end(step)) {
            let mut ring = Vec::new();
            for step in path.drain(from..) {
                place.remove(&graph.start(step));
                graph.append(step, &mut ring);
            }
            ring.push(ring[0]);
            rings.push(ring);
        }
    }
    rings
}

/// For each walk around the outside of a component: the walk around the area that the component lies in, if it lies in one.
fn holders(graph: &Graph, walks: &[Vec<usize>], of_step: &[u32], sizes: &[f64]) -> Vec<Option<usize>> {
    let mut components = UnionFind::new(graph.nodes());
    (0..graph.steps()).step_by(2).for_each(|step| {
        components.unite(graph.start(step) as usize, graph.end(step) as usize);
    });
    let mut east: HashMap<usize, DVec2> = HashMap::new();
    let mut segments = Vec::new();
    for (chain, course) in graph.courses().enumerate() {
        let component = components.root(graph.start(2 * chain) as usize);
        let most = east.entry(component).or_insert(course[0]);
        for p in course {
            if (p.x, p.y) > (most.x, most.y) {
                *most = *p;
            }
        }
        segments.extend(course.windows(2).map(|w| (Segment { a: w[0], b: w[1] }, chain)));
    }
    let mut outer: Vec<(DVec2, usize)> = (0..walks.len())
        .filter(|&w| sizes[w] <= 0.0)
        .map(|w| (east[&components.root(graph.start(walks[w][0]) as usize)], w))
        .collect();
    outer.sort_by(|(p, v), (q, w)| q.x.total_cmp(&p.x).then(q.y.total_cmp(&p.y)).then(v.cmp(w)));
    let places: Vec<DVec2> = outer.iter().map(|(place, _)| *place).collect();
    let edges: Vec<Segment> = segments.iter().map(|(segment, _)| *segment).collect();
    let mut holder = vec![None; walks.len()];
    for ((_, w), hit) in outer.iter().zip(nearest_east(&edges, &places)) {
        holder[*w] = hit.and_then(|hit| {
            // The west of a segment that runs upwards is its left.
            let (Segment { a, b }, chain) = segments[hit as usize];
            let walk = of_step[2 * chain + usize::from(a.y > b.y)] as usize;
            // A component beside it, further east, is done already.
            if sizes[walk] > 0.0 { Some(walk) } else { holder[walk] }
        });
    }
    holder
}
