//! Landforms: number, class and nesting of sub-domains where they are known by hand, and outlines that tile the frame.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeMap;
use std::path::Path;

use geo::{Area, Contains, Relate, line_string, point};
use glam::DVec2;
use tokosen::base::error::FindingKind;
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::{Contour, ContourMap};
use tokosen::io::{ReadOptions, read_contours};
use tokosen::subdivision::{Subdivision, subdivide};
use tokosen::subdomains::LandformClass::{Basin, Bottom, Branching, Peak, RidgePeak, Slope, Tableland, Valley};
use tokosen::subdomains::{BorderKind, Frame, Landform, LandformClass, landforms};

use crate::common;
use crate::guarantees::{Refusal, Tally};

fn subdivision(map: ContourMap, frame: &Frame) -> Subdivision {
    let map = clean(map, &CleanParams::default()).unwrap().value;
    let report = subdivide(map, frame, &()).unwrap();
    let is_odd = |kind| kind == FindingKind::WrongLabel;
    let odd: Vec<_> = report.findings.iter().filter(|f| is_odd(f.kind)).collect();
    assert!(odd.is_empty(), "{odd:?}");
    report.value
}

fn sample(name: &str) -> Subdivision {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name);
    subdivision(read_contours(&path, &ReadOptions::default()).unwrap().value, &Frame::Hull)
}

fn map_of(lines: Vec<(f64, Vec<DVec2>)>) -> ContourMap {
    let contours = lines.into_iter().map(|(elevation, points)| Contour { elevation, points, feature: 0.into() });
    ContourMap { contours: contours.collect(), ..ContourMap::default() }
}

/// A ring around a centre.
fn ring(level: f64, x: f64, y: f64, radius: f64) -> (f64, Vec<DVec2>) {
    let at = |k: i32| DVec2::new(x, y) + radius * DVec2::from_angle(f64::from(k % 48) * std::f64::consts::TAU / 48.0);
    (level, (0..=48).map(at).collect())
}

/// The outline of a landform.
fn polygon(subdivision: &Subdivision, form: &Landform) -> geo::Polygon<f64> {
    let line = |ring: &tokosen::subdomains::Ring| ring.points(&subdivision.tin).iter().map(|p| (p.x, p.y)).collect();
    geo::Polygon::new(line(&form.rings[0]), form.rings[1..].iter().map(line).collect())
}

/// Sub-domains inside closed contours: how many of each class and depth.
fn closed(subdivision: &Subdivision) -> Vec<(LandformClass, u32, usize)> {
    let mut counts: BTreeMap<(u32, LandformClass), usize> = BTreeMap::new();
    for form in landforms(&subdivision.tin, &subdivision.regions).iter().filter(|f| !f.is_open) {
        *counts.entry((form.depth, form.class)).or_default() += 1;
    }
    counts.into_iter().map(|((depth, class), count)| (class, depth, count)).collect()
}

/// The landform at a place.
fn at(subdivision: &Subdivision, x: f64, y: f64) -> Landform {
    let mut found = landforms(&subdivision.tin, &subdivision.regions);
    found.retain(|f| polygon(subdivision, f).contains(&point!(x: x, y: y)));
    assert_eq!(found.len(), 1, "at {x} {y}");
    found.remove(0)
}

#[test]
fn drawn_shapes_have_the_classes_of_the_paper() {
    for (name, expected) in [
        ("fig1a_one_to_one", vec![(Tableland, 0, 1), (Peak, 1, 1)]),
        ("fig1b_one_convolution", vec![(Tableland, 0, 1), (Peak, 1, 1)]),
        ("fig1c_many_convolutions", vec![(Tableland, 0, 1), (Peak, 1, 1)]),
        ("fig1d_two_branches_one_convolution", vec![(Branching, 0, 1), (Peak, 1, 2)]),
        ("fig1e_three_branches", vec![(Branching, 0, 1), (Peak, 1, 3)]),
        (
            "fig1f_nested",
            vec![
                (Branching, 0, 1),
                (Tableland, 1, 1),
                (Basin, 1, 1),
                (RidgePeak, 1, 1),
                (Peak, 2, 1),
                (Bottom, 2, 1),
                (Basin, 2, 1),
                (Bottom, 3, 1),
            ],
        ),
        ("fig5ab_two_branches_ridges_canyon", vec![(Branching, 0, 1), (Peak, 1, 1), (Tableland, 1, 1), (Peak, 2, 1)]),
        ("fig5cd_three_branches_basin", vec![(Branching, 0, 1), (Peak, 1, 3), (Basin, 1, 1), (Bottom, 2, 1)]),
    ] {
        let subdivision = sample(&format!("{name}.geojson"));
        assert_eq!(closed(&subdivision), expected, "{name}");
        check(&subdivision, name);
    }
}

#[test]
fn pits_are_found_without_help() {
    // A crater with a central peak; a pit in a plateau; a pit within that pit.
    let crater = [ring(100.0, 0.0, 0.0, 100.0), ring(110.0, 0.0, 0.0, 90.0), ring(110.0, 0.0, 0.0, 80.0)];
    let inside = [ring(100.0, 0.0, 0.0, 70.0), ring(100.0, 0.0, 0.0, 30.0), ring(110.0, 0.0, 0.0, 20.0)];
    let subdivision = subdivision(map_of(crater.into_iter().chain(inside).collect()), &Frame::Hull);
    let expected =
        [(Tableland, 0, 1), (RidgePeak, 1, 1), (Basin, 2, 1), (Valley, 3, 1), (Tableland, 4, 1), (Peak, 5, 1)];
    assert_eq!(closed(&subdivision), expected);
    check(&subdivision, "crater");

    let plateau = [ring(100.0, 0.0, 0.0, 100.0), ring(110.0, 0.0, 0.0, 80.0), ring(110.0, -30.0, 0.0, 10.0)];
    let deep = [ring(110.0, 30.0, 0.0, 30.0), ring(100.0, 30.0, 0.0, 25.0), ring(90.0, 30.0, 0.0, 10.0)];
    let subdivision = self::subdivision(map_of(plateau.into_iter().chain(deep).collect()), &Frame::Hull);
    assert_eq!(
        closed(&subdivision),
        [(Tableland, 0, 1), (Branching, 1, 1), (Bottom, 2, 1), (Basin, 2, 1), (Basin, 3, 1), (Bottom, 4, 1)]
    );
    assert_eq!(at(&subdivision, 0.0, 60.0).mixture.to_string(), "ridge-peak 2");
    check(&subdivision, "plateau");
}

#[test]
fn equal_rings_alternate_inwards() {
    let rings = [100.0, 110.0, 110.0, 110.0].into_iter().zip([100.0, 80.0, 60.0, 40.0]);
    let subdivision =
        subdivision(map_of(rings.map(|(level, radius)| ring(level, 0.0, 0.0, radius)).collect()), &Frame::Hull);
    assert_eq!(closed(&subdivision), [(Tableland, 0, 1), (RidgePeak, 1, 1), (Valley, 2, 1), (Peak, 3, 1)]);
}

#[test]
fn sub_domains_that_the_frame_cuts_are_open() {
    let across = |level: f64, y: f64| (level, vec![DVec2::new(-100.0, y), DVec2::new(0.0, y), DVec2::new(100.0, y)]);
    let bay = |level: f64, half: f64, y: f64| {
        (level, vec![DVec2::new(-half, 100.0), DVec2::new(-half, y), DVec2::new(half, y), DVec2::new(half, 100.0)])
    };
    // From the south: a valley between lines of 10, a slope with a knoll, a ridge between lines of 20, and a pit that the
    // northern edge cuts.
    let subdivision = subdivision(
        map_of(vec![
            across(10.0, 0.0),
            across(10.0, 10.0),
            across(20.0, 30.0),
            ring(20.0, 50.0, 20.0, 5.0),
            across(20.0, 50.0),
            across(10.0, 60.0),
            bay(0.0, 60.0, 70.0),
            bay(-10.0, 20.0, 90.0),
        ]),
        &Frame::Hull,
    );
    let class = |x: f64, y: f64| {
        let form = at(&subdivision, x, y);
        (form.class, form.is_open, form.parent.is_some(), form.mixture.to_string())
    };
    assert_eq!(class(0.0, 5.0), (Valley, true, false, String::new()));
    assert_eq!(class(0.0, 20.0), (Branching, true, false, "tableland 2".to_owned()));
    assert_eq!(class(50.0, 20.0), (Peak, false, true, String::new()));
    assert_eq!(class(0.0, 40.0), (RidgePeak, true, false, String::new()));
    assert_eq!(class(0.0, 55.0), (Slope, true, false, String::new()));
    assert_eq!(class(0.0, 65.0), (Slope, true, false, String::new()));
    assert_eq!(class(0.0, 80.0), (Slope, true, false, String::new()));
    assert_eq!(class(0.0, 95.0), (Bottom, true, false, String::new()));
    check(&subdivision, "strips");
}

#[test]
fn the_ground_around_an_outermost_contour_is_no_parent() {
    let rings = || vec![ring(100.0, 0.0, 0.0, 100.0), ring(110.0, 0.0, 0.0, 50.0)];
    for frame in [Frame::Hull, Frame::Box] {
        let subdivision = subdivision(map_of(rings()), &frame);
        assert_eq!(closed(&subdivision), [(Tableland, 0, 1), (Peak, 1, 1)]);
        check(&subdivision, "frame");
    }
    let wide: geo::Polygon<f64> = geo::Polygon::new(
        line_string![(x: -101.0, y: -101.0), (x: 101.0, y: -101.0), (x: 101.0, y: 101.0), (x: -101.0, y: 101.0)],
        vec![],
    );
    let subdivision = subdivision(map_of(rings()), &Frame::Polygon(wide.into()));
    let around = at(&subdivision, 100.5, 100.5);
    assert_eq!((around.class, around.is_open, around.interior_count()), (Tableland, true, 1));
    assert_eq!(
        closed(&subdivision),
        [(Tableland, 1, 1), (Peak, 2, 1)],
        "there the frame's ground encloses the contour"
    );
}

#[test]
fn contours_that_touch_keep_their_own_rings() {
    let square = |level: f64, x: f64, y: f64, h: f64| {
        let corners = [(-h, -h), (h, -h), (h, h), (-h, h), (-h, -h)];
        (level, corners.map(|(u, v)| DVec2::new(x + u, y + v)).to_vec())
    };
    let two = vec![square(100.0, 0.0, 0.0, 100.0), square(110.0, -10.0, -10.0, 10.0), square(110.0, 10.0, 10.0, 10.0)];
    let two = subdivision(map_of(two), &Frame::Hull);
    assert_eq!(closed(&two), [(Branching, 0, 1), (Peak, 1, 2)]);
    assert_eq!(at(&two, 0.0, 60.0).mixture.to_string(), "tableland 2");
    check(&two, "two");

    // Four tops that touch in a circle, around a patch of the lower ground.
    let around = [(-20.0, 0.0), (0.0, -20.0), (20.0, 0.0), (0.0, 20.0)];
    let mut four = vec![square(100.0, 0.0, 0.0, 100.0)];
    four.extend(around.map(|(x, y)| square(110.0, x, y, 10.0)));
    let four = subdivision(map_of(four), &Frame::Hull);
    assert_eq!(closed(&four), [(Bottom, 0, 1), (Tableland, 0, 1), (Peak, 1, 4)]);
    assert_eq!(at(&four, 0.0, 0.0).class, Bottom);
    check(&four, "four");

    // A hollow whose rim touches the line around it.
    let notch = vec![square(100.0, 0.0, 0.0, 100.0), square(110.0, 0.0, 0.0, 50.0), {
        let corners = [(50.0, 50.0), (20.0, 10.0), (10.0, 20.0), (50.0, 50.0)];
        (110.0, corners.map(DVec2::from).to_vec())
    }];
    let notch = subdivision(map_of(notch), &Frame::Hull);
    assert_eq!(closed(&notch), [(Tableland, 0, 1), (RidgePeak, 1, 1), (Bottom, 2, 1)]);
    check(&notch, "notch");
}

#[test]
fn a_line_that_ends_inside_is_no_border() {
    let mut lines = vec![ring(100.0, 0.0, 0.0, 100.0), ring(110.0, 0.0, 0.0, 50.0)];
    lines.push((110.0, vec![DVec2::new(0.0, 60.0), DVec2::new(5.0, 70.0), DVec2::new(0.0, 80.0)]));
    let subdivision = subdivision(map_of(lines), &Frame::Hull);
    assert_eq!(closed(&subdivision), [(Tableland, 0, 1), (Peak, 1, 1)]);
    check(&subdivision, "stub");
}

/// All that holds for the landforms of any map.
fn check(subdivision: &Subdivision, what: &str) {
    let forms = landforms(&subdivision.tin, &subdivision.regions);
    assert_eq!(forms.len(), subdivision.regions.regions.len(), "{what}");
    let mut sum = 0.0;
    let polygons: Vec<geo::Polygon<f64>> = forms.iter().map(|f| polygon(subdivision, f)).collect();
    let frame: f64 = subdivision.frame.area.unsigned_area();
    for (id, (form, polygon)) in forms.iter().zip(&polygons).enumerate() {
        let points = |ring: &geo::LineString<f64>| ring.coords().map(|c| DVec2::new(c.x, c.y)).collect();
        let rings: Vec<(f64, Vec<DVec2>)> =
            polygon.interiors().iter().chain([polygon.exterior()]).map(|ring| (0.0, points(ring))).collect();
        let met = [common::crossings(&rings), common::same_level_crossings(&rings)].concat();
        assert!(met.is_empty(), "{what}: sub-domain {id}: {}", met[0]);
        let outlined: f64 = form.rings.iter().map(|r| r.signed_area(&subdivision.tin)).sum();
        assert!((outlined - form.area).abs() <= 1e-9 * frame, "{what}: {outlined} {}", form.area);
        assert!(form.rings[0].signed_area(&subdivision.tin) > 0.0, "{what}");
        assert!(form.rings[1..].iter().all(|r| r.signed_area(&subdivision.tin) < 0.0), "{what}");
        assert!(form.class != Branching || form.mixture != Default::default(), "{what}");
        sum += form.area;
        let region = &subdivision.regions.regions[id];
        for ring in &form.rings {
            let edges: u32 = ring.borders.iter().map(|b| b.edges).sum();
            assert_eq!(edges as usize, ring.vertices.len(), "{what}");
            for border in &ring.borders {
                if let BorderKind::Contour(level) = border.kind {
                    assert!(region.side(level).is_some(), "{what}: a contour that the sub-domain does not know");
                }
            }
        }
        match form.parent {
            None => assert_eq!(form.depth, 0, "{what}"),
            Some(parent) => {
                assert_eq!(form.depth, forms[parent as usize].depth + 1, "{what}");
                // Its own holes are not filled: a child lies in a hole of its parent.
                let filled = geo::Polygon::new(polygons[parent as usize].exterior().clone(), vec![]);
                assert!(filled.relate(polygon).is_covers(), "{what}: {id} is not inside of {parent}");
            }
        }
    }
    // Triangles along the frame that are flatter than its tolerance do not count.
    let outline: f64 = subdivision.frame.edges().map(|[a, b]| a.distance(b)).sum();
    let flat = subdivision.frame.tolerance() * outline;
    assert!((sum - frame).abs() <= flat.max(1e-9 * frame), "{what}: areas add up to {sum}, the frame has {frame}");
}

#[test]
fn outlines_tile_the_frame_on_any_terrain() {
    let tally = Tally::default();
    for seed in 0..3 {
        for terrain in common::all_kinds(seed) {
            let map = clean(map_of(terrain.contours()), &CleanParams::default()).unwrap().value;
            for frame in [Frame::Hull, Frame::Box] {
                let what = format!("{} {seed} {frame:?}", terrain.kind);
                let allowed = [Refusal::NoContour, Refusal::OneContour, Refusal::OneLevel];
                if let Some(report) = tally.take(subdivide(map.clone(), &frame, &()), &allowed, &what) {
                    check(&report.value, &what);
                }
            }
        }
    }
    tally.assert_share(1.0, 0.0);
}

/// Findings about marks when the features are marked so, and as they stand.
fn contradictions(rings: Vec<(f64, Vec<DVec2>)>, marks: &[(u64, bool)]) -> Vec<String> {
    let mut map = map_of(rings);
    for (contour, feature) in map.contours.iter_mut().zip(0..) {
        contour.feature = u64::into(feature);
    }
    map.depressions = marks.iter().map(|&(feature, mark)| (feature.into(), mark)).collect();
    let map = clean(map, &CleanParams::default()).unwrap().value;
    let findings = subdivide(map, &Frame::Hull, &()).unwrap().findings;
    findings.into_iter().filter(|f| f.kind == FindingKind::DepressionMark).map(|f| f.message).collect()
}

#[test]
fn marks_that_contradict_the_contours_are_told() {
    let crater = || {
        let sizes = [(100.0, 100.0), (110.0, 80.0), (110.0, 60.0), (100.0, 40.0)];
        sizes.map(|(level, radius)| ring(level, 0.0, 0.0, radius)).to_vec()
    };
    let reversed = || crater().into_iter().map(|(level, points)| (level, points.into_iter().rev().collect())).collect();
    let right = [(0, false), (1, false), (2, true), (3, true)];
    assert_eq!(contradictions(crater(), &right), [""; 0]);
    assert_eq!(contradictions(reversed(), &right), [""; 0], "the direction of a line says nothing");
    assert_eq!(contradictions(crater(), &[]), [""; 0]);
    assert_eq!(contradictions(crater(), &[(3, true)]), [""; 0], "features without a mark say nothing");
    let told = contradictions(crater(), &[(1, true), (2, false), (3, true)]);
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(
        told[0].contains("110 m (feature 1) is marked") && told[0].ends_with("show higher ground inside"),
        "{told:?}"
    );
    assert!(
        told[1].contains("110 m (feature 2) is not marked") && told[1].ends_with("show lower ground inside"),
        "{told:?}"
    );
}
