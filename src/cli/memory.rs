//! How much memory the library may take.

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Bytes that the process may still take, by the machine, by the limits of its control group and by the limit of its
/// address space (`ulimit -v`); `None` where the system does not say.
pub fn available() -> Option<u64> {
    let memory = MemoryRefreshKind::nothing().with_ram();
    let system = System::new_with_specifics(RefreshKind::nothing().with_memory(memory)).ok()?;
    let free = system.available_memory();
    let limited = system.cgroup_limits().map_or(free, |limits| free.min(limits.free_memory));
    let limited = left_of_address_space().map_or(limited, |left| limited.min(left));
    (limited > 0).then_some(limited)
}

/// Bytes that are left below the limit of the address space; `None` without a limit.
///
/// Each thread reserves an arena for its allocations, and uses little of it. These bytes cannot be used for others.
#[cfg(target_os = "linux")]
fn left_of_address_space() -> Option<u64> {
    use rustix::param::page_size;

    use super::address_space::{is_shared, limit};

    /// Bytes of an arena of the GNU C library.
    const ARENA: u64 = 64 << 20;
    /// Most arenas per processor.
    const PER_PROCESSOR: usize = 8;

    let limit = limit()?;
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?.split(' ').next()?.parse::<u64>().ok()?;
    let most = std::thread::available_parallelism().map_or(1, usize::from) * PER_PROCESSOR;
    let arenas = if is_shared() { 0 } else { ARENA * (rayon::current_num_threads() + 1).min(most) as u64 };
    // What is left is at least one byte: no limit must not be taken for none left.
    Some(limit.saturating_sub(pages * page_size() as u64 + arenas).max(1))
}

#[cfg(not(target_os = "linux"))]
fn left_of_address_space() -> Option<u64> {
    None
}
