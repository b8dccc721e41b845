//! The everyday jobs of the guide: each command runs as it stands there.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_contours};

use crate::guide_pages::{commands, inputs, run, words};
use crate::running::{Running, folder_with_part};

const PAGE: &str = include_str!("../../src/guide/everyday.md");

#[test]
fn every_command_of_the_page_runs() {
    let folder = inputs();
    let commands = commands(PAGE);
    assert!(commands.len() >= 14, "{commands:?}");
    for command in &commands {
        let told = run(&folder, command);
        let output =
            words(command).into_iter().skip_while(|word| !["-o", "--report", "--hillshade"].contains(&word.as_str()));
        let Some(output) = output.clone().nth(1) else {
            assert!(command.contains("--run "), "{command} writes nothing");
            continue;
        };
        assert!(std::fs::metadata(folder.path(&output)).unwrap().len() > 500, "{command}: {told}");
    }
    let lines = |name: &str| {
        let options = ReadOptions {
            layer: name.strip_suffix("labelled.gpkg").map(|_| "contours_10m".into()),
            ..ReadOptions::default()
        };
        read_contours(&folder.path(name), &options).unwrap().value.contours
    };
    // The sheets give the lines of the whole map again.
    let closed = |name: &str| {
        let of_input = |elevation: f64| elevation % 20.0 == 0.0;
        lines(name).iter().filter(|line| of_input(line.elevation) && line.is_closed()).count()
    };
    assert_eq!(closed("joined.gpkg"), closed("labelled.gpkg"));
    assert!(lines("every_100_m.gpkg").iter().all(|line| line.elevation % 100.0 == 0.0));
    assert!(lines("every_10_feet.gpkg").iter().all(|line| line.elevation % 10.0 == 0.0));
    let spots = std::fs::read_to_string(folder.path("spots.csv")).unwrap();
    let dem = read_dem(&folder.path("with_spots.tif")).unwrap().value.dem;
    assert!(spots.lines().count() == 4 && dem.values.iter().any(|z| z.is_finite()));
}

#[test]
fn lines_at_levels_of_the_input_need_no_surface() {
    let folder = folder_with_part("in.gpkg");
    let text = folder.succeeds("densify in.gpkg -i 40 -o coarse.geojson");
    assert!(text.contains("surface    none"), "{text}");
    // With a picture the surface is made. The lines are the same.
    let text = folder.succeeds("densify in.gpkg -i 40 -o with_surface.geojson --preview look.png");
    assert!(text.contains("surface    smooth"), "{text}");
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert_eq!(bytes("coarse.geojson"), bytes("with_surface.geojson"));
    // Where a contour is missing, its line is found on the surface.
    let line = |level: u32, end: f64| {
        format!(
            r#"{{"type":"Feature","properties":{{"elev":{level}}},"geometry":{{"type":"LineString",
            "coordinates":[[500000,{y}],[{end},{y}]]}}}}"#,
            y = 4_000_000 + 5 * level
        )
    };
    let lines =
        [(10, 500_100.0), (20, 500_040.0), (30, 500_100.0), (40, 500_100.0)].map(|(level, end)| line(level, end));
    let map = format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:32616"}}}},"features":[{}]}}"#,
        lines.join(",")
    );
    std::fs::write(folder.path("gap.geojson"), map).unwrap();
    let text = folder.succeeds("densify gap.geojson -i 10 -o whole.geojson");
    assert!(text.contains("surface    smooth") && text.contains(" 1 new line"), "{text}");
}
