//! Cleaning: repairs a map's contours and reports what was wrong.
//!
//! The steps, in this order:
//! 1. Bad points are removed.
//! 2. Levels that differ only by rounding are united.
//! 3. Each line is brought to its standard form.
//! 4. Ends that overrun their own line are trimmed. Lines that touch themselves are split.
//! 5. Duplicate lines are removed.
//! 6. Ends are joined.
//! 7. Stray vertices, which make a line cross another one, are removed.
//! 8. Conflicts are cut.
//! 9. Spot heights are checked.
//!
//! Conflicts are pairs of lines that no triangulation could hold: lines of different level that touch, and lines that
//! cross. Exact predicates find them in the coordinates as they are. Cutting removes whole segments, so each remaining
//! vertex is a vertex of the input. A line that only touches itself loses nothing: it is split there. The result
//! depends neither on the order of the input's features nor on the number of threads.

mod canonical;
mod contacts;
mod cut;
mod faults;
mod join;
mod levels;
mod nodes;
mod overruns;
mod points;
mod removed;
mod segments;
mod split;
mod spots;
mod strays;
mod stretch;
#[cfg(test)]
mod tests;

use std::collections::HashSet;

use glam::DVec2;
use rayon::prelude::*;

pub(crate) use self::points::is_height;
#[doc(hidden)]
pub use self::points::is_place;
pub(crate) use self::segments::{Runs, Segments};

use self::contacts::Contacts;
use self::removed::{Removed, Why};

use crate::base::bits::bits;
use crate::base::error::{Error, Finding, Report, Result};
use crate::base::parallel;
use crate::contour::{Contour, ContourMap};
use crate::geometry::{self, Segment, tolerance_of_box};

/// Rounds in which single connections that are in the way are undone, before all are. Two are nearly always enough:
/// undoing one connection can bring back a segment that is in the way of another.
const JOIN_ROUNDS: usize = 4;

/// Rounds in which stray vertices are looked for. The straight pieces that replace them may meet each other.
const STRAY_ROUNDS: usize = 4;

/// On large maps lines of different level must be further apart: at most this many times the separation.
const WIDEST: f64 = 1e3;

/// What counts as near, in map units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CleanParams {
    /// Widest gap across which ends of one level are joined and a line is closed. With 0, only ends at exactly the same
    /// point are joined.
    pub snap: f64,
    /// Lines of different level, and spot heights, closer than this count as touching. On a large map, or one far from
    /// zero, positions on the frame are less accurate: two billionths of its size, so 0.06 mm for 30 km, and at least 4
    /// micrometres. There that distance counts instead, up to a thousand times this value.
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

    /// The same with the separation that this map needs. Two lines may both lie on the frame within its tolerance, one
    /// on either side of it. Closer than the tolerance, each could take the other's place there.
    pub(super) fn on(&self, map: &ContourMap) -> Self {
        let places = map.places().filter(|p| points::is_place(*p));
        let (min, max) = places.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
        let least = if min.x <= max.x { 2.0 * tolerance_of_box(min, max) } else { 0.0 };
        Self { separation: self.separation.max(least.min(WIDEST * self.separation)), ..*self }
    }
}

/// Cleans a map. The first lines of the module list the steps.
///
/// The result has these properties:
/// - Each coordinate and elevation is finite.
/// - Each line has at least two points, visits no vertex twice (except the end of a closed line) and does not cross
///   itself.
/// - Lines of one level touch only at single points, and cross there only at a common vertex.
/// - Lines of different level are at least [`separation`](CleanParams::separation) apart.
/// - Lines are sorted by elevation, then by their points. Open lines run from their smaller end (by x, then y). Closed
///   lines start at their smallest vertex.
/// - A joined line has the smallest feature number of its pieces.
/// - Elevations that differ only by rounding are made equal.
///
/// The findings report what was left out or joined, step by step, and in a fixed order within each step.
///
/// # Errors
/// [`Error::OutOfRange`] for distances that are negative or not numbers. [`Error::Data`] if lines meet so often that
/// they cannot be contour lines, or if there are more than 2³² vertices.
pub fn clean(mut map: ContourMap, params: &CleanParams) -> Result<Report<ContourMap>> {
    params.check()?;
    let params = &params.on(&map);
    let apart: HashSet<[u64; 2]> = map.cut_ends.iter().map(|p| bits(*p)).collect();
    let lines = clean_lines(std::mem::take(&mut map.contours), params, &apart)?;
    let mut findings = lines.findings;
    findings.extend(lines.removed.iter().filter_map(Removed::finding));
    map.mended.extend(lines.faults.iter().filter_map(|fault| fault.place));
    findings.extend(lines.faults);
    map.spots = spots::clean(map.spots, &lines.contours, params.separation)?.collect(&mut findings);
    map.contours = lines.contours;
    Ok(Report { value: map, findings })
}

/// Checks that a map's lines have the properties that [`clean`](fn@clean) promises, and that its spot heights are
/// finite.
///
/// # Errors
/// [`Error::Data`] with the first violation.
pub fn validate(map: &ContourMap, params: &CleanParams) -> Result<()> {
    params.check()?;
    let params = params.on(map);
    for contour in &map.contours {
        points::validate(contour)?;
    }
    if map.spots.iter().any(|s| !(points::is_place(s.truncate()) && points::is_height(s.z))) {
        return Err(Error::Data("a spot height has no valid position or height".to_owned()));
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

/// Numbers of the lines that [`validate`] would reject because they meet another line or themselves, ascending.
pub(super) fn lines_in_conflict(lines: &[Contour], params: &CleanParams) -> Result<Vec<usize>> {
    let mut numbers: Vec<usize> = segments_in_conflict(lines, params)?.into_iter().map(|(line, _)| line).collect();
    numbers.dedup();
    Ok(numbers)
}

/// The segments that [`validate`] would reject, ascending: the number of the line, and the number of the segment on it.
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

/// Whether a single line has finite points and visits none twice.
pub(super) fn is_sound(line: &Contour) -> bool {
    points::validate(line).is_ok()
}

/// The lines in standard form and standard order.
pub(super) fn in_standard_order(mut lines: Vec<Contour>) -> Vec<Contour> {
    canonical::sort(&mut lines);
    lines
}

/// Lines without their invalid points, with the findings about them.
pub fn without_bad_points(contours: Vec<Contour>) -> Report<Vec<Contour>> {
    points::drop_bad(contours)
}

/// The spot heights that do not lie on a contour.
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
    /// The pieces that were left out.
    removed: Vec<Removed>,
    /// Where lines met.
    faults: Vec<Finding>,
}

/// Cleans lines. Ends at the positions `apart` are not joined across a gap.
fn clean_lines(contours: Vec<Contour>, params: &CleanParams, apart: &HashSet<[u64; 2]>) -> Result<Cleaned> {
    let Report { value: mut lines, mut findings } = points::drop_bad(contours);
    levels::unite(&mut lines);
    let mut removed = Vec::new();
    let lines = canonical::sort_unique(simple(lines, params, &mut removed), &mut findings);

    let joined = join_where_free(lines, params, apart)?;
    findings.extend(joined.findings);
    removed.extend(joined.removed);

    let (mut lines, mut contacts) = (joined.lines, joined.contacts);
    if !contacts.own.is_empty() {
        let split = nodes::insert(lines, &contacts.own)?;
        let from = removed.len();
        lines = split.unchanged;
        lines.extend(simple(split.changed, params, &mut removed));
        findings.extend(nodes::findings(&split.new, &removed[from..]));
        lines = canonical::sort_unique(lines, &mut findings);
        contacts = contacts::find(&Segments::new(&lines)?, params.separation)?;
    }

    // No line touches or overlaps itself any more, so all contacts are conflicts.
    let mut conflicts: Vec<_> = contacts.iter().collect();
    let mut faults = Vec::new();
    let mut changed = None;
    for _ in 0..STRAY_ROUNDS {
        let segments = Segments::new(&lines)?;
        let straight = strays::leave_out(&segments, &conflicts, changed.as_deref(), params.separation);
        let Some(straight) = straight else { break };
        changed = Some(straight.changed);
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
        removed.extend(cuts.iter().map(|&(s, _)| {
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

/// Joins lines, except where the connection would meet a line. The input is not cut for the sake of a guess.
fn join_where_free(mut lines: Vec<Contour>, params: &CleanParams, apart: &HashSet<[u64; 2]>) -> Result<Joined> {
    let mut in_the_way = HashSet::new();
    let mut round = 0;
    loop {
        round += 1;
        // Without gaps to close there is no second round.
        let pieces = if params.snap > 0.0 { lines.clone() } else { std::mem::take(&mut lines) };
        let join::Joined { unchanged, joined, connectors } = join::join(pieces, params.snap, apart, &in_the_way);
        let (mut findings, mut removed) = (Vec::new(), Vec::new());
        let mut all = unchanged;
        all.extend(simple(joined, params, &mut removed));
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

/// The lines in standard form, without overruns, split where they touch themselves.
fn simple(mut lines: Vec<Contour>, params: &CleanParams, removed: &mut Vec<Removed>) -> Vec<Contour> {
    parallel::update(&mut lines, |_, line| canonical::normalise(&mut line.points));
    let near = params.snap.max(params.separation);
    let split: Vec<split::Split> = lines.into_par_iter().map(|line| trimmed_and_split(line, near)).collect();
    let mut simple = Vec::with_capacity(split.len());
    let from = removed.len();
    for part in split {
        simple.extend(part.lines);
        removed.extend(part.spikes);
    }
    removed[from..].sort_by(Removed::compare);
    simple
}

fn trimmed_and_split(line: Contour, near: f64) -> split::Split {
    let mut overruns = Vec::new();
    let mut line = overruns::trim(line, near, &mut overruns);
    if !overruns.is_empty() {
        canonical::normalise(&mut line.points);
    }
    let mut split = split::at_repeated_vertices(line);
    split.spikes.extend(overruns);
    split
}
