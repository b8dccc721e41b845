use std::collections::HashSet;

use super::ground::rings;
use super::*;
use crate::base::Grid;
use crate::base::bits::bits;
use crate::mesh::outline::height_at;
use crate::tin::{TinInput, VertexKind, triangulate};

/// Hills with a hollow, on cells of another size in x than in y, far from zero.
fn hills(cols: usize, rows: usize) -> Dem {
    let grid = Grid { corner: DVec2::new(500_000.0, 4_000_000.0), cell: DVec2::new(5.0, 8.0), cols, rows };
    let height = |k: usize| {
        let (x, y) = ((k % cols) as f64, (k / cols) as f64);
        let bumps = (x / 7.0).sin() * (y / 11.0).cos() * 30.0 + (x * y / 900.0).sin() * 4.0;
        (bumps + if x > 40.0 && y > 30.0 { 12.0 } else { 0.0 }) as f32
    };
    Dem { grid, values: (0..cols * rows).map(height).collect(), crs: None }
}

/// Two triangles between the corners of a polygon without holes.
fn ground(dem: &Dem, corners: &[(f64, f64)]) -> Tin {
    let grid = &dem.grid;
    let first = grid.center(0, 0);
    let points: Vec<DVec2> = corners.iter().map(|&(col, row)| first + DVec2::new(col, -row) * grid.cell).collect();
    let mut input = TinInput::new([points[0], points[0] + 1000.0], -1.0);
    points.iter().for_each(|p| {
        input.push(*p, 5.0, VertexKind::Frame);
    });
    triangulate(&input).unwrap()
}

/// The largest error at the cells inside, each compared with every triangle that covers it; and how many were covered.
fn brute_force(tin: &Tin, dem: &Dem) -> (f64, usize) {
    let (mut worst, mut covered) = (0.0_f64, 0);
    for (k, &height) in dem.values.iter().enumerate().filter(|(_, h)| h.is_finite()) {
        let p = dem.grid.center(k % dem.grid.cols, k / dem.grid.cols) - tin.origin;
        let over: Vec<u32> = (0..tin.len() as u32).filter(|&t| tin.weights(t, p).iter().all(|w| *w >= -1e-9)).collect();
        covered += usize::from(!over.is_empty());
        for t in over {
            let own: f64 = tin.weights(t, p).iter().zip(tin.corner_heights(t)).map(|(w, h)| w * h).sum();
            worst = worst.max((own - f64::from(height)).abs());
        }
    }
    (worst, covered)
}

fn area(tin: &Tin) -> f64 {
    let doubled = |t: u32| {
        let [a, b, c] = tin.corners(t);
        assert!((b - a).perp_dot(c - a) > 0.0, "triangle {t} is turned over");
        (b - a).perp_dot(c - a)
    };
    (0..tin.len() as u32).map(doubled).sum::<f64>() / 2.0
}

#[test]
fn no_cell_is_further_than_the_tolerance() {
    let dem = hills(70, 50);
    // The corners of the first are centres of cells; the second cuts cells anyhow, in an irregular hexagon.
    let rectangle = [(0.0, 0.0), (0.0, 49.0), (69.0, 49.0), (69.0, 0.0)];
    let hexagon = [(3.3, 20.1), (10.7, 44.9), (40.2, 48.6), (66.6, 30.3), (51.4, 2.2), (20.5, 1.7)];
    for corners in [&rectangle[..], &hexagon] {
        let base = ground(&dem, corners);
        let mut before = usize::MAX;
        for tolerance in [0.05, 0.5, 5.0] {
            let few = light(&Outline::of_tin(&base), &dem, tolerance).unwrap();
            let (worst, covered) = brute_force(&few, &dem);
            assert!(worst <= tolerance + 1e-6, "{worst} > {tolerance}");
            assert_eq!(covered, brute_force(&base, &dem).1);
            assert!((area(&few) / area(&base) - 1.0).abs() < 1e-9);
            assert!(few.len() < before && few.len() > 4, "{} triangles", few.len());
            before = few.len();
        }
    }
}

#[test]
fn cells_without_a_height_ask_for_nothing() {
    let mut dem = hills(20, 20);
    dem.values.iter_mut().for_each(|height| *height = 5.0);
    dem.values[7 * 20 + 7] = f32::NAN;
    let base = ground(&dem, &[(0.0, 0.0), (0.0, 19.0), (19.0, 19.0), (19.0, 0.0)]);
    assert_eq!(light(&Outline::of_tin(&base), &dem, 0.1).unwrap().len(), 2);
    assert!(
        light(&Outline::of_tin(&base), &dem, 0.0).is_err() && light(&Outline::of_tin(&base), &dem, f64::NAN).is_err()
    );
}

#[test]
fn a_height_map_has_triangles_between_its_centres_and_holes_where_heights_are_missing() {
    let mut dem = hills(60, 40);
    let missing = [20 * 60 + 20, 20 * 60 + 21, 35 * 60 + 59, 0];
    missing.iter().for_each(|cell| dem.values[*cell] = f32::NAN);
    let outline = Outline::of_cells(&dem);
    let few = light(&outline, &dem, 0.5).unwrap();
    let (worst, covered) = brute_force(&few, &dem);
    assert!(worst <= 0.5 + 1e-6, "{worst}");
    assert_eq!(covered, 60 * 40 - missing.len());
    // The squares at one of two neighbours are six; at a side two; at a corner one.
    let squares = 59.0 * 39.0 - 6.0 - 2.0 - 1.0;
    assert!((area(&few) / (squares * 40.0) - 1.0).abs() < 1e-9, "{}", area(&few) / 40.0);
    let mesh = crate::mesh::height_mesh(&dem, None, Some(0.5)).unwrap();
    mesh.validate().unwrap();
    assert!((mesh.plan_area() - area(&few)).abs() < 1e-6 && mesh.triangles.len() == few.len());
    dem.values.fill(f32::NAN);
    assert!(crate::mesh::height_mesh(&dem, None, Some(0.5)).is_err());
}

#[test]
fn an_outline_keeps_its_corners_and_its_heights() {
    let dem = hills(20, 20);
    let corners =
        [(2.0, 2.0), (2.0, 17.0), (17.0, 17.0), (17.0, 9.5), (17.0, 2.0)].map(|(x, y)| DVec3::new(x, -y, 0.0));
    let mut ring = corners.to_vec();
    let border: Vec<[u32; 2]> = (0..5).map(|k| [k, (k + 1) % 5]).collect();
    let place = |v: DVec3| v.truncate();
    let kept = |ring: &[DVec3], ends: &[DVec3]| {
        let (vertices, edges) = (ring.to_vec(), border.clone());
        let outline = Outline { vertices, edges, kept: Vec::new(), lines: Vec::new(), origin: DVec2::ZERO };
        rings(&outline, &place, 0.1, &ends.iter().map(|end| bits(end.truncate())).collect())[0].len()
    };
    assert_eq!(kept(&ring, &[]), 4, "the vertex on the straight side is not needed");
    assert_eq!(kept(&ring, &[ring[3]]), 5, "a line ends there");
    ring[3].z = 0.2;
    assert_eq!(kept(&ring, &[]), 5);
    assert!(height_at(&dem, DVec2::new(-1.0, 0.0)).is_none() && height_at(&dem, DVec2::new(19.0, -19.0)).is_some());
}

#[test]
fn lines_that_are_kept_are_chains_of_edges_and_the_tolerance_holds_beside_them() {
    let dem = hills(70, 50);
    let place = |col: f64, row: f64| dem.grid.center(0, 0) + DVec2::new(col, -row) * dem.grid.cell;
    // The first ends on the border; the second runs along a row of centres, and anyhow.
    let lines = [
        vec![(0.0, 20.3), (30.4, 20.3), (47.5, 31.25), (60.3, 44.6)],
        // It crosses the first.
        vec![(10.0, 6.0), (20.0, 6.0), (30.3, 34.7), (40.8, 3.3), (66.0, 8.0)],
    ];
    let height = |(col, row): (f64, f64)| height_at(&dem, DVec2::new(col.round(), -row.round())).unwrap();
    let mut input = TinInput::new([place(0.0, 49.0), place(69.0, 0.0)], -1.0);
    for (col, row) in [(0.0, 0.0), (0.0, 49.0), (69.0, 49.0), (69.0, 0.0)] {
        input.push(place(col, row), height((col, row)), VertexKind::Frame);
    }
    // The first is a contour, as far as the triangulation knows, the second a break line.
    for (k, &at) in lines[0].iter().enumerate() {
        let v = input.push(place(at.0, at.1), 0.0, VertexKind::Contour);
        if k > 0 {
            input.push_edge(v - 1, v);
        }
    }
    let base = triangulate(input).unwrap();
    let level = |base: &Tin| (0..base.len() as u32).any(|t| (0..3).any(|i| base.contour_level(t, i) == Some(0.0)));
    assert!(level(&base));
    let line = || lines[1..].iter().map(|line| line.iter().map(|&at| place(at.0, at.1).extend(height(at))).collect());
    for tolerance in [0.5, 5.0] {
        let few = light(&Outline::of_tin(&base).with_contours(&base).with_lines(line()), &dem, tolerance).unwrap();
        let (worst, covered) = brute_force(&few, &dem);
        assert!(worst <= tolerance + 1e-6 && covered == 70 * 50, "{worst} > {tolerance}");
        area(&few);
        let edges: HashSet<[u32; 2]> = (0..few.len() as u32).flat_map(|t| [0, 1, 2].map(|i| few.edge(t, i))).collect();
        let vertex = |p: DVec2| few.positions.iter().position(|v| bits(*v + few.origin) == bits(p)).unwrap();
        for ends in lines.iter().flat_map(|line| line.windows(2)) {
            let [from, to] = [ends[0], ends[1]].map(|(col, row)| place(col, row));
            let way = to - from;
            let share = |v: usize| (few.positions[v] + few.origin - from).dot(way) / way.length_squared();
            let is_on = |v: &usize| {
                let p = few.positions[*v] + few.origin - from;
                (way.perp_dot(p) / way.length()).abs() < 1e-4 && (0.0..=1.0).contains(&share(*v))
            };
            let mut chain: Vec<usize> = (0..few.positions.len()).filter(is_on).collect();
            chain.sort_by(|a, b| share(*a).total_cmp(&share(*b)));
            assert_eq!((chain[0], chain[chain.len() - 1]), (vertex(from), vertex(to)));
            for pair in chain.windows(2) {
                let [u, v] = [pair[0] as u32, pair[1] as u32];
                assert!(edges.contains(&[u, v]) || edges.contains(&[v, u]), "{from} {to}: {chain:?}");
            }
        }
    }
}
