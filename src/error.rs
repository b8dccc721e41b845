//! What can go wrong ([`Error`]) and what was noticed on the way ([`Finding`]).
//!
//! An error stops the work. A finding does not: a step that finds something odd in its input goes on and hands the
//! finding back beside its result in a [`Report`], so that nothing is dropped without a word.

use std::fmt;
use std::path::{Path, PathBuf};

use glam::DVec2;

/// The library's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The cause below an error, as other crates report it.
pub type Cause = Box<dyn std::error::Error + Send + Sync + 'static>;

/// Why the work could not be done. The text says what, where and what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to open, read, write or rename a file.
    #[error("cannot {action} {}", path.display())]
    Io {
        /// What was tried, as a verb: "read", "write", "create".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's own word.
        source: std::io::Error,
    },
    /// A file is not what it should be. The message names the feature and the place where it can.
    #[error("{}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        message: String,
        /// The error of the format's library, if that is where it came from.
        source: Option<Cause>,
    },
    /// The data were read, and no surface can be made of them.
    #[error("{0}")]
    Data(String),
    /// Parameters that contradict each other or are out of their range.
    #[error("{0}")]
    Parameter(String),
}

impl Error {
    /// An operating system error on `path`.
    pub fn io(action: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }

    /// A file whose content is wrong.
    pub fn file(path: &Path, message: impl Into<String>) -> Self {
        Self::File { path: path.to_owned(), message: message.into(), source: None }
    }

    /// A file that a format's library could not take.
    pub fn file_cause(path: &Path, message: impl Into<String>, cause: impl Into<Cause>) -> Self {
        Self::File { path: path.to_owned(), message: message.into(), source: Some(cause.into()) }
    }
}

/// The kinds of finding, by the step that meets them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum FindingKind {
    /// A feature without a usable geometry or elevation; it was left out.
    SkippedFeature,
    /// The coordinate reference system is not known.
    UnknownCrs,
    /// A coordinate was NaN or infinite; the point was left out.
    NonFinitePoint,
    /// The same point twice or more in a row; kept once.
    RepeatedPoint,
    /// A line with fewer than two different points; left out.
    PointLine,
    /// The same line twice; kept once.
    DuplicateLine,
    /// Ends of one level were joined across a gap under the snap tolerance.
    ClosedGap,
    /// Lines of different elevation cross or touch; a piece was cut out.
    LevelsCross,
    /// A line crosses itself or another line of its elevation; a piece was cut out.
    SelfCross,
    /// A spot height lies on a contour or on another spot height of a different elevation; left out.
    SpotOnLine,
    /// A spot height lies outside the two levels around it; left out.
    SpotOutsideBand,
    /// The frame polygon reaches beyond what the contours tell of; it was cut.
    FrameBeyondMap,
    /// A lake is crossed or touched by contours of another level, or by other water; it was cut back from them.
    LakeCutBack,
    /// A lake contradicts the contours around it; it was left out.
    LakeLeftOut,
    /// Contours lie below the sea; the ground around them was left as it is.
    BelowSea,
    /// Neighbouring contours skip one or more levels: a contour is missing or mislabelled.
    SkippedLevel,
    /// The levels on the two sides of a contour contradict each other.
    BandContradiction,
    /// The input marks a contour as a depression and the ground inside is higher, or the other way round.
    DepressionMark,
    /// A raster has more than one band; the first was taken.
    OtherBands,
    /// Cells of a raster hold values that are no heights; they are taken as cells without data.
    NoHeight,
    /// Heights are in another unit than metres.
    HeightUnit,
}

impl FindingKind {
    /// What the findings of this kind are about, as a heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::SkippedFeature => "features left out",
            Self::UnknownCrs => "coordinate reference system unknown",
            Self::NonFinitePoint => "points without coordinates left out",
            Self::RepeatedPoint => "repeated points",
            Self::PointLine => "lines without length left out",
            Self::DuplicateLine => "duplicate lines",
            Self::ClosedGap => "gaps closed",
            Self::LevelsCross => "lines of different level that cross or touch",
            Self::SelfCross => "lines that cross themselves or their own level",
            Self::SpotOnLine => "spot heights on contours",
            Self::SpotOutsideBand => "spot heights outside the contours around them",
            Self::FrameBeyondMap => "frame larger than the map",
            Self::LakeCutBack => "lakes cut back from contours",
            Self::LakeLeftOut => "lakes left out",
            Self::BelowSea => "contours below the sea",
            Self::SkippedLevel => "neighbouring contours that skip a level",
            Self::BandContradiction => "contours with the same side on both sides",
            Self::DepressionMark => "depression marks that the contours contradict",
            Self::OtherBands => "raster bands left out",
            Self::NoHeight => "cells whose values are no heights",
            Self::HeightUnit => "heights in another unit than metres",
        }
    }
}

/// Something noticed about the input, with its place. The work went on.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Finding {
    /// What kind of thing it is.
    pub kind: FindingKind,
    /// Where, in the input's coordinates, if it has a place.
    pub place: Option<DVec2>,
    /// A sentence that a person understands.
    pub message: String,
}

impl Finding {
    /// A finding at a place.
    pub fn at(kind: FindingKind, place: DVec2, message: impl Into<String>) -> Self {
        Self { kind, place: Some(place), message: message.into() }
    }

    /// A finding about the whole input.
    pub fn general(kind: FindingKind, message: impl Into<String>) -> Self {
        Self { kind, place: None, message: message.into() }
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

/// A result and what was noticed while it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Report<T> {
    /// The result.
    pub value: T,
    /// What was noticed, in a fixed order.
    pub findings: Vec<Finding>,
}

impl<T> Report<T> {
    /// Takes the result and appends the findings to `all`.
    pub fn collect(self, all: &mut Vec<Finding>) -> T {
        all.extend(self.findings);
        self.value
    }
}
