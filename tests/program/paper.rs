//! Maps on paper: PDF and SVG.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::io::Read;

use flate2::read::ZlibDecoder;
use serde_json::Value;

use crate::running::{Running, folder_with, folder_with_part};

/// A part of the sample that is quick to work on, 2000 x 1500 m.
const PART: &str = "--extent 745000,4018500,747000,4020000 --surface linear";

/// The width of the map in an SVG, millimetres.
fn width_of_map(svg: &str) -> f64 {
    let clip = &svg[svg.find("<clipPath id=\"map\">").unwrap()..];
    let width = &clip[clip.find("width=\"").unwrap() + 7..];
    width[..width.find('"').unwrap()].parse().unwrap()
}

/// What the streams of a PDF hold.
fn streams(pdf: &[u8]) -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    let mut from = 0;
    let find = |what: &[u8], from: usize| pdf[from..].windows(what.len()).position(|w| w == what).map(|k| from + k);
    while let Some(at) = find(b"stream\n", from) {
        let start = at + b"stream\n".len();
        let end = find(b"endstream", start).unwrap();
        let mut out = Vec::new();
        if ZlibDecoder::new(&pdf[start..end]).read_to_end(&mut out).is_ok() {
            found.push(out);
        }
        from = end + b"endstream".len();
    }
    found
}

#[test]
fn a_map_has_its_scale_title_and_source_as_text() {
    let folder = folder_with_part("in.gpkg");
    let said = folder.succeeds(&format!(
        "densify in.gpkg -i 10 -o out.gpkg --preview map.svg --scale 1:12500 --paper A4 --title Caryville --source USGS {PART}"
    ));
    assert!(said.contains("map.svg (297 x 210 mm, 1:12500)"), "{said}");
    let svg = fs::read_to_string(folder.path("map.svg")).unwrap();
    assert!(svg.contains("<!-- made by tokosen -->") && svg.contains("width=\"297mm\""));
    for text in
        [">Caryville</text>", ">USGS</text>", ">1:12 500</text>", "Contours every 10 m, from contours every 20 m"]
    {
        assert!(svg.contains(text), "{text}");
    }
    // 2000 m at this scale are 160 mm.
    assert!((width_of_map(&svg) - 160.0).abs() < 0.5, "{}", width_of_map(&svg));
    // It may be replaced by another map.
    let said = folder.succeeds(&format!("dem in.gpkg --cell 50 -o dem.tif --preview map.svg {PART}"));
    assert!(said.contains("map.svg (420 x 297 mm, 1:7500)"), "{said}");
}

#[test]
fn a_pdf_has_lines_and_text_in_an_embedded_font() {
    let folder = folder_with_part("in.gpkg");
    let make = format!("densify in.gpkg -i 10 -o out.gpkg --preview map.pdf --scale 10000 --title Caryville {PART}");
    folder.succeeds(&make);
    let pdf = fs::read(folder.path("map.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF-1."));
    let text = String::from_utf8_lossy(&pdf).into_owned();
    for part in
        ["/Producer (tokosen)", "/Title (Caryville)", "/FontFile2", "/ToUnicode", "/MediaBox [0 0 1190.55 841.89]"]
    {
        assert!(text.contains(part), "{part}");
    }
    let streams = streams(&pdf);
    let content = streams.iter().map(|stream| String::from_utf8_lossy(stream)).find(|s| s.contains(" Tj")).unwrap();
    // More than a thousand vertices, and a text for each label.
    let count = |operator: &str| content.lines().filter(|line| line.ends_with(operator)).count();
    assert!(count(" l") > 1000 && count(" Tj") > 20, "{} {}", count(" l"), count(" Tj"));
    // The letters can be found again.
    let letters: String = streams.iter().map(|s| String::from_utf8_lossy(s).into_owned()).collect();
    assert!(letters.contains("beginbfchar") || letters.contains("beginbfrange"));
    folder.succeeds(&make);
    assert!(pdf == fs::read(folder.path("map.pdf")).unwrap(), "the same bytes again");
}

#[test]
fn a_clip_has_its_outline_and_no_ground_around_it() {
    let folder = folder_with_part("in.gpkg");
    let ring = "[[745000,4018500],[747000,4018700],[746000,4020000],[745000,4018500]]";
    let clip = format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::32616"}}}},
        "features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[{ring}]}}}}]}}"#
    );
    fs::write(folder.path("clip.geojson"), clip).unwrap();
    folder.succeeds("dem in.gpkg --cell 50 --clip clip.geojson --surface linear -o dem.tif --preview look.png");
    let image = image::open(folder.path("look.png")).unwrap().to_rgb8();
    let is_border = |p: &image::Rgb<u8>| p.0[0] > 150 && p.0[1] < 80 && p.0[2] < 90;
    assert!(image.pixels().filter(|p| is_border(p)).count() > 1000);
    // A triangle covers half of its box; around it is paper.
    let white = image.pixels().filter(|p| p.0 == [255; 3]).count() as f64 / image.pixels().len() as f64;
    assert!((0.4..0.8).contains(&white), "{white}");
    folder.succeeds("dem in.gpkg --cell 50 --clip clip.geojson --surface linear -o dem.tif --preview look.svg");
    assert!(fs::read_to_string(folder.path("look.svg")).unwrap().contains("stroke=\"#b01828\""));
}

#[test]
fn what_does_not_fit_is_said_with_what_does() {
    let folder = folder_with("fig3a_spur.geojson", "map.geojson");
    let said = |arguments: &str| folder.ends(&format!("densify map.geojson -i 5 -o out.gpkg {arguments}"), 2);
    assert!(said("--preview look.png --title x").contains("--preview FILE.pdf or FILE.svg"));
    assert!(said("--title x").contains("--preview"));
    assert!(said("--preview look.jpg").contains(".png, .pdf, .svg"));
    assert!(said("--preview look.pdf --paper B9").contains("A4, A3, A2, A1, A0"));
    assert!(said("--preview look.pdf --scale 0").contains("5000 or 1:5000"));
    let no_font =
        folder.ends("densify map.geojson -i 5 -o out.gpkg --preview look.pdf --title x --font map.geojson", 1);
    assert!(no_font.contains("map.geojson: is no TrueType or OpenType font"), "{no_font}");
    let too_large = said("--preview look.pdf --scale 1 --plane-unit m");
    assert!(too_large.contains("too large for A0: take 1:"), "{too_large}");
}

#[test]
fn a_map_of_differences_has_its_scale_and_its_figures() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds(&format!("dem in.gpkg --cell 50 -o a.tif {}", PART.replace("linear", "skeleton")));
    folder.succeeds(&format!("dem in.gpkg --cell 50 -o b.tif {PART}"));
    let said = folder.succeeds("compare a.tif b.tif --preview map.svg --scale 12500 --source USGS");
    assert!(said.contains("map.svg (297 x 210 mm, 1:12500)"), "{said}");
    let svg = fs::read_to_string(folder.path("map.svg")).unwrap();
    // Beside JSON, nothing is said about the picture.
    let json = folder.succeeds("compare a.tif b.tif --json --preview json.svg -q");
    let figures: Value = serde_json::from_str(&json).unwrap();
    let rmse = figures["overall"]["rmse"].as_f64().unwrap();
    let shown = svg.split("RMSE ").nth(1).and_then(|text| text.split(' ').next()).unwrap().parse::<f64>().unwrap();
    assert!((shown - rmse).abs() <= 0.01 * rmse.max(0.5), "{shown} {rmse}");
    for text in [">Heights compared: A − B</text>", ">A: a.tif  ·  B: b.tif</text>", ">1:12 500</text>", ">USGS</text>"]
    {
        assert!(svg.contains(text), "{text}");
    }
    folder.succeeds("compare a.tif b.tif --preview map.pdf --title Change");
    let pdf = fs::read(folder.path("map.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF") && streams(&pdf).len() > 2);
    let refused = folder.ends("compare a.tif b.tif --preview map.png", 2);
    assert!(refused.contains("maps of differences are written as .pdf, .svg"), "{refused}");
}
