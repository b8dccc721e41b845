//! The table of the guide that says which verbs take which option. It is compared with what the program takes.

use clap::{Arg, Command, CommandFactory};

use super::Cli;

const PAGE: &str = include_str!("../guide/options.md");
/// What stands before and behind the table.
const FROM: &str = "<!-- options of the verbs -->\n";
const TO: &str = "<!-- end -->";

/// The options of a verb, without those that all verbs have.
fn options(verb: &Command) -> impl Iterator<Item = &Arg> {
    verb.get_arguments().filter(|arg| !arg.is_global_set() && arg.get_long().is_some_and(|long| long != "help"))
}

/// The table: a row for each option, a column for each verb.
fn table() -> String {
    let program = Cli::command();
    let verbs: Vec<&Command> = program.get_subcommands().filter(|verb| !verb.is_hide_set()).collect();
    let mut names: Vec<&str> = verbs.iter().flat_map(|verb| options(verb)).filter_map(Arg::get_long).collect();
    names.sort_unstable();
    names.dedup();
    let mut out = String::from("| option |");
    verbs.iter().for_each(|verb| out.push_str(&format!(" {} |", verb.get_name())));
    out.push_str("\n|---|");
    verbs.iter().for_each(|_| out.push_str(":-:|"));
    for name in names {
        out.push_str(&format!("\n| `--{name}` |"));
        for verb in &verbs {
            let has = options(verb).any(|arg| arg.get_long() == Some(name));
            out.push_str(if has { " x |" } else { " |" });
        }
    }
    out + "\n"
}

#[test]
fn the_guide_says_which_verbs_take_which_option() {
    let (_, rest) = PAGE.split_once(FROM).expect("the page has the table");
    let (shown, _) = rest.split_once(TO).expect("the table ends");
    let right = table();
    assert!(shown == right, "the table of src/guide/options.md is not up to date; it must be:\n{right}");
}
