//! Figures 7 and 8: the curve mesh lies on the model, and the model is a polyhedron without terraces.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use tokosen::mesh::{Mesh, MeshParams, mesh};
use tokosen::surface::{Given, Surface, SurfaceKind, SurfaceParams, build};

use super::sample::{ALL, map};

fn surface(name: &str, kind: SurfaceKind) -> Surface {
    build(map(name), &Given::default(), &SurfaceParams { kind, ..SurfaceParams::default() }, &()).unwrap().value
}

fn shell(surface: &Surface) -> Mesh {
    mesh(surface, None, &MeshParams::default()).unwrap()
}

/// A point in space by the bits of its map coordinates and height.
fn bits(p: DVec3) -> [u64; 3] {
    p.to_array().map(f64::to_bits)
}

/// Triangles with all corners on one height.
fn flat(mesh: &Mesh) -> usize {
    let is_flat = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize].z);
        a == b && b == c
    };
    mesh.triangles.iter().filter(is_flat).count()
}

/// Every piece of a contour and of a ridge or canyon line is an edge of the model, at its own height.
#[test]
fn figure_7_the_curve_mesh_is_made_of_edges() {
    for name in ALL {
        let surface = surface(name, SurfaceKind::Skeleton);
        let shell = shell(&surface);
        let number: HashMap<[u64; 3], u32> =
            shell.vertices.iter().enumerate().map(|(v, &p)| (bits(p + shell.origin), v as u32)).collect();
        let edges: HashSet<[u32; 2]> = shell
            .triangles
            .iter()
            .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]])
            .map(|[u, v]| [u.min(v), u.max(v)])
            .collect();
        let mut pieces = 0;
        let mut check = |a: DVec3, b: DVec3| {
            let [u, v] = [a, b].map(|p| *number.get(&bits(p)).unwrap_or_else(|| panic!("{name}: no vertex at {p}")));
            assert!(edges.contains(&[u.min(v), u.max(v)]), "{name}: no edge from {a} to {b}");
            pieces += 1;
        };
        for contour in &surface.map.contours {
            let points = contour.points.iter().map(|p| p.extend(contour.elevation));
            points.clone().zip(points.skip(1)).for_each(|(a, b)| check(a, b));
        }
        for line in &surface.skeleton_lines {
            line.points.windows(2).for_each(|w| check(w[0], w[1]));
        }
        assert!(pieces > surface.map.contours.len(), "{name}");
    }
}

/// The shell on the bare triangulation has level terraces: all of the tops, of the bottom and of the ground outside. With
/// the ridge and canyon lines there is none, and every top rises above its contour, as the bottom lies below.
#[test]
fn figure_8_two_shells() {
    let name = "fig5cd_three_branches_basin";
    let [bare, whole] = [SurfaceKind::Linear, SurfaceKind::Skeleton].map(|kind| shell(&surface(name, kind)));
    // A polygon without holes of n corners has n - 2 triangles.
    let terraces: usize = map(name)
        .contours
        .iter()
        .filter(|c| c.elevation == 110.0 || c.elevation == 90.0)
        .map(|c| c.points.len() - 3)
        .sum();
    assert!(flat(&bare) > terraces, "{} and {terraces}", flat(&bare));
    assert_eq!(flat(&whole), 0);
    let heights = |mesh: &Mesh| (mesh.extent().0.z, mesh.extent().1.z);
    assert_eq!(heights(&bare), (90.0, 110.0));
    let (lowest, highest) = heights(&whole);
    assert!(80.0 < lowest && lowest < 90.0 && 110.0 < highest && highest < 120.0, "{lowest} to {highest}");
    // Both cover the same ground.
    assert!((bare.plan_area() - whole.plan_area()).abs() < 1e-9 * bare.plan_area());
}
