//! What a task finds besides heights: new lines, sides of contours, findings.

use std::path::Path;

use tokosen_core::base::error::{Error, Finding, Result};

use super::bytes::{In, Out};
use super::cut::Piece;
use super::findings::Stored;

/// A part of a new line.
#[derive(Debug, Clone, PartialEq)]
pub struct LinePiece {
    pub elevation: f64,
    pub index: bool,
    pub piece: Piece,
}

/// The part of a layer in a tile.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TileLayer {
    pub pieces: Vec<LinePiece>,
    pub artefact_rings: usize,
    pub dead_ends: usize,
}

/// What a task found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TileResult {
    pub layers: Vec<TileLayer>,
    /// For contours of the map by their number: their length in the tile, negative if higher ground is on the left.
    pub sides: Vec<(u32, f64)>,
    pub findings: Vec<Finding>,
}

impl TileResult {
    pub fn encode(&self) -> Result<Vec<u8>> {
        let mut out = Out::default();
        out.count(self.layers.len());
        for layer in &self.layers {
            [layer.artefact_rings, layer.dead_ends, layer.pieces.len()].into_iter().for_each(|n| out.count(n));
            for LinePiece { elevation, index, piece } in &layer.pieces {
                out.number(*elevation);
                out.count(usize::from(*index) | usize::from(piece.cut[0]) << 1 | usize::from(piece.cut[1]) << 2);
                out.points(&piece.points);
            }
        }
        out.count(self.sides.len());
        for (line, length) in &self.sides {
            out.count(*line as usize);
            out.number(*length);
        }
        let findings: Vec<Stored> = self.findings.iter().map(Stored::from).collect();
        let text = serde_json::to_vec(&findings);
        out.0.extend(text.map_err(|e| Error::Data(format!("the findings cannot be stored: {e}")))?);
        Ok(out.0)
    }

    pub fn decode(bytes: &[u8], file: &Path) -> Result<Self> {
        let mut bytes = In::new(bytes, file);
        let mut result = Self::default();
        for _ in 0..bytes.count(24)? {
            let (artefact_rings, dead_ends) = (bytes.whole()? as usize, bytes.whole()? as usize);
            let mut layer = TileLayer { pieces: Vec::new(), artefact_rings, dead_ends };
            for _ in 0..bytes.count(24)? {
                let (elevation, flags) = (bytes.number()?, bytes.whole()?);
                let piece = Piece { points: bytes.points()?, cut: [flags & 2 != 0, flags & 4 != 0] };
                layer.pieces.push(LinePiece { elevation, index: flags & 1 != 0, piece });
            }
            result.layers.push(layer);
        }
        for _ in 0..bytes.count(16)? {
            result.sides.push((bytes.whole()? as u32, bytes.number()?));
        }
        let findings: Vec<Stored> = serde_json::from_slice(bytes.rest())
            .map_err(|e| Error::file_cause(file, "the findings are broken; do the task again", e))?;
        result.findings = findings.into_iter().filter_map(Stored::finding).collect();
        Ok(result)
    }
}
