//! What a map has besides contours and spot heights: [`Features`], each in a [`Role`].

use crate::base::error::FindingKind;
use crate::break_lines::BreakLine;
use crate::contour::{CliffLine, CoastLine, Excluded, Lake};
use crate::drain::Sink;
use crate::streams::{RiverArea, StreamLine};

/// What lines, polygons or points of a file are to the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// Lines of a coast, or polygons of land or sea.
    Coast,
    /// Polygons whose contours are left out.
    Exclude,
    /// Lines across which the surface may jump.
    Cliffs,
    /// Polygons of level water.
    Water,
    /// Lines along which water flows, and river areas.
    Streams,
    /// Lines along which the ground bends sharply.
    BreakLines,
    /// Points and polygons where water may stay.
    Sinks,
}

/// The words about a role.
struct Words {
    role: Role,
    /// The name of the option, in all front ends.
    name: &'static str,
    /// One feature, for messages.
    one: &'static str,
    /// The shapes of its features, as a sentence.
    shapes: &'static str,
    /// The heights of its features, for messages about their unit.
    heights: &'static str,
    /// The finding about a feature of a file that cannot be one.
    left_out: FindingKind,
    /// The finding about a feature that has no place on the working plane.
    outside: FindingKind,
}

/// All roles, in the order in which an input takes them.
const ROLES: [Words; 7] = [
    Words {
        role: Role::Coast,
        name: "coast",
        one: "coast",
        shapes: "a coast is lines or polygons",
        heights: "the levels of the coast",
        left_out: FindingKind::CoastOutside,
        outside: FindingKind::CoastOutside,
    },
    Words {
        role: Role::Exclude,
        name: "exclude",
        one: "part to leave out",
        shapes: "parts to leave out are polygons",
        heights: "",
        left_out: FindingKind::SkippedFeature,
        outside: FindingKind::SkippedFeature,
    },
    Words {
        role: Role::Cliffs,
        name: "cliffs",
        one: "cliff",
        shapes: "cliffs are lines",
        heights: "",
        left_out: FindingKind::CliffLeftOut,
        outside: FindingKind::CliffLeftOut,
    },
    Words {
        role: Role::Water,
        name: "water",
        one: "lake",
        shapes: "lakes are polygons",
        heights: "the heights of the lakes",
        left_out: FindingKind::SkippedFeature,
        outside: FindingKind::SkippedFeature,
    },
    Words {
        role: Role::Streams,
        name: "streams",
        one: "stream",
        shapes: "streams are lines",
        heights: "",
        left_out: FindingKind::StreamLeftOut,
        outside: FindingKind::StreamOutside,
    },
    Words {
        role: Role::BreakLines,
        name: "breaklines",
        one: "break line",
        shapes: "break lines are lines",
        heights: "the heights of the break lines",
        left_out: FindingKind::BreakLineLeftOut,
        outside: FindingKind::BreakLineLeftOut,
    },
    Words {
        role: Role::Sinks,
        name: "sinks",
        one: "sink",
        shapes: "sinks are points or polygons",
        heights: "",
        left_out: FindingKind::SinkOutside,
        outside: FindingKind::SinkOutside,
    },
];

impl Role {
    /// All roles, in the order in which an input takes them.
    pub fn all() -> impl Iterator<Item = Self> {
        ROLES.iter().map(|words| words.role)
    }

    fn words(self) -> &'static Words {
        &ROLES[self as usize]
    }

    /// The name of the option for files in this role, in all front ends: `streams`, `breaklines`.
    pub fn name(self) -> &'static str {
        self.words().name
    }

    /// One feature in this role, for messages.
    pub fn one(self) -> &'static str {
        self.words().one
    }

    /// Which shapes features in this role have, as a sentence.
    pub fn shapes(self) -> &'static str {
        self.words().shapes
    }

    /// The heights of features in this role, for messages.
    pub fn heights(self) -> &'static str {
        self.words().heights
    }

    /// The kind of the finding about a feature of a file that cannot be one.
    pub fn left_out(self) -> FindingKind {
        self.words().left_out
    }

    /// The kind of the finding about a feature that has no place on the working plane.
    pub fn outside(self) -> FindingKind {
        self.words().outside
    }
}

/// What a map has besides contours and spot heights.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Features {
    /// Lines of a coast.
    pub coast: Vec<CoastLine>,
    /// Parts of the map whose contours are left out.
    pub excluded: Vec<Excluded>,
    /// Cliffs.
    pub cliffs: Vec<CliffLine>,
    /// Lakes.
    pub lakes: Vec<Lake>,
    /// Rivers and streams, in any direction.
    pub streams: Vec<StreamLine>,
    /// Rivers as wide as the map shows them.
    pub river_areas: Vec<RiverArea>,
    /// Break lines.
    pub break_lines: Vec<BreakLine>,
    /// Places where water may stay.
    pub sinks: Vec<Sink>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_role_has_its_own_words() {
        for role in Role::all() {
            assert_eq!(role.words().role, role, "the table is in the order of the roles");
        }
        assert_eq!(Role::all().count(), 7);
    }
}
