//! Which flags are given.

/// The name of the first flag that is given.
pub fn first_given(flags: impl IntoIterator<Item = (bool, &'static str)>) -> Option<&'static str> {
    flags.into_iter().find(|(is_given, _)| *is_given).map(|(_, flag)| flag)
}
