//! What the user sees: progress bars on a terminal, findings, the summary. Nothing else prints.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use tokosen::Input;
use tokosen::base::ElevationUnit;
use tokosen::base::error::{Error, Finding};
use tokosen::base::progress::{Progress, step};
use tokosen::crs::Reprojection;

use super::Common;

/// The terminal, and how long each step took.
pub struct Console {
    quiet: bool,
    pub verbose: bool,
    /// Whether outputs may replace what other programs made.
    pub overwrite: bool,
    started: Instant,
    reprojection: OnceLock<Reprojection>,
    unit: OnceLock<ElevationUnit>,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    running: Option<(&'static str, Instant, ProgressBar)>,
    times: Vec<(&'static str, Duration)>,
    /// Why text could not be printed.
    unprinted: Option<std::io::Error>,
}

impl Console {
    pub fn new(&Common { quiet, verbose, overwrite, .. }: &Common) -> Self {
        let (reprojection, unit, state) = (OnceLock::new(), OnceLock::new(), Mutex::default());
        Self { quiet, verbose, overwrite, started: Instant::now(), reprojection, unit, state }
    }

    /// Sets what is said about the input: the conversion of places in findings from the working plane to its
    /// coordinates, and the unit that its elevations had.
    pub fn set_input(&self, input: &Input) {
        // The input is read once.
        let _ = self.reprojection.set(input.reprojection.clone());
        let _ = self.unit.set(input.unit());
    }

    /// The unit that the elevations of the input had; metres before it is read.
    pub fn unit(&self) -> ElevationUnit {
        self.unit.get().copied().unwrap_or_default()
    }

    /// The conversion between the working plane and the input's coordinates, once the input is read.
    pub fn reprojection(&self) -> Option<&Reprojection> {
        self.reprojection.get()
    }

    /// The text of a finding, with its place in the input's coordinates.
    pub fn text_of(&self, finding: &Finding) -> String {
        let Some(reprojection) = self.reprojection().filter(|reprojection| !reprojection.are_unmoved()) else {
            return finding.to_string();
        };
        let decimals = if reprojection.input_crs().is_some_and(|crs| crs.is_geographic()) { 7 } else { 3 };
        match finding.place.and_then(|p| reprojection.in_input(p)) {
            Some(p) => format!("{} at {:.decimals$} {:.decimals$}", finding.message, p.x, p.y),
            None => finding.message.clone(),
        }
    }

    /// One line of the summary, on standard output.
    pub fn say(&self, line: &str) {
        if !self.quiet {
            self.result(line);
        }
    }

    /// One line of the summary that only `--verbose` prints.
    pub fn detail(&self, line: &str) {
        if self.verbose {
            self.say(line);
        }
    }

    /// A result that the user asked for as text, on standard output. `--quiet` does not suppress it.
    pub fn result(&self, text: &str) {
        if let Err(e) = writeln!(std::io::stdout(), "{text}") {
            self.state().unprinted.get_or_insert(e);
        }
    }

    /// Checks at the end of a run that all text was printed. A closed pipe is no error: its reader has seen enough.
    pub fn printed(&self) -> Result<(), Error> {
        let flushed = std::io::stdout().flush();
        match self.state().unprinted.take().map_or(flushed, Err) {
            Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io("write", Path::new("standard output"), e)),
            _ => Ok(()),
        }
    }

    /// One line about a finding, on standard error.
    pub fn warn(&self, line: &str) {
        if !self.quiet {
            let _ = writeln!(std::io::stderr(), "{line}");
        }
    }

    /// Runs a step that reports no progress of its own.
    pub fn step<T>(&self, name: &'static str, work: impl FnOnce() -> T) -> T {
        step(self, name, work)
    }

    /// The time since the program started, also between steps.
    pub fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    /// The steps so far and the time each took; steps of one name together.
    pub fn times(&self) -> Vec<(&'static str, Duration)> {
        let mut sums: Vec<(&'static str, Duration)> = Vec::new();
        for &(name, time) in &self.state().times {
            match sums.iter_mut().find(|(n, _)| *n == name) {
                Some((_, sum)) => *sum += time,
                None => sums.push((name, time)),
            }
        }
        sums
    }

    /// Removes a progress bar that is still on the screen.
    pub fn clear(&self) {
        if let Some((_, _, bar)) = self.state().running.take() {
            bar.finish_and_clear();
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Console {
    fn start(&self, step: &'static str, total: u64) {
        let bar = if self.quiet || !std::io::stderr().is_terminal() {
            ProgressBar::hidden()
        } else if total == 0 {
            let bar = ProgressBar::new_spinner();
            bar.set_style(style("{spinner} {msg} {elapsed}"));
            bar.enable_steady_tick(Duration::from_millis(120));
            bar
        } else {
            let bar = ProgressBar::new(total);
            bar.set_style(style("{msg:24} [{bar:40}] {percent:>3} %  {eta} left").progress_chars("=> "));
            bar
        };
        bar.set_message(step);
        self.state().running = Some((step, Instant::now(), bar));
    }

    fn advance(&self, amount: u64) {
        if let Some((_, _, bar)) = &self.state().running {
            bar.inc(amount);
        }
    }

    fn finish(&self) {
        let mut state = self.state();
        if let Some((step, started, bar)) = state.running.take() {
            bar.finish_and_clear();
            state.times.push((step, started.elapsed()));
        }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// An error message, on standard error.
pub fn error(message: &str) {
    let _ = writeln!(std::io::stderr(), "error: {message}");
}
