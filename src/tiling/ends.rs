//! Which ends of line pieces at seams belong together.
//!
//! Both tiles at a seam compute where a line crosses it. The two places differ by as little as the heights do. An end goes with the
//! nearest end of a piece in another tile that runs on in its direction. A line that only touches a seam may leave a tile and come
//! back, and be missing in the other one. Then its two ends in one tile go together.

use std::collections::HashMap;

use glam::DVec2;

/// An end at a seam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    pub place: DVec2,
    /// The number of its piece.
    pub piece: usize,
    /// The tile of its piece.
    pub tile: usize,
}

/// The ends that belong together: for pieces that run to a seam, the number of the piece that goes on from there. `runs_to` and `runs_from`
/// are the ends of one layer and level.
pub fn matched(runs_to: &[End], runs_from: &[End], most: f64) -> Vec<[usize; 2]> {
    let square = |p: DVec2| (p / most).floor().to_array().map(|v| v as i64);
    let mut by_square: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for (k, end) in runs_from.iter().enumerate() {
        by_square.entry(square(end.place)).or_default().push(k);
    }
    let mut pairs: Vec<(bool, f64, usize, usize)> = Vec::new();
    for (k, end) in runs_to.iter().enumerate() {
        let [x, y] = square(end.place);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        for &other in around.filter_map(|square| by_square.get(&square)).flatten() {
            let distance = end.place.distance(runs_from[other].place);
            if distance <= most {
                pairs.push((end.tile == runs_from[other].tile, distance, k, other));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then((a.2, a.3).cmp(&(b.2, b.3))));
    let (mut used_to, mut used_from) = (vec![false; runs_to.len()], vec![false; runs_from.len()]);
    let mut found = Vec::new();
    for (_, _, to, from) in pairs {
        if !used_to[to] && !used_from[from] {
            (used_to[to], used_from[from]) = (true, true);
            found.push([to, from]);
        }
    }
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn end(x: f64, y: f64, piece: usize, tile: usize) -> End {
        End { place: DVec2::new(x, y), piece, tile }
    }

    #[test]
    fn the_nearest_ends_of_two_tiles_go_together_and_those_of_one_tile_only_if_left() {
        let to = [end(0.0, 5.0, 0, 0), end(0.0, 6.0, 1, 1), end(0.0, 90.0, 2, 0)];
        let from = [end(0.0, 5.2, 3, 1), end(0.0, 6.1, 4, 0), end(0.0, 91.0, 5, 0), end(0.0, 5.05, 6, 0)];
        assert_eq!(matched(&to, &from, 3.0), [[0, 0], [1, 1], [2, 2]]);
        assert_eq!(matched(&to, &from, 0.5), [[0, 0], [1, 1]], "too far apart");
        assert!(matched(&to, &[], 3.0).is_empty());
    }
}
