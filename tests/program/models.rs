//! Pages, light models and models to print. `scripts/checks/check_terrain_page.py` opens pages in a browser.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::io::Read;

use crate::running::{Running, folder_with_part};

/// Status of wrong usage.
const USAGE: i32 = 2;

/// The triangles of a binary STL.
fn triangles(bytes: &[u8]) -> Vec<[[f32; 3]; 3]> {
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
    assert_eq!(bytes.len(), 84 + 50 * count);
    let corner = |at: usize| [number(at), number(at + 4), number(at + 8)];
    (0..count).map(|k| [12, 24, 36].map(|offset| corner(84 + 50 * k + offset))).collect()
}

#[test]
fn a_print_is_closed_and_as_large_as_asked_for() {
    let folder = folder_with_part("in.gpkg");
    let said = folder.succeeds("mesh in.gpkg --tolerance 1 --size 120mm --exaggeration 2 -o a.stl");
    assert!(said.contains("a.stl (solid,") && said.contains(" mm)"), "{said}");
    let found = triangles(&fs::read(folder.path("a.stl")).unwrap());
    let side = |axis: usize| {
        let all = || found.iter().flatten().map(|corner| corner[axis]);
        all().fold(f32::MIN, f32::max) - all().fold(f32::MAX, f32::min)
    };
    assert!((side(0).max(side(1)) - 120.0).abs() < 0.01, "{} {}", side(0), side(1));
    // Each edge is there once in each direction.
    let bits = |corner: [f32; 3]| corner.map(f32::to_bits);
    let mut edges = std::collections::HashMap::new();
    for [a, b, c] in &found {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((bits(*from), bits(*to))).or_insert(0) += 1;
        }
    }
    assert!(edges.iter().all(|((from, to), count)| *count == 1 && edges.get(&(*to, *from)) == Some(&1)));
    // Twice the heights over two millimetres; the same solid as 3MF.
    folder.succeeds("mesh in.gpkg --tolerance 1 --size 120 -o b.stl");
    let plain = triangles(&fs::read(folder.path("b.stl")).unwrap());
    let top = plain.iter().flatten().map(|corner| corner[2]).fold(f32::MIN, f32::max);
    assert!((side(2) - 2.0 - 2.0 * (top - 2.0)).abs() < 0.01, "{} {top}", side(2));
    folder.succeeds("mesh in.gpkg --tolerance 1 --size 120mm --exaggeration 2 -o a.3mf");
    let mut package = zip::ZipArchive::new(fs::File::open(folder.path("a.3mf")).unwrap()).unwrap();
    let mut model = String::new();
    package.by_name("3D/3dmodel.model").unwrap().read_to_string(&mut model).unwrap();
    assert!(model.contains("unit=\"millimeter\""));
    assert_eq!(model.matches("<triangle ").count(), found.len());
}

#[test]
fn a_light_model_has_few_triangles() {
    let folder = folder_with_part("in.gpkg");
    let count = |said: &str| -> usize {
        let before = said.split(" triangles").next().unwrap();
        before.rsplit(' ').next().unwrap().parse().unwrap()
    };
    let all = count(&folder.succeeds("mesh in.gpkg -o all.ply"));
    let fine = count(&folder.succeeds("mesh in.gpkg --tolerance 0.5 -o fine.ply"));
    let coarse = count(&folder.succeeds("mesh in.gpkg --tolerance 5 --cell 20 -o coarse.ply"));
    assert!(all > 5 * fine && fine > 5 * coarse, "{all} {fine} {coarse}");
}

#[test]
fn a_page_knows_its_lines() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("mesh in.gpkg -i 10 --uncertainty --cell 30 -o page.html");
    let page = fs::read_to_string(folder.path("page.html")).unwrap();
    let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_eq!((&data["title"], &data["grid"]["cell"]), (&"in".into(), &30.0.into()));
    for lines in ["input", "added", "ridges", "canyons"] {
        assert!(data["lines"][lines].as_str().unwrap().len() > 100, "{lines}");
    }
    assert!(data["packed"]["errors"].is_string() && !data["labels"].as_array().unwrap().is_empty());
    folder.succeeds("mesh in.gpkg --cell 30 -o plain.html");
    let plain = fs::read_to_string(folder.path("plain.html")).unwrap();
    assert!(!plain.contains("\"added\":\"") && !plain.contains("\"errors\":\""));
    // Beside denser lines it shows the finest of them.
    let said = folder.succeeds("densify in.gpkg -i 10,5 -o dense.gpkg --page beside.html");
    assert!(said.contains("beside.html (a page for the browser"), "{said}");
    let lengths = ["page.html", "beside.html"].map(|name| {
        let page = fs::read_to_string(folder.path(name)).unwrap();
        page.split("\"added\":\"").nth(1).unwrap().find('"').unwrap()
    });
    assert!(lengths[1] > 2 * lengths[0], "{lengths:?}");
    let said = folder.ends("densify in.gpkg -i 5 -o other.gpkg --page page.pdf", USAGE);
    assert!(said.contains("pages are written as .html, .htm"), "{said}");
}

#[test]
fn flags_that_have_no_meaning_are_refused() {
    let folder = folder_with_part("in.gpkg");
    for (arguments, words) in [
        ("-o a.ply --size 100", "--size is for models to print or to cut"),
        ("-o a.glb --exaggeration 2", "--exaggeration is for models to print or to cut"),
        ("-o a.ply -i 5", "--interval is for pages and plates"),
        ("-o a.stl --uncertainty", "--uncertainty is for pages"),
        ("-o a.ply --cell 5", "--cell needs --tolerance"),
        ("-o a.html --preview a.png", "--preview is for models"),
        ("-o a.html --base-height 0", "--base-height makes a solid"),
        ("-o a.xml --base-height 0", "--base-height makes a solid"),
        ("-o a.html --tolerance 0", "--tolerance is 0, it must be more than 0"),
        ("-o a.stl --size 0mm", "it must be a length such as 180mm"),
        ("-o a.step", "models are written as .html"),
    ] {
        let said = folder.ends(&format!("mesh in.gpkg {arguments}"), USAGE);
        assert!(said.contains(words), "{arguments}: {said}");
    }
    let said = folder.ends("mesh in.gpkg --base-height 9000 -o a.stl", USAGE);
    assert!(said.contains("it must be below the lowest height"), "{said}");
}
