//! What happens when the system or the user stops the program.

use std::io;

use tokosen::io::discard_unfinished;

/// The exit status of a program that was stopped, as shells give it for Ctrl-C: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Installs the signal handlers: SIGINT (Ctrl-C), SIGTERM and SIGHUP then leave no unfinished files. SIGHUP stays
/// ignored if it was so, as with `nohup`. A file above the size limit of the process (SIGXFSZ) is a write error.
#[cfg(unix)]
pub fn prepare() -> io::Result<()> {
    use std::sync::Arc;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    if is_hang_up_heeded() {
        signals.add_signal(SIGHUP)?;
    }
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        if signals.forever().next().is_some() {
            stop();
        }
    })?;
    // Without a handler, SIGXFSZ kills the program. With one, the write that caused it fails.
    signal_hook::flag::register(SIGXFSZ, Arc::default())?;
    Ok(())
}

/// Whether SIGHUP is not ignored. Where the system does not say, no handler is installed for it.
#[cfg(unix)]
fn is_hang_up_heeded() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    // A hexadecimal number whose lowest bit is the first signal.
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal_hook::consts::SIGHUP - 1) & 1 == 0)
}

/// Installs the signal handler. From then on Ctrl-C leaves no unfinished files.
#[cfg(not(unix))]
pub fn prepare() -> io::Result<()> {
    ctrlc::set_handler(stop).map_err(io::Error::other)
}

fn stop() {
    discard_unfinished(|| std::process::exit(INTERRUPTED));
}
