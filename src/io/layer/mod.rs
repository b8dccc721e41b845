//! Layers of features: shapes with attributes. All writers take them.
//!
//! Every stage passes its output to the writers in this form. A new kind of layer needs no new writer, and a new format
//! needs nothing from the stages. Each stage that writes features has a file here that defines its columns.

mod bands;
mod break_lines;
mod catchments;
mod contours;
mod depths;
mod features;
mod findings;
mod flood;
mod flow_lines;
mod labels;
mod landforms;
mod repaired;
mod reprojected;
mod sinks;
mod skeleton;
mod steep;
mod streams;

pub use bands::{bands_layer, of_bands};
pub use break_lines::break_lines;
pub use catchments::{CATCHMENTS_LAYER, of_catchments, of_outlets};
pub use contours::of_contours;
pub use depths::columns;
pub(super) use features::{Bounds, NO_BOUNDS, check, check_names, file_name, joined};
pub use features::{Cell, Column, Geometry, Kind, Layer, Outer, Row, Shape};
pub use findings::{FINDINGS_LAYER, of_conflicts, of_findings};
pub use flood::{FLOOD_LAYER, of_flood};
pub use flow_lines::{STREAM_LINES_LAYER, of_flow_lines};
pub use labels::{LABELS_LAYER, labels_layer, of_labels};
pub use landforms::{REGIONS_LAYER, of_landforms};
pub use repaired::{REPAIRED_LAYERS, holds_spots, of_map, of_repaired, of_spots};
pub(super) use reprojected::ReprojectedShapes;
pub use sinks::pit_points;
pub use skeleton::{curve_mesh, skeleton_lines, skeleton_triangles};
pub use steep::{STEEP_LAYER, steep_areas};
pub use streams::stream_lines;
