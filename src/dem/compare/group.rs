//! Classes of cells by one value, and the statistics of each.

use glam::DVec2;

use super::classes::Class;
use super::tally::{Second, Tally};

/// The first pass over the cells of some classes.
#[derive(Debug)]
pub(super) struct Group {
    classes: Bounds,
    tallies: Vec<Tally>,
}

/// The second pass.
#[derive(Debug)]
pub(super) struct SecondGroup {
    classes: Bounds,
    tallies: Vec<Option<Second>>,
}

/// Bounds of classes: those that are reported, and those that values are compared with. There are none or at least two.
#[derive(Debug, Clone)]
struct Bounds {
    told: Vec<f64>,
    compared: Vec<f64>,
}

impl Bounds {
    /// The class of a value. A class has its lower bound, and not its upper one.
    fn class(&self, value: f64) -> Option<usize> {
        let count = self.compared.iter().filter(|bound| value >= **bound).count();
        if count < self.compared.len() { count.checked_sub(1) } else { None }
    }
}

impl Group {
    /// Classes between bounds.
    pub fn new(bounds: &[f64]) -> Self {
        Self::compared(bounds, bounds.to_vec())
    }

    /// Classes between bounds that are compared with values of another kind.
    pub fn compared(bounds: &[f64], compared: Vec<f64>) -> Self {
        let tallies = bounds.iter().skip(1).map(|_| Tally::new()).collect();
        Self { classes: Bounds { told: bounds.to_vec(), compared }, tallies }
    }

    /// Counts a row of differences, NaN where there is none. `value` gives the value of a column. `first` is the index of the
    /// first cell.
    pub fn add(&mut self, differences: &[f64], value: impl Fn(usize) -> f64, first: usize) {
        for (col, &d) in differences.iter().enumerate().filter(|(_, d)| !d.is_nan()) {
            if let Some(class) = self.classes.class(value(col)) {
                self.tallies[class].add(d, first + col);
            }
        }
        self.tallies.iter_mut().for_each(Tally::end_row);
    }

    pub fn second(self) -> SecondGroup {
        SecondGroup { classes: self.classes, tallies: self.tallies.into_iter().map(Tally::second).collect() }
    }
}

impl SecondGroup {
    /// Takes a row of differences, as [`Group::add`].
    pub fn add(&mut self, differences: &[f64], value: impl Fn(usize) -> f64) {
        for (col, &d) in differences.iter().enumerate().filter(|(_, d)| !d.is_nan()) {
            if let Some(tally) = self.classes.class(value(col)).and_then(|class| self.tallies[class].as_mut()) {
                tally.add(d);
            }
        }
        self.tallies.iter_mut().flatten().for_each(Second::end_row);
    }

    pub fn classes(self, place: &dyn Fn(usize) -> DVec2) -> Vec<Class> {
        let bounds = self.classes.told;
        let class = |(bound, tally): (&[f64], Option<Second>)| Class {
            from: bound[0],
            to: Some(bound[1]).filter(|to| to.is_finite()),
            statistics: tally.map(|tally| tally.statistics(place)),
        };
        bounds.windows(2).zip(self.tallies).map(class).collect()
    }
}
