//! Why no surface, no lines or no mesh can be made of a map: the only errors that a test on random maps may accept, and a
//! count of them, so that a test fails when it has tested too little.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use tokosen::base::error::{Error, Result};

/// The reasons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Refusal {
    /// The map has no contour line, or none inside the frame.
    NoContour,
    /// It has a single contour line.
    OneContour,
    /// All its contour lines have the same elevation.
    OneLevel,
    /// All vertices lie on one straight line.
    NoArea,
    /// Sampling would add more points than were allowed.
    TooManyPoints,
}

impl Refusal {
    /// The reason of an error. None for every other error.
    pub fn of(error: &Error) -> Option<Self> {
        match error.root() {
            Error::NoContours { .. } => Some(Self::NoContour),
            Error::TooFewLevels { lines: 1, .. } => Some(Self::OneContour),
            Error::TooFewLevels { .. } => Some(Self::OneLevel),
            Error::NoArea => Some(Self::NoArea),
            Error::TooManyPoints { .. } => Some(Self::TooManyPoints),
            _ => None,
        }
    }
}

/// What the cases of a test came to.
#[derive(Debug, Default)]
pub struct Tally {
    made: Cell<usize>,
    refused: RefCell<BTreeMap<Refusal, usize>>,
    lines: Cell<usize>,
}

impl Tally {
    /// What was made, counted; None if it was refused for one of the `allowed` reasons. Every other error ends the test.
    pub fn take<T>(&self, outcome: Result<T>, allowed: &[Refusal], what: &str) -> Option<T> {
        match outcome {
            Ok(made) => {
                self.made.set(self.made.get() + 1);
                Some(made)
            }
            Err(error) => {
                let refusal = Refusal::of(&error).filter(|r| allowed.contains(r));
                let refusal = refusal.unwrap_or_else(|| panic!("{what}: {error}"));
                *self.refused.borrow_mut().entry(refusal).or_default() += 1;
                None
            }
        }
    }

    /// Counts new lines that were checked.
    pub fn add_lines(&self, count: usize) {
        self.lines.set(self.lines.get() + count);
    }

    /// Fails unless at least this share of the cases was made, and so many new lines were checked for each of them.
    #[expect(clippy::print_stderr, reason = "shown with --nocapture: whoever sets a bound needs what was measured")]
    pub fn assert_share(&self, least: f64, lines_each: f64) {
        let (made, refused) = (self.made.get(), self.refused.borrow().values().sum::<usize>());
        let share = made as f64 / ((made + refused) as f64).max(1.0);
        let each = self.lines.get() as f64 / (made as f64).max(1.0);
        eprintln!("{made} made, {refused} refused ({share:.3}), {each:.1} new lines each");
        assert!(made > 0 && share >= least, "{share:.3} of the cases were made, not {least}: {self:?}");
        assert!(each >= lines_each, "{each:.1} new lines were checked for each, not {lines_each}: {self:?}");
    }
}
