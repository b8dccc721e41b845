//! What happens when the system or the user stops the program, or when memory cannot be had.

use std::io;

use tokosen::io::discard_unfinished;

/// The exit status of a program that was stopped, as shells give it for Ctrl-C: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// The exit status of a program that could not have the memory that it needs: that of any failure.
#[cfg(unix)]
const EXHAUSTED: i32 = super::FAILED as i32;

/// What is told then. The standard library has told how many bytes could not be had.
#[cfg(unix)]
const TOO_LITTLE_MEMORY: &str = "\
error: there was not enough memory, so nothing was written. Take a larger cell, a coarser interval or a part of the map; close \
other programs; or raise the limit of memory, if there is one (ulimit -v)\n";

/// Memory that is kept for the end, bytes. It is given back before the unfinished files are removed.
#[cfg(unix)]
const RESERVE: usize = 4 << 20;

/// Installs the signal handlers: SIGINT (Ctrl-C), SIGTERM and SIGHUP then leave no unfinished files. SIGHUP stays
/// ignored if it was so, as with `nohup`. A file above the size limit of the process (SIGXFSZ) is a write error. Where memory
/// cannot be had, the standard library aborts (SIGABRT). Then the program tells so and ends as after any failure.
#[cfg(unix)]
pub fn prepare() -> io::Result<()> {
    use std::sync::Arc;

    use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    let mut signals = Signals::new([SIGINT, SIGTERM, SIGABRT])?;
    if is_hang_up_heeded() {
        signals.add_signal(SIGHUP)?;
    }
    // After the handler that wakes the thread below.
    let stalled = stall(SIGABRT)?;
    let reserve: Vec<u8> = Vec::with_capacity(RESERVE);
    std::thread::Builder::new().name("signals".into()).stack_size(STACK).spawn(move || {
        match signals.forever().next() {
            Some(SIGABRT) => {
                drop(reserve);
                // Without a format, which could need memory.
                let _ = io::Write::write_all(&mut io::stderr(), TOO_LITTLE_MEMORY.as_bytes());
                discard_unfinished(|| std::process::exit(EXHAUSTED));
            }
            Some(_) => stop(),
            None => {}
        }
        drop(stalled);
    })?;
    // Without a handler, SIGXFSZ kills the program. With one, the write that caused it fails.
    signal_hook::flag::register(SIGXFSZ, Arc::default())?;
    Ok(())
}

/// Bytes of the stack of the thread that waits for signals.
#[cfg(unix)]
const STACK: usize = 256 << 10;

/// Makes a signal stop the thread that gets it, as long as the result lives. The handler writes to a pipe that is full. So the
/// thread that aborts does not end the process before another one has told why.
#[cfg(unix)]
fn stall(signal: i32) -> io::Result<(io::PipeReader, io::PipeWriter)> {
    use std::io::Write;

    use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};

    let (reader, mut writer) = io::pipe()?;
    signal_hook::low_level::pipe::register(signal, writer.try_clone()?)?;
    // The handler's end does not wait now. Both ends share this setting.
    let flags = fcntl_getfl(&writer)?;
    fcntl_setfl(&writer, flags | OFlags::NONBLOCK)?;
    for length in [4096, 1] {
        while writer.write(&[0; 4096][..length]).is_ok() {}
    }
    fcntl_setfl(&writer, flags - OFlags::NONBLOCK)?;
    Ok((reader, writer))
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
