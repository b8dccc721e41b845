//! Nodes beside contours.

/// Whether a contour passes between a node and one of its four neighbours.
pub fn is_at_contour(floor: &[f32], n: usize, cols: usize) -> bool {
    let differs = |m: usize| floor.get(m).is_some_and(|f| !f.is_nan() && *f != floor[n]);
    let (has_west, has_east) = (!n.is_multiple_of(cols), !(n + 1).is_multiple_of(cols));
    !floor[n].is_nan()
        && ((has_west && differs(n - 1))
            || (has_east && differs(n + 1))
            || (n >= cols && differs(n - cols))
            || differs(n + cols))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_outside_the_frame_are_no_contours() {
        let floor = [f32::NAN, 1.0, 1.0, 2.0, 2.0, f32::NAN];
        let found: Vec<bool> = (0..6).map(|n| is_at_contour(&floor, n, 6)).collect();
        assert_eq!(found, [false, false, true, true, false, false]);
        // The last node of a row and the first of the next are no neighbours.
        let columns: Vec<bool> = (0..6).map(|n| is_at_contour(&[1.0, 1.0, 2.0, 1.0, 1.0, 2.0], n, 3)).collect();
        assert_eq!(columns, [false, true, true, false, true, true]);
    }
}
