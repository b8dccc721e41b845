//! The tests of the library, as one program: it is built once, and all of them run side by side.

#[path = "../common/mod.rs"]
mod common;
#[path = "../guarantees/mod.rs"]
mod guarantees;

mod area_files;
mod bands;
mod break_lines;
mod cliffs;
mod degenerate;
mod elevations;
mod faults;
mod figures;
mod file_box;
mod floors;
mod gorge;
mod gsi_files;
mod height_map_contours;
mod invariants;
mod landforms;
mod layer_files;
mod mesh;
mod more_vector_files;
mod planted;
mod raster_files;
mod read_only_files;
mod sample;
mod seeds;
mod simplified;
mod skeleton;
mod streams;
mod support;
mod surface;
mod uncertainty;
mod vector_files;
mod water;
