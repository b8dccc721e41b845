//! Properties of the heights of one side, in two passes over its rows.

use serde::Serialize;

use super::Statistics;
use super::levels::{LevelCounts, LevelHistogram, range};
use super::precision::{Decimals, Precision};
use crate::base::error::Result;
use crate::contour::Interval;
use crate::raster::{Blocks, RasterRows};

/// Properties of the heights of one side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeightFigures {
    /// Cells with a height.
    pub cells: usize,
    /// The step that all heights are multiples of, if it is coarse.
    pub precision: Option<Precision>,
    /// Heights modulo the contour interval. Without a given interval, `None` unless there are terraces.
    pub levels: Option<LevelHistogram>,
    /// Statistics of height − check height at check points. `None` if there are no check points here.
    pub points: Option<Statistics>,
}

/// Finds the properties of the heights of one side.
///
/// # Errors
/// As [`RasterRows::read`].
pub fn height_figures(heights: &dyn RasterRows, interval: Option<&Interval>) -> Result<HeightFigures> {
    let mut scan = Scan::new();
    let mut blocks = Blocks::of(heights);
    while let Some(block) = blocks.next()? {
        scan.add(block.heights());
    }
    let mut levels = scan.levels(interval);
    let mut blocks = Blocks::of(heights);
    while let Some(block) = blocks.next()? {
        levels.add(block.heights());
    }
    Ok(scan.figures(&levels))
}

/// What the first pass finds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scan {
    cells: usize,
    lowest: f32,
    highest: f32,
    decimals: Decimals,
}

impl Scan {
    pub fn new() -> Self {
        Self { cells: 0, lowest: f32::INFINITY, highest: f32::NEG_INFINITY, decimals: Decimals::default() }
    }

    /// Looks at heights.
    pub fn add(&mut self, heights: &[f32]) {
        let (lowest, highest) = range(heights);
        self.cells += heights.iter().filter(|h| h.is_finite()).count();
        (self.lowest, self.highest) = (self.lowest.min(lowest), self.highest.max(highest));
        self.decimals.add(heights);
    }

    /// Counts for the second pass.
    pub fn levels(&self, interval: Option<&Interval>) -> LevelCounts {
        LevelCounts::new((self.lowest, self.highest), interval, self.decimals.precision())
    }

    /// The figures after the second pass.
    pub fn figures(&self, levels: &LevelCounts) -> HeightFigures {
        let (cells, precision) = (self.cells, self.decimals.precision());
        HeightFigures { cells, precision, levels: levels.histogram(), points: None }
    }
}
