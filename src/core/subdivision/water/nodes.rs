//! Makes shores and contours of one level share every vertex where they meet.
//!
//! A shore is often a contour: vertex for vertex, or but for rounding and generalisation. The steps:
//!
//! 1. Vertices of the shore near a contour of its own level become vertices of that contour. Where it has none there,
//!    one is added to it, in the triangulation only, never in the map.
//! 2. Vertices of the contour beside the shore become vertices of the shore.
//! 3. Where the two still cross, both get a vertex at the crossing.
//!
//! A lake whose shore still crosses a contour after that is left out.

use glam::DVec2;

use super::net::{Net, Piece};
use crate::base::parallel;
use crate::geometry::{BoxTree, Meeting, OrientedBox, Segment, meeting, place, point_distance};

/// How often the search for crossings is repeated after vertices were added.
const ROUNDS: usize = 4;

/// Distances between shores and contours of one level, map units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach {
    /// Vertices of the shore move onto a contour that is this near.
    pub snap: f64,
    /// Points closer to each other than this count as one.
    pub tolerance: f64,
}

/// The shore with a vertex wherever it meets a contour of its level. The contours get these vertices too.
pub(crate) fn node(shore: Vec<DVec2>, level: f64, net: &mut Net, reach: Reach) -> Vec<DVec2> {
    let snap = reach.snap;
    let shore = snapped(shore, level, net, snap);
    let shore = with_ends(shore, level, net, reach.tolerance);
    let mut shore = with_contour_vertices(&shore, level, net, snap);
    for _ in 0..ROUNDS {
        let count = shore.len();
        shore = with_crossings(&shore, level, net);
        if shore.len() == count {
            break;
        }
    }
    without_spikes(without_chords(&shore, level, net))
}

fn own(net: &Net, a: DVec2, b: DVec2, level: f64, reach: f64) -> impl Iterator<Item = Piece> {
    net.near(a, b, reach).into_iter().filter(move |piece| piece.level == level)
}

/// The shore with its vertices moved onto the contour. The ends of an open piece lie on the frame and stay.
fn snapped(mut shore: Vec<DVec2>, level: f64, net: &mut Net, snap: f64) -> Vec<DVec2> {
    let Some(last) = shore.len().checked_sub(1) else { return shore };
    let is_closed = shore[0] == shore[last];
    let range = if is_closed { 0..last } else { 1..last };
    for p in &mut shore[range] {
        let pieces: Vec<Piece> = own(net, *p, *p, level, snap).collect();
        *p = on_contour(*p, &pieces, net, snap).unwrap_or(*p);
    }
    if is_closed {
        shore[last] = shore[0];
    }
    shore.dedup();
    shore
}

/// The point of some pieces of contour nearest to `p`, if one is within `reach`. It is a vertex, or becomes one.
fn on_contour(p: DVec2, pieces: &[Piece], net: &mut Net, reach: f64) -> Option<DVec2> {
    let ends = pieces.iter().flat_map(|piece| [piece.ends.a, piece.ends.b]);
    let nearest = ends.min_by(|a, b| a.distance(p).total_cmp(&b.distance(p)));
    if let Some(vertex) = nearest.filter(|v| v.distance(p) <= reach) {
        return Some(vertex);
    }
    let distance = |piece: &Piece| point_distance(p, &piece.ends);
    let nearest = pieces.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let piece = nearest.filter(|piece| distance(piece) <= reach)?;
    let Segment { a, b } = piece.ends;
    let place = a + (b - a) * ((p - a).dot(b - a) / (b - a).length_squared());
    net.add_node(piece, place);
    Some(place)
}

/// Moves the ends of an open piece, which lie on the frame, onto the contour along the frame. A computed crossing would
/// lie beside the end by rounding. Lines would then fit between the two vertices at one position, or between the
/// contour and a vertex beside it.
fn with_ends(mut shore: Vec<DVec2>, level: f64, net: &mut Net, tolerance: f64) -> Vec<DVec2> {
    let Some(last) = shore.len().checked_sub(1) else { return shore };
    if shore[0] == shore[last] {
        return shore;
    }
    for k in [0, last] {
        let p = shore[k];
        let pieces: Vec<Piece> = own(net, p, p, level, tolerance).collect();
        shore[k] = on_contour(p, &pieces, net, tolerance).unwrap_or(p);
    }
    shore.dedup();
    shore
}

/// Adds the vertices of the contour that lie beside a segment of the shore to that segment.
fn with_contour_vertices(shore: &[DVec2], level: f64, net: &Net, snap: f64) -> Vec<DVec2> {
    with_points_within(shore, |s| {
        let pieces = own(net, s.a, s.b, level, snap);
        let ends = pieces.flat_map(|piece| [piece.ends.a, piece.ends.b]);
        ends.filter(|&v| {
            let share = (v - s.a).dot(s.b - s.a) / (s.b - s.a).length_squared();
            share > 0.0 && share < 1.0 && point_distance(v, s) <= snap
        })
        .collect()
    })
}

/// Adds the crossings with the contour to both lines.
fn with_crossings(shore: &[DVec2], level: f64, net: &mut Net) -> Vec<DVec2> {
    with_points_within(shore, |s| {
        let crossed: Vec<Piece> =
            own(net, s.a, s.b, level, 0.0).filter(|piece| meeting(s, &piece.ends) == Meeting::Cross).collect();
        let add = |piece: &Piece| {
            let at = place(s, &piece.ends);
            net.add_node(piece, at);
            at
        };
        crossed.iter().map(add).collect()
    })
}

/// Adds a vertex to every segment that joins two vertices of contours without being a piece of contour. Otherwise it
/// would count as one.
fn without_chords(shore: &[DVec2], level: f64, net: &Net) -> Vec<DVec2> {
    with_points_within(shore, |s| {
        let pieces: Vec<Piece> = own(net, s.a, s.b, level, 0.0).collect();
        let has_end = |p: DVec2| pieces.iter().any(|piece| piece.ends.a == p || piece.ends.b == p);
        let is_piece = |piece: &Piece| {
            (piece.ends.a == s.a && piece.ends.b == s.b) || (piece.ends.a == s.b && piece.ends.b == s.a)
        };
        let is_chord = has_end(s.a) && has_end(s.b) && !pieces.iter().any(is_piece);
        if is_chord { vec![s.a.midpoint(s.b)] } else { Vec::new() }
    })
}

/// The line without spikes, pieces that run to a point and straight back. There the lake is narrower than the distance
/// that its vertices moved. Of a ring that consists of spikes, one point is left.
fn without_spikes(mut shore: Vec<DVec2>) -> Vec<DVec2> {
    let is_closed = shore.first() == shore.last();
    let mut kept: Vec<DVec2> = Vec::with_capacity(shore.len());
    for p in shore.drain(..) {
        if kept.len() >= 2 && kept[kept.len() - 2] == p {
            kept.pop();
        } else {
            kept.push(p);
        }
    }
    // A spike where the ring begins.
    let (mut first, mut end) = (0, kept.len());
    while is_closed && end - first >= 3 && kept[first + 1] == kept[end - 2] {
        (first, end) = (first + 1, end - 1);
    }
    kept.truncate(end);
    kept.split_off(first)
}

/// The line with further points, which `within` gives for each segment; they are put in order along the segment.
fn with_points_within(shore: &[DVec2], mut within: impl FnMut(&Segment) -> Vec<DVec2>) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = shore.first().copied().into_iter().collect();
    for w in shore.windows(2) {
        let segment = Segment { a: w[0], b: w[1] };
        let along = segment.b - segment.a;
        let mut new = within(&segment);
        let share = |p: &DVec2| (*p - segment.a).dot(along);
        new.sort_by(|p, q| share(p).total_cmp(&share(q)).then(p.x.total_cmp(&q.x)).then(p.y.total_cmp(&q.y)));
        new.retain(|p| *p != segment.a && *p != segment.b);
        points.extend(new);
        points.push(segment.b);
    }
    points.dedup();
    points
}

/// The first point where shores cross or overlap each other, cross a contour, or touch a contour of another level.
pub(crate) fn conflict(shores: &[Vec<DVec2>], level: f64, net: &Net) -> Option<DVec2> {
    let segments: Vec<Segment> =
        shores.iter().flat_map(|shore| shore.windows(2)).map(|w| Segment { a: w[0], b: w[1] }).collect();
    let boxes = parallel::map_each(&segments, |s| OrientedBox::around(&[s.a, s.b]));
    let own = BoxTree::new(&boxes);
    (0u32..).zip(&segments).find_map(|(i, s)| {
        let clashes = |piece: &Piece| match meeting(s, &piece.ends) {
            Meeting::Apart => false,
            Meeting::Cross => true,
            Meeting::Touch | Meeting::Overlap => piece.level != level,
        };
        let contour = net.near(s.a, s.b, 0.0).into_iter().find(|piece| clashes(piece)).map(|piece| piece.ends);
        let crosses = |t: &Segment| matches!(meeting(s, t), Meeting::Cross | Meeting::Overlap);
        let itself = || {
            let later = own.near(boxes[i as usize]).filter(|t| *t > i && crosses(&segments[*t as usize]));
            later.min().map(|t| segments[t as usize])
        };
        contour.or_else(itself).map(|t| place(s, &t))
    })
}
