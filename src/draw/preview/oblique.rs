//! A picture of the model in space: [`render_model`] looks down on it from the south-south-west along parallel rays.
//!
//! Parallel rays keep parallel lines parallel and equal heights equally long, so the picture can be read like a map.
//! The triangles have the tint and the light of the map. Where there are few, each is of one brightness and its edges
//! are drawn: the polyhedron shell (paper, figure 8). Where there are many, brightness varies evenly between the
//! corners. On the model lie the contours and the ridge and canyon lines (the paper's curve mesh, figure 7b), hidden
//! where the ground hides them.

use glam::{DVec2, DVec3};
use image::RgbImage;
use tiny_skia::{IntSize, Pixmap};

use super::canvas::image_of;
use super::color::{self, INK, Rgb, Tint};
use super::legend;
use super::plan::{drawn_as, plan};
use super::sheet::{Head, MAX_COLS, MAX_ROWS, MIN_LEGEND, sheet};
use super::skeleton_lines;
use super::stroke::{Style, skeleton_style};
use super::text::Typesetter;
use super::view::Subject;
use super::zbuffer::{self, Corner, Piece, Scene};
use crate::scale;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::{Grid, Units};
use tokosen_core::contour::{ContourLine, Source};
use tokosen_core::dem::shade::{Lights, ShadeParams};
use tokosen_core::mesh::Mesh;
use tokosen_core::raster::Dem;
use tokosen_core::skeleton::{SkeletonKind, SkeletonLine};

/// Direction of the eye, degrees west of south; the light of the map then comes from the left.
const TURN: f64 = 25.0;
/// Height of the eye above the horizon, degrees.
const ALTITUDE: f64 = 36.0;
/// Heights are scaled until the mean slope is about this steep, because such ground can be read well.
const GOOD_SLOPE: f64 = 0.5;
/// The least and the greatest height of the scaled model, as shares of its diagonal.
const TALL: (f64, f64) = (0.06, 0.28);
/// The least factor on heights.
const LEAST: f64 = 1.0;
/// Edges are drawn where a triangle covers more than this on average, square pixels.
const LARGE: f64 = 30.0;
/// The walls of a solid.
const WALL: Rgb = [176, 160, 142];
/// The edges of the triangles.
const EDGE_STYLE: Style = Style { color: INK, width: 0.7, alpha: 0.32, dashes: None };

/// What to draw.
#[derive(Debug, Clone, Copy)]
pub struct Model<'a> {
    /// The triangles.
    pub mesh: &'a Mesh,
    /// Contours on the model, in map coordinates.
    pub contours: &'a [ContourLine],
    /// Ridge and canyon lines on the model, in map coordinates.
    pub skeleton_lines: &'a [SkeletonLine],
    /// The units of heights in the legend.
    pub units: Units,
    /// A title above the model.
    pub title: Option<&'a str>,
}

/// Draws the model with a legend below it; no side is longer than [`MAX_SIDE`](super::MAX_SIDE).
///
/// Long because the parts of the picture are placed relative to each other.
///
/// # Errors
/// A model without extent, or with coordinates that are not finite.
pub fn render_model(model: &Model<'_>) -> Result<RgbImage> {
    let mesh = model.mesh;
    let metres = mesh.crs.as_ref().and_then(|crs| crs.length_unit()).map_or(1.0, |unit| unit.metres);
    let ground = Ground::new(mesh);
    let exaggeration = ground.exaggeration(metres);
    let view = View::new(mesh, exaggeration / metres)?;
    let covered = ground.area * view.scale * view.scale * ALTITUDE.to_radians().sin();
    let faceted = covered / mesh.triangles.len() as f64 > LARGE;
    let grid = ground.grid(&view);
    let plan = plan(model.contours, &grid);
    let frame = frame_edges(mesh);
    let map_area = (ground.area * view.scale * view.scale).max(1.0);
    let skeleton_lines =
        skeleton_lines::choose(model.skeleton_lines, &frame, (1.0 / view.scale, map_area), Subject::Ground);

    let (mut styles, mut pieces) = (vec![EDGE_STYLE], Vec::new());
    if faceted {
        let edges = mesh.triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        let ends = edges.map(|edge| edge.map(|v| view.points[v as usize]));
        pieces.extend(ends.map(|ends| Piece { ends, style: 1 }));
    }
    for source in [Source::Interpolated, Source::Input] {
        let Some(class) = plan.class(source) else { continue };
        for (index, style) in [(false, class.style), (true, class.index_style)] {
            styles.push(style);
            let is_drawn = |c: &&ContourLine| drawn_as(c) == source && plan.is_index(c) == index && plan.draws(c);
            for line in model.contours.iter().filter(is_drawn) {
                view.add_line(&mut pieces, styles.len(), line.points.iter().map(|p| p.extend(line.elevation)));
            }
        }
    }
    for kind in [SkeletonKind::Canyon, SkeletonKind::Ridge] {
        styles.push(skeleton_style(kind, skeleton_lines.width));
        for line in skeleton_lines.of(kind) {
            view.add_line(&mut pieces, styles.len(), line.iter().copied());
        }
    }

    let light = Brightness::new(mesh, exaggeration / metres);
    let tint = Tint::over(ground.range, &[]);
    let pixels = zbuffer::draw(&Scene {
        size: view.size,
        triangles: mesh.triangles.len() as u32,
        corners: |t: u32| {
            let lights = light.of_triangle(mesh, t, faceted)?;
            Some([0, 1, 2].map(|k| {
                let v = mesh.triangles[t as usize][k] as usize;
                Corner { at: view.points[v], height: ground.share(mesh.vertices[v].z), light: lights[k] }
            }))
        },
        paint: |t: u32, height: f64, light: f64| {
            let color = if is_wall(mesh, t) { WALL } else { tint.at(height) };
            color::shaded(color, light)
        },
        pieces: &pieces,
        styles: &styles,
    });
    let size = IntSize::from_wh(view.size.0 as u32, view.size.1 as u32);
    let picture = size.and_then(|size| Pixmap::from_vec(pixels, size)).expect("four bytes per pixel were drawn");

    let setter = Typesetter::new();
    let room = view.size.0.max(MIN_LEGEND);
    let map = Dem { grid, values: Vec::new(), crs: mesh.crs.clone() };
    let metres_per_pixel = map.metres_per_unit().map(|m| m.x * grid.cell.x);
    let scale = legend::Block::Scale {
        bar: scale::bar(grid.cols as f64, metres_per_pixel, grid.cell.x, model.units.heights),
        arrow: None,
        remark: mesh.crs.as_ref().and_then(legend::crs_label),
    };
    let content = legend::Content {
        scale,
        plan: &plan,
        skeleton_lines: &skeleton_lines,
        patches: None,
        tint: Some(&tint),
        units: model.units,
    };
    let mut blocks = legend::blocks(content, room as f32, &setter);
    let remark = Some(format!("Seen from south-south-west, heights x {exaggeration}"));
    blocks.insert(1, legend::Block::Scale { bar: None, arrow: None, remark });
    let head = Head { title: model.title, note: None };
    Ok(image_of(&sheet(&picture, &blocks, room, &head, &setter)?))
}

/// The edges around the ground, on the map: those of one triangle alone, or of one and a wall.
fn frame_edges(mesh: &Mesh) -> Vec<[DVec2; 2]> {
    let ground = (0..mesh.triangles.len() as u32).filter(|&t| normal(mesh, t).z > 0.0);
    let mut edges: Vec<[u32; 2]> = ground
        .flat_map(|t| {
            let [a, b, c] = mesh.triangles[t as usize];
            [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
        })
        .collect();
    edges.sort_unstable();
    let alone = edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]);
    alone.map(|ends| ends.map(|v| (mesh.vertices[v as usize] + mesh.origin).truncate())).collect()
}

/// Size and slope of the ground: of the mesh without the walls and the bottom of a solid.
struct Ground {
    /// The box around it on the map, relative to the mesh's origin.
    corners: [DVec2; 2],
    /// Lowest and highest height, metres.
    range: (f64, f64),
    /// Area on the map, map units squared.
    area: f64,
    /// Mean rise over run, metres per map unit.
    slope: f64,
}

impl Ground {
    fn new(mesh: &Mesh) -> Self {
        let mut corners = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for v in mesh.vertices.iter().filter(|v| mesh.base != Some(v.z)) {
            corners = [corners[0].min(v.truncate()), corners[1].max(v.truncate())];
            range = (range.0.min(v.z), range.1.max(v.z));
        }
        let (mut area, mut rise) = (0.0, 0.0);
        for normal in (0..mesh.triangles.len() as u32).map(|t| normal(mesh, t)).filter(|n| n.z > 0.0) {
            area += normal.z / 2.0;
            rise += normal.truncate().length() / 2.0;
        }
        Self { corners, range, area, slope: rise / area }
    }

    /// The factor on the heights that makes the ground easy to read, a multiple of one half.
    fn exaggeration(&self, metres: f64) -> f64 {
        let diagonal = self.corners[0].distance(self.corners[1]) * metres;
        let tall = |share: f64| share * diagonal / (self.range.1 - self.range.0);
        let wanted = (GOOD_SLOPE * metres / self.slope).max(tall(TALL.0)).min(tall(TALL.1));
        // For level ground the factor would be infinite.
        let step = if wanted < 10.0 { 0.5 } else { 5.0 };
        let rounded = (wanted / step).round() * step;
        if rounded.is_finite() { rounded.max(LEAST) } else { LEAST }
    }

    /// Share of the height range.
    fn share(&self, height: f64) -> f64 {
        let span = self.range.1 - self.range.0;
        if span > 0.0 { (height - self.range.0) / span } else { 0.0 }
    }

    /// The map in pixels as long as those of the view, from its left to its right.
    fn grid(&self, view: &View<'_>) -> Grid {
        let corner = DVec2::new(self.corners[0].x, self.corners[1].y) + view.mesh.origin.truncate();
        let count = ((self.corners[1] - self.corners[0]) * view.scale).ceil().max(DVec2::ONE);
        Grid { corner, cell: DVec2::splat(1.0 / view.scale), cols: count.x as usize, rows: count.y as usize }
    }
}

/// The parallel projection: the size of the picture, and the places of the vertices in it.
struct View<'a> {
    mesh: &'a Mesh,
    /// Factor on the heights, which also turns metres into map units.
    rise: f64,
    /// Pixels per map unit.
    scale: f64,
    /// Right, down and nearness, map units, of the upper left corner of the picture.
    corner: DVec3,
    /// Pixels across and down.
    size: (usize, usize),
    /// The vertices in pixels: right, down, towards the eye.
    points: Vec<DVec3>,
}

impl<'a> View<'a> {
    fn new(mesh: &'a Mesh, rise: f64) -> Result<Self> {
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut points: Vec<DVec3> = mesh.vertices.iter().map(|&v| turned(v, rise)).collect();
        for &p in &points {
            (lo, hi) = (lo.min(p), hi.max(p));
        }
        let extent = (hi - lo).truncate();
        if !(points.iter().all(|p| p.is_finite()) && extent.is_finite() && extent.max_element() > 0.0) {
            return Err(Error::Parameter("no picture can be drawn of a model without extent".into()));
        }
        let room = DVec2::new(MAX_COLS as f64, MAX_ROWS[1] as f64);
        let scale = (room / extent).min_element();
        let size = (extent * scale).ceil().max(DVec2::ONE).min(room);
        points.iter_mut().for_each(|p| *p = (*p - lo) * scale);
        Ok(Self { mesh, rise, scale, corner: lo, size: (size.x as usize, size.y as usize), points })
    }

    /// Adds the pieces of a line in map coordinates.
    fn add_line(&self, pieces: &mut Vec<Piece>, style: usize, points: impl Iterator<Item = DVec3>) {
        let place = |p: DVec3| (turned(p - self.mesh.origin, self.rise) - self.corner) * self.scale;
        let mut last = None;
        for p in points.map(place).filter(|p| p.is_finite()) {
            if let Some(start) = last.replace(p) {
                pieces.push(Piece { ends: [start, p], style: style as u8 });
            }
        }
    }
}

/// A point seen by the eye: right, down, towards the eye.
fn turned(p: DVec3, rise: f64) -> DVec3 {
    let ground = DVec2::from_angle(TURN.to_radians()).rotate(p.truncate());
    let (sin, cos) = ALTITUDE.to_radians().sin_cos();
    let height = p.z * rise;
    DVec3::new(ground.x, -(ground.y * sin + height * cos), height * sin - ground.y * cos)
}

/// Twice the area of a triangle along its normal, outwards; x and y in map units, z in metres.
fn normal(mesh: &Mesh, t: u32) -> DVec3 {
    let [a, b, c] = mesh.triangles[t as usize].map(|v| mesh.vertices[v as usize]);
    (b - a).cross(c - a)
}

/// Whether a triangle stands upright below the border of a solid.
fn is_wall(mesh: &Mesh, t: u32) -> bool {
    mesh.base.is_some() && normal(mesh, t).z == 0.0
}

/// How bright the model is, 1 on level ground.
struct Brightness {
    lights: Lights,
    level: f64,
    rise: f64,
    of_vertex: Vec<f32>,
}

impl Brightness {
    fn new(mesh: &Mesh, rise: f64) -> Self {
        let params = ShadeParams::soft();
        let mut all = Self { lights: Lights::new(&params), level: params.level(), rise, of_vertex: Vec::new() };
        all.of_vertex = mesh.normals.iter().map(|n| all.on(n.as_dvec3()) as f32).collect();
        all
    }

    /// Brightness of ground with a normal; scaling the heights up tilts normals towards the horizontal.
    fn on(&self, normal: DVec3) -> f64 {
        let raised = DVec3::new(normal.x, normal.y, normal.z / self.rise);
        self.lights.on(raised.try_normalize().unwrap_or(DVec3::Z)) / self.level
    }

    /// Brightness in the corners of a triangle; `None` for the bottom of a solid, which is never seen.
    fn of_triangle(&self, mesh: &Mesh, t: u32, faceted: bool) -> Option<[f64; 3]> {
        let normal = normal(mesh, t);
        if normal.z < 0.0 {
            return None;
        }
        Some(if faceted || is_wall(mesh, t) {
            [self.on(normal); 3]
        } else {
            mesh.triangles[t as usize].map(|v| f64::from(self.of_vertex[v as usize]))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::MAX_SIDE;
    use crate::preview::color::{PAPER, RIDGE};
    use tokosen_core::skeleton::LineEnd;

    /// A field of `n` by `n` squares of ten units, each two triangles, closed by a base where one is given.
    fn field(n: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
        let at = |i: u32| {
            let (x, y) = (f64::from(i % (n + 1)) * 10.0, f64::from(i / (n + 1)) * 10.0);
            DVec3::new(x, y, height(x, y))
        };
        let vertices: Vec<DVec3> = (0..(n + 1) * (n + 1)).map(at).collect();
        let squares = (0..n * n).map(|i| i % n + i / n * (n + 1));
        let triangles = squares.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]).collect();
        let normals = vec![glam::Vec3::Z; vertices.len()];
        let origin = DVec3::new(14_000.0, -16_500.0, 0.0);
        Mesh { origin, vertices, normals, triangles, break_lines: Vec::new(), base: None, crs: None, unit: None }
    }

    fn picture(mesh: &Mesh, skeleton_lines: &[SkeletonLine]) -> RgbImage {
        render_model(&Model { mesh, contours: &[], skeleton_lines, units: Units::METRES, title: Some("Model") })
            .unwrap()
    }

    /// A ridge line across a field of a hundred units from west to east, ten units from its northern edge.
    fn line(mesh: &Mesh, height: f64) -> SkeletonLine {
        let points = [0.0, 100.0].map(|x| DVec3::new(x, 90.0, height) + mesh.origin).to_vec();
        let ends = [LineEnd::Frame; 2];
        SkeletonLine { kind: SkeletonKind::Ridge, points, region: 0, ends, network: 0 }
    }

    fn red(image: &RgbImage) -> usize {
        // Legend and map have the same ink, mixed with what lies below.
        let is_red = |p: &&image::Rgb<u8>| p.0.iter().zip(RIDGE).all(|(a, b)| a.abs_diff(b) < 40);
        image.pixels().filter(is_red).count()
    }

    #[test]
    fn a_wall_in_front_hides_a_line() {
        let level = field(10, |_, _| 10.0);
        let wall = field(10, |_, y| if y == 50.0 { 100.0 } else { 10.0 });
        let [seen, hidden] = [&level, &wall].map(|mesh| red(&picture(mesh, &[line(mesh, 10.0)])));
        assert!(seen > 500, "{seen}");
        assert!(hidden < seen / 3, "{hidden} of {seen}");
    }

    #[test]
    fn few_triangles_have_edges_and_many_have_not() {
        // On level ground of one colour every other colour is an edge.
        let inner = |n: u32| {
            let image = picture(&field(n, |_, _| 10.0), &[]);
            let (x, y) = (image.width() / 2, image.height() / 3);
            let window: Vec<_> = (0..40_000).map(|i| *image.get_pixel(x - 100 + i % 200, y - 100 + i / 200)).collect();
            window.iter().filter(|p| **p != window[0]).count()
        };
        assert!(inner(20) > 500);
        assert_eq!(inner(400), 0);
    }

    #[test]
    fn pictures_fit_and_are_the_same_for_any_number_of_threads() {
        for (x, y) in [(1.0, 1.0), (0.01, 1.0), (1.0, 0.01)] {
            let mut mesh = field(30, |x, y| (x / 20.0).sin() * 5.0 + (y / 30.0).cos() * 9.0);
            mesh.vertices.iter_mut().for_each(|v| *v *= DVec3::new(x, y, 1.0));
            let images = [1, 3].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| picture(&mesh, &[]))
            });
            assert!(images[0] == images[1]);
            let (width, height) = images[0].dimensions();
            assert!(width.max(height) <= MAX_SIDE as u32, "{width} x {height}");
            assert_eq!(images[0].get_pixel(2, height - 2).0, PAPER);
        }
    }

    #[test]
    fn models_that_cannot_be_drawn() {
        let mut mesh = field(2, |_, _| 1.0);
        mesh.vertices[3].z = f64::NAN;
        let model = |mesh: &Mesh| {
            render_model(&Model { mesh, contours: &[], skeleton_lines: &[], units: Units::METRES, title: None })
                .is_err()
        };
        assert!(model(&mesh));
        mesh.vertices.fill(DVec3::ONE);
        assert!(model(&mesh));
        (mesh.vertices, mesh.normals, mesh.triangles) = Default::default();
        assert!(model(&mesh));
    }
}
