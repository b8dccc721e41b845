//! How far break lines run from each other.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Line};
use rstar::{PointDistance, RTree};

use super::BreakLine;
use crate::base::parallel;

/// Lines nearer than this to each other count as one line that was drawn twice, as a share of the largest distance asked
/// for. With two nodes per distance, it is a quarter of a cell: cells of this size do not show the ground between.
const SAME: f64 = 0.125;

/// The median distance from surveyed break lines to the nearest other one beside them, map units, at most `most`. Each
/// piece of a line counts with its length. Lines that go on where another one ends do not run beside it.
pub(crate) fn spacing(lines: &[BreakLine], most: f64) -> f64 {
    let of_line = |(number, line): (u32, &BreakLine)| {
        let segments = line.points.windows(2).map(|w| Line::new(w[0].to_array(), w[1].to_array()));
        segments.map(|segment| GeomWithData::new(segment, number)).collect::<Vec<_>>()
    };
    let surveyed = (0..).zip(lines).filter(|(_, line)| !line.heights.is_empty());
    let segments: Vec<GeomWithData<Line<[f64; 2]>, u32>> = surveyed.flat_map(of_line).collect();
    let tree = RTree::bulk_load(segments.clone());
    let mut found: Vec<(f64, f64)> = parallel::map_each(&segments, |own| {
        let [a, b] = ends(own.geom());
        let middle = (a + b) / 2.0;
        let near = tree.locate_within_distance(middle.to_array(), most * most);
        let beside = near.filter(|other| other.data != own.data && is_beside(middle, other.geom()));
        let squares = beside.map(|other| other.distance_2(&middle.to_array()));
        let square = squares.filter(|square| *square > (SAME * most).powi(2)).fold(most * most, f64::min);
        (square.sqrt(), a.distance(b))
    });
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = found.iter().map(|(_, length)| length).sum();
    let mut before = 0.0;
    let median = found.iter().find(|(_, length)| {
        before += length;
        2.0 * before >= whole
    });
    median.map_or(most, |(distance, _)| *distance)
}

/// Whether the nearest point of a segment is none of its ends.
fn is_beside(p: DVec2, segment: &Line<[f64; 2]>) -> bool {
    let [a, b] = ends(segment);
    let along = (p - a).dot(b - a);
    0.0 < along && along < a.distance_squared(b)
}

fn ends(segment: &Line<[f64; 2]>) -> [DVec2; 2] {
    [segment.from, segment.to].map(DVec2::from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::break_lines::Bend;

    fn line(points: &[(f64, f64)], heights: &[f64]) -> BreakLine {
        let points = points.iter().map(|p| DVec2::from(*p)).collect();
        BreakLine { points, heights: heights.to_vec(), bend: Bend::Either, feature: 1.into() }
    }

    #[test]
    fn lines_side_by_side_count_and_pieces_of_one_line_do_not() {
        let side = |y: f64| line(&[(0.0, y), (40.0, y), (100.0, y)], &[5.0; 3]);
        assert!((spacing(&[side(0.0), side(1.5), side(4.0)], 10.0) - 1.5).abs() < 1e-12);
        assert_eq!(spacing(&[side(0.0), side(1.5)], 1.0), 1.0);
        assert_eq!(spacing(&[side(0.0)], 10.0), 10.0);
        assert_eq!(spacing(&[], 10.0), 10.0);
        // A line in many features, drawn without gaps.
        let pieces: Vec<BreakLine> =
            (0..50).map(|k| line(&[(f64::from(k), 0.0), (f64::from(k + 1), 0.0)], &[5.0; 2])).collect();
        assert_eq!(spacing(&pieces, 10.0), 10.0);
        assert_eq!(spacing(&[side(0.0), side(0.0)], 10.0), 10.0);
        assert_eq!(spacing(&[side(0.0), side(0.5), side(6.0)], 10.0), 5.5);
        // What has no heights is not surveyed.
        assert_eq!(spacing(&[side(0.0), line(&[(0.0, 1.0), (100.0, 1.0)], &[])], 10.0), 10.0);
        // Most of the length decides.
        let short = line(&[(0.0, 0.5), (20.0, 0.5)], &[5.0; 2]);
        assert_eq!(spacing(&[side(0.0), short], 10.0), 10.0);
    }
}
