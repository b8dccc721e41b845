//! Adds vertices where a line touches or overlaps itself.
//!
//! A vertex that lies on another segment of its own line becomes a vertex of that segment too. It lies exactly on the
//! segment, so the line's course does not change. The line then visits the same vertex twice and can be split there.
//! Otherwise a piece of it would be lost. In this way a spike, however it was drawn, returns to one of its own
//! vertices.

use std::collections::HashSet;

use glam::DVec2;

use super::removed::Removed;
use super::segments::Segments;
use crate::base::FeatureId;
use crate::base::bits::bits;
use crate::base::error::{Finding, FindingKind, Result};
use crate::contour::Contour;
use crate::geometry::Segment;
use crate::geometry::compare_points;
use crate::geometry::{Meeting, meeting};

/// Lines with new vertices.
pub(super) struct Noded {
    /// Lines without new vertices.
    pub(super) unchanged: Vec<Contour>,
    /// Lines with new vertices. They visit vertices twice.
    pub(super) changed: Vec<Contour>,
    /// The new vertices.
    pub(super) new: Vec<Node>,
}

/// A new vertex, with its line's elevation and feature.
pub(super) struct Node {
    elevation: f64,
    feature: FeatureId,
    place: DVec2,
}

/// Inserts vertices where the pairs of segments, each of one line, meet.
pub(super) fn insert(lines: Vec<Contour>, pairs: &[(u32, u32)]) -> Result<Noded> {
    let segments = Segments::new(&lines)?;
    let mut new: Vec<(u32, DVec2)> = Vec::new();
    for &(i, j) in pairs {
        let (s, t) = (segments.get(i), segments.get(j));
        new.extend([t.a, t.b].into_iter().filter(|p| is_inside(*p, &s)).map(|p| (i, p)));
        new.extend([s.a, s.b].into_iter().filter(|p| is_inside(*p, &t)).map(|p| (j, p)));
    }
    // Along a straight line, points are in the order of their coordinates.
    new.sort_unstable_by(|a, b| a.0.cmp(&b.0).then_with(|| compare_points(&a.1, &b.1)));
    new.dedup();
    let node = |&(i, place): &(u32, DVec2)| {
        let line = segments.line_of(i);
        Node { elevation: line.elevation, feature: line.feature, place }
    };
    let nodes = new.iter().map(node).collect();

    let starts = segments.into_starts();
    let mut noded = Noded { unchanged: Vec::new(), changed: Vec::new(), new: nodes };
    let mut new = new.into_iter().peekable();
    for (mut line, bounds) in lines.into_iter().zip(starts.windows(2)) {
        if new.peek().is_none_or(|n| n.0 >= bounds[1]) {
            noded.unchanged.push(line);
            continue;
        }
        let mut points = Vec::with_capacity(line.points.len() + 1);
        for (i, w) in (bounds[0]..).zip(line.points.windows(2)) {
            points.push(w[0]);
            let from = points.len();
            while let Some((_, p)) = new.next_if(|n| n.0 == i) {
                points.push(p);
            }
            if compare_points(&w[0], &w[1]).is_gt() {
                points[from..].reverse();
            }
        }
        points.extend(line.points.last());
        line.points = points;
        noded.changed.push(line);
    }
    Ok(noded)
}

/// Whether a point lies exactly on a segment and is not one of its ends.
fn is_inside(p: DVec2, s: &Segment) -> bool {
    // A point in the segment's box and on its straight line lies on the segment.
    p != s.a
        && p != s.b
        && s.bounds().meets(&Segment { a: p, b: p }.bounds())
        && meeting(s, &Segment { a: s.a, b: p }) == Meeting::Overlap
}

/// Findings about lines that touch themselves. Places on spikes are left out, because spikes have findings of their
/// own.
pub(super) fn findings(nodes: &[Node], spikes: &[Removed]) -> Vec<Finding> {
    let on_spikes: HashSet<(u64, [u64; 2])> =
        spikes.iter().flat_map(|s| s.way.iter().map(move |p| (s.elevation.to_bits(), bits(*p)))).collect();
    let told = nodes.iter().filter(|n| !on_spikes.contains(&(n.elevation.to_bits(), bits(n.place))));
    let finding = |&Node { elevation, feature, place }: &Node| {
        let message = format!("the contour {elevation} m (feature {feature}) touches itself; it was split there");
        Finding::at(FindingKind::SelfCross, place, message).about(feature, elevation)
    };
    told.map(finding).collect()
}
