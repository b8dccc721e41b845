//! Pages, light models and models to print. `scripts/checks/check_terrain_page.py` opens pages in a browser.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::io::Read;

use crate::obj::Obj;
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
        ("-o a.ply --keep contours", "--keep needs --tolerance"),
        ("-o a.html --keep contours --tolerance 1", "--keep is for models"),
        ("-o a.svg --thickness 3mm --keep contours", "--keep is not for plates"),
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

#[test]
fn lines_that_are_kept_are_edges_with_all_their_vertices() {
    let folder = folder_with_part("in.gpkg");
    let breaks = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32616"}},"features":[
        {"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":
        [[745511.3,4018202.7],[746003.1,4018390.4],[746702.9,4018501.2]]}}]}"#;
    fs::write(folder.path("breaks.geojson"), breaks).unwrap();
    // The contours as they are drawn, in map coordinates.
    folder.succeeds("densify in.gpkg -i 20 -o lines.geojson");
    let lines: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("lines.geojson")).unwrap()).unwrap();
    let of_input = |feature: &&serde_json::Value| feature["properties"]["source"] == "input";
    let contours: Vec<Vec<[f64; 3]>> = lines["features"]
        .as_array()
        .unwrap()
        .iter()
        .filter(of_input)
        .map(|feature| {
            let elevation = feature["properties"]["elev"].as_f64().unwrap();
            let points = feature["geometry"]["coordinates"].as_array().unwrap();
            points.iter().map(|p| [p[0].as_f64().unwrap(), p[1].as_f64().unwrap(), elevation]).collect()
        })
        .collect();
    assert!(contours.iter().map(Vec::len).sum::<usize>() > 1000);
    let given = "mesh in.gpkg --breaklines breaks.geojson --tolerance 2";
    folder.succeeds(&format!("{given} -o none.obj"));
    folder.succeeds(&format!("{given} --keep breaklines -o breaks.obj"));
    folder.succeeds(&format!("{given} --keep contours -o all.obj"));
    let [none, breaks, all] = ["none.obj", "breaks.obj", "all.obj"].map(|name| Obj::read(&folder, name));
    let corners = [[745511.3, 4018202.7], [746003.1, 4018390.4], [746702.9, 4018501.2]];
    let has = |model: &Obj, p: [f64; 2]| model.vertices.iter().any(|v| (v[0] - p[0]).hypot(v[1] - p[1]) < 1e-6);
    for (model, is_kept) in [(&none, false), (&breaks, true), (&all, true)] {
        assert!(corners.iter().all(|p| has(model, *p) == is_kept));
    }
    // Every vertex of a contour, and every piece of it as an edge, or as edges end to end.
    let number = |p: [f64; 3]| p.map(|v| (v * 1e6).round() as i64);
    let vertices: std::collections::HashMap<[i64; 3], usize> =
        all.vertices.iter().enumerate().map(|(k, v)| (number(*v), k)).collect();
    let edges: std::collections::HashSet<[usize; 2]> = all
        .triangles
        .iter()
        .flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]])
        .flat_map(|[a, b]| [[a, b], [b, a]])
        .collect();
    let mut missing = 0;
    for piece in contours.iter().flat_map(|line| line.windows(2)) {
        let ends = [piece[0], piece[1]].map(|p| vertices.get(&number(p)).copied());
        let [Some(from), Some(to)] = ends else { panic!("{piece:?} is not in the model") };
        if !edges.contains(&[from, to]) {
            let (length, way) = ((piece[1][0] - piece[0][0]).hypot(piece[1][1] - piece[0][1]), |v: [f64; 3]| {
                [v[0] - piece[0][0], v[1] - piece[0][1]]
            });
            let [x, y] = way(piece[1]);
            let off = |v: &[f64; 3]| {
                let [a, b] = way(*v);
                ((a * y - b * x) / length, (a * x + b * y) / length)
            };
            let mut chain: Vec<usize> = (0..all.vertices.len())
                .filter(|k| {
                    let (aside, along) = off(&all.vertices[*k]);
                    aside.abs() < 1e-3 && (-1e-9..=length + 1e-9).contains(&along)
                })
                .collect();
            chain.sort_by(|a, b| off(&all.vertices[*a]).1.total_cmp(&off(&all.vertices[*b]).1));
            missing += usize::from(!chain.windows(2).all(|pair| edges.contains(&[pair[0], pair[1]])));
        }
    }
    assert_eq!(missing, 0);
}
