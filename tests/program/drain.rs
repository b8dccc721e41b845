//! `--drain` and `--sinks`.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use glam::DVec2;
use rusqlite::Connection;
use tokosen::contour::{Contour, ContourMap};
use tokosen::io::raster::read_dem;
use tokosen::raster::Dem;

use crate::common::Folder;
use crate::maps::put;
use crate::running::Running;

/// Slopes at 10, 20, 30 m that fall to the west, with a hollow in a hollow (20, 10 m) in the east at `HOLLOW`.
fn folder() -> Folder {
    let folder = Folder::new();
    let line = |x: f64, elevation: f64| {
        let points = (0..=40).map(|k| DVec2::new(x + 15.0 * f64::from(k % 2), 25.0 * f64::from(k))).collect();
        Contour { elevation, points, feature: 0.into() }
    };
    let ring = |radius: f64, elevation: f64| {
        let angle = |k: i32| f64::from(k % 40) * std::f64::consts::TAU / 40.0;
        let points = (0..=40).map(|k| HOLLOW + radius * DVec2::from_angle(angle(k))).collect();
        Contour { elevation, points, feature: 0.into() }
    };
    let mut contours: Vec<Contour> = [(0.0, 0.0), (150.0, 10.0), (300.0, 20.0), (450.0, 30.0), (990.0, 40.0)]
        .map(|(x, elevation)| line(x, elevation))
        .into();
    contours.extend([(150.0, 30.0), (100.0, 20.0), (50.0, 10.0)].map(|(radius, elevation)| ring(radius, elevation)));
    put(&folder.path("c.gpkg"), &ContourMap { contours, ..ContourMap::default() }, "contours");
    folder
}

const HOLLOW: DVec2 = DVec2::new(740.0, 500.0);

/// Cells from which no way leads off the map, or to a sink, without going up, by repeated passes.
fn undrained(dem: &Dem, sink: Option<usize>) -> Vec<usize> {
    let (cols, rows) = (dem.grid.cols as isize, dem.grid.rows as isize);
    let around = |cell: usize| {
        let (col, row) = (cell as isize % cols, cell as isize / cols);
        (-1..=1).flat_map(move |j| (-1..=1).map(move |i| (col + i, row + j))).map(move |(col, row)| {
            let is_on = (0..cols).contains(&col) && (0..rows).contains(&row);
            is_on.then_some((row * cols + col) as usize)
        })
    };
    let has = |cell: usize| !dem.values[cell].is_nan();
    let cells: Vec<usize> = (0..dem.values.len()).filter(|&cell| has(cell)).collect();
    let mut drains = vec![false; dem.values.len()];
    for &cell in &cells {
        drains[cell] = around(cell).any(|near| near.is_none_or(|near| !has(near)));
    }
    sink.iter().for_each(|&cell| drains[cell] = true);
    loop {
        let mut is_done = true;
        for &cell in &cells {
            let is_way = |near: usize| drains[near] && dem.values[near] <= dem.values[cell];
            if !drains[cell] && around(cell).flatten().any(is_way) {
                (drains[cell], is_done) = (true, false);
            }
        }
        if is_done {
            return cells.into_iter().filter(|&cell| !drains[cell]).collect();
        }
    }
}

fn height_map(folder: &Folder, name: &str) -> Dem {
    read_dem(&folder.path(name)).unwrap().value.dem
}

/// Number of pits in a file of diagnostics by their reasons.
fn reasons(path: &Path) -> BTreeMap<String, u32> {
    let db = Connection::open(path).unwrap();
    let mut query = db.prepare("select reason, count(*) from sinks group by reason").unwrap();
    query.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap().map(Result::unwrap).collect()
}

fn write_point(folder: &Folder, name: &str, p: DVec2) {
    let DVec2 { x, y } = p;
    let text = format!(
        r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"Point","coordinates":[{x},{y}]}},
        "crs":{{"type":"name","properties":{{"name":"EPSG:6677"}}}}}}"#
    );
    fs::write(folder.path(name), text).unwrap();
}

#[test]
fn no_pit_is_left_with_all_and_hollows_stay_without() {
    let folder = folder();
    let safe = folder.succeeds("dem c.gpkg --cell 10 --drain safe -o safe.tif --diagnostics safe.gpkg");
    folder.succeeds("dem c.gpkg --cell 10 -o plain.tif");
    let [plain, asked] = ["plain.tif", "safe.tif"].map(|name| fs::read(folder.path(name)).unwrap());
    assert!(plain == asked, "safe is the default");
    assert!(!undrained(&height_map(&folder, "safe.tif"), None).is_empty());
    assert!(reasons(&folder.path("safe.gpkg")).contains_key("depression contour"), "{safe}");
    // Cells on the nodes of the working grid and between them.
    for cell in ["10", "7.3"] {
        let said = folder
            .succeeds(&format!("dem c.gpkg --cell {cell} --drain all -o all.tif --diagnostics all.gpkg --overwrite"));
        assert!(said.contains("pits       0 left in the height map"), "{said}");
        assert!(said.contains("hollows inside contours drained: 1"), "{said}");
        assert_eq!(undrained(&height_map(&folder, "all.tif"), None), Vec::<usize>::new());
        assert!(reasons(&folder.path("all.gpkg")).is_empty());
    }
}

#[test]
fn water_stays_in_a_given_sink_and_nowhere_else() {
    let folder = folder();
    let crs = "--crs EPSG:6677";
    write_point(&folder, "sink.geojson", HOLLOW + DVec2::new(20.0, 0.0));
    let run = format!("dem c.gpkg {crs} --cell 10 --drain all -o d.tif --diagnostics d.gpkg --sinks sink.geojson");
    let said = folder.succeeds(&run);
    assert_eq!(reasons(&folder.path("d.gpkg")), BTreeMap::from([("given".to_owned(), 1)]), "{said}");
    let dem = height_map(&folder, "d.tif");
    let left = undrained(&dem, None);
    let lowest = left.iter().copied().min_by(|&a, &b| dem.values[a].total_cmp(&dem.values[b])).unwrap();
    let bottom = dem.values[lowest];
    assert!(bottom < 10.0, "the innermost contour is at 10 m, the bottom at {bottom} m");
    assert!(dem.grid.center(lowest % dem.grid.cols, lowest / dem.grid.cols).distance(HOLLOW) < 50.0);
    assert_eq!(undrained(&dem, Some(lowest)), Vec::<usize>::new(), "all else drains, into the sink or off the map");
    // New contours keep the hollow, too.
    let said = folder.succeeds(&format!(
        "densify c.gpkg {crs} -i 5 --drain all -o l.gpkg --sinks sink.geojson --diagnostics l_d.gpkg"
    ));
    assert!(said.contains("1 given"), "{said}");
}

#[test]
fn sinks_that_cannot_be_used_are_told() {
    let folder = folder();
    write_point(&folder, "slope.geojson", DVec2::new(220.0, 500.0));
    write_point(&folder, "far.geojson", DVec2::new(9000.0, 500.0));
    let said = folder.succeeds(
        "dem c.gpkg --crs EPSG:6677 --cell 10 -o d.tif --sinks slope.geojson --sinks far.geojson --diagnostics d.gpkg",
    );
    assert!(said.contains("sinks without a pit: 1") && said.contains("sinks outside the frame: 1"), "{said}");
    let wrong = folder.ends("dem c.gpkg --cell 10 --surface skeleton --drain all -o e.tif", 2);
    assert!(wrong.contains("--drain has no meaning for --surface skeleton"), "{wrong}");
    let wrong = folder.ends("dem c.gpkg --cell 10 --sinks c.gpkg -o e.tif", 1);
    assert!(wrong.contains("points or polygons"), "{wrong}");
    fs::write(
        folder.path("line.geojson"),
        r#"{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[1,2],[3,4]]}}"#,
    )
    .unwrap();
    let wrong = folder.ends("dem c.gpkg --cell 10 --sinks line.geojson -o e.tif", 1);
    assert!(wrong.contains("no point and no polygon") && wrong.contains("1 lines"), "{wrong}");
}
