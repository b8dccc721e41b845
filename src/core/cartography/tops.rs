//! Rings of supplementary contours that show a top, a saddle or a hollow that the contours around do not show.
//!
//! A ring without another contour inside goes around a top or a hollow. It is the first one to show it, unless it is alone in the
//! ring around it: then that one shows it. Two rings in one show the saddle between them.

use std::collections::HashMap;

use glam::DVec2;
use rstar::{AABB, RTree, RTreeObject};

use super::nearest::Nearest;
use crate::base::parallel;
use crate::contour::ContourLine;
use crate::geometry::Bounds;
use crate::slice::signed_area;

/// Rings that are wider or higher than this many times the distance at which supplementary contours are needed are no single tops.
const LARGEST: f64 = 4.0;
/// Smaller rings do not show a top, as a share of that distance: 2 mm on the map where it is 15 mm.
const SMALLEST: f64 = 2.0 / 15.0;

/// What a ring shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ring {
    /// A top, hollow or saddle that no contour around it shows.
    New,
    /// One that a contour around shows already. `width` is that of the ring, metres.
    Known { width: f64 },
}

/// The upright box around a line, metres.
struct Framed {
    bounds: Bounds,
    line: u32,
}

impl RTreeObject for Framed {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.bounds.min.to_array(), self.bounds.max.to_array())
    }
}

/// For those of the lines `asked` that are rings around a single top or hollow: what they show. `around` are the other contours,
/// which are in `nearest` too.
pub(super) fn tops(
    lines: &[ContourLine],
    asked: &[u32],
    around: &[u32],
    nearest: &Nearest,
    (apart, metres): (f64, DVec2),
) -> HashMap<u32, Ring> {
    let framed = |&line: &u32| {
        let bounds = Bounds::around(&lines[line as usize].points);
        Framed { bounds: Bounds { min: bounds.min * metres, max: bounds.max * metres }, line }
    };
    let tree = RTree::bulk_load(parallel::map_each(around, framed));
    let found = parallel::map_each(asked, |number| {
        let line = &lines[*number as usize];
        let frame = framed(number);
        let size = (frame.bounds.max - frame.bounds.min).max_element();
        if !line.is_closed() || size > LARGEST * apart {
            return None;
        }
        let is_inside = |other: &Framed| is_within(lines[other.line as usize].points[0], &line.points);
        if tree.locate_in_envelope(&frame.envelope()).any(is_inside) {
            return None;
        }
        let [below, above] = nearest.beside(line.points[0] * metres, line.elevation);
        let outer = if line.depression { above } else { below };
        let holder = outer.map(|outer| outer.line).filter(|outer| {
            let points = &lines[*outer as usize];
            let Framed { bounds, .. } = framed(outer);
            points.is_closed()
                && (bounds.max - bounds.min).max_element() <= 2.0 * LARGEST * apart
                && is_within(line.points[0], &points.points)
        });
        Some((*number, holder, size, width(&line.points, metres)))
    });
    let mut rings_in: HashMap<(u32, u64), usize> = HashMap::new();
    let level = |number: u32| lines[number as usize].elevation.to_bits();
    for (number, holder, ..) in found.iter().flatten() {
        holder.iter().for_each(|holder| *rings_in.entry((*holder, level(*number))).or_default() += 1);
    }
    let shown = found.into_iter().flatten().map(|(number, holder, size, width)| {
        let is_alone = holder.is_some_and(|holder| rings_in.get(&(holder, level(number))) == Some(&1));
        let is_new = !is_alone && size >= SMALLEST * apart;
        (number, if is_new { Ring::New } else { Ring::Known { width } })
    });
    shown.collect()
}

/// How wide a ring is, metres: the diameter of a circle, the width of a long strip.
fn width(ring: &[DVec2], metres: DVec2) -> f64 {
    let area = signed_area(ring).abs() * metres.element_product();
    let length: f64 = ring.windows(2).map(|pair| ((pair[1] - pair[0]) * metres).length()).sum();
    let roundness = 4.0 * std::f64::consts::PI * area / (length * length);
    2.0 * area / length * (1.0 + roundness)
}

/// Whether a place lies inside a ring that repeats its first point.
fn is_within(place: DVec2, ring: &[DVec2]) -> bool {
    let crossed = ring.windows(2).filter(|pair| {
        let [a, b] = [pair[0], pair[1]];
        (a.y > place.y) != (b.y > place.y) && place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossed.count() % 2 == 1
}
