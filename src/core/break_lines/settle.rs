//! Brings break lines into agreement with the contours.

use glam::DVec2;

use super::line::{BreakLine, FittedBreakLine};
use crate::base::error::{Finding, FindingKind};
use crate::base::{Sure, parallel};
use crate::skeleton::Heights;
use crate::subdomains::{Band, Course, Regions, band_of};
use crate::tin::Tin;
use crate::tuning::BreakLineTuning;

/// Lines per parallel task. The search for the first triangle starts anew with each task.
const CHUNK: usize = 64;
/// A shorter piece is a rounding error, in spacings: such lines end on the frame.
const ROUNDING: f64 = 1e-3;

/// Break lines that agree with the contours, and what had to be done for it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Settled {
    pub break_lines: Vec<FittedBreakLine>,
    pub findings: Vec<Finding>,
}

/// Brings break lines whose heights are this `sure` into agreement with a triangulated map. `interval` (metres) and
/// `spacing` (map units) are those of its contours.
pub(crate) fn settle(
    (lines, sure): (&[BreakLine], Sure),
    (tin, regions): (&Tin, &Regions),
    by_distance: &Heights<'_>,
    interval: f64,
    spacing: f64,
    tuning: &BreakLineTuning,
) -> Settled {
    let of_chunk = |lines: &[BreakLine]| {
        let mut near = 0;
        lines.iter().map(|line| Cut::new(line, (tin, regions), spacing, tuning, &mut near)).collect::<Vec<_>>()
    };
    let chunks: Vec<&[BreakLine]> = lines.chunks(CHUNK).collect();
    let cut: Vec<Cut> = parallel::flat_map_each(&chunks, |lines| of_chunk(lines));
    let places: Vec<Option<(DVec2, u32)>> = cut
        .iter()
        .flat_map(|cut| cut.pieces.iter().flatten())
        .map(|v| v.height().is_none().then_some((v.place, v.region)))
        .collect();
    let mut guesses = by_distance.at(&places).into_iter();
    let name = if sure == Sure::Surveyed { "the break line" } else { "the banks of the river area" };
    let mut settled = Settled::default();
    for (line, cut) in lines.iter().zip(cut) {
        let mut conflict = Conflict::default();
        for piece in cut.pieces {
            let mut break_line = FittedBreakLine {
                points: Vec::with_capacity(piece.len()),
                sure: Vec::with_capacity(piece.len()),
                bands: Vec::with_capacity(piece.len()),
                bend: line.bend,
                feature: line.feature,
            };
            let mut before: Option<DVec2> = None;
            for v in &piece {
                let band = band_of(regions, v.region);
                let guess = guesses.next().unwrap_or(f64::NAN);
                let off = v.contradiction(band) / interval;
                if off.abs() > tuning.told {
                    conflict.add(off, v.place, before.map_or(0.0, |b| b.distance(v.place)));
                }
                before = Some(v.place);
                let (z, sure) = match (v.level, v.own) {
                    (Some(level), _) => (level, Sure::Exact),
                    (None, Some(own)) if off.abs() <= tuning.wrong => (band.strictly_inside(own), sure),
                    // Heights that contradict the contours that much are those of something else.
                    (None, Some(own)) => (band.strictly_inside(own), Sure::Guessed),
                    (None, None) => (band.strictly_inside(guess), Sure::Guessed),
                };
                break_line.points.push((v.place + tin.origin).extend(z));
                break_line.sure.push(sure);
                break_line.bands.push(band);
            }
            settled.break_lines.push(break_line);
        }
        settled.findings.extend(conflict.finding(line, name, interval, tin.origin));
        if cut.outside > ROUNDING * spacing {
            let message = format!("{:.1} map units of {name} lie outside the frame or in water", cut.outside);
            let place = line.points.first().copied().unwrap_or_default();
            settled.findings.push(Finding::at(FindingKind::BreakLineOutside, place, message).of_feature(line.feature));
        }
    }
    settled
}

/// A vertex of a piece.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    /// Position relative to the origin of the triangulation.
    place: DVec2,
    /// The height that the line gives, metres.
    own: Option<f64>,
    /// The level of the contour that is crossed here.
    level: Option<f64>,
    region: u32,
}

impl Vertex {
    fn height(&self) -> Option<f64> {
        self.level.or(self.own)
    }

    /// By how much the height of the line is above (positive) or below what the contours allow, metres.
    fn contradiction(&self, band: Band) -> f64 {
        let Some(own) = self.own else { return 0.0 };
        let [lo, hi] = self.level.map_or([band.lo, band.hi], |level| [level; 2]);
        (own - hi).max(0.0) + (own - lo).min(0.0)
    }
}

/// A line, cut into pieces on ground.
struct Cut {
    pieces: Vec<Vec<Vertex>>,
    /// Length outside the frame or in water, map units.
    outside: f64,
}

impl Cut {
    /// `near` is the triangle where the search for the first one starts.
    fn new(
        line: &BreakLine,
        (tin, regions): (&Tin, &Regions),
        spacing: f64,
        tuning: &BreakLineTuning,
        near: &mut u32,
    ) -> Self {
        let points: Vec<DVec2> = line.points.iter().map(|p| *p - tin.origin).collect();
        let course = Course::new(tin, regions, &points, near);
        let mut at = vec![0.0];
        for w in points.windows(2) {
            at.push(at[at.len() - 1] + w[0].distance(w[1]));
        }
        let own = |k: usize| line.heights.get(k).copied().filter(|z| z.is_finite());
        let own_at = |s: f64| {
            let k = at.partition_point(|a| *a <= s).clamp(1, at.len() - 1);
            let share = if at[k] > at[k - 1] { ((s - at[k - 1]) / (at[k] - at[k - 1])).clamp(0.0, 1.0) } else { 0.0 };
            Some(own(k - 1)? * (1.0 - share) + own(k)? * share)
        };
        let mut cut = Self { pieces: Vec::new(), outside: 0.0 };
        let mut piece: Vec<Vertex> = Vec::new();
        let mut next = 0;
        for (k, stretch) in course.stretches.iter().enumerate() {
            let first = next;
            let is_last = k + 1 == course.stretches.len();
            next += at[first..].iter().take_while(|a| is_last || **a <= stretch.to).count();
            let region = regions.regions.get(stretch.region as usize);
            if region.is_none_or(|region| region.water.is_some()) {
                cut.outside += stretch.to - stretch.from;
                cut.push(std::mem::take(&mut piece));
                continue;
            }
            let crossing = |c: usize| {
                let crossing = course.crossings[c];
                let band = |k: usize| band_of(regions, course.stretches[k].region);
                // A contour that ends in the open may be crossed inside one sub-domain. Heights beside it are inside the
                // band, so a level at the edge of the band would be a step.
                let fits = |level: f64| band(c) != band(c + 1) || level < band(c).hi && level > band(c).lo;
                let level = crossing.level.filter(|level| fits(*level));
                Vertex { place: crossing.place, own: own_at(crossing.at), level, region: stretch.region }
            };
            if piece.is_empty() && k > 0 {
                piece.push(crossing(k - 1));
            }
            let inner = (first..next).filter(|&i| at[i] > stretch.from || k == 0);
            piece.extend(inner.map(|i| Vertex { place: points[i], own: own(i), level: None, region: stretch.region }));
            if !is_last {
                piece.push(crossing(k));
            }
        }
        cut.push(piece);
        cut.pieces.iter_mut().for_each(|piece| densify(piece, spacing / tuning.vertices_per_spacing));
        cut
    }

    fn push(&mut self, mut piece: Vec<Vertex>) {
        // Of a vertex on a contour and the crossing there, the crossing counts.
        piece.dedup_by(|b, a| {
            let is_same = a.place == b.place;
            if is_same && a.level.is_none() {
                *a = *b;
            }
            is_same
        });
        if piece.len() > 1 {
            self.pieces.push(piece);
        }
    }
}

/// Adds vertices until neighbours are at most `step` apart, map units.
fn densify(vertices: &mut Vec<Vertex>, step: f64) {
    let mut out: Vec<Vertex> = Vec::with_capacity(vertices.len());
    for w in vertices.windows(2) {
        out.push(w[0]);
        let parts = (w[0].place.distance(w[1].place) / step).ceil().max(1.0) as usize;
        out.extend((1..parts).map(|k| {
            let share = k as f64 / parts as f64;
            let own = w[0].own.zip(w[1].own).map(|(a, b)| a + share * (b - a));
            // A crossing belongs to the sub-domain before it.
            Vertex { place: w[0].place.lerp(w[1].place, share), own, level: None, region: w[1].region }
        }));
    }
    out.extend(vertices.last().copied());
    *vertices = out;
}

/// Heights of a line that contradict the contours.
#[derive(Default)]
struct Conflict {
    /// Length of the line that does, map units.
    length: f64,
    /// The largest contradiction, intervals, and its place.
    largest: f64,
    place: DVec2,
}

impl Conflict {
    fn add(&mut self, off: f64, place: DVec2, length: f64) {
        self.length += length;
        if off.abs() > self.largest.abs() {
            (self.largest, self.place) = (off, place);
        }
    }

    /// `name` is what a message calls the line.
    fn finding(&self, line: &BreakLine, name: &str, interval: f64, origin: DVec2) -> Option<Finding> {
        if self.largest == 0.0 {
            return None;
        }
        let side = if self.largest > 0.0 { "above" } else { "below" };
        let message = format!(
            "the heights of {name} lie up to {:.2} m {side} those that the contours allow, on {:.1} map units; \
             the contours win",
            (self.largest * interval).abs(),
            self.length
        );
        let finding = Finding::at(FindingKind::BreakLineConflict, self.place + origin, message);
        Some(finding.of_feature(line.feature))
    }
}
