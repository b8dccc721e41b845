//! Checks the memory that a step needs before the step starts. Otherwise the system would stop it half-way.

use crate::base::error::{Error, Result};

/// Refuses work that needs more memory than the caller's budget, if there is one.
///
/// `bytes` is the estimated peak memory, `what` names the work, `remedy` says what the user can do.
///
/// # Errors
/// [`Error::OutOfMemory`] if `budget` is less than `bytes`.
pub fn check(bytes: f64, budget: Option<u64>, what: String, remedy: &'static str) -> Result<()> {
    match budget {
        Some(available) if bytes > available as f64 => {
            Err(Error::OutOfMemory { what, needed: bytes, available, remedy })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_beyond_the_budget_is_refused_with_both_figures() {
        assert!(check(1.0, Some(1), "a byte".into(), "").is_ok());
        assert!(check(5e18, None, "a map of the moon".into(), "").is_ok());
        let refused = check(5e18, Some(8_000_000_000), "a map of the moon".into(), "take a larger cell");
        let said = refused.unwrap_err().to_string();
        assert!(said.contains("a map of the moon would need about 5000000000.0 GB of memory, 8.0 GB are"), "{said}");
        assert!(said.ends_with("take a larger cell"), "{said}");
    }
}
