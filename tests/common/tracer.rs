//! Cuts contour lines from a grid of heights by marching squares.
//!
//! A height belongs to the upper side when it is equal to or above the level; heights that equal a level are not moved.
//! Lines therefore run exactly through such nodes and may touch or retrace themselves and each other there, as lines of
//! one level. Lines of different levels never touch: crossing points on an edge are in the order of their levels, and
//! within a cell the straight pieces connect them without interleaving.

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;

/// An edge of the grid: the node at its west or north end, and whether it runs east (false) or south (true).
type Edge = (usize, bool);

/// The contour lines of heights at the nodes of a grid, as [`traces_of`] gives them. Repeated points are dropped, and so are
/// lines of which only one point is left; closed lines that fold onto themselves are kept as they are.
pub fn contours_of(
    heights: &[f64],
    cols: usize,
    rows: usize,
    cell: f64,
    interval: f64,
    origin: DVec2,
) -> Vec<(f64, Vec<DVec2>)> {
    let mut lines = traces_of(heights, cols, rows, cell, interval, origin);
    lines.iter_mut().for_each(|(_, line)| line.dedup());
    lines.retain(|(_, line)| line.len() >= 2);
    lines
}

/// The contour lines of heights at the nodes of a grid, at all multiples of `interval`, by level. There is a point on each
/// edge that a line crosses. Around a node at the level they are all at the node.
///
/// `heights` go row by row from the north-west, `origin` is the position of the first node, x grows with the column and y
/// falls with the row by `cell`. Lines are open where they meet the border or a cell with a height that is NaN, else
/// closed with the first point repeated; higher ground lies on the right.
pub fn traces_of(
    heights: &[f64],
    cols: usize,
    rows: usize,
    cell: f64,
    interval: f64,
    origin: DVec2,
) -> Vec<(f64, Vec<DVec2>)> {
    assert_eq!(heights.len(), cols * rows, "one height a node");
    let mut pieces: BTreeMap<i64, Vec<(Edge, Edge)>> = BTreeMap::new();
    for row in 0..rows.saturating_sub(1) {
        for col in 0..cols.saturating_sub(1) {
            let n = row * cols + col;
            let corners = [heights[n], heights[n + 1], heights[n + cols + 1], heights[n + cols]];
            if corners.iter().any(|z| !z.is_finite()) {
                continue;
            }
            let low = corners.iter().copied().fold(f64::INFINITY, f64::min);
            let high = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            for k in (low / interval).floor() as i64..=(high / interval).ceil() as i64 {
                for piece in pieces_of(corners, k as f64 * interval, n, cols) {
                    pieces.entry(k).or_default().push(piece);
                }
            }
        }
    }
    let node = |n: usize| DVec2::new(origin.x + (n % cols) as f64 * cell, origin.y - (n / cols) as f64 * cell);
    let mut lines = Vec::new();
    for (k, pieces) in pieces {
        let level = k as f64 * interval;
        let point = |(n, south): Edge| {
            let m = if south { n + cols } else { n + 1 };
            let (a, b, t) = (node(n), node(m), (level - heights[n]) / (heights[m] - heights[n]));
            // The ends are returned as they are, so that a node at the level is hit exactly.
            if t <= 0.0 {
                a
            } else if t >= 1.0 {
                b
            } else {
                DVec2::new(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y))
            }
        };
        for chain in chains_of(&pieces) {
            lines.push((level, chain.into_iter().map(point).collect()));
        }
    }
    lines
}

/// The pieces of the level's lines in one cell, each from edge to edge with the upper side on its right.
fn pieces_of(corners: [f64; 4], level: f64, n: usize, cols: usize) -> Vec<(Edge, Edge)> {
    // Edges and corners clockwise from the north-west: edge i runs from corner i to corner i + 1.
    let edges: [Edge; 4] = [(n, false), (n + 1, true), (n + cols, false), (n, true)];
    let up = corners.map(|z| z >= level);
    // Going round clockwise, a piece leaves the border where the corners fall below the level and comes back where they
    // rise to it: that keeps the upper corners on its right.
    let rises = |i: usize| !up[i] && up[(i + 1) % 4];
    let falls = (0..4).filter(|&i| up[i] && !up[(i + 1) % 4]);
    let saddle = up[0] == up[2] && up[1] == up[3] && up[0] != up[1];
    // In a saddle the mean of the corners says whether the upper corners are connected (each piece cuts off a lower
    // corner, to the next edge) or the lower ones (each piece cuts off an upper corner, to the edge before).
    let connected = corners.iter().sum::<f64>() / 4.0 >= level;
    let steps: &[usize] = match (saddle, connected) {
        (false, _) => &[1, 2, 3],
        (true, true) => &[1],
        (true, false) => &[3],
    };
    falls.filter_map(|f| steps.iter().map(|d| (f + d) % 4).find(|&i| rises(i)).map(|r| (edges[f], edges[r]))).collect()
}

/// Joins pieces end to end: first the open chains, then the closed ones, whose first edge is repeated.
fn chains_of(pieces: &[(Edge, Edge)]) -> Vec<Vec<Edge>> {
    let next: HashMap<Edge, usize> = pieces.iter().enumerate().map(|(i, p)| (p.0, i)).collect();
    let ends: std::collections::HashSet<Edge> = pieces.iter().map(|p| p.1).collect();
    let mut used = vec![false; pieces.len()];
    let mut chains = Vec::new();
    let open = (0..pieces.len()).filter(|&i| !ends.contains(&pieces[i].0));
    for start in open.chain(0..pieces.len()) {
        if used[start] {
            continue;
        }
        let mut chain = vec![pieces[start].0];
        let mut at = Some(start);
        while let Some(i) = at.filter(|&i| !used[i]) {
            used[i] = true;
            chain.push(pieces[i].1);
            at = next.get(&pieces[i].1).copied();
        }
        chains.push(chain);
    }
    chains
}
