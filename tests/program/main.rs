//! The tests of the command line, as one program: it is built once, and all of them run side by side.

#[path = "../common/mod.rs"]
mod common;

mod base;
mod break_lines;
mod check;
mod coast;
mod compare;
mod contour;
mod coordinates;
mod countries;
mod derive;
mod districts;
mod drain;
mod elevations;
mod everyday;
mod exclude;
mod existing_outputs;
mod feet_jobs;
mod file_troubles;
mod flow;
mod geopackage_locks;
mod guide_pages;
mod hulls;
mod labels;
mod maps;
mod negative_numbers;
mod no_ordinary_files;
mod other_crs;
mod other_inputs;
mod out_of_proportion;
mod paper;
mod parts;
mod phones;
mod plane_units;
mod profile_volume;
mod progress;
mod running;
mod saved_runs;
mod several_files;
mod streams;
mod tiles;
mod units;
mod verbs;
mod when_a_map_looks_wrong;
mod words;
