//! New contours with fewer vertices: their course is that of the traced lines, within the tolerance, and none cross.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use glam::DVec2;
use tokosen::contour::Target;
use tokosen::contour::{ContourLine, Source};
use tokosen::layers::{LayerParams, SIMPLIFIED, contour_layers};
use tokosen::surface::{Given, Surface, SurfaceParams, build};

use crate::common::{self, Course};
use crate::guarantees::{clean_map, map_of};

fn new_lines(surface: &Surface, step: f64, simplify: Option<f64>) -> Vec<ContourLine> {
    let targets = vec![Target::Interval { step, base: 0.0 }];
    let layer =
        contour_layers(surface, &LayerParams { targets, simplify, ..LayerParams::default() }, &()).unwrap().remove(0);
    layer.lines.into_iter().filter(|line| line.source == Source::Interpolated).collect()
}

#[test]
fn simplified_lines_follow_the_traced_ones_within_the_tolerance_and_do_not_cross() {
    let (mut before, mut after, mut largest) = (0, 0, 0.0_f64);
    for terrain in (1..4).flat_map(common::all_kinds) {
        let contours = terrain.contours();
        let Ok(report) = build(clean_map(map_of(&contours)), &Given::default(), &SurfaceParams::default(), &()) else {
            continue;
        };
        let (surface, step) = (report.value, quarter_of_interval(&contours));
        let traced = new_lines(&surface, step, Some(0.0));
        for tolerance in [0.01, 0.1, 10.0] {
            let simplified = new_lines(&surface, step, Some(tolerance));
            assert_eq!(traced.len(), simplified.len());
            for (line, thin) in traced.iter().zip(&simplified) {
                assert_eq!(line.elevation, thin.elevation);
                assert_eq!([line.points.first(), line.points.last()], [thin.points.first(), thin.points.last()]);
                let [course, thin_course] = [line, thin].map(|line| Course::of([&line.points[..]]));
                let off = line.points.iter().map(|&p| thin_course.distance(p));
                let back = thin.points.iter().map(|&p| course.distance(p));
                let farthest = off.chain(back).fold(0.0, f64::max);
                assert!(farthest <= tolerance + 1e-9, "{farthest} with {tolerance}");
                largest = largest.max(farthest / tolerance);
                (before, after) = (before + line.points.len(), after + thin.points.len());
            }
            let pairs: Vec<_> = simplified.into_iter().map(|line| (line.elevation, line.points)).collect();
            let given = surface.map.contours.iter().map(|contour| (contour.elevation, contour.points.clone()));
            let all: Vec<_> = pairs.iter().cloned().chain(given).collect();
            assert!(common::crossings(&all).is_empty(), "{:?}", common::crossings(&all));
            assert!(common::same_level_crossings(&pairs).is_empty());
        }
        // The tolerance that is usual leaves fewer vertices than none.
        assert!(
            SIMPLIFIED > 0.0 && count(&new_lines(&surface, step, None)) <= count(&new_lines(&surface, step, Some(0.0)))
        );
    }
    assert!(before > 100_000, "{before} vertices were compared");
    assert!(after < before * 2 / 3, "{after} of {before} vertices stay");
    assert!(largest > 0.5, "the tolerance is used");
}

fn count(lines: &[ContourLine]) -> usize {
    lines.iter().map(|line| line.points.len()).sum()
}

/// A quarter of the contour interval.
fn quarter_of_interval(contours: &[(f64, Vec<DVec2>)]) -> f64 {
    let mut levels: Vec<f64> = contours.iter().map(|(level, _)| *level).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    levels.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min) / 4.0
}
