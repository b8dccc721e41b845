//! Contours that were cut with a district's polygon, with the polygon as frame.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::HashSet;

use geo::{BooleanOps, Contains, Coord, LineString, MultiLineString, Point, Polygon};
use glam::DVec2;
use serde_json::json;

use crate::common::Folder;
use crate::hulls::{MIDDLE, contours, feature, ground, heights, lines_of, write, write_raster};
use crate::running::Running;

/// Contour interval, metres.
const INTERVAL: f64 = 5.0;

/// A star of some hundred metres.
fn district(turn: f64) -> Polygon<f64> {
    let corner = |k: u32| {
        let radius = if k.is_multiple_of(2) { 240.0 } else { 130.0 } + 17.3 * f64::from(k % 5);
        let p = MIDDLE + DVec2::new(11.1, -7.7) + radius * DVec2::from_angle(turn + f64::from(k) * 0.449);
        Coord { x: p.x, y: p.y }
    };
    Polygon::new((0..14).map(corner).collect(), Vec::new())
}

/// Lines cut with a polygon. Their ends are off it by a rounding error.
fn cut(lines: &[(f64, Vec<DVec2>)], area: &Polygon<f64>) -> Vec<(f64, Vec<DVec2>)> {
    let of = |(level, points): &(f64, Vec<DVec2>)| {
        let line: LineString<f64> = points.iter().map(|p| Coord { x: p.x, y: p.y }).collect();
        let pieces = area.clip(&MultiLineString::new(vec![line]), false);
        let level = *level;
        pieces.into_iter().map(move |piece| (level, piece.coords().map(|c| DVec2::new(c.x, c.y)).collect()))
    };
    lines.iter().flat_map(of).collect()
}

/// The vertices of lines with their levels, as bits.
fn vertices<'a>(lines: impl Iterator<Item = (f64, &'a [DVec2])>) -> HashSet<[u64; 3]> {
    lines.flat_map(|(z, points)| points.iter().map(move |p| [p.x, p.y, z].map(f64::to_bits))).collect()
}

#[test]
fn ends_on_the_frame_stay_and_the_frame_is_filled() {
    let whole = contours(INTERVAL, |_| true);
    let (mut ends, mut beyond) = (0, 0);
    for turn in [0.1, 0.21, 0.32] {
        let folder = Folder::new();
        write_raster(&folder);
        let area = district(turn);
        let lines = cut(&whole, &area);
        write(&folder, "cut.geojson", &lines, &[]);
        let ring: Vec<[f64; 2]> = area.exterior().coords().map(|c| [c.x, c.y]).collect();
        write(&folder, "area.geojson", &[], &[feature("Polygon", json!([ring]), 0.0)]);
        let is_open = |(_, points): &&(f64, Vec<DVec2>)| points.first() != points.last();
        ends += 2 * lines.iter().filter(is_open).count();

        let said = folder
            .succeeds("densify cut.geojson -i 2.5 --frame area.geojson -o once.geojson --dem dem.tif --like like.asc");
        assert!(said.contains("outside the convex hull of the contours, where heights are a guess"), "{said}");
        let once = lines_of(&folder, "once.geojson");
        let given = vertices(lines.iter().map(|(z, points)| (*z, points.as_slice())));
        let made = vertices(once.iter().map(|(_, z, points)| (*z, points.as_slice())));
        assert_eq!(given.difference(&made).count(), 0, "vertices of the input that were moved");
        // Once more, with the same polygon.
        folder.succeeds("densify once.geojson -i 1.25 --frame area.geojson -o twice.geojson");
        let twice = lines_of(&folder, "twice.geojson");
        let again = vertices(twice.iter().map(|(_, z, points)| (*z, points.as_slice())));
        assert_eq!(made.difference(&again).count(), 0, "vertices that were moved in the second step");

        let hull = geo::ConvexHull::convex_hull(&MultiLineString::new(
            lines.iter().map(|(_, points)| points.iter().map(|p| Coord { x: p.x, y: p.y }).collect()).collect(),
        ));
        let dem = heights(&folder, "dem.tif");
        for (n, &z) in dem.values.iter().enumerate() {
            let p = dem.grid.center(n % dem.grid.cols, n / dem.grid.cols);
            let at = Point::new(p.x, p.y);
            assert_eq!(area.contains(&at), z.is_finite(), "{p}");
            if z.is_finite() && hull.contains(&at) {
                // The contours were drawn between cells of 10 m, so near a level the ground is on either side of it.
                let (z, truth) = (f64::from(z), ground(p));
                let [lo, hi] = [(truth - 0.2).div_euclid(INTERVAL), (truth + 0.2).div_euclid(INTERVAL) + 1.0]
                    .map(|k| k * INTERVAL);
                assert!(lo - 1e-3 <= z && z <= hi + 1e-3, "{z} at {p}, where the ground is {truth}");
            }
            beyond += usize::from(z.is_finite() && !hull.contains(&at));
        }
        folder.succeeds("dem cut.geojson --frame area.geojson --no-extend --like like.asc -o hull.tif");
        let inside = heights(&folder, "hull.tif");
        let outside =
            inside.values.iter().zip(&dem.values).filter(|(less, all)| less.is_nan() && !all.is_nan()).count();
        assert!(outside > 0, "--no-extend leaves them out");
    }
    assert!(ends > 50 && beyond > 10, "{ends} ends, {beyond} cells beyond the contours");
}

#[test]
fn spot_heights_are_met_at_cells() {
    let folder = Folder::new();
    write_raster(&folder);
    write(&folder, "map.geojson", &contours(INTERVAL, |_| true), &[]);
    // The centres of cells, and places between them.
    let places = (0..40).map(|k| {
        let cell = DVec2::new(f64::from(k * 7 % 23 - 11), f64::from(k * 5 % 19 - 9)) * 40.0;
        MIDDLE + cell + DVec2::splat(if k % 4 == 3 { 3.3 } else { 5.0 })
    });
    let spots: Vec<DVec2> =
        places.filter(|p| (ground(*p) / INTERVAL).fract().min(1.0 - (ground(*p) / INTERVAL).fract()) > 0.1).collect();
    let table: String = spots.iter().map(|p| format!("{},{},{}\n", p.x, p.y, ground(*p))).collect();
    std::fs::write(folder.path("spots.csv"), format!("x,y,z\n{table}")).unwrap();
    folder.succeeds("dem map.geojson --points spots.csv --like like.asc -o dem.tif");
    let dem = heights(&folder, "dem.tif");
    let mut met = 0;
    for (n, &z) in dem.values.iter().enumerate() {
        let p = dem.grid.center(n % dem.grid.cols, n / dem.grid.cols);
        if spots.iter().any(|spot| spot.distance(p) < 1e-6) {
            assert!((f64::from(z) - ground(p)).abs() < 1e-3 * INTERVAL, "{z} at {p}, not {}", ground(p));
            met += 1;
        }
    }
    assert!(met > 15, "{met}");
}
