//! Joins the pieces of a level to lines.

use glam::DVec2;

use super::cut::Piece;
use super::ends::{End, matched};

/// The lines of a level, from the pieces of all tiles.
#[derive(Debug, Default)]
pub struct Chains {
    pub lines: Vec<Vec<DVec2>>,
    /// Ends at seams that were joined, and the largest distance between two of them.
    pub joined: usize,
    pub furthest: f64,
    /// Ends at seams that nothing goes on from.
    pub left: Vec<DVec2>,
}

/// Joins pieces; each comes with the number of its tile. Ends that are further apart than `most` are not joined.
pub fn chains(pieces: Vec<(usize, Piece)>, most: f64) -> Chains {
    let mut found = Chains::default();
    let ends = |at_end: bool| -> Vec<End> {
        let is_cut = |piece: &Piece| piece.cut[usize::from(at_end)];
        let end = |(k, (tile, piece)): (usize, &(usize, Piece))| {
            let place = if at_end { piece.points.last() } else { piece.points.first() };
            place.filter(|_| is_cut(piece)).map(|&place| End { place, piece: k, tile: *tile })
        };
        pieces.iter().enumerate().filter_map(end).collect()
    };
    let (runs_to, runs_from) = (ends(true), ends(false));
    let mut next: Vec<Option<(usize, DVec2)>> = vec![None; pieces.len()];
    let mut has_before = vec![false; pieces.len()];
    let (mut to_is_left, mut from_is_left) = (vec![true; runs_to.len()], vec![true; runs_from.len()]);
    for [to, from] in matched(&runs_to, &runs_from, most) {
        let (one, other) = (runs_to[to], runs_from[from]);
        found.furthest = found.furthest.max(one.place.distance(other.place));
        found.joined += 1;
        next[one.piece] = Some((other.piece, one.place.midpoint(other.place)));
        has_before[other.piece] = true;
        (to_is_left[to], from_is_left[from]) = (false, false);
    }
    let left = |ends: &[End], is_left: &[bool]| -> Vec<DVec2> {
        ends.iter().zip(is_left).filter(|(_, left)| **left).map(|(end, _)| end.place).collect()
    };
    found.left = [left(&runs_to, &to_is_left), left(&runs_from, &from_is_left)].concat();
    // Open lines begin with a piece that nothing comes before. What is left then are rings.
    let mut is_used = vec![false; pieces.len()];
    let first = (0..pieces.len()).filter(|&k| !has_before[k]).chain((0..pieces.len()).filter(|&k| has_before[k]));
    for first in first {
        if !is_used[first] {
            found.lines.extend(chain(first, &pieces, &next, &mut is_used));
        }
    }
    found
}

/// The line that begins with a piece; `None` if nothing is left of it.
fn chain(
    first: usize,
    pieces: &[(usize, Piece)],
    next: &[Option<(usize, DVec2)>],
    is_used: &mut [bool],
) -> Option<Vec<DVec2>> {
    let mut line: Vec<DVec2> = Vec::new();
    let mut at = first;
    loop {
        is_used[at] = true;
        let points = &pieces[at].1.points;
        // The ends that were joined are replaced by the place between them.
        let from = usize::from(!line.is_empty());
        let Some((after, place)) = next[at] else {
            line.extend(&points[from..]);
            break;
        };
        line.extend(&points[from..points.len() - 1]);
        line.push(place);
        if is_used[after] {
            if after == first {
                line[0] = place;
            }
            break;
        }
        at = after;
    }
    line.dedup();
    let is_ring = line.first() == line.last();
    (line.len() >= if is_ring { 4 } else { 2 }).then_some(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiling::cut::Tile;

    fn pieces(line: &[DVec2], shift: f64) -> Vec<(usize, Piece)> {
        let tiles = (0..4).map(|k| f64::from(k) * 10.0).map(|x| Tile::new([x - 20.0, -50.0, x - 10.0, 50.0]));
        let tile = |(k, tile): (usize, Tile)| {
            // Each tile has its own idea of where the line is.
            let moved: Vec<DVec2> = line.iter().map(|p| *p + DVec2::Y * shift * k as f64).collect();
            tile.pieces(&moved).into_iter().map(move |piece| (k, piece)).collect::<Vec<_>>()
        };
        tiles.enumerate().flat_map(tile).collect()
    }

    #[test]
    fn a_ring_that_was_cut_is_one_ring_again() {
        let ring: Vec<DVec2> =
            (0..=90).map(|k| 15.0 * DVec2::from_angle(-std::f64::consts::TAU * f64::from(k % 90) / 90.0)).collect();
        for shift in [0.0, 0.01] {
            let found = chains(pieces(&ring, shift), 1.0);
            assert_eq!((found.lines.len(), found.joined, found.left.len()), (1, 6, 0), "{shift}");
            assert!(found.furthest <= 2.0 * shift);
            let line = &found.lines[0];
            assert_eq!(line.first(), line.last());
            let area = crate::slice::signed_area(line);
            assert!((area - crate::slice::signed_area(&ring)).abs() < 1.0, "{area}: the direction stays");
        }
    }

    #[test]
    fn an_open_line_keeps_its_ends_and_an_end_without_a_partner_is_reported() {
        let line: Vec<DVec2> = (0..=30).map(|k| DVec2::new(f64::from(k) - 15.2, 3.0)).collect();
        let mut parts = pieces(&line, 0.0);
        let found = chains(parts.clone(), 1.0);
        assert_eq!((found.lines.len(), found.joined), (1, 3));
        assert_eq!((found.lines[0].first(), found.lines[0].last()), (line.first(), line.last()));
        parts.remove(1);
        let found = chains(parts, 1.0);
        assert_eq!((found.lines.len(), found.left.len()), (2, 2));
    }
}
