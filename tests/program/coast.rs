//! `--coast`.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use glam::DVec2;
use tokosen::contour::{Contour, ContourMap};
use tokosen::io::raster::read_dem;
use tokosen::raster::Dem;

use crate::common::Folder;
use crate::maps::put;
use crate::running::Running;

/// The line through these positions, densely.
fn line(elevation: f64, corners: &[(f64, f64)]) -> Contour {
    let corners: Vec<DVec2> = corners.iter().map(|&p| p.into()).collect();
    let piece = |w: &[DVec2]| (0..20).map(|k| w[0].lerp(w[1], f64::from(k) / 20.0)).collect::<Vec<_>>();
    let mut points: Vec<DVec2> = corners.windows(2).flat_map(piece).collect();
    points.extend(corners.last());
    Contour { elevation, points, feature: 0.into() }
}

fn square(x: f64, y: f64, half: f64) -> [(f64, f64); 5] {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(i, j)| (x + half * i, y + half * j))
}

/// A coast at x = 500 from frame to frame with land in the west, a low island, and a lagoon.
fn coast() -> Vec<Contour> {
    vec![
        line(0.0, &[(500.0, 0.0), (520.0, 500.0), (500.0, 1000.0)]),
        line(0.0, &square(800.0, 500.0, 80.0)),
        line(0.0, &square(430.0, 500.0, 40.0)),
    ]
}

/// Contours at 10, 20 and 30 m in the west, without the coast. A box as the frame reaches over the sea.
fn land() -> Vec<Contour> {
    let mut land: Vec<Contour> =
        [(300.0, 10.0), (200.0, 20.0), (100.0, 30.0)].map(|(x, z)| line(z, &[(x, 0.0), (x, 1000.0)])).into();
    land.push(line(10.0, &square(900.0, 900.0, 30.0)));
    land
}

fn write(folder: &Folder, name: &str, contours: Vec<Contour>) {
    put(&folder.path(name), &ContourMap { contours, ..ContourMap::default() }, "lines");
}

fn at(dem: &Dem, x: f64, y: f64) -> f32 {
    let place = dem.grid.place(DVec2::new(x, y)).round();
    dem.values[place.y as usize * dem.grid.cols + place.x as usize]
}

/// Land, lagoon, island and sea.
fn check(folder: &Folder, name: &str) {
    let dem = read_dem(&folder.path(name)).unwrap().value.dem;
    for (x, y) in [(700.0, 200.0), (600.0, 800.0), (430.0, 500.0), (950.0, 500.0)] {
        assert_eq!(at(&dem, x, y), 0.0, "sea or lagoon at {x} {y}");
    }
    for (x, y) in [(400.0, 200.0), (440.0, 800.0), (800.0, 500.0), (900.0, 900.0)] {
        let z = at(&dem, x, y);
        assert!(z > 0.0, "land at {x} {y}: {z}");
    }
}

#[test]
fn a_coast_parts_land_from_sea_without_contours_on_the_other_side() {
    let folder = Folder::new();
    write(&folder, "land.gpkg", land());
    let mut lines = coast();
    // The island in the sea with a contour.
    lines.push(line(0.0, &square(900.0, 900.0, 60.0)));
    write(&folder, "all.gpkg", land().into_iter().chain(lines.clone()).collect());
    // The writer gives each line its level as attribute and z.
    write(&folder, "coast.gpkg", lines);
    let said = folder.succeeds("dem land.gpkg --coast coast.gpkg --cell 20 --frame bbox -o a.tif");
    assert!(!said.contains("coasts that do not part"), "{said}");
    check(&folder, "a.tif");
    folder.succeeds("dem all.gpkg --coast 0 --cell 20 --frame bbox -o b.tif");
    check(&folder, "b.tif");
    // Lines that the map has already do not hurt.
    folder.succeeds("dem all.gpkg --coast coast.gpkg --cell 20 --frame bbox -o c.tif");
    check(&folder, "c.tif");
    // In tiles.
    folder.succeeds("plan land.gpkg --coast coast.gpkg --cell 20 --frame bbox --tile-side 500 -o plan");
    folder.succeeds("work plan");
    folder.succeeds("join plan --dem tiled.tif");
    check(&folder, "tiled.tif");
    // New contours.
    folder.succeeds("densify land.gpkg --coast coast.gpkg -i 5 --frame bbox -o l.gpkg");
}

#[test]
fn polygons_of_land_or_of_sea_are_a_coast_too() {
    let folder = Folder::new();
    write(&folder, "land.gpkg", land());
    let polygon = |rings: &[&[(f64, f64)]]| {
        let ring = |ring: &&[(f64, f64)]| {
            let points: Vec<String> = ring.iter().map(|(x, y)| format!("[{x},{y}]")).collect();
            format!("[{}]", points.join(","))
        };
        let rings: Vec<String> = rings.iter().map(ring).collect();
        format!(
            r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[{}]}}}}"#,
            rings.join(",")
        )
    };
    let write_all = |name: &str, polygons: &[String]| {
        let text = format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:6677"}}}},"features":[{}]}}"#,
            polygons.join(",")
        );
        fs::write(folder.path(name), text).unwrap();
    };
    let mainland = [(-50.0, -50.0), (500.0, -50.0), (520.0, 500.0), (500.0, 1050.0), (-50.0, 1050.0), (-50.0, -50.0)];
    let (lagoon, island, hill) = (square(430.0, 500.0, 40.0), square(800.0, 500.0, 80.0), square(900.0, 900.0, 60.0));
    write_all("land.geojson", &[polygon(&[&mainland, &lagoon]), polygon(&[&island]), polygon(&[&hill])]);
    let open = [(500.0, -50.0), (1050.0, -50.0), (1050.0, 1050.0), (500.0, 1050.0), (520.0, 500.0), (500.0, -50.0)];
    write_all("sea.geojson", &[polygon(&[&open, &island, &hill]), polygon(&[&lagoon])]);
    write_all(
        "frame.geojson",
        &[polygon(&[&[(0.0, 0.0), (1000.0, 0.0), (1000.0, 1000.0), (0.0, 1000.0), (0.0, 0.0)]])],
    );
    for kind in ["land", "sea"] {
        folder.succeeds(&format!(
            "dem land.gpkg --crs EPSG:6677 --coast {kind}.geojson --cell 20 --frame frame.geojson -o {kind}.tif"
        ));
        check(&folder, &format!("{kind}.tif"));
    }
}

#[test]
fn a_coast_that_cannot_be_used_is_told() {
    let folder = Folder::new();
    write(&folder, "land.gpkg", land());
    let wrong = folder.ends("dem land.gpkg --cell 20 --coast 0 -o a.tif", 2);
    assert!(wrong.contains("no contour has the level of the coast, 0 m; the nearest level is 10 m"), "{wrong}");
    let wrong = folder.ends("dem land.gpkg --cell 20 --coast nan -o a.tif", 2);
    assert!(wrong.contains("no elevation"), "{wrong}");
    // A line through the land, with contours on both sides.
    write(&folder, "wrong.gpkg", vec![line(0.0, &[(250.0, 0.0), (250.0, 1000.0)])]);
    let said = folder.succeeds("dem land.gpkg --cell 20 --coast wrong.gpkg -o a.tif");
    assert!(said.contains("coasts that do not part land from sea: 1") && said.contains("land on both sides"), "{said}");
    fs::write(
        folder.path("point.geojson"),
        r#"{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[1,2]}}"#,
    )
    .unwrap();
    let wrong = folder.ends("dem land.gpkg --cell 20 --coast point.geojson -o b.tif", 1);
    assert!(wrong.contains("no line and no polygon"), "{wrong}");
}

/// A ring of 48 vertices.
fn circle(elevation: f64, x: f64, y: f64, radius: f64) -> Contour {
    let at = |k: u32| DVec2::new(x, y) + radius * DVec2::from_angle(f64::from(k % 48) * std::f64::consts::TAU / 48.0);
    Contour { elevation, points: (0..=48).map(at).collect(), feature: 0.into() }
}

/// Two islands with contours every 5 m, a rock of 0 m at 600 150, and the sea between them.
fn islands() -> Vec<Contour> {
    let island = |x: f64, y: f64, radius: f64, levels: u32| {
        (0..levels).map(move |k| circle(5.0 * f64::from(k), x, y, radius - 20.0 * f64::from(k)))
    };
    let rock = [circle(0.0, 600.0, 150.0, 25.0)];
    island(300.0, 300.0, 200.0, 5).chain(island(800.0, 700.0, 150.0, 4)).chain(rock).collect()
}

/// Height maps with `--sea` and with `--coast`, and what is said.
fn with_sea(contours: Vec<Contour>) -> Vec<(Dem, String)> {
    let folder = Folder::new();
    write(&folder, "map.gpkg", contours);
    let of = |option: &str| {
        let said = folder.succeeds(&format!("dem map.gpkg {option} --cell 10 --frame bbox -o {}.tif", &option[2..4]));
        (read_dem(&folder.path(&format!("{}.tif", &option[2..4]))).unwrap().value.dem, said)
    };
    vec![of("--sea 0"), of("--coast 0")]
}

#[test]
fn a_contour_in_the_sea_makes_it_no_land_and_no_rock_water() {
    let sound = with_sea(islands());
    assert!(sound.iter().all(|(_, said)| !said.contains("contours in the sea")), "{}", sound[0].1);
    let one = |level: f64| vec![circle(level, 620.0, 420.0, 15.0)];
    let several: Vec<Contour> =
        [(620.0, 420.0), (560.0, 500.0), (150.0, 600.0), (900.0, 450.0), (400.0, 700.0), (200.0, 800.0)]
            .map(|(x, y)| circle(5.0, x, y, 12.0))
            .into();
    for (others, count) in [(one(5.0), 1), (several, 6), (one(10.0), 1), (one(-5.0), 1)] {
        for ((dem, said), (sound, _)) in
            with_sea(islands().into_iter().chain(others.clone()).collect()).iter().zip(&sound)
        {
            assert!(said.contains(&format!("contours in the sea: {count}")), "{said}");
            assert!(!said.contains("contours below the sea"), "{said}");
            for (x, y) in [(750.0, 250.0), (500.0, 600.0), (900.0, 300.0), (700.0, 450.0)] {
                assert_eq!(at(dem, x, y), 0.0, "open sea at {x} {y}: {said}");
            }
            for (x, y) in [(600.0, 150.0), (300.0, 300.0), (440.0, 300.0), (800.0, 700.0)] {
                let (height, right) = (at(dem, x, y), at(sound, x, y));
                assert!((height - right).abs() < 0.2, "land at {x} {y}: {height}, not {right}");
            }
            let inside = at(dem, 620.0, 420.0);
            assert_eq!(inside > 0.0, others[0].elevation > 0.0, "inside the ring: {inside}");
        }
    }
}

#[test]
fn a_contour_in_the_sea_hides_neither_a_lagoon_nor_a_coast_at_the_frame() {
    let folder = Folder::new();
    let islets = [circle(10.0, 700.0, 250.0, 12.0), circle(20.0, 650.0, 800.0, 10.0)];
    write(&folder, "all.gpkg", land().into_iter().take(3).chain(coast()).chain(islets).collect());
    for option in ["--sea 0", "--coast 0"] {
        let said = folder.succeeds(&format!("dem all.gpkg {option} --cell 20 --frame bbox --overwrite -o a.tif"));
        assert!(said.contains("contours in the sea: 2") && !said.contains("coasts that do not part"), "{said}");
        let dem = read_dem(&folder.path("a.tif")).unwrap().value.dem;
        for (x, y) in [(700.0, 500.0), (600.0, 600.0), (430.0, 500.0), (740.0, 900.0)] {
            assert_eq!(at(&dem, x, y), 0.0, "sea or lagoon at {x} {y} with {option}");
        }
        for (x, y) in [(400.0, 200.0), (440.0, 800.0), (800.0, 500.0)] {
            assert!(at(&dem, x, y) > 0.0, "land at {x} {y} with {option}");
        }
    }
    let (_, said) = folder.run("check all.gpkg");
    assert!(said.contains("contour 0 m may be the coast"), "{said}");
}
