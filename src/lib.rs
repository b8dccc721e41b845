//! Terrain from contour lines: denser contours, height maps, ridge and canyon lines, and comparison with height maps.
//!
//! The [guide] explains the program by task, the file formats, the method, the accuracy and the limits.
//!
//! The method is that of Zhang, Konno and Tokuyama, "3D Terrain Reconstruction Based on Contours" (CAD/CG 2005). The
//! contours are triangulated. The triangles show where spurs, gullies and tops are. Ridge and canyon lines with heights
//! turn the triangulation into a surface without flat steps. This reference surface then guides a smooth surface of
//! minimum curvature through the contours (Briggs 1974; Smith and Wessel 1990). See [the method](guide::method).
//!
//! # The pipeline
//!
//! [`Terrain`] is the entry. It calls the steps below in the right order. [`Input`] reads contours or takes them from
//! memory. [`Options`] holds the parameters of all steps.
//!
//! | step | takes | gives |
//! |---|---|---|
//! | [`Input::read`], [`Input::from_map`], [`Input::from_arrays`] | a file, or lines in memory | an [`Input`]: a map on its working plane, and the findings about it |
//! | [`Input::add`], [`Input::read_features`] | an input, [`Features`](features::Features) in their [`Role`](features::Role) | the same input with streams, break lines, cliffs, coast, lakes, sinks, or without the contours inside polygons |
//! | [`Input::prepare`] | an input | the same input: examined, repaired, cleaned, fitted and sampled |
//! | [`Terrain::build`] | an input | a [`Terrain`]: [`contours`](Terrain::contours), [`dem`](Terrain::dem), [`errors`](Terrain::errors), [`mesh`](Terrain::mesh) |
//! | [`io::read_contours`] | a file, including 基盤地図情報 ([`io::gsi`]) | a [`ContourMap`](contour::ContourMap): contours, spot heights, coordinate reference system |
//! | [`crs::working_crs`], [`contour::reproject`] | a map in any coordinates | the same map on a plane in metres, and the [`Reprojection`](crs::Reprojection) between the two |
//! | [`check::examine`] | a map as read | faults of single lines, and proposed corrections |
//! | [`clean::clean`](fn@clean::clean) | a map | the repaired map, and findings about its faults |
//! | [`resample::fit`](fn@resample::fit) | a clean map | a [`Fitted`](resample::Fitted) map: smooth lines within a tolerance |
//! | [`resample::sample`](fn@resample::sample) | a clean map | a [`Sampled`](resample::Sampled) map: more vertices where other contours are near |
//! | [`tin::triangulate`] | points and edges | a [`Tin`](tin::Tin), the constrained Delaunay triangulation |
//! | [`subdomains::regions`] | a triangulation | [`Regions`](subdomains::Regions): sub-domains, each with its band of levels |
//! | [`subdivision::subdivide`](fn@subdivision::subdivide) | a clean map | a [`Subdivision`](subdivision::Subdivision): the triangulation with its sub-domains |
//! | [`subdomains::landforms`] | a triangulation, its sub-domains | a [`Landform`](subdomains::Landform) per sub-domain: outline, class, nesting tree |
//! | [`skeleton::skeleton`] | a triangulation, its sub-domains | ridge and canyon lines with heights |
//! | [`break_lines::BreakLine`] | break lines, in [`surface::Given`] | [`break_lines::FittedBreakLine`]s in the surface: with heights |
//! | [`streams::Streams`] | lines of rivers, in [`surface::Given`] | [`streams::Stream`]s in the surface: with direction and heights |
//! | [`drain::Drain`], [`drain::Sink`] | which pits get a way out, and places where water may stay, in [`surface::Given`] | a surface and height maps with fewer pits; [`drain::Pit`]s that are left |
//! | [`surface::build`] | a clean map | a [`Surface`](surface::Surface): subdivision, skeleton and smooth surface |
//! | [`surface::heights`], [`surface::heights_on`] | a surface, a grid on the plane or in other coordinates | a [`Dem`](raster::Dem), or heights alone |
//! | [`layers::contour_layers`] | a surface, intervals | the input's contours and new contours between them |
//! | [`slice::place_labels`] | contours | [`Label`](slice::Label)s: the elevations of contours as texts with position and angle |
//! | [`raster::rasterise`] | a triangulation, a grid | a [`Dem`](raster::Dem) |
//! | [`dem::join::join`] | a height map with cells without heights, another one | the first, filled from the second without a step |
//! | [`io::raster::read_dem`] | a raster file | a [`Dem`](raster::Dem) |
//! | [`dem::contour::contours`] | a height map, intervals | its contours, smooth and with few vertices |
//! | [`dem::derive::slope`](fn@dem::derive::slope), [`aspect`](dem::derive::aspect), [`shade`](dem::derive::shade), [`steep`](fn@dem::derive::steep) | a height map | a raster each; [`Steeps`](dem::derive::Steeps): steep places as areas |
//! | [`dem::derive::flow_directions`], [`flow_accumulation`](dem::derive::flow_accumulation), [`catchments`](dem::derive::catchments) | a height map | where water flows, how many cells drain through each, [`Catchments`](dem::derive::Catchments) |
//! | [`dem::derive::catchments_above`], [`flow_lines`](dem::derive::flow_lines), [`flood_to_level`](dem::derive::flood_to_level) | where water flows | the ground above an outlet, streams as lines, ground under water |
//! | [`mesh::mesh`](fn@mesh::mesh) | a surface | a [`Mesh`](mesh::Mesh), open or a solid |
//! | [`terrain::DemModel`] | a height map | a [`Mesh`](mesh::Mesh), [`plates::Plates`], or a page in HTML, of its ground |
//! | [`Terrain::plates`] | a terrain, a thickness | [`plates::Plates`]: layers of a model, to be cut out with a laser |
//! | [`draw::preview::render`] | a height map, contours, ridge and canyon lines | a picture |
//! | [`dem::compare::compare`] | two height maps on one grid | a [`Comparison`](dem::compare::Comparison): figures over all cells and by class |
//! | [`dem::compare::difference`] | two height maps on one grid | a [`Dem`](raster::Dem) of their differences |
//! | [`draw::report::remarks`], [`draw::report::comparison_page`], [`draw::report::comparison_sheet`] | a comparison | sentences, a report in HTML, and a map on paper |
//! | [`crs::Reprojection::from_working`] | a coordinate reference system | the conversion of lines and areas to it |
//! | [`io::write_contours`], [`io::raster::write_dem`], [`io::mesh::write_mesh`] | the results | files |
//!
//! Data flows one way, down that table. Each step is a function of its input and its parameters. It returns its result
//! together with [findings](base::error::Finding) about the input.
//!
//! [`validate`] chooses the hyper-parameters of the smooth surface and estimates standard errors, by cross-validation on
//! hidden contours. [`tuning`] holds the fitted constants. [`base`] holds errors, progress, grids and memory limits.
//!
//! # Units and axes
//!
//! x is east, y is north, in the units of the map; elevations are in metres. Files may have heights in feet:
//! [`InputOptions::unit`] for inputs, [`crs::FromWorking::with_heights_in`] and `io::raster::RasterParams` for outputs. Rows of a height map run from north to
//! south. The steps below [`Input`] do not take degrees: [`crs::Reprojection`] converts them to a plane and back.
//! Higher ground lies on the right of every contour that is written.
//!
//! # Features
//!
//! | feature | adds |
//! |---|---|
//! | `io` | reading and writing of files: vector formats, rasters, 3-D models |
//! | `draw` | pictures and reports in HTML |
//! | `cli` (default) | the program `tokosen`; includes `io` and `draw` |
//!
//! The core, without these features, works on data in memory. It depends on crs-definitions, foldhash, geo, glam,
//! proj4rs, pulp, rayon, robust, rstar, serde, serde_json, spade and thiserror.
//!
//! # Examples
//!
//! Contours at an interval of 2 m and a height map from a file of contours, as the command `densify --dem` writes them:
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
//! The same with the single steps: a hill of two contours gets contours at an interval of 2 m and a height map:
//!
//! ```
//! use glam::DVec2;
//! use tokosen::base::Grid;
//! use tokosen::clean::{CleanParams, clean};
//! use tokosen::contour::{Contour, ContourMap, Target};
//! use tokosen::layers::{LayerParams, contour_layers};
//! use tokosen::surface::{Given, SurfaceParams, build, heights};
//!
//! # fn main() -> tokosen::Result<()> {
//! let ring = |radius: f64, elevation: f64| {
//!     let angle = |k: i32| f64::from(k % 60) * std::f64::consts::TAU / 60.0;
//!     let points = (0..=60).map(|k| radius * DVec2::from_angle(angle(k))).collect();
//!     Contour { elevation, points, feature: 0.into() }
//! };
//! let map = ContourMap { contours: vec![ring(200.0, 10.0), ring(80.0, 20.0)], ..ContourMap::default() };
//!
//! let map = clean(map, &CleanParams::default())?.value;
//! let surface = build(map, &Given::default(), &SurfaceParams::default(), &())?.value;
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

// The program's modules name the library as any other front end does.
#[cfg(feature = "cli")]
extern crate self as tokosen;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
pub mod guide;
pub mod terrain;
#[cfg(feature = "io")]
pub mod tiling;

#[doc(inline)]
pub use tokosen_core::{
    arrays, bands, base, break_lines, cartography, check, clean, contour, crs, dem, drain, features, layers, mesh,
    plates, raster, resample, skeleton, slice, spline, streams, subdivision, subdomains, surface, tiles, tin, tuning,
    validate,
};
#[cfg(feature = "draw")]
#[doc(inline)]
pub use tokosen_draw as draw;
#[cfg(feature = "io")]
#[doc(inline)]
pub use tokosen_io as io;

pub use base::error::{Error, Result};
pub use contour::Interval;
pub use terrain::{GridSpec, Input, InputOptions, Options, Terrain};
