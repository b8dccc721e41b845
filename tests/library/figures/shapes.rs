//! Figures 1 and 5: what sub-domains a map has, and which ridges and canyons run in them.

use std::collections::HashSet;

use tokosen::skeleton::{SkeletonKind, skeleton};
use tokosen::subdomains::LandformClass::{Basin, Bottom, Branching, Peak, RidgePeak, Tableland};
use tokosen::subdomains::{LandformClass, landforms};
use tokosen::tuning::SkeletonTuning;

use super::sample::{Counts, Sample, sample};

/// A level around a sub-domain: the ground lies above it, or below it.
const fn above(level: f64) -> (f64, bool) {
    (level, true)
}

const fn below(level: f64) -> (f64, bool) {
    (level, false)
}

/// What is known by hand of the sub-domain at a place.
struct Expected {
    at: (f64, f64),
    levels: Vec<(f64, bool)>,
    holes: usize,
    class: LandformClass,
}

fn expected(at: (f64, f64), levels: &[(f64, bool)], holes: usize, class: LandformClass) -> Expected {
    Expected { at, levels: levels.to_vec(), holes, class }
}

/// Checks levels, sides, class and the number of triangles of each kind; the sub-domains are all different, and there are
/// `outside` more of them between the outermost line and the convex hull.
fn check(sample: &Sample, wanted: &[Expected], outside: usize) {
    let forms = landforms(&sample.subdivision.tin, &sample.subdivision.regions);
    let mut regions: Vec<u32> = wanted
        .iter()
        .map(|w| {
            let region = sample.region_at(w.at.0, w.at.1);
            assert_eq!(sample.levels(region), w.levels, "at {:?}", w.at);
            let form = &forms[region as usize];
            assert_eq!((form.class, form.interior_count()), (w.class, w.holes), "at {:?}", w.at);
            let Counts { terminal, junction, .. } = sample.counts(region);
            assert_eq!(terminal + 2 * w.holes, junction + 2, "at {:?}", w.at);
            region
        })
        .collect();
    regions.sort_unstable();
    regions.dedup();
    assert_eq!(regions.len(), wanted.len(), "places in different sub-domains");
    assert_eq!(sample.subdivision.regions.regions.len(), wanted.len() + outside);
}

/// Of the lines inside the sub-domain at a place, how many are higher than, level with and lower than the one around it.
fn mixture_at(sample: &Sample, x: f64, y: f64) -> [u32; 3] {
    let forms = landforms(&sample.subdivision.tin, &sample.subdivision.regions);
    let mixture = forms[sample.region_at(x, y) as usize].mixture;
    assert_eq!(mixture.valleys, 0);
    [mixture.tablelands, mixture.ridge_peaks, mixture.basins]
}

/// Numbers of ridges and of canyons in the sub-domain at a place, with w = 1. A line falls from its first point to its last,
/// so that one canyon may be two lines from a saddle on: lines that share a point count once.
fn lines_at(sample: &Sample, x: f64, y: f64) -> (usize, usize) {
    let region = sample.region_at(x, y);
    let lines = skeleton(&sample.subdivision.tin, &sample.subdivision.regions, 1.0, &SkeletonTuning::default()).lines;
    let own = |kind: SkeletonKind| {
        let mut groups: Vec<HashSet<[u64; 2]>> = Vec::new();
        for line in lines.iter().filter(|line| line.kind == kind && line.region == region) {
            let mut group: HashSet<[u64; 2]> = line.points.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
            let (joined, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(|g| !g.is_disjoint(&group));
            group.extend(joined.into_iter().flatten());
            groups = apart;
            groups.push(group);
        }
        groups.len()
    };
    (own(SkeletonKind::Ridge), own(SkeletonKind::Canyon))
}

/// Both lines are convex, so that neither has a place where it turns back: sleeves only, one a piece of line.
#[test]
fn figure_1a_one_to_one() {
    let sample = sample("fig1a_one_to_one");
    check(
        &sample,
        &[
            expected((-300.0, 0.0), &[above(100.0), below(110.0)], 1, Tableland),
            expected((10.0, 5.0), &[above(110.0)], 0, Peak),
        ],
        0,
    );
    let pieces = sample.subdivision.map.contours.iter().map(|c| c.points.len() - 1).sum();
    let between = sample.counts(sample.region_at(-300.0, 0.0));
    assert_eq!(between, Counts { terminal: 0, sleeve: pieces, junction: 0 });
    assert_eq!(lines_at(&sample, -300.0, 0.0), (0, 0));
}

/// The one bay of the upper line is the one place where a line runs: a canyon.
#[test]
fn figure_1b_one_convolution() {
    let sample = sample("fig1b_one_convolution");
    check(
        &sample,
        &[
            expected((0.0, -260.0), &[above(100.0), below(110.0)], 1, Tableland),
            expected((35.0, 150.0), &[above(110.0)], 0, Peak),
        ],
        0,
    );
    let between = sample.region_at(0.0, -260.0);
    assert_eq!(sample.region_at(100.0, -20.0), between, "the bay is open");
    let tips = sample.kept_tips(between);
    assert_eq!(tips.len(), 1);
    // The bay ends in the west, some way in from the upper line's western arm.
    let tip = sample.centre(tips[0]);
    assert!(tip.x < -50.0 && tip.x > -120.0 && tip.y.abs() < 100.0, "{tip}");
    assert_eq!(lines_at(&sample, 0.0, -260.0), (0, 1));
}

/// The upper line swings to and fro five times: four bays between its strokes, by turns from the south and the north.
#[test]
fn figure_1c_many_convolutions() {
    let sample = sample("fig1c_many_convolutions");
    check(
        &sample,
        &[
            expected((0.0, 300.0), &[above(100.0), below(110.0)], 1, Tableland),
            expected((0.0, 0.0), &[above(110.0)], 0, Peak),
        ],
        0,
    );
    let between = sample.region_at(0.0, 300.0);
    let bays = [(-283.0, 1.0), (-94.0, -1.0), (94.0, 1.0), (283.0, -1.0)];
    for (x, _) in bays {
        assert_eq!(sample.region_at(x, 0.0), between);
    }
    let mut tips: Vec<_> = sample.kept_tips(between).into_iter().map(|t| sample.centre(t)).collect();
    tips.sort_by(|a, b| a.x.total_cmp(&b.x));
    assert_eq!(tips.len(), bays.len(), "{tips:?}");
    for (tip, (x, end)) in tips.iter().zip(bays) {
        assert!((tip.x - x).abs() < 50.0 && tip.y * end > 50.0, "{tip} in the bay at {x}");
    }
    assert_eq!(lines_at(&sample, 0.0, 300.0), (0, 4));
}

/// A canyon runs between the hook and the top that it reaches around, from the one junction of three contours to the other.
#[test]
fn figure_1d_two_branches_one_convolution() {
    let sample = sample("fig1d_two_branches_one_convolution");
    check(
        &sample,
        &[
            expected((300.0, 0.0), &[above(100.0), below(110.0)], 2, Branching),
            expected((0.0, 190.0), &[above(110.0)], 0, Peak),
            expected((70.0, -5.0), &[above(110.0)], 0, Peak),
        ],
        0,
    );
    let between = sample.region_at(300.0, 0.0);
    assert_eq!(sample.region_at(50.0, 90.0), between);
    assert_eq!(mixture_at(&sample, 300.0, 0.0), [2, 0, 0]);
    assert!(sample.kept_tips(between).is_empty());
    assert_eq!(lines_at(&sample, 300.0, 0.0), (0, 1));
}

/// Four junctions hold three tops and the line around them together; the bays of the lower line between its three lobes
/// are open to the hull and hold a canyon each.
#[test]
fn figure_1e_three_branches() {
    let sample = sample("fig1e_three_branches");
    let bays = [(0.0, -260.0), (260.0, 160.0), (-260.0, 160.0)];
    let mut wanted = vec![
        expected((0.0, 0.0), &[above(100.0), below(110.0)], 3, Branching),
        expected((0.0, 270.0), &[above(110.0)], 0, Peak),
        expected((290.0, -135.0), &[above(110.0)], 0, Peak),
        expected((-290.0, -135.0), &[above(110.0)], 0, Peak),
    ];
    wanted.extend(bays.map(|bay| expected(bay, &[below(100.0)], 0, Bottom)));
    check(&sample, &wanted, 0);
    let between = sample.region_at(0.0, 0.0);
    assert_eq!(sample.counts(between).junction, 4);
    assert_eq!(mixture_at(&sample, 0.0, 0.0), [3, 0, 0]);
    assert!(sample.kept_tips(between).is_empty());
    for (x, y) in bays {
        assert_eq!(lines_at(&sample, x, y), (0, 1));
    }
}

/// Eight lines, eight sub-domains: two of one level may be a tableland's, a ridge-peak's or a hollow's.
#[test]
fn figure_1f_nested() {
    let sample = sample("fig1f_nested");
    check(
        &sample,
        &[
            expected((-700.0, 0.0), &[above(100.0), below(110.0)], 3, Branching),
            // The stepped hill: tableland and peak.
            expected((-580.0, 60.0), &[above(110.0), below(120.0)], 1, Tableland),
            expected((-400.0, 70.0), &[above(120.0)], 0, Peak),
            // The crater: ridge-peak, basin, bottom.
            expected((545.0, 90.0), &[above(110.0)], 1, RidgePeak),
            expected((460.0, 95.0), &[above(100.0), below(110.0)], 1, Basin),
            expected((350.0, 95.0), &[below(100.0)], 0, Bottom),
            // The hollow: basin and bottom.
            expected((90.0, -240.0), &[above(90.0), below(100.0)], 1, Basin),
            expected((-15.0, -245.0), &[below(90.0)], 0, Bottom),
        ],
        0,
    );
    assert_eq!(mixture_at(&sample, -700.0, 0.0), [2, 1, 0]);
    // One ridge runs around the rim of the crater; it is closed, and without any tip.
    assert_eq!(lines_at(&sample, 545.0, 90.0), (1, 0));
    assert_eq!(sample.counts(sample.region_at(545.0, 90.0)).terminal, 0);
    // A canyon lies between the hill and the crater, a ridge between the hollow and the outermost line.
    assert_eq!(lines_at(&sample, -700.0, 0.0), (1, 1));
}

/// Three spurs of the lower line are ridges (I), the ground between the two tops is a canyon (II).
#[test]
fn figure_5ab_two_branches_with_ridges_and_a_canyon() {
    let sample = sample("fig5ab_two_branches_ridges_canyon");
    // Bays of the lower line on both sides of the saddle, and on both sides of each spur that is not between those two.
    check(
        &sample,
        &[
            expected((0.0, 0.0), &[above(100.0), below(110.0)], 2, Branching),
            expected((-140.0, 10.0), &[above(110.0), below(120.0)], 1, Tableland),
            expected((-250.0, 15.0), &[above(120.0)], 0, Peak),
            expected((245.0, 15.0), &[above(110.0)], 0, Peak),
        ],
        6,
    );
    let between = sample.region_at(0.0, 0.0);
    let tips: Vec<_> = sample.kept_tips(between).into_iter().map(|t| sample.centre(t)).collect();
    assert_eq!(tips.len(), 3, "{tips:?}");
    for spur in [(-630.0, 120.0), (-180.0, 435.0), (695.0, 120.0)] {
        let spur = glam::DVec2::from(spur);
        assert!(tips.iter().any(|tip| tip.distance(spur) < 45.0), "{spur} in {tips:?}");
    }
    assert_eq!(mixture_at(&sample, 0.0, 0.0), [2, 0, 0]);
    assert_eq!(lines_at(&sample, 0.0, 0.0), (3, 1));
}

/// Canyons lead up between three tops (III), a basin lies between them (IV), ridges on the rim of the basin (V).
#[test]
fn figure_5cd_three_branches_with_a_basin() {
    let sample = sample("fig5cd_three_branches_basin");
    // Polar coordinates, degrees from east: tops at 90, 210 and 330, canyons half-way between them.
    let at = |degrees: f64, radius: f64| {
        let p = radius * glam::DVec2::from_angle(degrees.to_radians());
        (p.x, p.y)
    };
    let mut wanted = vec![
        expected(at(30.0, 220.0), &[above(100.0), below(110.0)], 4, Branching),
        expected((120.0, 0.0), &[above(90.0), below(100.0)], 1, Basin),
        expected((0.0, 0.0), &[below(90.0)], 0, Bottom),
    ];
    wanted.extend([90.0, 210.0, 330.0].map(|top| expected(at(top, 400.0), &[above(110.0)], 0, Peak)));
    wanted.extend([30.0, 150.0, 270.0].map(|canyon| expected(at(canyon, 400.0), &[below(100.0)], 0, Bottom)));
    check(&sample, &wanted, 0);
    let (x, y) = at(30.0, 220.0);
    let between = sample.region_at(x, y);
    assert_eq!(mixture_at(&sample, x, y), [3, 1, 0]);
    assert_eq!((sample.counts(between).junction, sample.counts(between).terminal), (6, 0));
    // One ridge on the rim below the head of each canyon.
    assert_eq!(lines_at(&sample, x, y), (3, 0));
    for (x, y) in [30.0, 150.0, 270.0].map(|canyon| at(canyon, 400.0)) {
        assert_eq!(lines_at(&sample, x, y), (0, 1));
    }
}
