//! The layers of ridge and canyon lines: the lines, the triangles they come from, and the curve mesh.

use glam::DVec2;

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::skeleton::{JunctionEdge, Skeleton, SkeletonKind};
use tokosen_core::streams::Stream;
use tokosen_core::subdivision::Subdivision;
use tokosen_core::tin::TriangleKind;

const LINE_COLUMNS: &[Column] = &[
    Column { name: "kind", kind: Kind::Text(8) },
    Column { name: "given", kind: Kind::Bool },
    Column { name: "region", kind: Kind::Int },
    Column { name: "network", kind: Kind::Int },
    Column { name: "length", kind: Kind::Real },
    Column { name: "upper_end", kind: Kind::Text(8) },
    Column { name: "upper_z", kind: Kind::Height },
    Column { name: "lower_end", kind: Kind::Text(8) },
    Column { name: "lower_z", kind: Kind::Height },
];

const TRIANGLE_COLUMNS: &[Column] = &[
    Column { name: "kind", kind: Kind::Text(12) },
    Column { name: "region", kind: Kind::Int },
    Column { name: "band_lo", kind: Kind::Height },
    Column { name: "band_hi", kind: Kind::Height },
];

const MESH_COLUMNS: &[Column] =
    &[Column { name: "kind", kind: Kind::Text(8) }, Column { name: "region", kind: Kind::Int }];

fn kind_name(kind: SkeletonKind) -> &'static str {
    match kind {
        SkeletonKind::Ridge => "ridge",
        SkeletonKind::Canyon => "canyon",
    }
}

/// The ridge and canyon lines, as the layer `skeleton`. They run downhill, with a height at every vertex. Given streams are
/// canyon lines too, with the attribute `given`; they run through several sub-domains.
pub fn skeleton_lines<'a>(skeleton: &'a Skeleton, streams: &'a [Stream]) -> Layer<'a> {
    let height = |at: Option<&glam::DVec3>| at.map_or(Cell::Null, |p| Cell::Real(p.z));
    let found = skeleton.lines.iter().map(|line| {
        let cells = vec![
            Cell::Text(kind_name(line.kind).into()),
            Cell::Bool(false),
            Cell::Int(line.region.into()),
            Cell::Int(line.network.into()),
            Cell::Real(line.length()),
            Cell::Text(line.ends[0].name().into()),
            height(line.points.first()),
            Cell::Text(line.ends[1].name().into()),
            height(line.points.last()),
        ];
        Row { shape: Shape::Line(&line.points), cells }
    });
    let given = streams.iter().map(|stream| {
        let cells = vec![
            Cell::Text(kind_name(SkeletonKind::Canyon).into()),
            Cell::Bool(true),
            Cell::Null,
            Cell::Null,
            Cell::Real(stream.length()),
            Cell::Null,
            height(stream.points.first()),
            Cell::Null,
            height(stream.points.last()),
        ];
        Row { shape: Shape::Line(&stream.points), cells }
    });
    let rows = found.chain(given);
    Layer { name: "skeleton", geometry: Geometry::Lines, columns: LINE_COLUMNS, rows: rows.collect() }
}

/// The triangles inside the frame, as the layer `triangles`, with sub-domain and band. The kinds are terminal, sleeve,
/// junction, eliminated (a junction that was turned into a sleeve) and isolated (a whole sub-domain).
pub fn skeleton_triangles<'a>(subdivision: &Subdivision, skeleton: &Skeleton) -> Layer<'a> {
    let tin = &subdivision.tin;
    let inside = (0..tin.len() as u32).filter(|&t| tin.is_inside(t));
    let rows = inside.map(|t| {
        let corner = |k: usize| tin.point(tin.triangles[t as usize][k]).truncate();
        let ring: Vec<DVec2> = [0, 1, 2, 0].map(corner).to_vec();
        let level = |of: fn(&tokosen_core::subdomains::Band) -> f64| {
            let level = subdivision.regions.region(t).map(|r| of(&r.band)).filter(|level| level.is_finite());
            level.map_or(Cell::Null, Cell::Real)
        };
        let kind = match skeleton.kinds[t as usize] {
            _ if skeleton.elimination.eliminated[t as usize] => "eliminated",
            TriangleKind::Terminal => "terminal",
            TriangleKind::Sleeve => "sleeve",
            TriangleKind::Junction => "junction",
            TriangleKind::Isolated | TriangleKind::Outside => "isolated",
        };
        let cells = vec![
            Cell::Text(kind.into()),
            Cell::Int(subdivision.regions.of_triangle[t as usize].into()),
            level(|band| band.lo),
            level(|band| band.hi),
        ];
        Row { shape: Shape::Area(vec![ring]), cells }
    });
    Layer { name: "triangles", geometry: Geometry::Areas, columns: TRIANGLE_COLUMNS, rows: rows.collect() }
}

/// The curve mesh (paper, section 4, figure 7b), as the layer `curve_mesh`: contours, edges of the junction triangles
/// that were kept, ridge and canyon lines. Contours have no sub-domain, because they separate two.
pub fn curve_mesh<'a>(subdivision: &'a Subdivision, skeleton: &'a Skeleton, edges: &'a [JunctionEdge]) -> Layer<'a> {
    let row = |shape, kind: &'static str, region: Option<u32>| {
        let region = region.map_or(Cell::Null, |r| Cell::Int(r.into()));
        Row { shape, cells: vec![Cell::Text(kind.into()), region] }
    };
    let contours = subdivision.map.contours.iter();
    let contours = contours.map(|c| row(Shape::Contour(&c.points, c.elevation), "contour", None));
    let edges = edges.iter().map(|e| row(Shape::Line(&e.ends), "junction", Some(e.region)));
    let lines = skeleton.lines.iter();
    let lines = lines.map(|l| row(Shape::Line(&l.points), kind_name(l.kind), Some(l.region)));
    let rows = contours.chain(edges).chain(lines).collect();
    Layer { name: "curve_mesh", geometry: Geometry::Lines, columns: MESH_COLUMNS, rows }
}
