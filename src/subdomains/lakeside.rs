//! Ground beside lakes, where the band of the sub-domain reaches below their level.
//!
//! A sub-domain can have a contour below a lake far away from it. Its band then reaches down to this contour everywhere.
//! But ground that is nearer to the shore than to anything lower does not lie below the lake: otherwise it would be under
//! water. Towards the lower contour, half-way, the ground may fall: a lake has an outlet.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use foldhash::HashMap;
use glam::DVec2;

use super::Regions;
use crate::base::parallel;
use crate::tin::{Tin, VertexKind};

/// Ground within this share of the way from the shore to lower ground is not below the lake.
const NEARER: f64 = 0.5;

/// What the shore says about the ground in a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lakeside {
    /// The level of the nearest lake; the lowest one if they differ between the corners.
    level: f64,
    /// For each corner: how far it is on the way from the shore (0) to known ground below the lake (1).
    shares: [f64; 3],
}

impl Lakeside {
    /// The level below which the ground at `p` in triangle `t` does not lie, if the shore is near enough. The position is
    /// relative to the triangulation's origin.
    pub fn floor(&self, tin: &Tin, t: u32, p: DVec2) -> Option<f64> {
        let [a, b, c] = tin.corners(t);
        let area = (b - a).perp_dot(c - a);
        let (wb, wc) = ((p - a).perp_dot(c - a) / area, (b - a).perp_dot(p - a) / area);
        let [sa, sb, sc] = self.shares;
        (sa + wb * (sb - sa) + wc * (sc - sa) <= NEARER).then_some(self.level)
    }
}

/// The triangles of land where a shore is nearer than known ground below it: contours and `given` heights of vertices.
/// Distances run along edges of triangles, inside the sub-domain. Only sub-domains whose band reaches below a shore count.
pub(crate) fn lakesides(
    tin: &Tin,
    regions: &Regions,
    given: impl Fn(u32) -> Option<f64> + Sync,
) -> HashMap<u32, Lakeside> {
    let mut highest = vec![f64::NEG_INFINITY; regions.regions.len()];
    for (t, i) in (0..tin.len() as u32).flat_map(|t| (0..3).map(move |i| (t, i))).filter(|&(t, i)| tin.is_shore(t, i)) {
        if regions.region(t).is_some_and(|region| region.water.is_none()) {
            let of_region = &mut highest[regions.of_triangle[t as usize] as usize];
            *of_region = of_region.max(tin.heights[tin.edge(t, i)[0] as usize]);
        }
    }
    let mut triangles: HashMap<u32, Vec<u32>> = HashMap::default();
    for t in 0..tin.len() as u32 {
        let Some(region) = regions.region(t).filter(|_| tin.is_inside(t)) else { continue };
        let r = regions.of_triangle[t as usize];
        if highest[r as usize] > region.band.lo {
            triangles.entry(r).or_default().push(t);
        }
    }
    let mut lands: Vec<(f64, Vec<u32>)> = triangles.into_iter().map(|(r, of)| (highest[r as usize], of)).collect();
    lands.sort_by_key(|(_, triangles)| triangles[0]);
    let found = parallel::flat_map(lands.len(), |k| beside(tin, &lands[k].1, lands[k].0, &given));
    found.into_iter().collect()
}

/// The same for the triangles of one sub-domain. `highest` is its highest shore.
fn beside(tin: &Tin, triangles: &[u32], highest: f64, given: &impl Fn(u32) -> Option<f64>) -> Vec<(u32, Lakeside)> {
    let (mut ways, mut shores, mut lower): (HashMap<u32, Vec<u32>>, _, _) =
        (HashMap::default(), Vec::new(), Vec::new());
    for &t in triangles {
        for i in 0..3 {
            let [v, w] = tin.edge(t, i);
            ways.entry(v).or_default().push(w);
            ways.entry(w).or_default().push(v);
            if tin.is_shore(t, i) {
                shores.extend([v, w]);
            }
            let is_level = tin.kinds[v as usize] == VertexKind::Contour;
            let height = if is_level { Some(tin.heights[v as usize]) } else { given(v) };
            lower.extend(height.filter(|height| *height < highest).map(|height| (v, height)));
        }
    }
    let shores = nearest(tin, &ways, shores.into_iter().map(|v| (v, tin.heights[v as usize])));
    let lower = nearest(tin, &ways, lower.into_iter());
    let at_corner = |v: u32| {
        let &(shore, level) = shores.get(&v)?;
        let share = match lower.get(&v) {
            None => 0.0,
            // Ground between the levels of two lakes is not below the lower one, and what is below it may be near too.
            Some(&(_, height)) if height >= level => 1.0,
            Some(&(distance, _)) if distance == 0.0 => 1.0,
            Some(&(distance, _)) => shore / (shore + distance),
        };
        Some((share, level))
    };
    let side = |&t: &u32| {
        let [Some(a), Some(b), Some(c)] = tin.triangles[t as usize].map(at_corner) else { return None };
        let shares = [a.0, b.0, c.0];
        let is_near = shares.iter().any(|share| *share <= NEARER);
        is_near.then_some((t, Lakeside { level: a.1.min(b.1).min(c.1), shares }))
    };
    triangles.iter().filter_map(side).collect()
}

/// The distance of each vertex to the nearest one `from` which the search begins, along the edges, and the height there.
fn nearest(
    tin: &Tin,
    ways: &HashMap<u32, Vec<u32>>,
    from: impl Iterator<Item = (u32, f64)>,
) -> HashMap<u32, (f64, f64)> {
    let mut found: HashMap<u32, (f64, f64)> = HashMap::default();
    // The bits of numbers that are not negative have the order of the numbers.
    let mut open: BinaryHeap<_> = from.map(|(v, height)| Reverse((0, v, height.to_bits()))).collect();
    while let Some(Reverse((bits, v, height))) = open.pop() {
        if found.contains_key(&v) {
            continue;
        }
        let distance = f64::from_bits(bits);
        found.insert(v, (distance, f64::from_bits(height)));
        let place = |v: u32| tin.positions[v as usize];
        for &w in ways.get(&v).into_iter().flatten().filter(|w| !found.contains_key(w)) {
            open.push(Reverse(((distance + place(v).distance(place(w))).to_bits(), w, height)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::Interval;
    use crate::subdomains::{regions, with_water};
    use crate::tin::{TinInput, triangulate};

    /// Points every 5 units along a line.
    fn dense(corners: &[(f64, f64)]) -> Vec<DVec2> {
        let corners: Vec<DVec2> = corners.iter().copied().map(DVec2::from).collect();
        let piece = |w: &[DVec2]| {
            let count = (w[0].distance(w[1]) / 5.0).ceil() as usize;
            let (a, b) = (w[0], w[1]);
            (0..count).map(move |k| a.lerp(b, k as f64 / count as f64))
        };
        corners.windows(2).flat_map(piece).chain(corners.last().copied()).collect()
    }

    #[test]
    fn ground_is_below_a_lake_only_nearer_to_a_lower_contour() {
        // A valley from a lake at 95 in the west to a contour of 90 in the east, in a ring of 100.
        let mut input = TinInput::new([DVec2::new(-200.0, -60.0), DVec2::new(200.0, 60.0)], 1e-7);
        let ring = dense(&[(-190.0, -50.0), (190.0, -50.0), (190.0, 50.0), (-190.0, 50.0), (-190.0, -50.0)]);
        input.push_line(&ring, 100.0, VertexKind::Contour);
        let low = dense(&[(120.0, -20.0), (160.0, -20.0), (160.0, 20.0), (120.0, 20.0), (120.0, -20.0)]);
        input.push_line(&low, 90.0, VertexKind::Contour);
        let shore = dense(&[(-160.0, -20.0), (-100.0, -20.0), (-100.0, 20.0), (-160.0, 20.0), (-160.0, -20.0)]);
        input.push_line(&shore, 95.0, VertexKind::Shore);
        for k in 0..20 {
            input.push(DVec2::new(-95.0 + 10.0 * f64::from(k), 0.0), 95.5, VertexKind::Axis);
        }
        let in_lake = |p: DVec2| (-160.0..-100.0).contains(&p.x) && p.y.abs() < 20.0;
        let tin = triangulate(input).unwrap().with_lakes(|p| in_lake(p).then_some(0));
        let whole = regions(&tin, &Interval { step: 10.0, base: 0.0 });
        let regions = with_water(whole, &tin, &[95.0], None);
        let floors = |given: &dyn Fn(u32) -> Option<f64>, places: &[f64]| {
            let given: HashMap<u32, f64> =
                (0..tin.positions.len() as u32).filter_map(|v| Some((v, given(v)?))).collect();
            let sides = lakesides(&tin, &regions, |v| given.get(&v).copied());
            let floor = |x: &f64| {
                let p = DVec2::new(*x, 1.0) - tin.origin;
                let t = tin.locate(0, p).unwrap();
                sides.get(&t).and_then(|side| side.floor(&tin, t, p))
            };
            places.iter().map(floor).collect::<Vec<_>>()
        };
        let beside = Some(95.0);
        let places = [-175.0, -130.0, -90.0, -20.0, 40.0, 110.0];
        assert_eq!(floors(&|_| None, &places), [beside, None, beside, beside, None, None]);
        // A stream that is known to be lower ends the ground beside the lake nearer to it.
        let on_stream = |v: u32| {
            let p = tin.positions[v as usize] + tin.origin;
            (p.y.abs() < 1e-9 && (-66.0..120.0).contains(&p.x)).then_some(94.0)
        };
        assert_eq!(floors(&on_stream, &places), [beside, None, beside, None, None, None]);
    }
}
