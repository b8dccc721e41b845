//! What a step noticed in the input: [`Finding`], its [`FindingKind`], [`Severity`] and [`Proposal`].

use std::fmt;

use glam::DVec2;

use crate::base::FeatureId;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Worth knowing; nothing is wrong with the result.
    Note,
    /// Unusual. The result is sound, but may not be what the map means.
    Warning,
    /// Wrong. The ground near it cannot be right, or something was left out because of it.
    Error,
}

impl Severity {
    /// The word in messages and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// Declares each kind with its code, severity and heading. The compiler then refuses a kind that lacks one.
macro_rules! kinds {
    ($($(#[$doc:meta])+ $name:ident = $code:literal, $severity:ident, $title:literal;)+) => {
        /// The kinds of finding, in the order of the steps that report them.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum FindingKind {
            $($(#[$doc])+ $name,)+
        }

        impl FindingKind {
            /// All kinds, in their order.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// The code for files and programs, which stays the same from version to version.
            pub fn code(self) -> &'static str {
                match self {
                    $(Self::$name => $code,)+
                }
            }

            /// How bad findings of this kind are.
            pub fn severity(self) -> Severity {
                match self {
                    $(Self::$name => Severity::$severity,)+
                }
            }

            /// What the findings of this kind are about, as a heading.
            pub fn title(self) -> &'static str {
                match self {
                    $(Self::$name => $title,)+
                }
            }
        }
    };
}

kinds! {
    /// A feature without a usable geometry; it was left out.
    SkippedFeature = "skipped-feature", Error, "features left out";
    /// A feature without a usable elevation among others that have one; it was left out.
    MissingElevation = "missing-elevation", Error, "features without an elevation left out";
    /// The coordinate reference system is not known.
    UnknownCrs = "unknown-crs", Note, "coordinate reference system unknown";
    /// Files are in several coordinate reference systems. They were treated as one system.
    MixedCrs = "mixed-crs", Warning, "different coordinate reference systems treated as one";
    /// One of several files is in another coordinate reference system; its lines were transformed.
    OtherCrs = "other-crs", Note, "files transformed to the coordinate reference system of the others";
    /// Coordinates are degrees where a plane is expected, or the other way round.
    LooksLikeDegrees = "looks-like-degrees", Error, "coordinates that look like degrees";
    /// Contours and spot heights inside a polygon were left out, as asked for.
    Excluded = "excluded", Note, "parts of the map left out";
    /// No contour and no spot height lies inside the polygons that were to be left out.
    NothingExcluded = "nothing-excluded", Warning, "polygons to leave out without contours in them";
    /// A square of a height map occurs twice.
    RepeatedMesh = "repeated-mesh", Note, "squares of the height map that occur twice";
    /// A file occurs twice, for instance in an archive and beside it. It was read once.
    RepeatedFile = "repeated-file", Note, "files that occur twice";
    /// A coordinate is NaN or infinite; the point was left out.
    NonFinitePoint = "non-finite-point", Error, "points without valid coordinates left out";
    /// Lines far from all others: a map sheet in the wrong zone, or an error in a coordinate.
    FarAway = "far-away", Error, "lines far from all others";
    /// The file leaves open which coordinate comes first, or many programs write it otherwise than its name says.
    AxisOrder = "axis-order", Note, "order of coordinates not certain";
    /// The coordinates fit their coordinate reference system with x and y the other way round.
    AxesSwapped = "axes-swapped", Warning, "coordinates whose x and y look swapped";
    /// The same point twice or more in a row; one was kept.
    RepeatedPoint = "repeated-point", Note, "repeated points";
    /// A line with fewer than two different points; left out.
    PointLine = "point-line", Warning, "lines without length left out";
    /// A line that is too short to mean anything on the map.
    ShortLine = "short-line", Note, "very short lines";
    /// The same line twice; one was kept.
    DuplicateLine = "duplicate-line", Warning, "duplicate lines";
    /// A line runs to a point and back the same way; the spike was left out.
    Spike = "spike", Warning, "spikes";
    /// A vertex that sticks out of an otherwise smooth line.
    StrayVertex = "stray-vertex", Warning, "vertices that stick out of their line";
    /// Lines overlap along a part of their length; a piece of one was cut out.
    OverlappingLines = "overlapping-lines", Error, "lines that overlap";
    /// A line crosses or touches itself, or crosses another line of its elevation; a piece was cut out.
    SelfCross = "self-cross", Error, "lines that cross themselves or a line of their level";
    /// Lines of different elevation cross or touch; a piece was cut out.
    LevelsCross = "levels-cross", Error, "lines of different level that cross or touch";
    /// Two lines of different elevation share an end, and no other line ends there: one line whose elevation jumps.
    LevelJump = "level-jump", Error, "elevations that jump along a line";
    /// Two ends of one level were joined. The gap was no wider than the snap distance.
    ClosedGap = "closed-gap", Note, "gaps closed";
    /// Two ends of one level that should join, but are further apart than the snap distance.
    Gap = "gap", Error, "gaps";
    /// A line ends inside the map, away from the frame and from other ends of its level.
    OpenEnd = "open-end", Warning, "lines that end inside the map";
    /// A level off the vertical interval: an auxiliary contour, or a wrong elevation.
    OffInterval = "off-interval", Note, "levels off the vertical interval";
    /// An elevation of 0 where the ground is not at 0, or a number that stands for "no data".
    ZeroElevation = "zero-elevation", Error, "elevations that are 0 or stand for no data";
    /// Levels, or heights along a line, that differ by rounding only. They were taken as one level.
    SameLevel = "same-level", Note, "levels that differ by rounding only";
    /// Polygons that are at one elevation. Their outlines were read as contours.
    PolygonContour = "polygon-contour", Note, "polygons read as contours";
    /// The name of an attribute says that it holds depths, and they are taken as heights, or the other way round.
    Depths = "depths", Warning, "elevations that may be depths";
    /// An elevation above the highest mountain, or far below the sea on land.
    ImplausibleElevation = "implausible-elevation", Warning, "elevations that no ground on land has";
    /// The unit of elevations is not certain: the signs of it contradict each other, or the unit in use.
    UnitDoubt = "unit-doubt", Warning, "elevations whose unit is not certain";
    /// The unit of x and y is not certain: elevations are in feet and nothing states it, or two statements contradict each other.
    PlaneUnit = "plane-unit", Warning, "coordinates whose unit is not certain";
    /// Some elevations are in feet and some in metres.
    MixedUnits = "mixed-units", Error, "metres and feet mixed";
    /// A line's elevation contradicts the lines around it.
    WrongLabel = "wrong-label", Error, "elevations that contradict the lines around";
    /// Neighbouring contours skip one or more levels: a contour is missing.
    SkippedLevel = "skipped-level", Error, "neighbouring contours that skip a level";
    /// All contours have one level, or there are none. No surface can be made of them.
    TooFewLevels = "too-few-levels", Error, "too few levels for a surface";
    /// The input marks a contour as a depression and the ground inside is higher, or the other way round.
    DepressionMark = "depression-mark", Warning, "depression marks that the contours contradict";
    /// A hollow inside a single contour looks like water, and no lake was given there.
    MayBeLake = "may-be-lake", Note, "hollows that may be lakes";
    /// The lowest contours look like a coast, and no sea level was given.
    MayBeSea = "may-be-sea", Note, "contours that may be a coast";
    /// A spot height lies on a contour or on another spot height, with a different elevation; it was left out.
    SpotOnLine = "spot-on-line", Warning, "spot heights on contours";
    /// A spot height does not lie between the two levels around it; it was left out.
    SpotOutsideBand = "spot-outside-band", Warning, "spot heights outside the contours around them";
    /// The surface does not pass through spot heights, because others are too near.
    SpotMissed = "spot-missed", Warning, "spot heights that the surface misses";
    /// A line was given the elevation that fits the lines around it.
    Relabelled = "relabelled", Note, "elevations corrected";
    /// Two ends were joined across a gap wider than the snap distance.
    JoinedGap = "joined-gap", Note, "gaps joined";
    /// A stray vertex of a line was left out.
    Straightened = "straightened", Note, "stray vertices left out";
    /// The frame polygon reaches beyond the area that the contours describe; it was cut back.
    FrameBeyondMap = "frame-beyond-map", Note, "frame larger than the map";
    /// The nodes of the smooth surface are further apart than the contours ask for.
    CoarseNodes = "coarse-nodes", Warning, "surfaces coarser than the contours";
    /// Much of the convex hull of the contours is far from all of them.
    HullBeyondMap = "hull-beyond-map", Note, "convex hull larger than the map";
    /// A lake meets contours of another level, the extension of a contour to the frame, or other water. It was cut back
    /// from them.
    LakeCutBack = "lake-cut-back", Warning, "lakes cut back from contours";
    /// A lake contradicts the contours around it; it was left out.
    LakeLeftOut = "lake-left-out", Warning, "lakes left out";
    /// Contours lie below sea level; the ground around them was left unchanged.
    BelowSea = "below-sea", Note, "contours below the sea";
    /// A stream was drawn upstream; it was turned.
    StreamTurned = "stream-turned", Note, "streams drawn upstream";
    /// A stream was moved to agree with the contours.
    StreamMoved = "stream-moved", Note, "streams moved into the bends of contours";
    /// A stream crosses the contours beside their bends, further away than it may be moved. It is used where it is.
    StreamBeside = "stream-beside", Warning, "streams beside their valleys";
    /// A stream runs upwards across a contour. The part that does was left out.
    StreamCut = "stream-cut", Warning, "streams that run upwards across contours";
    /// The surface rises along a stream between contours. The stream is cut there.
    StreamClimbs = "stream-climbs", Warning, "streams along which the ground rises";
    /// A stream parts, and its branches do not meet again.
    StreamParts = "stream-parts", Warning, "streams that part";
    /// Most streams contradict the contours. They are of another place.
    StreamsElsewhere = "streams-elsewhere", Error, "streams that are not those of the contours";
    /// A stream, or a piece of it, is no line along which water runs: a point, a loop, a copy. It was left out.
    StreamLeftOut = "stream-left-out", Warning, "streams left out";
    /// A stream, or a piece of it, lies outside the frame. It was left out there.
    StreamOutside = "stream-outside", Note, "streams outside the frame";
    /// No stream runs through a river area. Its middle line counts as one.
    RiverMiddle = "river-middle", Note, "river areas without a stream, whose middle lines count as streams";
    /// The heights of a break line contradict the contours, which win.
    BreakLineConflict = "breakline-conflict", Warning, "heights of break lines that contradict the contours";
    /// A break line, or a piece of it, lies outside the frame or in water. It was left out there.
    BreakLineOutside = "breakline-outside", Note, "break lines outside the frame or in water";
    /// A break line is a point, or has no place on the map. It was left out.
    BreakLineLeftOut = "breakline-left-out", Warning, "break lines left out";
    /// The attribute `kind` of break lines has a value that is not known.
    BreakLineKind = "breakline-kind", Note, "break lines of an unknown kind";
    /// A contour ends at a cliff, or runs together with others in it.
    AtCliff = "at-cliff", Note, "contours that meet cliffs";
    /// A cliff is a point, or has no place on the map. It was left out.
    CliffLeftOut = "cliff-left-out", Warning, "cliffs left out";
    /// The base has no height at any cell outside the surface.
    BaseUnused = "base-unused", Warning, "bases that give no height";
    /// The base has no heights along the border of the surface, so both were not joined.
    BaseApart = "base-apart", Warning, "bases apart from the surface";
    /// The base lies above or below the surface by more than the contours allow.
    BaseDiffers = "base-differs", Warning, "bases that do not fit the surface";
    /// A coast does not part land from sea.
    CoastContradicted = "coast-contradicted", Warning, "coasts that do not part land from sea";
    /// A contour above the sea has no coast around it, or one below the sea is the only sign of its ground.
    ContourInSea = "contour-in-sea", Warning, "contours in the sea";
    /// A line of a coast has no place on the map.
    CoastOutside = "coast-outside", Note, "coasts without a place on the map";
    /// A sink holds no pit, or is no place; it has no effect.
    SinkWithoutPit = "sink-without-pit", Note, "sinks without a pit";
    /// A sink lies outside the frame.
    SinkOutside = "sink-outside", Note, "sinks outside the frame";
    /// Ground inside contours that are all higher was drained, as asked for.
    HollowDrained = "hollow-drained", Note, "hollows inside contours drained";
    /// An outlet whose catchment is asked for lies outside the height map.
    OutletOutside = "outlet-outside", Warning, "outlets outside the height map";
    /// The catchment above an outlet reaches the edge of the height map. In truth it may be larger.
    CatchmentCut = "catchment-cut", Warning, "catchments that reach the edge of the height map";
    /// A place that the water of a flood was to come from is not below the level, or outside the height map.
    FloodSourceDry = "flood-source-dry", Warning, "places that no flood can come from";
    /// A contour ends inside the map. It is no border of a band.
    BandOpenLine = "band-open-line", Warning, "contours that bound no band";
    /// The lines around an area do not agree on two neighbouring levels.
    BandUnclear = "band-unclear", Warning, "bands of more than one step";
    /// Nearly all pixels of the terrain tiles lie beyond the height map.
    TilesBeyondMap = "tiles-beyond-map", Warning, "terrain tiles mostly beyond the map";
    /// A surface of triangles was read as a height map.
    TriangleCells = "triangle-cells", Note, "triangles read at the centres of cells";
    /// A raster has more than one band; the first was taken.
    OtherBands = "other-bands", Note, "raster bands left out";
    /// Cells of a raster hold values that are not heights. They count as cells without data.
    NoHeight = "no-height", Note, "cells whose values are not heights";
    /// A new contour ends at the border of a tile.
    SeamEnd = "seam-end", Warning, "new contours that end at the border of a tile";
    /// Tiles disagree about the side of a contour on which the ground is higher.
    SeamSides = "seam-sides", Warning, "contours whose higher side differs between tiles";
    /// Inputs are in different height systems. Their heights were used as they are.
    MixedHeights = "mixed-heights", Warning, "different height systems treated as one";
    /// An input names no height system, and another one does.
    UnknownHeights = "unknown-heights", Note, "height systems that are not named";
    /// Heights are in another unit than metres.
    HeightUnit = "height-unit", Note, "heights in another unit than metres";
    /// A picture in colour does not state how its colours become heights. It is read as an elevation tile of GSI.
    ColourEncoding = "colour-encoding", Note, "pictures in colour read as elevation tiles of GSI";
}

impl FindingKind {
    /// Whether two inputs contradict each other: contours and a stream, a lake, a break line, a cliff or a spot height.
    pub fn is_conflict(self) -> bool {
        matches!(
            self,
            Self::StreamCut
                | Self::StreamBeside
                | Self::StreamMoved
                | Self::LakeCutBack
                | Self::LakeLeftOut
                | Self::SpotOnLine
                | Self::SpotOutsideBand
                | Self::BreakLineConflict
                | Self::AtCliff
        )
    }
}

impl serde::Serialize for FindingKind {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.code())
    }
}

/// A correction that would remove the fault.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
pub enum Proposal {
    /// Give the line at the finding's place another elevation.
    Relabel {
        /// The elevation that it has, metres.
        from: f64,
        /// The elevation that fits, metres.
        to: f64,
    },
    /// Join two ends of lines of one level by a straight piece.
    Join {
        /// The ends, in the coordinates of the finding's place.
        ends: [DVec2; 2],
    },
    /// Leave out the vertex at the finding's place.
    LeaveOut,
}

impl Proposal {
    /// The proposal in words. `place` is a place in the coordinates of the reader, in words.
    pub fn in_words(&self, place: impl Fn(DVec2) -> String) -> String {
        match self {
            Self::Relabel { from, to } => format!("elevation {to} m instead of {from} m"),
            Self::LeaveOut => "leave out the vertex".to_owned(),
            Self::Join { ends } => {
                let [a, b] = ends.map(place);
                format!("join {a} and {b}")
            }
        }
    }
}

/// Something that a step noticed in the input, with its position. The step continued.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Finding {
    /// What kind of thing it is.
    pub kind: FindingKind,
    /// Where, in the input's coordinates, if it has a position.
    pub place: Option<DVec2>,
    /// A sentence for people.
    pub message: String,
    /// The features that it is about.
    pub features: Vec<FeatureId>,
    /// The elevations of those lines, metres.
    pub elevations: Vec<f64>,
    /// The correction, where one is known.
    pub proposal: Option<Proposal>,
}

impl Finding {
    /// A finding, with a position if it has one.
    pub fn new(kind: FindingKind, place: Option<DVec2>, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { kind, place, message, features: Vec::new(), elevations: Vec::new(), proposal: None }
    }

    /// A finding at a position.
    pub fn at(kind: FindingKind, place: DVec2, message: impl Into<String>) -> Self {
        Self::new(kind, Some(place), message)
    }

    /// A finding about the whole input.
    pub fn general(kind: FindingKind, message: impl Into<String>) -> Self {
        Self::new(kind, None, message)
    }

    /// The same finding, also about a line: the number of its feature, and its elevation. Call it again for further
    /// lines; nothing is listed twice.
    pub fn about(mut self, feature: impl Into<FeatureId>, elevation: f64) -> Self {
        let feature = feature.into();
        if !self.features.contains(&feature) {
            self.features.push(feature);
        }
        self.of_elevations([elevation])
    }

    /// The same finding, also about a feature that has no elevation.
    pub fn of_feature(mut self, feature: impl Into<FeatureId>) -> Self {
        self.features.push(feature.into());
        self
    }

    /// The same finding, also about heights that belong to no feature, metres.
    pub fn of_elevations(mut self, elevations: impl IntoIterator<Item = f64>) -> Self {
        for elevation in elevations {
            if !self.elevations.contains(&elevation) && elevation.is_finite() {
                self.elevations.push(elevation);
            }
        }
        self
    }

    /// The same with its place in the sentence instead, in the coordinates that it has.
    pub fn with_place_in_words(&self) -> Self {
        let Some(p) = self.place else { return self.clone() };
        // Seven decimals of what may be degrees are a centimetre.
        let decimals = if p.x.abs() <= 360.0 && p.y.abs() <= 90.0 { 7 } else { 3 };
        Self::general(self.kind, format!("{} at {:.decimals$} {:.decimals$}", self.message, p.x, p.y))
    }

    /// The same finding with a proposed correction.
    pub fn proposing(self, proposal: Proposal) -> Self {
        Self { proposal: Some(proposal), ..self }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Some(p) => write!(f, "{} at {:.3} {:.3}", self.message, p.x, p.y),
            None => f.write_str(&self.message),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_of_the_names_and_differ() {
        let mut codes: Vec<&str> = FindingKind::ALL.iter().map(|kind| kind.code()).collect();
        for kind in FindingKind::ALL {
            let name = format!("{kind:?}").to_lowercase();
            assert_eq!(kind.code().replace('-', ""), name);
        }
        codes.sort_unstable();
        codes.dedup();
        assert_eq!(codes.len(), FindingKind::ALL.len());
    }
}
