//! Plans where points are added. No point is made before the plan is complete, so that too many can be refused.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec2;

use super::params::SampleParams;
use crate::base::error::{Error, Result};
use crate::base::parallel;
use crate::clean::{Runs, Segments};
use crate::contour::Contour;

/// Largest piece that is split into equal parts without further distances, as a share of the distance to other
/// contours.
const SHORT: f64 = 0.25;
/// About this many vertices are used for the median distance to other contours.
const MEDIAN_OF: usize = 50_000;
/// The lower limit as a share of the usual spacing, if none is given.
const LEAST_SHARE: f64 = 1.0 / 16.0;
/// The lower limit is at least this share of the largest coordinate, so that pieces are much longer than rounding
/// errors.
const LEAST_OF_COORDINATE: f64 = 1e-13;
/// It is also at least this share of the map's size, for maps without a useful median.
const LEAST_OF_SIZE: f64 = 1e-7;

/// More points than this are always refused: vertices are numbered in 32 bits.
const MOST: usize = u32::MAX as usize;

/// A point to add.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cut {
    /// Number of the segment on its line.
    pub(crate) segment: u32,
    /// Share of the segment's length before the point.
    pub(crate) share: f64,
}

/// Points to add to each line, in order along it.
pub(crate) struct Plan {
    pub(crate) cuts: Vec<Vec<Cut>>,
    /// The lower limit that was used.
    pub(crate) least: f64,
    /// Pieces that remain longer than the ratio asks.
    pub(crate) held: usize,
}

/// Plans the sampling of clean lines.
pub(crate) fn plan(lines: &[Contour], params: &SampleParams) -> Result<Plan> {
    let runs = Segments::new(lines)?.runs();
    let least = lower_limit(lines, &runs, params);
    let most = params.most.min(MOST);
    let shared = Shared { lines, runs: &runs, ratio: params.ratio, least, most, added: AtomicUsize::new(0) };
    let (cuts, held): (Vec<Vec<Cut>>, Vec<usize>) = parallel::map(lines.len(), |line| {
        let mut walk = Walk { shared: &shared, line: line as u32, cuts: Vec::new(), held: 0 };
        walk.line();
        (walk.cuts, walk.held)
    })
    .into_iter()
    .unzip();
    if shared.added.into_inner() > most {
        return Err(Error::TooManyPoints { ratio: params.ratio, most });
    }
    Ok(Plan { cuts, least, held: held.into_iter().sum() })
}

/// The lower limit: as given, otherwise from the usual distance between contours. It is never so small that rounding
/// matters.
fn lower_limit(lines: &[Contour], runs: &Runs, params: &SampleParams) -> f64 {
    let vertices = || (0u32..).zip(lines).flat_map(|(line, c)| c.points.iter().map(move |&p| (line, p)));
    let largest = vertices().map(|(_, p)| p.abs().max_element()).fold(0.0, f64::max);
    let floor = largest * LEAST_OF_COORDINATE;
    if let Some(least) = params.least {
        return least.max(floor);
    }
    let count: usize = lines.iter().map(|c| c.points.len()).sum();
    let some: Vec<(u32, DVec2)> = vertices().step_by(count / MEDIAN_OF + 1).collect();
    let mut distances: Vec<f64> = parallel::map_each(&some, |&(line, p)| runs.distance_to_others(lines, p, line));
    distances.retain(|d| d.is_finite());
    distances.sort_unstable_by(f64::total_cmp);
    let usual = distances.get(distances.len() / 2).copied().unwrap_or(0.0) * params.ratio;
    let (low, high) =
        vertices().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), (_, p)| (low.min(p), high.max(p)));
    let size = if low.x <= high.x { low.distance(high) } else { 0.0 };
    (usual * LEAST_SHARE).max(size * LEAST_OF_SIZE * params.ratio).max(floor)
}

/// What all lines share.
struct Shared<'a> {
    lines: &'a [Contour],
    runs: &'a Runs,
    ratio: f64,
    least: f64,
    most: usize,
    added: AtomicUsize,
}

/// The plan of one line, while it is made.
struct Walk<'a> {
    shared: &'a Shared<'a>,
    line: u32,
    cuts: Vec<Cut>,
    held: usize,
}

/// A position on a segment, and its distance to the nearest other contour.
#[derive(Clone, Copy)]
struct Probe {
    share: f64,
    distance: f64,
}

/// A whole segment of the line.
#[derive(Clone, Copy)]
struct WholeSegment {
    number: u32,
    a: DVec2,
    b: DVec2,
    length: f64,
}

impl Walk<'_> {
    fn distance(&self, p: DVec2) -> f64 {
        self.shared.runs.distance_to_others(self.shared.lines, p, self.line)
    }

    fn line(&mut self) {
        let shared = self.shared;
        let points = &shared.lines[self.line as usize].points;
        // The last distance gives a lower bound of the distances nearby, so most vertices need no search.
        let mut last = (points[0], self.distance(points[0]));
        let at_least = |last: (DVec2, f64), p: DVec2| last.1 - last.0.distance(p);
        for (number, w) in (0u32..).zip(points.windows(2)) {
            let (a, b) = (w[0], w[1]);
            let length = a.distance(b);
            let enough = |last| length <= shared.ratio * at_least(last, a).min(at_least(last, b));
            if enough(last) {
                continue;
            }
            if last.0 != a {
                last = (a, self.distance(a));
                if enough(last) {
                    continue;
                }
            }
            let from = Probe { share: 0.0, distance: last.1 };
            last = (b, self.distance(b));
            self.piece(WholeSegment { number, a, b, length }, from, Probe { share: 1.0, distance: last.1 });
            if shared.added.load(Ordering::Relaxed) > shared.most {
                return;
            }
        }
    }

    /// Plans a piece of a segment: the points strictly inside it.
    fn piece(&mut self, whole: WholeSegment, from: Probe, to: Probe) {
        let Shared { ratio, least, .. } = *self.shared;
        let length = whole.length * (to.share - from.share);
        let nearest = from.distance.min(to.distance);
        if length <= ratio * nearest {
            return;
        }
        if length < 2.0 * least {
            self.held += 1;
            return;
        }
        if length <= SHORT * nearest {
            // Inside the piece, the distance is nowhere smaller than this.
            let wanted = ratio * (from.distance + to.distance - length) / 2.0;
            let parts = (length / wanted).ceil().min((length / least).floor());
            let count = parts as usize - 1;
            if self.add(count) {
                let step = (to.share - from.share) / parts;
                let cut = |k: usize| Cut { segment: whole.number, share: from.share + step * k as f64 };
                self.cuts.extend((1..=count).map(cut));
                self.held += if length / parts > wanted { count + 1 } else { 0 };
            }
            return;
        }
        if !self.add(1) {
            return;
        }
        let share = from.share.midpoint(to.share);
        let middle = Probe { share, distance: self.distance(on_segment(whole.a, whole.b, share)) };
        self.piece(whole, from, middle);
        self.cuts.push(Cut { segment: whole.number, share });
        self.piece(whole, middle, to);
    }

    /// Counts added points. Returns whether there are still few enough to go on.
    fn add(&self, count: usize) -> bool {
        // Never so much at once that the sum could overflow.
        let count = count.min(self.shared.most + 1);
        self.shared.added.fetch_add(count, Ordering::Relaxed) + count <= self.shared.most
    }
}

/// The position at a share of a segment. If the share is a multiple of a power of two, the position is the same to the
/// last bit for both directions of the segment.
pub(super) fn on_segment(a: DVec2, b: DVec2, share: f64) -> DVec2 {
    if share <= 0.5 { a + (b - a) * share } else { b + (a - b) * (1.0 - share) }
}
