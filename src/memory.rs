//! Whether there is room for what is asked for: told before the work, not by the system in the middle of it.

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

use crate::base::error::{Error, Result};

/// Refuses work that needs more memory than there is.
///
/// `bytes` is about what it takes at its largest, `what` names it, `remedy` says what to do.
///
/// # Errors
/// If less is available; the message has both figures. Where the system does not say how much there is, nothing is refused.
pub fn check(bytes: f64, what: &str, remedy: &str) -> Result<()> {
    match available() {
        Some(available) if bytes > available as f64 => Err(Error::Data(format!(
            "{what} would need about {:.1} GB of memory, {:.1} GB are available: {remedy}",
            bytes / 1e9,
            available as f64 / 1e9
        ))),
        _ => Ok(()),
    }
}

/// Bytes that a process may still take, by the machine and by the limits of its control group.
fn available() -> Option<u64> {
    let memory = MemoryRefreshKind::nothing().with_ram();
    let system = System::new_with_specifics(RefreshKind::nothing().with_memory(memory)).ok()?;
    let free = system.available_memory();
    let limited = system.cgroup_limits().map_or(free, |limits| free.min(limits.free_memory));
    (limited > 0).then_some(limited)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_the_figure() {
        assert!(check(1.0, "a byte", "").is_ok());
        let said = check(5e18, "a map of the moon", "take a larger cell").unwrap_err().to_string();
        assert!(said.contains("a map of the moon would need about 5000000000.0 GB"), "{said}");
        assert!(said.ends_with("take a larger cell"), "{said}");
    }
}
