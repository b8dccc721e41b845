//! From lines to streams with heights, in agreement with the contours.

use glam::DVec2;
use rayon::prelude::*;

use super::course::{Course, band_of};
use super::descend::{Detour, Ground, Piece, Vertex, descending};
use super::direction::flows_back;
use super::follow::follow;
use super::line::{Stream, StreamLine, Streams, Sure};
use super::network::{Network, Reach};
use super::profile::{Edge, Profiles, profiles};
use super::shift::{moved, shifts};
use crate::base::error::{Finding, FindingKind};
use crate::contour::ContourMap;
use crate::skeleton::{AxisPoint, axis_heights};
use crate::subdomains::{Regions, line_starts};
use crate::tin::{NONE, Tin};
use crate::tuning::{SkeletonTuning, StreamTuning};

/// Reaches per parallel task. The search for the first triangle starts anew with each task.
const CHUNK: usize = 64;

/// Streams that agree with the contours, and what had to be done for it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Settled {
    /// The pieces that are used, each after those that flow into it.
    pub streams: Vec<Stream>,
    /// What was turned, moved, cut or left out.
    pub findings: Vec<Finding>,
}

/// Brings streams into agreement with a map and its triangulation. `spacing` is the mean spacing of the contours.
pub(crate) fn settle(
    streams: &Streams,
    (map, tin, regions): (&ContourMap, &Tin, &Regions),
    spacing: f64,
    tuning: &StreamTuning,
) -> Settled {
    let mut findings = Vec::new();
    let starts = line_starts(map);
    let ground = Ground { map, tin, regions, starts: &starts };
    let tolerance = streams.tolerance.unwrap_or(tuning.tolerance * spacing);
    let local = |line: &StreamLine| StreamLine {
        points: line.points.iter().map(|p| *p - tin.origin).collect(),
        feature: line.feature,
    };
    let lines: Vec<StreamLine> = streams.lines.iter().map(local).collect();
    let Network { nodes, reaches } = Network::new(&lines, tuning.snap * spacing);

    let courses = courses(&ground, &reaches);
    let heights = node_heights(&ground, &reaches, &courses, nodes);
    let back = flows_back(&reaches, &courses, regions, &heights);
    let turned: Vec<Reach> =
        reaches.into_iter().zip(&back).map(|(r, &back)| if back { r.reversed() } else { r }).collect();
    let before = self::courses(&ground, &turned);
    let each = turned.par_iter().zip(&before);
    let shifts: Vec<_> = each.map(|(r, course)| shifts(&ground, &r.points, course, tolerance, tuning)).collect();
    let reaches = moved(&turned, nodes, &shifts);
    let courses = self::courses(&ground, &reaches);

    let found: Vec<(Vec<Piece>, Vec<Detour>)> = reaches
        .par_iter()
        .zip(&courses)
        .map(|(reach, course)| descending(&ground, &reach.points, course, tolerance))
        .collect();
    let mut edges = Vec::new();
    let mut reach_of = Vec::new();
    let mut shift_of: Vec<f64> = shifts.iter().map(|s| s.iter().map(|s| s.by.length()).fold(0.0, f64::max)).collect();
    for (r, (pieces, detours)) in found.into_iter().enumerate() {
        for detour in detours {
            let feature = lines[reaches[r].line].feature;
            if let Detour::Moved { by, .. } = detour {
                shift_of[r] = shift_of[r].max(by);
            }
            findings.extend(detour_finding(&detour, tin.origin).map(|f| f.of_feature(feature)));
        }
        for mut piece in pieces {
            densify(&mut piece.vertices, spacing / tuning.vertices_per_spacing);
            let nodes = [0, 1].map(|k| piece.at_nodes[k].then_some(reaches[r].nodes[k]));
            let bands = piece.regions.map(|region| band_of(regions, region));
            edges.push(Edge { piece, nodes, guesses: [f64::NAN; 2], bands });
            reach_of.push(r);
        }
    }
    guess_ends(&ground, &mut edges);
    let Profiles { mut heights, mut sure, orders, downstream } = profiles(&edges, nodes, tuning.sure_reach * spacing);
    findings.extend(line_findings(&lines, &reaches, (&back, &shift_of), &reach_of, tin.origin));
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
    guess_between(&ground, &downstream.iter().map(|&e| &edges[e]).collect::<Vec<_>>(), &mut used);
    Settled { streams: used, findings }
}

/// The courses of reaches, in their order.
fn courses(ground: &Ground<'_>, reaches: &[Reach]) -> Vec<Course> {
    let of_chunk = |chunk: &[Reach]| {
        let mut near = 0;
        chunk.iter().map(|r| Course::new(ground.tin, ground.regions, &r.points, &mut near)).collect::<Vec<_>>()
    };
    reaches.par_chunks(CHUNK).flat_map_iter(of_chunk).collect()
}

/// Heights of the nodes by equation (1). A node outside the frame has the height where its reach enters the frame.
fn node_heights(ground: &Ground<'_>, reaches: &[Reach], courses: &[Course], nodes: usize) -> Vec<f64> {
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
    let heights = heights_at(ground, &places);
    heights.into_iter().map(|z| if z.is_nan() { f64::INFINITY } else { z }).collect()
}

/// Heights by equation (1) at places in sub-domains; NaN without a place.
fn heights_at(ground: &Ground<'_>, places: &[Option<(DVec2, u32)>]) -> Vec<f64> {
    let Ground { tin, regions, .. } = ground;
    let mut near = 0;
    let mut points = Vec::new();
    let mut number = Vec::new();
    for (k, (position, region)) in places.iter().enumerate().filter_map(|(k, place)| place.map(|p| (k, p))) {
        if let Ok(triangle) = tin.walk(near, position) {
            near = triangle;
            points.push(AxisPoint { position, level: None, triangle, region });
            number.push(k);
        }
    }
    let mut heights = vec![f64::NAN; places.len()];
    let found = axis_heights(tin, regions, &points, &SkeletonTuning::default());
    for ((k, z), point) in number.into_iter().zip(found).zip(&points) {
        let band = band_of(regions, point.region);
        heights[k] = if z.is_finite() { z } else { band.lo.midpoint(band.hi) };
    }
    heights
}

/// Heights of the ends of pieces that have none.
fn guess_ends(ground: &Ground<'_>, edges: &mut [Edge]) {
    let end = |edge: &Edge, k: usize| {
        let vertex = if k == 0 { edge.piece.vertices.first() } else { edge.piece.vertices.last() };
        let region = edge.piece.regions[k];
        vertex.filter(|v| v.height.is_none() && region != NONE).map(|v| (v.place, region))
    };
    let places: Vec<_> = edges.iter().flat_map(|edge| [end(edge, 0), end(edge, 1)]).collect();
    let heights = heights_at(ground, &places);
    for (edge, heights) in edges.iter_mut().zip(heights.as_chunks::<2>().0) {
        edge.guesses = *heights;
    }
}

/// Heights of the vertices of streams that contours are far from: the mean of the curve along the stream and of equation
/// (1). One knows the slope of the stream, the other the ground beside it.
fn guess_between(ground: &Ground<'_>, edges: &[&Edge], streams: &mut [Stream]) {
    let is_guessed = |stream: &Stream, k: usize| stream.sure[k] == Sure::Guessed;
    let mut places = Vec::new();
    for (edge, stream) in edges.iter().zip(&*streams) {
        let vertices =
            edge.piece.vertices.iter().enumerate().filter(|(k, v)| is_guessed(stream, *k) && v.region != NONE);
        places.extend(vertices.map(|(_, v)| Some((v.place, v.region))));
    }
    let mut heights = heights_at(ground, &places).into_iter();
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

fn detour_finding(detour: &Detour, origin: DVec2) -> Option<Finding> {
    match *detour {
        Detour::Moved { .. } => None,
        Detour::Cut { place, level, length } => {
            let message = match level.is_finite() {
                true => format!("the stream crosses contour {level} upwards; {length:.0} of its length is left out"),
                false => format!("the stream runs upwards; {length:.0} of its length is left out"),
            };
            Some(Finding::at(FindingKind::StreamCut, place + origin, message).of_elevations([level]))
        }
    }
}

/// What was done to whole lines.
fn line_findings(
    lines: &[StreamLine],
    reaches: &[Reach],
    (back, shift_of): (&[bool], &[f64]),
    reach_of: &[usize],
    origin: DVec2,
) -> Vec<Finding> {
    #[derive(Clone, Copy, Default)]
    struct Line {
        reaches: usize,
        used: usize,
        turned: f64,
        kept: f64,
        shift: f64,
        moved: DVec2,
    }
    let mut all = vec![Line::default(); lines.len()];
    for ((reach, &back), &shift) in reaches.iter().zip(back).zip(shift_of) {
        let line = &mut all[reach.line];
        line.reaches += 1;
        *(if back { &mut line.turned } else { &mut line.kept }) += reach.length();
        if shift > line.shift {
            (line.shift, line.moved) = (shift, reach.points[reach.points.len() / 2]);
        }
    }
    for &r in reach_of {
        all[reaches[r].line].used += 1;
    }
    let mut found = Vec::new();
    for (line, state) in lines.iter().zip(all) {
        let start = line.points.first().copied().unwrap_or_default() + origin;
        let mut note =
            |kind, place, message: String| found.push(Finding::at(kind, place, message).of_feature(line.feature));
        if state.used == 0 {
            let why = match state.reaches {
                0 => "it is a loop, a point or a copy of another line",
                _ => "it lies outside the frame",
            };
            note(FindingKind::StreamLeftOut, start, format!("the stream is left out: {why}"));
            continue;
        }
        if state.turned > state.kept {
            note(FindingKind::StreamTurned, start, "the stream is drawn upstream; it is turned".into());
        }
        if state.shift > 0.0 {
            let message = format!("the stream is moved by up to {:.1} into the bends of contours", state.shift);
            note(FindingKind::StreamMoved, state.moved + origin, message);
        }
    }
    found
}
