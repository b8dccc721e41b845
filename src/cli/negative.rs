//! Negative numbers as values of options: `--levels -12.5,-7`.
//!
//! clap takes a word with a leading hyphen for a flag, and makes an exception for single numbers only: not for a list of
//! levels, an extent or an angle in seconds. No flag of this program starts with a digit, so a word of a hyphen and a digit
//! is a value. It is joined to the option before it by an equals sign, behind which clap takes every value. A word of a
//! hyphen and a letter stays a flag: `--levels --dem x` is an error.

use std::ffi::OsString;

use clap::{Arg, Command};

/// The arguments of the program, with each negative value joined to its option.
pub fn joined(mut program: Command, arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    // Building gives each verb the options that all have.
    program.build();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let verb = arguments.iter().skip(1).find_map(|word| program.find_subcommand(word)).unwrap_or(&program);
    let mut joined: Vec<OsString> = Vec::with_capacity(arguments.len());
    let mut is_open = true;
    for word in arguments {
        // Behind it, everything is a file.
        is_open &= word != "--";
        match joined.last_mut() {
            Some(option) if is_open && is_negative(&word) && wants_value(verb, option) => {
                option.push("=");
                option.push(word);
            }
            _ => joined.push(word),
        }
    }
    joined
}

/// Whether a word is a hyphen with a number or a list of numbers behind it.
fn is_negative(word: &OsString) -> bool {
    let rest = word.to_str().and_then(|word| word.strip_prefix('-'));
    rest.is_some_and(|rest| rest.trim_start_matches('.').starts_with(|c: char| c.is_ascii_digit()))
}

/// Whether a word is an option of this verb that takes the next word as its value: `--levels`, `-i`, or `-vi`.
fn wants_value(verb: &Command, word: &OsString) -> bool {
    let Some(word) = word.to_str() else { return false };
    if let Some(name) = word.strip_prefix("--") {
        return verb.get_arguments().filter(|option| has_long(option, name)).any(takes_next);
    }
    let Some(letters) = word.strip_prefix('-') else { return false };
    let named = |letter: char| verb.get_arguments().find(|option| option.get_short() == Some(letter));
    let mut letters = letters.chars();
    let last = letters.next_back().and_then(named);
    last.is_some_and(takes_next)
        && letters.all(|flag| named(flag).is_some_and(|flag| !flag.get_action().takes_values()))
}

fn has_long(option: &Arg, name: &str) -> bool {
    option.get_long() == Some(name) || option.get_all_aliases().unwrap_or_default().contains(&name)
}

fn takes_next(option: &Arg) -> bool {
    option.get_action().takes_values() && !option.is_require_equals_set()
}

#[cfg(test)]
mod tests {
    use std::any::TypeId;
    use std::collections::BTreeSet;

    use clap::CommandFactory;
    use clap::error::ErrorKind;

    use super::*;
    use crate::cli::Cli;

    /// What becomes of a value that is below 0.
    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Outcome {
        /// It reaches the verb, which says whether it makes sense.
        Taken,
        /// The parser of the option says that it is out of range.
        Refused,
    }
    use Outcome::{Refused, Taken};

    /// Every option that takes numbers, a negative value of it, and what becomes of that.
    const OPTIONS: &[(&str, &str, Outcome)] = &[
        ("--levels", "-12.5,-7", Taken),
        ("--levels", "-12.5", Taken),
        ("--levels", "-.5,3", Taken),
        ("--interval", "-5", Taken),
        ("-i", "-5", Taken),
        ("--base-level", "-12.5", Taken),
        ("--base-height", "-12.5", Taken),
        ("--base", "-12.5", Taken),
        ("--index", "-5", Refused),
        ("--extent", "-10,-20,30,40.5", Taken),
        ("--extent", "-10.5 -20 30 40", Taken),
        ("--coast", "-1.5", Taken),
        ("--sea", "-1.5", Taken),
        ("--snap", "-1", Taken),
        ("--points-sigma", "-1", Taken),
        ("--fit", "-1e-3", Taken),
        ("--sample", "-0.5", Refused),
        ("--cell", "-10", Taken),
        ("--cell-degrees", "-0.4s", Taken),
        ("--base-fade", "-100", Taken),
        ("--resolution", "-1", Taken),
        ("--tension", "-1", Taken),
        ("--noise", "-1", Taken),
        ("--stream-tolerance", "-1", Taken),
        ("--outlet", "-83.5,-36", Taken),
        ("--outlet-snap", "-1", Taken),
        ("--threshold", "-100", Taken),
        ("--flood-level", "-1.5", Taken),
        ("--flood-from", "-83.5,-36", Taken),
        ("--flood-bands", "-0.5,1", Taken),
        ("--steep-angle", "-30", Taken),
        ("--steep-height", "-5", Taken),
        ("--azimuth", "-45", Taken),
        ("--altitude", "-45", Taken),
        ("--z-factor", "-2", Taken),
        ("--simplify", "-1", Taken),
        ("--tolerance", "-1", Taken),
        ("--smooth", "-1", Taken),
        ("--sigma", "-1", Taken),
        ("--level", "-1.5", Taken),
        ("--step", "-1", Taken),
        ("--sections", "-1", Taken),
        ("--width", "-1", Taken),
        ("--exaggeration", "-1", Taken),
        ("--threads", "-1", Refused),
        ("--zooms", "-1:5", Refused),
        ("--max-zoom", "-1", Refused),
        ("--scale", "-5000", Refused),
        ("--supplementary", "-5,-2.5", Taken),
        ("--supplementary-spacing", "-100", Taken),
        ("--size", "-180", Refused),
        ("--thickness", "-3", Refused),
        ("--sheet", "-600x400", Refused),
        ("--tile-side", "-1", Refused),
        ("--jobs", "-1", Refused),
    ];

    fn words(verb: &str, given: &[&str]) -> Vec<OsString> {
        ["tokosen", verb, "a.gpkg"].iter().chain(given).map(OsString::from).collect()
    }

    /// The options of a verb that take numbers, by their long names. An option of a type of its own is known by the table.
    fn numeric(verb: &Command) -> BTreeSet<String> {
        let numbers = [TypeId::of::<f64>(), TypeId::of::<u16>(), TypeId::of::<u32>()];
        let is_number = |option: &&Arg| {
            let kind = option.get_value_parser().type_id();
            takes_next(option) && numbers.iter().any(|number| kind == *number)
        };
        verb.get_arguments().filter(is_number).filter_map(|option| Some(format!("--{}", option.get_long()?))).collect()
    }

    #[test]
    fn every_option_with_numbers_takes_negative_ones() {
        let mut program = Cli::command();
        program.build();
        let (mut cases, mut tested) = (0, BTreeSet::new());
        // Hidden verbs print texts for shells.
        for verb in program.get_subcommands().filter(|verb| verb.get_name() != "help" && !verb.is_hide_set()) {
            for &(option, value, outcome) in OPTIONS {
                let bare = option.trim_start_matches('-');
                let is_it = |arg: &&Arg| match option.starts_with("--") {
                    true => arg.get_long() == Some(bare),
                    false => arg.get_short() == bare.chars().next(),
                };
                let Some(arg) = verb.get_arguments().find(is_it) else { continue };
                let what = format!("{} {option} {value}", verb.get_name());
                let all = joined(program.clone(), words(verb.get_name(), &[option, value]));
                // Other options that are missing are no matter here.
                let matches = program.clone().ignore_errors(true).try_get_matches_from(&all).unwrap();
                let error = program.clone().try_get_matches_from(&all).err().map(|error| error.kind());
                assert_ne!(error, Some(ErrorKind::UnknownArgument), "{what}");
                assert_eq!(error == Some(ErrorKind::ValueValidation), outcome == Refused, "{what}: {error:?}");
                if outcome == Taken {
                    let found = matches.subcommand().unwrap().1.get_raw(arg.get_id().as_str()).unwrap();
                    let found: Vec<&str> = found.map(|value| value.to_str().unwrap()).collect();
                    assert_eq!(found.join(","), value, "{what}");
                }
                // A flag is no value.
                let error = Cli::command()
                    .try_get_matches_from(joined(program.clone(), words(verb.get_name(), &[option, "--verbose"])));
                assert_eq!(error.unwrap_err().kind(), ErrorKind::InvalidValue, "{what}");
                tested.insert((verb.get_name().to_owned(), format!("--{}", arg.get_long().unwrap())));
                cases += 1;
            }
            for option in numeric(verb) {
                assert!(tested.contains(&(verb.get_name().to_owned(), option.clone())), "{} {option}", verb.get_name());
            }
        }
        assert_eq!(cases, CASES, "cases of {} options", tested.len());
    }

    /// Rows of the table that apply, over all verbs.
    const CASES: usize = 217;

    #[test]
    fn flags_and_files_stay_what_they_are() {
        let line = |given: &str| {
            let words = given.split(' ').map(OsString::from);
            joined(Cli::command(), words).join(&OsString::from(" ")).into_string().unwrap()
        };
        for (given, expected) in [
            (
                "tokosen densify a.gpkg --levels -12.5,-7 -o b.gpkg",
                "tokosen densify a.gpkg --levels=-12.5,-7 -o b.gpkg",
            ),
            ("tokosen -q densify a.gpkg -vi -5 -o b.gpkg", "tokosen -q densify a.gpkg -vi=-5 -o b.gpkg"),
            ("tokosen densify a.gpkg --levels --dem x.tif", "tokosen densify a.gpkg --levels --dem x.tif"),
            ("tokosen densify a.gpkg --levels -i 5", "tokosen densify a.gpkg --levels -i 5"),
            // Not the value of an option: clap says that it does not know it.
            ("tokosen densify a.gpkg --levels=3 -7", "tokosen densify a.gpkg --levels=3 -7"),
            ("tokosen densify --quiet -7", "tokosen densify --quiet -7"),
            ("tokosen densify a.gpkg -- --levels -7", "tokosen densify a.gpkg -- --levels -7"),
            // A value without an equals sign is not taken, so that a file may follow.
            ("tokosen densify --labels -7", "tokosen densify --labels -7"),
        ] {
            assert_eq!(line(given), expected);
        }
    }
}
