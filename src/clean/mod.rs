//! Cleaning: makes a map's contours sound, and says what was wrong.
//!
//! In this order: bad points out, levels that differ by rounding made one, every line in its standard form, self-touching
//! lines split, duplicates out, ends joined, vertices that stray across lines left out, conflicts cut, spot heights checked.
//! Conflicts are lines that no triangulation could hold: those of different levels that touch, and lines that cross. They
//! are searched with exact predicates on the coordinates as they are, and cut by leaving out whole segments, so that every
//! vertex that remains is a vertex of the input. A line that merely touches itself loses nothing: it is split there. Nothing
//! depends on the order of the input's features, nor on the number of threads.

mod canonical;
mod contacts;
mod cut;
mod faults;
mod join;
mod levels;
mod nodes;
mod points;
mod removed;
mod segments;
mod split;
mod spots;
mod strays;
#[cfg(test)]
mod tests;

use std::collections::HashSet;

use glam::DVec2;
use rayon::prelude::*;

pub(crate) use self::points::is_height;
#[cfg(feature = "io")]
pub(crate) use self::points::is_place;
pub(crate) use self::segments::{Runs, Segments};

use self::contacts::Contacts;
use self::removed::{Removed, Why};

use crate::base::error::{Error, Finding, Report, Result};
use crate::contour::{Contour, ContourMap};
use crate::geometry::{self, Segment, tolerance_of_box};

/// How often connections that are in the way are taken back one by one, before all are. Twice is nearly always enough:
/// to take one back can bring back a segment that is in the way of another.
const JOIN_ROUNDS: usize = 4;

/// How often vertices that stray are looked for: the straight pieces instead of them may meet each other.
const STRAY_ROUNDS: usize = 4;

/// On large maps lines of different level are to be further apart, up to so many times.
const WIDEST: f64 = 1e3;

/// What counts as near, in map units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CleanParams {
    /// The widest gap across which ends of one level are joined and a line is closed. With 0 only ends at the very same
    /// point are.
    pub snap: f64,
    /// Lines of different level, and spot heights, closer than this count as touching. On a map so large, or so far from
    /// zero, that places on its frame are known less well (two billionths of its size, so 0.06 mm for 30 km), they count so when
    /// they are closer than that, up to a thousand times this.
    pub separation: f64,
}

impl Default for CleanParams {
    fn default() -> Self {
        Self { snap: 0.0, separation: 1e-6 }
    }
}

impl CleanParams {
    fn check(&self) -> Result<()> {
        for (name, value) in [("snap distance", self.snap), ("separation", self.separation)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(Error::out_of_range(name, value, "0 or more"));
            }
        }
        Ok(())
    }

    /// The same with the separation that this map needs: of two lines that both lie on the frame but for its tolerance, on either
    /// side of it, each could take the other's place there.
    pub(super) fn on(&self, map: &ContourMap) -> Self {
        let places = map.places().filter(|p| points::is_place(*p));
        let (min, max) = places.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
        let least = if min.x <= max.x { 2.0 * tolerance_of_box(min, max) } else { 0.0 };
        Self { separation: self.separation.max(least.min(WIDEST * self.separation)), ..*self }
    }
}

/// Makes a map sound; see the module's first lines for the steps.
///
/// In the result every coordinate and elevation is finite and every line has two points at least, visits no vertex twice
/// (but for the end of a closed line) and does not cross itself; lines of one level touch at single points at most and
/// do not cross there otherwise than at a common vertex; lines of different level are at least
/// [`separation`](CleanParams::separation) apart. Lines
/// are sorted by elevation, then by their points. Open lines run from their smaller end (by x, then y), closed ones start
/// at their smallest vertex. A joined line has the smallest feature number of its pieces. Elevations that differ by rounding
/// only are made the same number.
///
/// What is left out or joined is in the findings, step by step and in a fixed order within each.
///
/// # Errors
/// [`Error::OutOfRange`] for distances that are negative or no numbers. [`Error::Data`] if lines meet so often that they
/// cannot be contour lines, or if there are more than 2³² vertices.
pub fn clean(mut map: ContourMap, params: &CleanParams) -> Result<Report<ContourMap>> {
    params.check()?;
    let params = &params.on(&map);
    let lines = clean_lines(std::mem::take(&mut map.contours), params)?;
    let mut findings = lines.findings;
    findings.extend(lines.removed.iter().filter_map(Removed::finding));
    map.mended.extend(lines.faults.iter().filter_map(|fault| fault.place));
    findings.extend(lines.faults);
    map.spots = spots::clean(map.spots, &lines.contours, params.separation)?.collect(&mut findings);
    map.contours = lines.contours;
    Ok(Report { value: map, findings })
}

/// Checks what [`clean`](fn@clean) promises of a map's lines and that its spot heights are finite.
///
/// # Errors
/// [`Error::Data`] with the first thing that is not so.
pub fn validate(map: &ContourMap, params: &CleanParams) -> Result<()> {
    params.check()?;
    let params = params.on(map);
    for contour in &map.contours {
        points::validate(contour)?;
    }
    if map.spots.iter().any(|s| !(points::is_place(s.truncate()) && points::is_height(s.z))) {
        return Err(Error::Data("a spot height is no place or no height".to_owned()));
    }
    let segments = Segments::new(&map.contours)?;
    let contacts = contacts::find(&segments, params.separation)?;
    let Some((s, t)) = contacts.iter().next() else { return Ok(()) };
    let (a, b, place) = (segments.line_of(s), segments.line_of(t), geometry::place(&segments.get(s), &segments.get(t)));
    Err(Error::Data(format!(
        "the contours {} m (feature {}) and {} m (feature {}) meet at {} {}",
        a.elevation, a.feature, b.elevation, b.feature, place.x, place.y
    )))
}

/// Numbers of the lines that [`validate`] would complain about for meeting another line or themselves, ascending.
pub(super) fn lines_in_conflict(lines: &[Contour], params: &CleanParams) -> Result<Vec<usize>> {
    let mut numbers: Vec<usize> = segments_in_conflict(lines, params)?.into_iter().map(|(line, _)| line).collect();
    numbers.dedup();
    Ok(numbers)
}

/// The segments that [`validate`] would complain about: number of the line and of the segment on it, ascending.
pub(super) fn segments_in_conflict(lines: &[Contour], params: &CleanParams) -> Result<Vec<(usize, usize)>> {
    let segments = Segments::new(lines)?;
    let contacts = contacts::find(&segments, params.separation)?;
    let mut numbers: Vec<u32> = contacts.iter().flat_map(|(s, t)| [s, t]).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let place = |s: u32| {
        let line = segments.line_number(s);
        (line, (s - segments.start(line as u32)) as usize)
    };
    Ok(numbers.into_iter().map(place).collect())
}

/// Whether a line by itself has finite points and visits none twice.
pub(super) fn is_sound(line: &Contour) -> bool {
    points::validate(line).is_ok()
}

/// The lines in standard form and order.
pub(super) fn in_standard_order(mut lines: Vec<Contour>) -> Vec<Contour> {
    canonical::sort(&mut lines);
    lines
}

/// Spot heights without those that lie on a contour.
pub(super) fn spots_off_contours(
    spots: Vec<glam::DVec3>,
    contours: &[Contour],
    params: &CleanParams,
) -> Result<Report<Vec<glam::DVec3>>> {
    spots::clean(spots, contours, params.separation)
}

/// The lines after cleaning, and what happened to them.
struct Cleaned {
    contours: Vec<Contour>,
    findings: Vec<Finding>,
    /// What is left out.
    removed: Vec<Removed>,
    /// Where lines met.
    faults: Vec<Finding>,
}

fn clean_lines(contours: Vec<Contour>, params: &CleanParams) -> Result<Cleaned> {
    let Report { value: mut lines, mut findings } = points::drop_bad(contours);
    levels::unite(&mut lines);
    let mut removed = Vec::new();
    let lines = canonical::sort_unique(simple(lines, &mut removed), &mut findings);

    let joined = join_where_free(lines, params)?;
    findings.extend(joined.findings);
    removed.extend(joined.removed);

    let (mut lines, mut contacts) = (joined.lines, joined.contacts);
    if !contacts.own.is_empty() {
        let split = nodes::insert(lines, &contacts.own)?;
        let from = removed.len();
        lines = split.unchanged;
        lines.extend(simple(split.changed, &mut removed));
        findings.extend(nodes::findings(&split.new, &removed[from..]));
        lines = canonical::sort_unique(lines, &mut findings);
        contacts = contacts::find(&Segments::new(&lines)?, params.separation)?;
    }

    // No line meets itself any more but by crossing, so there are only conflicts left.
    let mut conflicts: Vec<_> = contacts.iter().collect();
    let mut faults = Vec::new();
    for _ in 0..STRAY_ROUNDS {
        let Some(straight) = strays::leave_out(&Segments::new(&lines)?, &conflicts, params.separation) else { break };
        lines = straight.lines;
        removed.extend(straight.removed);
        faults.extend(straight.findings);
        canonical::sort(&mut lines);
        conflicts = contacts::find(&Segments::new(&lines)?, params.separation)?.iter().collect();
    }
    if !conflicts.is_empty() {
        let segments = Segments::new(&lines)?;
        let cuts = cut::choose(&segments, &conflicts);
        faults.extend(faults::findings(&segments, conflicts, &cuts, params.separation));
        removed.par_extend(cuts.par_iter().map(|&(s, _)| {
            let Segment { a, b } = segments.get(s);
            Removed::new(segments.line_of(s), vec![a, b], Why::Meets)
        }));
        let starts = segments.into_starts();
        lines = cut::apply(lines, &starts, &cuts);
        canonical::sort(&mut lines);
    }
    Ok(Cleaned { contours: lines, findings, removed, faults })
}

/// Lines joined where they can be, sorted, with their contacts.
struct Joined {
    lines: Vec<Contour>,
    contacts: Contacts,
    findings: Vec<Finding>,
    removed: Vec<Removed>,
}

/// Joins lines, but not where the connection would meet a line: what the input has is not cut for the sake of a guess.
fn join_where_free(mut lines: Vec<Contour>, params: &CleanParams) -> Result<Joined> {
    let mut in_the_way = HashSet::new();
    let mut round = 0;
    loop {
        round += 1;
        // Without gaps to close there is no second round.
        let pieces = if params.snap > 0.0 { lines.clone() } else { std::mem::take(&mut lines) };
        let join::Joined { unchanged, joined, connectors } = join::join(pieces, params.snap, &in_the_way);
        let (mut findings, mut removed) = (Vec::new(), Vec::new());
        let mut all = unchanged;
        all.extend(simple(joined, &mut removed));
        let all = canonical::sort_unique(all, &mut findings);
        let segments = Segments::new(&all)?;
        let contacts = contacts::find(&segments, params.separation)?;

        let before = in_the_way.len();
        if !connectors.is_empty() {
            let met = contacts.iter().flat_map(|(s, t)| [segments.key(s), segments.key(t)]);
            in_the_way
                .extend(met.chain(removed.iter().flat_map(Removed::keys)).filter(|key| connectors.contains_key(key)));
        }
        if in_the_way.len() == before {
            findings.extend(join::findings(&connectors));
            return Ok(Joined { lines: all, contacts, findings, removed });
        }
        if round == JOIN_ROUNDS {
            in_the_way.extend(connectors.into_keys());
        }
    }
}

/// The lines in standard form, split where they touch themselves.
fn simple(mut lines: Vec<Contour>, removed: &mut Vec<Removed>) -> Vec<Contour> {
    lines.par_iter_mut().for_each(|line| canonical::normalise(&mut line.points));
    let split: Vec<split::Split> = lines.into_par_iter().map(split::at_repeated_vertices).collect();
    let mut simple = Vec::with_capacity(split.len());
    let from = removed.len();
    for part in split {
        simple.extend(part.lines);
        removed.extend(part.spikes);
    }
    removed[from..].sort_by(Removed::compare);
    simple
}
