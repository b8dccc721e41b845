//! The layers of a drawing, and the errors if it is not clear which of them hold contours.

use std::collections::BTreeMap;
use std::path::Path;

use super::names::LayerFilter;
use tokosen_core::base::error::{Error, Result};

/// Words in the names of layers that hold contours, in lower case.
const CONTOUR_WORDS: &[&str] = &["contour", "isoline", "hoehenlinie", "höhenlinie", "curva", "courbe", "等高線"];

/// The number of layers that a message lists.
const SHOWN: usize = 20;

/// Counts of one layer.
#[derive(Default)]
struct LayerCounts {
    lines: u64,
    /// Lines whose heights are all 0.
    at_zero: u64,
    /// Points of known height: not at 0.
    spots: u64,
    /// Lines and points that blocks have on this layer, and those of them at height 0.
    in_blocks: [u64; 2],
}

/// The layers of a drawing that have entities.
#[derive(Default)]
pub(super) struct Layers(BTreeMap<String, LayerCounts>);

impl Layers {
    /// Records an entity and how many lines it is.
    pub fn note(&mut self, layer: &str, lines: u64) {
        match self.0.get_mut(layer) {
            Some(content) => content.lines += lines,
            None => {
                self.0.insert(layer.to_owned(), LayerCounts { lines, ..LayerCounts::default() });
            }
        }
    }

    /// Records the heights of a line.
    pub fn note_heights(&mut self, layer: &str, z: &[f64]) {
        if let Some(content) = self.0.get_mut(layer) {
            content.at_zero += u64::from(z.iter().all(|&z| z == 0.0));
        }
    }

    /// Records the height of a point.
    pub fn note_spot(&mut self, layer: &str, z: f64) {
        if let Some(content) = self.0.get_mut(layer) {
            content.spots += u64::from(z != 0.0);
        }
    }

    /// Records a line or point of a block, by its heights.
    pub fn note_in_block(&mut self, layer: &str, z: &[f64]) {
        let counts = &mut self.0.entry(layer.to_owned()).or_default().in_blocks;
        counts[0] += 1;
        counts[1] += u64::from(z.iter().all(|&z| z == 0.0));
    }

    /// Whether all that blocks have on this layer lies at 0, while other lines or points have heights. Those are
    /// symbols, the sheet's border and the like.
    pub fn is_symbol_layer(&self, layer: &str) -> bool {
        let has_heights = |counts: &LayerCounts| {
            counts.at_zero < counts.lines || counts.spots > 0 || counts.in_blocks[1] < counts.in_blocks[0]
        };
        self.0.get(layer).is_some_and(|counts| counts.in_blocks[0] == counts.in_blocks[1])
            && self.0.values().any(has_heights)
    }

    /// Records lines of blocks that are kept as lines of their layer.
    pub fn keep_block_line(&mut self, layer: &str, z: &[f64]) {
        self.note(layer, 1);
        self.note_heights(layer, z);
    }

    /// Refuses a layer name that is not in the drawing.
    pub fn check_named(&self, path: &Path, wanted: &LayerFilter) -> Result<()> {
        match wanted.missing(self.0.keys()) {
            Some(missing) => {
                Err(Error::file(path, format!("there is no layer {missing:?}; its layers are {}", self.list())))
            }
            None => Ok(()),
        }
    }

    /// Refuses drawings whose lines have no elevations. Also refuses drawings where only some layers have elevations,
    /// while the lines of others lie at 0, such as the map border or roads. Those lines would become contours at sea
    /// level.
    pub fn check_elevations(&self, path: &Path, wanted: &LayerFilter, texts: u64) -> Result<()> {
        let with_lines = || self.0.iter().filter(|(layer, content)| wanted.has(layer) && content.lines > 0);
        let flat: Vec<&str> = with_lines()
            .filter(|(layer, content)| content.at_zero == content.lines && !says_contour(layer))
            .map(|(layer, _)| layer.as_str())
            .collect();
        if with_lines().next().is_some() && with_lines().all(|(_, content)| content.at_zero == content.lines) {
            let place = if wanted.is_named() { "on the layers that were named" } else { "in this drawing" };
            let texts = match texts {
                0 => String::new(),
                n => format!(", and the {n} texts that may hold them are not read"),
            };
            // Layer "0" is in every drawing, whatever is on it.
            let is_number = |layer: &&String| *layer != "0" && layer.trim().parse().is_ok_and(f64::is_finite);
            let number = with_lines().map(|(layer, _)| layer).find(is_number);
            return Err(Error::NoElevations { place, texts, layer: number.cloned() }.in_file(path));
        }
        if flat.is_empty() || wanted.is_named() {
            return Ok(());
        }
        let flat = shortened(flat.iter().map(|layer| format!("{layer:?}")));
        Err(Error::FlatLayers { flat, layers: self.list() }.in_file(path))
    }

    fn list(&self) -> String {
        shortened(self.0.iter().map(|(layer, content)| format!("{layer:?} ({} lines)", content.lines)))
    }
}

fn says_contour(layer: &str) -> bool {
    let layer = layer.to_lowercase();
    CONTOUR_WORDS.iter().any(|word| layer.contains(word))
}

fn shortened(names: impl Iterator<Item = String>) -> String {
    let names: Vec<String> = names.collect();
    let more = names.len().saturating_sub(SHOWN);
    let shown = names[..names.len() - more].join(", ");
    if more == 0 { shown } else { format!("{shown} and {more} more") }
}
