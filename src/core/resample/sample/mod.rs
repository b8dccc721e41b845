//! Sampling: makes vertices dense enough for the contours around them (Zhang, Konno and Tokuyama 2005, section 3.1).
//!
//! A contour is an s-sample if the neighbours of each vertex on the line are within `s` times the distance to the
//! nearest other contour. Here both neighbours must be so near, not only the nearer one. Otherwise a
//! wide space could remain beside a cluster. "Another contour" is any other line, also of the same level. As in the paper,
//! two arms of one line side by side do not affect each other.
//!
//! Points are added on the existing segments, and nothing moves. Segments are halved until the condition holds. A piece
//! that is short compared with the distance to other contours is split into equal parts at once. Along it that distance
//! cannot change by more than its length. Where contours nearly touch, a lower limit ends the halving.

mod params;
mod plan;
#[cfg(test)]
mod tests;

pub use self::params::SampleParams;
use self::plan::on_segment;
pub(super) use self::plan::{Cut, Plan, plan};

use crate::base::error::{Error, Report, Result};
use crate::base::parallel;
use crate::clean::{self, CleanParams};
use crate::contour::{Contour, ContourMap};

/// Rounds in which single segments lose their new points if these make lines meet. After them whole lines lose theirs.
const ROUNDS: usize = 4;

/// A sampled map, with figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// The map: its lines as before, in their order, with more vertices.
    pub map: ContourMap,
    /// Points that were added.
    pub added: usize,
    /// The lower limit, map units. Where the ratio asks for pieces shorter than twice this, longer pieces are allowed.
    pub least: f64,
    /// Pieces that are longer than the ratio asks because of the lower limit.
    pub held: usize,
    /// Segments without the points that they need. Because of rounding, lines would meet with these points.
    pub whole: usize,
}

/// Adds vertices to the lines of a clean map; see the module's first lines.
///
/// All existing vertices stay bit for bit and in order. The result passes [`validate`](clean::validate). Spot heights
/// that come to lie on a contour by rounding are left out, with a finding.
///
/// # Errors
/// [`Error::OutOfRange`] for a ratio that is not between 0 and 1, and for a lower limit that is not above 0.
/// [`Error::TooManyPoints`] if more points than `most` would arise. [`Error::Data`] if the map is not clean.
pub fn sample(mut map: ContourMap, params: &SampleParams, near: &CleanParams) -> Result<Report<Sampled>> {
    params.check()?;
    clean::validate(&map, near)?;
    let near = &near.on(&map);
    let contours = std::mem::take(&mut map.contours);
    let spots = std::mem::take(&mut map.spots);
    let Plan { mut cuts, least, held } = plan(&contours, params)?;
    let mut whole = 0;
    let mut round = 0;
    let lines = loop {
        let lines: Vec<Contour> = parallel::map(contours.len(), |i| with_points(&contours[i], &cuts[i]));
        let met = clean::segments_in_conflict(&lines, near)?;
        if met.is_empty() {
            break lines;
        }
        round += 1;
        let mut taken = 0;
        for of_line in met.chunk_by(|a, b| a.0 == b.0) {
            let line = of_line[0].0;
            taken += take_back(&mut cuts[line], of_line.iter().map(|&(_, k)| k), round > ROUNDS);
        }
        if taken == 0 {
            // Lines without added points do not meet, so this cannot happen. Still, the loop must end.
            clean::validate(&ContourMap { contours: lines, ..ContourMap::default() }, near)?;
            return Err(Error::Data("sampled lines meet where nothing was added".to_owned()));
        }
        whole += taken;
    };
    let added = cuts.iter().map(Vec::len).sum();
    let (spots, findings) = match added {
        0 => (spots, Vec::new()),
        _ => {
            let Report { value, findings } = clean::spots_off_contours(spots, &lines, near)?;
            (value, findings)
        }
    };
    let map = ContourMap { contours: lines, spots, ..map };
    Ok(Report { value: Sampled { map, added, least, held, whole }, findings })
}

/// Takes the added points of some segments out of a line. `pieces` are numbers of segments with the added points in.
/// Returns the number of segments that lost points.
fn take_back(cuts: &mut Vec<Cut>, pieces: impl Iterator<Item = usize>, all: bool) -> usize {
    // Before piece k there are as many added points as cuts on the way.
    let segment_of = |k: usize, cuts: &[Cut]| {
        let before = partition(cuts.len(), |i| cuts[i].segment as usize + i < k);
        (k - before) as u32
    };
    let segments: Vec<u32> = pieces.map(|k| segment_of(k, cuts)).collect();
    let segments_with_points = |cuts: &[Cut]| cuts.chunk_by(|a, b| a.segment == b.segment).count();
    let before = segments_with_points(cuts);
    cuts.retain(|cut| !all && segments.binary_search(&cut.segment).is_err());
    before - segments_with_points(cuts)
}

/// The first of `0..n` for which `is_before` is false. It must be true for all numbers before, and false for all after.
fn partition(n: usize, is_before: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, n);
    while low < high {
        let middle = low.midpoint(high);
        if is_before(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

fn with_points(contour: &Contour, cuts: &[Cut]) -> Contour {
    let mut points = Vec::with_capacity(contour.points.len() + cuts.len());
    let mut cuts = cuts.iter().peekable();
    for (k, w) in (0u32..).zip(contour.points.windows(2)) {
        points.push(w[0]);
        while let Some(cut) = cuts.next_if(|cut| cut.segment == k) {
            points.push(on_segment(w[0], w[1], cut.share));
        }
    }
    points.extend(contour.points.last());
    Contour { points, ..*contour }
}
