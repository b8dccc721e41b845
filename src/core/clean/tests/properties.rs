//! Properties of cleaned maps, on small grids where lines meet all the time, against a search over all pairs of segments in
//! whole numbers, and on real coordinates.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use proptest::prelude::*;

use crate::clean::removed::{Removed, Why};
use crate::clean::segments::Segments;
use crate::clean::tests::*;
use crate::clean::{clean_lines, contacts};

type Point = (i64, i64);
/// Elevation, and the two ends in order.
type Piece = (i64, Point, Point);

/// How the coordinates of a case are made from the grid's whole numbers: exactly, so that they can be taken back.
const SCALE: f64 = 0.25;
const ORIGIN: DVec2 = DVec2::new(534_000.5, -4_012_345.75);

fn to_map(p: Point) -> DVec2 {
    ORIGIN + SCALE * DVec2::new(p.0 as f64, p.1 as f64)
}

fn to_grid(p: DVec2) -> Point {
    let q = (p - ORIGIN) / SCALE;
    assert_eq!(to_map((q.x as i64, q.y as i64)), p, "a vertex that the input does not have");
    (q.x as i64, q.y as i64)
}

fn grid_points(c: &Contour) -> Vec<Point> {
    c.points.iter().map(|p| to_grid(*p)).collect()
}

fn piece(elevation: f64, a: Point, b: Point) -> Piece {
    (elevation as i64, a.min(b), a.max(b))
}

fn cross(o: Point, a: Point, b: Point) -> i64 {
    (a.0 - o.0) * (b.1 - o.1) - (a.1 - o.1) * (b.0 - o.0)
}

fn dot(o: Point, a: Point, b: Point) -> i64 {
    (a.0 - o.0) * (b.0 - o.0) + (a.1 - o.1) * (b.1 - o.1)
}

fn is_on(p: Point, a: Point, b: Point) -> bool {
    cross(a, b, p) == 0 && dot(p, a, b) <= 0
}

/// Number of common points: none, one, or (as 2) more; and whether a single one is inside both.
fn common(a: Point, b: Point, c: Point, d: Point) -> (usize, bool) {
    let ends: BTreeSet<Point> = [(a, is_on(a, c, d)), (b, is_on(b, c, d)), (c, is_on(c, a, b)), (d, is_on(d, a, b))]
        .into_iter()
        .filter_map(|(p, on)| on.then_some(p))
        .collect();
    let proper =
        cross(a, b, c).signum() * cross(a, b, d).signum() < 0 && cross(c, d, a).signum() * cross(c, d, b).signum() < 0;
    if proper { (1, true) } else { (ends.len().min(2), false) }
}

/// Whether a point is nearer to a segment than separation / 4 grid steps.
fn is_near(p: Point, a: Point, b: Point, separation: i64) -> bool {
    let length = dot(a, b, b);
    let along = dot(a, b, p);
    // Squares of distances, times 16; off the middle part the nearest point is an end.
    if along <= 0 {
        16 * dot(a, p, p) < separation * separation
    } else if along >= length {
        16 * dot(b, p, p) < separation * separation
    } else {
        16 * cross(a, b, p).pow(2) < separation * separation * length
    }
}

/// What no two lines of a clean map may do. Numbers of lines and of segments on them.
fn forbidden(lines: &[(f64, Vec<Point>)], separation: i64) -> Vec<((usize, usize), (usize, usize))> {
    let all: Vec<(usize, usize)> =
        lines.iter().enumerate().flat_map(|(i, l)| (0..l.1.len() - 1).map(move |k| (i, k))).collect();
    let mut found = Vec::new();
    for (n, &(i, k)) in all.iter().enumerate() {
        for &(j, l) in &all[n + 1..] {
            let ((z, p), (w, q)) = (&lines[i], &lines[j]);
            let (a, b, c, d) = (p[k], p[k + 1], q[l], q[l + 1]);
            let (points, proper) = common(a, b, c, d);
            let closes = p.first() == p.last() && k == 0 && l + 2 == p.len();
            let bad = if z != w {
                points > 0
                    || is_near(a, c, d, separation)
                    || is_near(b, c, d, separation)
                    || is_near(c, a, b, separation)
                    || is_near(d, a, b, separation)
            } else if i != j {
                proper || points > 1
            } else if l == k + 1 || closes {
                points > 1
            } else {
                points > 0
            };
            if bad {
                found.push(((i, k), (j, l)));
            }
        }
    }
    found
}

fn on_grid(contours: &[Contour]) -> Vec<(f64, Vec<Point>)> {
    contours.iter().map(|c| (c.elevation, grid_points(c))).collect()
}

/// The segments cut at all vertices of the input, `vertices`, that lie on them, and how often each comes.
fn pieces(contours: &[Contour], vertices: &BTreeSet<Point>) -> BTreeMap<Piece, usize> {
    let mut all = BTreeMap::new();
    for c in contours {
        for w in grid_points(c).windows(2).filter(|w| w[0] != w[1]) {
            // On a straight line, points are in the order of their coordinates.
            let (low, high) = (w[0].min(w[1]), w[0].max(w[1]));
            let on: Vec<&Point> = vertices.range(low..=high).filter(|p| is_on(**p, low, high)).collect();
            for v in on.windows(2) {
                *all.entry(piece(c.elevation, *v[0], *v[1])).or_default() += 1;
            }
        }
    }
    all
}

/// Lines on a grid of `size` steps, of points anywhere or of short steps, some closed, some twice.
fn lines(size: i64, most: usize) -> impl Strategy<Value = Vec<Contour>> {
    let anywhere = prop::collection::vec((0..size, 0..size), 0..12);
    let steps =
        ((0..size, 0..size), prop::collection::vec((-2i64..=2, -2i64..=2), 0..40)).prop_map(|(start, steps)| {
            let mut points = vec![start];
            for step in steps {
                let last = points[points.len() - 1];
                points.push((last.0 + step.0, last.1 + step.1));
            }
            points
        });
    let one = (prop_oneof![anywhere, steps], 1i64..4, any::<bool>(), 0u8..10);
    prop::collection::vec(one, 0..most).prop_map(|rows| {
        let mut lines = Vec::new();
        for (feature, (mut points, level, close, again)) in (1..).zip(rows) {
            if close {
                points.extend(points.first().copied());
            }
            let contour = Contour {
                elevation: 10.0 * level as f64,
                points: points.into_iter().map(to_map).collect(),
                feature: feature.into(),
            };
            if again == 0 {
                let mut copy = contour.clone();
                copy.points.reverse();
                lines.push(Contour { feature: (1000 + feature).into(), ..copy });
            }
            lines.push(contour);
        }
        lines
    })
}

/// The same lines in another order, some of them reversed, closed ones started elsewhere.
fn rewritten(lines: &[Contour], seed: u64) -> Vec<Contour> {
    let mut state = seed | 1;
    let mut next = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let mut lines = lines.to_vec();
    for i in (1..lines.len()).rev() {
        lines.swap(i, next(i + 1));
    }
    for line in &mut lines {
        if next(2) == 0 {
            line.points.reverse();
        }
        // A point that comes twice in a row makes a ring of what would be a line there and back.
        if line.is_closed() && line.points.windows(2).all(|w| w[0] != w[1]) {
            line.points.pop();
            let start = next(line.points.len());
            line.points.rotate_left(start);
            line.points.push(line.points[0]);
        }
    }
    lines
}

/// Numbers that make trouble, and some that meet.
fn wild() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-3i8..4).prop_map(f64::from),
        1 => any::<f64>(),
        1 => prop::num::f64::ANY,
        1 => prop::sample::select(vec![-0.0, 1e-320, 1e-160, 1e50, 9.9e49, 0.1, 0.3, 0.1 + 0.2]),
    ]
}

fn check(input: &[Contour], params: &CleanParams, separation: i64) -> Result<(), TestCaseError> {
    let cleaned = clean_lines(input.to_vec(), params, &HashSet::new()).expect("few conflicts");
    let lines = on_grid(&cleaned.contours);

    prop_assert_eq!(forbidden(&lines, separation), Vec::new());
    for (_, points) in &lines {
        let ring = usize::from(points.len() >= 4 && points.first() == points.last());
        prop_assert!(points.len() >= 2);
        let distinct: BTreeSet<_> = points[ring..].iter().collect();
        prop_assert_eq!(distinct.len(), points.len() - ring, "a vertex comes twice");
    }

    let vertices: BTreeSet<Point> = input.iter().flat_map(grid_points).collect();
    let left_out: Vec<Contour> = cleaned
        .removed
        .iter()
        .map(|r| Contour { elevation: r.elevation, points: r.way.clone(), feature: r.feature })
        .collect();
    let (before, after, removed) =
        (pieces(input, &vertices), pieces(&cleaned.contours, &vertices), pieces(&left_out, &vertices));
    let straight = pieces(&straights(&cleaned.removed), &vertices);
    for p in after.keys() {
        let length = to_map(p.1).distance(to_map(p.2));
        let is_known = before.contains_key(p) || straight.contains_key(p) || length <= params.snap;
        prop_assert!(is_known, "{p:?} is new");
    }
    for (p, count) in &after {
        prop_assert_eq!(*count, 1, "{:?} comes twice", p);
    }
    for p in before.keys() {
        prop_assert!(after.contains_key(p) || removed.contains_key(p), "{p:?} is lost without a word");
    }
    for p in removed.keys() {
        // A connection may be a part of a way that strays.
        let length = to_map(p.1).distance(to_map(p.2));
        let is_known = before.contains_key(p) || straight.contains_key(p) || length <= params.snap;
        prop_assert!(is_known, "{p:?} is reported, and the input does not have it");
    }

    let again = clean_lines(rewritten(input, before.len() as u64 * 7919 + 12_345), params, &HashSet::new())
        .expect("few conflicts");
    prop_assert_eq!(&again.contours, &cleaned.contours);
    prop_assert_eq!(&again.findings, &cleaned.findings);
    prop_assert_eq!(&again.removed, &cleaned.removed);
    prop_assert_eq!(&again.faults, &cleaned.faults);
    let is_fault = |r: &Removed| matches!(r.why, Why::Meets | Why::Strays);
    prop_assert_eq!(cleaned.faults.is_empty(), !cleaned.removed.iter().any(is_fault));
    Ok(())
}

/// The straight pieces instead of ways that were left out.
fn straights(removed: &[Removed]) -> Vec<Contour> {
    let strays = removed.iter().filter(|r| r.why == Why::Strays);
    let straight = |r: &Removed| {
        let points = vec![r.way[0], r.way[r.way.len() - 1]];
        Contour { elevation: r.elevation, points, feature: r.feature }
    };
    strays.map(straight).collect()
}

/// What goes was in a conflict; the rest of the line stays.
fn check_removed_were_bad(input: &[Contour]) -> Result<(), TestCaseError> {
    let params = CleanParams { snap: 0.0, separation: 0.0 };
    let cleaned = clean_lines(input.to_vec(), &params, &HashSet::new()).expect("few conflicts");
    let straights = on_grid(&straights(&cleaned.removed));
    let mut lines = on_grid(input);
    lines.iter_mut().for_each(|l| l.1.dedup());
    lines.retain(|l| l.1.len() > 1);
    let bad: BTreeSet<Piece> = forbidden(&lines, 0)
        .into_iter()
        .flat_map(|(s, t)| [s, t])
        .map(|(i, k)| piece(lines[i].0, lines[i].1[k], lines[i].1[k + 1]))
        .collect();
    for r in &cleaned.removed {
        let was_bad = |ends: &[DVec2]| {
            let p = piece(r.elevation, to_grid(ends[0]), to_grid(ends[1]));
            // What goes may have been in the way of a straight piece.
            let meets_straight = || straights.iter().any(|s| common(p.1, p.2, s.1[0], s.1[1]).0 > 0);
            bad.iter().any(|b| b.0 == p.0 && is_on(p.1, b.1, b.2) && is_on(p.2, b.1, b.2)) || meets_straight()
        };
        let mut pieces = r.way.windows(2);
        // Of a way that strays, one piece is enough.
        let had_need = if r.why == Why::Strays { pieces.any(was_bad) } else { pieces.all(was_bad) };
        prop_assert!(had_need, "{:?} was removed without need", r.way);
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::draws::draws())]

    #[test]
    fn dense_grids(input in lines(7, 9)) {
        check(&input, &CleanParams { snap: 0.0, separation: 0.0 }, 0)?;
        check_removed_were_bad(&input)?;
    }

    #[test]
    fn wide_grids(input in lines(60, 14)) {
        check(&input, &CleanParams { snap: 0.0, separation: 0.0 }, 0)?;
        check_removed_were_bad(&input)?;
    }

    #[test]
    fn joined_across_gaps(input in lines(20, 9), snap in 0i64..20) {
        check(&input, &CleanParams { snap: SCALE * snap as f64 / 2.0, separation: 0.0 }, 0)?;
    }

    #[test]
    fn kept_apart(input in lines(30, 9), separation in 0i64..12) {
        check(&input, &CleanParams { snap: 0.0, separation: SCALE * separation as f64 / 4.0 }, separation)?;
    }

    #[test]
    fn no_number_is_too_wild(
        rows in prop::collection::vec((prop::collection::vec((wild(), wild()), 0..9), wild()), 0..9),
        spots in prop::collection::vec((wild(), wild(), wild()), 0..9),
        snap in prop::sample::select(vec![0.0, 1.0, 1e300]),
        separation in prop::sample::select(vec![0.0, 1e-6, 1e-320, 1e3]),
    ) {
        let contours = (0u64..)
            .zip(&rows)
            .map(|(feature, (points, elevation))| Contour {
                elevation: *elevation,
                points: points.iter().map(|p| DVec2::new(p.0, p.1)).collect(),
                feature: feature.into(),
            })
            .collect();
        let spots: Vec<DVec3> = spots.iter().map(|s| DVec3::new(s.0, s.1, s.2)).collect();
        let input = ContourMap { contours, spots, ..ContourMap::default() };
        let params = CleanParams { snap, separation };
        let report = clean(input.clone(), &params).expect("few conflicts");
        crate::clean::validate(&report.value, &params).expect("sound");
        let _ = crate::contour::find_interval(&input.contours);
        let mut turned = input;
        turned.contours.reverse();
        turned.spots.reverse();
        let again = clean(turned, &params).expect("few conflicts");
        // Places of bad spot heights may be NaN, so findings are compared as text.
        prop_assert_eq!(again.value, report.value);
        prop_assert_eq!(format!("{:?}", again.findings), format!("{:?}", report.findings));
    }

    #[test]
    fn the_tree_misses_no_pair(
        rows in prop::collection::vec((prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 2..60), 1u8..4), 1..8),
        stride in 0.05..1.0f64,
        separation in prop::sample::select(vec![0.0, 1e-6, 0.01]),
    ) {
        let contours: Vec<Contour> = rows
            .iter()
            .map(|(steps, level)| {
                let mut at = DVec2::new(steps[0].0, steps[0].1);
                let points = steps.iter().map(|s| { at += stride * DVec2::new(s.0, s.1); at }).collect();
                Contour { elevation: (*level).into(), points, feature: 0.into() }
            })
            .collect();
        let segments = Segments::new(&contours).expect("few");
        let found = contacts::find(&segments, separation).expect("few conflicts");
        let all: Vec<contacts::Placed> = (0u32..)
            .zip(&contours)
            .flat_map(|(line, contour)| {
                contour.points.windows(2).enumerate().map(move |(number, w)| contacts::Placed {
                    segment: crate::geometry::Segment { a: w[0], b: w[1] },
                    contour,
                    line,
                    number,
                })
            })
            .collect();
        let mut slow = contacts::Contacts::default();
        for (i, s) in (0u32..).zip(&all) {
            for (j, t) in (0u32..).zip(&all).skip(i as usize + 1) {
                match contacts::contact(s, t, separation) {
                    contacts::Contact::Conflict => slow.conflicts.push((i, j)),
                    contacts::Contact::Own => slow.own.push((i, j)),
                    _ => (),
                }
            }
        }
        prop_assert_eq!(found, slow);
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    // Wide waves of three levels that cross each other all over.
    let wave = |i: u32| {
        let points = (0..4000).map(|k| {
            let x = f64::from(k) * 0.5;
            DVec2::new(x, f64::from(i) * 3.0 + 8.0 * (x * (0.05 + 0.001 * f64::from(i))).sin())
        });
        Contour { elevation: f64::from(i % 3) * 10.0, points: points.collect(), feature: (i as u64).into() }
    };
    let input: Vec<Contour> = (0..40).map(wave).collect();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| cleaned(input.clone(), 1.0))
    };
    let one = run(1);
    assert!(one.findings.len() > 100);
    assert_eq!(one, run(2));
    assert_eq!(one, run(5));
}
