//! Clips a map to an area, so that its contours end exactly on the area's border.

use geo::{Contains, MultiPolygon};
use glam::DVec2;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use super::{Contour, ContourMap};

/// A map cut to an area, and the area with every cut as a vertex of its border.
#[derive(Debug, Clone, PartialEq)]
pub struct Clipped {
    /// The pieces of contours and the spot heights inside the area.
    pub map: ContourMap,
    /// Where contours were cut, on the area's border.
    pub cuts: Vec<DVec2>,
}

/// Cuts contours where they cross the border of `area` and keeps what lies inside, its own vertices unchanged.
pub fn clip(map: ContourMap, area: &MultiPolygon<f64>) -> Clipped {
    let border: Vec<_> = area
        .iter()
        .flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()))
        .flat_map(|ring| ring.lines())
        .enumerate()
        .map(|(id, l)| GeomWithData::new(Line::new([l.start.x, l.start.y], [l.end.x, l.end.y]), id as u32))
        .collect();
    let border = RTree::bulk_load(border);
    let inside = |p: DVec2| area.contains(&geo::Point::new(p.x, p.y));
    let mut clipped = Clipped { map: ContourMap { crs: map.crs, ..ContourMap::default() }, cuts: Vec::new() };
    clipped.map.spots = map.spots.into_iter().filter(|s| inside(s.truncate())).collect();
    for contour in map.contours {
        let (pieces, cuts) = pieces_of(&contour, &border);
        let kept = pieces.into_iter().filter(|piece| inside(middle_of(piece)));
        clipped.map.contours.extend(kept.map(|points| Contour { points, ..contour }));
        clipped.cuts.extend(cuts);
    }
    clipped
}

type Border = RTree<GeomWithData<Line<[f64; 2]>, u32>>;

/// The pieces of a contour between its crossings with the border, and the crossings.
fn pieces_of(contour: &Contour, border: &Border) -> (Vec<Vec<DVec2>>, Vec<DVec2>) {
    let mut pieces = vec![vec![contour.points[0]]];
    let mut cuts = Vec::new();
    for w in contour.points.windows(2) {
        for cut in crossings(w[0], w[1], border) {
            if let Some(piece) = pieces.last_mut()
                && piece.last() != Some(&cut)
            {
                piece.push(cut);
            }
            pieces.push(vec![cut]);
            cuts.push(cut);
        }
        if let Some(piece) = pieces.last_mut()
            && piece.last() != Some(&w[1])
        {
            piece.push(w[1]);
        }
    }
    // A ring starts somewhere between two crossings: its first and last piece are one.
    if contour.is_closed() && pieces.len() > 1 {
        let first = pieces.remove(0);
        if let Some(last) = pieces.last_mut() {
            last.extend(first.into_iter().skip(1));
        }
    }
    pieces.retain(|p| p.len() >= 2);
    (pieces, cuts)
}

/// Where the segment crosses the border, from `a` to `b`.
fn crossings(a: DVec2, b: DVec2, border: &Border) -> Vec<DVec2> {
    let mut found: Vec<f64> = border
        .locate_in_envelope_intersecting(&AABB::from_corners(a.to_array(), b.to_array()))
        .filter_map(|edge| {
            let (c, d) = (DVec2::from(edge.geom().from), DVec2::from(edge.geom().to));
            let across = (b - a).perp_dot(d - c);
            if across == 0.0 {
                return None;
            }
            let t = (c - a).perp_dot(d - c) / across;
            let s = (c - a).perp_dot(b - a) / across;
            ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some(t)
        })
        .collect();
    found.sort_by(f64::total_cmp);
    found.dedup();
    found
        .into_iter()
        .map(|t| {
            if t == 0.0 {
                a
            } else if t == 1.0 {
                b
            } else {
                a + (b - a) * t
            }
        })
        .collect()
}

/// A point of the piece away from its ends.
fn middle_of(piece: &[DVec2]) -> DVec2 {
    let longest = piece.windows(2).max_by(|a, b| a[0].distance(a[1]).total_cmp(&b[0].distance(b[1])));
    longest.map_or(piece[0], |w| w[0].midpoint(w[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use geo::polygon;

    #[test]
    fn a_ring_across_the_border_keeps_its_inner_part_in_one_piece() {
        let area: MultiPolygon<f64> =
            polygon![(x: 0.0, y: 0.0), (x: 10.0, y: 0.0), (x: 10.0, y: 10.0), (x: 0.0, y: 10.0)].into();
        let ring = [(5.0, 2.0), (15.0, 2.0), (15.0, 8.0), (5.0, 8.0), (5.0, 2.0)].map(DVec2::from).to_vec();
        let map = ContourMap {
            contours: vec![Contour { elevation: 10.0, points: ring, feature: 1 }],
            spots: vec![glam::DVec3::new(1.0, 1.0, 3.0), glam::DVec3::new(11.0, 1.0, 3.0)],
            crs: None,
        };
        let clipped = clip(map, &area);
        let expected = [(10.0, 8.0), (5.0, 8.0), (5.0, 2.0), (10.0, 2.0)].map(DVec2::from).to_vec();
        assert_eq!(clipped.map.contours.len(), 1);
        assert_eq!(clipped.map.contours[0].points, expected);
        assert_eq!(clipped.map.spots.len(), 1);
        assert_eq!(clipped.cuts.len(), 2);
    }
}
