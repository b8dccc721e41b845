//! Finds places where contour lines cross or touch that must not.
//!
//! Segments are entered into a uniform grid of cells and compared within each cell; whether two segments meet is
//! decided by exact orientation tests. Nothing is rounded and there is no tolerance.

use glam::DVec2;
use robust::{Coord, orient2d};

/// A segment and where it comes from.
struct Segment {
    line: u32,
    index: u32,
    a: DVec2,
    b: DVec2,
}

/// How two closed segments share points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Meeting {
    /// One point, inside both.
    Cross,
    /// One point, the end of at least one.
    Touch,
    /// A stretch of positive length.
    Overlap,
}

/// Every meeting that contours must not have, one sentence each, in a fixed order:
///
/// - segments of lines of different elevation that share any point;
/// - segments of one line that cross, overlap or fold back; and lines that pass through themselves at a vertex.
///
/// A line that touches itself without passing through is let pass, and so is everything between lines of one elevation
/// (see [`same_level_crossings`]). Points that are not finite are reported.
pub fn crossings(lines: &[(f64, Vec<DVec2>)]) -> Vec<String> {
    let mut out = not_finite(lines);
    let paths = paths_of(lines);
    for (s, t, meeting) in
        meetings(&paths, |s, t| s.line == t.line || lines[s.line as usize].0 != lines[t.line as usize].0)
    {
        if s.line != t.line || meeting != Meeting::Touch {
            out.push(describe(lines, &s, &t, meeting));
        } else if passes_through(&paths[s.line as usize], s.index as usize, t.index as usize) {
            out.push(describe(lines, &s, &t, Meeting::Cross));
        }
    }
    out
}

/// Segments of different lines of one elevation that cross inside both or overlap, one sentence each.
pub fn same_level_crossings(lines: &[(f64, Vec<DVec2>)]) -> Vec<String> {
    let paths = paths_of(lines);
    meetings(&paths, |s, t| s.line != t.line && lines[s.line as usize].0 == lines[t.line as usize].0)
        .into_iter()
        .filter(|m| m.2 != Meeting::Touch)
        .map(|(s, t, meeting)| describe(lines, &s, &t, meeting))
        .collect()
}

fn describe(lines: &[(f64, Vec<DVec2>)], s: &Segment, t: &Segment, meeting: Meeting) -> String {
    let verb = match meeting {
        Meeting::Cross => "cross",
        Meeting::Touch => "touch",
        Meeting::Overlap => "overlap",
    };
    format!(
        "line {} (level {}) segment {} {} to {} and line {} (level {}) segment {} {} to {} {verb}",
        s.line, lines[s.line as usize].0, s.index, s.a, s.b, t.line, lines[t.line as usize].0, t.index, t.a, t.b
    )
}

fn not_finite(lines: &[(f64, Vec<DVec2>)]) -> Vec<String> {
    let mut out = Vec::new();
    for (n, (level, points)) in lines.iter().enumerate() {
        if let Some(p) = points.iter().find(|p| !p.is_finite()) {
            out.push(format!("line {n} (level {level}) has the point {p}, which is not finite"));
        }
    }
    out
}

/// The lines without repeated points and points that are not finite.
fn paths_of(lines: &[(f64, Vec<DVec2>)]) -> Vec<Vec<DVec2>> {
    lines
        .iter()
        .map(|(_, points)| {
            let mut path: Vec<DVec2> = points.iter().copied().filter(|p| p.is_finite()).collect();
            path.dedup();
            path
        })
        .collect()
}

/// All pairs of segments that meet and that `wanted` asks for. Neighbours along a line, which share a vertex, are
/// reported only when they overlap.
fn meetings(paths: &[Vec<DVec2>], wanted: impl Fn(&Segment, &Segment) -> bool) -> Vec<(Segment, Segment, Meeting)> {
    let segments = segments_of(paths);
    let entries = cells_of(&segments);
    let mut found = Vec::new();
    for cell in entries.chunk_by(|a, b| a.0 == b.0) {
        for (n, &(_, i)) in cell.iter().enumerate() {
            let s = &segments[i as usize];
            for &(_, j) in &cell[n + 1..] {
                let t = &segments[j as usize];
                if boxes_apart(s, t) || !wanted(s, t) {
                    continue;
                }
                let Some(meeting) = meeting_of(s, t) else { continue };
                if s.line == t.line && meeting == Meeting::Touch && neighbours(&paths[s.line as usize], s, t) {
                    continue;
                }
                found.push((i.min(j), i.max(j), meeting));
            }
        }
    }
    found.sort_unstable_by_key(|f| (f.0, f.1));
    found.dedup();
    let copy = |i: u32| {
        let s = &segments[i as usize];
        Segment { line: s.line, index: s.index, a: s.a, b: s.b }
    };
    found.into_iter().map(|(i, j, meeting)| (copy(i), copy(j), meeting)).collect()
}

fn segments_of(paths: &[Vec<DVec2>]) -> Vec<Segment> {
    let mut segments = Vec::new();
    for (line, path) in (0u32..).zip(paths) {
        // A line of one point still touches what runs through that point.
        if let [p] = path[..] {
            segments.push(Segment { line, index: 0, a: p, b: p });
        }
        for (index, w) in (0u32..).zip(path.windows(2)) {
            segments.push(Segment { line, index, a: w[0], b: w[1] });
        }
    }
    segments
}

/// Pairs (cell, segment), sorted: every cell that a segment runs through, and perhaps a few beside it.
fn cells_of(segments: &[Segment]) -> Vec<(u64, u32)> {
    let (mut low, mut high, mut length) = (DVec2::INFINITY, DVec2::NEG_INFINITY, 0.0);
    for s in segments {
        low = low.min(s.a.min(s.b));
        high = high.max(s.a.max(s.b));
        length += s.a.distance(s.b);
    }
    let extent = (high - low).max_element();
    // Cells of about two segments' length hold few segments; the lower limit keeps the table small.
    let size = (2.0 * length / segments.len().max(1) as f64).max(extent / 8192.0).max(f64::MIN_POSITIVE);
    let cell = |x: f64| (x / size).floor();
    let mut entries = Vec::new();
    for (n, s) in (0u32..).zip(segments) {
        let (p, q) = if s.a.y <= s.b.y { (s.a - low, s.b - low) } else { (s.b - low, s.a - low) };
        for row in cell(p.y) as u64..=cell(q.y) as u64 {
            // The part of the segment within the row, widened by a little so that rounding loses no cell.
            let at =
                |y: f64| if q.y > p.y { p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)).clamp(0.0, 1.0) } else { p.x };
            let (mut x0, mut x1) = (at(row as f64 * size), at((row + 1) as f64 * size));
            if q.y <= p.y {
                (x0, x1) = (p.x, q.x);
            }
            let margin = 1e-6 * size;
            let (west, east) = (x0.min(x1) - margin, x0.max(x1) + margin);
            for column in cell(west).max(0.0) as u64..=cell(east).max(0.0) as u64 {
                entries.push((row << 32 | column, n));
            }
        }
    }
    entries.sort_unstable();
    entries
}

fn boxes_apart(s: &Segment, t: &Segment) -> bool {
    s.a.max(s.b).cmplt(t.a.min(t.b)).any() || t.a.max(t.b).cmplt(s.a.min(s.b)).any()
}

/// On which side of the line from `a` to `b` the point `p` lies: 1 left, -1 right, 0 on it. Exact.
fn side(a: DVec2, b: DVec2, p: DVec2) -> i8 {
    let c = |v: DVec2| Coord { x: v.x, y: v.y };
    let o = orient2d(c(a), c(b), c(p));
    i8::from(o > 0.0) - i8::from(o < 0.0)
}

/// Whether `p`, known to lie on the line through `a` and `b`, is between them or at one of them.
fn within(a: DVec2, b: DVec2, p: DVec2) -> bool {
    a.min(b).cmple(p).all() && p.cmple(a.max(b)).all()
}

fn meeting_of(s: &Segment, t: &Segment) -> Option<Meeting> {
    let (ta, tb) = (side(s.a, s.b, t.a), side(s.a, s.b, t.b));
    let (sa, sb) = (side(t.a, t.b, s.a), side(t.a, t.b, s.b));
    if ta * tb < 0 && sa * sb < 0 {
        return Some(Meeting::Cross);
    }
    let mut shared = Vec::new();
    for (p, on) in [(t.a, ta == 0 && within(s.a, s.b, t.a)), (t.b, tb == 0 && within(s.a, s.b, t.b))] {
        if on && !shared.contains(&p) {
            shared.push(p);
        }
    }
    for (p, on) in [(s.a, sa == 0 && within(t.a, t.b, s.a)), (s.b, sb == 0 && within(t.a, t.b, s.b))] {
        if on && !shared.contains(&p) {
            shared.push(p);
        }
    }
    match shared.len() {
        0 => None,
        1 => Some(Meeting::Touch),
        _ => Some(Meeting::Overlap),
    }
}

/// Whether two segments of one line follow each other, the first and last of a closed line included.
fn neighbours(path: &[DVec2], s: &Segment, t: &Segment) -> bool {
    let (i, j) = (s.index.min(t.index) as usize, s.index.max(t.index) as usize);
    j == i + 1 || (i == 0 && j + 2 == path.len() && path.first() == path.last())
}

/// Whether a line that touches itself where segments `i` and `j` meet passes from one side of itself to the other there.
fn passes_through(path: &[DVec2], i: usize, j: usize) -> bool {
    let shared = [path[i], path[i + 1], path[j], path[j + 1]].into_iter().find(|&p| {
        side(path[i], path[i + 1], p) == 0
            && within(path[i], path[i + 1], p)
            && side(path[j], path[j + 1], p) == 0
            && within(path[j], path[j + 1], p)
    });
    let Some(p) = shared else { return false };
    match (branch(path, i, p), branch(path, j, p)) {
        (Some((a, b)), Some((c, d))) => separates(p, a, b, c) * separates(p, a, b, d) < 0,
        _ => false,
    }
}

/// The points of the path just before and just after `p`, which lies on segment `i`. None at the end of an open line.
fn branch(path: &[DVec2], i: usize, p: DVec2) -> Option<(DVec2, DVec2)> {
    let last = path.len() - 1;
    let closed = path.first() == path.last();
    if p == path[i] {
        let before = if i > 0 {
            path[i - 1]
        } else if closed {
            path[last - 1]
        } else {
            return None;
        };
        Some((before, path[i + 1]))
    } else if p == path[i + 1] {
        let after = if i + 2 <= last {
            path[i + 2]
        } else if closed {
            path[1]
        } else {
            return None;
        };
        Some((path[i], after))
    } else {
        Some((path[i], path[i + 1]))
    }
}

/// Whether `q` lies left (1) or right (-1) of the bent line a, p, b; 0 when it lies on one of its two legs.
fn separates(p: DVec2, a: DVec2, b: DVec2, q: DVec2) -> i8 {
    let (first, second) = (side(a, p, q), side(p, b, q));
    let ahead = |leg: DVec2| (leg - p).dot(q - p) > 0.0;
    if (first == 0 && ahead(a)) || (second == 0 && ahead(b)) {
        return 0;
    }
    match side(a, p, b) {
        // A left turn: the left side is where both legs have the point on their left; else the right.
        1 => {
            if first > 0 && second > 0 {
                1
            } else {
                -1
            }
        }
        -1 => {
            if first < 0 && second < 0 {
                -1
            } else {
                1
            }
        }
        _ => first,
    }
}
