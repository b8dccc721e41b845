//! What can go wrong ([`Error`]) and what was noticed on the way ([`Finding`]).
//!
//! An error stops the work. A finding does not: the step continues, and returns the finding beside its result in a
//! [`Report`]. So nothing is left out silently.

mod arrays;
mod finding;

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use glam::DVec2;

pub use arrays::ArrayFault;
pub use finding::{Finding, FindingKind, Proposal, Severity};

/// The library's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The cause below an error, as other crates report it.
pub type Cause = Box<dyn std::error::Error + Send + Sync + 'static>;

/// Why the work could not be done. The text says what is wrong, where, and what to do.
///
/// Callers match the variants. Variants that hold only a text are meant for people.
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
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A file has the wrong content. The message names the feature and the position where it can.
    #[error("{}: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        message: String,
        /// The error of the format's library, if it came from there.
        source: Option<Cause>,
    },
    /// An error of another variant, about the data of one file. [`Error::root`] returns that error.
    #[error("{}: {error}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with its data.
        #[source]
        error: Box<Error>,
    },
    /// There are no contours.
    #[error("there is no contour line{}", inside(*in_polygon))]
    NoContours {
        /// Whether the frame is a polygon. Then no contour lies inside it.
        in_polygon: bool,
    },
    /// All contours have one elevation; a surface needs two levels.
    #[error("{}", one_level(*lines, *elevation, *in_polygon))]
    TooFewLevels {
        /// Number of contours.
        lines: usize,
        /// The elevation of all of them, metres.
        elevation: f64,
        /// Whether the frame is a polygon. Then only the lines inside it count.
        in_polygon: bool,
    },
    /// All points lie on one line.
    #[error("all points lie on one line: there is no area between the contours")]
    NoArea,
    /// Sampling the contours would add too many points.
    #[error("sampling at {ratio} would add more than {most} points; take a larger ratio or a smaller part of the map")]
    TooManyPoints {
        /// The ratio that was asked for.
        ratio: f64,
        /// Most points that may be added.
        most: usize,
    },
    /// Two lines cross that must not: contours that were not cleaned, or a contour and the frame.
    #[error(
        "lines cross near {:.3} {:.3}, which is not allowed: if both are contours, clean them first; if one is the frame, \
         move the frame's border a little",
        place.x,
        place.y
    )]
    LinesCross {
        /// A position near the crossing, map units.
        place: DVec2,
    },
    /// The coordinate reference system of the contours is not known, and something needs it.
    #[error("{}", needs_crs(*needed_for))]
    UnknownCrs {
        /// What needs it.
        needed_for: CrsNeed,
    },
    /// The coordinates look like degrees, and no coordinate reference system is named.
    #[error("the coordinates look like degrees, and the file does not say in which coordinate reference system")]
    LooksLikeDegrees,
    /// A drawing says that it is in a unit in which no map is drawn, and nothing else states the unit of its coordinates.
    #[error(
        "the drawing says that its unit is the {unit} ($INSUNITS), in which maps are not drawn; many programs write that \
         whatever the unit is. State the unit of x and y; scale a drawing that is really in this unit to metres first"
    )]
    PlaneUnit {
        /// Name of the unit, singular.
        unit: String,
    },
    /// Heights are in feet, and nothing states the unit of x and y. A slope or a model would be a guess.
    #[error(
        "the elevations are in feet, and nothing states the unit of x and y: slopes and models would be 3.28 times too flat if \
         these are feet too. State the unit of x and y, or the coordinate reference system"
    )]
    PlaneUnitUnknown,
    /// Most streams contradict the contours. The message says how many.
    #[error("{0}")]
    StreamsElsewhere(String),
    /// The working system is not a projected system in metres.
    #[error("{name} is no projected system in metres")]
    NotProjectedInMetres {
        /// Name of the system.
        name: String,
    },
    /// A coordinate of one system cannot be expressed in another.
    #[error(
        "{:?} {:?} in {from} cannot be transformed to {to}; is that the right coordinate reference system?",
        place.x,
        place.y
    )]
    NoPlace {
        /// The coordinate, in `from`.
        place: DVec2,
        /// Name of the system that it is in.
        from: String,
        /// Name of the system in which it cannot be expressed.
        to: String,
    },
    /// Degrees whose latitudes lie beyond the pole, and would not if the two coordinates changed places.
    #[error(
        "the coordinates are not longitude and latitude of {crs}, but look like latitude and longitude: swap x and y"
    )]
    AxesSwapped {
        /// Name of the system that they are in.
        crs: String,
    },
    /// A parameter is out of its range.
    #[error("the {name} is {value}{unit}, it must be {must}")]
    OutOfRange {
        /// What the parameter is.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// A space and the unit of the value, or nothing.
        unit: &'static str,
        /// The range, in words.
        must: &'static str,
    },
    /// A height map would have too many cells.
    #[error("cells of {cell} make {cols:.0} x {rows:.0} cells{because}: choose a larger cell")]
    TooManyCells {
        /// Size of a cell, in the units of the grid's coordinate reference system.
        cell: f64,
        /// Columns.
        cols: f64,
        /// Rows.
        rows: f64,
        /// Whether the size is in degrees.
        in_degrees: bool,
        /// Why the map is so large, if that is known: the end of a sentence, or nothing.
        because: String,
    },
    /// Cells are so large that none of their centres lies on the map.
    #[error("cells of {cell} are too large: none of their centres lies on the map, which is {width} x {height}")]
    CellTooLarge {
        /// Size of a cell, in the units of the grid's coordinate reference system.
        cell: f64,
        /// Extent of the map in x, in the same units.
        width: f64,
        /// Extent of the map in y.
        height: f64,
        /// Whether the size is in degrees.
        in_degrees: bool,
    },
    /// A height map in this system would lie on both sides of a cut of its coordinates.
    #[error("{}", across(*cut, crs))]
    AcrossCut {
        /// Name of the coordinate reference system.
        crs: String,
        /// What is cut.
        cut: Cut,
    },
    /// No cell of the grid lies in the area of the contours.
    #[error(
        "none of its cells lies in the area of the contours: do they overlap, and do the files name the right coordinate \
         reference systems?"
    )]
    NoOverlap,
    /// The part of the map that is asked for lies outside of it.
    #[error("the part that is asked for ({}) lies outside of {of} ({})", span(part), span(map))]
    PartOutside {
        /// Corners of the box around the part, in the coordinates of the map.
        part: [DVec2; 2],
        /// Corners of the box around the map.
        map: [DVec2; 2],
        /// What the map is: the contours, or the height map.
        of: &'static str,
    },
    /// No field and no coordinate is known to hold the elevations.
    #[error("no field is known to hold elevations, and {z}; {fields}")]
    NoElevationField {
        /// Why the z coordinate is not the elevation.
        z: ZCoordinate,
        /// The fields that there are, with an example of each, as a sentence.
        fields: String,
    },
    /// Two fields, or a field and the z coordinate, could hold the elevation. Their values differ.
    #[error("{what} disagree in feature {feature}; {fields}")]
    ElevationsDisagree {
        /// The two, with their values.
        what: String,
        /// Number of the feature where they differ.
        feature: u64,
        /// Whether one of them is the z coordinate.
        with_z: bool,
        /// The fields that there are, with an example of each, as a sentence.
        fields: String,
    },
    /// All lines of a drawing have the elevation 0.
    #[error(
        "there are no elevations {place}: all lines lie at 0{texts}{}; give the lines their elevations in the program that \
         drew them",
        layers_with_numbers(layer.as_deref())
    )]
    NoElevations {
        /// Where: in the drawing or on the layers that were named.
        place: &'static str,
        /// A remark on texts in the drawing, or nothing.
        texts: String,
        /// The name of a layer that is a number and so may be the elevation of its lines, if there is one.
        layer: Option<String>,
    },
    /// All lines of some layers of a drawing have the elevation 0, and no layer was chosen.
    #[error(
        "the lines of some layers all lie at 0, which may not be their elevation: {flat}; the layers of the drawing are {layers}"
    )]
    FlatLayers {
        /// Those layers.
        flat: String,
        /// All layers.
        layers: String,
    },
    /// A file has several layers to choose from.
    #[error("there are several layers of {what}: {}", quoted(layers))]
    LayerAmbiguous {
        /// What the layers hold: lines, points or polygons.
        what: &'static str,
        /// Their names.
        layers: Vec<String>,
    },
    /// Something needs more memory than the caller allows.
    #[error(
        "{what} would need about {:.1} GB of memory, {:.1} GB are available: {remedy}",
        needed / 1e9,
        *available as f64 / 1e9
    )]
    OutOfMemory {
        /// What needs it.
        what: String,
        /// Estimated peak memory, bytes.
        needed: f64,
        /// The caller's budget, bytes.
        available: u64,
        /// What to do.
        remedy: &'static str,
    },
    /// A file is there that another program made, and may not be replaced.
    #[error("{} exists, and nothing in it shows that tokosen made it", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A GeoPackage has a layer of this name that may not be replaced.
    #[error("{}: the layer {layer:?} exists, and {}", path.display(), why_kept(*is_input))]
    LayerExists {
        /// The GeoPackage.
        path: PathBuf,
        /// The layer.
        layer: String,
        /// Whether the GeoPackage is an input. Otherwise another program made the layer.
        is_input: bool,
    },
    /// The contours need repair, but repair is not allowed.
    #[error("{input}: {places} places need repair before a surface can be made, and no repair is allowed")]
    NeedsRepair {
        /// Name of the input.
        input: String,
        /// Number of places.
        places: usize,
    },
    /// The input has errors or warnings, and none is allowed.
    #[error("{input} has {}, and strict preparation allows none", count_of(*findings))]
    Strict {
        /// Name of the input.
        input: String,
        /// Number of findings that are errors or warnings.
        findings: usize,
    },
    /// Arrays that do not describe lines.
    #[error(transparent)]
    Arrays(#[from] ArrayFault),
    /// The data were read, but no surface can be made of them.
    #[error("{0}")]
    Data(String),
    /// Parameters that contradict each other or are out of their range.
    #[error("{0}")]
    Parameter(String),
}

/// What needs the coordinate reference system of the contours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrsNeed {
    /// Projecting them to a plane.
    Projecting,
    /// Writing lines in another system.
    OtherOutput,
    /// A working system that the caller names.
    WorkingCrs,
    /// A height map whose cells are in degrees.
    CellsInDegrees,
}

/// Where coordinates jump although the ground goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cut {
    /// Along a line, such as the 180th meridian.
    Line,
    /// Around a pole, at which every longitude ends.
    Pole,
}

/// Why the z coordinate is not the elevation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZCoordinate {
    /// There is none.
    Missing,
    /// It is 0 everywhere.
    Zero,
    /// It changes along every line.
    Varies,
}

fn layers_with_numbers(layer: Option<&str>) -> String {
    layer.map_or_else(String::new, |name| format!(", but the names of layers are numbers, such as {name:?}"))
}

impl fmt::Display for ZCoordinate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Missing => "the geometry has no z",
            Self::Zero => "every z is 0",
            Self::Varies => "z varies along every line",
        })
    }
}

/// A box in words.
fn span([lo, hi]: &[DVec2; 2]) -> String {
    // A map of a few units is one in degrees.
    let decimals = if (*hi - *lo).max_element() < 10.0 { 5 } else { 1 };
    format!("x {:.decimals$} to {:.decimals$}, y {:.decimals$} to {:.decimals$}", lo.x, hi.x, lo.y, hi.y)
}

fn inside(in_polygon: bool) -> &'static str {
    if in_polygon { " inside the frame polygon" } else { "" }
}

fn one_level(lines: usize, elevation: f64, in_polygon: bool) -> String {
    let inside = inside(in_polygon);
    if lines == 1 {
        return format!(
            "there is one contour line only{inside} (elevation {elevation} m): a surface needs contours of two levels"
        );
    }
    let remedy = if in_polygon { "choose a larger polygon" } else { "is it the right elevation field?" };
    format!(
        "all {lines} contour lines{inside} have the elevation {elevation} m: a surface needs contours of two levels ({remedy})"
    )
}

fn needs_crs(need: CrsNeed) -> String {
    let known = "contours whose coordinate reference system is known";
    match need {
        CrsNeed::Projecting => "the coordinate reference system of the contours is not known".to_owned(),
        CrsNeed::OtherOutput => {
            "the coordinate reference system of the contours is not known, so they cannot be transformed to another one; \
             KML and map tiles are always in longitudes and latitudes"
                .to_owned()
        }
        CrsNeed::WorkingCrs => format!("a system to work in needs {known}"),
        CrsNeed::CellsInDegrees => format!("cells in degrees need {known}"),
    }
}

fn across(cut: Cut, crs: &str) -> String {
    match cut {
        Cut::Line => format!(
            "the map lies on both sides of the line where coordinates of {crs} jump (the 180th meridian, for most \
             systems), so a height map in it would go around the Earth"
        ),
        Cut::Pole => {
            format!("the map contains a pole, so a height map in {crs} would hold all longitudes")
        }
    }
}

fn why_kept(is_input: bool) -> &'static str {
    if is_input { "the file is an input: choose another file for the output" } else { "another program made it" }
}

fn count_of(findings: usize) -> String {
    if findings == 1 { "1 error or warning".to_owned() } else { format!("{findings} errors and warnings") }
}

fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
}

impl Error {
    /// The message with those of its causes, and what to do where the operating system gives only the cause. Some errors
    /// contain the text of their cause, some causes end with the text of the error above; these are not repeated.
    pub fn with_causes(&self) -> String {
        let mut text = self.to_string();
        let mut last = text.clone();
        let mut cause = std::error::Error::source(self);
        while let Some(inner) = cause {
            let message = inner.to_string();
            if !text.ends_with(&message) && !message.ends_with(&last) {
                text.push_str(&format!(": {message}"));
            }
            last = message;
            cause = inner.source();
        }
        match self.remedy() {
            Some(remedy) => text + "; " + remedy,
            None => text,
        }
    }

    /// What to do about a refusal of the operating system.
    fn remedy(&self) -> Option<&'static str> {
        let Self::Io { action, source, .. } = self.root() else { return None };
        match (source.kind(), *action) {
            (ErrorKind::NotFound, "read" | "find") => Some("check the name and the folder"),
            (ErrorKind::NotFound, "create" | "create a file in" | "write") => {
                Some("make its folder first, or choose another one")
            }
            (ErrorKind::StorageFull, _) => Some("make room, or choose another disk"),
            (ErrorKind::PermissionDenied, _) => Some("change its permissions, or choose another file"),
            _ => None,
        }
    }

    /// An operating system error on `path`.
    pub fn io(action: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }

    /// A file without content.
    pub fn empty(path: &Path) -> Self {
        Self::file(path, "the file is empty; copy or download it again, or name another one")
    }

    /// A file whose content is wrong.
    pub fn file(path: &Path, message: impl Into<String>) -> Self {
        Self::File { path: path.to_owned(), message: message.into(), source: None }
    }

    /// A parameter without a unit that is out of its range.
    pub fn out_of_range(name: &'static str, value: f64, must: &'static str) -> Self {
        Self::OutOfRange { name, value, unit: "", must }
    }

    /// The same error, with the file from which the data came. Errors that already name a file, or that are about
    /// parameters, stay as they are.
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Data(message) => Self::file(path, message),
            Self::Io { .. }
            | Self::File { .. }
            | Self::InFile { .. }
            | Self::Parameter(_)
            | Self::OutOfRange { .. }
            | Self::NotProjectedInMetres { .. }
            | Self::TooManyCells { .. }
            | Self::CellTooLarge { .. }
            | Self::AcrossCut { .. }
            | Self::TooManyPoints { .. }
            | Self::NeedsRepair { .. }
            | Self::Strict { .. }
            | Self::Exists { .. }
            | Self::LayerExists { .. }
            | Self::Arrays(_)
            | Self::UnknownCrs { needed_for: CrsNeed::WorkingCrs | CrsNeed::CellsInDegrees } => self,
            error => Self::InFile { path: path.to_owned(), error: Box::new(error) },
        }
    }

    /// The error without the file from which the data came. Callers match this one.
    pub fn root(&self) -> &Self {
        match self {
            Self::InFile { error, .. } => error.root(),
            error => error,
        }
    }

    /// An error about a map that is too large, with the lines that make it so, if findings name them.
    pub fn because_of_far_lines(self, findings: &[Finding]) -> Self {
        let moved = |finding: &&Finding| matches!(finding.kind, FindingKind::FarAway | FindingKind::LooksLikeDegrees);
        let far = findings.iter().filter(moved).find(|finding| !finding.features.is_empty());
        let Some(far) = far else { return self };
        let because =
            format!(" because {} (leave them out, or write a part with --extent)", far.with_place_in_words().message);
        match self {
            Self::TooManyCells { cell, cols, rows, in_degrees, .. } => {
                Self::TooManyCells { cell, cols, rows, in_degrees, because }
            }
            Self::OutOfMemory { what, needed, available, remedy } => {
                Self::OutOfMemory { what: what + &because, needed, available, remedy }
            }
            error => error,
        }
    }

    /// Whether the parameters are wrong, not the data. Then other parameters help.
    pub fn is_about_parameters(&self) -> bool {
        matches!(
            self.root(),
            Self::Parameter(_)
                | Self::OutOfRange { .. }
                | Self::NotProjectedInMetres { .. }
                | Self::TooManyCells { .. }
                | Self::CellTooLarge { .. }
                | Self::AcrossCut { .. }
                | Self::TooManyPoints { .. }
                | Self::UnknownCrs { needed_for: CrsNeed::WorkingCrs | CrsNeed::CellsInDegrees }
        )
    }

    /// A file that the format's library refused.
    pub fn file_cause(path: &Path, message: impl Into<String>, cause: impl Into<Cause>) -> Self {
        Self::File { path: path.to_owned(), message: message.into(), source: Some(cause.into()) }
    }
}

/// A result, and what was noticed while it was made.
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
