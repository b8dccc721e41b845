//! Positions as keys of hash maps and sets.

use glam::DVec2;

/// The bits of a position's coordinates. Equal positions have equal bits: −0 becomes 0.
pub fn bits(p: DVec2) -> [u64; 2] {
    (p + 0.0).to_array().map(f64::to_bits)
}
