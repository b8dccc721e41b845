//! Models to print: solids in millimetres, scaled to a size.

use glam::DVec3;

use super::Mesh;
use crate::base::error::{Error, Result};

/// Thickness below the lowest ground, millimetres, if the height of the bottom is not given: what holds a plate together.
const FLOOR: f64 = 2.0;

/// How large a model is printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrintParams {
    /// Length of the longer side of the map, millimetres.
    pub size: f64,
    /// Factor on heights.
    pub exaggeration: f64,
    /// Height of the bottom, metres. Two millimetres below the lowest ground if `None`.
    pub base: Option<f64>,
}

impl Default for PrintParams {
    /// 180 mm, which most printers can make, with heights as they are.
    fn default() -> Self {
        Self { size: 180.0, exaggeration: 1.0, base: None }
    }
}

impl Mesh {
    /// The solid over a flat bottom, in millimetres from its lowest, westernmost and southernmost place. `self` is an open shell.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a size or a factor that is not above 0. As [`Mesh::closed`].
    pub fn printed(&self, params: &PrintParams) -> Result<Self> {
        for (name, value) in [("size", params.size), ("factor on heights", params.exaggeration)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::out_of_range(name, value, "more than 0"));
            }
        }
        let (lo, hi) = self.extent();
        let scale = params.size / (hi - lo).truncate().max_element();
        let scale = DVec3::new(scale, scale, scale * params.exaggeration);
        let base = params.base.unwrap_or(lo.z - FLOOR / scale.z);
        let mut solid = self.clone().closed(base)?;
        let corner = lo.truncate().extend(base) - self.origin;
        solid.vertices.iter_mut().for_each(|v| *v = (*v - corner) * scale);
        (solid.origin, solid.base, solid.crs) = (DVec3::ZERO, Some(0.0), None);
        Ok(solid)
    }
}
