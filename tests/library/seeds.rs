//! The seeds of the fuzz targets: what the fuzzer found before, and what it starts from.

#[path = "../fuzz/src/pipeline.rs"]
mod pipeline;
#[path = "../fuzz/src/readers.rs"]
mod readers;

use std::path::{Path, PathBuf};

/// Of these no surface can be made: too few levels, heights that are none, coordinates with too few digits.
const REFUSED: [&str; 5] = [
    "elevation_that_is_no_height_2",
    "flat_triangles_beside_the_frame_1",
    "frame_polygon_beyond_all_places",
    "lake_height_that_is_no_height",
    "thousands_of_points_beside_each_other_in_a_lake",
];

/// The seeds of a target.
fn seeds(target: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(target).expect("a folder of seeds");
    let mut seeds: Vec<_> = entries.map(|entry| entry.expect("a seed").path()).collect();
    seeds.sort();
    seeds
}

/// The folder of all seeds.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/seeds")
}

#[test]
fn maps_made_of_bytes_hold_all_guarantees() {
    let (mut held, mut refused) = (0, Vec::new());
    for seed in seeds(&folder().join("pipeline")) {
        match pipeline::run(&std::fs::read(&seed).unwrap()) {
            Some(Ok(())) => held += 1,
            Some(Err(_)) => refused.push(seed.file_name().unwrap().to_str().unwrap().to_string()),
            None => panic!("{}: no map", seed.display()),
        }
    }
    assert_eq!(refused, REFUSED);
    assert!(held >= 70, "{held} seeds tested anything");
}

#[test]
fn every_reader_takes_what_the_fuzzer_found() {
    let mut read = 0;
    for target in seeds(&folder()) {
        let name = target.file_name().unwrap().to_str().unwrap();
        let extension = match name {
            "pipeline" => continue,
            "gsi" | "landxml" => "xml",
            _ => name.rsplit('_').next().unwrap(),
        };
        for seed in seeds(&target) {
            let data = std::fs::read(seed).unwrap();
            readers::vectors(&data, extension);
            readers::heights(&data, extension);
            read += 1;
        }
    }
    assert!(read >= 15, "{read} seeds");
}
