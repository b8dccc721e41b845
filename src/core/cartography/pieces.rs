//! Which pieces of a supplementary contour are drawn, given how far apart the contours beside it are at each vertex.

/// A piece goes on until the contours beside it are closer than this share of the distance at which it is needed. With 1, it would
/// break wherever their distance is about that.
const RELEASE: f64 = 0.8;
/// Shortest piece, as a share of that distance: 10 mm on the map where it is 15 mm.
const SHORTEST: f64 = 2.0 / 3.0;
/// Shortest gap in a line, likewise: 5 mm.
const SHORTEST_GAP: f64 = 1.0 / 3.0;
/// A ring is drawn as a whole if at least this share of its length is needed.
const WHOLE: f64 = 0.7;

/// What is drawn of a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Drawn {
    /// All of it.
    Whole,
    /// From one vertex to another, for each piece. In a ring, a piece may go on beyond its last vertex: then the second number
    /// is larger than the number of that vertex.
    Pieces(Vec<[usize; 2]>),
}

/// The pieces of a line that are drawn. `along` is the distance of each vertex from the first one, `spacing` how far the contours
/// beside it are apart there, 0 where it must not be drawn. It is needed from a spacing of `apart` on. A ring repeats its first
/// vertex.
pub(super) fn drawn(along: &[f64], spacing: &[f64], apart: f64, is_ring: bool) -> Drawn {
    let last = along.len() - 1;
    let is_close = |v: usize| spacing[v] < RELEASE * apart;
    let Some(start) = (0..last + usize::from(!is_ring)).find(|v| !is_ring || is_close(*v)) else {
        let is_needed = spacing.iter().any(|s| *s >= apart);
        return if is_needed { Drawn::Whole } else { Drawn::Pieces(Vec::new()) };
    };
    let length = along[last];
    // Counted from the start, once around a ring.
    let vertex = |k: usize| if is_ring { (start + k) % last } else { k };
    let at = |k: usize| {
        let turns = if is_ring { (start + k) / last } else { 0 };
        along[vertex(k)] + turns as f64 * length
    };
    let is_free = |a: usize, b: usize| (a..=b).all(|k| spacing[vertex(k)] > 0.0);
    let mut pieces: Vec<[usize; 2]> = Vec::new();
    let mut from = None;
    for k in 0..=last {
        match (from, is_close(vertex(k))) {
            (None, false) => from = Some(k),
            (Some(first), true) => {
                pieces.push([first, k - 1]);
                from = None;
            }
            _ => {}
        }
    }
    pieces.extend(from.map(|first| [first, last]));
    pieces.retain(|[a, b]| (*a..=*b).any(|k| spacing[vertex(k)] >= apart));
    pieces.dedup_by(|next, piece| {
        let is_short = at(next[0]) - at(piece[1]) < SHORTEST_GAP * apart && is_free(piece[1], next[0]);
        piece[1] = if is_short { next[1] } else { piece[1] };
        is_short
    });
    if is_ring {
        return around(pieces, at, is_free, [start, last], apart);
    }
    if let Some(first) = pieces.first_mut().filter(|first| at(first[0]) < SHORTEST_GAP * apart && is_free(0, first[0]))
    {
        first[0] = 0;
    }
    if let Some(end) =
        pieces.last_mut().filter(|end| length - at(end[1]) < SHORTEST_GAP * apart && is_free(end[1], last))
    {
        end[1] = last;
    }
    pieces.retain(|[a, b]| at(*b) - at(*a) >= SHORTEST * apart);
    match pieces[..] {
        [[0, end]] if end == last => Drawn::Whole,
        _ => Drawn::Pieces(pieces),
    }
}

/// The pieces of a ring, counted from the vertex `start`: those at its two ends may be one.
fn around(
    mut pieces: Vec<[usize; 2]>,
    at: impl Fn(usize) -> f64,
    is_free: impl Fn(usize, usize) -> bool,
    [start, count]: [usize; 2],
    apart: f64,
) -> Drawn {
    let length = at(count) - at(0);
    if let (Some(first), Some(end)) = (pieces.first().copied(), pieces.last().copied()) {
        let gap = at(first[0]) + length - at(end[1]);
        if pieces.len() > 1 && gap < SHORTEST_GAP * apart && is_free(end[1], first[0] + count) {
            pieces.remove(0);
            let joined = pieces.len() - 1;
            pieces[joined][1] = first[1] + count;
        }
    }
    let of = |[a, b]: &[usize; 2]| at(*b) - at(*a);
    pieces.retain(|piece| of(piece) >= SHORTEST * apart);
    if pieces.iter().map(of).sum::<f64>() >= WHOLE * length && is_free(0, count) {
        return Drawn::Whole;
    }
    Drawn::Pieces(pieces.into_iter().map(|piece| piece.map(|k| start + k)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pieces of a line with a vertex every 10 m, needed from 90 m on: pieces of 60 m, gaps of 30 m.
    fn of(spacing: &[f64], is_ring: bool) -> Drawn {
        let along: Vec<f64> = (0..spacing.len()).map(|k| k as f64 * 10.0).collect();
        drawn(&along, spacing, 90.0, is_ring)
    }

    fn line(runs: &[(usize, f64)]) -> Vec<f64> {
        runs.iter().flat_map(|(count, spacing)| std::iter::repeat_n(*spacing, *count)).collect()
    }

    #[test]
    fn a_line_is_drawn_where_it_is_needed() {
        assert_eq!(of(&line(&[(20, 100.0)]), false), Drawn::Whole);
        assert_eq!(of(&line(&[(20, 80.0)]), false), Drawn::Pieces(vec![]), "it goes on at 80 m, and does not begin");
        assert_eq!(of(&line(&[(10, 50.0), (10, 100.0), (10, 50.0)]), false), Drawn::Pieces(vec![[10, 19]]));
        assert_eq!(of(&line(&[(10, 50.0), (3, 80.0), (10, 100.0), (10, 50.0)]), false), Drawn::Pieces(vec![[10, 22]]));
    }

    #[test]
    fn no_piece_is_shorter_than_60_m_and_no_gap_than_30_m() {
        assert_eq!(of(&line(&[(10, 50.0), (6, 100.0), (10, 50.0)]), false), Drawn::Pieces(vec![]));
        assert_eq!(of(&line(&[(10, 50.0), (7, 100.0), (10, 50.0)]), false), Drawn::Pieces(vec![[10, 16]]));
        let two = |gap: usize| of(&line(&[(10, 50.0), (10, 100.0), (gap, 50.0), (10, 100.0), (10, 50.0)]), false);
        assert_eq!(two(1), Drawn::Pieces(vec![[10, 30]]));
        assert_eq!(two(2), Drawn::Pieces(vec![[10, 19], [22, 31]]));
        assert_eq!(of(&line(&[(2, 50.0), (10, 100.0), (10, 50.0)]), false), Drawn::Pieces(vec![[0, 11]]), "its end");
        assert_eq!(of(&line(&[(2, 50.0), (10, 100.0), (2, 50.0)]), false), Drawn::Whole);
        let cut = [(10, 50.0), (10, 100.0), (1, 0.0), (10, 100.0), (10, 50.0)];
        assert_eq!(of(&line(&cut), false), Drawn::Pieces(vec![[10, 19], [21, 30]]), "it must not be drawn there");
    }

    #[test]
    fn rings_close_where_they_nearly_close() {
        let ring = |runs: &[(usize, f64)]| {
            let mut spacing = line(runs);
            spacing.push(spacing[0]);
            of(&spacing, true)
        };
        assert_eq!(ring(&[(40, 100.0)]), Drawn::Whole);
        assert_eq!(ring(&[(40, 85.0)]), Drawn::Pieces(vec![]));
        assert_eq!(ring(&[(15, 100.0), (10, 50.0), (15, 100.0)]), Drawn::Whole, "a quarter is not needed");
        assert_eq!(
            ring(&[(10, 100.0), (20, 50.0), (10, 100.0)]),
            Drawn::Pieces(vec![[30, 49]]),
            "across its first vertex"
        );
        assert_eq!(ring(&[(1, 50.0), (10, 100.0), (19, 50.0), (10, 100.0)]), Drawn::Pieces(vec![[30, 50]]));
        assert_eq!(ring(&[(20, 50.0), (10, 100.0), (10, 50.0)]), Drawn::Pieces(vec![[20, 29]]));
    }
}
