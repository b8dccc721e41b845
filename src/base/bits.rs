//! Positions as keys of maps and sets.

use glam::DVec2;

/// A position's bits: the same for equal positions, the two zeros being equal.
pub(crate) fn bits(p: DVec2) -> [u64; 2] {
    (p + 0.0).to_array().map(f64::to_bits)
}
