//! Levels: the elevations that lines are drawn at.

/// The vertical interval: levels are `base + k * step`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval { /// Step.
pub step: f64, /// Base.
pub base: f64 }
impl Interval {
    /// Next level strictly above.
    pub fn next_above(&self, z: f64) -> f64 { let k = ((z - self.base) / self.step + 1e-9).floor() + 1.0; self.base + k * self.step }
    /// Next level strictly below.
    pub fn next_below(&self, z: f64) -> f64 { let k = ((z - self.base) / self.step - 1e-9).ceil() - 1.0; self.base + k * self.step }
}

/// TEMP
pub fn find_interval(contours: &[super::Contour]) -> Option<Interval> {
    let mut l: Vec<f64> = contours.iter().map(|c| c.elevation).collect();
    l.sort_by(f64::total_cmp); l.dedup();
    let step = l.windows(2).map(|w| w[1]-w[0]).fold(f64::INFINITY, f64::min);
    step.is_finite().then_some(Interval { step, base: 0.0 })
}
