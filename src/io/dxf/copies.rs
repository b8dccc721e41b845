//! The copies of a block that an `INSERT` stands for: scale, rotation, shift, plane, columns and rows.
//!
//! Coordinates of planar entities and of references count in the plane of the entity. Its axes follow from its normal by
//! the "arbitrary axis algorithm" of the DXF reference (AutoCAD, section "Object Coordinate Systems").

use glam::{DMat3, DVec2, DVec3};

use super::entity::Entity;
use super::placement::{Placement, VERTICAL};
use tokosen_core::base::error::Result;

/// If x and y of a normal are smaller, the x axis of the plane is taken from the y axis of the world.
const NEAR_VERTICAL: f64 = 1.0 / 64.0;

/// The copies that one reference to a block stands for.
pub(super) struct Copies {
    first: Placement,
    /// The shifts from a column and from a row to the next, in the drawing.
    steps: [DVec3; 2],
    /// The number of columns and of rows.
    pub counts: [u64; 2],
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
        let count =
            |code| Ok::<u64, tokosen_core::base::error::Error>(u64::try_from(insert.flags(code)?).unwrap_or(1).max(1));
        Ok(Self {
            first: Placement::new(matrix, shift),
            steps: [across * DVec3::X * insert.number(44)?, across * DVec3::Y * insert.number(45)?],
            counts: [count(70)?, count(71)?],
        })
    }

    /// The placement of the copy in a column and a row.
    pub fn at(&self, column: u64, row: u64) -> Placement {
        let [across, down] = self.steps;
        self.first.shifted(across * column as f64).shifted(down * row as f64)
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
