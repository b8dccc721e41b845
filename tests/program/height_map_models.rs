//! `mesh` with a height map: models, pages and plates.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs;

use crate::common::Folder;
use crate::obj::Obj;
use crate::running::{Running, folder_with};

/// Status of faulty work, and of wrong usage.
const WORK: i32 = 1;
const USAGE: i32 = 2;

/// Columns, rows, and size of the cells of [`hills`].
const COLS: usize = 40;
const ROWS: usize = 30;
const CELL: f64 = 10.0;

/// The height of a cell of [`hills`], and whether the map has it.
fn height(col: usize, row: usize) -> Option<f64> {
    let (x, y) = (col as f64, row as f64);
    let known = !((10..14).contains(&col) && (12..15).contains(&row)) && (col, row) != (0, 0);
    known.then(|| ((x / 5.0).sin() * (y / 4.0).cos() * 20.0 + 100.0).round())
}

fn centre(col: usize, row: usize) -> [f64; 2] {
    [5000.0 + CELL * (col as f64 + 0.5), 3000.0 + CELL * (ROWS as f64 - row as f64 - 0.5)]
}

/// A folder with hills that have a hole, and a corner without a height.
fn hills() -> Folder {
    let folder = Folder::new();
    let mut text =
        format!("ncols {COLS}\nnrows {ROWS}\nxllcorner 5000\nyllcorner 3000\ncellsize {CELL}\nNODATA_value -9999\n");
    for row in 0..ROWS {
        for col in 0..COLS {
            write!(text, "{} ", height(col, row).unwrap_or(-9999.0)).unwrap();
        }
        text.push('\n');
    }
    fs::write(folder.path("hills.asc"), text).unwrap();
    folder
}

#[test]
fn all_triangles_have_the_heights_of_cells_and_cells_without_data_are_no_ground() {
    let folder = hills();
    folder.succeeds("mesh hills.asc -o all.obj");
    let all = Obj::read(&folder, "all.obj");
    let known = (0..ROWS).flat_map(|row| (0..COLS).filter_map(move |col| Some((centre(col, row), height(col, row)?))));
    let known: HashMap<[u64; 2], f64> = known.map(|(p, z)| (p.map(f64::to_bits), z)).collect();
    assert_eq!(all.vertices.len(), known.len());
    for [x, y, z] in &all.vertices {
        assert_eq!(known.get(&[x.to_bits(), y.to_bits()]), Some(z));
    }
    // Five by four squares have a corner in the hole, and one has the corner of the map.
    let squares = (COLS - 1) * (ROWS - 1) - 5 * 4 - 1;
    assert_eq!(all.triangles.len(), 2 * squares);
    assert!((all.area() - squares as f64 * CELL * CELL).abs() < 1e-6);
    assert!(all.heights_at(centre(11, 13)).is_empty());

    folder.succeeds("mesh hills.asc --tolerance 1 -o few.obj");
    let few = Obj::read(&folder, "few.obj");
    assert!(few.triangles.len() < all.triangles.len() / 2, "{}", few.triangles.len());
    assert!((few.area() - all.area()).abs() < 1e-6);
    for (col, row) in (0..ROWS).flat_map(|row| (0..COLS).map(move |col| (col, row))) {
        let own = few.heights_at(centre(col, row));
        assert_eq!(own.is_empty(), height(col, row).is_none(), "{col} {row}");
        assert!(own.iter().all(|own| (own - height(col, row).unwrap()).abs() <= 1.0 + 1e-6), "{col} {row}");
    }
}

#[test]
fn a_part_ends_at_its_border() {
    let folder = hills();
    for (few, name) in [("", "all.obj"), ("--tolerance 1", "few.obj")] {
        folder.succeeds(&format!("mesh hills.asc {few} --extent 5203,3007,5358.5,3142 -o {name}"));
        let part = Obj::read(&folder, name);
        assert!((part.area() - 155.5 * 135.0).abs() < 1e-4, "{name}: {}", part.area());
        let side = |axis: usize| {
            let all = || part.vertices.iter().map(|v| v[axis]);
            [all().fold(f64::MAX, f64::min), all().fold(f64::MIN, f64::max)]
        };
        assert_eq!([side(0), side(1)], [[5203.0, 5358.5], [3007.0, 3142.0]]);
    }
    let said = folder.ends("mesh hills.asc --extent 9203,3007,9358.5,3142 -o elsewhere.obj", WORK);
    assert!(said.contains("in this part of the map"), "{said}");
    // The part of a part without cells is the hole.
    let said = folder.ends("mesh hills.asc --extent 5111,3156,5129,3169 -o hole.obj", WORK);
    assert!(said.contains("in this part of the map"), "{said}");
}

#[test]
fn a_height_map_has_all_outputs_of_contours() {
    let folder = hills();
    for (arguments, words) in [
        ("-o a.ply --base-height 0 --preview a.png", "a.ply (solid,"),
        ("-o a.glb --tolerance 1", "a.glb (shell,"),
        ("-o a.xml", "a.xml (shell,"),
        ("-o a.dxf --tolerance 1", "a.dxf (shell,"),
        ("-o a.stl --size 120mm", "120.00 x"),
        ("-o a.3mf --exaggeration 2 --tolerance 1", "a.3mf (solid,"),
        ("-o a.html -i 5", "a.html (a page for the browser"),
        ("-o plain.html --cell 20", "plain.html (a page for the browser"),
        ("-o a.svg --thickness 3mm -i 5", "heights"),
        ("-o plates.dxf --thickness 3mm --exaggeration 3 --sheet 600x400", "plates of 3 mm"),
    ] {
        let said = folder.succeeds(&format!("mesh hills.asc {arguments}"));
        assert!(said.contains(words) && said.contains("hills.asc (40 x 30 cells)"), "{arguments}: {said}");
    }
    assert!(
        folder.path("a.png").exists() && folder.path("plates_1.dxf").exists() != folder.path("plates.dxf").exists()
    );
    let data = |name: &str| -> serde_json::Value {
        let page = fs::read_to_string(folder.path(name)).unwrap();
        let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
        serde_json::from_str(data).unwrap()
    };
    let (page, plain) = (data("a.html"), data("plain.html"));
    assert_eq!(
        (&page["title"], &page["grid"]["cols"], &page["tolerance"]),
        (&"hills".into(), &40.into(), &0.25.into())
    );
    assert!(page["lines"]["contours"].is_string() && !page["labels"].as_array().unwrap().is_empty());
    assert_eq!((&plain["grid"]["cell"], plain["lines"].as_object().unwrap().len()), (&20.0.into(), 0));
}

#[test]
fn cells_in_degrees_become_a_model_in_metres() {
    let folder = folder_with("caryville_20m.gpkg", "in.gpkg");
    folder.succeeds("dem in.gpkg --cell-degrees 0.001 -o degrees.tif");
    let said = folder.succeeds("mesh degrees.tif -o model.obj --extent -84.25,36.26,-84.22,36.28");
    assert!(said.contains("heights are interpolated in cells of") && said.contains("UTM zone 16N"), "{said}");
    let part = Obj::read(&folder, "model.obj");
    // 0.03 by 0.02 degrees at 36.27° north.
    let expected = (0.03 * 89_865.0) * (0.02 * 110_966.0);
    assert!((part.area() / expected - 1.0).abs() < 2e-3, "{} {expected}", part.area());
    // Without a name, degrees are not taken for metres.
    let rows = "1 2 3 4 5 6\n".repeat(6);
    let text = format!("ncols 6\nnrows 6\nxllcorner 138\nyllcorner 36\ncellsize 0.001\n{rows}");
    fs::write(folder.path("bare.asc"), text).unwrap();
    let said = folder.ends("mesh bare.asc -o bare.obj", WORK);
    assert!(said.contains("the coordinates look like degrees"), "{said}");
    folder.succeeds("mesh bare.asc --crs EPSG:6668 -o bare.obj");
}

#[test]
fn a_plane_in_feet_gives_a_model_in_feet() {
    let folder = hills();
    folder.succeeds("mesh hills.asc --plane-unit ft -o feet.obj");
    folder.succeeds("mesh hills.asc -o metres.obj");
    let [feet, metres] = ["feet.obj", "metres.obj"].map(|name| Obj::read(&folder, name));
    assert_eq!(feet.triangles, metres.triangles);
    for (of_feet, of_metres) in feet.vertices.iter().zip(&metres.vertices) {
        assert!((0..2).all(|axis| (of_feet[axis] - of_metres[axis]).abs() < 1e-6), "{of_feet:?} {of_metres:?}");
        assert!((of_feet[2] * 0.3048 - of_metres[2]).abs() < 1e-6);
    }
}

#[test]
fn flags_about_contours_are_refused() {
    let folder = hills();
    for (arguments, words) in [
        ("-o a.ply --streams rivers.gpkg", "--streams applies to contours, but the input is a height map"),
        ("-o a.ply --tension 3", "--tension applies to contours"),
        ("-o a.ply --frame bbox", "--frame applies to contours"),
        ("-o a.ply --elevation-field z", "--elevation-field applies to contours"),
        ("-o a.ply --work-crs EPSG:6677", "--work-crs applies to contours"),
        ("-o a.ply --points spots.csv", "--points applies to contours"),
        ("-o a.html --uncertainty", "--uncertainty applies to contours"),
        ("-o a.ply --tolerance 1 --cell 5", "--cell applies to contours and pages"),
        ("-o a.ply -i 5", "--interval is for pages and plates"),
    ] {
        let said = folder.ends(&format!("mesh hills.asc {arguments}"), USAGE);
        assert!(said.contains(words), "{arguments}: {said}");
    }
    let said = folder.ends("mesh hills.asc hills.asc -o a.ply", USAGE);
    assert!(said.contains("only one height map can be the input"), "{said}");
}

#[test]
fn a_row_of_cells_is_no_ground_and_cells_of_a_page_are_not_too_many() {
    let folder = hills();
    fs::write(folder.path("row.asc"), "ncols 4\nnrows 1\nxllcorner 5000\nyllcorner 3000\ncellsize 10\n1 2 3 4\n")
        .unwrap();
    for output in ["-o a.ply", "-o a.stl --tolerance 1", "-o a.html -i 1", "-o a.svg --thickness 3mm"] {
        let said = folder.ends(&format!("mesh row.asc {output}"), WORK);
        assert!(said.contains("no four neighbouring cells have heights"), "{output}: {said}");
    }
    let (well, said) = folder.run("mesh hills.asc --cell 0.00001 -o a.html");
    assert!(!well && said.contains("cells"), "{said}");
    assert!(!folder.path("a.html").exists());
}

#[test]
fn few_triangles_are_the_same_for_any_number_of_threads() {
    let folder = folder_with("caryville_20m_truth.tif", "truth.tif");
    let made = [1, 2, 5].map(|threads| {
        folder.succeeds(&format!("mesh truth.tif --tolerance 1 --threads {threads} -o {threads}.ply"));
        fs::read(folder.path(&format!("{threads}.ply"))).unwrap()
    });
    assert!(made[0] == made[1] && made[0] == made[2]);
}
