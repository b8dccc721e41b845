//! Cuts the lines of a layer at the border of an area.

use geo::MultiPolygon;

use super::clip::clip;
use super::line::ContourLine;
use super::map::{Contour, ContourMap};

/// Cuts lines at the border of an area and keeps the parts inside, in their order. The vertices of the lines do not change;
/// see [`clip`].
pub fn clip_lines(lines: &mut Vec<ContourLine>, area: &MultiPolygon<f64>) {
    let numbered = (0u64..).zip(lines.iter_mut()).map(|(k, line)| Contour {
        elevation: line.elevation,
        points: std::mem::take(&mut line.points),
        feature: k.into(),
    });
    let map = ContourMap { contours: numbered.collect(), ..ContourMap::default() };
    let pieces = clip(map, area).map.contours;
    let piece = |piece: Contour| {
        let mut line = ContourLine { points: piece.points, ..lines[piece.feature.number() as usize] };
        // A ring that is cut open has no ground inside.
        line.depression &= line.is_closed();
        line
    };
    *lines = pieces.into_iter().map(piece).collect();
}
