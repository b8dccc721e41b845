//! GeoPackage (OGC 12-128r17, version 1.3): an SQLite file with agreed tables.

mod engine;
mod index;
mod merge;
mod quoted;
mod read;
mod styles;
mod target;
pub(super) mod wkb;
mod write;

pub(super) use merge::merge;
pub(super) use read::read;
pub(super) use target::{check_layers, is_there};
pub(super) use write::write;
