//! Height systems of several inputs.

use std::fmt::Display;

#[cfg(feature = "io")]
use super::input::Input;
use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::crs::{HeightSystem, mixed_heights};

/// What is to be said about the height system of a second input beside that of a first one, each with its name.
pub(super) fn beside(
    (first, system): (&dyn Display, &HeightSystem),
    (second, other): (&dyn Display, Option<&HeightSystem>),
) -> Option<Finding> {
    match other {
        Some(other) if other == system => None,
        Some(other) => Some(mixed_heights((first, system), (second, other))),
        None => {
            let message = format!(
                "{second} names no height system; its heights are taken to be in {system}, as those of {first}"
            );
            Some(Finding::general(FindingKind::UnknownHeights, message))
        }
    }
}

/// The finding about two inputs of which either may name its height system.
pub fn height_systems_differ(
    a: (&dyn Display, Option<&HeightSystem>),
    b: (&dyn Display, Option<&HeightSystem>),
) -> Option<Finding> {
    match (a.1, b.1) {
        (Some(system), _) => beside((a.0, system), b),
        (None, Some(system)) => beside((b.0, system), a),
        (None, None) => None,
    }
}

#[cfg(feature = "io")]
impl Input {
    /// Compares the height system of a further input with that of the contours.
    pub(super) fn note_heights(&mut self, of: &dyn Display, system: Option<&HeightSystem>) {
        let name = self.name().into_owned();
        let found = height_systems_differ((&name, self.map.height_system.as_ref()), (of, system));
        self.findings.extend(found);
    }
}
