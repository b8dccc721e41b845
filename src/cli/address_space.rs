//! What the program does to get along with a limit of its address space (`ulimit -v`).
//!
//! Such a limit counts what is reserved, not what is used. The GNU C library reserves 64 MB for each thread that allocates, and
//! every thread has a stack.

use std::ffi::OsString;

/// The variable that tells the GNU C library for how many threads it reserves memory.
#[cfg(target_os = "linux")]
const ARENAS: &str = "MALLOC_ARENA_MAX";

/// Bytes of the address space for each thread at the least. With less, there are fewer threads.
#[cfg(target_os = "linux")]
const PER_THREAD: u64 = 32 << 20;

/// The limit of the address space, bytes; `None` if there is none.
#[cfg(target_os = "linux")]
pub fn limit() -> Option<u64> {
    rustix::process::getrlimit(rustix::process::Resource::As).current
}

/// Whether threads share what the C library reserves.
#[cfg(target_os = "linux")]
pub fn is_shared() -> bool {
    std::env::var_os(ARENAS).is_some_and(|count| count == "1")
}

/// Starts the program anew if there is a limit, so that threads share what the C library reserves. It reads the variable only
/// when a program starts. Returns if there is nothing to do, or if it fails.
#[cfg(target_os = "linux")]
pub fn share(arguments: &[OsString]) {
    use std::os::unix::process::CommandExt;

    if limit().is_none() || std::env::var_os(ARENAS).is_some() {
        return;
    }
    let Ok(program) = std::env::current_exe() else { return };
    let mut command = std::process::Command::new(program);
    if let Some((name, rest)) = arguments.split_first() {
        command.arg0(name).args(rest);
    }
    // It only returns if it fails.
    let _ = command.env(ARENAS, "1").exec();
}

/// The number of threads that the limit leaves room for; `None` if it does not matter.
#[cfg(target_os = "linux")]
pub fn most_threads() -> Option<usize> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = usize::try_from(limit()? / PER_THREAD).unwrap_or(usize::MAX).max(1);
    Some(most.min(cores))
}

#[cfg(not(target_os = "linux"))]
pub fn share(_: &[OsString]) {}

#[cfg(not(target_os = "linux"))]
pub fn most_threads() -> Option<usize> {
    None
}
