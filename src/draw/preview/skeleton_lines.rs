//! The choice of the ridge and canyon lines that are drawn.
//!
//! * Nothing is drawn along the frame. Lines there follow the edge of the data, not the ground.
//! * Together they may cover a small share of the map, otherwise they would hide it. If they would cover more, the
//!   shortest are left out. If these are more than half of their length, what remains says little, and none is drawn.
//!   Where the picture is about these lines, the share is larger, and the longest are always drawn.
//!
//! The legend says what is left out.
//!
//! Ridge and canyon lines run along edges of triangles and turn from side to side with them. Where they are only added to
//! the ground, they are drawn smooth.

use glam::{DVec2, DVec3};
use rstar::RTree;
use rstar::primitives::Line;

use super::view::Subject;
use tokosen_core::skeleton::{SkeletonKind, SkeletonLine};

/// Nothing is drawn this near to the frame, pixels.
pub(super) const REACH: f64 = 12.0;
/// Longest piece of a line that is drawn or left out as a whole near the frame, pixels.
const PIECE: f64 = 3.0;
/// Shortest piece that is drawn, pixels.
const SHORTEST: f64 = 5.0;
/// Smoothed points lie this far apart along a line, and each is the mean over this distance to both sides, pixels.
const SMOOTH: (f64, f64) = (2.0, 10.0);
/// Least share of the lines, by length, that is worth drawing.
const WORTH: f64 = 0.5;

/// The largest share of the map that the lines may cover, and their width, pixels.
const fn most(subject: Subject) -> (f64, f32) {
    match subject {
        Subject::Ground => (0.02, 1.2),
        Subject::BreakLines => (0.06, 1.7),
    }
}

/// How much of the lines is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shown {
    All,
    /// Without the shortest.
    Longest,
    Nothing,
}

/// The lines that are drawn, in map units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chosen {
    pub lines: Vec<(SkeletonKind, Vec<DVec3>)>,
    pub shown: Shown,
    /// Pixels.
    pub width: f32,
}

impl Chosen {
    /// The lines of a kind.
    pub fn of(&self, kind: SkeletonKind) -> impl Iterator<Item = &[DVec3]> {
        self.lines.iter().filter(move |line| line.0 == kind).map(|line| line.1.as_slice())
    }
}

/// Chooses the lines to draw on a map of `area` pixels with pixels of a size in map units, inside of a frame.
pub(crate) fn choose(
    lines: &[SkeletonLine],
    frame: &[[DVec2; 2]],
    (pixel, area): (f64, f64),
    subject: Subject,
) -> Chosen {
    let edges = frame.iter().map(|[a, b]| Line::new(a.to_array(), b.to_array())).collect();
    let edges = RTree::bulk_load(edges);
    let finite = lines.iter().filter(|line| line.points.iter().all(|p| p.is_finite()));
    let pieces = finite.flat_map(|line| away(&line.points, &edges, pixel).into_iter().map(|piece| (line.kind, piece)));
    let mut pieces: Vec<(f64, (SkeletonKind, Vec<DVec3>))> =
        pieces.map(|piece| (length(&piece.1) / pixel, piece)).collect();
    pieces.retain(|(length, _)| *length >= SHORTEST);
    // The sort is stable, so lines of equal length keep their order.
    pieces.sort_by(|a, b| b.0.total_cmp(&a.0));
    let total: f64 = pieces.iter().map(|piece| piece.0).sum();
    let (share, width) = most(subject);
    let room = share * area / f64::from(width);
    let mut kept = 0.0;
    let count = pieces.iter().take_while(|(length, _)| {
        let fits = kept + length <= room;
        kept += if fits { *length } else { 0.0 };
        fits
    });
    let count = count.count();
    let shown = match () {
        () if count == pieces.len() => Shown::All,
        () if kept < WORTH * total && subject == Subject::Ground => Shown::Nothing,
        () => Shown::Longest,
    };
    pieces.truncate(if shown == Shown::Nothing { 0 } else { count });
    let smooth = |(kind, piece): (SkeletonKind, Vec<DVec3>)| match subject {
        Subject::Ground => (kind, smoothed(&piece, pixel)),
        Subject::BreakLines => (kind, piece),
    };
    Chosen { lines: pieces.into_iter().map(|(_, piece)| smooth(piece)).collect(), shown, width }
}

/// A line whose points are means of the points around them. Near an end the mean is over less, so the ends stay.
fn smoothed(line: &[DVec3], pixel: f64) -> Vec<DVec3> {
    let length = length(line);
    let count = (length / (SMOOTH.0 * pixel)).ceil();
    if !(1.0..1e6).contains(&count) {
        return line.to_vec();
    }
    let step = length / count;
    let mut even = vec![line[0]];
    let mut behind = 0.0;
    for pair in line.windows(2) {
        let piece = pair[0].truncate().distance(pair[1].truncate());
        while (even.len() as f64) * step <= behind + piece && even.len() < count as usize {
            even.push(pair[0].lerp(pair[1], (even.len() as f64 * step - behind) / piece));
        }
        behind += piece;
    }
    even.push(line[line.len() - 1]);
    let reach = (SMOOTH.1 / SMOOTH.0) as usize;
    let mean = |k: usize| {
        let reach = reach.min(k).min(even.len() - 1 - k);
        let around = &even[k - reach..=k + reach];
        around.iter().sum::<DVec3>() / around.len() as f64
    };
    (0..even.len()).map(mean).collect()
}

fn length(line: &[DVec3]) -> f64 {
    line.windows(2).map(|w| w[0].truncate().distance(w[1].truncate())).sum()
}

/// The pieces of a line that are not near the edges.
fn away(line: &[DVec3], edges: &RTree<Line<[f64; 2]>>, pixel: f64) -> Vec<Vec<DVec3>> {
    let (reach, step) = (REACH * pixel, PIECE * pixel);
    let is_near = |p: DVec3, slack: f64| {
        let p = p.truncate().to_array();
        edges.locate_within_distance(p, (reach + slack).powi(2)).next().is_some()
    };
    let mut pieces: Vec<Vec<DVec3>> = vec![Vec::new()];
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let length = a.truncate().distance(b.truncate());
        let count = if is_near(a.midpoint(b), length / 2.0) { (length / step).ceil().max(1.0) } else { 1.0 };
        for k in 0..count as usize {
            let at = |k: usize| if k as f64 == count { b } else { a.lerp(b, k as f64 / count) };
            let (from, to) = (at(k), at(k + 1));
            let Some(last) = pieces.last_mut() else { continue };
            if is_near(from.midpoint(to), 0.0) {
                if !last.is_empty() {
                    pieces.push(Vec::new());
                }
            } else {
                if last.is_empty() {
                    last.push(from);
                }
                last.push(to);
            }
        }
    }
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokosen_core::skeleton::LineEnd;

    fn line(kind: SkeletonKind, points: &[(f64, f64)]) -> SkeletonLine {
        let points = points.iter().map(|&(x, y)| DVec3::new(x, y, 7.0)).collect();
        SkeletonLine { kind, points, region: 0, ends: [LineEnd::Frame; 2], network: 0 }
    }

    /// The frame of a square of a thousand pixels.
    fn frame() -> Vec<[DVec2; 2]> {
        let corners = [(0.0, 0.0), (1000.0, 0.0), (1000.0, 1000.0), (0.0, 1000.0)].map(|(x, y)| DVec2::new(x, y));
        (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect()
    }

    const SIZE: (f64, f64) = (1.0, 1e6);

    #[test]
    fn nothing_is_drawn_along_the_frame() {
        let along = line(SkeletonKind::Ridge, &[(0.0, 0.0), (500.0, 0.0), (900.0, 5.0)]);
        let into = line(SkeletonKind::Canyon, &[(300.0, 0.0), (300.0, 400.0)]);
        let past = line(SkeletonKind::Ridge, &[(100.0, 500.0), (2.0, 500.0), (2.0, 700.0), (100.0, 700.0)]);
        let chosen = choose(&[along, into, past], &frame(), SIZE, Subject::Ground);
        assert_eq!(chosen.shown, Shown::All);
        assert_eq!(chosen.of(SkeletonKind::Ridge).count(), 2);
        assert_eq!(chosen.of(SkeletonKind::Canyon).count(), 1);
        for point in chosen.lines.iter().flat_map(|line| &line.1) {
            let inside = point.truncate().min(DVec2::splat(1000.0) - point.truncate()).min_element();
            assert!(inside >= REACH - PIECE, "{point}");
        }
        let canyon = chosen.of(SkeletonKind::Canyon).next().unwrap();
        assert!(canyon.last() == Some(&DVec3::new(300.0, 400.0, 7.0)) && length(canyon) > 380.0, "{canyon:?}");
    }

    #[test]
    fn lines_beside_the_ground_are_smooth_and_keep_their_ends() {
        let zigzag: Vec<(f64, f64)> =
            (0..100).map(|k| (100.0 + 3.0 * f64::from(k), 500.0 + f64::from(k % 2) * 4.0)).collect();
        let zigzag = line(SkeletonKind::Ridge, &zigzag);
        let drawn = |subject| choose(std::slice::from_ref(&zigzag), &frame(), SIZE, subject).lines[0].1.clone();
        assert_eq!(drawn(Subject::BreakLines), zigzag.points);
        let smooth = drawn(Subject::Ground);
        assert_eq!((smooth.first(), smooth.last()), (zigzag.points.first(), zigzag.points.last()));
        assert!(smooth[10..smooth.len() - 10].iter().all(|p| (p.y - 502.0).abs() < 1.0), "{smooth:?}");
    }

    #[test]
    fn lines_that_would_cover_the_map_are_left_out() {
        let lines = |count: usize, length: f64| -> Vec<SkeletonLine> {
            (0..count)
                .map(|k| line(SkeletonKind::Ridge, &[(50.0, 50.0 + k as f64), (50.0 + length, 50.0 + k as f64)]))
                .collect()
        };
        let shown = |lines: &[SkeletonLine], subject| {
            let chosen = choose(lines, &frame(), SIZE, subject);
            let covered = chosen.lines.iter().map(|line| length(&line.1)).sum::<f64>() * f64::from(chosen.width) / 1e6;
            assert!(covered <= most(subject).0, "{covered}");
            (chosen.shown, chosen.lines.len())
        };
        assert_eq!(shown(&lines(16, 1000.0 - 100.0), Subject::Ground), (Shown::All, 16));
        // Twenty long ones are too much; the shortest of them go.
        let mut some = lines(18, 800.0);
        some.extend(lines(100, 50.0));
        assert_eq!(shown(&some, Subject::Ground), (Shown::Longest, 18 + 45));
        assert_eq!(shown(&lines(800, 800.0), Subject::Ground), (Shown::Nothing, 0));
        assert_eq!(shown(&lines(800, 800.0), Subject::BreakLines), (Shown::Longest, 44));
        assert_eq!(shown(&[], Subject::Ground), (Shown::All, 0));
    }
}
