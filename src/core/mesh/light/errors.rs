//! How far triangles are from the heights of cells.

use glam::DVec2;

use super::network::{Network, Worst};
use crate::raster::Dem;

/// Rows of a triangle reach this far beyond its edges, in cells. So each centre on an edge is seen from both sides.
const MARGIN: f64 = 1e-9;

/// The largest error of triangle `t` above the tolerance. The triangle looks through its cells, row by row.
pub(super) fn worst(network: &Network, t: u32, dem: &Dem, tolerance: f64) -> Worst {
    let corners = network.corners[t as usize].map(|v| network.places[v as usize]);
    let ([a, b, c], heights) = (corners.map(|corner| corner.truncate()), corners.map(|corner| corner.z));
    let (cols, rows) = (dem.grid.cols, dem.grid.rows);
    let (lo, hi) = (a.min(b).min(c) - MARGIN, a.max(b).max(c) + MARGIN);
    let (first, last) = ((-hi.y).ceil().max(0.0), (-lo.y).floor().min(rows as f64 - 1.0));
    let (rise_b, rise_c) = (heights[1] - heights[0], heights[2] - heights[0]);
    let slope = DVec2::new(rise_b * (c.y - a.y) - rise_c * (b.y - a.y), rise_c * (b.x - a.x) - rise_b * (c.x - a.x))
        / (b - a).perp_dot(c - a);
    let lowest = heights[0].min(heights[1]).min(heights[2]);
    let highest = heights[0].max(heights[1]).max(heights[2]);
    // The ground lies on the left of each edge.
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| (from, to.y - from.y, (to.x - from.x) / (to.y - from.y)));
    let (mut largest, mut cell) = (tolerance, None);
    let mut row = first;
    while row <= last {
        let (mut left, mut right) = (lo.x, hi.x);
        for (from, rise, lean) in &edges {
            let x = from.x - (row + from.y) * lean;
            if *rise > 0.0 {
                right = right.min(x + MARGIN);
            } else if *rise < 0.0 {
                left = left.max(x - MARGIN);
            }
        }
        let (left, right) = (left.ceil().max(0.0), right.floor().min(cols as f64 - 1.0));
        if left <= right {
            let start = row as usize * cols + left as usize;
            let cells = &dem.values[start..=start + (right - left) as usize];
            let from = heights[0] + slope.x * (left - a.x) - slope.y * (row + a.y);
            for (k, height) in cells.iter().enumerate() {
                // In slivers, the slope is hardly determined.
                let own = (from + slope.x * k as f64).clamp(lowest, highest);
                let error = (own - f64::from(*height)).abs();
                if error > largest {
                    (largest, cell) = (error, Some((start + k) as u32));
                }
            }
        }
        row += 1.0;
    }
    cell.map_or_else(Worst::default, |cell| Worst { error: (largest as f32).max(f32::MIN_POSITIVE), cell })
}
