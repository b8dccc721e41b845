//! Leaves out vertices that a line does not need at a zoom, without touching another line.
//!
//! Between a vertex, the one before it and the one after it lies a triangle. If no vertex of any line is in it, no line crosses
//! it: a line that enters it, and touches none of its two sides that are a line, would have to turn inside. So the third side
//! can replace the other two. (The condition is that of Visvalingam and Whelan for areas, 2016, applied to all lines together.)
//! In the first pass, only vertices close to the third side go, in the last one all within the tolerance. So flat bends are
//! straightened before sharp ones lose their tips.

use glam::DVec2;
use robust::{Coord, orient2d};

use super::cells::Cells;
use super::network::{Line, Links, Network};
use crate::geometry::{Bounds, Segment, point_distance};

/// Shares of the tolerance, one for each pass.
const PASSES: [f64; 3] = [0.25, 0.5, 1.0];
/// Most vertices of the line that one segment replaces. It limits the work.
const MOST: usize = 256;
/// Vertices per cell of the search, about.
const PER_CELL: f64 = 2.0;

/// Leaves out vertices that are within the tolerance of the line that remains. No segment gets longer than `longest`.
pub(super) fn thin(network: &mut Network, tolerance: f64, longest: f64) {
    let Thinning { places, is_kept, .. } =
        left(&network.lines, std::mem::take(&mut network.places), tolerance, longest);
    let mut kept = Vec::new();
    for line in &mut network.lines {
        let first = kept.len() as u32;
        kept.extend(line.vertices().filter(|v| is_kept[*v as usize]).map(|v| places[v as usize]));
        (line.first, line.count) = (first, kept.len() as u32 - first);
    }
    network.places = kept;
}

/// The same for lines that are no tiles': for each, which of its vertices stay. A ring repeats its first one.
pub(crate) fn kept_vertices<'a>(lines: impl Iterator<Item = (&'a [DVec2], bool)>, tolerance: f64) -> Vec<Vec<bool>> {
    let (mut all, mut places) = (Vec::new(), Vec::new());
    for (points, is_ring) in lines {
        let (first, count) = (places.len() as u32, (points.len() - usize::from(is_ring)) as u32);
        places.extend_from_slice(&points[..count as usize]);
        all.push(Line { level: 0, first, count, is_ring });
    }
    let Thinning { is_kept, .. } = left(&all, places, tolerance, f64::INFINITY);
    let of = |line: &Line| {
        let own = line.vertices().map(|v| is_kept[v as usize]);
        own.chain(line.is_ring.then_some(true)).collect()
    };
    all.iter().map(of).collect()
}

/// Which vertices are left.
fn left(lines: &[Line], places: Vec<DVec2>, tolerance: f64, longest: f64) -> Thinning {
    let mut left = Thinning { cells: search(&places), is_kept: vec![true; places.len()], places };
    let mut links = Links::new(lines, left.places.len());
    for share in PASSES {
        for line in lines {
            let mut count = line.vertices().filter(|v| left.is_kept[*v as usize]).count();
            for v in line.vertices().filter(|v| *v != line.first) {
                let is_needed = line.is_ring && count <= 3;
                if left.is_kept[v as usize] && !is_needed && left.can_go(v, line, &links, share * tolerance, longest) {
                    left.is_kept[v as usize] = false;
                    links.leave_out(v);
                    count -= 1;
                }
            }
        }
    }
    left
}

fn search(places: &[DVec2]) -> Cells {
    let span = Bounds::around(places);
    let area = (span.max - span.min).element_product();
    let size = (PER_CELL * area / places.len().max(1) as f64).sqrt();
    Cells::new(places.len(), size, |i| Some(Bounds { min: places[i], max: places[i] }))
}

struct Thinning {
    places: Vec<DVec2>,
    is_kept: Vec<bool>,
    cells: Cells,
}

impl Thinning {
    fn at(&self, v: u32) -> DVec2 {
        self.places[v as usize]
    }

    fn can_go(&self, v: u32, line: &Line, links: &Links, tolerance: f64, longest: f64) -> bool {
        let Some((before, after)) = links.around(v) else { return false };
        let piece = Segment { a: self.at(before), b: self.at(after) };
        if before == after || piece.a.distance(piece.b) > longest {
            return false;
        }
        // All vertices that were ever between them.
        let between = (0..line.count).map(|k| line.first + (before - line.first + 1 + k) % line.count);
        let mut replaced = between.take_while(|k| *k != after).enumerate();
        if replaced.any(|(k, vertex)| k >= MOST || point_distance(self.at(vertex), &piece) > tolerance) {
            return false;
        }
        let corners = [piece.a, self.at(v), piece.b];
        !self.cells.any(Bounds::around(&corners), |other| {
            let p = self.at(other);
            self.is_kept[other as usize]
                && ![before, v, after].contains(&other)
                && p != piece.a
                && p != piece.b
                && is_in_triangle(p, corners)
        })
    }
}

/// Whether a point lies in a triangle or on its border, exactly. A triangle without area is the line that it covers.
pub(super) fn is_in_triangle(p: DVec2, corners: [DVec2; 3]) -> bool {
    let bounds = Bounds::around(&corners);
    if !bounds.meets(&Bounds { min: p, max: p }) {
        return false;
    }
    let [a, b, c] = corners;
    let sides = [side(a, b, p), side(b, c, p), side(c, a, p)];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

/// On which side of the line from `a` to `b` a point lies. The sign is exact.
pub(super) fn side(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(p))
}
