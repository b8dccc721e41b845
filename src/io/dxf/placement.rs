//! The position of a block's copy in the drawing: scale, rotation, shift and the plane of an `INSERT`.
//!
//! Coordinates of planar entities and of references count in the plane of the entity. Its axes follow from its normal by
//! the "arbitrary axis algorithm" of the DXF reference (AutoCAD, section "Object Coordinate Systems").

use glam::{DMat3, DVec2, DVec3};

use super::entity::Entity;
use crate::base::error::Result;

/// If x and y of a normal are smaller, the x axis of the plane is taken from the y axis of the world.
const NEAR_VERTICAL: f64 = 1.0 / 64.0;
/// A normal that is off the vertical by no more than this is vertical: programs round it.
pub(super) const VERTICAL: f64 = 1e-12;

/// An affine map from a block to the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    matrix: DMat3,
    shift: DVec3,
}

/// The copies that one reference to a block stands for.
pub(super) struct Copies {
    first: Placement,
    /// The shifts from a column and from a row to the next, in the drawing.
    steps: [DVec3; 2],
    /// The number of columns and of rows.
    pub counts: [u64; 2],
}

impl Placement {
    /// The drawing itself.
    pub const IDENTITY: Self = Self { matrix: DMat3::IDENTITY, shift: DVec3::ZERO };

    /// The position of a point. Points of the drawing itself keep their bits.
    pub fn apply(&self, point: DVec3) -> DVec3 {
        if *self == Self::IDENTITY { point } else { self.matrix * point + self.shift }
    }

    /// This placement of what `inner` places.
    pub fn of(&self, inner: &Self) -> Self {
        Self { matrix: self.matrix * inner.matrix, shift: self.apply(inner.shift) }
    }

    /// The largest factor by which a length grows, but at least 1.
    pub fn growth(&self) -> f64 {
        let [x, y, z] = [self.matrix.x_axis, self.matrix.y_axis, self.matrix.z_axis];
        // The norm of the columns is at least that of the matrix.
        (x.length_squared() + y.length_squared() + z.length_squared()).sqrt().max(1.0)
    }
}

impl Copies {
    /// The copies of a block with this base point by an `INSERT`.
    pub fn of(insert: &Entity<'_>, base: DVec3) -> Result<Self> {
        let or_one = |code| if insert.find(code).is_some() { insert.number(code) } else { Ok(1.0) };
        let scale = DVec3::new(or_one(41)?, or_one(42)?, or_one(43)?);
        let plane = axes(insert)?;
        let turn = of_z(insert.number(50)?);
        let matrix = plane * turn * DMat3::from_diagonal(scale);
        let shift = plane * insert.point(10)? - matrix * base;
        let across = plane * turn;
        let count = |code| Ok::<u64, crate::base::error::Error>(u64::try_from(insert.flags(code)?).unwrap_or(1).max(1));
        Ok(Self {
            first: Placement { matrix, shift },
            steps: [across * DVec3::X * insert.number(44)?, across * DVec3::Y * insert.number(45)?],
            counts: [count(70)?, count(71)?],
        })
    }

    /// The placement of the copy in a column and a row.
    pub fn at(&self, column: u64, row: u64) -> Placement {
        let [across, down] = self.steps;
        let shift = self.first.shift + across * column as f64 + down * row as f64;
        Placement { matrix: self.first.matrix, shift }
    }
}

/// A rotation about the z axis, degrees. Quarters are exact, so that borders stay straight.
fn of_z(degrees: f64) -> DMat3 {
    let quarter = degrees.rem_euclid(360.0) / 90.0;
    let turn = match quarter {
        0.0 => DVec2::X,
        1.0 => DVec2::Y,
        2.0 => DVec2::NEG_X,
        3.0 => DVec2::NEG_Y,
        _ => DVec2::from_angle(degrees.to_radians()),
    };
    DMat3::from_cols(turn.extend(0.0), turn.perp().extend(0.0), DVec3::Z)
}

/// The axes of an entity's plane.
fn axes(entity: &Entity<'_>) -> Result<DMat3> {
    let Some(normal) = entity.normal()?.try_normalize() else { return Ok(DMat3::IDENTITY) };
    if normal.truncate().abs().max_element() <= VERTICAL {
        let side = normal.z.signum();
        return Ok(DMat3::from_diagonal(DVec3::new(side, 1.0, side)));
    }
    let start = if normal.x.abs() < NEAR_VERTICAL && normal.y.abs() < NEAR_VERTICAL { DVec3::Y } else { DVec3::Z };
    let x = start.cross(normal).normalize();
    Ok(DMat3::from_cols(x, normal.cross(x), normal))
}
