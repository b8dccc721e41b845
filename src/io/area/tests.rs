use std::path::Path;

use crate::area::*;
use crate::table::{Feature, Purpose, Request, Rings};

const PATH: &str = "frame.geojson";

fn square(x: f64, y: f64, side: f64) -> Vec<DVec2> {
    [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side), (0.0, 0.0)].map(|(u, v)| DVec2::new(x + u, y + v)).to_vec()
}

fn points(points: &[(f64, f64)]) -> Vec<DVec2> {
    points.iter().map(|&p| p.into()).collect()
}

/// The area of features of one polygon each, numbered from 0.
fn read(polygons: &[Rings]) -> Result<MultiPolygon<f64>> {
    let mut table =
        Table::new(&Request { elevation_field: None, layer: None, purpose: Purpose::Area, within: None, memory: None });
    for (number, rings) in (0..).zip(polygons) {
        table.push(Feature { number, polygons: vec![rings.clone()], ..Feature::default() });
    }
    area(Path::new(PATH), table)
}

fn error(polygons: &[Rings]) -> String {
    read(polygons).unwrap_err().to_string()
}

fn vertices(polygon: &Polygon<f64>) -> Rings {
    let rings = std::iter::once(polygon.exterior()).chain(polygon.interiors());
    rings.map(|ring| ring.coords().map(|c| DVec2::new(c.x, c.y)).collect()).collect()
}

#[test]
fn polygons_apart_keep_every_bit() {
    let odd = points(&[(0.1 + 0.2, 1e7), (1e7 / 3.0, 1e7 + 0.1), (2.0, 2e7 / 3.0), (0.1 + 0.2, 1e7)]);
    let holed = vec![square(-50.0, 0.1, 30.3), square(-40.0, 7.7, 1.1)];
    let in_hole = vec![square(-39.9, 7.8, 0.2)];
    let at_corner = vec![square(-50.0 + 30.3, 0.1 + 30.3, 5.5)];
    let polygons = [vec![odd], holed, in_hole, at_corner];
    let found: Vec<Rings> = read(&polygons).unwrap().iter().map(vertices).collect();
    assert_eq!(found, polygons);
}

#[test]
fn overlapping_nested_equal_and_adjoining_polygons_become_one() {
    for (other, expected) in [
        (square(5.0, 5.0, 10.0), 175.0),
        (square(2.0, 2.0, 3.0), 100.0),
        (square(0.0, 0.0, 10.0), 100.0),
        (square(10.0, 2.0, 4.0), 116.0),
        (points(&[(0.0, 0.0), (10.0, 10.0), (20.0, 10.0), (0.0, 0.0)]), 125.0),
    ] {
        for (a, b) in [(square(0.0, 0.0, 10.0), other.clone()), (other.clone(), square(0.0, 0.0, 10.0))] {
            let mut reversed = b.clone();
            reversed.reverse();
            for b in [b, reversed] {
                let area = read(&[vec![a.clone()], vec![square(100.0, 0.0, 1.0)], vec![b]]).unwrap();
                assert_eq!(area.0.len(), 2);
                assert!((area.unsigned_area() - expected - 1.0).abs() < 1e-6, "{expected} {}", area.unsigned_area());
                assert!(area.0.iter().any(|p| vertices(p) == [square(100.0, 0.0, 1.0)]), "the one apart is untouched");
            }
        }
    }
}

#[test]
fn a_united_area_keeps_its_holes() {
    let holed = vec![square(0.0, 0.0, 10.0), square(4.0, 4.0, 2.0)];
    let area = read(&[holed, vec![square(8.0, 8.0, 4.0)]]).unwrap();
    assert_eq!((area.0.len(), area.0[0].interiors().len()), (1, 1));
    assert!((area.unsigned_area() - (100.0 - 4.0 + 12.0)).abs() < 1e-6);
}

#[test]
fn rings_that_are_none_are_errors_with_feature_and_place() {
    let good = vec![square(0.0, 0.0, 1.0)];
    let cases: [(Rings, &str); 8] = [
        (vec![points(&[(1.0, 2.0), (3.0, 4.0), (1.0, 2.0)])], "at 1.000 2.000 has 3 points"),
        (vec![points(&[(1.0, 2.0), (f64::NAN, 4.0), (3.0, 3.0), (1.0, 2.0)])], "at NaN 4"),
        (
            vec![points(&[(0.0, 0.0), (-1e304, 1e-310), (3.0, 3.0), (0.0, 0.0)])],
            "at -1e304 1e-310, which is not a valid position",
        ),
        (vec![points(&[(0.0, 0.0), (8.0, 4.0), (8.0, 0.0), (0.0, 4.0), (0.0, 0.0)])], "crosses itself at 4.000 2.000"),
        (vec![square(0.0, 0.0, 4.0), square(2.0, 1.0, 4.0)], "crosses itself at 2.000 4.000"),
        (vec![square(0.0, 0.0, 4.0), square(6.0, 6.0, 1.0)], "a hole lies outside of its polygon at 6.000 6.000"),
        (vec![points(&[(5.0, 6.0), (6.0, 7.0), (7.0, 8.0), (5.0, 6.0)])], "at 5.000 6.000 has no area"),
        (vec![square(0.0, 0.0, 4.0), points(&[(1.0, 1.0), (2.0, 2.0)])], "has 3 points"),
    ];
    for (rings, expected) in cases {
        let message = error(&[good.clone(), rings]);
        assert!(message.starts_with(&format!("{PATH}: feature 1: ")), "{message}");
        assert!(message.contains(expected) && message.contains("Fix Geometries"), "{message}");
    }
}

#[test]
fn unclosed_rings_are_closed_and_touching_ones_allowed() {
    let mut open = square(0.0, 0.0, 10.0);
    open.pop();
    let touching = points(&[(0.0, 5.0), (3.0, 4.0), (3.0, 6.0), (0.0, 5.0)]);
    let area = read(&[vec![open, touching.clone()]]).unwrap();
    assert_eq!(vertices(&area.0[0]), [square(0.0, 0.0, 10.0), touching]);
}

#[test]
fn a_file_without_polygons_says_what_it_has() {
    let message = error(&[]);
    assert!(message.contains("there is no polygon in it"), "{message}");
    let mut table =
        Table::new(&Request { elevation_field: None, layer: None, purpose: Purpose::Area, within: None, memory: None });
    let mut feature = Feature::default();
    feature.push_line(square(0.0, 0.0, 1.0), &[]);
    table.push(feature);
    let message = area(Path::new(PATH), table).unwrap_err().to_string();
    assert!(message.contains("(found: 1 lines)"), "{message}");
    let mut table =
        Table::new(&Request { elevation_field: None, layer: None, purpose: Purpose::Area, within: None, memory: None });
    table.push(Feature { polygons: vec![vec![square(0.0, 0.0, 1.0)]], ..Feature::default() });
    table.leave_out("CurvePolygon");
    let message = area(Path::new(PATH), table).unwrap_err().to_string();
    assert!(message.contains("1 geometries of type CurvePolygon"), "{message}");
}

#[test]
fn many_polygons_on_each_other_become_one_outline() {
    let polygons: Vec<Rings> =
        (0..1000).map(|k| vec![square(f64::from(k) * 1e-3, f64::from(k % 7) * 1e-3, 10.0)]).collect();
    let found = read(&polygons).unwrap();
    assert_eq!(found.0.len(), 1);
    assert!((found.unsigned_area() - 10.999 * 10.006).abs() < 0.1, "{}", found.unsigned_area());
}

#[test]
fn polygons_that_may_not_be_united_stay_apart() {
    let mut table =
        Table::new(&Request { elevation_field: None, layer: None, purpose: Purpose::Area, within: None, memory: None });
    for number in 0..3 {
        let polygons = vec![vec![square(number as f64, 0.0, 10.0)]];
        table.push(Feature { number, polygons, ..Feature::default() });
    }
    let found = united_polygons(Path::new(PATH), table, |a, b| a + b == 3).unwrap();
    assert_eq!(found.iter().map(|member| member.feature).collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn long_spikes_are_no_crossings_and_one_crossing_is_found() {
    let count = 20_000;
    let at = |k: u32| {
        let radius = if k.is_multiple_of(2) { 10.0 } else { 5.0 };
        radius * DVec2::from_angle(f64::from(k % count) / f64::from(count) * std::f64::consts::TAU)
    };
    let mut star: Vec<DVec2> = (0..=count).map(at).collect();
    assert_eq!(read(&[vec![star.clone()]]).unwrap().0[0].exterior().0.len(), star.len());
    star[7001] = 1.5 * star[7001].length() * DVec2::from_angle(star[7001].to_angle() + 1e-3);
    assert!(error(&[vec![star]]).contains("crosses itself at"));
}
