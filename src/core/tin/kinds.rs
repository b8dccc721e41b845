//! Terminal, sleeve and junction triangles (paper, section 3.3, figure 2d).

use super::network::Tin;
use crate::base::parallel;

/// A triangle by the number of its edges that lie neither on a contour nor on the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TriangleKind {
    /// Outside the frame.
    Outside,
    /// No free edge: the triangle is a whole sub-domain.
    Isolated,
    /// One free edge: a tip, where a contour turns back.
    Terminal,
    /// Two free edges: a piece of the strip between two lines.
    Sleeve,
    /// Three free edges: three strips meet.
    Junction,
}

/// The kind of every triangle.
///
/// Frame edges count as border. Otherwise a line would run towards the map's edge only because the contours stop there.
pub fn triangle_kinds(tin: &Tin) -> Vec<TriangleKind> {
    parallel::map(tin.len(), |t| {
        let t = t as u32;
        if !tin.is_inside(t) {
            return TriangleKind::Outside;
        }
        match (0..3).filter(|&i| tin.across(t, i).is_some()).count() {
            0 => TriangleKind::Isolated,
            1 => TriangleKind::Terminal,
            2 => TriangleKind::Sleeve,
            _ => TriangleKind::Junction,
        }
    })
}
