//! Heights that fall along a network, with changes as small upstream as downstream.

use std::collections::HashMap;

use super::line::Ends;

/// Makes heights along streams fall: each becomes the mean of the lowest one upstream and the highest one downstream, neither
/// of which ever rises. Heights that are NaN do not count. `ends` says where each stream begins and ends. The streams come
/// in an order in which each one follows those that flow into it.
pub(super) fn fall(ends: &[Option<Ends>], heights: &mut [Vec<f64>]) {
    // The lowest height above each end, and the highest one below each start.
    let mut above: HashMap<[u64; 2], f64> = HashMap::new();
    let mut lowest: Vec<Vec<f64>> = Vec::with_capacity(heights.len());
    for (ends, heights) in ends.iter().zip(&*heights) {
        let mut least = ends.and_then(|[first, _]| above.get(&first).copied()).unwrap_or(f64::INFINITY);
        let lowered = heights.iter().map(|z| {
            least = least.min(*z);
            least
        });
        lowest.push(lowered.collect());
        if let Some([_, last]) = ends {
            let at = above.entry(*last).or_insert(f64::INFINITY);
            *at = at.min(least);
        }
    }
    let mut below: HashMap<[u64; 2], f64> = HashMap::new();
    for ((ends, heights), lowest) in ends.iter().zip(heights).zip(&lowest).rev() {
        let mut most = ends.and_then(|[_, last]| below.get(&last).copied()).unwrap_or(f64::NEG_INFINITY);
        for (z, least) in heights.iter_mut().zip(lowest).rev() {
            most = most.max(*z);
            *z = most.midpoint(*least);
        }
        if let Some([first, _]) = ends {
            let at = below.entry(*first).or_insert(f64::NEG_INFINITY);
            *at = at.max(most);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_fall_through_confluences_and_those_that_fall_already_stay() {
        let [west, east, meet, mouth] = [[0, 2], [2, 2], [1, 1], [1, 0]];
        let ends = [Some([west, meet]), Some([east, meet]), Some([meet, mouth])];
        let mut falling = vec![vec![9.0, 8.0, 5.0], vec![7.0, 5.0], vec![5.0, 4.0, 1.0]];
        let before = falling.clone();
        fall(&ends, &mut falling);
        assert_eq!(falling, before);
        // A dam of 8 m below the confluence, and a place without height.
        let mut dammed = vec![vec![9.0, f64::NAN, 5.0], vec![7.0, 5.0], vec![5.0, 8.0, 1.0]];
        fall(&ends, &mut dammed);
        assert_eq!([dammed[0][0], dammed[0][2]], [9.0, 6.5]);
        assert_eq!(dammed[1..], [vec![7.5, 6.5], vec![6.5, 6.5, 1.0]]);
    }
}
