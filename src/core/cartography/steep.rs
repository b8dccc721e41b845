//! Intermediate contours, left out where lines would run together on steep slopes.

use super::ground::Ground;
use super::nearest::Nearest;
use super::pieces::Drawn;
use super::rules::{CLOSEST, MapScale, SHORTEST};
use super::supplementary::{along, cut};
use crate::base::parallel;
use crate::contour::{ContourKind, ContourLine};

/// Leaves out intermediate contours where they are closer to a line of another level than lines may be at a scale. Index contours
/// stay. Supplementary contours do not count: they keep clear of the others themselves. Returns the length that was left out,
/// metres.
pub(super) fn thin(lines: &mut Vec<ContourLine>, scale: MapScale, ground: &Ground) -> f64 {
    let metres = ground.metres;
    let numbered = (0u32..).zip(lines.iter());
    let is_main = |line: &ContourLine| !line.kind.is_some_and(ContourKind::is_supplementary);
    let main: Vec<u32> = numbered.filter(|(_, line)| is_main(line)).map(|(number, _)| number).collect();
    let nearest = Nearest::new(lines, &main, metres);
    let chosen = parallel::map_each(lines, |line| match line.kind {
        Some(ContourKind::Intermediate) => {
            let close = nearest.close(line, scale.metres(CLOSEST), metres);
            close
                .contains(&true)
                .then(|| apart(&close, &along(&line.points, metres), line.is_closed(), scale.metres(SHORTEST)))
        }
        _ => None,
    });
    let length = |line: &ContourLine| along(&line.points, metres)[line.points.len() - 1];
    let mut left_out = 0.0;
    let mut kept = Vec::with_capacity(lines.len());
    for (line, chosen) in std::mem::take(lines).into_iter().zip(chosen) {
        let Some(chosen) = chosen else {
            kept.push(line);
            continue;
        };
        left_out += length(&line);
        for piece in cut(line, chosen) {
            left_out -= length(&piece);
            kept.push(piece);
        }
    }
    *lines = kept;
    left_out
}

/// The pieces of a line between its segments that are close to others, those of a least length. At least one segment is close.
fn apart(close: &[bool], along: &[f64], is_ring: bool, shortest: f64) -> Drawn {
    let count = close.len();
    // A ring begins behind a segment that is left out.
    let start = if is_ring { close.iter().position(|close| *close).map_or(0, |k| k + 1) } else { 0 };
    let at = |v: usize| along[v % count] + (v / count) as f64 * along[count];
    let at = |v: usize| if is_ring { at(v) } else { along[v] };
    let mut pieces = Vec::new();
    let mut from = start;
    for k in start..=start + count {
        if k == start + count || close[k % count] {
            if k > from && at(k) - at(from) >= shortest {
                pieces.push([from, k]);
            }
            from = k + 1;
        }
    }
    Drawn::Pieces(pieces)
}
