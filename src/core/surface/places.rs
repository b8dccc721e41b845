//! Places of a grid on the surface: conversions between coordinates, and the triangle at a position.

use glam::DVec2;

use super::built::Surface;
use crate::tin::{NONE, Tin};

/// A grid in some coordinates, and the conversion between them and those of the surface.
#[derive(Clone, Copy)]
pub struct InOther<'a> {
    /// From the coordinates of the grid to those of the surface.
    pub to_surface: &'a (dyn Fn(DVec2) -> Option<DVec2> + Sync),
    /// And back.
    pub from_surface: &'a (dyn Fn(DVec2) -> Option<DVec2> + Sync),
}

/// The triangle at a position, if there are heights. The search starts at the triangle `near`, which becomes the last one
/// that it came to.
pub(crate) fn triangle_at(surface: &Surface, near: &mut u32, p: DVec2) -> Option<u32> {
    let tin = &surface.tin;
    let found = tin.walk(*near, p - tin.origin);
    *near = found.unwrap_or_else(|left| left);
    found.ok().and_then(|t| with_height(tin, t, p - tin.origin))
}

/// Triangle `t` if it is inside the frame and has heights. Otherwise a neighbour that is, if the place lies on their
/// common edge.
fn with_height(tin: &Tin, t: u32, place: DVec2) -> Option<u32> {
    let good = |t: u32| tin.is_inside(t) && tin.corner_heights(t).iter().all(|h| !h.is_nan());
    if good(t) {
        return Some(t);
    }
    let mut around = tin.neighbours[t as usize].into_iter();
    around.find(|&n| n != NONE && good(n) && tin.holds(n, place))
}
