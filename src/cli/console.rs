//! What the user sees: progress bars on a terminal, findings, the summary. Nothing else prints.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use clap::ValueEnum;
use glam::DVec2;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use tokosen::Input;
use tokosen::base::Units;
use tokosen::base::error::{Error, Finding, Proposal};
use tokosen::base::progress::{Progress, step};
use tokosen::crs::Reprojection;
use tokosen::io::{PlannedOutput, check_paths};
use tokosen::surface::Surface;

use super::Common;
use super::flags::Flags;
use super::hints::TakesUnit;
use super::progress::Track;
use super::run_file::{Record, RunFile, further};

/// How progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Shown {
    /// A bar, if standard error is a terminal
    Bar,
    /// Lines of JSON
    Json,
}

/// The terminal, and how long each step took.
pub struct Console {
    quiet: bool,
    shown: Shown,
    pub verbose: bool,
    /// Whether outputs may replace what other programs made.
    pub overwrite: bool,
    started: Instant,
    reprojection: OnceLock<Reprojection>,
    units: OnceLock<Units>,
    track: Arc<Mutex<Track>>,
    state: Mutex<State>,
    /// The flags that are given.
    pub flags: Flags,
    /// The notes for `--save-run`.
    record: Option<Record>,
    /// The saved run that is repeated.
    repeated: Option<RunFile>,
}

/// Time between two drawings of the progress.
const TICK: Duration = Duration::from_millis(150);
/// Characters of the bar.
const BAR: usize = 30;

#[derive(Default)]
struct State {
    /// What is on the screen while a step runs.
    bar: Option<ProgressBar>,
    times: Vec<(&'static str, Duration)>,
    /// When progress was printed last as a line of JSON.
    told: Option<Instant>,
    /// The share that was printed.
    share: f64,
    /// Why text could not be printed.
    unprinted: Option<std::io::Error>,
}

impl Console {
    /// `record` takes the notes about the run, `repeated` is the saved run that is repeated.
    pub fn new(
        &Common { quiet, verbose, overwrite, progress: shown, .. }: &Common,
        flags: Flags,
        record: Option<Record>,
        repeated: Option<RunFile>,
    ) -> Self {
        let (reprojection, units, state) = (OnceLock::new(), OnceLock::new(), Mutex::default());
        let track = Arc::new(Mutex::new(Track::new()));
        let started = Instant::now();
        Self { quiet, shown, verbose, overwrite, started, reprojection, units, track, state, flags, record, repeated }
    }

    /// Says which steps will come, for the share that is done and the time that is left.
    pub fn plan(&self, steps: impl IntoIterator<Item = &'static str>) {
        locked(&self.track).plan(steps);
    }

    /// Sets what is said about the input: the conversion of places in findings from the working plane to its
    /// coordinates, and its units.
    pub fn set_input(&self, input: &Input) {
        // The input is read once.
        let _ = self.reprojection.set(input.reprojection.clone());
        let _ = self.units.set(input.units());
    }

    /// Checks the paths of a run before the work, see [`check_paths`]; notes the inputs if the run is saved.
    pub fn check_paths(&self, inputs: &[&Path], outputs: &[PlannedOutput<'_>]) -> Result<(), Error> {
        let mut outputs = outputs.to_vec();
        outputs.extend(self.record.as_ref().map(|record| PlannedOutput::from(record.path())));
        check_paths(inputs, &outputs, self.overwrite)?;
        if let Some(record) = &self.record {
            record.note_inputs(inputs)?;
        }
        if let Some(saved) = &self.repeated {
            for file in further(saved, inputs)? {
                self.warn(&format!("warning: the input {} was not there when the run was saved", file.display()));
            }
        }
        Ok(())
    }

    /// Notes what was chosen for a surface, if the run is saved.
    pub fn note_surface(&self, surface: &Surface) {
        self.record.iter().for_each(|record| record.note_surface(surface));
    }

    /// Writes the file of `--save-run`, if there is one.
    pub fn save_run(&mut self) -> Result<(), Error> {
        if let Some(record) = self.record.take() {
            let path = record.commit()?;
            // The summary may be JSON that another program reads.
            self.warn(&format!("saved      {}", path.display()));
        }
        Ok(())
    }

    /// The units of the input, in which figures about it are printed; metres before it is read.
    pub fn units(&self) -> Units {
        self.units.get().copied().unwrap_or(Units::METRES)
    }

    /// The units of errors that stop the run.
    pub fn error_units(&self) -> Units {
        self.units.get().copied().unwrap_or(Units::METRES_ON_ANY_PLANE)
    }

    /// Whether --unit applies to the run.
    pub fn takes_unit(&self) -> TakesUnit {
        let reads_heights = self.units.get().is_some() || self.flags.first(&["--points"]).is_some();
        if reads_heights { TakesUnit::Yes } else { TakesUnit::No }
    }

    /// The conversion between the working plane and the input's coordinates, once the input is read.
    pub fn reprojection(&self) -> Option<&Reprojection> {
        self.reprojection.get()
    }

    /// The text of a finding, with its place in the input's coordinates.
    pub fn text_of(&self, finding: &Finding) -> String {
        // Findings about inputs are in their units already. Some have all digits of a calculation.
        let message = Units::METRES_ON_ANY_PLANE.message(&finding.message);
        match finding.place.and_then(|p| self.place_in_words(p)) {
            Some(place) => format!("{message} at {place}"),
            None => message,
        }
    }

    /// A proposal, with its places in the input's coordinates and its heights in the input's unit.
    pub fn text_of_proposal(&self, proposal: &Proposal) -> String {
        let place = |p| self.place_in_words(p).unwrap_or_else(|| "a place outside the map".into());
        self.units().message(&proposal.in_words(place))
    }

    /// A place of the working plane in the input's coordinates.
    fn place_in_words(&self, place: DVec2) -> Option<String> {
        let moved = self.reprojection().filter(|reprojection| !reprojection.are_unmoved());
        let place = moved.map_or(Some(place), |reprojection| reprojection.in_input(place))?;
        let in_degrees = moved.and_then(|reprojection| reprojection.input_crs()).is_some_and(|crs| crs.is_geographic());
        let decimals = if in_degrees { 7 } else { 3 };
        Some(format!("{:.decimals$} {:.decimals$}", place.x, place.y))
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
        if let Some(bar) = self.state().bar.take() {
            bar.finish_and_clear();
        }
    }

    /// Says that the run is done, to programs that read the progress.
    pub fn done(&self) {
        if self.shown == Shown::Json {
            let _ = writeln!(std::io::stderr(), "{}", progress_json("", 1.0));
        }
    }

    /// Prints the progress as a line of JSON, if that is asked for and the last line is not too young.
    fn tell(&self, least: Duration) {
        if self.shown == Shown::Bar || self.state().told.is_some_and(|told| told.elapsed() < least) {
            return;
        }
        let track = locked(&self.track);
        let Some(share) = track.share() else { return };
        let step = track.step();
        drop(track);
        let mut state = self.state();
        // A step that runs once more may lower the share.
        state.share = state.share.max(share);
        state.told = Some(Instant::now());
        let _ = writeln!(std::io::stderr(), "{}", progress_json(step, state.share));
    }

    fn state(&self) -> MutexGuard<'_, State> {
        locked(&self.state)
    }
}

/// One line of progress for other programs.
fn progress_json(step: &str, share: f64) -> serde_json::Value {
    serde_json::json!({ "progress": (share * 1e3).round() / 1e3, "step": step })
}

fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Progress for Console {
    fn start(&self, step: &'static str, total: u64) {
        locked(&self.track).start(step, total);
        self.tell(Duration::ZERO);
        let mut state = self.state();
        if state.bar.is_none() && self.shown == Shown::Bar && !self.quiet && std::io::stderr().is_terminal() {
            let track = Arc::clone(&self.track);
            let line = move |_: &ProgressState, out: &mut dyn std::fmt::Write| {
                let _ = out.write_str(&locked(&track).line(BAR));
            };
            let style = ProgressStyle::with_template("{line}").unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::new_spinner().with_style(style.with_key("line", line));
            bar.enable_steady_tick(TICK);
            state.bar = Some(bar);
        }
    }

    fn advance(&self, amount: u64) {
        locked(&self.track).advance(amount);
        self.tell(TICK);
    }

    fn finish(&self) {
        let finished = locked(&self.track).finish();
        self.state().times.extend(finished);
        // What is printed between steps must not mix with the line.
        self.clear();
    }
}

/// An error message, on standard error.
pub fn error(message: &str) {
    let _ = writeln!(std::io::stderr(), "error: {message}");
}
