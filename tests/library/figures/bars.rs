//! What holds for the subdivision of every sample: constrained Delaunay by brute force, and nothing lost or covered twice.

use std::collections::HashMap;

use geo::{Area, ConvexHull, MultiPoint, Point};
use glam::DVec2;
use robust::{Coord, incircle, orient2d};
use tokosen::contour::ContourMap;

use super::sample::{ALL, ORIGIN, Sample, map, sample};

fn coord(p: DVec2) -> Coord<f64> {
    Coord { x: p.x, y: p.y }
}

fn side(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    orient2d(coord(a), coord(b), coord(p))
}

/// Whether two segments cross in a point inside both.
fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Points strictly inside the circumcircle of a triangle that can be seen from its middle or from near its corners.
fn disturbers([a, b, c]: [DVec2; 3], points: &[DVec2], segments: &[[DVec2; 2]]) -> Vec<DVec2> {
    let middle = (a + b + c) / 3.0;
    let eyes = [middle, middle.lerp(a, 0.9), middle.lerp(b, 0.9), middle.lerp(c, 0.9)];
    // The triangle's own pieces of line, tried first, hide most of what lies beyond them.
    let is_own = |s: &&[DVec2; 2]| s.iter().all(|p| [a, b, c].contains(p));
    let own: Vec<[DVec2; 2]> = segments.iter().filter(is_own).copied().collect();
    let is_hidden = |eye: DVec2, p: DVec2| own.iter().chain(segments).any(|&segment| cross([eye, p], segment));
    let in_circle = |p: &DVec2| incircle(coord(a), coord(b), coord(c), coord(*p)) > 0.0;
    let inside = points.iter().copied().filter(|p| ![a, b, c].contains(p)).filter(in_circle);
    inside.filter(|&p| eyes.iter().any(|&eye| !is_hidden(eye, p))).collect()
}

/// Pieces of contours, relative to the triangulation's origin.
fn segments(sample: &Sample) -> Vec<[DVec2; 2]> {
    let local = |p: &DVec2| *p - sample.subdivision.tin.origin;
    let lines = sample.subdivision.map.contours.iter();
    lines.flat_map(|c| c.points.windows(2).map(|w| [local(&w[0]), local(&w[1])])).collect()
}

#[test]
fn every_triangle_is_constrained_delaunay() {
    for name in ALL {
        let sample = sample(name);
        let tin = &sample.subdivision.tin;
        tin.validate().unwrap();
        let segments = segments(&sample);
        for t in sample.triangles() {
            let found = disturbers(tin.corners(t), &tin.positions, &segments);
            assert!(found.is_empty(), "{name}: triangle {:?} and {found:?}", sample.corners(t));
        }
    }
}

#[test]
fn the_other_diagonal_is_found_out() {
    let sample = sample("fig2_triangles");
    let [a, b, k, l] = [(0.0, 0.0), (90.0, -10.0), (38.0, 41.0), (57.0, 35.0)]
        .map(|p| DVec2::from(p) + ORIGIN - sample.subdivision.tin.origin);
    let found = |corners| disturbers(corners, &sample.subdivision.tin.positions, &segments(&sample));
    assert_eq!(found([a, b, l]), []);
    assert_eq!(found([a, b, k]), [l]);
}

/// Doubled signed area of a closed line.
fn doubled_area(ring: &[DVec2]) -> f64 {
    ring.windows(2).map(|w| (w[0] - ring[0]).perp_dot(w[1] - ring[0])).sum()
}

/// Whether a closed line goes around a point, by crossings of the ray to the east.
fn goes_around(ring: &[DVec2], p: DVec2) -> bool {
    let crossed = ring.windows(2).filter(|w| {
        let [a, b] = [w[0], w[1]];
        (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}

/// The number of the smallest line around a point that is not the line `except`.
fn line_around(map: &ContourMap, p: DVec2, except: Option<usize>) -> Option<usize> {
    let rings = map.contours.iter().enumerate().filter(|(i, c)| Some(*i) != except && goes_around(&c.points, p));
    let area = |points: &[DVec2]| doubled_area(points).abs();
    rings.min_by(|a, b| area(&a.1.points).total_cmp(&area(&b.1.points))).map(|(i, _)| i)
}

/// Each sub-domain is its outer line less the lines directly inside; what is left of the hull lies outside all lines.
#[test]
fn areas_of_triangles_add_up() {
    for name in ALL {
        let (sample, map) = (sample(name), map(name));
        let tin = &sample.subdivision.tin;
        let mut of_region: HashMap<u32, f64> = HashMap::new();
        let mut line_of_region: HashMap<u32, Option<usize>> = HashMap::new();
        for t in sample.triangles() {
            let [a, b, c] = tin.corners(t);
            let region = sample.subdivision.regions.of_triangle[t as usize];
            *of_region.entry(region).or_default() += (b - a).perp_dot(c - a) / 2.0;
            let around = line_around(&map, sample.centre(t) + ORIGIN, None);
            assert_eq!(
                *line_of_region.entry(region).or_insert(around),
                around,
                "{name}: one sub-domain, one line around it"
            );
        }
        let own = |i: usize| doubled_area(&map.contours[i].points).abs() / 2.0;
        let mut wanted: Vec<f64> = (0..map.contours.len()).map(own).collect();
        let points: MultiPoint<f64> =
            map.contours.iter().flat_map(|c| &c.points).map(|p| Point::new(p.x - ORIGIN.x, p.y - ORIGIN.y)).collect();
        let mut outside = points.convex_hull().unsigned_area();
        for i in 0..map.contours.len() {
            match line_around(&map, map.contours[i].points[0], Some(i)) {
                Some(parent) => wanted[parent] -= own(i),
                None => outside -= own(i),
            }
        }
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * points.convex_hull().unsigned_area();
        for (i, &wanted) in wanted.iter().enumerate() {
            let regions: Vec<u32> =
                line_of_region.iter().filter(|(_, line)| **line == Some(i)).map(|(region, _)| *region).collect();
            assert_eq!(regions.len(), 1, "{name}: inside line {i}");
            assert!(near(of_region[&regions[0]], wanted), "{name}: {} and {wanted}", of_region[&regions[0]]);
        }
        let pockets: f64 = line_of_region.iter().filter(|(_, line)| line.is_none()).map(|(r, _)| of_region[r]).sum();
        assert!(near(pockets, outside), "{name}: {pockets} and {outside}");
    }
}
