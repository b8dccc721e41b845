//! How much memory the library may take.

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Bytes that the process may still take, by the machine and by the limits of its control group; `None` where the system
/// does not say.
pub fn available() -> Option<u64> {
    let memory = MemoryRefreshKind::nothing().with_ram();
    let system = System::new_with_specifics(RefreshKind::nothing().with_memory(memory)).ok()?;
    let free = system.available_memory();
    let limited = system.cgroup_limits().map_or(free, |limits| free.min(limits.free_memory));
    (limited > 0).then_some(limited)
}
