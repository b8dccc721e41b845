//! The share of a run that is done, and the time that is left.
//!
//! A run is a list of steps, each with a weight: its usual share of the time. A step that does not report its own progress
//! is taken to be as fast as the steps before it.

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
/// From this share on, the time that is left can be told.
const TOLD: f64 = 0.04;

/// How far a run is.
pub struct Track {
    started: Instant,
    planned: Vec<&'static str>,
    /// Weight and time of the planned steps that are over.
    weight: f64,
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
        Self { started: Instant::now(), planned: Vec::new(), weight: 0.0, time: Duration::ZERO, running: None }
    }

    /// The steps that will come.
    pub fn plan(&mut self, steps: impl IntoIterator<Item = &'static str>) {
        self.planned.extend(steps);
    }

    /// A step begins; `total` is its amount of work, 0 if unknown.
    pub fn start(&mut self, step: &'static str, total: u64) {
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
            self.weight += weight_of(step);
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
        let running = self.running.as_ref().filter(|running| self.planned.contains(&running.step));
        let partly = running.map_or(0.0, |running| weight_of(running.step) * self.fraction(running));
        Some(((self.weight + partly) / total).clamp(0.0, 1.0))
    }

    /// The share of the running step that is done.
    fn fraction(&self, running: &Running) -> f64 {
        if running.total > 0 {
            return (running.done as f64 / running.total as f64).min(1.0);
        }
        let expected = self.time.as_secs_f64() * weight_of(running.step) / self.weight;
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
        let mut shares = vec![track.share().unwrap_or(-1.0)];
        for (step, total) in [("reading", 0), ("not planned", 10), ("smooth surface", 4), ("writing", 0)] {
            track.start(step, total);
            for _ in 0..total {
                track.advance(1);
                shares.push(track.share().unwrap_or(-1.0));
            }
            assert_eq!(track.finish().map(|(name, _)| name), Some(step));
            shares.push(track.share().unwrap_or(-1.0));
        }
        assert!(shares.is_sorted() && shares[0] == 0.0 && shares[shares.len() - 1] == 1.0, "{shares:?}");
        // Half of the surface: 3 and 15 of 37.
        assert!(shares.iter().any(|share| (share - 18.0 / 37.0).abs() < 1e-12), "{shares:?}");
    }

    #[test]
    fn the_line_says_what_is_done_and_left() {
        let mut track = Track::new();
        track.plan(["reading", "smooth surface"]);
        track.start("smooth surface", 2);
        track.advance(1);
        let line = track.line(10);
        assert!(line.contains("smooth surface") && line.contains("45 %") && line.contains(" left"), "{line}");
        assert_eq!(in_words(Duration::from_secs(4000)), "1 h 6 min");
        assert_eq!(in_words(Duration::from_secs(75)), "1 min 15 s");
    }
}
