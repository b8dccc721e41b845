//! Checks that spade's walk to a new point ends.

use spade::handles::FixedVertexHandle;
use spade::{Point2, Triangulation as _};

use super::cdt::Cdt;

/// A walk with more steps counts as endless. Between points side by side a walk takes a few steps, and some thousand
/// round a vertex in the middle of a large ring.
const STEPS: usize = 20_000;

/// Whether spade's walk from a vertex to a position ends.
///
/// The walk turns round a vertex to the triangle towards the position. It goes on to the vertex behind that triangle's
/// far edge, and so on. Across edges that are locally Delaunay it comes nearer and nearer: the position's power with
/// respect to the circumcircles falls. Across constraints it may not. Among lines that wind round each other it can run
/// in a circle, and then spade panics. So each walk is tried beforehand with the same steps.
pub(super) fn is_found(cdt: &Cdt, place: Point2<f64>, from: FixedVertexHandle) -> bool {
    if cdt.all_vertices_on_line() {
        return true;
    }
    let mut nearest = cdt.vertex(from);
    let distance = |p: Point2<f64>| p.distance_2(place);
    while let Some(next) =
        nearest.out_edges().map(|edge| edge.to()).find(|next| distance(next.position()) < distance(nearest.position()))
    {
        nearest = next;
    }
    let Some(mut edge) = nearest.out_edge() else { return true };
    let mut side = edge.side_query(place);
    let mut leftward = side.is_on_left_side_or_on_line();
    // spade itself takes no more steps than there are edges.
    for _ in 0..STEPS.min(cdt.num_directed_edges()) {
        if edge.vertices().iter().any(|v| v.position() == place) {
            return true;
        }
        if side.is_on_line() {
            // Turn round the previous vertex, which lies beside the line through this edge and the position.
            edge = if edge.is_outer_edge() { edge.rev() } else { edge }.prev();
            side = edge.side_query(place);
            leftward = side.is_on_left_side_or_on_line();
            continue;
        }
        let near = if leftward { edge } else { edge.rev() };
        if near.is_outer_edge() {
            return true;
        }
        let turned = if leftward { edge.ccw() } else { edge.cw() };
        let turned_side = turned.side_query(place);
        if turned_side.is_on_line() || turned_side.is_on_left_side() == leftward {
            (edge, side) = (turned, turned_side);
            continue;
        }
        let far = if leftward { near.next() } else { near.prev() };
        if far.side_query(place).is_on_left_side_or_on_line() {
            return true;
        }
        edge = far.rev();
        edge = if edge.is_outer_edge() { edge } else { edge.prev() };
        side = edge.side_query(place);
        leftward = side.is_on_left_side_or_on_line();
    }
    false
}

/// Lines among which spade's walk runs in a circle: vertices, edges between them, and points to add in this order. The
/// walk to the last point does so.
#[cfg(test)]
pub(super) fn winding_lines() -> (Vec<glam::DVec2>, Vec<[usize; 2]>, Vec<glam::DVec2>) {
    let winding =
        [(3.0, 12.0), (13.0, 6.0), (14.0, 9.0), (9.0, 10.0), (31.0, 9.0), (24.0, 11.0), (15.0, 11.0), (7.0, 10.0)];
    let others = [(1.0, 15.0), (2.0, 31.0), (0.0, 3.0), (7.0, 1.0), (15.0, 2.0), (24.0, 2.0)];
    let ends = [(0.654_822_335_025_380_8, 12.167_512_690_355_33), (0.857_868_020_304_568_5, 15.010_152_284_263_96)];
    let points = [(46.0 / 3.0, 5.0 / 3.0), (23.0, 10.0), (22.5, 9.0), (12.0, 10.5), (11.0, 8.0)];
    let edges = (0..7).map(|i| [i, i + 1]).chain([[8, 9], [10, 11], [11, 12], [12, 13], [0, 14], [8, 15]]);
    let vertices = winding.into_iter().chain(others).chain(ends);
    (vertices.map(Into::into).collect(), edges.collect(), points.map(Into::into).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_in_a_circle_is_noticed() {
        let (vertices, edges, points) = winding_lines();
        let place = |p: glam::DVec2| Point2::new(p.x, p.y);
        let vertices = vertices.into_iter().map(place).collect();
        let mut cdt = Cdt::try_bulk_load_cdt(vertices, edges, |e| panic!("{e:?}")).unwrap();
        let mut near = FixedVertexHandle::from_index(0);
        let (last, before) = points.split_last().unwrap();
        for &p in before {
            assert!(is_found(&cdt, place(p), near));
            near = cdt.insert_with_hint(place(p), near).unwrap();
        }
        assert!(!is_found(&cdt, place(*last), near));
        assert!(is_found(&cdt, Point2::new(40.0, 8.0), near), "outside");
    }
}
