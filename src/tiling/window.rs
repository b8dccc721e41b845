//! The window around a tile, and what meets it.

use glam::DVec2;

/// A window.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    pub lo: DVec2,
    pub hi: DVec2,
}

impl Window {
    pub fn new([lo, hi]: [DVec2; 2]) -> Self {
        Self { lo, hi }
    }

    pub fn holds(&self, p: DVec2) -> bool {
        p.cmpge(self.lo).all() && p.cmple(self.hi).all()
    }

    /// Whether the box around a segment meets the window.
    pub fn meets(&self, a: DVec2, b: DVec2) -> bool {
        a.max(b).cmpge(self.lo).all() && a.min(b).cmple(self.hi).all()
    }

    /// Whether a segment of a line, or its only point, meets the window as [`Window::meets`] tells.
    pub fn meets_line(&self, points: impl Iterator<Item = DVec2>) -> bool {
        let mut before = None;
        points.into_iter().any(|p| self.meets(before.replace(p).unwrap_or(p), p))
    }

    /// Whether the box around points meets the window.
    pub fn meets_box(&self, points: impl Iterator<Item = DVec2>) -> bool {
        let [lo, hi] = points.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)]);
        self.meets(lo, hi)
    }

    /// The runs of a line whose segments meet the window. Ends of runs that are no ends of the line lie outside. A ring goes on
    /// through its first point.
    pub fn runs(&self, line: &[DVec2]) -> Vec<Vec<DVec2>> {
        let mut runs: Vec<Vec<DVec2>> = Vec::new();
        let mut is_open = false;
        for ends in line.windows(2) {
            let meets = self.meets(ends[0], ends[1]);
            match runs.last_mut().filter(|_| is_open) {
                Some(run) if meets => run.push(ends[1]),
                None if meets => runs.push(ends.to_vec()),
                _ => {}
            }
            is_open = meets;
        }
        let is_ring = line.len() > 3 && line.first() == line.last();
        if is_ring
            && is_open
            && runs.len() > 1
            && runs[0].first() == line.first()
            && let Some(mut last) = runs.pop()
        {
            last.extend(&runs[0][1..]);
            runs[0] = last;
        }
        runs
    }
}
