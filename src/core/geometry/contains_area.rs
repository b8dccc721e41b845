//! Whether an area lies in another.

use geo::{Contains, MultiPolygon};
use glam::DVec2;

use super::{Border, Meeting, meeting, rings};

/// Whether all of `inner` lies in `outer`. Their borders may touch.
///
/// Where the borders do not touch, it takes few steps for each edge, also of outlines with long spikes.
pub fn contains_area(outer: &MultiPolygon<f64>, inner: &MultiPolygon<f64>) -> bool {
    let [outside, inside] = [Border::new(outer), Border::new(inner)];
    let mut is_touched = false;
    for edge in inside.edges().iter().filter(|edge| edge.a != edge.b) {
        for (_, other) in outside.near(edge.a, edge.b).filter(|(_, other)| other.a != other.b) {
            match meeting(edge, &other) {
                Meeting::Apart => {}
                Meeting::Cross => return false,
                Meeting::Touch | Meeting::Overlap => is_touched = true,
            }
        }
    }
    if is_touched || inner.0.is_empty() || outer.0.is_empty() {
        return outer.contains(inner);
    }
    // With borders apart, each ring lies on one side of the other border.
    let all_are = |area: &MultiPolygon<f64>, border: &Border, is_in: bool| {
        rings(area).filter_map(|ring| ring.0.first()).all(|c| border.contains(DVec2::new(c.x, c.y)) == is_in)
    };
    all_are(inner, &outside, true) && all_are(outer, &inside, false)
}

#[cfg(test)]
mod tests {
    use geo::{Polygon, Rect, coord};

    use super::*;

    fn square(from: f64, to: f64) -> Polygon<f64> {
        Rect::new(coord! { x: from, y: from }, coord! { x: to, y: to }).to_polygon()
    }

    #[test]
    fn areas_in_others_beside_them_and_around_their_holes() {
        let hollow = Polygon::new(square(0.0, 10.0).exterior().clone(), vec![square(4.0, 6.0).exterior().clone()]);
        let solid = square(0.0, 10.0);
        for outer in [&hollow, &solid] {
            for inner in
                [(1.0, 2.0), (0.0, 2.0), (3.0, 7.0), (4.5, 5.5), (4.0, 6.0), (9.0, 11.0), (-1.0, 11.0), (12.0, 13.0)]
            {
                let (outer, inner) = (MultiPolygon::from(outer.clone()), square(inner.0, inner.1).into());
                assert_eq!(contains_area(&outer, &inner), outer.contains(&inner), "{inner:?}");
            }
        }
        let none = MultiPolygon::new(Vec::new());
        assert!(!contains_area(&solid.into(), &none));
    }
}
