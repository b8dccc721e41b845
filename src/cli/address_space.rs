//! What the program does to get along with a limit of its address space (`ulimit -v`).
//!
//! Such a limit counts what is reserved, not what is used. The GNU C library reserves 64 MB for each thread that allocates, and
//! every thread has a stack.

/// The limit of the address space, bytes; `None` if there is none.
#[cfg(target_os = "linux")]
pub fn limit() -> Option<u64> {
    rustix::process::getrlimit(rustix::process::Resource::As).current
}

/// Whether the user has set that threads share what the GNU C library reserves.
#[cfg(target_os = "linux")]
pub fn is_shared() -> bool {
    std::env::var_os("MALLOC_ARENA_MAX").is_some_and(|count| count == "1")
}

/// The number of threads that the limit leaves room for; `None` if all may be started, or if the user has set the number.
#[cfg(target_os = "linux")]
pub fn most_threads() -> Option<usize> {
    /// Bytes of the address space for each thread at the least.
    const PER_THREAD: u64 = 32 << 20;

    if std::env::var_os("RAYON_NUM_THREADS").is_some() {
        return None;
    }
    let most = usize::try_from(limit()? / PER_THREAD).unwrap_or(usize::MAX).max(1);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    (most < cores).then_some(most)
}

#[cfg(not(target_os = "linux"))]
pub fn most_threads() -> Option<usize> {
    None
}
