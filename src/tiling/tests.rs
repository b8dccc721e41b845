//! Tiles give the terrain of an untiled run.
