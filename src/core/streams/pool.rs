//! Heights that never rise along a network, and that are as near to given ones as possible.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::tin::NONE;

/// Replaces heights by those of least squared change that never rise downstream (isotonic regression on a tree: Pardalos and
/// Xue 1999, Algorithmica 23). Where given heights rise, the nodes are pooled: all get the mean.
///
/// `below` is the node that each one flows into, [`NONE`] for outlets. Nodes in a circle, and those below one, stay.
pub(super) fn pool(heights: &mut [f64], below: &[u32]) {
    let mut waiting = vec![0; heights.len()];
    below.iter().filter(|n| **n != NONE).for_each(|n| waiting[*n as usize] += 1);
    let mut pools: Vec<Pool> = heights.iter().map(|z| Pool::of(*z)).collect();
    // Each node after those that flow into it.
    let mut order: Vec<u32> = (0..heights.len() as u32).filter(|n| waiting[*n as usize] == 0).collect();
    let mut joined = vec![NONE; heights.len()];
    let mut next = 0;
    while let Some(&node) = order.get(next) {
        next += 1;
        let mut own = std::mem::replace(&mut pools[node as usize], Pool::of(f64::NAN));
        while own.above.peek().is_some_and(|upper| upper.height < own.height())
            && let Some(Upper { node: upper, .. }) = own.above.pop()
        {
            joined[upper as usize] = node;
            own.join(std::mem::replace(&mut pools[upper as usize], Pool::of(f64::NAN)));
        }
        let out = below[node as usize];
        if out != NONE {
            pools[out as usize].above.push(Upper { height: own.height(), node });
            waiting[out as usize] -= 1;
            if waiting[out as usize] == 0 {
                order.push(out);
            }
        }
        pools[node as usize] = own;
    }
    // A node has the height of the pool that its own has joined. That one came later.
    for &node in order.iter().rev() {
        let [node, into] = [node, joined[node as usize]].map(|n| n as usize);
        heights[node] = if into == NONE as usize { pools[node].height() } else { heights[into] };
    }
}

/// Nodes that get one height.
struct Pool {
    sum: f64,
    count: f64,
    /// The lowest and the highest of the given heights.
    range: [f64; 2],
    /// The pools directly upstream.
    above: BinaryHeap<Upper>,
}

impl Pool {
    fn of(z: f64) -> Self {
        Self { sum: z, count: 1.0, range: [z; 2], above: BinaryHeap::new() }
    }

    /// The mean. Rounding leads to no height outside the given ones.
    fn height(&self) -> f64 {
        let [lo, hi] = self.range;
        (self.sum / self.count).max(lo).min(hi)
    }

    fn join(&mut self, mut upper: Self) {
        self.sum += upper.sum;
        self.count += upper.count;
        self.range = [self.range[0].min(upper.range[0]), self.range[1].max(upper.range[1])];
        self.above.append(&mut upper.above);
    }
}

/// A pool directly upstream of another one, by the lowest of its nodes.
#[derive(PartialEq)]
struct Upper {
    height: f64,
    node: u32,
}

impl Eq for Upper {}

impl Ord for Upper {
    /// The lowest one is the greatest, so that a heap has it on top.
    fn cmp(&self, other: &Self) -> Ordering {
        other.height.total_cmp(&self.height).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Upper {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pooled(heights: &[f64], below: &[u32]) -> Vec<f64> {
        let mut pooled = heights.to_vec();
        pool(&mut pooled, below);
        pooled
    }

    #[test]
    fn a_dip_takes_no_more_than_its_surroundings_with_it() {
        // One low place in a long level reach would lower all below it to the mean of both, if only extremes counted.
        let below: Vec<u32> = (1..=100).chain([NONE]).collect();
        let mut heights = vec![50.0; 101];
        heights[20] = 10.0;
        let found = pooled(&heights, &below);
        assert!(found[..20].iter().all(|z| *z == 50.0));
        assert!(found[20..].iter().all(|z| *z > 49.0 && *z < 50.0), "{found:?}");
    }

    #[test]
    fn a_side_stream_that_is_too_low_is_pooled_with_what_is_below_it() {
        // 0 and 1 flow into 2, which flows into 3.
        let below = [2, 2, 3, NONE];
        assert_eq!(pooled(&[9.0, 2.0, 6.0, 1.0], &below), [9.0, 4.0, 4.0, 1.0]);
        assert_eq!(pooled(&[4.0, 2.0, 6.0, 7.0], &below), [4.75; 4]);
        // Nothing to do.
        assert_eq!(pooled(&[9.1, 8.2, 7.3, 7.3], &below), [9.1, 8.2, 7.3, 7.3]);
    }

    #[test]
    fn circles_stay() {
        assert_eq!(pooled(&[1.0, 2.0, 3.0, 0.0], &[1, 2, 0, 2]), [1.0, 2.0, 3.0, 0.0]);
        assert!(pooled(&[], &[]).is_empty());
    }

    proptest! {
        /// Of all heights that never rise, those found are nearest to the given ones. That is so if no set of nodes that holds
        /// all above its own can be raised with gain, and no pool can be moved with gain.
        #[test]
        fn no_other_heights_that_fall_are_nearer(
            given in proptest::collection::vec(-20i32..20, 1..40),
            parents in proptest::collection::vec(0.0f64..1.0, 40),
            drawn in proptest::collection::vec(proptest::bool::weighted(0.3), 40),
        ) {
            let count = given.len();
            let heights: Vec<f64> = given.into_iter().map(f64::from).collect();
            // Each node flows into a later one; some into none.
            let below: Vec<u32> = (0..count).map(|n| {
                let at = n + 1 + (parents[n] * (count - n) as f64) as usize;
                if at < count { at as u32 } else { NONE }
            }).collect();
            let found = pooled(&heights, &below);
            let out = |n: usize| (below[n] != NONE).then_some(below[n] as usize);
            for n in 0..count {
                prop_assert!(out(n).is_none_or(|out| found[n] >= found[out] - 1e-9));
            }
            let change = |n: usize| found[n] - heights[n];
            for n in 0..count {
                let pool: f64 = (0..count).filter(|k| found[*k] == found[n]).map(change).sum();
                prop_assert!(pool.abs() < 1e-9, "{pool}");
            }
            // What flows through one of the drawn nodes; for each single node too.
            let set = |is_drawn: &dyn Fn(usize) -> bool| {
                let flows = |n: usize| std::iter::successors(Some(n), |n| out(*n)).any(is_drawn);
                (0..count).filter(|n| flows(*n)).map(change).sum::<f64>()
            };
            prop_assert!(set(&|n| drawn[n]) > -1e-9);
            for k in 0..count {
                prop_assert!(set(&|n| n == k) > -1e-9);
            }
        }
    }
}
