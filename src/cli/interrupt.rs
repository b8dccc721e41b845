//! What happens when the system or the user stops the program.

use std::io;

use tokosen::io::discard_unfinished;

/// The exit status of a program that was stopped with Ctrl-C, as shells have it.
const INTERRUPTED: i32 = 130;

/// From here on a program that is stopped (Ctrl-C, or politely by the system) leaves no unfinished files behind, and a file
/// that grows beyond what the system lets it is an error like that of a full disk. A terminal that hangs up is left to the
/// system, so that `nohup` works.
#[cfg(unix)]
pub fn prepare() -> io::Result<()> {
    use std::sync::Arc;

    use signal_hook::consts::{SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        if signals.forever().next().is_some() {
            stop();
        }
    })?;
    // The signal for it kills a program that does not mind it. One that does is told by the write that failed.
    signal_hook::flag::register(SIGXFSZ, Arc::default())?;
    Ok(())
}

/// From here on a program that is stopped with Ctrl-C leaves no unfinished files behind.
#[cfg(not(unix))]
pub fn prepare() -> io::Result<()> {
    ctrlc::set_handler(stop).map_err(io::Error::other)
}

fn stop() {
    discard_unfinished(|| std::process::exit(INTERRUPTED));
}
