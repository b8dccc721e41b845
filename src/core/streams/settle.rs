//! From lines to streams with heights, in agreement with the contours.

use glam::DVec2;

use super::beside::{Beside, beside};
use super::descend::{Detour, Ground, Piece, Vertex, descending};
use super::direction::flows_back;
use super::elsewhere::{Compared, elsewhere};
use super::follow::follow;
use super::line::{Stream, StreamLine, Streams};
use super::middle::with_middle_lines;
use super::network::{Network, Reach};
use super::parting::partings;
use super::profile::{Edge, Profiles, profiles};
use super::shift::{moved, shifts};
use crate::base::error::{Finding, FindingKind};
use crate::base::{Sure, parallel};
use crate::contour::ContourMap;
use crate::skeleton::Heights;
use crate::subdomains::{Course, band_of};
use crate::subdomains::{Regions, line_starts};
use crate::tin::{NONE, Tin};
use crate::tuning::StreamTuning;

/// Reaches per parallel task. The search for the first triangle starts anew with each task.
const CHUNK: usize = 64;

/// A smaller share of a line is a rounding error.
const ROUNDING: f64 = 1e-9;

/// Streams that agree with the contours, and what had to be done for it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Settled {
    /// The pieces that are used, each after those that flow into it.
    pub streams: Vec<Stream>,
    /// What was turned, moved, cut or left out.
    pub findings: Vec<Finding>,
}

/// Brings streams into agreement with a map and its triangulation. The middle lines of river areas that no stream runs
/// through are streams too. `by_distance` gives heights by equation (1). `spacing` is the mean spacing of the
/// contours; a stream moves by at most `tolerance`.
/// Heights that are less sure than `known_from` are the mean of the curve along the stream and of the ground beside it.
pub(crate) fn settle(
    streams: &Streams,
    (map, tin, regions): (&ContourMap, &Tin, &Regions),
    by_distance: &Heights<'_>,
    (spacing, tolerance): (f64, f64),
    known_from: Sure,
    tuning: &StreamTuning,
) -> Settled {
    let snap = tuning.snap * spacing;
    let (lines, mut findings) = with_middle_lines(streams, snap);
    let starts = line_starts(map);
    let ground = Ground { map, tin, regions, starts: &starts };
    let local = |line: &StreamLine| StreamLine {
        points: line.points.iter().map(|p| *p - tin.origin).collect(),
        feature: line.feature,
    };
    let lines: Vec<StreamLine> = lines.iter().map(local).collect();
    let Network { nodes, reaches, left_out } = Network::new(&lines, snap);

    let courses = courses(&ground, &reaches, |_| None);
    let heights = node_heights(by_distance, &reaches, &courses, nodes);
    let back = flows_back(&reaches, &courses, regions, &heights);
    let turned: Vec<Reach> =
        reaches.into_iter().zip(&back).map(|(r, &back)| if back { r.reversed() } else { r }).collect();
    let before = self::courses(&ground, &turned, |r| (!back[r]).then(|| courses[r].clone()));
    let shifts: Vec<_> =
        parallel::map(turned.len(), |r| shifts(&ground, &turned[r].points, &before[r], tolerance, tuning));
    let beside: Vec<Option<Beside>> = parallel::map(turned.len(), |r| {
        beside(&ground, &turned[r].points, &before[r], (tolerance, &shifts[r]), tuning)
    });
    let reaches = moved(&turned, nodes, &shifts);
    let courses =
        self::courses(&ground, &reaches, |r| (reaches[r].points == turned[r].points).then(|| before[r].clone()));

    let found: Vec<(Vec<Piece>, Vec<Detour>)> =
        parallel::map(reaches.len(), |r| descending(&ground, &reaches[r].points, &courses[r], tolerance));
    let compared = (0..reaches.len()).map(|r| Compared { course: &before[r], beside: beside[r], detours: &found[r].1 });
    // Without a tolerance, streams are taken where they are.
    let elsewhere = (tolerance > 0.0).then(|| elsewhere(compared, tuning)).flatten();
    findings.extend(partings(&reaches, nodes, &lines, tin.origin));
    let mut edges = Vec::new();
    let mut reach_of = Vec::new();
    let mut shift_of: Vec<f64> = shifts.iter().map(|s| s.iter().map(|s| s.by.length()).fold(0.0, f64::max)).collect();
    for (r, (pieces, detours)) in found.into_iter().enumerate() {
        for detour in detours {
            let feature = lines[reaches[r].line].feature;
            match detour {
                Detour::Moved(by) => shift_of[r] = shift_of[r].max(by),
                Detour::Cut { place, level, length } => {
                    findings.push(cut_finding(place + tin.origin, level, length).of_feature(feature));
                }
            }
        }
        for mut piece in pieces {
            densify(&mut piece.vertices, spacing / tuning.vertices_per_spacing);
            let nodes = [0, 1].map(|k| piece.at_nodes[k].then_some(reaches[r].nodes[k]));
            let bands = piece.regions.map(|region| band_of(regions, region));
            edges.push(Edge { piece, nodes, guesses: [f64::NAN; 2], bands });
            reach_of.push(r);
        }
    }
    guess_ends(by_distance, &mut edges);
    let Profiles { mut heights, mut sure, orders, downstream } = profiles(&edges, nodes, tuning.sure_reach * spacing);
    let used = UsedLines {
        lines: &lines,
        reaches: &reaches,
        courses: &courses,
        back: &back,
        shift_of: &shift_of,
        beside: &beside,
    };
    findings.extend(used.findings(&reach_of, &left_out, tin.origin));
    let mut stream = |e: usize| {
        let (vertices, r) = (&edges[e].piece.vertices, reach_of[e]);
        let heights = std::mem::take(&mut heights[e]);
        Stream {
            points: vertices.iter().zip(heights).map(|(v, z)| (v.place + tin.origin).extend(z)).collect(),
            sure: std::mem::take(&mut sure[e]),
            bands: vertices.iter().map(|v| band_of(regions, v.region)).collect(),
            feature: lines[reaches[r].line].feature,
            order: orders[e],
            shift: shift_of[r],
            turned: back[r],
        }
    };
    let mut used: Vec<Stream> = downstream.iter().map(|&e| stream(e)).collect();
    guess_between(by_distance, &downstream.iter().map(|&e| &edges[e]).collect::<Vec<_>>(), &mut used, known_from);
    // What is said about each of them is no help then.
    Settled { streams: used, findings: elsewhere.map_or(findings, |one| vec![one]) }
}

/// The courses of reaches, in their order. `known` gives those that are known, by the number of the reach.
fn courses(ground: &Ground<'_>, reaches: &[Reach], known: impl Fn(usize) -> Option<Course> + Sync) -> Vec<Course> {
    parallel::flat_map(reaches.len().div_ceil(CHUNK), |chunk| {
        let mut near = 0;
        let new = |r: usize| {
            known(r).unwrap_or_else(|| Course::new(ground.tin, ground.regions, &reaches[r].points, &mut near))
        };
        (chunk * CHUNK..reaches.len().min((chunk + 1) * CHUNK)).map(new).collect::<Vec<_>>()
    })
}

/// Heights of the nodes by equation (1). A node outside the frame has the height where its reach enters the frame.
fn node_heights(by_distance: &Heights<'_>, reaches: &[Reach], courses: &[Course], nodes: usize) -> Vec<f64> {
    let mut places: Vec<Option<(DVec2, u32)>> = vec![None; nodes];
    for (reach, course) in reaches.iter().zip(courses) {
        let inside = |k: &usize| course.stretches[*k].region != NONE;
        let count = course.stretches.len();
        let ends = [(0..count).find(inside), (0..count).rev().find(inside)];
        let last = reach.points.len() - 1;
        for (k, (node, stretch)) in reach.nodes.into_iter().zip(ends).enumerate() {
            let Some(stretch) = stretch else { continue };
            let at_end = stretch == if k == 0 { 0 } else { count - 1 };
            let place = match (at_end, k) {
                (true, 0) => reach.points[0],
                (true, _) => reach.points[last],
                (false, 0) => course.crossings[stretch - 1].place,
                (false, _) => course.crossings[stretch].place,
            };
            if places[node].is_none() || at_end {
                places[node] = Some((place, course.stretches[stretch].region));
            }
        }
    }
    let heights = by_distance.at(&places);
    heights.into_iter().map(|z| if z.is_nan() { f64::INFINITY } else { z }).collect()
}

/// Heights of the ends of pieces that have none.
fn guess_ends(by_distance: &Heights<'_>, edges: &mut [Edge]) {
    let end = |edge: &Edge, k: usize| {
        let vertex = if k == 0 { edge.piece.vertices.first() } else { edge.piece.vertices.last() };
        let region = edge.piece.regions[k];
        vertex.filter(|v| v.height.is_none() && region != NONE).map(|v| (v.place, region))
    };
    let places: Vec<_> = edges.iter().flat_map(|edge| [end(edge, 0), end(edge, 1)]).collect();
    let heights = by_distance.at(&places);
    for (edge, heights) in edges.iter_mut().zip(heights.as_chunks::<2>().0) {
        edge.guesses = *heights;
    }
}

/// Heights of the vertices of streams that are less sure than `known_from`: the mean of the curve along the stream and of
/// equation (1). One knows the slope of the stream, the other the ground beside it.
fn guess_between(by_distance: &Heights<'_>, edges: &[&Edge], streams: &mut [Stream], known_from: Sure) {
    let is_guessed = |stream: &Stream, k: usize| stream.sure[k] < known_from;
    let mut places = Vec::new();
    for (edge, stream) in edges.iter().zip(&*streams) {
        let vertices =
            edge.piece.vertices.iter().enumerate().filter(|(k, v)| is_guessed(stream, *k) && v.region != NONE);
        places.extend(vertices.map(|(_, v)| Some((v.place, v.region))));
    }
    let mut heights = by_distance.at(&places).into_iter();
    for (edge, stream) in edges.iter().zip(&mut *streams) {
        for (k, v) in edge.piece.vertices.iter().enumerate() {
            if is_guessed(stream, k) && v.region != NONE {
                let z = &mut stream.points[k].z;
                *z = heights.next().filter(|z| z.is_finite()).map_or(*z, |other| z.midpoint(other));
            }
        }
    }
    follow(streams, |p| p.z);
}

/// Adds vertices until neighbours are at most `step` apart, map units.
fn densify(vertices: &mut Vec<Vertex>, step: f64) {
    let mut out: Vec<Vertex> = Vec::with_capacity(vertices.len());
    for w in vertices.windows(2) {
        out.push(w[0]);
        let parts = (w[0].place.distance(w[1].place) / step).ceil().max(1.0) as usize;
        let between = (1..parts).map(|k| w[0].place.lerp(w[1].place, k as f64 / parts as f64));
        // A crossing belongs to both sub-domains. Between two vertices, the lower one does not matter.
        let region = w[1].region;
        out.extend(between.map(|place| Vertex { place, height: None, region }));
    }
    out.extend(vertices.last().copied());
    *vertices = out;
}

/// The finding about a piece that was cut out.
fn cut_finding(place: DVec2, level: Option<f64>, length: f64) -> Finding {
    let where_to = level.map_or("upwards".into(), |level| format!("up across the contour {level} m"));
    let message = format!("the stream runs {where_to}; this piece, {length:.1} map units long, is left out");
    Finding::at(FindingKind::StreamCut, place, message).of_elevations(level)
}

/// The lines and what was made of them.
struct UsedLines<'a> {
    lines: &'a [StreamLine],
    reaches: &'a [Reach],
    courses: &'a [Course],
    /// By reach: whether it was turned, and how far it was moved.
    back: &'a [bool],
    shift_of: &'a [f64],
    /// By reach: whether it runs beside the bends of contours.
    beside: &'a [Option<Beside>],
}

/// What was made of one line.
#[derive(Clone, Copy, Default)]
struct LineState {
    /// Number of pieces that are used.
    used: usize,
    /// Length that was turned and that was not, and length outside the frame, map units.
    turned: f64,
    kept: f64,
    outside: f64,
    /// The largest shift, and where it is.
    shift: f64,
    moved: DVec2,
    /// Length beside the bends of contours, the largest distance from them if it is known, and where it is.
    beside: f64,
    off: f64,
    aside: DVec2,
}

impl UsedLines<'_> {
    /// What was done to whole lines. `reach_of` gives the reach of each piece that is used, `left_out` the length of the
    /// loops and copies of each line.
    fn findings(&self, reach_of: &[usize], left_out: &[f64], origin: DVec2) -> Vec<Finding> {
        let mut all = vec![LineState::default(); self.lines.len()];
        for (r, reach) in self.reaches.iter().enumerate() {
            let line = &mut all[reach.line];
            *(if self.back[r] { &mut line.turned } else { &mut line.kept }) += reach.length();
            let outside = self.courses[r].stretches.iter().filter(|s| s.region == NONE);
            line.outside += outside.map(|s| s.to - s.from).sum::<f64>();
            if let Some(beside) = self.beside[r] {
                let off = if let Beside::Tips(off) = beside { off } else { 0.0 };
                if line.beside == 0.0 || off > line.off {
                    (line.off, line.aside) = (off, reach.points[reach.points.len() / 2]);
                }
                line.beside += reach.length();
            }
            if self.shift_of[r] > line.shift {
                (line.shift, line.moved) = (self.shift_of[r], reach.points[reach.points.len() / 2]);
            }
        }
        reach_of.iter().for_each(|&r| all[self.reaches[r].line].used += 1);
        let mut found = Vec::new();
        for ((line, state), &left_out) in self.lines.iter().zip(all).zip(left_out) {
            let start = line.points.first().copied().unwrap_or_default();
            let mut note = |kind, place: DVec2, message: String| {
                found.push(Finding::at(kind, place + origin, message).of_feature(line.feature));
            };
            if left_out > 0.0 || state.turned + state.kept == 0.0 {
                let message = format!("{left_out:.1} map units of the stream are a loop or a copy of another stream");
                note(FindingKind::StreamLeftOut, start, message);
            }
            // A line that ends on the frame may lie outside by a rounding error.
            if state.outside > ROUNDING * (state.turned + state.kept) {
                let message = format!("{:.1} map units of the stream lie outside the frame", state.outside);
                note(FindingKind::StreamOutside, start, message);
            }
            if state.used > 0 && state.turned > state.kept {
                note(FindingKind::StreamTurned, start, "the stream is drawn upstream; it is turned".into());
            }
            if state.used > 0 && 2.0 * state.beside > state.turned + state.kept {
                let message = if state.off > 0.0 {
                    let off = state.off;
                    format!(
                        "the stream runs about {off:.1} map units beside the bends of contours, more than it may be moved"
                    )
                } else {
                    "the stream crosses the contours on slopes, not in their bends".into()
                };
                note(FindingKind::StreamBeside, state.aside, message);
            }
            if state.used > 0 && state.shift > 0.0 {
                let message =
                    format!("the stream is moved by up to {:.1} map units into bends of contours", state.shift);
                note(FindingKind::StreamMoved, state.moved, message);
            }
        }
        found
    }
}
