//! The entry to the library, from contour lines to results: [`Input`] → [`Terrain`] → contours, height maps, errors,
//! meshes.
//!
//! This module calls the steps of the other modules in the right order. The findings about the input are in
//! [`Terrain::findings`].

mod base;
#[cfg(feature = "io")]
mod beside;
mod clipped;
mod compare;
mod dem_area;
mod dem_model;
#[cfg(feature = "draw")]
mod dem_page;
#[cfg(feature = "draw")]
mod difference_page;
mod facade;
#[cfg(feature = "io")]
mod files;
mod grid;
mod height_map;
mod height_systems;
#[cfg(feature = "draw")]
mod html;
mod input;
#[cfg(feature = "io")]
mod json;
mod lengths;
mod measure;
mod options;
mod outline;
pub(crate) mod part;
mod places;
mod plane;
mod plane_cells;
#[cfg(feature = "io")]
mod planned;
mod plates;
mod plausible;
mod preparation;
mod prepare;
mod profile;
#[cfg(feature = "draw")]
mod report;
mod room;
mod sample;
mod samples;
#[cfg(feature = "io")]
mod sheets;
#[cfg(all(test, feature = "io"))]
mod tests;
mod units;
mod volume;

pub use base::BaseJoin;
#[cfg(feature = "io")]
pub(crate) use beside::Beside;
#[cfg(feature = "io")]
pub use clipped::clip_areas;
pub use clipped::{clip_edges, clip_skeleton, clip_streams, clip_subdivision};
pub use compare::{Kind, Nodes, Pair, Side, SideSource};
#[cfg(feature = "io")]
pub use dem_area::read_area_on;
pub use dem_area::{area_on, extent_on};
pub use dem_model::DemModel;
#[cfg(feature = "draw")]
pub use difference_page::difference_page;
pub use facade::Terrain;
#[cfg(feature = "io")]
pub use files::read_check_points;
pub use grid::GridSpec;
pub use height_map::HeightMap;
pub use height_systems::height_systems_differ;
#[cfg(feature = "draw")]
pub use html::HtmlParams;
pub use input::{Input, InputOptions};
#[cfg(feature = "io")]
pub use json::{check_json, comparison_json};
pub use measure::{MeasureOptions, add_check_points, measure};
pub use options::Options;
#[cfg(feature = "io")]
pub use places::read_places_in;
pub use places::{Outlets, Place, flood_source};
#[cfg(feature = "io")]
pub(crate) use planned::{Ground, Planned, TileParams, lake_height, tile_surface};
pub use preparation::{Preparation, Repair};
pub use prepare::{all_right, is_repair};
#[cfg(feature = "io")]
pub use profile::read_profile;
pub use profile::{Profile, ProfileParams, ProfilePoint, ProfileRun, profile};
#[cfg(feature = "draw")]
pub use report::{difference_map, page, sentences};
pub use sample::Sample;
pub use tokosen_core::arrays::{RaggedLines, TriangleArrays};
pub use volume::{VolumeSides, heights_of};
