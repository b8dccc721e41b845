//! Terrain from contour lines: denser contours, height maps, ridge and canyon lines, and how far they are from others.
//!
//! The method is that of Zhang, Konno and Tokuyama, "3D Terrain Reconstruction Based on Contours" (CAD/CG 2005): the
//! contours are triangulated, the triangles tell where spurs, gullies and tops are, and lines with heights along their
//! axes turn the triangulation into a surface without flat steps. With that as a guide, a smooth surface of least curvature
//! is drawn through the contours.
//!
//! # The pipeline
//!
//! [`Terrain`] is the entry: it calls the steps below in the order that they need. [`Input`] reads or takes the contours,
//! [`Options`] has the parameters of all steps.
//!
//! | step | takes | gives |
//! |---|---|---|
//! | [`Input::read`], [`Input::from_map`], [`Input::from_arrays`] | a file, or lines in memory | an [`Input`]: a map on its working plane, findings about it |
//! | [`Input::prepare`] | an input | the same, examined, repaired, cleaned, fitted and sampled |
//! | [`Terrain::build`] | an input | a [`Terrain`]: [`contours`](Terrain::contours), [`dem`](Terrain::dem), [`errors`](Terrain::errors), [`mesh`](Terrain::mesh) |
//! | [`io::read_contours`] | a file, also of 基盤地図情報 ([`io::gsi`]) | a [`ContourMap`](contour::ContourMap): contours, spot heights, coordinate reference system |
//! | [`crs::working_crs`], [`contour::reproject`] | a map in any coordinates | the same on a plane in metres, and the [`Reprojection`](crs::Reprojection) for the way back |
//! | [`check::examine`] | a map as read | faults that its lines by themselves show, and what would mend them |
//! | [`clean::clean`](fn@clean::clean) | a map | the same map made sound, and what was wrong with it |
//! | [`resample::fit`](fn@resample::fit) | a clean map | a [`Fitted`](resample::Fitted) one: smooth lines within a tolerance |
//! | [`resample::sample`](fn@resample::sample) | a clean map | a [`Sampled`](resample::Sampled) one: vertices as dense as the contours around ask |
//! | [`tin::triangulate`] | points and edges | a [`Tin`](tin::Tin), the constrained Delaunay triangulation |
//! | [`subdomains::regions`] | a triangulation | [`Regions`](subdomains::Regions): sub-domains with the band of levels of each |
//! | [`subdivision::subdivide`](fn@subdivision::subdivide) | a clean map | a [`Subdivision`](subdivision::Subdivision): the triangulation with its sub-domains |
//! | [`subdomains::landforms`] | both | a [`Landform`](subdomains::Landform) a sub-domain: outline, class, nesting tree |
//! | [`skeleton::skeleton`] | both | ridge and canyon lines with heights |
//! | [`surface::build`] | a clean map | a [`Surface`](surface::Surface): subdivision, skeleton and smooth surface, heights everywhere |
//! | [`surface::heights`], [`surface::heights_on`] | a surface, a grid on the plane or in other coordinates | a [`Dem`](dem::Dem) |
//! | [`slice::contour_layers`] | a surface, intervals | the input's contours and new ones between them |
//! | [`dem::rasterise`] | a triangulation, a grid | a [`Dem`](dem::Dem) |
//! | [`io::raster::read_dem`] | a file | a [`Dem`](dem::Dem) that is there already |
//! | [`dem::derive::slope`](fn@dem::derive::slope), [`aspect`](dem::derive::aspect), [`shade`](dem::derive::shade), [`steep`](fn@dem::derive::steep) | a height map | rasters of them, and [`Steeps`](dem::derive::Steeps): steep places as areas |
//! | [`mesh::mesh`](fn@mesh::mesh) | a surface | a [`Mesh`](mesh::Mesh), open or a solid |
//! | [`draw::preview::render`] | all of them | a picture |
//! | [`dem::compare::compare`] | two height maps | a [`Comparison`](dem::compare::Comparison): figures over all cells and by class |
//! | [`dem::compare::difference`] | two height maps | a [`Dem`](dem::Dem) of their differences |
//! | [`draw::report::remarks`], [`draw::report::comparison_page`] | a comparison | sentences, and a page for people |
//! | [`crs::Reprojection::from_working`] | a coordinate reference system | the way of lines and areas out to it |
//! | [`io::write_contours`], [`io::raster::write_dem`], [`io::mesh::write_mesh`] | the results | files |
//!
//! Data flows one way, down that table. A step is a function of its input and its parameters; what it noticed about the
//! input comes back beside the result as [findings](base::error::Finding).
//!
//! # Units and axes
//!
//! x is east, y is north, in the units of the map; elevations are in metres. Rows of a height map run from north to south.
//! Coordinates must not be degrees: [`crs::Reprojection`] brings them to a plane and back. Higher ground lies on the right of every
//! contour that comes out.
//!
//! # Examples
//!
//! Contours 2 m apart and a height map from a file of contours, as the command `densify --dem` makes them:
//!
//! ```
//! use tokosen::io::layer::of_contours;
//! use tokosen::io::raster::write_dem;
//! use tokosen::io::{StagedOutput, write_layers_back};
//! use tokosen::{GridSpec, Input, Interval, Options, Terrain};
//!
//! fn main() -> tokosen::Result<()> {
//!     let folder = tempfile::tempdir().expect("a folder for the outputs");
//!     let grid = GridSpec::Cell(5.0);
//!     let options = Options { grid: Some(grid.clone()), ..Options::default() };
//!     let terrain = Terrain::build(Input::read("samples/fig5cd_three_branches_basin.geojson")?, &options)?;
//!     terrain.findings.iter().for_each(|finding| eprintln!("{finding}"));
//!
//!     let layers = terrain.contours(&[Interval::every(2.0)])?;
//!     let contours = StagedOutput::create(&folder.path().join("dense.gpkg"))?;
//!     write_layers_back(&contours, &layers.iter().map(of_contours).collect::<Vec<_>>(), &terrain.to_output(None)?)?;
//!     contours.commit()?;
//!
//!     let dem = StagedOutput::create(&folder.path().join("dem.tif"))?;
//!     write_dem(&dem.path(), &terrain.dem(&grid)?)?;
//!     dem.commit()?;
//!     Ok(())
//! }
//! ```
//!
//! The steps themselves: a hill of two contours, sliced at 2 m and rasterised:
//!
//! ```
//! use glam::DVec2;
//! use tokosen::base::Grid;
//! use tokosen::clean::{CleanParams, clean};
//! use tokosen::contour::{Contour, ContourMap};
//! use tokosen::slice::{LayerParams, Target, contour_layers};
//! use tokosen::surface::{SurfaceParams, build, heights};
//!
//! # fn main() -> tokosen::Result<()> {
//! let ring = |radius: f64, elevation: f64| {
//!     let angle = |k: i32| f64::from(k % 60) * std::f64::consts::TAU / 60.0;
//!     let points = (0..=60).map(|k| radius * DVec2::from_angle(angle(k))).collect();
//!     Contour { elevation, points, feature: 0 }
//! };
//! let map = ContourMap { contours: vec![ring(200.0, 10.0), ring(80.0, 20.0)], ..ContourMap::default() };
//!
//! let map = clean(map, &CleanParams::default())?.value;
//! let surface = build(map, &SurfaceParams::default(), &())?.value;
//! let params = LayerParams { targets: vec![Target::Interval { step: 2.0, base: 0.0 }], ..LayerParams::default() };
//! let layers = contour_layers(&surface, &params, &())?;
//! // 12, 14, 16 and 18 m between the two, and at least one ring on the rounded top.
//! assert!(layers[0].lines.len() >= 2 + 4 + 1);
//!
//! let grid = Grid { corner: DVec2::new(-200.0, 200.0), cell: DVec2::splat(10.0), cols: 40, rows: 40 };
//! let dem = heights(&surface, &grid, &());
//! let top = dem.values[20 * 40 + 20];
//! assert!(20.0 < top && top < 30.0, "the top is neither flat nor above the next level");
//! # Ok(())
//! # }
//! ```

pub mod base;
pub mod check;
pub mod clean;
pub mod contour;
pub mod crs;
pub mod dem;
#[cfg(feature = "draw")]
pub mod draw;
#[cfg(test)]
#[path = "../tests/common/draws.rs"]
mod draws;
mod geometry;
pub mod guide;
#[cfg(feature = "io")]
pub mod io;
pub mod mesh;
pub mod resample;
pub mod skeleton;
pub mod slice;
pub mod spline;
pub mod subdivision;
pub mod subdomains;
pub mod surface;
pub mod terrain;
pub mod tin;
pub mod tuning;
pub mod validate;

pub use base::error::{Error, Result};
pub use contour::Interval;
pub use terrain::{GridSpec, Input, InputOptions, Options, Terrain};
