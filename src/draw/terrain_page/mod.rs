//! A terrain in 3-D as one HTML file, which a browser opens from disk.
//!
//! The page has everything in it: the triangles, the heights in cells, the lines, and three.js, which draws them (`vendor`, which
//! `scripts/make/make_page_library.py` makes). It asks nothing of anybody, and a policy in the page makes the browser refuse it.
//! What it shows under the pointer, in profiles and at a level comes from the heights in cells; the triangles are for the eye.
//!
//! The scripts stand one behind the other, each with one concept: words, units, the data, the ground, colours, the scene, lines,
//! marks, the profile, the panel, the view, the flat picture for browsers without WebGL, and the start.

mod packed;

use glam::{DVec2, DVec3};
use maud::html;
use serde_json::{Map, Value, json};

use self::packed::Packed;
use crate::page::Page;
use tokosen_core::base::Units;
use tokosen_core::base::error::Finding;
use tokosen_core::contour::{ContourLine, Source};
use tokosen_core::mesh::Mesh;
use tokosen_core::raster::Dem;
use tokosen_core::slice::Label;

const STYLE: &str = include_str!("page/page.css");
const LIBRARY: &str = include_str!("vendor/three.js");
const LICENCES: &str = include_str!("vendor/LICENSES.txt");
const SCRIPTS: [&str; 13] = [
    include_str!("page/words.js"),
    include_str!("page/units.js"),
    include_str!("page/data.js"),
    include_str!("page/ground.js"),
    include_str!("page/colours.js"),
    include_str!("page/scene.js"),
    include_str!("page/lines.js"),
    include_str!("page/marks.js"),
    include_str!("page/profile.js"),
    include_str!("page/panel.js"),
    include_str!("page/view.js"),
    include_str!("page/flat.js"),
    include_str!("page/main.js"),
];

/// What the browser may load: what is in the page.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                      base-uri 'none'; form-action 'none'";
/// Heights are told to half of this, metres. A reader sees centimetres.
const HEIGHT_STEP: f64 = 0.005;
/// Expected errors and differences, metres.
const ERROR_STEP: f64 = 0.001;
/// Places of lines and triangles, as a share of a cell.
const PLACE_STEP: f64 = 0.01;
/// Findings that a page shows; those that are worst come first.
const MOST_FINDINGS: usize = 500;

/// What the page shows. All places are map coordinates on one plane in metres.
#[derive(Debug, Clone)]
pub struct TerrainPage<'a> {
    /// What the terrain is called.
    pub title: &'a str,
    /// Heights in square cells.
    pub heights: &'a Dem,
    /// Their standard errors, metres.
    pub errors: Option<Vec<f32>>,
    /// Differences from other heights.
    pub differences: Option<Differences>,
    /// Which cells are water.
    pub water: Option<Vec<bool>>,
    /// The triangles, without a bottom.
    pub mesh: &'a Mesh,
    /// How near the triangles are to the heights, metres.
    pub tolerance: f64,
    /// Contours of the input, and new ones.
    pub contours: &'a [ContourLine],
    /// Labels of contours.
    pub labels: &'a [Label],
    /// Other lines by their name in `page/colours.js`, with heights in metres.
    pub lines: Vec<(&'static str, Vec<Vec<DVec3>>)>,
    /// Spot heights.
    pub spots: Vec<DVec3>,
    /// What was found in the input.
    pub findings: &'a [Finding],
    /// The factor on heights that the page begins with.
    pub exaggeration: f64,
    /// The units of heights.
    pub units: Units,
}

impl<'a> TerrainPage<'a> {
    /// Heights and their triangles alone, in metres and not exaggerated.
    pub fn of_heights(heights: &'a Dem, mesh: &'a Mesh) -> Self {
        Self {
            title: "",
            heights,
            errors: None,
            differences: None,
            water: None,
            mesh,
            tolerance: 0.0,
            contours: &[],
            labels: &[],
            lines: Vec::new(),
            spots: Vec::new(),
            findings: &[],
            exaggeration: 1.0,
            units: Units::METRES,
        }
    }
}

/// Differences from other heights, metres.
#[derive(Debug, Clone)]
pub struct Differences {
    /// The differences in the cells, NaN where the other heights are missing.
    pub values: Vec<f32>,
    /// Colours reach from minus this to this.
    pub limit: f64,
    /// The places of the largest, and their differences.
    pub places: Vec<(DVec2, f64)>,
}

/// The page as HTML.
pub fn terrain_page(page: &TerrainPage<'_>) -> String {
    Page {
        title: page.title,
        policy: POLICY,
        styles: &[STYLE],
        body: html! { canvas id="terrain" tabindex="0" role="application" {} },
        licences: LICENCES,
        data: &data(page),
        libraries: &[LIBRARY],
        scripts: &SCRIPTS,
    }
    .html()
}

/// The data of the page.
fn data(page: &TerrainPage<'_>) -> Value {
    let grid = &page.heights.grid;
    let origin = page.mesh.origin;
    let step = PLACE_STEP * grid.cell.x;
    let near = |p: DVec2| p - origin.truncate();
    let first = near(grid.center(0, 0));
    let cells = |values: &[f32], step| Packed::cells(values.iter().copied(), grid.cols, step).text();

    let (mut vertices, mut corners) = (Packed::default(), Packed::default());
    page.mesh.vertices.iter().for_each(|v| vertices.push_place(*v, step));
    let mut last = 0;
    for corner in page.mesh.triangles.as_flattened() {
        corners.push_signed(i64::from(*corner) - last);
        last = i64::from(*corner);
    }
    let mut packed = json!({
        "heights": cells(&page.heights.values, HEIGHT_STEP), "vertices": vertices.text(), "corners": corners.text(),
    });
    if let Some(errors) = &page.errors {
        packed["errors"] = cells(errors, ERROR_STEP).into();
    }
    if let Some(differences) = &page.differences {
        packed["differences"] = cells(&differences.values, ERROR_STEP).into();
    }
    if let Some(water) = &page.water {
        let values: Vec<f32> = water.iter().map(|is| f32::from(u8::from(*is))).collect();
        packed["water"] = cells(&values, 1.0).into();
    }

    let contours = |name: &'static str| {
        let is_own = move |line: &&ContourLine| name_of(line.source) == name;
        let own = page.contours.iter().filter(is_own);
        let lines = own.map(|line| (line.index, line.points.iter().map(|p| p.extend(line.elevation)).collect()));
        (name, lines.collect())
    };
    let others = page.lines.iter().map(|(name, lines)| {
        let lines: Vec<(bool, Vec<DVec3>)> = lines.iter().map(|line| (false, line.clone())).collect();
        (*name, lines)
    });
    let all = ["input", "contours", "added"].map(contours).into_iter().chain(others);
    let lines: Map<String, Value> = all
        .filter(|(_, lines)| !lines.is_empty())
        .map(|(name, lines)| (name.to_owned(), packed_lines(&lines, origin, step).into()))
        .collect();

    let mut findings: Vec<&Finding> = page.findings.iter().collect();
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.kind.severity()));
    let shown = findings.iter().take(MOST_FINDINGS).map(|finding| {
        let place = finding.place.map(|place| near(place).to_array());
        json!({ "severity": finding.kind.severity().name(), "message": finding.message, "place": place })
    });
    let unit = page.units.heights;
    let largest = page.differences.iter().flat_map(|differences| &differences.places).map(|(place, difference)| {
        let message = format!("{:+.2} {}", unit.from_metres(*difference), unit.symbol());
        json!({ "severity": "note", "message": message, "place": near(*place).to_array() })
    });
    let labels = page.labels.iter().map(|label| near(label.position).extend(label.elevation).to_array());
    let spots = page.spots.iter().map(|spot| near(spot.truncate()).extend(spot.z).to_array());
    json!({
        "title": page.title,
        "unit": { "name": unit.symbol(), "size": unit.metres(1.0) },
        "crs": page.heights.crs.as_ref().and_then(|crs| crs.name()),
        "origin": origin.truncate().to_array(),
        "grid": { "x": first.x, "y": first.y, "cell": grid.cell.x, "cols": grid.cols, "rows": grid.rows },
        "step": { "height": HEIGHT_STEP, "error": ERROR_STEP, "place": step },
        "tolerance": page.tolerance,
        "times": page.exaggeration,
        "limit": page.differences.as_ref().map(|differences| differences.limit),
        "packed": packed,
        "lines": lines,
        "labels": labels.collect::<Vec<_>>(),
        "spots": spots.collect::<Vec<_>>(),
        "findings": shown.chain(largest).collect::<Vec<_>>(),
        "leftOut": findings.len().saturating_sub(MOST_FINDINGS),
    })
}

/// The name of contours in `page/colours.js`.
fn name_of(source: Source) -> &'static str {
    match source {
        Source::Input => "input",
        Source::HeightMap => "contours",
        Source::Interpolated => "added",
    }
}

/// Lines: twice the number of vertices, plus one for index contours, and the vertices.
fn packed_lines(lines: &[(bool, Vec<DVec3>)], origin: DVec3, step: f64) -> String {
    let mut packed = Packed::default();
    for (is_index, points) in lines {
        packed.push(2 * points.len() as u64 + u64::from(*is_index));
        points.iter().for_each(|p| packed.push_place(*p - origin, step));
    }
    packed.text()
}

#[cfg(test)]
mod tests;
