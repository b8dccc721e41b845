//! Pairs of segments that meet where they must not.
//!
//! A tree finds runs of segments whose boxes meet. The pairs of segments within these runs are then tested exactly.
//! Time grows with the number of segments, and with the number of pairs whose rotated boxes meet.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::canonical::is_closed;
use super::segments::{Run, Runs, Segments};
use crate::base::error::{Error, Result};
use crate::contour::Contour;
use crate::geometry::{Bounds, Segment};
use crate::geometry::{Meeting, distance, meeting};

/// This many meeting pairs are always accepted.
const PAIRS: usize = 10_000_000;
/// Meeting pairs per segment that are accepted on large maps.
const PAIRS_PER_SEGMENT: usize = 20;

/// How two segments relate to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Contact {
    /// Nothing.
    None,
    /// Two lines of one level touch at a point: allowed.
    Allowed,
    /// A line touches or overlaps itself. It needs a vertex there, where it is split.
    Own,
    /// One of the two must be removed.
    Conflict,
}

/// Pairs of segments, the smaller number first, sorted.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Contacts {
    /// Pairs within one line that touch or overlap.
    pub(super) own: Vec<(u32, u32)>,
    /// Pairs of which one segment must be removed.
    pub(super) conflicts: Vec<(u32, u32)>,
}

impl Contacts {
    /// All pairs.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, u32)> {
        self.own.iter().chain(&self.conflicts).copied()
    }
}

/// A segment and its place in the map.
#[derive(Clone, Copy)]
pub(super) struct Placed<'a> {
    pub(super) segment: Segment,
    pub(super) contour: &'a Contour,
    /// Number of the line.
    pub(super) line: u32,
    /// Number of the segment on its line.
    pub(super) number: usize,
}

/// Decides how two segments relate.
///
/// Lines of different level may not come closer than `separation`. Lines of one level may not cross, but two of them
/// may touch at a point. Successive segments of one line share only their common vertex. Its other segments share
/// nothing.
pub(super) fn contact(s: &Placed, t: &Placed, separation: f64) -> Contact {
    let meeting = meeting(&s.segment, &t.segment);
    if s.contour.elevation != t.contour.elevation {
        let near = separation > 0.0 && distance(&s.segment, &t.segment) < separation;
        return if near || meeting != Meeting::Apart { Contact::Conflict } else { Contact::None };
    }
    match (meeting, s.line == t.line) {
        (Meeting::Apart, _) => Contact::None,
        (Meeting::Cross, _) | (Meeting::Overlap, false) => Contact::Conflict,
        (Meeting::Touch, false) => Contact::Allowed,
        (Meeting::Touch, true) if are_successive(s.contour, s.number, t.number) => Contact::None,
        (Meeting::Touch | Meeting::Overlap, true) => Contact::Own,
    }
}

fn are_successive(contour: &Contour, i: usize, j: usize) -> bool {
    let last = contour.points.len() - 2;
    i.abs_diff(j) == 1 || (i.abs_diff(j) == last && is_closed(&contour.points))
}

/// Finds all pairs that meet where they must not.
///
/// # Errors
/// [`Error::Data`] if so many pairs meet that the lines cannot be contours. This limits time and memory.
pub(super) fn find(segments: &Segments, separation: f64) -> Result<Contacts> {
    let runs = segments.runs();
    let limit = PAIRS.max(segments.len().saturating_mul(PAIRS_PER_SEGMENT));
    let met = AtomicUsize::new(0);
    let mut found = (0..runs.runs.len() as u32)
        .into_par_iter()
        .fold(Contacts::default, |mut found, i| {
            if met.load(Ordering::Relaxed) <= limit {
                met.fetch_add(contacts_of_run(segments, &runs, i, separation, &mut found), Ordering::Relaxed);
            }
            found
        })
        .reduce(Contacts::default, |mut a, mut b| {
            a.own.append(&mut b.own);
            a.conflicts.append(&mut b.conflicts);
            a
        });
    if met.into_inner() > limit {
        return Err(Error::Data(format!(
            "the lines meet each other in more than {limit} places; these do not look like contour lines: check that the \
             right layer and elevation field are read"
        )));
    }
    found.own.par_sort_unstable();
    found.conflicts.par_sort_unstable();
    Ok(found)
}

/// Adds the contacts of a run's segments with each other and with those of later runs. Returns the number of pairs that
/// meet.
fn contacts_of_run(segments: &Segments, runs: &Runs, i: u32, separation: f64, found: &mut Contacts) -> usize {
    let run = &runs.runs[i as usize];
    // Wider than necessary, so that the rounding of boxes has no effect.
    let margin = 2.0 * separation;
    let reach = run.bounds.grown(margin);
    let mut met = 0;
    let mut test = |s: Placed, t: Placed| {
        let contact = contact(&s, &t, separation);
        met += usize::from(contact != Contact::None);
        let id = |p: &Placed| segments.start(p.line) + p.number as u32;
        let pair = (id(&s).min(id(&t)), id(&s).max(id(&t)));
        match contact {
            Contact::None | Contact::Allowed => (),
            Contact::Own => found.own.push(pair),
            Contact::Conflict => found.conflicts.push(pair),
        }
    };
    for s in placed(segments, run) {
        let near = s.segment.bounds().grown(margin);
        for t in placed(segments, run).skip(s.number + 1 - run.from as usize) {
            if near.meets(&t.segment.bounds()) {
                test(s, t);
            }
        }
    }
    for j in runs.near_run(segments.lines(), run, margin).filter(|&j| j > i) {
        let other = &runs.runs[j as usize];
        let shared = overlap(&reach, &other.bounds.grown(margin));
        for s in placed(segments, run) {
            let near = s.segment.bounds().grown(margin);
            if !near.meets(&shared) {
                continue;
            }
            for t in placed(segments, other) {
                if near.meets(&t.segment.bounds()) {
                    test(s, t);
                }
            }
        }
    }
    met
}

fn placed<'a>(segments: &Segments<'a>, run: &Run) -> impl Iterator<Item = Placed<'a>> + use<'a> {
    let (line, contour) = (run.line, &segments.lines()[run.line as usize]);
    (run.from as usize..run.to as usize).map(move |number| Placed {
        segment: Segment { a: contour.points[number], b: contour.points[number + 1] },
        contour,
        line,
        number,
    })
}

fn overlap(a: &Bounds, b: &Bounds) -> Bounds {
    Bounds { min: a.min.max(b.min), max: a.max.min(b.max) }
}
