//! Ridge and canyon lines: they fall, they meet, and fewer remain when more are asked to go.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::common::{Terrain, all_kinds};
use glam::DVec2;
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::{Contour, ContourMap, clip};
use tokosen::io::{ReadOptions, read_contours};
use tokosen::skeleton::{LineEnd, Skeleton, SkeletonKind, SkeletonLine, axis_heights, skeleton};
use tokosen::subdivision::{Subdivision, subdivide};
use tokosen::subdomains::{Frame, Side};
use tokosen::surface::{Given, Surface, SurfaceKind, SurfaceParams, build};
use tokosen::tin::VertexKind;
use tokosen::tuning::SkeletonTuning;

fn tiling_of(map: ContourMap) -> Subdivision {
    let map = clean(map, &CleanParams::default()).unwrap().value;
    subdivide(map, &Frame::Hull, &()).unwrap().value
}

fn read(name: &str) -> ContourMap {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name);
    read_contours(&path, &ReadOptions::default()).unwrap().value
}

/// A drawn sample, or a part of the large one.
fn sample(name: &str) -> Subdivision {
    let part = geo::Rect::new((745_000.0, 4_017_500.0), (748_500.0, 4_020_500.0)).to_polygon();
    tiling_of(if name.starts_with("caryville") { clip(read(name), &part.into()).map } else { read(name) })
}

fn of_terrain(terrain: &Terrain) -> Subdivision {
    let contours = terrain.contours().into_iter().enumerate().map(|(i, (elevation, points))| Contour {
        elevation,
        points,
        feature: (i as u64).into(),
    });
    tiling_of(ContourMap { contours: contours.collect(), ..ContourMap::default() })
}

fn lines_of(subdivision: &Subdivision, resolution: f64) -> Skeleton {
    skeleton(&subdivision.tin, &subdivision.regions, resolution, &SkeletonTuning::default())
}

const SAMPLES: [&str; 8] = [
    "fig1a_one_to_one.geojson",
    "fig1b_one_convolution.geojson",
    "fig1c_many_convolutions.geojson",
    "fig1d_two_branches_one_convolution.geojson",
    "fig1e_three_branches.geojson",
    "fig1f_nested.geojson",
    "fig5ab_two_branches_ridges_canyon.geojson",
    "fig5cd_three_branches_basin.geojson",
];

fn bits(p: DVec2) -> [u64; 2] {
    [p.x.to_bits(), p.y.to_bits()]
}

/// Every line falls from each vertex to the next, lies in its band, and its ends are what they say.
fn check(subdivision: &Subdivision, lines: &[SkeletonLine], what: &str) {
    let tin = &subdivision.tin;
    let on_contour = (0..tin.positions.len()).filter(|&v| tin.kinds[v] == VertexKind::Contour);
    let contour: HashMap<[u64; 2], f64> =
        on_contour.map(|v| (bits(tin.point(v as u32).truncate()), tin.heights[v])).collect();
    let mut ends: HashMap<[u64; 2], HashSet<u32>> = HashMap::new();
    for line in lines {
        assert!(line.points.len() >= 2, "{what}");
        let falls = line.points.windows(2).all(|w| w[0].z > w[1].z);
        assert!(falls, "{what}: a {:?} line does not fall: {:?}", line.kind, line.points);
        let band = subdivision.regions.regions[line.region as usize].band;
        for p in &line.points[1..line.points.len() - 1] {
            assert!(band.lo < p.z && p.z < band.hi, "{what}: {} is not inside {band:?}", p.z);
        }
        for (end, p) in line.ends.iter().zip([line.points[0], line.points[line.points.len() - 1]]) {
            let level = contour.get(&bits(p.truncate()));
            assert_eq!(*end == LineEnd::Contour, level == Some(&p.z), "{what}: {end:?} at {p}");
            ends.entry(bits(p.truncate())).or_default().insert(line.network);
        }
    }
    assert!(ends.values().all(|networks| networks.len() == 1), "{what}: lines meet and are not one network");
}

#[test]
fn lines_fall_on_all_kinds_of_terrain() {
    let mut canyons = 0;
    for seed in 0..3 {
        for terrain in all_kinds(seed) {
            let subdivision = of_terrain(&terrain);
            for resolution in [0.0, 1.0, 3.0] {
                let found = lines_of(&subdivision, resolution);
                check(&subdivision, &found.lines, &format!("{} {seed}, w {resolution}", terrain.kind));
                canyons += found.lines.iter().filter(|l| l.kind == SkeletonKind::Canyon).count();
            }
        }
    }
    assert!(canyons > 100, "{canyons}");
}

/// Of the places where lines of one kind reach a contour from one side: how many, and at how many a line of that kind goes on.
fn continued(lines: &[SkeletonLine]) -> (usize, usize) {
    let mut at: HashMap<(bool, [u64; 2]), HashSet<u32>> = HashMap::new();
    for line in lines {
        for (end, p) in line.ends.iter().zip([line.points[0], line.points[line.points.len() - 1]]) {
            if *end == LineEnd::Contour {
                at.entry((line.kind == SkeletonKind::Ridge, bits(p.truncate()))).or_default().insert(line.region);
            }
        }
    }
    (at.len(), at.values().filter(|regions| regions.len() > 1).count())
}

/// The same for lines that arrive from the contour before: down canyons, up ridges.
fn arrivals(lines: &[SkeletonLine]) -> (usize, usize) {
    let at = |l: &SkeletonLine, lower: bool| if lower { l.points[l.points.len() - 1] } else { l.points[0] };
    let on_contour = |l: &SkeletonLine, lower: bool| l.ends[usize::from(lower)] == LineEnd::Contour;
    let key = |l: &SkeletonLine, lower: bool| (l.kind, bits(at(l, lower).truncate()));
    let down = |l: &SkeletonLine| l.kind == SkeletonKind::Canyon;
    let starts: HashSet<_> = lines.iter().filter(|l| on_contour(l, !down(l))).map(|l| key(l, !down(l))).collect();
    let ends: HashSet<_> = lines.iter().filter(|l| on_contour(l, down(l))).map(|l| key(l, down(l))).collect();
    (ends.len(), ends.intersection(&starts).count())
}

#[test]
fn lines_go_on_from_sub_domain_to_sub_domain() {
    let subdivision = tiling_of(read("caryville_20m.gpkg"));
    let found = lines_of(&subdivision, 1.0);
    check(&subdivision, &found.lines, "caryville");
    let (places, shared) = continued(&found.lines);
    assert!(4 * shared > places, "{shared} of {places} ends at contours");
    let (arrivals, shared) = arrivals(&found.lines);
    assert!(2 * shared > arrivals, "{shared} of {arrivals} ends at the next contour");
    assert_eq!(
        left_behind(&subdivision, &found),
        0,
        "lines stop at a contour although a line that was kept can be reached beyond"
    );
}

/// How many lines stop at the next contour although flat triangles lead from there to a line beyond. Where all of the bend
/// beyond was eliminated, or there is none, a line rightly stops.
fn left_behind(subdivision: &Subdivision, found: &Skeleton) -> usize {
    let (tin, regions) = (&subdivision.tin, &subdivision.regions);
    let mut around: HashMap<[u64; 2], Vec<(u32, usize)>> = HashMap::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for (k, v) in tin.triangles[t as usize].into_iter().enumerate() {
            around.entry(bits(tin.point(v).truncate())).or_default().push((t, k));
        }
    }
    // The upper end of a canyon and the lower end of a ridge start at the tip of a bend, the others arrive.
    let mut starts = HashSet::new();
    let mut ends = Vec::new();
    for line in &found.lines {
        let points = [line.points[0], line.points[line.points.len() - 1]];
        for (k, p) in points.into_iter().enumerate().filter(|(k, _)| line.ends[*k] == LineEnd::Contour) {
            if (k == 0) == (line.kind == SkeletonKind::Ridge) {
                ends.push((line, p));
            } else {
                starts.insert((line.kind, bits(p.truncate())));
            }
        }
    }
    let leads_on = |(line, p): &(&SkeletonLine, glam::DVec3)| {
        let way = if line.kind == SkeletonKind::Ridge { Side::Above } else { Side::Below };
        let flat = |t: u32| tin.corner_heights(t).iter().all(|&h| h == p.z);
        let beyond = |t: u32| {
            let region = regions.of_triangle[t as usize];
            region != line.region && regions.regions[region as usize].side(p.z) == Some(way)
        };
        let fan = around[&bits(p.truncate())].iter();
        let first = fan.filter(|&&(t, k)| beyond(t) && flat(t) && tin.across(t, (k + 1) % 3).is_some()).map(|f| f.0);
        let mut stack: Vec<u32> = first.collect();
        let mut seen: HashSet<u32> = stack.iter().copied().collect();
        while let Some(t) = stack.pop() {
            if !found.elimination.dropped[t as usize] {
                return true;
            }
            stack.extend((0..3).filter_map(|i| tin.across(t, i)).filter(|&n| flat(n) && seen.insert(n)));
        }
        false
    };
    ends.retain(|(line, p)| !starts.contains(&(line.kind, bits(p.truncate()))));
    ends.iter().filter(|end| leads_on(end)).count()
}

#[test]
fn more_resolution_leaves_fewer_and_shorter_lines() {
    for name in SAMPLES.into_iter().chain(["caryville_20m.gpkg"]) {
        let subdivision = sample(name);
        let totals: Vec<(f64, usize, f64)> = [0.0, 0.3, 0.5, 0.7, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0]
            .into_iter()
            .map(|w| {
                let lines = lines_of(&subdivision, w).lines;
                (w, lines.len(), lines.iter().map(SkeletonLine::length).sum())
            })
            .collect();
        // Where nothing more is dropped, the lengths may be summed in another order.
        let falls = totals.windows(2).all(|p| p[1].1 <= p[0].1 && p[1].2 <= p[0].2 * (1.0 + 1e-12));
        let last = totals[totals.len() - 1];
        assert!(falls, "{name}: {totals:?}");
        // Where bends branch, something goes.
        let branches = name.starts_with("caryville") || name.starts_with("fig5ab");
        assert!(!branches || last.1 < totals[0].1 && last.2 < totals[0].2, "{name}: {totals:?}");
    }
}

#[test]
fn the_surface_has_the_same_lines() {
    let subdivision = sample("fig5ab_two_branches_ridges_canyon.geojson");
    let found = lines_of(&subdivision, 1.0);
    for kind in [SurfaceKind::Skeleton, SurfaceKind::Spline] {
        let surface =
            build(subdivision.map.clone(), &Given::default(), &SurfaceParams { kind, ..SurfaceParams::default() }, &())
                .unwrap()
                .value;
        if kind == SurfaceKind::Skeleton {
            assert_eq!(surface.skeleton_lines, found.lines);
        }
        let length = |lines: &[SkeletonLine]| lines.iter().map(|l| l.length()).sum::<f64>();
        let (own, paper) = (length(&surface.skeleton_lines), length(&found.lines));
        assert!((own - paper).abs() < 1e-9 * paper, "{own} {paper}");
        check_heights(&surface);
    }
}

/// The lines of a surface fall, and the triangulation has their heights.
fn check_heights(surface: &Surface) {
    let height: HashMap<[u64; 2], f64> = (0..surface.tin.positions.len() as u32)
        .map(|v| (bits(surface.tin.point(v).truncate()), surface.tin.heights[v as usize]))
        .collect();
    for line in &surface.skeleton_lines {
        assert!(line.points.windows(2).all(|w| w[0].z > w[1].z), "{:?}", line.points);
        for p in &line.points {
            assert_eq!(height.get(&bits(p.truncate())), Some(&p.z));
        }
    }
}

/// The nearest point of a segment.
fn nearest(p: DVec2, [a, b]: [DVec2; 2]) -> DVec2 {
    a + (b - a) * ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0)
}

/// Whether two segments cross, other than by touching.
fn crosses([p, q]: [DVec2; 2], [a, b]: [DVec2; 2]) -> bool {
    let near = 1e-9 * p.distance(q) * (a.distance(b) + p.distance(q));
    let turn = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
    let apart = |x: f64, y: f64| (x > near && y < -near) || (x < -near && y > near);
    apart(turn(p, q, a), turn(p, q, b)) && apart(turn(a, b, p), turn(a, b, q))
}

/// Whether a segment lies in a union of triangles, their borders included.
fn covered([p, q]: [DVec2; 2], triangles: &[[DVec2; 3]]) -> bool {
    let way = q - p;
    let near = 1e-9 * way.length();
    // The part of the segment in each triangle, as shares of its length.
    let mut parts: Vec<[f64; 2]> = Vec::new();
    for c in triangles {
        let [mut from, mut to] = [0.0f64, 1.0];
        for k in 0..3 {
            let edge = (c[(k + 1) % 3] - c[k]).normalize();
            let (inside, rate) = (edge.perp_dot(p - c[k]) + near, edge.perp_dot(way));
            if rate.abs() <= near {
                to = if inside < 0.0 { 0.0 } else { to };
            } else if rate > 0.0 {
                from = from.max(-inside / rate);
            } else {
                to = to.min(-inside / rate);
            }
        }
        if from < to {
            parts.push([from, to]);
        }
    }
    parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let reached =
        parts.iter().fold(0.0f64, |reached, p| if p[0] > reached + 1e-7 { reached } else { reached.max(p[1]) });
    reached > 1.0 - 1e-7
}

#[test]
fn equation_1_takes_the_nearest_contours_in_sight() {
    let (mut compared, mut blocked) = (0, 0);
    // On caryville many sights run along a row of the grid that the contours were cut from, through vertices of contours.
    for name in SAMPLES.into_iter().chain(["caryville_20m.gpkg"]) {
        let subdivision = sample(name);
        let (tin, regions) = (&subdivision.tin, &subdivision.regions);
        let mut borders: HashMap<u32, Vec<(f64, [DVec2; 2])>> = HashMap::new();
        let mut ground: HashMap<u32, Vec<[DVec2; 3]>> = HashMap::new();
        for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
            ground.entry(regions.of_triangle[t as usize]).or_default().push(tin.corners(t));
            for i in 0..3 {
                if let Some(level) = tin.contour_level(t, i) {
                    let segment = tin.edge(t, i).map(|v| tin.positions[v as usize]);
                    borders.entry(regions.of_triangle[t as usize]).or_default().push((level, segment));
                }
            }
        }
        let points = lines_of(&subdivision, 1.0).axis.points;
        let heights = axis_heights(tin, regions, &points, &SkeletonTuning::default());
        for (p, height) in points.iter().zip(heights) {
            let border = &borders[&p.region];
            let own = p.level.unwrap();
            let region = &regions.regions[p.region as usize];
            let above = region.side(own) == Some(Side::Above);
            // The distance to what can be seen of some levels, or else, if nothing of them is in sight, to the nearest.
            let mut distance = |wanted: &dyn Fn(f64) -> bool| {
                let mut sorted: Vec<(f64, f64, DVec2)> = border
                    .iter()
                    .filter(|(level, _)| wanted(*level))
                    .map(|(level, s)| (p.position.distance(nearest(p.position, *s)), *level, nearest(p.position, *s)))
                    .collect();
                sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
                // Where a sight crosses a contour in a vertex, it crosses no segment of it: hence the second test.
                let sees = |to: DVec2| {
                    let sight = [p.position, to];
                    !border.iter().any(|(_, s)| crosses(sight, *s)) && covered(sight, &ground[&p.region])
                };
                let seen = sorted.iter().position(|s| sees(s.2));
                blocked += usize::from(seen != Some(0));
                sorted.get(seen.unwrap_or(0)).map(|s| (s.0, s.1))
            };
            let other = distance(&|level| if above { level > own } else { level < own });
            let Some((far, level)) = other else { continue };
            let Some((near, _)) = distance(&|level| level == own) else { continue };
            let expected = region.band.strictly_inside((own * far + level * near) / (far + near));
            let at = p.position + tin.origin;
            assert!((height - expected).abs() < 1e-9, "{name} at {at}: {height}, not {expected}");
            compared += 1;
        }
    }
    println!("{compared} points compared, {blocked} times the nearest segment was out of sight");
    assert!(compared > 100 && blocked > 0, "{compared}, {blocked}");
}

/// Text, number or nothing of a row.
fn rows(file: &Path, query: &str) -> Vec<Vec<rusqlite::types::Value>> {
    let db = rusqlite::Connection::open(file).unwrap();
    let mut statement = db.prepare(query).unwrap();
    let columns = statement.column_count();
    let rows = statement.query_map([], |row| (0..columns).map(|i| row.get(i)).collect());
    rows.unwrap().map(|row| row.unwrap()).collect()
}

#[test]
fn the_command_writes_all_layers() {
    let folder = tempfile::tempdir().unwrap();
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/samples/caryville_20m.gpkg");
    let part = ["densify", sample, "-i", "20", "--extent", "745000,4017500,748500,4020500", "-o", "part.gpkg"];
    assert_cmd::cargo::cargo_bin_cmd!("tokosen").current_dir(folder.path()).args(part).assert().success();
    let run = |arguments: &str| {
        let mut command = assert_cmd::cargo::cargo_bin_cmd!("tokosen");
        command.current_dir(folder.path()).args(["skeleton", "part.gpkg"]).args(arguments.split_whitespace());
        let output = command.output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned() + &text)
    };
    let (status, said) = run("-o all.gpkg --triangles --curve-mesh --preview look.png");
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("ridges") && said.contains("canyons") && said.contains("layer curve_mesh"), "{said}");
    assert!(folder.path().join("look.png").exists());
    let file = folder.path().join("all.gpkg");
    let lines =
        rows(&file, "SELECT kind, region, network, length, upper_end, upper_z, lower_end, lower_z FROM skeleton");
    assert!(lines.len() > 40);
    let wrong = rows(&file, "SELECT 1 FROM skeleton WHERE NOT (upper_z > lower_z AND length > 0)");
    assert!(wrong.is_empty());
    let mut kinds: Vec<_> = rows(&file, "SELECT DISTINCT kind FROM triangles").concat();
    kinds.sort_by_key(|k| format!("{k:?}"));
    let text = |t: &str| rusqlite::types::Value::Text(t.into());
    assert_eq!(kinds, ["eliminated", "isolated", "junction", "sleeve", "terminal"].map(text));
    let count = |query: &str| match rows(&file, query)[0][0] {
        rusqlite::types::Value::Integer(n) => n,
        _ => 0,
    };
    let whole = count("SELECT count(*) FROM curve_mesh WHERE kind IN ('ridge', 'canyon')");
    assert_eq!(whole as usize, lines.len());
    assert!(count("SELECT count(*) FROM curve_mesh WHERE kind = 'junction'") > 0);

    let (status, said) = run("-o few.geojson --resolution 3 --triangles");
    assert_eq!(status, Some(0), "{said}");
    let few = std::fs::read_to_string(folder.path().join("few_skeleton.geojson")).unwrap();
    assert!(few.matches("\"Feature\"").count() < lines.len());
    assert!(folder.path().join("few_triangles.geojson").exists());
    assert_eq!(run("-o few.geojson --resolution 0.2 -q").0, Some(0));
    assert!(run("-o low.gpkg --resolution 0.2").1.contains("lower limit"));
    assert_eq!(run("-o x.gpkg --resolution -1").0, Some(2));
    assert_eq!(run("-o x.txt").0, Some(2));
}
