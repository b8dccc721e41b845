//! Names the right flag for one that other programs have.

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, Error};

/// Flags of other programs, and the flag here.
const KNOWN: &[(&str, &[&str])] = &[
    ("--extent", &["bbox", "te", "spat", "projwin", "bounds", "box", "region", "aoi", "projwin_srs", "window"]),
    ("--clip", &["cutline", "mask", "clipsrc", "clip-to", "polygon"]),
    ("--frame", &["boundary", "border", "hull"]),
    ("--to-crs", &["t_srs", "t-srs", "dst-crs", "out-crs", "output-crs", "reproject", "target-crs"]),
    ("--crs", &["s_srs", "s-srs", "a_srs", "a-srs", "epsg", "srs", "src-crs", "input-crs"]),
    ("--cell", &["res", "tr", "cell-size", "cellsize", "pixel-size", "pixel", "spacing", "gsd"]),
    ("--elevation-field", &["field", "attribute", "attr", "zfield", "z-field", "height-field", "elev", "elev-field"]),
    ("--water", &["lakes", "lake", "waterbodies", "hydro"]),
    ("--breaklines", &["break-lines", "breakline", "break-line", "hardlines", "edges", "structure-lines"]),
    ("--cliffs", &["cliff", "faults", "fault", "barriers", "scarps"]),
    ("--streams", &["rivers", "river", "stream", "drainage", "flowlines", "burn", "burn-in"]),
    ("--base", &["background", "fallback", "fill-dem", "fill-from"]),
    ("--coast", &["coastline", "coast-line", "shoreline"]),
    ("--sinks", &["sink", "depressions", "pits"]),
    ("--drain", &["fill", "breach", "fill-depressions", "drainage-enforcement", "enforce", "hydro-enforce"]),
    ("--points", &["spots", "spot-heights", "heights", "spot-elevations"]),
    ("--save-run", &["save-config", "record", "dump-config", "save-parameters"]),
    ("--overwrite", &["force", "yes", "y"]),
    ("--interval", &["step", "contour-interval", "equidistance", "intervals"]),
    ("--hillshade", &["shade", "relief"]),
    ("--output", &["out", "outfile", "dst"]),
];

/// The error of wrong arguments, with the right flag if it is about a flag of another program.
pub fn with_right_flag(mut error: Error, mut program: Command, arguments: &[OsString]) -> Error {
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    let given = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(given)) => given.clone(),
        _ => return error,
    };
    let bare = given.split('=').next().unwrap_or_default().trim_start_matches('-').to_ascii_lowercase();
    let right = KNOWN.iter().find(|(_, others)| others.contains(&bare.as_str())).map(|(right, _)| *right);
    // Building gives each verb the flags that all have.
    program.build();
    let verb = arguments.iter().find_map(|word| program.find_subcommand(word).cloned());
    let has = |flag: &str| {
        let long = flag.trim_start_matches("--");
        verb.as_ref().is_some_and(|verb| verb.get_arguments().any(|arg| arg.get_long() == Some(long)))
    };
    if let Some(right) = right.filter(|right| has(right)) {
        error.insert(ContextKind::SuggestedArg, ContextValue::String(right.into()));
        error.remove(ContextKind::Suggested);
    }
    error
}
