//! What lies beside the contours, in maps that are made in tiles: lakes, streams, break lines, cliffs, sinks, excluded parts.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use glam::DVec2;
use serde_json::{Value, json};
use tokosen::io::raster::read_dem;
use tokosen::raster::Dem;

use crate::common::Folder;
use crate::running::{Running, folder_with_part};

/// The middle of the part of the sample; its four tiles meet 200 m from there.
const MIDDLE: DVec2 = DVec2::new(746_740.0, 4_019_000.0);

fn put(folder: &Folder, name: &str, kind: &str, coordinates: &Value) {
    let features = json!([{
        "type": "Feature", "properties": {}, "geometry": { "type": kind, "coordinates": coordinates }
    }]);
    let crs = json!({ "type": "name", "properties": { "name": "EPSG:32616" } });
    let text = json!({ "type": "FeatureCollection", "crs": crs, "features": features }).to_string();
    std::fs::write(folder.path(name), text).unwrap();
}

fn square(middle: DVec2, half: f64) -> Value {
    let at = |x: f64, y: f64| json!([middle.x + half * x, middle.y + half * y]);
    json!([[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0), at(-1.0, -1.0)]])
}

fn heights(folder: &Folder, name: &str) -> Dem {
    read_dem(&folder.path(name)).unwrap().value.dem
}

/// The largest difference of two height maps and its root mean square, within a distance of a place.
fn difference(a: &Dem, b: &Dem, place: DVec2, reach: f64) -> (f64, f64) {
    assert_eq!(a.grid, b.grid);
    let (mut most, mut squares, mut count) = (0.0_f64, 0.0, 0.0);
    for (k, (x, y)) in a.values.iter().zip(&b.values).enumerate() {
        let is_near = a.grid.center(k % a.grid.cols, k / a.grid.cols).distance(place) <= reach;
        if is_near && !x.is_nan() {
            let off = f64::from((x - y).abs());
            (most, squares, count) = (most.max(off), squares + off * off, count + 1.0);
        }
    }
    assert!(count > 20.0);
    (most, (squares / count).sqrt())
}

#[test]
fn tiles_take_what_lies_beside_the_contours_as_one_run_does() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("dem in.gpkg --cell 20 -o plain.tif");
    folder.succeeds("derive plain.tif --stream-lines streams.gpkg --threshold 200000");
    // A lake and a hole over seams, a break line and a cliff across them, a sink. The lake has no height.
    let at = |x: f64, y: f64| MIDDLE + DVec2::new(x, y);
    let line = |from: DVec2, to: DVec2| json!([[from.x, from.y], [to.x, to.y]]);
    let [lake, hole] = [at(190.0, 850.0), at(900.0, -40.0)];
    put(&folder, "lake.geojson", "Polygon", &square(lake, 45.0));
    put(&folder, "hole.geojson", "Polygon", &square(hole, 150.0));
    put(&folder, "break.geojson", "LineString", &line(at(-900.0, -200.0), at(-800.0, 250.0)));
    put(&folder, "cliff.geojson", "LineString", &line(at(-200.0, 700.0), at(250.0, 760.0)));
    put(&folder, "sink.geojson", "Polygon", &square(at(500.0, 500.0), 60.0));
    let beside = "--water lake.geojson --exclude hole.geojson --breaklines break.geojson --cliffs cliff.geojson \
                  --sinks sink.geojson --streams streams.gpkg";
    let of_run = folder.succeeds(&format!("dem in.gpkg {beside} --cell 20 -o whole.tif"));
    folder.succeeds(&format!("plan in.gpkg {beside} --cell 20 --tile-side 2000 -o plan"));
    folder.succeeds("work plan");
    let of_tiles = folder.succeeds("join plan --dem tiled.tif");
    let [plain, whole, tiled] = ["plain.tif", "whole.tif", "tiled.tif"].map(|name| heights(&folder, name));

    let (most, rms) = difference(&tiled, &whole, MIDDLE, f64::INFINITY);
    assert!(most < 1.0 && rms < 0.02, "{most} m, {rms} m, of an interval of 20 m");
    // Each of them changed the map, and far more than the tiles do.
    for (what, place) in [("lake", lake), ("hole", hole), ("break line", at(-850.0, 25.0)), ("cliff", at(25.0, 730.0))]
    {
        let (_, change) = difference(&whole, &plain, place, 120.0);
        let (_, off) = difference(&tiled, &whole, place, 120.0);
        assert!(change > 0.02 && off < 0.1 * change, "{what}: {change} m, and {off} m in tiles");
    }
    // The lake is level across its tiles.
    let of_lake: Vec<f32> = (0..tiled.values.len())
        .filter(|k| {
            let off = (tiled.grid.center(k % tiled.grid.cols, k / tiled.grid.cols) - lake).abs();
            off.max_element() < 30.0
        })
        .map(|k| tiled.values[k])
        .collect();
    assert!(of_lake.len() >= 9 && of_lake.iter().all(|z| z == &of_lake[0]), "{of_lake:?}");
    // What was left out is told once.
    let told = |said: &str| said.matches("parts of the map left out").count();
    assert_eq!((told(&of_run), told(&of_tiles)), (1, 1), "{of_run}\n{of_tiles}");
}
