//! Leaves out what lies inside polygons.

use std::collections::HashSet;

use geo::{BoundingRect, Coord, MultiPolygon, Polygon, Rect};
use glam::DVec2;

use super::clip::clip;
use super::map::{Contour, ContourMap};
use crate::base::bits::bits;
use crate::geometry::{Border, rings, tolerance};

/// Width of the surroundings of a polygon and its lines, as a share of their size. Any positive share works.
const MARGIN: f64 = 0.1;

/// What was left out inside an area.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CutOut {
    /// Number of contours that were cut or left out as a whole.
    pub lines: usize,
    /// Length of contours that was left out, map units.
    pub length: f64,
    /// Number of spot heights that were left out.
    pub spots: usize,
}

impl CutOut {
    /// Whether nothing was left out.
    pub fn is_empty(&self) -> bool {
        self.lines == 0 && self.spots == 0
    }
}

/// Leaves out the contours and spot heights inside areas. Contours are cut at the borders; elsewhere their vertices do not
/// change, and a line that only touches a border does not change at all. The new ends are added to
/// [`ContourMap::cut_ends`]. Returns what each area took away.
///
/// The lines have valid coordinates. The polygons of an area must not overlap, and none may cross itself. Where areas
/// overlap, the first one takes.
pub fn cut_out(map: &mut ContourMap, areas: &[MultiPolygon<f64>]) -> Vec<CutOut> {
    let mut lines: Vec<(Bounds, Contour)> =
        std::mem::take(&mut map.contours).into_iter().map(|line| (Bounds::of(&line), line)).collect();
    let mut found = Vec::with_capacity(areas.len());
    for area in areas {
        let Some(rect) = area.bounding_rect() else {
            found.push(CutOut::default());
            continue;
        };
        let near: Vec<usize> = (0..lines.len()).filter(|&k| lines[k].0.meets(&rect)).collect();
        let mut taken = cut_lines(&mut lines, &near, area, &rect, &mut map.cut_ends);
        let border = Border::new(area);
        let before = map.spots.len() + map.soft_spots.len();
        let is_in = |p: DVec2| holds(&rect, p) && border.contains(p);
        map.spots.retain(|spot| !is_in(spot.truncate()));
        map.soft_spots.retain(|spot| !is_in(spot.place.truncate()));
        taken.spots = before - map.spots.len() - map.soft_spots.len();
        found.push(taken);
    }
    map.contours = lines.into_iter().map(|(_, line)| line).filter(|line| !line.points.is_empty()).collect();
    found
}

/// Cuts the lines with these numbers. Of a line that is cut, the first piece takes its place and the others are added at
/// the end. A line that is left out as a whole keeps no point.
fn cut_lines(
    lines: &mut Vec<(Bounds, Contour)>,
    near: &[usize],
    area: &MultiPolygon<f64>,
    rect: &Rect<f64>,
    cut_ends: &mut Vec<DVec2>,
) -> CutOut {
    let mut taken = CutOut::default();
    let around = near.iter().fold(Bounds::from(rect), |around, &k| around.joined(&lines[k].0));
    let surroundings = around.without(area);
    let least = tolerance(&surroundings);
    // The number of a line takes the place of its feature, so that its pieces are known.
    let numbered = near.iter().map(|&k| Contour { feature: (k as u64).into(), ..lines[k].1.clone() });
    let map = ContourMap { contours: numbered.collect(), ..ContourMap::default() };
    let pieces = clip(map, &surroundings).map.contours;
    let mut pieces = pieces.into_iter().peekable();
    for &k in near {
        let mut kept: Vec<Contour> = Vec::new();
        while let Some(piece) = pieces.next_if(|piece| piece.feature.number() == k as u64) {
            kept.push(Contour { feature: lines[k].1.feature, ..piece });
        }
        let line = &lines[k].1;
        let lost = line.length() - kept.iter().map(Contour::length).sum::<f64>();
        // A line that touches the border is as long as before.
        if !kept.is_empty() && lost <= least {
            continue;
        }
        taken.lines += 1;
        taken.length += lost;
        let own: HashSet<[u64; 2]> =
            if line.is_closed() { HashSet::new() } else { ends(line).into_iter().map(bits).collect() };
        cut_ends.extend(kept.iter().flat_map(ends).filter(|end| !own.contains(&bits(*end))));
        let mut kept = kept.into_iter();
        match kept.next() {
            Some(first) => lines[k] = (Bounds::of(&first), first),
            None => {
                lines[k].0 = Bounds::default();
                lines[k].1.points = Vec::new();
            }
        }
        lines.extend(kept.map(|piece| (Bounds::of(&piece), piece)));
    }
    taken
}

fn ends(line: &Contour) -> Vec<DVec2> {
    line.points.first().into_iter().chain(line.points.last()).copied().collect()
}

fn holds(rect: &Rect<f64>, p: DVec2) -> bool {
    (rect.min().x..=rect.max().x).contains(&p.x) && (rect.min().y..=rect.max().y).contains(&p.y)
}

/// The box around a line.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    lo: DVec2,
    hi: DVec2,
}

impl Default for Bounds {
    /// The box around nothing.
    fn default() -> Self {
        Self { lo: DVec2::INFINITY, hi: DVec2::NEG_INFINITY }
    }
}

impl From<&Rect<f64>> for Bounds {
    fn from(rect: &Rect<f64>) -> Self {
        let [lo, hi] = [rect.min(), rect.max()].map(|c| DVec2::new(c.x, c.y));
        Self { lo, hi }
    }
}

impl Bounds {
    fn of(line: &Contour) -> Self {
        line.points.iter().fold(Self::default(), |b, p| Self { lo: b.lo.min(*p), hi: b.hi.max(*p) })
    }

    fn meets(&self, rect: &Rect<f64>) -> bool {
        let other = Self::from(rect);
        self.lo.cmple(other.hi).all() && self.hi.cmpge(other.lo).all()
    }

    fn joined(&self, other: &Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// A larger box without an area. Whether a position lies inside depends on the number of rings around it, so the
    /// rings of all polygons and of their holes can be holes of the box.
    fn without(&self, area: &MultiPolygon<f64>) -> MultiPolygon<f64> {
        let margin = DVec2::splat(MARGIN * self.lo.distance(self.hi));
        let corner = |p: DVec2| Coord { x: p.x, y: p.y };
        let box_ring = Rect::new(corner(self.lo - margin), corner(self.hi + margin)).to_polygon().into_inner().0;
        MultiPolygon::new(vec![Polygon::new(box_ring, rings(area).cloned().collect())])
    }
}

#[cfg(test)]
mod tests {
    use geo::polygon;
    use glam::DVec3;

    use super::*;

    fn line(points: &[(f64, f64)]) -> Contour {
        Contour { elevation: 10.0, points: points.iter().map(|&p| p.into()).collect(), feature: 7.into() }
    }

    fn square(west: f64, south: f64, side: f64) -> MultiPolygon<f64> {
        let (east, north) = (west + side, south + side);
        polygon![(x: west, y: south), (x: east, y: south), (x: east, y: north), (x: west, y: north)].into()
    }

    fn cut(lines: &[Contour], areas: &[MultiPolygon<f64>]) -> (ContourMap, Vec<CutOut>) {
        let mut map = ContourMap { contours: lines.to_vec(), ..ContourMap::default() };
        let found = cut_out(&mut map, areas);
        (map, found)
    }

    #[test]
    fn a_line_across_is_cut_and_keeps_its_other_vertices() {
        let across = line(&[(0.0, 5.0), (3.0, 5.0), (5.0, 5.0), (9.0, 5.0), (20.0, 5.1)]);
        let far = line(&[(50.0, 0.0), (60.0, 1.0)]);
        let (map, found) = cut(&[across, far.clone()], &[square(4.0, 4.0, 2.0)]);
        assert_eq!(found, [CutOut { lines: 1, length: 2.0, spots: 0 }]);
        let first = line(&[(0.0, 5.0), (3.0, 5.0), (4.0, 5.0)]);
        let last = line(&[(6.0, 5.0), (9.0, 5.0), (20.0, 5.1)]);
        assert_eq!(map.contours, [first, far, last]);
        assert_eq!(map.cut_ends, [DVec2::new(4.0, 5.0), DVec2::new(6.0, 5.0)]);
    }

    #[test]
    fn what_is_inside_goes_and_what_touches_stays_as_it_is() {
        let inside = line(&[(4.5, 4.5), (5.0, 5.5), (5.5, 4.5), (4.5, 4.5)]);
        let touching = line(&[(0.0, 0.0), (4.0, 4.5), (0.0, 9.0)]);
        let along_corner = line(&[(2.0, 6.0), (6.0, 2.0)]);
        let areas = [square(4.0, 4.0, 2.0)];
        let mut map =
            ContourMap { contours: vec![inside, touching.clone(), along_corner.clone()], ..Default::default() };
        map.spots = vec![DVec3::new(5.0, 5.0, 1.0), DVec3::new(9.0, 5.0, 1.0), DVec3::new(f64::NAN, 5.0, 1.0)];
        let found = cut_out(&mut map, &areas);
        assert_eq!((found[0].lines, found[0].spots, map.spots.len()), (1, 1, 2));
        assert_eq!(map.contours, [touching, along_corner]);
        assert!(map.cut_ends.is_empty());
    }

    #[test]
    fn a_ring_is_cut_open_and_islands_keep_their_lines() {
        let ring = line(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)]);
        let (map, found) = cut(&[ring], &[square(9.0, 4.0, 2.0)]);
        assert_eq!((map.contours.len(), found[0].length), (1, 2.0));
        assert_eq!(map.contours[0].points.len(), 6);
        assert_eq!(map.cut_ends.len(), 2);
        let holed = polygon!(
            exterior: [(x: 0.0, y: 0.0), (x: 9.0, y: 0.0), (x: 9.0, y: 9.0), (x: 0.0, y: 9.0)],
            interiors: [[(x: 3.0, y: 3.0), (x: 3.0, y: 6.0), (x: 6.0, y: 6.0), (x: 6.0, y: 3.0)]],
        );
        let (map, found) = cut(&[line(&[(-1.0, 5.0), (10.0, 5.0)])], &[holed.into()]);
        assert_eq!(map.contours.iter().map(Contour::length).collect::<Vec<_>>(), [1.0, 3.0, 1.0]);
        assert_eq!(found[0].length, 6.0);
    }

    #[test]
    fn several_areas_take_one_after_the_other() {
        let lines = [line(&[(0.0, 0.0), (30.0, 0.0)])];
        let areas = [square(4.0, -1.0, 2.0), square(5.0, -1.0, 2.0), square(20.0, -1.0, 2.0), square(50.0, 0.0, 1.0)];
        let (map, found) = cut(&lines, &areas);
        assert_eq!(found.iter().map(|taken| taken.length).collect::<Vec<_>>(), [2.0, 1.0, 2.0, 0.0]);
        assert!(found[3].is_empty());
        let total: f64 = map.contours.iter().map(Contour::length).sum();
        assert_eq!((map.contours.len(), total), (3, 25.0));
        assert_eq!(cut(&[], &areas).1.len(), 4);
        assert!(cut(&lines, &[MultiPolygon::new(vec![])]).1[0].is_empty());
    }
}
