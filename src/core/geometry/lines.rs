//! Segments with an index for distances from places. It bears long segments side by side, whose upright boxes would all meet.

use glam::DVec2;
use rstar::PointDistance;
use rstar::primitives::Line;

use super::{BoxTree, OrientedBox};
use crate::base::parallel;

/// Segments and the tree of the boxes around them.
#[derive(Debug)]
pub struct LineTree {
    lines: Vec<Line<[f64; 2]>>,
    boxes: BoxTree,
}

impl LineTree {
    /// Takes segments, each by its ends.
    pub fn new(ends: impl Iterator<Item = [DVec2; 2]>) -> Self {
        let ends: Vec<[DVec2; 2]> = ends.collect();
        let boxes = BoxTree::new(&parallel::map_each(&ends, |ends| OrientedBox::around(ends)));
        let lines = ends.into_iter().map(|[a, b]| Line::new(a.to_array(), b.to_array())).collect();
        Self { lines, boxes }
    }

    /// The nearest segment, with the square of its distance. Of several, it is the first.
    pub fn nearest(&self, p: DVec2) -> Option<(f64, &Line<[f64; 2]>)> {
        let mut best = (f64::INFINITY, u32::MAX);
        for (number, least) in self.boxes.nearest_first(p) {
            if least * least > best.0 {
                break;
            }
            let found = (self.lines[number as usize].distance_2(&p.to_array()), number);
            best = if found < best { found } else { best };
        }
        self.lines.get(best.1 as usize).map(|line| (best.0, line))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_of_all_is_found() {
        let spoke = |k: u32| {
            let way = DVec2::from_angle(f64::from(k) * 0.01);
            [way * 50.0, way * (90.0 + f64::from(k % 7))]
        };
        let tree = LineTree::new((0..628).map(spoke));
        for k in 0..300 {
            let p = DVec2::from_angle(f64::from(k) * 0.7) * f64::from(k % 150);
            let distances = tree.lines.iter().map(|line| line.distance_2(&p.to_array()));
            assert_eq!(tree.nearest(p).map(|n| n.0), distances.min_by(f64::total_cmp));
        }
        assert!(LineTree::new(std::iter::empty()).nearest(DVec2::ZERO).is_none());
    }
}
