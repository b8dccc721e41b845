//! Clips a map to an area. Its contours then end exactly on the area's border.
//!
//! Where a contour meets the border, both need the same vertex. Otherwise a triangulation of both would find them
//! crossing because of a rounding error. So three kinds of vertices are added:
//! - A vertex of a contour that lies on the border, up to rounding, becomes a vertex of the border.
//! - A corner of the border that lies on a contour becomes a vertex of the contour.
//! - Where contour and border then still cross, the crossing becomes a vertex of both.
//!
//! Coordinates of the contours never change.

use std::collections::HashSet;

use geo::MultiPolygon;
use glam::DVec2;
use rayon::prelude::*;

use super::map::{Contour, ContourMap};
use crate::base::bits::bits;
use crate::base::parallel;
use crate::geometry::{Border, OnEdge, rings, with_vertices};
use crate::geometry::{Meeting, OrientedBox, Segment, meeting, place, point_distance};

/// Largest number of rounds in which new vertices are looked for. Three are nearly always enough.
const ROUNDS: usize = 16;

/// So many segments of a line are compared with the border at once, as long as no edge of it is near.
const STRETCH: usize = 32;

/// The search also stops when there are more vertices than this many times those after the first round.
const GROWTH: usize = 2;

/// A map cut to an area, and the area with a vertex wherever a contour meets its border.
#[derive(Debug, Clone, PartialEq)]
pub struct Clipped {
    /// The pieces of contours inside the area or along its border, and the spot heights there.
    pub map: ContourMap,
    /// The area. Its border is in the same place, up to rounding.
    pub area: MultiPolygon<f64>,
}

/// Cuts contours at the border of `area` and keeps the parts inside. Their own vertices do not change. Pieces that run
/// along the border are kept. A contour that only touches the border from inside stays in one piece.
///
/// The polygons of `area` must not overlap, and none may cross itself.
pub fn clip(mut map: ContourMap, area: &MultiPolygon<f64>) -> Clipped {
    let (lines, area) = noded(map.contours.iter_mut().map(|c| std::mem::take(&mut c.points)).collect(), area);
    let border = Border::new(&area);
    let corners: HashSet<[u64; 2]> = rings(&area).flatten_points().map(bits).collect();
    let contours: Vec<Vec<Contour>> = std::mem::take(&mut map.contours)
        .into_par_iter()
        .zip(lines)
        .map(|(contour, line)| {
            let of = |points| Contour { points, ..contour };
            let mut nodes: Vec<Node> = Vec::with_capacity(line.len());
            for (stretch, is_near) in stretches(&line, &border) {
                let node = |&point: &DVec2| Node { point, on_border: is_near && corners.contains(&bits(point)) };
                nodes.extend(stretch.iter().skip(usize::from(!nodes.is_empty())).map(node));
            }
            kept_pieces(nodes, &border).into_iter().map(of).collect()
        })
        .collect();
    let spots = std::mem::take(&mut map.spots).into_iter().filter(|s| {
        let place = s.truncate();
        border.contains(place) || border.edge_at(place).is_some()
    });
    map.spots = spots.collect();
    map.contours = contours.into_iter().flatten().collect();
    Clipped { map, area }
}

/// Lines and the border of an area with a vertex wherever they meet. Nothing is cut.
///
/// The polygons of `area` must not overlap, and none may cross itself.
pub fn noded(lines: Vec<Vec<DVec2>>, area: &MultiPolygon<f64>) -> (Vec<Vec<DVec2>>, MultiPolygon<f64>) {
    let border = Border::new(area);
    let on_border = |&p: &DVec2| {
        let (edge, ends) = border.edge_at(p)?;
        (p != ends.a && p != ends.b).then_some((edge, p))
    };
    let near = |points: &Vec<DVec2>| -> Vec<OnEdge> {
        let near = stretches(points, &border).filter(|(_, is_near)| *is_near);
        near.flat_map(|(stretch, _)| stretch.iter().filter_map(on_border)).collect()
    };
    let on_border: Vec<OnEdge> = lines.par_iter().flat_map_iter(near).collect();
    with_meetings(lines, with_vertices(area, on_border))
}

/// A line in stretches that share their ends, each with whether an edge of the border may be near it. Most of a map is far from its
/// border, and a stretch is told so at once.
fn stretches<'a>(points: &'a [DVec2], border: &'a Border) -> impl Iterator<Item = (&'a [DVec2], bool)> {
    let starts = (0..points.len().saturating_sub(1).max(points.len().min(1))).step_by(STRETCH);
    starts.map(|from| &points[from..(from + STRETCH + 1).min(points.len())]).map(|stretch| {
        let (min, max) = stretch.iter().fold((stretch[0], stretch[0]), |(min, max), p| (min.min(*p), max.max(*p)));
        let around = OrientedBox::upright(min, max).grown(2.0 * border.tolerance());
        (stretch, border.near_box(around).next().is_some())
    })
}

/// A vertex of a contour, old or new.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    point: DVec2,
    on_border: bool,
}

/// Adds a vertex to lines and area wherever they meet, and to the area wherever it meets itself.
///
/// A new vertex moves its edge by a rounding error, or by up to the border's tolerance. Two edges side by side at a
/// small angle may then cross at another place. So the search is repeated until it finds nothing. Each round moves less
/// than the one before. On a map hardly larger than the tolerance (one point may lie very far away), new vertices could
/// bring newer ones without end. There [`ROUNDS`] and [`GROWTH`] stop the search.
fn with_meetings(mut lines: Vec<Vec<DVec2>>, mut area: MultiPolygon<f64>) -> (Vec<Vec<DVec2>>, MultiPolygon<f64>) {
    let mut most = usize::MAX;
    for _ in 0..ROUNDS {
        let border = Border::new(&area);
        let met: Vec<(Option<Vec<DVec2>>, Vec<OnEdge>)> =
            parallel::map_each(&lines, |points| meetings(points, &border));
        let mut crossings = own_crossings(&area, &border);
        let mut is_changed = !crossings.is_empty();
        for (line, (points, crossed)) in lines.iter_mut().zip(met) {
            is_changed |= points.is_some() || !crossed.is_empty();
            crossings.extend(crossed);
            if let Some(points) = points {
                *line = points;
            }
        }
        if !is_changed {
            break;
        }
        area = with_vertices(&area, crossings);
        let count = lines.iter().map(Vec::len).sum::<usize>() + rings(&area).map(|ring| ring.0.len()).sum::<usize>();
        if count > most {
            break;
        }
        most = most.min(GROWTH * count);
    }
    (lines, area)
}

/// The vertices of a line including those where it meets the border, or `None` if no vertex is new. Then its crossings
/// with the border's edges.
fn meetings(points: &[DVec2], border: &Border) -> (Option<Vec<DVec2>>, Vec<OnEdge>) {
    let mut all: Vec<DVec2> = Vec::with_capacity(points.len());
    all.extend(points.first());
    let mut crossings = Vec::new();
    let segments =
        stretches(points, border).flat_map(|(stretch, is_near)| stretch.windows(2).map(move |w| (w, is_near)));
    for (w, is_near) in segments {
        if !is_near {
            all.push(w[1]);
            continue;
        }
        let segment = Segment { a: w[0], b: w[1] };
        let mut new = Vec::new();
        for (edge, ends) in border.near(segment.a, segment.b) {
            let on_segment = |corner: DVec2| {
                let near = |p: DVec2| p.distance(corner) <= border.tolerance();
                !near(segment.a) && !near(segment.b) && point_distance(corner, &segment) <= border.tolerance()
            };
            let [at_a, at_b] = [ends.a, ends.b].map(on_segment);
            new.extend([(at_a, ends.a), (at_b, ends.b)].into_iter().filter(|(on, _)| *on).map(|(_, corner)| corner));
            if !at_a && !at_b && ends.a != ends.b && meeting(&segment, &ends) == Meeting::Cross {
                let crossing = place(&segment, &ends);
                new.push(crossing);
                crossings.push((edge, crossing));
            }
        }
        let along = segment.b - segment.a;
        let share = |p: DVec2| (p - segment.a).dot(along);
        new.sort_by(|p, q| share(*p).total_cmp(&share(*q)).then(p.x.total_cmp(&q.x)).then(p.y.total_cmp(&q.y)));
        new.dedup();
        new.retain(|p| *p != segment.a && *p != segment.b);
        all.append(&mut new);
        all.push(segment.b);
    }
    ((all.len() > points.len()).then_some(all), crossings)
}

/// The crossings of the border's edges with each other, given for both edges.
fn own_crossings(area: &MultiPolygon<f64>, border: &Border) -> Vec<OnEdge> {
    let lines: Vec<geo::Line<f64>> = rings(area).flat_map(|ring| ring.lines()).collect();
    let of = |(id, line): (usize, &geo::Line<f64>)| {
        let edge = Segment { a: DVec2::new(line.start.x, line.start.y), b: DVec2::new(line.end.x, line.end.y) };
        let mut found = Vec::new();
        for (other, ends) in border.near(edge.a, edge.b) {
            let is_edge = edge.a != edge.b && ends.a != ends.b;
            if other as usize > id && is_edge && meeting(&edge, &ends) == Meeting::Cross {
                let crossing = place(&edge, &ends);
                found.extend([(id as u32, crossing), (other, crossing)]);
            }
        }
        found
    };
    parallel::flat_map(lines.len(), |i| of((i, &lines[i])))
}

/// The pieces between vertices on the border that lie inside. Successive pieces are joined again. A spike beside the
/// border can run along an edge and back once it has the border's vertices: that piece is kept once.
fn kept_pieces(mut nodes: Vec<Node>, border: &Border) -> Vec<Vec<DVec2>> {
    let Some(last) = nodes.len().checked_sub(1) else { return Vec::new() };
    let closed = nodes.len() >= 4 && nodes[0].point == nodes[last].point;
    let Some(first) = nodes.iter().position(|n| n.on_border) else {
        let inside = border.contains(nodes[0].point);
        return if inside { vec![points(&nodes)] } else { Vec::new() };
    };
    if closed {
        // A ring is cut at the border, not at its first vertex.
        nodes.pop();
        nodes.rotate_left(first);
        nodes.push(nodes[0]);
    }
    let stops: Vec<usize> = (1..last).filter(|&i| nodes[i].on_border).collect();
    let starts = std::iter::once(0).chain(stops.iter().copied());
    let mut kept: Vec<Vec<DVec2>> = Vec::new();
    let mut end = None;
    let mut along_border = HashSet::new();
    for (from, to) in starts.zip(stops.iter().copied().chain([last])) {
        let piece = &nodes[from..=to];
        let mut is_again = || match piece {
            [a, b] => {
                let ends = [a, b].map(|node| bits(node.point));
                !along_border.insert([ends[0].min(ends[1]), ends[0].max(ends[1])])
            }
            _ => false,
        };
        if !is_inside(piece, border) || is_again() {
            continue;
        }
        match kept.last_mut().filter(|_| end == Some(from)) {
            Some(piece_before) => piece_before.extend(points(&piece[1..])),
            None => kept.push(points(piece)),
        }
        end = Some(to);
    }
    if closed && kept.len() == 1 && kept[0].len() == nodes.len() {
        // Nothing was cut off: the ring keeps its first vertex.
        let ring = &mut kept[0];
        ring.pop();
        ring.rotate_right(first);
        ring.push(ring[0]);
    } else if closed && kept.len() > 1 && kept[0][0] == nodes[0].point && end == Some(last) {
        let first = kept.remove(0);
        if let Some(piece) = kept.last_mut() {
            piece.extend(&first[1..]);
        }
    }
    // A piece whose vertices are all within the tolerance exists by rounding only.
    kept.retain(|piece| piece.windows(2).any(|w| w[0].distance(w[1]) > border.tolerance()));
    kept
}

fn points(nodes: &[Node]) -> Vec<DVec2> {
    nodes.iter().map(|n| n.point).collect()
}

/// Whether a piece between two vertices on the border lies inside or along the border.
fn is_inside(piece: &[Node], border: &Border) -> bool {
    if let Some(node) = piece.iter().find(|n| !n.on_border) {
        return border.contains(node.point);
    }
    let middle = piece[0].point.midpoint(piece[piece.len() - 1].point);
    border.contains(middle) || border.edge_at(middle).is_some()
}

/// The points of rings.
trait FlattenPoints {
    fn flatten_points(self) -> impl Iterator<Item = DVec2>;
}

impl<'a, I: Iterator<Item = &'a geo::LineString<f64>>> FlattenPoints for I {
    fn flatten_points(self) -> impl Iterator<Item = DVec2> {
        self.flat_map(|ring| ring.coords().map(|c| DVec2::new(c.x, c.y)))
    }
}

#[cfg(test)]
mod tests {
    use geo::polygon;
    use glam::DVec3;

    use super::*;

    fn area() -> MultiPolygon<f64> {
        polygon![(x: 0.0, y: 0.0), (x: 10.0, y: 0.0), (x: 10.0, y: 10.0), (x: 0.0, y: 10.0)].into()
    }

    fn line(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&p| p.into()).collect()
    }

    fn clipped(lines: &[&[(f64, f64)]]) -> Clipped {
        let contours = lines.iter().map(|points| Contour { elevation: 10.0, points: line(points), feature: 1.into() });
        clip(ContourMap { contours: contours.collect(), ..ContourMap::default() }, &area())
    }

    fn pieces(lines: &[&[(f64, f64)]]) -> Vec<Vec<DVec2>> {
        clipped(lines).map.contours.into_iter().map(|c| c.points).collect()
    }

    fn corners(area: &MultiPolygon<f64>) -> usize {
        rings(area).map(|ring| ring.0.len() - 1).sum()
    }

    #[test]
    fn a_ring_across_the_border_keeps_its_inner_part_in_one_piece() {
        let ring = line(&[(5.0, 2.0), (15.0, 2.0), (15.0, 8.0), (5.0, 8.0), (5.0, 2.0)]);
        let map = ContourMap {
            contours: vec![Contour { elevation: 10.0, points: ring, feature: 1.into() }],
            spots: vec![DVec3::new(1.0, 1.0, 3.0), DVec3::new(11.0, 1.0, 3.0), DVec3::new(0.0, 4.0, 3.0)],
            ..ContourMap::default()
        };
        let clipped = clip(map, &area());
        let expected = line(&[(10.0, 8.0), (5.0, 8.0), (5.0, 2.0), (10.0, 2.0)]);
        assert_eq!(clipped.map.contours.len(), 1);
        assert_eq!(clipped.map.contours[0].points, expected);
        assert_eq!(clipped.map.spots, [DVec3::new(1.0, 1.0, 3.0), DVec3::new(0.0, 4.0, 3.0)]);
        assert_eq!(corners(&clipped.area), 6, "both crossings are corners of the border");
    }

    #[test]
    fn a_line_that_touches_the_border_from_inside_stays_whole() {
        let ring = [(5.0, 2.0), (10.0, 5.0), (5.0, 8.0), (0.0, 5.0), (5.0, 2.0)];
        let open = [(1.0, 1.0), (2.0, 0.0), (3.0, 1.0)];
        let found = clipped(&[&ring, &open]);
        let points: Vec<_> = found.map.contours.iter().map(|c| c.points.clone()).collect();
        assert_eq!(points, [line(&ring), line(&open)]);
        assert_eq!(corners(&found.area), 7);
    }

    #[test]
    fn a_line_that_touches_the_border_from_outside_is_dropped() {
        assert!(pieces(&[&[(2.0, -1.0), (3.0, 0.0), (4.0, -1.0)], &[(9.0, 12.0), (12.0, 9.0)]]).is_empty());
        assert!(pieces(&[&[(9.0, 11.0), (11.0, 9.0)]]).is_empty(), "through the corner");
    }

    #[test]
    fn a_line_along_the_border_is_kept() {
        let along = [(0.0, 2.0), (0.0, 5.0), (0.0, 8.0)];
        assert_eq!(pieces(&[&along]), [line(&along)]);
        let border = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)];
        assert_eq!(pieces(&[&border]), [line(&border)]);
        // A spike beside the border, which both of its sides get a vertex of.
        let found = pieces(&[&[(0.0, 2.0), (0.0, 8.0), (1e-9, 5.0)]]);
        assert_eq!(found, [line(&[(0.0, 2.0), (1e-9, 5.0), (0.0, 8.0)])]);
        let off_and_on = [(3.0, -2.0), (3.0, 0.0), (6.0, 0.0), (6.0, 4.0), (12.0, 4.0)];
        assert_eq!(pieces(&[&off_and_on]), [line(&[(3.0, 0.0), (6.0, 0.0), (6.0, 4.0), (10.0, 4.0)])]);
    }

    #[test]
    fn corners_of_the_border_cut_lines_that_pass_through_them() {
        let found = pieces(&[&[(-5.0, -5.0), (20.0, 20.0)]]);
        assert_eq!(found, [line(&[(0.0, 0.0), (10.0, 10.0)])]);
        // The line passes the corner by less than the tolerance.
        let found =
            pieces(&[&[(5.0, 15.0 + 1e-9), (15.0, 5.0 + 1e-9)], &[(5.0, 5.0), (10.0 + 1e-9, 10.0), (15.0, 5.0)]]);
        assert_eq!(found, [line(&[(5.0, 5.0), (10.0 + 1e-9, 10.0)])]);
    }

    #[test]
    fn holes_and_other_polygons_are_minded() {
        let holed = polygon!(
            exterior: [(x: 0.0, y: 0.0), (x: 10.0, y: 0.0), (x: 10.0, y: 10.0), (x: 0.0, y: 10.0)],
            interiors: [[(x: 4.0, y: 4.0), (x: 4.0, y: 6.0), (x: 6.0, y: 6.0), (x: 6.0, y: 4.0)]],
        );
        let other = polygon![(x: 12.0, y: 0.0), (x: 14.0, y: 0.0), (x: 14.0, y: 10.0), (x: 12.0, y: 10.0)];
        let contours = vec![Contour { elevation: 1.0, points: line(&[(-1.0, 5.0), (20.0, 5.0)]), feature: 1.into() }];
        let found = clip(ContourMap { contours, ..ContourMap::default() }, &MultiPolygon::new(vec![holed, other]));
        let found: Vec<_> = found.map.contours.into_iter().map(|c| c.points).collect();
        let expected =
            [line(&[(0.0, 5.0), (4.0, 5.0)]), line(&[(6.0, 5.0), (10.0, 5.0)]), line(&[(12.0, 5.0), (14.0, 5.0)])];
        assert_eq!(found, expected);
    }

    #[test]
    fn no_line_and_no_area_are_borne_with() {
        assert!(pieces(&[]).is_empty());
        assert!(pieces(&[&[], &[(20.0, 5.0)]]).is_empty());
        let map = ContourMap {
            contours: vec![Contour { elevation: 1.0, points: line(&[(1.0, 1.0), (2.0, 2.0)]), feature: 1.into() }],
            ..ContourMap::default()
        };
        assert!(clip(map, &MultiPolygon::new(Vec::new())).map.contours.is_empty());
    }
}
