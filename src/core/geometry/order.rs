//! The order of points. Because of it, results do not depend on how the input was written.

use std::cmp::Ordering;

use glam::DVec2;

/// By x, then by y.
pub fn compare_points(a: &DVec2, b: &DVec2) -> Ordering {
    a.x.total_cmp(&b.x).then_with(|| a.y.total_cmp(&b.y))
}
