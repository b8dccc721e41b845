//! Places along a Hilbert curve: those that follow each other are close to each other.

/// Bits of each coordinate.
const BITS: u32 = 16;

/// The number of a place along the curve through a square of 65536 x 65536 cells.
pub(super) fn number(mut x: u32, mut y: u32) -> u32 {
    let mut number = 0;
    for bit in (0..BITS).rev() {
        let side = 1 << bit;
        let (right, upper) = (x >> bit & 1, y >> bit & 1);
        number += side * side * ((3 * right) ^ upper);
        // The quarter is turned, so that the curve goes on in it.
        if upper == 0 {
            if right == 1 {
                (x, y) = ((side - 1).wrapping_sub(x), (side - 1).wrapping_sub(y));
            }
            (x, y) = (y, x);
        }
        (x, y) = (x & (side - 1), y & (side - 1));
    }
    number
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn followers_are_neighbours() {
        let mut cells: Vec<(u32, u32, u32)> =
            (0..64).flat_map(|x| (0..64).map(move |y| (number(x, y), x, y))).collect();
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let [(a, ax, ay), (b, bx, by)] = [pair[0], pair[1]];
            assert_eq!((b - a, ax.abs_diff(bx) + ay.abs_diff(by)), (1, 1), "{pair:?}");
        }
        assert!(number(65535, 65535) > number(0, 0));
    }
}
