//! Which flags are given.

use std::collections::BTreeSet;

use clap::ArgMatches;
use clap::parser::ValueSource;

/// The flags that the user gave, also those with the value that they have without.
#[derive(Debug, Clone, Default)]
pub struct Flags {
    given: BTreeSet<String>,
    left: BTreeSet<String>,
}

impl Flags {
    /// The flags in the matches of a command and of its verb.
    pub fn of(matches: &ArgMatches) -> Self {
        let verb = matches.subcommand().map(|(_, matches)| matches);
        let ids =
            verb.into_iter().chain([matches]).flat_map(|matches| matches.ids().map(move |id| (matches, id.as_str())));
        let mut flags = Self::default();
        for (matches, id) in ids {
            let flag = format!("--{}", id.replace('_', "-"));
            // A group of arguments has an id too, and no value of its own.
            match matches.try_contains_id(id).ok().and_then(|_| matches.value_source(id)) {
                Some(ValueSource::CommandLine) => flags.given.insert(flag),
                Some(ValueSource::DefaultValue) => flags.left.insert(flag),
                _ => false,
            };
        }
        flags
    }

    /// Whether a flag is given; it is named with its hyphens.
    pub fn has(&self, flag: &str) -> bool {
        self.given.contains(flag)
    }

    /// Whether the verb has a flag with a default, and it is not given.
    pub fn leaves(&self, flag: &str) -> bool {
        self.left.contains(flag)
    }

    /// The first of some flags that is given.
    pub fn first<'a>(&self, flags: impl IntoIterator<Item = &'a &'a str>) -> Option<&'a str> {
        flags.into_iter().copied().find(|flag| self.has(flag))
    }
}
