//! The expected error against ground that is known: waves whose contours are cut finely.

use glam::DVec2;
use tokosen::base::Grid;
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::{Contour, ContourMap, Source};
use tokosen::slice::{LayerParams, Target, contour_layers};
use tokosen::spline::Wanted;
use tokosen::surface::standard_errors;
use tokosen::surface::{Surface, SurfaceKind, SurfaceParams, Triangles, Uncertainty, build, heights};
use tokosen::validate::Lesson;

const STEP: f64 = 10.0;
const CELLS: usize = 160;

/// Hills and hollows of several lengths on a slope, metres.
fn ground(p: DVec2) -> f64 {
    let DVec2 { x, y } = p;
    0.05 * x
        + 45.0 * (x / 130.0).sin() * (y / 170.0).cos()
        + 9.0 * (x / 37.0 + 1.0).sin() * (y / 41.0).sin()
        + 2.5 * (x / 13.0).cos() * (y / 11.0 + 0.5).sin()
}

fn grid() -> Grid {
    Grid { corner: DVec2::new(0.0, 800.0), cell: DVec2::splat(5.0), cols: CELLS, rows: CELLS }
}

/// Contours of the ground, followed from cell to cell of a fine lattice with each square cut into two triangles.
fn contours() -> Vec<Contour> {
    use std::collections::BTreeMap;
    let (side, count) = (4.0, 200usize);
    let node =
        |k: usize| DVec2::new((k % (count + 1)) as f64, (k / (count + 1)) as f64) * side + DVec2::new(0.13, 0.29);
    let mut found = Vec::new();
    for level in -12..=20 {
        let level = f64::from(level) * STEP;
        let mut next: BTreeMap<[usize; 2], [usize; 2]> = BTreeMap::new();
        for square in 0..count * count {
            let k = square / count * (count + 1) + square % count;
            for corners in [[k, k + 1, k + count + 2], [k, k + count + 2, k + count + 1]] {
                let high = corners.map(|k| ground(node(k)) >= level);
                let edge = |from: bool| {
                    let i = (0..3).find(|&i| high[i] == from && high[(i + 1) % 3] != from)?;
                    let (a, b) = (corners[i], corners[(i + 1) % 3]);
                    Some([a.min(b), a.max(b)])
                };
                if let (Some(entry), Some(exit)) = (edge(false), edge(true)) {
                    next.insert(entry, exit);
                }
            }
        }
        let place = |[a, b]: [usize; 2]| {
            let (pa, pb) = (node(a), node(b));
            let (za, zb) = (ground(pa), ground(pb));
            pa.lerp(pb, ((level - za) / (zb - za)).clamp(1e-3, 1.0 - 1e-3))
        };
        let ends: std::collections::BTreeSet<[usize; 2]> = next.values().copied().collect();
        while let Some(&any) = next.keys().next() {
            let first = next.keys().find(|k| !ends.contains(*k)).copied().unwrap_or(any);
            let (mut at, mut points) = (first, vec![place(first)]);
            while let Some(to) = next.remove(&at) {
                points.push(place(to));
                at = to;
            }
            if points.len() > 2 {
                found.push(Contour { elevation: level, points, feature: found.len() as u64 });
            }
        }
    }
    found
}

fn surface(contours: Vec<Contour>, kind: SurfaceKind, triangles: Triangles, wanted: Option<Wanted>) -> Surface {
    let map = ContourMap { contours, ..ContourMap::default() };
    let map = clean(map, &CleanParams::default()).expect("contours of a function do not cross").value;
    let mut params = SurfaceParams { kind, triangles, uncertainty: Uncertainty::Learnt, ..SurfaceParams::default() };
    params.spline.wanted = wanted;
    build(map, &params, &()).expect("a clean map").value
}

#[test]
fn as_many_errors_lie_within_one_and_two_standard_errors_as_should() {
    for kind in [SurfaceKind::Spline, SurfaceKind::Skeleton, SurfaceKind::Linear] {
        let surface = surface(contours(), kind, Triangles::Guide, Some(Wanted::Grid(grid())));
        let field = surface.errors.as_ref().expect("it was asked for");
        assert!(matches!(field.model.lesson, Lesson::Hidden { places } if places > 1000), "{:?}", field.model.lesson);
        let dem = heights(&surface, &grid(), &());
        let errors = standard_errors(&surface, &dem).expect("it was asked for");
        assert_eq!(errors.len(), dem.values.len());
        let (mut count, mut within) = (0, [0, 0]);
        for (i, (height, error)) in dem.values.iter().zip(&errors).enumerate() {
            assert_eq!(height.is_nan(), error.is_nan(), "cell {i}");
            if height.is_nan() {
                continue;
            }
            assert!((0.0..=STEP as f32 / 2.0).contains(error), "cell {i}: {error}");
            let off = (f64::from(*height) - ground(grid().center(i % CELLS, i / CELLS))).abs();
            count += 1;
            within[0] += i32::from(off <= f64::from(*error));
            within[1] += i32::from(off <= 2.0 * f64::from(*error));
        }
        let [one, two] = within.map(|n| 100.0 * f64::from(n) / f64::from(count));
        assert!((50.0..88.0).contains(&one) && two > 82.0, "{kind:?}: {one:.1} {two:.1}");
    }
}

#[test]
fn the_error_is_zero_on_contours_and_largest_between() {
    let straight = |k: i32| {
        let points = (0..=40).map(|i| DVec2::new(f64::from(i) * 10.0, f64::from(k) * 40.0)).collect();
        Contour { elevation: f64::from(k) * STEP, points, feature: 0 }
    };
    let grid = Grid { corner: DVec2::new(-5.0, 405.0), cell: DVec2::splat(10.0), cols: 41, rows: 41 };
    let surface =
        surface((0..=10).map(straight).collect(), SurfaceKind::Spline, Triangles::Guide, Some(Wanted::Grid(grid)));
    let dem = heights(&surface, &grid, &());
    let errors = standard_errors(&surface, &dem).expect("it was asked for");
    let at = |col: usize, row: usize| errors[row * 41 + col];
    // Rows 0, 4, 8, ... lie on contours, rows 2, 6, ... half-way.
    for col in 3..38 {
        assert_eq!(at(col, 20), 0.0);
        assert!(at(col, 21) <= at(col, 22), "{} {}", at(col, 21), at(col, 22));
    }
}

#[test]
fn few_levels_fall_back_to_usual_terrain() {
    let ring = |radius: f64, elevation: f64| {
        let corner = |k: i32| radius * DVec2::from_angle(f64::from(k % 60) * std::f64::consts::TAU / 60.0);
        Contour { elevation, points: (0..=60).map(corner).collect(), feature: 0 }
    };
    let rings = vec![ring(300.0, 10.0), ring(200.0, 20.0), ring(100.0, 30.0)];
    let surface = surface(rings, SurfaceKind::Spline, Triangles::Smooth, None);
    let field = surface.errors.as_ref().expect("it was asked for");
    assert_eq!(field.model.lesson, Lesson::Usual);
    let params = LayerParams { targets: vec![Target::Interval { step: 1.0, base: 0.0 }], ..LayerParams::default() };
    let layer = contour_layers(&surface, &params, &()).expect("a fair interval").remove(0);
    for line in &layer.lines {
        let expected = line.expected.expect("the surface knows");
        if line.source == Source::Input {
            assert_eq!((expected.vertical, expected.horizontal, expected.inferred), (0.0, 0.0, false));
            continue;
        }
        assert!(expected.vertical > 0.0 && expected.vertical <= STEP / 2.0, "{expected:?}");
        assert!(expected.horizontal > 0.0 && expected.horizontal <= 100.0, "{expected:?}");
        assert_eq!(expected.inferred, line.elevation > 30.0, "{} {expected:?}", line.elevation);
    }
    assert!(layer.lines.iter().any(|line| line.elevation > 30.0));
}

#[test]
fn the_errors_are_the_same_for_any_number_of_threads() {
    let errors = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("two threads");
        pool.install(|| {
            let surface = surface(contours(), SurfaceKind::Spline, Triangles::Guide, Some(Wanted::Grid(grid())));
            let errors = surface.errors.expect("it was asked for").errors.heights;
            errors.into_iter().map(f32::to_bits).collect::<Vec<u32>>()
        })
    });
    assert!(errors[0] == errors[1]);
}
