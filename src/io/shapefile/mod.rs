//! Shapefile (Esri technical description, 1998): geometry in `.shp`, its index in `.shx`, attributes in `.dbf`, the
//! coordinate reference system in `.prj`, the encoding of text in `.cpg`.

mod companion;
mod dbf;
pub(super) mod encoding;
mod polygon;
mod read;
mod write;

pub(super) use polygon::grouped;
pub(super) use read::read;
pub(super) use write::write;
