//! The nodes of the working grid, and where lines cross the edges between them.

use glam::DVec2;

use crate::base::Grid;

/// A crossing nearer to a node than this is at the node, as a share of the edge: a tolerance of rounding.
const AT_NODE: f64 = 1e-7;

/// A vertex nearer to an edge than this is on the edge, in steps between nodes: vertices that were cut from a raster are
/// rounded.
const AT_VERTEX: f64 = 1e-3;

/// A point on an edge between two neighbouring nodes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Crossing {
    /// The western or northern node of the edge.
    pub node: u32,
    /// Share of the edge from there, 0 to 1.
    pub along: f64,
    /// How well the line tells the height there.
    pub kind: CrossingKind,
}

/// How well a line tells the height at a crossing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CrossingKind {
    /// A vertex of the line lies on the edge.
    Vertex,
    /// The line is only a chord there, of the curve that it stands for.
    #[default]
    Chord,
}

/// Rows of nodes, from the north-west: the centres of a grid's cells, or every 2nd, 4th, ... row and column of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// Map position of the first node.
    pub first: DVec2,
    /// Distance between nodes in x and y, map units, both positive.
    pub step: DVec2,
    /// Number of columns.
    pub cols: usize,
    /// Number of rows.
    pub rows: usize,
}

impl Lattice {
    /// The centres of a grid's cells.
    pub fn of_grid(grid: &Grid) -> Self {
        Self { first: grid.center(0, 0), step: grid.cell, cols: grid.cols, rows: grid.rows }
    }

    /// Every second node. There is one more row or column where the extent needs it.
    pub fn coarser(&self) -> Self {
        Self { step: 2.0 * self.step, cols: self.cols / 2 + 1, rows: self.rows / 2 + 1, ..*self }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.cols * self.rows
    }

    /// Column and row of a map position, with fractions.
    pub fn place(&self, p: DVec2) -> DVec2 {
        let from = p - self.first;
        DVec2::new(from.x / self.step.x, -from.y / self.step.y)
    }

    /// The node at a map position, if there is one.
    pub fn node_at(&self, p: DVec2) -> Option<usize> {
        let place = self.place(p);
        let whole = place.round();
        let on_lattice = whole.cmpge(DVec2::ZERO).all() && whole.x < self.cols as f64 && whole.y < self.rows as f64;
        let near = (place - whole).abs().max_element() < AT_NODE;
        (on_lattice && near).then(|| whole.y as usize * self.cols + whole.x as usize)
    }

    /// Calls `east` for each edge to an eastern neighbour that the line crosses, and `south` for each edge to a
    /// southern one.
    ///
    /// A vertex exactly on a row or column of nodes counts as beyond it. So a line through this vertex crosses once.
    pub fn cross(&self, line: &[DVec2], mut east: impl FnMut(Crossing), mut south: impl FnMut(Crossing)) {
        let Some((&first, rest)) = line.split_first() else { return };
        let kind = |k: usize, a: f64, b: f64| {
            let is_vertex = (k as f64 - a).abs().min((k as f64 - b).abs()) < AT_VERTEX;
            if is_vertex { CrossingKind::Vertex } else { CrossingKind::Chord }
        };
        let mut a = self.place(first);
        for &p in rest {
            let b = self.place(p);
            for_each_whole(a.x, b.x, self.cols, |col, t| {
                if let Some((row, along)) = edge(a.y + t * (b.y - a.y), self.rows) {
                    south(Crossing { node: (row * self.cols + col) as u32, along, kind: kind(col, a.x, b.x) });
                }
            });
            for_each_whole(a.y, b.y, self.rows, |row, t| {
                if let Some((col, along)) = edge(a.x + t * (b.x - a.x), self.cols) {
                    east(Crossing { node: (row * self.cols + col) as u32, along, kind: kind(row, a.y, b.y) });
                }
            });
            a = b;
        }
    }
}

/// Calls `each` with the whole numbers between `a` and `b` that are below `count`, and with their share of the way from
/// `a` to `b`. The smaller of `a` and `b` is left out, the larger one is not.
fn for_each_whole(a: f64, b: f64, count: usize, mut each: impl FnMut(usize, f64)) {
    let first = (a.min(b).floor() + 1.0).max(0.0);
    let last = a.max(b).floor().min(count as f64 - 1.0);
    if first <= last {
        for k in first as usize..=last as usize {
            each(k, (k as f64 - a) / (b - a));
        }
    }
}

/// The edge on which a place in a row or column of `count` nodes lies: its first node and the share of the edge.
fn edge(place: f64, count: usize) -> Option<(usize, f64)> {
    let last = count as f64 - 1.0;
    if count < 2 || place < -AT_NODE || place > last + AT_NODE {
        return None;
    }
    let (mut node, mut along) = (place.floor(), place - place.floor());
    if !(AT_NODE..=1.0 - AT_NODE).contains(&along) {
        (node, along) = (place.round(), 0.0);
    }
    // The last node begins no edge. A place there is the end of the edge before.
    Some(if node < last { (node.max(0.0) as usize, along) } else { (count - 2, 1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    const NINE: Lattice = Lattice { first: DVec2::new(10.0, 20.0), step: DVec2::new(2.0, 1.0), cols: 3, rows: 3 };

    type Found = Vec<(u32, f64)>;

    fn crossings(line: &[(f64, f64)]) -> (Found, Found) {
        let line: Vec<DVec2> = line.iter().map(|&p| p.into()).collect();
        let (mut east, mut south) = (Vec::new(), Vec::new());
        NINE.cross(&line, |c| east.push((c.node, c.along)), |c| south.push((c.node, c.along)));
        (east, south)
    }

    #[test]
    fn a_slanting_line_crosses_rows_and_columns() {
        // From column -1, row 0.1 to column 3, row 1.7.
        let (east, south) = crossings(&[(8.0, 19.9), (16.0, 18.3)]);
        let near = |found: &[(u32, f64)], wanted: &[(u32, f64)]| {
            found.len() == wanted.len() && found.iter().zip(wanted).all(|(f, w)| f.0 == w.0 && (f.1 - w.1).abs() < 1e-9)
        };
        assert!(near(&east, &[(4, 0.25)]), "{east:?}");
        assert!(near(&south, &[(0, 0.5), (1, 0.9), (5, 0.3)]), "{south:?}");
    }

    #[test]
    fn a_vertex_on_a_column_is_crossed_once() {
        let (_, south) = crossings(&[(11.0, 19.5), (12.0, 19.5), (13.0, 19.5)]);
        assert_eq!(south, [(1, 0.5)]);
        let (_, touched) = crossings(&[(11.0, 19.5), (12.0, 19.5), (11.0, 19.4)]);
        assert!(touched.len() % 2 == 0, "there and back: {touched:?}");
    }

    #[test]
    fn vertices_on_edges_are_distinguished_from_chords() {
        let mut found = Vec::new();
        // Vertices on the column at x = 12 and off all others.
        let line = [(11.0, 19.5), (12.0, 19.7), (15.0, 19.6)].map(DVec2::from);
        NINE.cross(&line, |_| (), |c| found.push((c.node, c.kind == CrossingKind::Vertex)));
        assert_eq!(found, [(1, true), (2, false)]);
    }

    #[test]
    fn the_last_row_and_column_are_reached() {
        let (east, south) = crossings(&[(13.9, 18.0), (13.9, 17.0), (15.0, 18.5), (13.0, 18.5)]);
        assert!(east.iter().all(|c| c.0 % 3 < 2) && south.iter().all(|c| c.0 < 6));
        let (_, south) = crossings(&[(13.5, 18.0), (14.5, 18.0)]);
        assert_eq!(south, [(5, 1.0)]);
        assert_eq!(crossings(&[(0.0, 0.0), (1.0, 50.0)]), (vec![], vec![]));
    }
}
