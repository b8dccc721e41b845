//! Maps in tiles: the terrain of an untiled run, from any tiling; and what happens when tasks fail.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeMap;
use std::path::PathBuf;

use glam::DVec2;
use tokosen::contour::ContourMap;
use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_contours};
use tokosen::raster::Dem;

use crate::common::{Folder, crossings};
use crate::guide_pages::{commands, run};
use crate::running::{Running, folder_with, folder_with_part};

fn heights(folder: &Folder, name: &str) -> Dem {
    read_dem(&folder.path(name)).unwrap().value.dem
}

fn lines(folder: &Folder, name: &str) -> ContourMap {
    read_contours(&folder.path(name), &ReadOptions::default()).unwrap().value
}

/// The bytes of all results of a plan.
fn results(folder: &Folder, plan: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder.path(plan).join("tiles")).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().to_owned();
    entries.map(|path| (name(&path), std::fs::read(&path).unwrap())).collect()
}

/// The lines that the input does not have, by their level, and where open ones end.
fn new_lines(map: &ContourMap, input: &ContourMap) -> (BTreeMap<i64, usize>, Vec<DVec2>) {
    let given: Vec<f64> = input.contours.iter().map(|line| line.elevation).collect();
    let (mut counts, mut ends) = (BTreeMap::new(), Vec::new());
    for line in map.contours.iter().filter(|line| !given.contains(&line.elevation)) {
        *counts.entry(line.elevation as i64).or_default() += 1;
        if !line.is_closed() {
            ends.extend([line.points[0], line.points[line.points.len() - 1]]);
        }
    }
    (counts, ends)
}

#[test]
fn tiles_of_two_sizes_give_the_terrain_of_an_untiled_run() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 10 --cell 20 --dem whole.tif -o whole.gpkg");
    let (untiled, untiled_lines, input) =
        (heights(&folder, "whole.tif"), lines(&folder, "whole.gpkg"), lines(&folder, "in.gpkg"));
    let (counts, ends) = new_lines(&untiled_lines, &input);
    for (size, least) in [(2000, 4), (1000, 12)] {
        let said = folder.succeeds(&format!("plan in.gpkg -i 10 --cell 20 --tile-side {size} -o plan{size}"));
        folder.succeeds(&format!("work plan{size}"));
        let tiles = std::fs::read_to_string(folder.path(&format!("plan{size}/manifest.json"))).unwrap();
        assert!(tiles.matches("\"id\"").count() >= least, "{said}");
        let said = folder.succeeds(&format!("join plan{size} -o dense{size}.gpkg --dem dem{size}.tif"));
        assert!(!said.contains("border of a tile"), "{said}");
        let tiled = heights(&folder, &format!("dem{size}.tif"));
        assert_eq!(tiled.grid, untiled.grid);
        let (mut most, mut squares) = (0.0_f32, 0.0);
        for (a, b) in tiled.values.iter().zip(&untiled.values) {
            assert_eq!(a.is_nan(), b.is_nan());
            if !a.is_nan() {
                most = most.max((a - b).abs());
                squares += f64::from((a - b).powi(2));
            }
        }
        let rms = (squares / tiled.values.len() as f64).sqrt();
        assert!(most < 0.2 && rms < 0.02, "{size}: {most} m, {rms} m, of an interval of 20 m");
        let dense = lines(&folder, &format!("dense{size}.gpkg"));
        let as_text = |map: &ContourMap| {
            let mut all: Vec<String> =
                map.contours.iter().map(|line| format!("{} {:?}", line.elevation, line.points)).collect();
            all.sort();
            all
        };
        let of_input: Vec<String> = as_text(&input);
        let (of_tiles, of_whole) = (as_text(&dense), as_text(&untiled_lines));
        let kept = |all: &[String]| all.iter().filter(|line| of_whole.binary_search(line).is_ok()).count();
        assert!(
            kept(&of_tiles) >= of_input.len(),
            "{size}: contours of the input come back vertex for vertex, turned as untiled"
        );
        let (its_counts, its_ends) = new_lines(&dense, &input);
        assert_eq!(its_counts, counts, "{size}: as many lines of each level");
        for end in its_ends {
            let nearest = ends.iter().map(|p| p.distance(end)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 5.0, "{size}: a line ends at {end}");
        }
        let of_map: Vec<(f64, Vec<DVec2>)> =
            dense.contours.iter().map(|line| (line.elevation, line.points.clone())).collect();
        assert_eq!(crossings(&of_map), Vec::<String>::new());
    }
}

#[test]
fn files_that_are_cut_off_or_missing_are_made_again_and_the_bytes_are_the_same() {
    let folder = folder_with("fig1f_nested.geojson", "in.geojson");
    folder.succeeds("plan in.geojson -i 2 --cell 10 --tile-side 600 -o plan");
    folder.succeeds("work plan");
    let first = results(&folder, "plan");
    assert!(first.len() >= 12, "{:?}", first.keys());
    folder.succeeds("join plan -o first.geojson --dem first.tif");
    // Damage of each kind.
    let name = |kind: &str, k: usize| first.keys().filter(|name| name.ends_with(kind)).nth(k).unwrap().clone();
    let (cut, changed, gone) = (name(".heights", 0), name(".result", 1), name(".result", 2));
    let path = |name: &str| folder.path("plan").join("tiles").join(name);
    std::fs::write(path(&cut), &first[&cut][..first[&cut].len() - 3]).unwrap();
    let mut other = first[&changed].clone();
    let last = other.len() - 1;
    other[last] ^= 1;
    std::fs::write(path(&changed), &other).unwrap();
    std::fs::remove_file(path(&gone)).unwrap();
    let said = folder.ends("join plan -o second.geojson --dem second.tif", 1);
    let task = |name: &str| name.split('.').next().unwrap().to_owned();
    for name in [&cut, &changed, &gone] {
        assert!(said.contains(&task(name)), "{name}: {said}");
    }
    assert!(said.contains("3 of") && !folder.path("second.geojson").exists(), "{said}");
    // In another order, and side by side: the same bytes.
    folder.succeeds(&format!("work plan --task {}", task(&gone)));
    let said = folder.succeeds("work plan --jobs 2");
    assert!(said.contains("was done before"), "{said}");
    assert!(results(&folder, "plan") == first);
    folder.succeeds("join plan -o second.geojson --dem second.tif");
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(bytes("first.tif") == bytes("second.tif") && bytes("first.geojson") == bytes("second.geojson"));
    // The plan's own files too.
    let input = name(".lines", 0);
    std::fs::write(path(&input), &first[&input][..100]).unwrap();
    std::fs::remove_file(path(&name(".heights", 0))).unwrap();
    let said = folder.ends("work plan", 1);
    assert!(said.contains(&input) && said.contains("make the plan again"), "{said}");
    let said = folder.ends("work plan --jobs 2", 1);
    assert!(said.contains("these tasks failed: ") && said.contains("goes on with those that are left"), "{said}");
    folder.succeeds("plan in.geojson -i 2 --cell 10 --tile-side 600 -o plan");
    let said = folder.succeeds("work plan");
    assert_eq!(said.matches(" done, ").count(), 1, "results that belong to the new plan are kept: {said}");
    // Another plan in the same folder makes its own results.
    folder.succeeds("plan in.geojson -i 1 --cell 10 --tile-side 600 -o plan");
    assert!(folder.ends("join plan -o third.geojson", 1).contains("are not done"));
}

#[test]
fn what_is_no_plan_and_what_tiles_cannot_take_is_refused() {
    let folder = folder_with("fig1f_nested.geojson", "in.geojson");
    for (line, words) in [
        ("plan in.geojson -o plan", "--interval"),
        ("plan in.geojson -i 2 -o plan --tune streams.climb=1", "manifest.json"),
        ("plan in.geojson -i 2 -o plan --strict", "tokosen check"),
        ("plan in.geojson -i -2 -o plan", "more than 0"),
        ("plan in.geojson -i 2 -o plan --tile-side 0", "it must be more than 0"),
        ("plan in.geojson -i 2 -o plan --memory some", "4G"),
        ("plan in.geojson --cell 10 -o plan --memory 10M", "the smallest possible tile takes about"),
        ("plan in.geojson --cell 0.1 -o plan --tile-side 0.5", "choose a larger size of tiles"),
    ] {
        let said = folder.ends(line, 2);
        assert!(said.contains(words), "{line}: {said}");
    }
    std::fs::create_dir(folder.path("other")).unwrap();
    std::fs::write(folder.path("other/mine.txt"), "mine").unwrap();
    assert!(folder.ends("plan in.geojson -i 2 -o other", 1).contains("holds other files"));
    assert!(folder.ends("work other", 1).contains("holds no plan"));
    assert!(folder.ends("work nowhere", 1).contains("nowhere"));
    folder.succeeds("plan in.geojson -i 2 --tile-side 600 -o plan");
    assert!(folder.ends("work plan --task t99", 2).contains("the plan has no task t99; its tasks are t"));
    assert!(folder.ends("join plan -o a.geojson --dem a.tif", 2).contains("does not have a height map"));
    assert!(folder.ends("join plan -o a.geojson", 1).contains("are not done"));
    let manifest = folder.path("plan/manifest.json");
    let text = std::fs::read_to_string(&manifest).unwrap();
    for (from, to, words) in [
        ("\"layout\": 2", "\"layout\": 3", "another version of this program"),
        ("\"version\": \"", "\"version\": \"9", "use that version, or make the plan again"),
        ("\"tasks\"", "\"jobs\"", "the manifest is broken"),
        ("\"description\": \"", "\"description\": \"no ", "no manifest"),
    ] {
        std::fs::write(&manifest, text.replacen(from, to, 1)).unwrap();
        for verb in ["work plan", "join plan -o a.geojson"] {
            let said = folder.ends(verb, 1);
            assert!(said.contains(words), "{verb} {to}: {said}");
        }
    }
}

#[test]
fn what_is_wrong_with_sheets_is_reported_by_the_plan_and_by_the_join() {
    let folder = folder_with_part("a.gpkg");
    folder.succeeds("densify a.gpkg -i 20 -o b.gpkg --to-crs EPSG:4326");
    for (sheets, words) in [("a.gpkg a.gpkg", "duplicate"), ("a.gpkg b.gpkg", "transformed to")] {
        let planned = folder.succeeds(&format!("plan {sheets} --cell 50 -o plan --surface linear"));
        assert!(planned.contains(words), "{planned}");
        folder.succeeds("work plan");
        let joined = folder.succeeds("join plan --dem dem.tif --overwrite");
        assert!(joined.contains(words), "{joined}");
    }
}

#[test]
fn the_commands_of_the_guide_work() {
    let folder = folder_with_part("contours.gpkg");
    for command in commands(include_str!("../../src/guide/countries.md")) {
        // Smaller tiles, so that the part of the sample has several.
        run(&folder, &command.replace("3500", "2000"));
    }
    let joined = heights(&folder, "joined.tif");
    assert!(joined.values.iter().any(|height| height.is_finite()));
}

#[test]
fn maps_in_degrees_and_feet_come_back_in_them() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 20 -o degrees.gpkg --to-crs EPSG:4326");
    folder.succeeds("densify degrees.gpkg -i 10 -o whole.gpkg --surface skeleton");
    folder.succeeds("plan degrees.gpkg -i 10 --tile-side 2000 -o plan --surface skeleton");
    folder.succeeds("work plan");
    folder.succeeds("join plan -o dense.gpkg");
    let (input, dense, whole) =
        (lines(&folder, "degrees.gpkg"), lines(&folder, "dense.gpkg"), lines(&folder, "whole.gpkg"));
    assert_eq!(dense.crs, whole.crs);
    let bits = |map: &ContourMap| -> std::collections::HashSet<[u64; 2]> {
        map.contours.iter().flat_map(|c| &c.points).map(|p| p.to_array().map(f64::to_bits)).collect()
    };
    let (of_input, of_dense) = (bits(&input), bits(&dense));
    assert!(of_input.is_subset(&of_dense), "the vertices of the input come back bit for bit");
    assert_eq!(new_lines(&dense, &input).0, new_lines(&whole, &input).0);
}
