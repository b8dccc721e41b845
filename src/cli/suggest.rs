//! Errors of arguments in words that help: the right flag for one that other programs have, the right verb, numbers with units.

use std::ffi::OsString;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, Error};
use tokosen::features::Role;

/// Flags of other programs, and the flag here. Those of lines, polygons and points beside the contours are in [`Role`].
const KNOWN: &[(&str, &[&str])] = &[
    ("--extent", &["bbox", "te", "spat", "projwin", "bounds", "box", "region", "aoi", "projwin_srs", "window"]),
    ("--clip", &["cutline", "mask", "clipsrc", "clip-to", "polygon"]),
    ("--frame", &["boundary", "border", "hull"]),
    ("--to-crs", &["t_srs", "t-srs", "dst-crs", "out-crs", "output-crs", "reproject", "target-crs"]),
    ("--crs", &["s_srs", "s-srs", "a_srs", "a-srs", "epsg", "srs", "src-crs", "input-crs"]),
    ("--cell", &["size", "res", "tr", "cell-size", "cellsize", "pixel-size", "pixel", "spacing", "gsd"]),
    ("--elevation-field", &["field", "attribute", "attr", "zfield", "z-field", "height-field", "elev", "elev-field"]),
    ("--base", &["background", "fallback", "fill-dem", "fill-from"]),
    ("--drain", &["fill", "breach", "fill-depressions", "drainage-enforcement", "enforce", "hydro-enforce"]),
    ("--points", &["spots", "spot-heights", "heights", "spot-elevations"]),
    ("--save-run", &["save-config", "record", "dump-config", "save-parameters"]),
    ("--overwrite", &["force", "yes", "y"]),
    ("--interval", &["step", "contour-interval", "equidistance", "intervals"]),
    ("--hillshade", &["shade", "relief"]),
    ("--output", &["out", "outfile", "dst"]),
];

/// Verbs of other programs, or what people expect, and the verb here.
const KNOWN_VERBS: &[(&str, &[&str])] = &[
    ("check", &["info", "validate", "lint", "inspect", "repair", "fix"]),
    ("compare", &["diff", "difference", "assess"]),
    ("contour", &["contours", "isolines", "trace"]),
    ("dem", &["grid", "interpolate", "raster", "rasterize", "dtm", "height-map", "heightmap", "topo-to-raster"]),
    ("densify", &["interval", "export", "convert", "supplement"]),
    ("derive", &["hillshade", "slope", "aspect", "flow", "catchment", "watershed", "flood"]),
    ("mesh", &["tin", "model", "3d", "stl", "obj"]),
    ("profile", &["section", "sections", "cross-section", "profiles", "transect"]),
    ("regions", &["landforms", "areas"]),
    ("skeleton", &["ridges", "valleys", "breaklines"]),
    ("volume", &["cutfill", "cut-fill", "storage", "earthwork", "earthworks"]),
];

/// The error of wrong arguments, in words that help where clap has none.
pub fn with_right_flag(error: Error, program: Command, arguments: &[OsString]) -> Error {
    match error.kind() {
        ErrorKind::UnknownArgument => with_known_flag(error, program, arguments),
        ErrorKind::InvalidSubcommand => with_verb(error, program),
        ErrorKind::ValueValidation => with_number(error, program),
        _ => error,
    }
}

/// A text of the context of an error.
fn text(error: &Error, kind: ContextKind) -> Option<String> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    }
}

/// The error about a word that is no verb: a file, or a verb of another program.
fn with_verb(error: Error, program: Command) -> Error {
    let Some(word) = text(&error, ContextKind::InvalidSubcommand) else { return error };
    let is_file = Path::new(&word).exists() || Path::new(&word).extension().is_some();
    let lower = word.to_lowercase();
    let known = KNOWN_VERBS.iter().find(|(_, others)| others.contains(&lower.as_str())).map(|(verb, _)| *verb);
    let message = match known {
        _ if is_file => format!(
            "the verb is missing before {word}. 'tokosen check {word}' says what is in it; 'tokosen densify' makes contours of \
             contours, 'tokosen dem' a height map of contours, 'tokosen contour' contours of a height map\n"
        ),
        Some(verb) => format!("there is no verb '{word}'; 'tokosen {verb} --help' may be what you look for\n"),
        None => return error,
    };
    Error::raw(ErrorKind::InvalidSubcommand, message).with_cmd(&program)
}

/// The error about a number with its unit behind it.
fn with_number(error: Error, program: Command) -> Error {
    let (Some(value), Some(option)) = (text(&error, ContextKind::InvalidValue), text(&error, ContextKind::InvalidArg))
    else {
        return error;
    };
    let number = value.trim_end_matches(|c: char| c.is_alphabetic() || matches!(c, ' ' | '°' | '%' | '′' | '²'));
    if number.len() == value.len()
        || number.parse::<f64>().is_err()
        || !error.to_string().contains("invalid float literal")
    {
        return error;
    }
    let message = format!(
        "invalid value '{value}' for '{option}': give the number alone, {number}; the help of the option names its unit, metres \
         for most\n"
    );
    Error::raw(ErrorKind::ValueValidation, message).with_cmd(&program)
}

/// The error about an unknown flag, with the right one if it is a flag of another program.
fn with_known_flag(mut error: Error, mut program: Command, arguments: &[OsString]) -> Error {
    // No value of this program starts with hyphens, so the tip to write '-- --flag' misleads.
    error.remove(ContextKind::Suggested);
    let given = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(given)) => given.clone(),
        _ => return error,
    };
    let bare = given.split('=').next().unwrap_or_default().trim_start_matches('-').to_ascii_lowercase();
    let of_roles = Role::all().map(|role| (role.flag(), role.also()));
    let mut known = KNOWN.iter().copied().chain(of_roles);
    let right = known.find(|(_, others)| others.contains(&bare.as_str())).map(|(right, _)| right);
    // Building gives each verb the flags that all have.
    program.build();
    let verb = arguments.iter().find_map(|word| program.find_subcommand(word).cloned());
    let has = |flag: &str| {
        let long = flag.trim_start_matches("--");
        verb.as_ref().is_some_and(|verb| verb.get_arguments().any(|arg| arg.get_long() == Some(long)))
    };
    if let Some(right) = right.filter(|right| has(right)) {
        error.insert(ContextKind::SuggestedArg, ContextValue::String(right.into()));
    }
    error
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::cli::Cli;

    /// What is said about arguments that are wrong.
    fn said(line: &str) -> String {
        let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
        let error = Cli::command().try_get_matches_from(&words).unwrap_err();
        with_right_flag(error, Cli::command(), &words).to_string()
    }

    #[test]
    fn wrong_words_get_the_right_ones() {
        for (line, words) in [
            ("tokosen dem a.gpkg --cell 10m -o b.tif", "give the number alone, 10;"),
            ("tokosen dem a.gpkg --cell ten -o b.tif", "invalid float literal"),
            ("tokosen dem a.gpkg --bbox 1,2,3,4 -o a.tif", "--extent"),
            ("tokosen dem a.gpkg --rivers b.gpkg --cell 5 -o a.tif", "--streams"),
            ("tokosen densify a.gpkg -i 5 --size 5 -o b.gpkg", "--cell"),
            ("tokosen FG-GML-5437.zip", "'tokosen check FG-GML-5437.zip' says what is in it"),
            ("tokosen cut-fill a.tif", "tokosen volume --help"),
            ("tokosen densfy a.gpkg", "densify"),
        ] {
            let said = said(line);
            assert!(said.contains(words), "{line}: {said}");
        }
        let said = said("tokosen densify a.gpkg --what 3 -i 5 -o b.gpkg");
        assert!(said.contains("--what") && !said.contains("-- --what"), "{said}");
    }

    #[test]
    fn verbs_are_those_of_the_program() {
        let mut program = Cli::command();
        program.build();
        for (verb, others) in KNOWN_VERBS {
            assert!(program.find_subcommand(verb).is_some(), "{verb}");
            assert!(others.iter().all(|other| program.find_subcommand(other).is_none()), "{others:?}");
        }
    }
}
