//! The library's errors and findings as the user sees them: the message, with the flag that helps.

use tokosen::base::error::{CrsNeed, Error, Finding, FindingKind, ZCoordinate};

/// The message of an error with its causes and the flag that helps.
pub fn with_causes(error: &Error) -> String {
    with_flags(error, error.with_causes())
}

/// The message of an error with the flag that helps.
pub fn with_flags(error: &Error, sentence: String) -> String {
    let field = "choose one with -a/--elevation-field";
    let hint = match error.root() {
        Error::LooksLikeDegrees => {
            "; name it with --crs, for instance --crs EPSG:4326 (WGS 84) or --crs EPSG:6668 (JGD2011)".to_owned()
        }
        Error::NoPlace { .. } => " --crs names that of the input, --work-crs another one to work in".to_owned(),
        Error::NoElevationField { z: ZCoordinate::Zero, .. } => format!("; {field} (-a z takes the 0 all the same)"),
        Error::ElevationsDisagree { with_z: true, .. } => format!("; {field} (-a z takes the z coordinate)"),
        Error::NoElevationField { .. } | Error::ElevationsDisagree { .. } => format!("; {field}"),
        Error::NoElevations { layer: Some(_), .. } => {
            " (-a layer takes the names of the layers, -a z takes the 0 all the same)".to_owned()
        }
        Error::NoElevations { .. } => " (-a z takes the 0 all the same)".to_owned(),
        Error::FlatLayers { .. } => "; name the layers with contours: --layer A,B".to_owned(),
        Error::LayerAmbiguous { what: "lines", .. } => "; choose one with --layer".to_owned(),
        Error::LayerAmbiguous { .. } => "; choose one by its name, in quotes: 'FILE|layername=NAME'".to_owned(),
        Error::UnknownCrs { needed_for: CrsNeed::OtherOutput } => "; name it with --crs".to_owned(),
        Error::PlaneUnit { .. } => {
            ": --plane-unit m, --plane-unit ft or --plane-unit us-ft; or name the coordinate reference system with --crs".to_owned()
        }
        Error::StreamsElsewhere(_) => "; --stream-tolerance 0 takes them all the same".to_owned(),
        Error::PlaneUnitUnknown => ": --plane-unit m, --plane-unit ft or --plane-unit us-ft; or --crs CRS".to_owned(),
        Error::Exists { .. } => "; use --overwrite to replace it, or choose another name".to_owned(),
        Error::LayerExists { is_input: false, .. } => {
            "; use --overwrite to replace the layer, or choose another file".to_owned()
        }
        Error::AcrossCut { .. } => {
            "; name a projected CRS for it (--to-crs CRS --cell SIZE), leave --to-crs and --cell-degrees out for the \
             working CRS (--cell SIZE), or make it in parts (--extent)"
                .to_owned()
        }
        root => return in_flags(root).unwrap_or(sentence),
    };
    sentence + &hint
}

/// Whether --unit applies to a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TakesUnit {
    /// It does.
    Yes,
    /// The run reads height maps alone, and refuses it.
    No,
}

/// The flag that helps with findings of the kind of this one.
/// `takes_unit` says whether the run reads what --unit is about: contours, or points with heights.
pub fn for_kind_of(finding: &Finding, takes_unit: TakesUnit) -> Option<String> {
    match finding.kind {
        FindingKind::UnitDoubt if takes_unit == TakesUnit::No => None,
        FindingKind::UnitDoubt => Some("--unit m, --unit ft or --unit us-ft states the unit of contours".into()),
        FindingKind::PlaneUnit => Some(
            "--plane-unit m, --plane-unit ft or --plane-unit us-ft states the unit of x and y; --crs names their coordinate \
             reference system"
                .into(),
        ),
        FindingKind::Depths => Some("--depths reads depths as negative elevations; -a names the field".into()),
        FindingKind::ZeroElevation if finding.elevations == [0.0] => {
            Some("--coast 0 or --sea 0 keeps contours at 0 that are a coast".into())
        }
        FindingKind::MayBeLake => Some("--water FILE gives lakes, which are level".into()),
        FindingKind::StreamBeside | FindingKind::StreamCut => {
            Some("--stream-tolerance DISTANCE moves streams further; --diagnostics shows them".into())
        }
        FindingKind::SpotMissed => Some("--points-sigma ERROR takes spot heights as measurements".into()),
        FindingKind::BaseDiffers => {
            Some("--base-fade DISTANCE carries the difference further; 0 leaves the base as it is".into())
        }
        FindingKind::HollowDrained => Some("--sinks FILE names places where water may stay".into()),
        FindingKind::MayBeSea => {
            let level = finding.elevations.first()?;
            Some(format!("--sea {level} makes the ground beyond the coast level"))
        }
        _ => None,
    }
}

/// The message of an error about a parameter, with its flag.
fn in_flags(error: &Error) -> Option<String> {
    let needs_crs =
        |flag: &str| format!("{flag} needs contours whose coordinate reference system is known; name it with --crs");
    Some(match error {
        Error::OutOfRange { name, value, must, .. } => format!("{} is {value}, it must be {must}", flag_of(name)?),
        Error::NotProjectedInMetres { name } => format!("--work-crs {name} is not a projected system in metres"),
        Error::UnknownCrs { needed_for: CrsNeed::WorkingCrs } => needs_crs("--work-crs"),
        Error::UnknownCrs { needed_for: CrsNeed::CellsInDegrees } => needs_crs("--cell-degrees"),
        Error::TooManyCells { cell, cols, rows, in_degrees, because } => {
            let flag = if *in_degrees { "--cell-degrees" } else { "--cell" };
            format!("{flag} {cell} gives {cols:.0} x {rows:.0} cells{because}: choose a larger cell")
        }
        Error::CellTooLarge { cell, width, height, in_degrees } => {
            let flag = if *in_degrees { "--cell-degrees" } else { "--cell" };
            format!(
                "{flag} {cell} is too large: no centre of a cell lies on the map, which is {} x {}; choose a smaller cell",
                significant(*width),
                significant(*height)
            )
        }
        Error::NeedsRepair { input, places } => format!(
            "{input}: {places} places need repair before a surface can be made, and --repair none is set; --repair safe \
             repairs them, 'tokosen check' lists them"
        ),
        Error::Strict { input, findings: 1 } => format!("{input} has 1 error or warning, and --strict allows none"),
        Error::Strict { input, findings } => {
            format!("{input} has {findings} errors and warnings, and --strict allows none")
        }
        _ => return None,
    })
}

/// A length with three significant digits.
fn significant(length: f64) -> String {
    let decimals = if length > 0.0 { (2.0 - length.log10().floor()).clamp(0.0, 9.0) as usize } else { 0 };
    format!("{length:.decimals$}")
}

/// The flag of a parameter of the library.
fn flag_of(parameter: &str) -> Option<&'static str> {
    Some(match parameter {
        "snap distance" => "--snap",
        "fitting tolerance" => "--fit",
        "tolerance of streams" => "--stream-tolerance",
        "distance of the base's fade" => "--base-fade",
        "cell size" => "--cell",
        "cell size in degrees" => "--cell-degrees",
        _ => return None,
    })
}

/// What to do instead of a flag that tiles cannot take yet.
pub fn not_in_tiles(flag: &str) -> &'static str {
    match flag {
        "--strict" => "a plan does not see the findings of its tasks; 'tokosen check' examines the contours first",
        _ => "it does not apply to a plan; its manifest.json holds what is needed to repeat the tasks",
    }
}
