//! Small rings and needless vertices, left out together.

use super::ground::Ground;
use super::rules::{MapScale, SIMPLIFIED, SMALLEST_RING};
use crate::contour::ContourLine;
use crate::geometry::Bounds;
use crate::slice::signed_area;
use crate::tiles::kept_vertices;

/// Leaves out what cannot be seen at a scale: vertices, and then rings, whose number is returned. A vertex goes if no vertex of any
/// line lies in the triangle with its neighbours. So lines that did not touch do not touch then.
pub(super) fn generalise(lines: &mut Vec<ContourLine>, scale: MapScale, ground: &Ground) -> usize {
    // In degrees, a unit is longer from south to north. With the longer one, no line is off by more than the tolerance.
    let tolerance = scale.metres(SIMPLIFIED) / ground.metres.max_element();
    let kept = kept_vertices(lines.iter().map(|line| (line.points.as_slice(), line.is_closed())), tolerance);
    for (line, kept) in lines.iter_mut().zip(kept) {
        let mut kept = kept.into_iter();
        line.points.retain(|_| kept.next().unwrap_or(true));
        line.depression = line.is_closed() && signed_area(&line.points) > 0.0;
    }
    let before = lines.len();
    lines.retain(|line| {
        let bounds = Bounds::around(&line.points);
        let size = ((bounds.max - bounds.min) * ground.metres).max_element();
        !line.is_closed() || size >= scale.metres(SMALLEST_RING)
    });
    before - lines.len()
}
