//! Ends of open lines, and the other ends at the same position.

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::base::parallel;
use crate::contour::{Contour, ContourMap};

/// An end of a line: twice the line's number, plus one for the line's last point.
pub(super) type End = usize;

/// What lies at the position of an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum At {
    /// No other end; or the other end of the same line; or the line is closed.
    Nothing,
    /// The end of one other line.
    One(End),
    /// Several ends of other lines.
    Several,
}

/// What lies at each end; there are two entries per line.
pub(super) fn find(map: &ContourMap, snap: f64) -> Vec<At> {
    let lines = &map.contours;
    let is_open = |line: &&Contour| line.points.len() >= 2 && line.points.first() != line.points.last();
    let open: Vec<End> = (0..lines.len())
        .filter(|&i| Some(&lines[i]).filter(is_open).is_some())
        .flat_map(|i| [2 * i, 2 * i + 1])
        .filter(|&end| place(lines, end).is_finite())
        .collect();
    let tree = RTree::bulk_load(open.iter().map(|&e| GeomWithData::new(place(lines, e).to_array(), e)).collect());
    let reach = if snap.is_finite() { snap.max(0.0).powi(2) } else { 0.0 };
    let found: Vec<At> = parallel::map_each(&open, |&end| {
        let near = tree.locate_within_distance(place(lines, end).to_array(), reach);
        let mut others = near.map(|other| other.data).filter(|&other| other != end).take(2);
        match (others.next(), others.next()) {
            (Some(other), None) if other != end ^ 1 => At::One(other),
            (None, _) | (Some(_), None) => At::Nothing,
            (Some(_), Some(_)) => At::Several,
        }
    });
    let mut at = vec![At::Nothing; 2 * lines.len()];
    for (end, found) in open.into_iter().zip(found) {
        at[end] = found;
    }
    at
}

/// The position of an end.
pub(super) fn place(lines: &[Contour], end: End) -> DVec2 {
    let points = &lines[end / 2].points;
    points[if end.is_multiple_of(2) { 0 } else { points.len() - 1 }]
}
