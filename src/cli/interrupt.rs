//! What happens when the system or the user stops the program.

use std::io;

use tokosen::io::discard_unfinished;

/// The exit status of a program that was stopped, as shells have it for Ctrl-C.
const INTERRUPTED: i32 = 130;

/// From here on a program that is stopped (Ctrl-C, or politely by the system) leaves no unfinished files behind, and a file
/// that grows beyond what the system lets it is an error like that of a full disk. A terminal that hangs up stops it too,
/// unless it was started to outlive the terminal, as `nohup` does.
#[cfg(unix)]
pub fn prepare() -> io::Result<()> {
    use std::sync::Arc;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    if minds_hang_up() {
        signals.add_signal(SIGHUP)?;
    }
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        if signals.forever().next().is_some() {
            stop();
        }
    })?;
    // The signal for it kills a program that does not mind it. One that does is told by the write that failed.
    signal_hook::flag::register(SIGXFSZ, Arc::default())?;
    Ok(())
}

/// Whether the signal of a terminal that hangs up is not ignored. Where the system does not tell, the signal is left to it.
#[cfg(unix)]
fn minds_hang_up() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    // A hexadecimal number whose lowest bit is the first signal.
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask >> (signal_hook::consts::SIGHUP - 1) & 1 == 0)
}

/// From here on a program that is stopped with Ctrl-C leaves no unfinished files behind.
#[cfg(not(unix))]
pub fn prepare() -> io::Result<()> {
    ctrlc::set_handler(stop).map_err(io::Error::other)
}

fn stop() {
    discard_unfinished(|| std::process::exit(INTERRUPTED));
}
