//! Triangulates many points in blocks, side by side, with the same triangles as all at once.
//!
//! Blocks are rectangles that cover the plane. Each is triangulated with its own points and with all edges that may touch it.
//! A triangle is certain if its circumcircle lies inside the rectangle: no point and no edge of another block can change it.
//! Certain triangles of two blocks never overlap. What they leave open, mostly strips along the borders of blocks, is
//! triangulated last, bounded by their edges. A block fits into the processor's caches, so this is faster on one core too.

use glam::DVec2;

use super::faces::{Face, faces_between};
use super::network::{CONSTRAINT, NONE};
use crate::base::error::Result;
use crate::base::parallel;
use crate::base::rows::Rows;

/// Most points of a block.
pub(super) const BLOCK: usize = 1 << 15;

/// A circumcircle keeps clear of the border of its block by this share of its radius. The centre of a triangle that is not
/// [`SLENDER`] is known far better.
const MARGIN: f64 = 1e-5;

/// Triangles whose doubled area is less than this share of the square of their longest edge are never certain.
const SLENDER: f64 = 1e-9;

/// The triangulation of `positions` with `edges`, in blocks of at most `most` points. `None` if the parts do not fit together,
/// which rounding might cause.
pub(super) fn in_blocks(positions: &[DVec2], edges: &[[u32; 2]], most: usize) -> Result<Option<Vec<Face>>> {
    let points = (0..positions.len() as u32).collect();
    let plane = Block { points, low: DVec2::NEG_INFINITY, high: DVec2::INFINITY };
    let blocks = parted(plane, positions, most);
    let mut block_of = vec![0_u32; positions.len()];
    for (b, block) in blocks.iter().enumerate() {
        block.points.iter().for_each(|&v| block_of[v as usize] = b as u32);
    }
    let edges_of = Rows::new(blocks.len(), || {
        edges.iter().enumerate().flat_map(|(e, &[u, v])| {
            let [p, q] = [u, v].map(|v| positions[v as usize]);
            let one = (block_of[u as usize] == block_of[v as usize]).then_some(block_of[u as usize] as usize);
            let several =
                one.is_none().then(|| blocks.iter().enumerate().filter(move |(_, b)| b.meets(p.min(q), p.max(q))));
            let several = several.into_iter().flatten().map(|(b, _)| b);
            one.into_iter().chain(several).map(move |b| (b, e as u32))
        })
    });
    let each = parallel::map(blocks.len(), |b| {
        let edges = edges_of.of(b).iter().map(|&e| edges[e as usize]);
        blocks[b].certain(edges, positions)
    });
    let mut faces: Vec<Face> = Vec::with_capacity(2 * positions.len());
    for certain in each {
        let certain = certain?;
        let first = faces.len() as u32;
        let numbered = |n: u32| if n == NONE { NONE } else { first + n };
        faces.extend(certain.into_iter().map(|face| Face { beyond: face.beyond.map(numbered), ..face }));
    }
    close(faces, positions, edges)
}

/// Points in a rectangle, which may reach to infinity.
struct Block {
    /// Ascending.
    points: Vec<u32>,
    low: DVec2,
    high: DVec2,
}

/// Halves a block until none has more than `most` points.
fn parted(block: Block, positions: &[DVec2], most: usize) -> Vec<Block> {
    let Block { points, low, high } = &block;
    if points.len() <= most {
        return vec![block];
    }
    let place = |v: &u32| positions[*v as usize];
    let extent = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (least, greatest) = points.iter().map(place).fold(extent, |(lo, hi), p| (lo.min(p), hi.max(p)));
    let size = greatest - least;
    let axis = usize::from(size.y > size.x);
    let mut along: Vec<f64> = points.iter().map(|v| place(v)[axis]).collect();
    let half = along.len() / 2;
    let cut = *along.select_nth_unstable_by(half, f64::total_cmp).1;
    // Points at the cut itself lie in the upper half.
    let (below, above): (Vec<u32>, Vec<u32>) = points.iter().partition(|v| place(v)[axis] < cut);
    if below.is_empty() {
        return vec![block];
    }
    let (mut below_high, mut above_low) = (*high, *low);
    (below_high[axis], above_low[axis]) = (cut, cut);
    let lower = Block { points: below, low: *low, high: below_high };
    let upper = Block { points: above, low: above_low, high: *high };
    let (mut lower, upper) = rayon::join(|| parted(lower, positions, most), || parted(upper, positions, most));
    lower.extend(upper);
    lower
}

impl Block {
    fn meets(&self, least: DVec2, greatest: DVec2) -> bool {
        least.cmple(self.high).all() && greatest.cmpge(self.low).all()
    }

    /// The certain triangles. `edges` are all that may touch the block.
    fn certain(&self, edges: impl Iterator<Item = [u32; 2]> + Clone, positions: &[DVec2]) -> Result<Vec<Face>> {
        let mut vertices: Vec<u32> = self.points.iter().copied().chain(edges.clone().flatten()).collect();
        vertices.sort_unstable();
        vertices.dedup();
        if vertices.len() < 3 {
            return Ok(Vec::new());
        }
        let local = |v: u32| vertices.partition_point(|&w| w < v) as u32;
        let edges: Vec<[u32; 2]> = edges.map(|edge| edge.map(local)).collect();
        let places: Vec<DVec2> = vertices.iter().map(|&v| positions[v as usize]).collect();
        let faces = faces_between(&places, &edges)?;
        let mut number = vec![NONE; faces.len()];
        let mut count = 0;
        for (f, face) in faces.iter().enumerate() {
            if self.holds_circle(face.corners.map(|v| positions[vertices[v as usize] as usize])) {
                number[f] = count;
                count += 1;
            }
        }
        let numbered = |n: u32| if n == NONE { NONE } else { number[n as usize] };
        let kept = faces.into_iter().enumerate().filter(|(f, _)| number[*f] != NONE);
        Ok(kept
            .map(|(_, face)| Face {
                corners: face.corners.map(|v| vertices[v as usize]),
                beyond: face.beyond.map(numbered),
                ..face
            })
            .collect())
    }

    /// Whether the circumcircle of a triangle lies inside, with some margin.
    fn holds_circle(&self, [a, b, c]: [DVec2; 3]) -> bool {
        let (ab, ac) = (b - a, c - a);
        let doubled = ab.perp_dot(ac);
        let longest = ab.length_squared().max(ac.length_squared()).max(b.distance_squared(c));
        if doubled <= SLENDER * longest {
            return false;
        }
        let centre = (ac.perp() * -ab.length_squared() + ab.perp() * ac.length_squared()) / (2.0 * doubled);
        let reach = centre.length() * (1.0 + MARGIN);
        let centre = a + centre;
        (centre - reach).cmpgt(self.low).all() && (centre + reach).cmplt(self.high).all()
    }
}

/// An edge of a certain triangle without a neighbour: its second end, its triangle, its number there, and its flag.
#[derive(Debug, Clone, Copy, Default)]
struct Open {
    to: u32,
    face: u32,
    edge: u8,
    is_constraint: bool,
}

/// Adds the triangles that `faces` leave open.
fn close(mut faces: Vec<Face>, positions: &[DVec2], edges: &[[u32; 2]]) -> Result<Option<Vec<Face>>> {
    // Points of the open ground: those on its outline, and those of no certain triangle.
    let mut is_open = vec![true; positions.len()];
    faces.iter().flat_map(|face| face.corners).for_each(|v| is_open[v as usize] = false);
    for face in faces.iter() {
        for i in (0..3).filter(|&i| face.beyond[i] == NONE) {
            face.edge(i).into_iter().for_each(|v| is_open[v as usize] = true);
        }
    }
    let vertices: Vec<u32> = (0..positions.len() as u32).filter(|&v| is_open[v as usize]).collect();
    let mut local = vec![NONE; positions.len()];
    vertices.iter().enumerate().for_each(|(k, &v)| local[v as usize] = k as u32);
    let all = &faces;
    let open_edges = || {
        all.iter().enumerate().flat_map(|(f, face)| {
            (0..3).filter(|&i| face.beyond[i] == NONE).map(move |i| (f as u32, i, face.edge(i), face.is_constraint(i)))
        })
    };
    let outline = Rows::new(vertices.len(), || {
        open_edges().map(|(face, i, [u, v], is_constraint)| {
            (local[u as usize] as usize, Open { to: local[v as usize], face, edge: i as u8, is_constraint })
        })
    });
    let on_outline = |[u, v]: [u32; 2]| outline.of(u as usize).iter().find(|open| open.to == v);
    let given = edges.iter().map(|edge| edge.map(|v| local[v as usize]));
    let given = given.filter(|[u, v]| *u != NONE && *v != NONE);
    let bounds = open_edges().map(|(_, _, edge, _)| edge.map(|v| local[v as usize]));
    let constraints: Vec<[u32; 2]> = given.chain(bounds).collect();
    let places: Vec<DVec2> = vertices.iter().map(|&v| positions[v as usize]).collect();
    let found = faces_between(&places, &constraints)?;
    // The triangulation also fills the ground of the certain triangles.
    let is_filled = |face: &Face| (0..3).any(|i| on_outline(face.edge(i)).is_some());
    let mut filled = vec![false; found.len()];
    let mut stack: Vec<u32> = (0..found.len() as u32).filter(|&f| is_filled(&found[f as usize])).collect();
    while let Some(f) = stack.pop() {
        if std::mem::replace(&mut filled[f as usize], true) {
            continue;
        }
        let face = &found[f as usize];
        let inner = (0..3).filter(|&i| face.beyond[i] != NONE && on_outline(face.edge(i)).is_none());
        stack.extend(inner.map(|i| face.beyond[i]));
    }
    let mut number = vec![NONE; found.len()];
    for (k, f) in (0..found.len()).filter(|&f| !filled[f]).enumerate() {
        number[f] = (faces.len() + k) as u32;
    }
    let mut joined = Vec::new();
    let mut closing = Vec::with_capacity(found.len());
    for (f, face) in found.iter().enumerate().filter(|(f, _)| !filled[*f]) {
        let mut own = Face { corners: face.corners.map(|v| vertices[v as usize]), beyond: [NONE; 3], ..*face };
        for i in 0..3 {
            let [u, v] = face.edge(i);
            if let Some(open) = on_outline([v, u]) {
                own.beyond[i] = open.face;
                if !open.is_constraint {
                    own.edges &= !(CONSTRAINT << i);
                }
                joined.push((*open, number[f]));
            } else if face.beyond[i] != NONE {
                own.beyond[i] = number[face.beyond[i] as usize];
            }
        }
        closing.push(own);
    }
    for (open, face) in joined {
        faces[open.face as usize].beyond[open.edge as usize] = face;
    }
    faces.extend(closing);
    // Euler's formula: with triangles missing or doubled, the numbers do not agree.
    let hull = faces.iter().flat_map(|face| face.beyond).filter(|&n| n == NONE).count();
    let fits = faces.len() + hull + 2 == 2 * positions.len();
    Ok(fits.then_some(faces))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of rings around centres, as contours have them, with the edges between them, and points between the rings.
    fn rings(wobble: f64) -> (Vec<DVec2>, Vec<[u32; 2]>) {
        let (mut points, mut edges) = (Vec::new(), Vec::new());
        let shaken = |k: usize, seed: f64| wobble * ((k as f64 * seed).fract() - 0.5);
        for centre in [DVec2::ZERO, DVec2::new(90.0, 10.0), DVec2::new(30.0, 95.0)] {
            for ring in 1..6 {
                let first = points.len() as u32;
                let count = 12 * ring;
                for k in 0..count {
                    let angle = f64::from(k) * std::f64::consts::TAU / f64::from(count);
                    let shake = shaken(points.len(), 0.618_034);
                    points.push(centre + DVec2::from_angle(angle) * (f64::from(ring) * 7.0 + shake));
                    edges.push([first + k, first + (k + 1) % count]);
                }
            }
        }
        // A long edge past many blocks, outside all rings.
        let first = points.len() as u32;
        points.extend([DVec2::new(-60.0, -45.0), DVec2::new(150.0, -45.0), DVec2::new(61.0, 60.0)]);
        edges.push([first, first + 1]);
        (points, edges)
    }

    /// Each edge with whether it is a constraint and whether it has a neighbour, sorted.
    fn sorted(faces: &[Face]) -> Vec<([u32; 2], bool, bool)> {
        let of_face = |face: &Face| [0, 1, 2].map(|i| (face.edge(i), face.is_constraint(i), face.beyond[i] == NONE));
        let mut all: Vec<_> = faces.iter().flat_map(of_face).collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn blocks_joined_are_the_triangulation_of_all() {
        let (points, edges) = rings(0.7);
        let whole = faces_between(&points, &edges).unwrap();
        for most in [5, 17, 60, 200, 1000] {
            let joined = in_blocks(&points, &edges, most).unwrap().unwrap();
            assert_eq!(sorted(&joined), sorted(&whole), "{most}");
            for (f, face) in joined.iter().enumerate() {
                for i in (0..3).filter(|&i| face.beyond[i] != NONE) {
                    let other = &joined[face.beyond[i] as usize];
                    assert!(other.beyond.contains(&(f as u32)), "{most} {f}");
                }
            }
        }
    }

    #[test]
    fn points_on_common_circles_and_on_cuts_fit_together() {
        let (mut points, edges) = rings(0.0);
        let raster = (0..40).flat_map(|i| (0..40).map(move |j| DVec2::new(f64::from(i) + 160.0, f64::from(j))));
        points.extend(raster);
        let whole = faces_between(&points, &edges).unwrap();
        for most in [20, 64, 500] {
            let joined = in_blocks(&points, &edges, most).unwrap().unwrap();
            assert_eq!(joined.len(), whole.len(), "{most}");
            let constraints = |faces: &[Face]| faces.iter().map(|face| face.edges.count_ones()).sum::<u32>();
            assert_eq!(constraints(&joined), constraints(&whole), "{most}");
        }
    }

    #[test]
    fn a_crossing_is_found_in_every_block() {
        let (mut points, mut edges) = rings(0.7);
        let first = points.len() as u32;
        points.extend([DVec2::new(-50.0, 3.1), DVec2::new(120.0, 3.2)]);
        edges.push([first, first + 1]);
        assert!(in_blocks(&points, &edges, 20).is_err());
    }
}
