//! The position of a block's copy in the drawing.

use glam::{DMat3, DVec3};

/// A normal that is off the vertical by no more than this is vertical: programs round it.
pub(super) const VERTICAL: f64 = 1e-12;

/// An affine map from a block to the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    matrix: DMat3,
    shift: DVec3,
}

impl Placement {
    /// The drawing itself.
    pub const IDENTITY: Self = Self { matrix: DMat3::IDENTITY, shift: DVec3::ZERO };

    /// A placement by the images of the three axes, and then a shift.
    pub fn new(matrix: DMat3, shift: DVec3) -> Self {
        Self { matrix, shift }
    }

    /// The position of a point. Points of the drawing itself keep their bits.
    pub fn apply(&self, point: DVec3) -> DVec3 {
        if *self == Self::IDENTITY { point } else { self.matrix * point + self.shift }
    }

    /// This placement of what `inner` places.
    pub fn of(&self, inner: &Self) -> Self {
        Self { matrix: self.matrix * inner.matrix, shift: self.apply(inner.shift) }
    }

    /// The same placement, shifted further.
    pub fn shifted(&self, by: DVec3) -> Self {
        Self { shift: self.shift + by, ..*self }
    }

    /// The largest factor by which a length grows, but at least 1.
    pub fn growth(&self) -> f64 {
        let [x, y, z] = [self.matrix.x_axis, self.matrix.y_axis, self.matrix.z_axis];
        // The norm of the columns is at least that of the matrix.
        (x.length_squared() + y.length_squared() + z.length_squared()).sqrt().max(1.0)
    }
}
