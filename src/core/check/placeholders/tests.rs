//! Placeholders among real levels, and real levels that look like them.

use glam::{DVec2, DVec3};

use crate::check::placeholders::*;
use crate::contour::SoftSpot;

fn line(elevation: f64, points: &[(f64, f64)]) -> Contour {
    Contour { elevation, points: points.iter().map(|&p| p.into()).collect(), feature: 7.into() }
}

/// Wavy contours from west to east in a square of 1000, one each 1000 / n.
fn slope(levels: &[f64]) -> Vec<Contour> {
    let n = levels.len() as f64;
    let course = |k: usize| {
        let y = move |x: f64| 1000.0 * (k as f64 + 0.5) / n + 10.0 * (x / 90.0).sin();
        (0..=20).map(|i| 50.0 * f64::from(i)).map(move |x| DVec2::new(x, y(x))).collect()
    };
    (0..levels.len()).map(|k| Contour { elevation: levels[k], points: course(k), feature: (k as u64).into() }).collect()
}

fn levels(from: f64, step: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| from + step * k as f64).collect()
}

/// A square around the slope, `away` from it.
fn frame(elevation: f64, away: f64) -> Contour {
    let (low, high) = (-away, 1000.0 + away);
    line(elevation, &[(low, low), (high, low), (high, high), (low, high), (low, low)])
}

/// The elevations of the lines and spot heights that are left out.
fn out(contours: Vec<Contour>, spots: &[f64], named: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let spots: Vec<DVec3> = spots.iter().map(|z| DVec3::new(500.0, 500.0, *z)).collect();
    let soft_spots = spots.iter().map(|&place| SoftSpot { place, sigma: 1.0 }).collect();
    let mut map = ContourMap { contours, spots, soft_spots, ..ContourMap::default() };
    let before = map.clone();
    let found = placeholders(&map, named);
    assert_eq!(found.spots, found.soft_spots);
    let lines = found.lines.iter().map(|&k| before.contours[k as usize].elevation).collect();
    let spots = found.spots.iter().map(|&k| before.spots[k as usize].z).collect();
    let counts = [found.lines.len(), found.spots.len()];
    let findings = found.leave_out(&mut map);
    assert_eq!(findings.len(), counts[0] + 2 * counts[1]);
    assert!(findings.iter().all(|f| f.kind == FindingKind::ZeroElevation && f.place.is_some()));
    assert_eq!(map.contours.len() + counts[0], before.contours.len());
    assert_eq!(map.spots.len() + counts[1], before.spots.len());
    (lines, spots)
}

#[test]
fn numbers_for_no_data_are_left_out_whatever_their_share() {
    for z in [-9999.0, -32_768.0, 9999.0, 99_999.0, -999.0, -99.0, 1e38, -f64::from(f32::MAX), f64::MAX, 65_535.0] {
        let (lines, spots) = out([slope(&levels(300.0, 20.0, 10)), vec![frame(z, 20.0)]].concat(), &[z, 310.0], &[]);
        assert_eq!((lines, spots), (vec![z], vec![z]), "{z}");
    }
    // More lines without an elevation than with one, and only one level beside them.
    let many = [slope(&[300.0, 320.0]), slope(&[-9999.0; 5])].concat();
    assert_eq!(out(many, &[], &[]).0, [-9999.0; 5]);
    assert_eq!(
        out([slope(&[300.0]), vec![frame(-9999.0, 9.0)]].concat(), &[-9999.0], &[]),
        (vec![-9999.0], vec![-9999.0])
    );
    // In feet that became metres.
    let feet = crate::base::ElevationUnit::Foot.metres(-9999.0);
    assert_eq!(out([slope(&levels(300.0, 6.096, 9)), vec![frame(feet, 9.0)]].concat(), &[], &[]).0, [feet]);
}

#[test]
fn zero_is_left_out_where_the_ground_is_not_at_zero() {
    let high = || slope(&levels(300.0, 20.0, 10));
    assert_eq!(out([high(), vec![frame(0.0, 50.0)]].concat(), &[0.0, 305.0], &[]), (vec![0.0], vec![0.0]));
    // A coast: its neighbours are there, or it is named.
    assert_eq!(out(slope(&levels(0.0, 20.0, 10)), &[0.0, -1.0], &[]), (vec![], vec![]));
    assert_eq!(out([high(), vec![frame(0.0, 50.0)]].concat(), &[0.0], &[0.0]), (vec![], vec![]));
    // A spot on the beach below a coast that begins at 2 m.
    assert_eq!(out(slope(&levels(2.0, 2.0, 10)), &[0.0], &[]).1, Vec::<f64>::new());
    // Most lines are at 0: these are the map's own, and the others may be wrong.
    assert_eq!(out([slope(&[0.0; 5]), slope(&levels(900.0, 50.0, 2))].concat(), &[], &[]).0, Vec::<f64>::new());
}

#[test]
fn the_neat_line_of_a_low_map_is_no_coast() {
    let low = || slope(&levels(10.0, 10.0, 10));
    assert_eq!(out([low(), vec![frame(0.0, 50.0)]].concat(), &[], &[]).0, [0.0]);
    // Its four sides as lines of their own, of which those along the contours' ends are certain.
    let sides = [[(-9.0, -9.0), (-9.0, 1009.0)], [(1009.0, -9.0), (1009.0, 1009.0)]].map(|side| line(0.0, &side));
    assert_eq!(out([low(), sides.to_vec()].concat(), &[], &[]).0, [0.0, 0.0]);
    // A frame that is turned a little, with vertices on its sides.
    let turned = |points: Vec<DVec2>| points.into_iter().map(|p| DVec2::from_angle(0.02).rotate(p)).collect();
    let dense = (0..=40).map(|k| {
        let (side, t) = (k / 10 % 4, f64::from(k % 10) / 10.0);
        let corner = [DVec2::splat(-20.0), DVec2::new(1020.0, -20.0), DVec2::splat(1020.0), DVec2::new(-20.0, 1020.0)];
        corner[side as usize].lerp(corner[(side as usize + 1) % 4], if k == 40 { 0.0 } else { t })
    });
    let mut map = [low(), vec![Contour { points: dense.collect(), ..frame(0.0, 0.0) }]].concat();
    map.iter_mut().for_each(|line| line.points = turned(std::mem::take(&mut line.points)));
    assert_eq!(out(map, &[], &[]).0, [0.0]);
    // Two sheets beside each other, each with its frame.
    let sheet = |file: u32, east: f64| {
        let moved = |line: Contour| Contour {
            points: line.points.iter().map(|p| *p + DVec2::new(east, 0.0)).collect(),
            feature: line.feature.in_file(file),
            ..line
        };
        [low(), vec![frame(0.0, 5.0)]].concat().into_iter().map(moved).collect::<Vec<_>>()
    };
    assert_eq!(out([sheet(1, 0.0), sheet(2, 1000.0)].concat(), &[], &[]).0, [0.0, 0.0]);
    // A straight shore below, a square island, and a line at 0 through the middle are judged by the ground.
    let mut shore = low();
    shore.push(line(0.0, &[(0.0, -40.0), (1000.0, -40.0)]));
    assert_eq!(out(shore, &[], &[]).0, Vec::<f64>::new());
    let island = (0..5).map(|k| frame(10.0 * f64::from(k), -50.0 * f64::from(k))).collect();
    assert_eq!(out(island, &[], &[]).0, Vec::<f64>::new());
    assert_eq!(out([low(), vec![line(0.0, &[(500.0, 0.0), (500.0, 1000.0)])]].concat(), &[], &[]).0, Vec::<f64>::new());
}

#[test]
fn a_file_in_millimetres_has_no_placeholders() {
    assert_eq!(out(slope(&levels(97_500.0, 2500.0, 9)), &[103_000.0], &[]), (vec![], vec![]));
    assert_eq!(out(slope(&levels(297_500.0, 2500.0, 9)), &[303_000.0], &[]), (vec![], vec![]));
    let odd = [slope(&levels(97_500.0, 2500.0, 9)), vec![frame(4e6, 9.0)]].concat();
    assert_eq!(out(odd, &[], &[]).0, [4e6]);
}

#[test]
fn heights_alone_show_numbers_for_no_data() {
    let judged = placeholder_heights(&[300.0, 0.0, 340.0, -9999.0, 420.0, f64::MAX]);
    assert_eq!(judged, [false, true, false, true, false, true]);
    assert_eq!(placeholder_heights(&[0.0, 3.0, 12.0, -1.0]), [false; 4]);
    assert_eq!(placeholder_heights(&[-9999.0, -9999.0]), [false; 2]);
}
