//! The number of decimals in the heights of a height map.

use serde::Serialize;

/// The step that all heights of a height map are multiples of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// Whole metres.
    WholeMetres,
    /// Tenths of a metre.
    Tenths,
}

impl Precision {
    /// The step, metres.
    pub fn step(self) -> f64 {
        match self {
            Self::WholeMetres => 1.0,
            Self::Tenths => 0.1,
        }
    }

    /// The decimal number that a height in single precision stands for.
    pub(super) fn decimal(self, height: f32) -> f64 {
        match self {
            Self::WholeMetres => height.into(),
            Self::Tenths => (f64::from(height) * 10.0).round() / 10.0,
        }
    }
}

/// The step that all heights are multiples of. `None` if it is finer than tenths, or if there are no heights.
pub fn precision(heights: &[f32]) -> Option<Precision> {
    let mut decimals = Decimals::default();
    decimals.add(heights);
    decimals.precision()
}

/// The decimals of the heights that were looked at.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Decimals {
    is_any: bool,
    beyond_whole: bool,
    beyond_tenths: bool,
}

impl Decimals {
    /// Looks at heights.
    pub fn add(&mut self, heights: &[f32]) {
        let all = |test: fn(f32) -> bool| heights.iter().all(|&h| !h.is_finite() || test(h));
        self.is_any |= heights.iter().any(|h| h.is_finite());
        self.beyond_whole |= !all(|h| h == h.round());
        self.beyond_tenths |= self.beyond_whole && !all(|h| h == Precision::Tenths.decimal(h) as f32);
    }

    /// The step that all of them are multiples of.
    pub fn precision(self) -> Option<Precision> {
        match self {
            Self { is_any: false, .. } => None,
            Self { beyond_whole: false, .. } => Some(Precision::WholeMetres),
            Self { beyond_tenths: false, .. } => Some(Precision::Tenths),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_seen_through_single_precision() {
        assert_eq!(precision(&[1.0, f32::NAN, -3.0, 2999.0]), Some(Precision::WholeMetres));
        assert_eq!(precision(&[1.0, 1234.1, -0.3, 2999.9]), Some(Precision::Tenths));
        assert_eq!(precision(&[1.0, 1234.15]), None);
        assert_eq!(precision(&[0.1 + 1e-4]), None);
        assert_eq!(precision(&[f32::NAN]), None);
        assert_eq!(precision(&[]), None);
    }
}
