//! The elevation tint of pictures and styles.

/// The tint from the lowest to the highest ground: the higher the lighter and warmer, as mountains are seen from above
/// through the air. Evenly spaced.
pub const TINT: [[u8; 3]; 7] = [
    [158, 192, 158],
    [182, 206, 162],
    [208, 219, 172],
    [229, 225, 184],
    [237, 224, 194],
    [244, 232, 214],
    [252, 249, 243],
];
