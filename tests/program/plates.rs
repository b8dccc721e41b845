//! `mesh --thickness`: a model in layers, to cut with a laser.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeMap;
use std::fs;

use rusqlite::Connection;

use crate::guide_pages::{commands, inputs, run};
use crate::running::{Running, folder_with_part};

/// Status of faulty work, and of wrong usage.
const WORK: i32 = 1;
const USAGE: i32 = 2;

type Ring = Vec<[f64; 2]>;

/// Twice the area of rings as even-odd areas cannot tell holes: outer rings turn to the left, holes to the right.
fn area(rings: &[Ring]) -> f64 {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - b[0] * a[1];
    let of_ring = |ring: &Ring| (0..ring.len()).map(|k| cross(ring[k], ring[(k + 1) % ring.len()])).sum::<f64>() / 2.0;
    rings.iter().map(of_ring).sum()
}

/// The lines of an SVG by the group that they are in, y upwards, and its size in millimetres.
fn svg(text: &str) -> (BTreeMap<String, Vec<Ring>>, [f64; 2]) {
    let attribute = |line: &str, name: &str| {
        let value = line.split(&format!(" {name}=\"")).nth(1)?;
        Some(value.split('"').next()?.to_owned())
    };
    let (mut lines, mut group, mut size) = (BTreeMap::new(), String::new(), [0.0; 2]);
    for line in text.lines() {
        if line.starts_with("<svg") {
            size = ["width", "height"]
                .map(|side| attribute(line, side).unwrap().strip_suffix("mm").unwrap().parse().unwrap());
            assert_eq!(attribute(line, "viewBox").unwrap(), format!("0 0 {} {}", size[0], size[1]));
        } else if line.starts_with("<g") {
            group = attribute(line, "id").unwrap();
        } else if line.starts_with("<path") {
            let numbers = attribute(line, "d").unwrap();
            let numbers: Vec<f64> =
                numbers.trim_start_matches('M').trim_end_matches('Z').split(' ').map(|n| n.parse().unwrap()).collect();
            let points = numbers.chunks(2).map(|p| [p[0], size[1] - p[1]]).collect();
            lines.entry(group.clone()).or_insert_with(Vec::new).push(points);
        }
    }
    (lines, size)
}

#[test]
fn plates_are_the_ground_above_their_levels_at_the_size_that_is_asked_for() {
    let folder = folder_with_part("in.gpkg");
    let said = folder.succeeds("mesh in.gpkg --thickness 3mm -i 40 --size 300mm -o plates.svg");
    let (lines, size) = svg(&fs::read_to_string(folder.path("plates.svg")).unwrap());
    let count = lines.keys().filter(|group| group.ends_with("-cut")).count();
    assert!(said.contains(&format!("{count} plates of 3 mm, one every 40 m, ")), "{said}");
    assert!(said.contains(&format!("sheet of {:.1} x {:.1} mm", size[0], size[1])), "{said}");

    folder.succeeds("densify in.gpkg -i 40 -o lines.gpkg --bands areas.gpkg");
    let db = Connection::open(folder.path("areas.gpkg")).unwrap();
    let mut query =
        db.prepare("SELECT elev_from, sum(area_m2) FROM bands_40m GROUP BY elev_from ORDER BY elev_from").unwrap();
    let bands: Vec<[f64; 2]> =
        query.query_map([], |row| Ok([row.get(0)?, row.get(1)?])).unwrap().map(Result::unwrap).collect();
    assert_eq!(bands.len(), count);
    // The longer side has 300 mm.
    let whole = &lines["plate1-cut"].concat();
    let side = |axis: usize| {
        let all = || whole.iter().map(|p| p[axis]);
        all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
    };
    assert!((side(0).max(side(1)) - 300.0).abs() < 0.002, "{} {}", side(0), side(1));
    let all: f64 = bands.iter().map(|band| band[1]).sum();
    let scale = area(&lines["plate1-cut"]) / all;
    for (k, [from, _]) in bands.iter().enumerate() {
        let above: f64 = bands[k..].iter().map(|band| band[1]).sum();
        let cut = &lines[&format!("plate{}-cut", k + 1)];
        // What is left out is smaller than a few circles of 3 mm.
        let missing = above * scale - area(cut);
        assert!(missing > -1.0 && missing < 40.0, "{missing} mm² above {from} m");
        assert!(lines[&format!("plate{}-numbers", k + 1)].len() >= 2);
    }
    // The outline of a plate on the one below is its cut without the frame.
    let length = |rings: &[Ring], is_closed: bool| -> f64 {
        let of_line = |ring: &Ring| {
            let count = ring.len() - usize::from(!is_closed);
            (0..count)
                .map(|k| (ring[k], ring[(k + 1) % ring.len()]))
                .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
                .sum::<f64>()
        };
        rings.iter().map(of_line).sum()
    };
    for k in 1..count {
        let engraved = length(&lines[&format!("plate{k}-engrave")], false);
        let cut = length(&lines[&format!("plate{}-cut", k + 1)], true);
        assert!(engraved > 0.0 && engraved < cut + 1.0, "plate {k}: {engraved} {cut}");
    }
}

#[test]
fn a_drawing_has_layers_and_the_same_lines() {
    let folder = folder_with_part("in.gpkg");
    let command = "mesh in.gpkg --thickness 4 --exaggeration 2 --size 250";
    let said = folder.succeeds(&format!("{command} -o plates.dxf"));
    folder.succeeds(&format!("{command} -o plates.svg"));
    assert!(said.contains("heights 2.00 times"), "{said}");
    let (lines, _) = svg(&fs::read_to_string(folder.path("plates.svg")).unwrap());
    let text = fs::read_to_string(folder.path("plates.dxf")).unwrap();
    let groups: Vec<(&str, &str)> = text.lines().collect::<Vec<_>>().chunks(2).map(|g| (g[0].trim(), g[1])).collect();
    let unit = groups.iter().position(|group| group.1 == "$INSUNITS").unwrap();
    assert_eq!(groups[unit + 1].1, "4", "millimetres");
    let mut drawn: BTreeMap<String, Vec<Ring>> = BTreeMap::new();
    for entity in groups.split(|group| group.0 == "0").filter(|entity| entity.contains(&("100", "AcDbPolyline"))) {
        let layer = entity.iter().find(|group| group.0 == "8").unwrap().1.to_lowercase();
        let of = |code: &str| -> Vec<f64> {
            entity.iter().filter(|group| group.0 == code).map(|group| group.1.parse().unwrap()).collect()
        };
        let points = of("10").into_iter().zip(of("20")).map(|(x, y)| [x, y]).collect();
        assert!(layer != "cut" || entity.contains(&("70", "1")), "what is cut is closed");
        drawn.entry(layer).or_default().push(points);
    }
    assert_eq!(drawn.keys().collect::<Vec<_>>(), ["cut", "engrave", "numbers"]);
    for (layer, rings) in &drawn {
        let others: Vec<Ring> = lines
            .iter()
            .filter(|(group, _)| group.ends_with(&format!("-{layer}")))
            .flat_map(|(_, l)| l.clone())
            .collect();
        assert_eq!(rings.len(), others.len(), "{layer}");
        let (own, other) = (area(rings), area(&others));
        assert!((own - other).abs() < 1e-5 * other.abs() + 0.01 * others.len() as f64, "{layer}: {own} {other}");
    }
    // Without a thickness, a drawing is a surface of triangles.
    folder.succeeds("mesh in.gpkg --tolerance 2 -o surface.dxf");
    assert!(fs::read_to_string(folder.path("surface.dxf")).unwrap().contains("3DFACE"));
}

#[test]
fn sheets_are_files_of_their_own() {
    let folder = folder_with_part("in.gpkg");
    let command = "mesh in.gpkg --thickness 3mm -i 50 --size 200 --sheet 430x300mm -o plates.svg";
    let said = folder.succeeds(command);
    for words in
        ["plates_1.svg (plates 1 to 2, sheet of 430.0 x 300.0 mm)", "plates_2.svg (plates 3 to 4, sheet of 430.0"]
    {
        assert!(said.contains(words), "{said}");
    }
    assert!(!folder.path("plates.svg").exists());
    for (name, first) in [("plates_1.svg", "plate1"), ("plates_2.svg", "plate3")] {
        let text = fs::read_to_string(folder.path(name)).unwrap();
        assert!(text.contains(&format!("<g id=\"{first}\"")), "{name}");
    }
    // They are replaced, but not those of other programs.
    folder.succeeds(command);
    fs::write(folder.path("plates_2.svg"), "<svg xmlns=\"http://www.w3.org/2000/svg\"/>").unwrap();
    let said = folder.ends(command, WORK);
    assert!(said.contains("plates_2.svg") && said.contains("--overwrite"), "{said}");
    let said = folder.ends("mesh in.gpkg --thickness 3mm --size 200 --sheet 100x100 -o a.svg", USAGE);
    assert!(said.contains("do not fit on a sheet of 100 x 100 mm"), "{said}");
    assert!(!folder.path("a.svg").exists());
}

#[test]
fn the_commands_of_the_guide_make_models() {
    let folder = inputs();
    let commands = commands(include_str!("../../src/guide/models.md"));
    let is_plates = |command: &&&str| command.contains("--thickness");
    assert_eq!(commands.iter().filter(is_plates).count(), 3);
    commands.iter().filter(is_plates).for_each(|command| assert!(run(&folder, command).contains("plates of")));
    let of_height_map = |command: &&&str| command.contains("published_dem.tif") && !is_plates(command);
    assert_eq!(commands.iter().filter(of_height_map).count(), 5);
    commands.iter().filter(of_height_map).for_each(|command| assert!(run(&folder, command).contains("written ")));
}

#[test]
fn flags_that_contradict_plates_are_refused() {
    let folder = folder_with_part("in.gpkg");
    for (arguments, words) in [
        ("-o a.svg", "plates need --thickness"),
        ("-o a.ply --thickness 3mm", "--thickness is for plates"),
        ("-o a.dxf --sheet 600x400", "--sheet is for plates"),
        ("-o a.svg --thickness 3mm -i 20 --exaggeration 2", "Leave out one"),
        ("-o a.svg --thickness 3mm --tolerance 1", "--tolerance is not for plates"),
        ("-o a.svg --thickness 3mm --preview a.png", "--preview is not for plates"),
        ("-o a.svg --thickness 3mm --base-height 0", "--base-height makes a solid"),
        ("-o a.svg --thickness 0", "it must be a length such as 180mm"),
        ("-o a.svg --thickness 3mm --sheet 600", "it must be a width and a height"),
        ("-o a.svg --thickness 3mm -i 0", "--interval is 0, it must be more than 0"),
        ("-o a.svg --thickness 3mm -i 5000", "there is one plate alone"),
        ("-o a.svg --thickness 3mm -i 0.1", "more than 999"),
    ] {
        let said = folder.ends(&format!("mesh in.gpkg {arguments}"), USAGE);
        assert!(said.contains(words), "{arguments}: {said}");
    }
}
