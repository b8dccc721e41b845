//! Maps that tests write for the program.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::path::Path;

use tokosen::contour::{Contour, ContourLayer, ContourLine, ContourMap, Source};
use tokosen::io::{StagedOutput, write_contours};

/// Writes a map's lines as a layer, in the order and with the vertices they have.
pub fn put(path: &Path, map: &ContourMap, layer: &str) {
    let line = |contour: &Contour| ContourLine {
        elevation: contour.elevation,
        points: contour.points.clone(),
        source: Source::Input,
        index: false,
        kind: None,
        depression: false,
        expected: None,
    };
    let lines = map.contours.iter().map(line).collect();
    let layer = ContourLayer { name: layer.into(), lines, artefact_rings: 0, dead_ends: 0 };
    let staged = StagedOutput::create(path).unwrap();
    write_contours(&staged, &[layer], map.crs.as_ref()).unwrap();
    staged.commit().unwrap();
}
