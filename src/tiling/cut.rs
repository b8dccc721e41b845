//! Cuts lines at the border of a tile.

use glam::DVec2;

/// A tile: a point on its west or south side belongs to it, a point on its east or north side to its neighbour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile {
    pub lo: DVec2,
    pub hi: DVec2,
}

/// A part of a line inside a tile.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    pub points: Vec<DVec2>,
    /// Whether the first and the last point are where the line was cut.
    pub cut: [bool; 2],
}

impl Tile {
    /// The tile between least x, least y, greatest x and greatest y.
    pub fn new([west, south, east, north]: [f64; 4]) -> Self {
        Self { lo: DVec2::new(west, south), hi: DVec2::new(east, north) }
    }

    pub fn holds(&self, p: DVec2) -> bool {
        p.cmpge(self.lo).all() && p.cmplt(self.hi).all()
    }

    /// The shares of a segment between which it is inside, if it is at all.
    fn inside(&self, a: DVec2, b: DVec2) -> Option<[f64; 2]> {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let (start, way) = (a[axis], b[axis] - a[axis]);
            if way == 0.0 {
                if start < self.lo[axis] || start >= self.hi[axis] {
                    return None;
                }
                continue;
            }
            let ends = [(self.lo[axis] - start) / way, (self.hi[axis] - start) / way];
            from = from.max(ends[0].min(ends[1]));
            to = to.min(ends[0].max(ends[1]));
        }
        (from < to).then_some([from, to])
    }

    /// A point of a segment at its border, exactly on it.
    fn at(&self, a: DVec2, b: DVec2, share: f64) -> DVec2 {
        let mut p = a + (b - a) * share;
        for axis in 0..2 {
            for side in [self.lo[axis], self.hi[axis]] {
                let way = b[axis] - a[axis];
                if way != 0.0 && (side - a[axis]) / way == share {
                    p[axis] = side;
                }
            }
        }
        p
    }

    /// The parts of a line inside, in their order. A ring goes on through its first point.
    pub fn pieces(&self, line: &[DVec2]) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut open: Option<Piece> = None;
        let cut_off = |piece: Piece| Piece { cut: [piece.cut[0], true], ..piece };
        for (k, ends) in line.windows(2).enumerate() {
            let (a, b) = (ends[0], ends[1]);
            let Some([from, to]) = self.inside(a, b) else {
                pieces.extend(open.take().map(cut_off));
                continue;
            };
            let enters = from > 0.0;
            let mut piece = match open.take() {
                Some(piece) if !enters => piece,
                earlier => {
                    pieces.extend(earlier.map(cut_off));
                    // What does not begin with the line begins where it was cut.
                    Piece { points: vec![if enters { self.at(a, b, from) } else { a }], cut: [enters || k > 0, false] }
                }
            };
            let end = if to < 1.0 { self.at(a, b, to) } else { b };
            if piece.points.last() != Some(&end) {
                piece.points.push(end);
            }
            let is_last = k + 2 == line.len();
            if to < 1.0 || (!is_last && !self.holds(b)) { pieces.push(cut_off(piece)) } else { open = Some(piece) }
        }
        pieces.extend(open);
        if line.len() > 3 && line.first() == line.last() {
            close(&mut pieces);
        }
        pieces.retain(|piece| piece.points.len() > 1);
        pieces
    }
}

/// Joins the first and the last piece of a ring where they meet in its first point. If only one of them is there, it is cut there.
fn close(pieces: &mut Vec<Piece>) {
    let begins = pieces.first().is_some_and(|piece| !piece.cut[0]);
    let ends = pieces.last().is_some_and(|piece| !piece.cut[1]);
    match pieces.as_mut_slice() {
        [first, .., last] if begins && ends => {
            let head = std::mem::replace(first, Piece { points: Vec::new(), cut: [false; 2] });
            last.points.extend(&head.points[1..]);
            last.cut[1] = head.cut[1];
            pieces.remove(0);
        }
        [first, ..] if begins && !ends => first.cut[0] = true,
        [.., last] if ends && !begins => last.cut[1] = true,
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile() -> Tile {
        Tile::new([0.0, 0.0, 10.0, 10.0])
    }

    fn line(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&p| p.into()).collect()
    }

    #[test]
    fn a_line_is_cut_where_it_leaves_and_comes_back() {
        let pieces = tile().pieces(&line(&[(5.0, 5.0), (15.0, 5.0), (15.0, 6.0), (5.0, 6.0), (5.0, 7.0)]));
        let expected = [
            Piece { points: line(&[(5.0, 5.0), (10.0, 5.0)]), cut: [false, true] },
            Piece { points: line(&[(10.0, 6.0), (5.0, 6.0), (5.0, 7.0)]), cut: [true, false] },
        ];
        assert_eq!(pieces, expected);
    }

    #[test]
    fn the_pieces_of_a_ring_go_through_its_first_point() {
        let ring = line(&[(9.0, 5.0), (11.0, 5.0), (11.0, 7.0), (9.0, 7.0), (9.0, 5.0)]);
        let here = tile().pieces(&ring);
        let expected = line(&[(10.0, 7.0), (9.0, 7.0), (9.0, 5.0), (10.0, 5.0)]);
        assert_eq!(here, [Piece { points: expected, cut: [true; 2] }]);
        let east = Tile::new([10.0, 0.0, 20.0, 10.0]).pieces(&ring);
        let expected = line(&[(10.0, 5.0), (11.0, 5.0), (11.0, 7.0), (10.0, 7.0)]);
        assert_eq!(east, [Piece { points: expected, cut: [true; 2] }]);
        let whole = tile().pieces(&line(&[(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 1.0)]));
        assert_eq!((whole.len(), whole[0].cut, whole[0].points.len()), (1, [false; 2], 4));
    }

    #[test]
    fn each_part_of_a_line_is_in_one_tile() {
        let wave: Vec<DVec2> =
            (0..4000).map(|k| f64::from(k) * 0.005).map(|t| DVec2::new(t, 10.0 + 9.0 * (t * 3.0).sin())).collect();
        let tiles = [[0.0, 0.0], [10.0, 0.0], [0.0, 10.0], [10.0, 10.0]];
        let tiles = tiles.map(|[x, y]| Tile::new([x, y, x + 10.0, y + 10.0]));
        let length = |line: &[DVec2]| line.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
        let pieces: Vec<Piece> = tiles.iter().flat_map(|tile| tile.pieces(&wave)).collect();
        let sum: f64 = pieces.iter().map(|piece| length(&piece.points)).sum();
        assert!((sum - length(&wave)).abs() < 1e-9, "{sum}");
        let cuts = pieces.iter().flat_map(|piece| piece.cut).filter(|cut| *cut).count();
        assert_eq!(cuts, 2 * (pieces.len() - 1), "every cut has two ends");
    }

    #[test]
    fn a_vertex_on_a_seam_is_where_the_line_is_cut() {
        let straight = line(&[(5.0, 5.0), (10.0, 5.0), (12.0, 5.0)]);
        let east = Tile::new([10.0, 0.0, 20.0, 10.0]);
        assert_eq!(tile().pieces(&straight), [Piece { points: line(&[(5.0, 5.0), (10.0, 5.0)]), cut: [false, true] }]);
        assert_eq!(east.pieces(&straight), [Piece { points: line(&[(10.0, 5.0), (12.0, 5.0)]), cut: [true, false] }]);
        let back: Vec<DVec2> = straight.into_iter().rev().collect();
        assert_eq!(tile().pieces(&back), [Piece { points: line(&[(10.0, 5.0), (5.0, 5.0)]), cut: [true, false] }]);
        assert_eq!(east.pieces(&back), [Piece { points: line(&[(12.0, 5.0), (10.0, 5.0)]), cut: [false, true] }]);
        // A ring whose first point is on the seam.
        let ring = line(&[(10.0, 5.0), (12.0, 5.0), (12.0, 7.0), (8.0, 7.0), (10.0, 5.0)]);
        for tile in [tile(), east] {
            let pieces = tile.pieces(&ring);
            assert_eq!((pieces.len(), pieces[0].cut), (1, [true; 2]), "{pieces:?}");
        }
        // An open line that ends on the seam is not cut there.
        let ended = line(&[(5.0, 5.0), (10.0, 5.0)]);
        assert_eq!(tile().pieces(&ended), [Piece { points: ended.clone(), cut: [false; 2] }]);
        assert!(east.pieces(&ended).is_empty());
    }
}
