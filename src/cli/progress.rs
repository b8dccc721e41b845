//! The share of a run that is done, and the time that is left.
//!
//! A run is a list of steps, each with a weight: its usual share of the time. A step that does not report its own progress
//! is taken to be as fast as the steps before it. A step may run several times in a row. How often is not known, so each
//! time counts for half of what is left of it, and the rest counts when another step begins.

use std::time::{Duration, Instant};

/// The usual time of each step, in units of its own. Measured on maps of 50 thousand to a million vertices.
const WEIGHTS: [(&str, f64); 16] = [
    ("reading", 3.0),
    ("cleaning", 2.0),
    ("fitting", 3.0),
    ("sampling", 2.0),
    ("triangulating", 9.0),
    ("ridge and canyon lines", 30.0),
    ("smooth surface", 30.0),
    ("expected errors", 25.0),
    ("triangulating the smooth surface", 25.0),
    ("slicing", 4.0),
    ("smoothing", 4.0),
    ("tracing", 12.0),
    ("rasterising", 3.0),
    ("evaluating the surface", 3.0),
    ("writing", 4.0),
    ("drawing", 10.0),
];

/// Share of a step without progress of its own that is not shown as done before it ends.
const HELD_BACK: f64 = 0.05;
/// Share of what is left of a step that one run of it counts for.
const AGAIN: f64 = 0.5;
/// From this share on, the time that is left can be told.
const TOLD: f64 = 0.04;

/// How far a run is.
pub struct Track {
    started: Instant,
    planned: Vec<&'static str>,
    /// The planned steps that are over.
    over: Vec<&'static str>,
    /// The planned step that ran last, and the share of it that counts so far.
    last: Option<(&'static str, f64)>,
    /// Time of all planned steps.
    time: Duration,
    running: Option<Running>,
}

struct Running {
    step: &'static str,
    started: Instant,
    total: u64,
    done: u64,
}

fn weight_of(step: &str) -> f64 {
    WEIGHTS.iter().find(|(name, _)| *name == step).map_or(1.0, |(_, weight)| *weight)
}

impl Track {
    /// A run that has not begun.
    pub fn new() -> Self {
        Self {
            started: Instant::now(),
            planned: Vec::new(),
            over: Vec::new(),
            last: None,
            time: Duration::ZERO,
            running: None,
        }
    }

    /// The steps that will come.
    pub fn plan(&mut self, steps: impl IntoIterator<Item = &'static str>) {
        self.planned.extend(steps);
    }

    /// A step begins; `total` is its amount of work, 0 if unknown.
    pub fn start(&mut self, step: &'static str, total: u64) {
        if self.planned.contains(&step) && self.last.is_some_and(|(last, _)| last != step) {
            self.over.extend(self.last.take().map(|(last, _)| last));
        }
        self.running = Some(Running { step, started: Instant::now(), total, done: 0 });
    }

    /// The running step has done this much more.
    pub fn advance(&mut self, amount: u64) {
        if let Some(running) = &mut self.running {
            running.done += amount;
        }
    }

    /// The running step ends. Returns its name and time.
    pub fn finish(&mut self) -> Option<(&'static str, Duration)> {
        let Running { step, started, .. } = self.running.take()?;
        let time = started.elapsed();
        if self.planned.contains(&step) {
            let before = self.last.map_or(0.0, |(_, share)| share);
            self.last = Some((step, before + (1.0 - before) * AGAIN));
            self.time += time;
        }
        Some((step, time))
    }

    /// The name of the running step.
    pub fn step(&self) -> &'static str {
        self.running.as_ref().map_or("", |running| running.step)
    }

    /// The share of the run that is done, 0 to 1; `None` if no steps are planned.
    pub fn share(&self) -> Option<f64> {
        let total: f64 = self.planned.iter().map(|step| weight_of(step)).sum();
        if total == 0.0 {
            return None;
        }
        let is_over = |step: &&&'static str| self.over.contains(step);
        let over: f64 = self.planned.iter().filter(is_over).map(|step| weight_of(step)).sum();
        let before = self.last.map_or(0.0, |(_, share)| share);
        let partly = match &self.running {
            Some(running) if self.planned.contains(&running.step) && !self.over.contains(&running.step) => {
                weight_of(running.step) * (before + (1.0 - before) * AGAIN * self.fraction(running))
            }
            _ => self.last.map_or(0.0, |(last, share)| weight_of(last) * share),
        };
        Some(((over + partly) / total).clamp(0.0, 1.0))
    }

    /// The share of the running step that is done.
    fn fraction(&self, running: &Running) -> f64 {
        if running.total > 0 {
            return (running.done as f64 / running.total as f64).min(1.0);
        }
        let weight: f64 = self.over.iter().map(|step| weight_of(step)).sum();
        let expected = self.time.as_secs_f64() * weight_of(running.step) / weight;
        let share = running.started.elapsed().as_secs_f64() / expected;
        if share.is_finite() { share.min(1.0 - HELD_BACK) } else { 0.0 }
    }

    /// The line that shows the progress.
    pub fn line(&self, width: usize) -> String {
        let Some(share) = self.share() else {
            return format!("{}  {}", self.step(), in_words(self.started.elapsed()));
        };
        let full = (share * width as f64).round() as usize;
        let bar = format!("{}{}", "=".repeat(full), " ".repeat(width - full.min(width)));
        let left = self.started.elapsed().mul_f64(((1.0 - share) / share.max(TOLD)).min(1e6));
        let left = if share < TOLD { String::new() } else { format!("  about {} left", in_words(left)) };
        format!("{:<32} [{bar}] {:>3.0} %{left}", self.step(), 100.0 * share)
    }
}

/// A duration as people say it.
fn in_words(time: Duration) -> String {
    match time.as_secs() {
        seconds @ 0..60 => format!("{seconds} s"),
        seconds @ 60..3600 => format!("{} min {} s", seconds / 60, seconds % 60),
        seconds => format!("{} h {} min", seconds / 3600, seconds % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_grows_with_the_weights_of_the_steps() {
        let mut track = Track::new();
        assert_eq!(track.share(), None);
        track.plan(["reading", "smooth surface", "writing"]);
        let mut shares = Vec::new();
        for (step, total) in [("reading", 2), ("not planned", 10), ("smooth surface", 4), ("writing", 1)] {
            track.start(step, total);
            shares.extend(track.share());
            for _ in 0..total {
                track.advance(1);
                shares.extend(track.share());
            }
            assert_eq!(track.finish().map(|(name, _)| name), Some(step));
            shares.extend(track.share());
        }
        assert!(shares.is_sorted() && shares[0] == 0.0 && shares[shares.len() - 1] < 1.0, "{shares:?}");
        // Half of the first run of the surface: 3 and 7.5 of 37; and when writing begins, all of it.
        for wanted in [10.5 / 37.0, 33.0 / 37.0] {
            assert!(shares.iter().any(|share| (share - wanted).abs() < 1e-12), "{wanted} of {shares:?}");
        }
    }

    #[test]
    fn a_step_that_runs_often_never_counts_for_more_than_its_weight() {
        let mut track = Track::new();
        track.plan(["reading", "smooth surface", "writing"]);
        let mut shares = Vec::new();
        for step in ["reading", "smooth surface", "smooth surface", "between", "smooth surface"] {
            track.start(step, 0);
            shares.extend(track.share());
            track.finish();
            shares.extend(track.share());
        }
        assert!(shares.is_sorted() && shares[shares.len() - 1] < 33.0 / 37.0, "{shares:?}");
    }

    #[test]
    fn the_line_says_what_is_done_and_left() {
        let mut track = Track::new();
        track.plan(["reading", "smooth surface"]);
        track.start("smooth surface", 2);
        track.advance(1);
        let line = track.line(10);
        assert!(line.contains("smooth surface") && line.contains("23 %") && line.contains(" left"), "{line}");
        assert_eq!(in_words(Duration::from_secs(4000)), "1 h 6 min");
        assert_eq!(in_words(Duration::from_secs(75)), "1 min 15 s");
    }
}
