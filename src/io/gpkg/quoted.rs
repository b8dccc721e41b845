//! Quotes names for SQL.

/// A name in SQL quotes; it may contain any character.
pub(super) fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}
