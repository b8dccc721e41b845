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

/// The shapes that features in a role may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shapes {
    /// Lines.
    Lines,
    /// Polygons.
    Polygons,
    /// Lines or polygons.
    LinesOrPolygons,
    /// Lines; polygons only count where there are no lines.
    LinesElsePolygons,
    /// Points or polygons.
    PointsOrPolygons,
}

impl Shapes {
    /// In words: `lines or polygons`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Lines => "lines",
            Self::Polygons => "polygons",
            Self::LinesOrPolygons | Self::LinesElsePolygons => "lines or polygons",
            Self::PointsOrPolygons => "points or polygons",
        }
    }
}

/// What features in a role are for. Each also serves what comes after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Serves {
    /// The contours themselves, also where no surface is made.
    Contours,
    /// Every surface.
    Surface,
    /// Surfaces with ridge and canyon lines.
    Skeleton,
    /// The smooth surface alone.
    Spline,
}

/// What is known about a role.
struct Words {
    role: Role,
    /// The flag, with the name of the option in all front ends.
    flag: &'static str,
    /// The names that other programs have for it.
    also: &'static [&'static str],
    /// One feature, for messages.
    one: &'static str,
    /// Several features, for messages.
    many: &'static str,
    shapes: Shapes,
    serves: Serves,
    /// The finding about a feature of a file that cannot be one.
    left_out: FindingKind,
    /// The finding about a feature that has no place on the working plane.
    outside: FindingKind,
}

/// All roles, in the order in which an input takes them.
const ROLES: [Words; 7] = [
    Words {
        role: Role::Coast,
        flag: "--coast",
        also: &["coastline", "coast-line", "shoreline"],
        one: "coast",
        many: "coasts",
        shapes: Shapes::LinesOrPolygons,
        serves: Serves::Contours,
        left_out: FindingKind::CoastOutside,
        outside: FindingKind::CoastOutside,
    },
    Words {
        role: Role::Exclude,
        flag: "--exclude",
        also: &[],
        one: "part to leave out",
        many: "parts to leave out",
        shapes: Shapes::Polygons,
        serves: Serves::Contours,
        left_out: FindingKind::SkippedFeature,
        outside: FindingKind::SkippedFeature,
    },
    Words {
        role: Role::Cliffs,
        flag: "--cliffs",
        also: &["cliff", "faults", "fault", "barriers", "scarps"],
        one: "cliff",
        many: "cliffs",
        shapes: Shapes::Lines,
        serves: Serves::Contours,
        left_out: FindingKind::CliffLeftOut,
        outside: FindingKind::CliffLeftOut,
    },
    Words {
        role: Role::Water,
        flag: "--water",
        also: &["lakes", "lake", "waterbodies", "hydro"],
        one: "lake",
        many: "lakes",
        shapes: Shapes::Polygons,
        serves: Serves::Surface,
        left_out: FindingKind::SkippedFeature,
        outside: FindingKind::SkippedFeature,
    },
    Words {
        role: Role::Streams,
        flag: "--streams",
        also: &["rivers", "river", "stream", "drainage", "flowlines", "burn", "burn-in"],
        one: "stream",
        many: "streams",
        shapes: Shapes::LinesElsePolygons,
        serves: Serves::Skeleton,
        left_out: FindingKind::StreamLeftOut,
        outside: FindingKind::StreamOutside,
    },
    Words {
        role: Role::BreakLines,
        flag: "--breaklines",
        also: &["break-lines", "breakline", "break-line", "hardlines", "edges", "structure-lines"],
        one: "break line",
        many: "break lines",
        shapes: Shapes::Lines,
        serves: Serves::Skeleton,
        left_out: FindingKind::BreakLineLeftOut,
        outside: FindingKind::BreakLineLeftOut,
    },
    Words {
        role: Role::Sinks,
        flag: "--sinks",
        also: &["sink", "depressions", "pits"],
        one: "sink",
        many: "sinks",
        shapes: Shapes::PointsOrPolygons,
        serves: Serves::Spline,
        left_out: FindingKind::SinkOutside,
        outside: FindingKind::SinkOutside,
    },
];

impl Role {
    /// All roles, in the order in which an input takes them.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        ROLES.iter().map(|words| words.role)
    }

    const fn words(self) -> &'static Words {
        &ROLES[self as usize]
    }

    /// The flag for files in this role: `--streams`, `--breaklines`.
    pub fn flag(self) -> &'static str {
        self.words().flag
    }

    /// The name of the option for files in this role, in all front ends: `streams`, `breaklines`.
    pub fn name(self) -> &'static str {
        self.flag().trim_start_matches('-')
    }

    /// The names that other programs have for this option.
    pub fn also(self) -> &'static [&'static str] {
        self.words().also
    }

    /// One feature in this role, for messages.
    pub const fn one(self) -> &'static str {
        self.words().one
    }

    /// Several features in this role, for messages.
    pub const fn many(self) -> &'static str {
        self.words().many
    }

    /// The shapes that features in this role may have.
    pub fn shapes(self) -> Shapes {
        self.words().shapes
    }

    /// Which shapes features in this role have, as a sentence: `streams are lines or polygons`.
    pub fn sentence(self) -> String {
        format!("{} are {}", self.many(), self.shapes().words())
    }

    /// What features in this role are for.
    pub fn serves(self) -> Serves {
        self.words().serves
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
