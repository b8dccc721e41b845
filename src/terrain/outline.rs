//! The outline of a frame in another coordinate reference system, for the extent of a height map there.
//!
//! In degrees, and in many projections, neighbouring places can have coordinates that are far apart: at the 180th
//! meridian, or around a pole. The box around such an outline goes around the Earth. This is found where a short piece
//! of the outline becomes a long one: it is halved again and again towards the place where it jumps. A piece that is
//! long but has no jump becomes short.

use glam::DVec2;

use tokosen_core::base::error::Cut;
use tokosen_core::crs::Transform;
use tokosen_core::subdomains::FrameRing;

/// Pieces per edge of the frame. A straight edge is a curve in another system.
const PIECES: u32 = 16;

/// Halvings of a piece. A piece of a kilometre is then shorter than a micrometre.
const HALVINGS: u32 = 30;

/// A piece is suspected to jump if it is longer than this share of the extent.
const LONG: f64 = 0.5;

/// A jump keeps at least this share of its length when its piece is halved.
const KEPT: f64 = 0.75;

/// A piece of the outline, by its ends on the working plane and in the other system.
#[derive(Debug, Clone, Copy)]
struct Piece {
    plane: [DVec2; 2],
    there: [DVec2; 2],
}

/// The outline of a frame in another system.
pub(super) struct Outline<'a> {
    /// The pieces of every ring that have a place there.
    rings: Vec<Vec<Piece>>,
    /// The conversion from that system to the working one.
    way: &'a Transform,
}

impl<'a> Outline<'a> {
    /// The outline of a frame in the system that `way` converts from.
    pub fn of(frame: &FrameRing, way: &'a Transform) -> Self {
        let ring = |ring: Vec<DVec2>| {
            let edges = ring.iter().zip(ring.iter().cycle().skip(1));
            let points = edges.flat_map(|(a, b)| (0..PIECES).map(|k| a.lerp(*b, f64::from(k) / f64::from(PIECES))));
            let points: Vec<(DVec2, Option<DVec2>)> = points.map(|p| (p, way.inverse(p))).collect();
            let pieces = points.iter().zip(points.iter().cycle().skip(1));
            let known = pieces.filter_map(|(a, b)| Some(Piece { plane: [a.0, b.0], there: [a.1?, b.1?] }));
            known.collect()
        };
        Self { rings: frame.rings().map(ring).collect(), way }
    }

    /// Whether no part of it has a place in the other system.
    pub fn is_empty(&self) -> bool {
        self.rings.iter().all(Vec::is_empty)
    }

    /// The corners of the box around it.
    pub fn extent(&self) -> (DVec2, DVec2) {
        let ends = self.rings.iter().flatten().flat_map(|piece| piece.there);
        ends.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
    }

    /// Where coordinates jump along it, if they do. `in_degrees`: whether they are longitude and latitude.
    pub fn cut(&self, in_degrees: bool) -> Option<Cut> {
        let (lo, hi) = self.extent();
        let long = (hi - lo) * LONG;
        let is_long = |piece: &&Piece| length(piece.there).cmpgt(long).any();
        if !self.rings.iter().flatten().filter(is_long).any(|piece| self.jumps(*piece)) {
            return None;
        }
        let around = |ring: &Vec<Piece>| in_degrees && turns(ring).abs() > 0.5;
        Some(if self.rings.iter().any(around) { Cut::Pole } else { Cut::Line })
    }

    /// Whether coordinates jump on a piece, however short it is.
    fn jumps(&self, mut piece: Piece) -> bool {
        let most = length(piece.there).max_element() * KEPT;
        for _ in 0..HALVINGS {
            let middle = piece.plane[0].midpoint(piece.plane[1]);
            // Where there is no place, coordinates do not go on.
            let Some(there) = self.way.inverse(middle) else { return true };
            let first = Piece { plane: [piece.plane[0], middle], there: [piece.there[0], there] };
            let second = Piece { plane: [middle, piece.plane[1]], there: [there, piece.there[1]] };
            let is_first = length(first.there).max_element() > length(second.there).max_element();
            piece = if is_first { first } else { second };
            if length(piece.there).max_element() < most {
                return false;
            }
        }
        true
    }
}

fn length([a, b]: [DVec2; 2]) -> DVec2 {
    (b - a).abs()
}

/// How often a ring turns around a pole: the sum of the steps in longitude, each the short way.
fn turns(ring: &[Piece]) -> f64 {
    let step = |piece: &Piece| {
        let step = (piece.there[1].x - piece.there[0].x) / 360.0;
        step - step.round()
    };
    ring.iter().map(step).sum()
}
