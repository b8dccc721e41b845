//! The surface as a triangle mesh in space: an open shell of the terrain ([`mesh`]), or a closed solid with a flat
//! bottom.
//!
//! Coordinates are double precision relative to [`Mesh::origin`], exactly as in the triangulation. So no triangle
//! collapses or turns over. Where the ground touches itself at a single point, this point becomes several vertices. So
//! the triangles around each vertex form one fan, and the walls of a solid are a two-manifold.

mod cells;
mod cut;
mod drawing;
mod light;
mod outline;
mod print;
mod validate;

use foldhash::HashSet;
use geo::MultiPolygon;
use glam::{DVec2, DVec3, Vec3};

use crate::base::Grid;
use crate::base::error::{Error, Result};
use crate::crs::{Crs, LengthUnit};
use crate::raster::Dem;
use crate::subdomains::MapExtent;
use crate::surface::{Surface, height_map};
use crate::tin::Tin;

use outline::Outline;
pub use print::PrintParams;

/// Marks a corner without a vertex yet.
const UNSET: u32 = u32::MAX;

/// Parameters of [`mesh`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeshParams {
    /// Height of the flat bottom of a solid, metres. `None` gives an open shell.
    pub base: Option<f64>,
    /// Few triangles instead of all those of the surface.
    pub light: Option<Light>,
}

/// Few triangles, near to the heights of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Largest distance from the height of a cell, metres.
    pub tolerance: f64,
    /// Size of the cells, metres. `None` gives those that the smooth surface is made on, or a quarter of the mean distance between
    /// contours.
    pub cell: Option<f64>,
    /// The lines that stay edges of the triangles.
    pub keep: Keep,
}

/// The lines of a surface that stay edges of few triangles, or chains of edges: with all their vertices, and their heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Keep {
    /// None.
    #[default]
    Nothing,
    /// Break lines.
    BreakLines,
    /// Break lines, and the contours of the input.
    Contours,
}

impl Light {
    /// The heights of a surface that the triangles come near to.
    pub fn heights(&self, surface: &Surface) -> Dem {
        height_map(surface, &self.grid(surface), surface.map.crs.as_ref(), None, &())
    }

    /// The cells over a surface.
    pub fn grid(&self, surface: &Surface) -> Grid {
        let (lo, hi) = surface.frame.extent();
        let own = surface.working.as_ref().map(|working| &working.0[..]);
        match (self.cell, own) {
            (Some(cell), _) => Grid::on_multiples(lo, hi, cell),
            (None, Some([alone])) => alone.grid,
            (None, Some([first, ..])) => Grid::on_multiples(lo, hi, first.grid.cell.x),
            (None, _) => {
                let spacing = MapExtent::new(&surface.map, &surface.frame, surface.interval).spacing;
                Grid::on_multiples(lo, hi, spacing / 4.0)
            }
        }
    }
}

/// Triangles in space: x east, y north, z up, in metres or in another unit on all three axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Origin of the vertices: origin plus vertex position gives map coordinates. It is in whole numbers, near the
    /// middle of the map, or zero for a map near zero.
    pub origin: DVec3,
    /// Vertex positions relative to the origin.
    pub vertices: Vec<DVec3>,
    /// Unit normals, one per vertex: the mean over the triangles around it, weighted by area.
    pub normals: Vec<Vec3>,
    /// Corners of the triangles, counter-clockwise seen from above. In a solid, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Break lines of the input as they are used, relative to the origin. Formats of surfaces hold them beside the triangles.
    pub break_lines: Vec<Vec<DVec3>>,
    /// Height of the bottom, if the mesh is a solid.
    pub base: Option<f64>,
    /// The coordinate reference system, if known.
    pub crs: Option<Crs>,
    /// The unit of all three axes, if it is not the metre.
    pub unit: Option<LengthUnit>,
}

/// The triangles of a surface inside its frame, or the solid between them and a flat bottom. Of a `part` of the map, the
/// triangles are cut at its border.
///
/// # Errors
/// If there is no ground inside the frame, or if few triangles are asked for and do not come within the tolerance. As
/// [`Mesh::closed`].
pub fn mesh(surface: &Surface, part: Option<&MultiPolygon<f64>>, params: &MeshParams) -> Result<Mesh> {
    let tin = &surface.tin;
    let cut = part.map(|area| cut::cut(tin, area)).transpose()?;
    let tin = cut.as_ref().unwrap_or(tin);
    if !(0..tin.len() as u32).any(|t| tin.is_inside(t)) {
        return Err(Error::Data("there is no ground inside the frame to make a mesh of".into()));
    }
    let few = |light: Light| {
        let mut outline = Outline::of_tin(tin);
        if light.keep == Keep::Contours {
            outline = outline.with_contours(tin);
        }
        if light.keep != Keep::Nothing {
            outline = outline.with_lines(surface.break_lines.iter().map(|line| line.points.clone()));
        }
        light::light(&outline, &light.heights(surface), light.tolerance)
    };
    let few = params.light.map(few).transpose()?;
    let mesh = of_tin(few.as_ref().unwrap_or(tin), surface.map.crs.as_ref())?;
    match params.base {
        Some(base) => mesh.closed(base),
        None => Ok(mesh),
    }
}

/// Triangles between the centres of the cells of a height map, as an open shell. With a `tolerance` (metres) there are few of them,
/// none further than this from the height of a cell that it covers; otherwise two between each four neighbouring cells. Cells without
/// heights are no ground. Of a `part`, the triangles are cut at its border. Coordinates of the height map are in metres.
///
/// # Errors
/// [`Error::Data`] if no four neighbouring cells have heights, or none in the part. [`Error::OutOfRange`] for a tolerance that is not
/// above 0.
pub fn height_mesh(dem: &Dem, part: Option<&MultiPolygon<f64>>, tolerance: Option<f64>) -> Result<Mesh> {
    let light = |outline: &Outline, tolerance| match outline.edges.is_empty() {
        true => Ok(Tin::default()),
        false => light::light(outline, dem, tolerance),
    };
    let tin = match (part, tolerance) {
        (None, None) => cells::of_cells(dem),
        (None, Some(tolerance)) => light(&Outline::of_cells(dem), tolerance)?,
        (Some(area), _) => {
            let cut = cut::cut(&cells::of_cells(&dem.beyond(area)), area)?;
            let few = tolerance.map(|tolerance| light(&Outline::of_tin(&cut), tolerance)).transpose()?;
            few.unwrap_or(cut)
        }
    };
    if tin.is_empty() {
        let place = if part.is_some() { " in this part of the map" } else { "" };
        let message = format!("no four neighbouring cells have heights{place} to make a mesh of");
        return Err(Error::Data(message));
    }
    of_tin(&tin, dem.crs.as_ref())
}

/// The triangles inside a triangulation as an open shell.
fn of_tin(tin: &Tin, crs: Option<&Crs>) -> Result<Mesh> {
    let (vertices, triangles, _) = shell(tin);
    check_heights(&vertices, tin.origin)?;
    let mut mesh = Mesh {
        break_lines: Vec::new(),
        origin: tin.origin.extend(0.0),
        vertices,
        normals: Vec::new(),
        triangles,
        base: None,
        crs: crs.cloned(),
        unit: None,
    };
    mesh.normals = normals(&mesh, mesh.triangles.len());
    Ok(mesh)
}

/// Vertices, triangles, and border edges. The ground lies on the left of the edges.
type Shell = (Vec<DVec3>, Vec<[u32; 3]>, Vec<[u32; 2]>);

/// The triangles inside the frame. A point has one vertex for each fan of triangles around it.
fn shell(tin: &Tin) -> Shell {
    let mut corners = vec![[UNSET; 3]; tin.len()];
    let mut vertices = Vec::new();
    let mut fan = Vec::new();
    let inside = || (0..tin.len() as u32).filter(|&t| tin.is_inside(t));
    for t in inside() {
        for i in 0..3 {
            if corners[t as usize][i] != UNSET {
                continue;
            }
            let point = tin.triangles[t as usize][i];
            let vertex = vertices.len() as u32;
            vertices.push(tin.positions[point as usize].extend(tin.heights[point as usize]));
            corners[t as usize][i] = vertex;
            fan.push((t, i));
            while let Some((t, i)) = fan.pop() {
                // The two edges of the triangle at this corner lead to the next triangles of the fan.
                for n in [i, (i + 2) % 3].into_iter().filter_map(|edge| tin.inner_neighbour(t, edge)) {
                    let here = tin.triangles[n as usize].iter().position(|&p| p == point);
                    if let Some(j) = here
                        && corners[n as usize][j] == UNSET
                    {
                        corners[n as usize][j] = vertex;
                        fan.push((n, j));
                    }
                }
            }
        }
    }
    let triangles = inside().map(|t| corners[t as usize]).collect();
    let open = inside().flat_map(|t| (0..3).map(move |i| (t, i))).filter(|&(t, i)| tin.inner_neighbour(t, i).is_none());
    let border = open.map(|(t, i)| [corners[t as usize][i], corners[t as usize][(i + 1) % 3]]).collect();
    (vertices, triangles, border)
}

/// Refuses vertices without a height.
fn check_heights(vertices: &[DVec3], origin: DVec2) -> Result<()> {
    let Some(v) = vertices.iter().find(|v| !v.is_finite()) else { return Ok(()) };
    let place = v.truncate() + origin;
    Err(Error::Data(format!("the surface has no height at {:.3} {:.3}", place.x, place.y)))
}

/// Area-weighted normals. They point upwards where the triangles around a vertex give no direction. The first `ground`
/// triangles face upwards, even where rounding turns a sliver over.
fn normals(mesh: &Mesh, ground: usize) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; mesh.vertices.len()];
    for (n, t) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        let mut twice_area = (b - a).cross(c - a);
        if n < ground {
            twice_area.z = twice_area.z.max(0.0);
        }
        t.iter().for_each(|&v| sums[v as usize] += twice_area);
    }
    sums.into_iter().map(|sum| sum.try_normalize().unwrap_or(DVec3::Z).as_vec3()).collect()
}

impl Mesh {
    /// The solid between an open shell and a flat bottom at a height, map coordinates. The bottom is a copy of the top without
    /// relief. Walls go down along every border edge, including the edges of holes.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the bottom is not below the lowest height. [`Error::Data`] if 32-bit indices cannot count the vertices.
    pub fn closed(mut self, base: f64) -> Result<Self> {
        let lowest = self.vertices.iter().fold(f64::INFINITY, |m, v| m.min(v.z)) + self.origin.z;
        if !base.is_finite() || base >= lowest {
            return Err(Error::Parameter(format!(
                "the base is at {base} m, it must be below the lowest height of the surface, {lowest:.3} m"
            )));
        }
        if self.vertices.len() > (UNSET / 2) as usize {
            return Err(Error::Data("the solid has more vertices than 32-bit indices can count".into()));
        }
        let edges = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        let all: HashSet<[u32; 2]> = self.triangles.iter().flat_map(edges).collect();
        // The vertex below vertex v has the number v plus the number of vertices on top.
        let (below, top) = (self.vertices.len() as u32, self.triangles.len());
        self.vertices.extend_from_within(..);
        self.vertices[below as usize..].iter_mut().for_each(|v| v.z = base - self.origin.z);
        for t in 0..top {
            let [a, b, c] = self.triangles[t].map(|v| v + below);
            self.triangles.push([a, c, b]);
        }
        for t in 0..top {
            for [u, v] in edges(&self.triangles[t]).into_iter().filter(|[u, v]| !all.contains(&[*v, *u])) {
                self.triangles.push([v, u, u + below]);
                self.triangles.push([v, u + below, v + below]);
            }
        }
        self.base = Some(base);
        self.normals = normals(&self, top);
        Ok(self)
    }

    /// The lower and the upper corner of the bounding box of the mesh, in map coordinates.
    pub fn extent(&self) -> (DVec3, DVec3) {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lo, hi) = self.vertices.iter().fold(start, |(lo, hi), &v| (lo.min(v), hi.max(v)));
        (lo + self.origin, hi + self.origin)
    }

    /// Volume of a solid, map units squared times metres.
    pub fn volume(&self) -> f64 {
        // Relative to the first vertex, the products stay small.
        let from = self.vertices.first().copied().unwrap_or_default();
        let six = self.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| self.vertices[v as usize] - from);
            a.dot(b.cross(c))
        });
        six.sum::<f64>() / 6.0
    }

    /// Area of the shell on the map, map units squared; zero for a solid.
    pub fn plan_area(&self) -> f64 {
        let twice = self.triangles.iter().map(|t| {
            let [a, b, c]: [DVec2; 3] = t.map(|v| self.vertices[v as usize].truncate());
            (b - a).perp_dot(c - a)
        });
        twice.sum::<f64>() / 2.0
    }
}

#[cfg(test)]
mod tests {
    use geo::{LineString, MultiPolygon, Polygon};

    use super::*;
    use crate::contour::{Contour, ContourMap};
    use crate::subdomains::Frame;
    use crate::surface::{Given, SurfaceParams, build};

    /// Ground that rises to the east by one metre per map unit, cut to the polygons.
    fn slope(polygons: Vec<Polygon<f64>>) -> Surface {
        let far = DVec2::new(400_000.0, 4_000_000.0);
        let contour = |k: i32| {
            let x = f64::from(10 * k) - 35.0;
            let points = (-4..=4).map(|j| far + DVec2::new(x, 10.0 * f64::from(j))).collect();
            Contour { elevation: f64::from(10 * k), points, feature: 0.into() }
        };
        let shifted = |ring: &LineString<f64>| ring.0.iter().map(|c| (c.x + far.x, c.y + far.y)).collect();
        let area: MultiPolygon<f64> = polygons
            .iter()
            .map(|p| Polygon::new(shifted(p.exterior()), p.interiors().iter().map(shifted).collect()))
            .collect();
        let map = ContourMap { contours: (0..8).map(contour).collect(), ..ContourMap::default() };
        let params = SurfaceParams { frame: Frame::Polygon(area), ..SurfaceParams::default() };
        build(map, &Given::default(), &params, &()).unwrap().value
    }

    fn ring(points: &[(f64, f64)]) -> LineString<f64> {
        points.to_vec().into()
    }

    fn euler(mesh: &Mesh) -> i64 {
        let edges = mesh.triangles.len() as i64 * 3 / 2;
        mesh.vertices.len() as i64 - edges + mesh.triangles.len() as i64
    }

    #[test]
    fn a_square_is_a_shell_and_a_box() {
        let square = ring(&[(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)]);
        let surface = slope(vec![Polygon::new(square, vec![])]);
        let shell = mesh(&surface, None, &MeshParams::default()).unwrap();
        shell.validate().unwrap();
        assert!((shell.plan_area() - 1600.0).abs() < 1e-6, "{}", shell.plan_area());
        assert!(shell.origin.truncate().distance(DVec2::new(400_000.0, 4_000_000.0)) < 50.0, "{}", shell.origin);
        let solid = mesh(&surface, None, &MeshParams { base: Some(-10.0), ..MeshParams::default() }).unwrap();
        solid.validate().unwrap();
        assert_eq!(euler(&solid), 2);
        assert!((solid.volume() - 1600.0 * 45.0).abs() < 1600.0 * 3.0, "{}", solid.volume());
    }

    #[test]
    fn a_hole_makes_a_ring() {
        let square = ring(&[(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)]);
        let hole = ring(&[(-8.0, -8.0), (8.0, -8.0), (8.0, 8.0), (-8.0, 8.0)]);
        let surface = slope(vec![Polygon::new(square, vec![hole])]);
        let solid = mesh(&surface, None, &MeshParams { base: Some(-10.0), ..MeshParams::default() }).unwrap();
        solid.validate().unwrap();
        assert_eq!(euler(&solid), 0);
    }

    #[test]
    fn parts_that_touch_at_a_point_come_apart() {
        let west = ring(&[(-20.0, -10.0), (0.0, 0.0), (-20.0, 10.0)]);
        let east = ring(&[(20.0, -10.0), (20.0, 10.0), (0.0, 0.0)]);
        let surface = slope(vec![Polygon::new(west, vec![]), Polygon::new(east, vec![])]);
        let shell = mesh(&surface, None, &MeshParams::default()).unwrap();
        shell.validate().unwrap();
        let middle = DVec2::new(400_000.0, 4_000_000.0) - shell.origin.truncate();
        assert_eq!(shell.vertices.iter().filter(|v| v.truncate() == middle).count(), 2);
        let solid = mesh(&surface, None, &MeshParams { base: Some(-10.0), ..MeshParams::default() }).unwrap();
        solid.validate().unwrap();
        assert_eq!(euler(&solid), 4, "two closed bodies");
    }

    #[test]
    fn a_base_that_is_not_below_is_refused() {
        let square = ring(&[(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)]);
        let surface = slope(vec![Polygon::new(square, vec![])]);
        for base in [30.0, f64::NAN, f64::NEG_INFINITY] {
            let error = mesh(&surface, None, &MeshParams { base: Some(base), ..MeshParams::default() }).unwrap_err();
            assert!(matches!(error, Error::Parameter(_)), "{error}");
        }
    }
}
