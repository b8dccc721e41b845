//! Plates: a model of the terrain in layers, to be cut out of a material of some thickness and glued on each other.
//!
//! 1. A plate is the ground at or above its level ([`areas_above`]). The lowest one is the whole map. Each plate lies inside the
//!    one below it, exactly.
//! 2. Pieces that are too small are left out. The widest circle in a piece says how wide it is (`widest`).
//! 3. On a plate, the outline of the next one shows where that is glued on, and a number tells the plates apart (`numeral`). It
//!    stands where the next plate covers it, if there is one.
//! 4. The plates are laid side by side on sheets (`sheets`).

mod numeral;
mod sheets;
#[cfg(test)]
mod tests;
mod widest;

use foldhash::HashSet;
use glam::DVec2;

use crate::bands::{BandArea, Rings, areas_above, runs};
use crate::base::bits::bits;
use crate::base::error::{Error, Result};
use crate::base::parallel;
use crate::contour::Interval;
use crate::geometry::Bounds;
use numeral::numeral;
use widest::{Circle, Shape};

/// A circle of this diameter fits into every piece, millimetres. Smaller ones burn, and fall through the grid of a laser cutter.
pub const SMALLEST: f64 = 3.0;
/// Largest number of plates. Their numbers have three digits.
const MOST_PLATES: i64 = 999;
/// Heights within this share of the interval are on a level.
const ON_LEVEL: f64 = 1e-6;

/// How high the ground of one plate is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rise {
    /// There is a plate every so many metres. The factor on heights follows.
    Interval(f64),
    /// Heights are the scale's times this factor. The interval follows.
    Exaggeration(f64),
}

/// How large and how thick plates are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateParams {
    /// Thickness of the material, millimetres.
    pub thickness: f64,
    /// Length of the longer side of the map, millimetres.
    pub size: f64,
    /// How high the ground of one plate is.
    pub rise: Rise,
    /// Width and height of a sheet of the material, millimetres. One sheet that is large enough if `None`.
    pub sheet: Option<DVec2>,
}

impl PlateParams {
    /// Plates of a material, for a map of 180 mm with heights as they are.
    pub fn of(thickness: f64) -> Self {
        Self { thickness, size: 180.0, rise: Rise::Exaggeration(1.0), sheet: None }
    }

    /// The interval between plates, and the factor on heights, for a scale in millimetres of the model for each metre.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for what is not above 0.
    pub fn steps(&self, scale: f64) -> Result<(Interval, f64)> {
        let (name, rise) = match self.rise {
            Rise::Interval(step) => ("interval", step),
            Rise::Exaggeration(factor) => ("factor on heights", factor),
        };
        for (name, value) in [("thickness", self.thickness), ("size", self.size), (name, rise)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::out_of_range(name, value, "more than 0"));
            }
        }
        // Both are the thickness on the ground, over the other.
        let other = self.thickness / scale / rise;
        let (step, factor) = if matches!(self.rise, Rise::Interval(_)) { (rise, other) } else { (other, rise) };
        Ok((Interval::every(step), factor))
    }
}

/// The lines of a plate on its sheet, in millimetres from the lower left corner. The first point of a ring is repeated.
#[derive(Debug, Clone, PartialEq)]
pub struct Plate {
    /// 1 for the lowest.
    pub number: u32,
    /// The ground of the plate is at or above this, metres.
    pub level: f64,
    /// Number of its pieces.
    pub pieces: usize,
    /// The rings to cut.
    pub cut: Vec<Vec<DVec2>>,
    /// The outline of the next plate, but for what is an outline of this one too.
    pub outline: Vec<Vec<DVec2>>,
    /// The strokes of its number, once in each piece.
    pub numbers: Vec<Vec<DVec2>>,
}

/// A sheet of material.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Width and height, millimetres.
    pub size: DVec2,
    /// The plates on it.
    pub plates: Vec<Plate>,
}

/// All plates of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Plates {
    /// The sheets, with the plates from the lowest to the highest.
    pub sheets: Vec<Sheet>,
    /// Width and height of the lowest plate, which is the whole map, millimetres.
    pub size: DVec2,
    /// Number of pieces that a circle of the diameter [`SMALLEST`] does not fit into. They are left out.
    pub left_out: usize,
}

/// A connected part of a plate, in millimetres.
struct Piece {
    rings: Rings,
    shape: Shape,
    widest: Circle,
}

impl Piece {
    fn new(rings: Rings) -> Self {
        let shape = Shape::new(&rings);
        let widest = shape.widest(SMALLEST / 2.0);
        Self { rings, shape, widest }
    }
}

/// The plates of a model at a scale in millimetres for each metre, from the bands between the levels of `interval`.
///
/// # Errors
/// [`Error::Parameter`] if there are fewer than two plates or too many of them, or if a sheet is too small.
pub fn plates(areas: &[BandArea], interval: Interval, scale: f64, sheet: Option<DVec2>) -> Result<Plates> {
    let levels = levels(areas, interval)?;
    let mut above = levels.clone();
    above[0] = f64::NEG_INFINITY;
    let map = Bounds::around(&areas.iter().flat_map(|area| &area.rings).flatten().copied().collect::<Vec<_>>());
    let on_plate = |ring: &Vec<DVec2>| ring.iter().map(|p| (*p - map.min) * scale).collect::<Vec<DVec2>>();
    let mut left_out = 0;
    let mut stack: Vec<Vec<Piece>> = Vec::new();
    // From the top down: a piece under another one is kept.
    for shapes in areas_above(areas, &above).into_iter().rev() {
        let pieces = parallel::map_each(&shapes, |rings| Piece::new(rings.iter().map(on_plate).collect()));
        let holds = |piece: &Piece| stack.last().into_iter().flatten().any(|p| piece.shape.contains(p.widest.middle));
        let (kept, small): (Vec<Piece>, Vec<Piece>) =
            pieces.into_iter().partition(|piece| piece.widest.radius >= SMALLEST / 2.0 || holds(piece));
        left_out += small.len();
        stack.push(kept);
    }
    stack.reverse();
    stack.retain(|pieces| !pieces.is_empty());
    if stack.len() < 2 {
        return Err(Error::Parameter(format!(
            "all pieces above the lowest plate are narrower than {SMALLEST} mm: choose a larger size or another interval"
        )));
    }
    let none = Vec::new();
    let next = stack.iter().skip(1).chain([&none]);
    let numbered = (1..).zip(&levels).zip(stack.iter().zip(next));
    let plates = numbered.map(|((number, level), (pieces, next))| plate((number, *level), pieces, next)).collect();
    let size = (map.max - map.min) * scale;
    Ok(Plates { sheets: sheets::lay(plates, sheet)?, size, left_out })
}

/// The levels from that at or below the lowest ground to that at or below the highest.
fn levels(areas: &[BandArea], interval: Interval) -> Result<Vec<f64>> {
    let number = |height: f64| ((height - interval.base) / interval.step + ON_LEVEL).floor() as i64;
    let known = || areas.iter().filter_map(|area| area.from);
    let lowest = number(known().fold(f64::INFINITY, f64::min));
    let highest = number(known().fold(f64::NEG_INFINITY, f64::max));
    let step = interval.step;
    if known().next().is_none() || lowest == highest {
        return Err(Error::Parameter(format!(
            "with a plate every {step:.2} m there is one plate alone: choose a smaller interval, a thinner material or a larger \
             factor on heights"
        )));
    }
    let count = highest.saturating_sub(lowest).saturating_add(1);
    if count > MOST_PLATES {
        return Err(Error::Parameter(format!(
            "with a plate every {step} m there are {count} plates, more than {MOST_PLATES}: choose a larger interval"
        )));
    }
    Ok((lowest..=highest).map(|k| interval.level(k)).collect())
}

/// The lines of a plate, at the place of the map.
fn plate((number, level): (u32, f64), pieces: &[Piece], next: &[Piece]) -> Plate {
    let rings = |pieces: &[Piece]| pieces.iter().flat_map(|piece| piece.rings.clone()).collect::<Rings>();
    let cut = rings(pieces);
    let edge = |edge: &[DVec2]| [bits(edge[0]), bits(edge[1])];
    let own: HashSet<[[u64; 2]; 2]> = cut.iter().flat_map(|ring| ring.windows(2).map(edge)).collect();
    let outline = rings(next).iter().flat_map(|ring| runs(ring, |at| !own.contains(&edge(at)))).collect();
    let numbers = pieces.iter().flat_map(|piece| {
        let covers = next.iter().filter(|next| piece.shape.contains(next.widest.middle)).map(|next| next.widest);
        numeral(number, covers.max_by(|a, b| a.radius.total_cmp(&b.radius)).unwrap_or(piece.widest))
    });
    Plate { number, level, pieces: pieces.len(), numbers: numbers.collect(), cut, outline }
}
