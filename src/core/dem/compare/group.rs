//! Classes of cells by one property.

use glam::DVec2;

use super::classes::{Class, SLOPE_BOUNDS};
use super::rows::Cells;
use super::slopes::steepness_of;
use super::tally::{Collector, Take, Tally};

/// The property that decides the class of a cell.
#[derive(Debug, Clone, Copy)]
enum By {
    /// All cells are one class.
    Nothing,
    Slope,
    Elevation,
    Distance,
}

/// Classes of cells by one property.
#[derive(Debug)]
pub(super) struct Group<T> {
    by: By,
    /// Bounds of the classes: none or at least two.
    bounds: Vec<f64>,
    /// The bounds in the unit that cells have the property in.
    limits: Vec<f64>,
    classes: Vec<T>,
}

impl Group<Tally> {
    /// All cells.
    pub fn all() -> Self {
        Self::new(By::Nothing, &[f64::NEG_INFINITY, f64::INFINITY])
    }

    /// Classes by the slope of B.
    pub fn by_slope() -> Self {
        // Slopes are compared as rise over run, which takes less time than their arc tangents.
        Self { limits: SLOPE_BOUNDS.map(steepness_of).to_vec(), ..Self::new(By::Slope, &SLOPE_BOUNDS) }
    }

    /// Classes by the elevation of B.
    pub fn by_elevation(bounds: &[f64]) -> Self {
        Self::new(By::Elevation, bounds)
    }

    /// Classes by the distance to the nearest contour.
    pub fn by_distance(bounds: &[f64]) -> Self {
        Self::new(By::Distance, bounds)
    }

    fn new(by: By, bounds: &[f64]) -> Self {
        let classes = bounds.iter().skip(1).map(|_| Tally::new()).collect();
        Self { by, bounds: bounds.to_vec(), limits: bounds.to_vec(), classes }
    }

    /// The same classes for the next pass.
    pub fn collectors(self) -> Group<Option<Collector>> {
        let Self { by, bounds, limits, classes } = self;
        Group { by, bounds, limits, classes: classes.into_iter().map(Tally::collector).collect() }
    }
}

impl<T: Take> Group<T> {
    /// Takes a row.
    pub fn add(&mut self, cells: &Cells<'_>) {
        match self.by {
            By::Nothing => self.add_by(cells, |_| 0.0),
            By::Slope => self.add_by(cells, |col| cells.row.steepness[col].into()),
            By::Elevation => self.add_by(cells, |col| cells.heights[col].into()),
            By::Distance => self.add_by(cells, |col| cells.distances.get(col).copied().unwrap_or(f64::NAN)),
        }
    }

    fn add_by(&mut self, cells: &Cells<'_>, value: impl Fn(usize) -> f64) {
        for (col, &d) in cells.row.differences.iter().enumerate().filter(|(_, d)| !d.is_nan()) {
            if let Some(class) = class(&self.limits, value(col)) {
                self.classes[class].add(d, cells.first + col);
            }
        }
        self.classes.iter_mut().for_each(T::end_row);
    }
}

impl Group<Option<Collector>> {
    /// The classes with their statistics. `place` gives the position of a cell.
    pub fn statistics(self, place: &dyn Fn(usize) -> DVec2) -> Vec<Class> {
        let class = |(bound, collector): (&[f64], Option<Collector>)| Class {
            from: bound[0],
            to: Some(bound[1]).filter(|to| to.is_finite()),
            statistics: collector.map(|collector| collector.statistics(place)),
        };
        self.bounds.windows(2).zip(self.classes).map(class).collect()
    }
}

/// The class of a value. A class has its lower bound, and not its upper one.
fn class(bounds: &[f64], value: f64) -> Option<usize> {
    let count = bounds.iter().filter(|bound| value >= **bound).count();
    if count < bounds.len() { count.checked_sub(1) } else { None }
}
