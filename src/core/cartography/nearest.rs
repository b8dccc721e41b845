//! How far it is to the nearest contour of each level.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, PointDistance, RTree};

use crate::base::parallel;
use crate::contour::ContourLine;
use crate::geometry::{Bounds, Segment, distance};

type Piece = GeomWithData<Line<[f64; 2]>, u32>;

/// Trees of the segments of some contours, one for each of their levels. One tree for all would be several times slower, because
/// the nearest contour is mostly of another level.
pub(super) struct Nearest {
    /// Ascending.
    levels: Vec<f64>,
    trees: Vec<RTree<Piece>>,
}

/// The nearest contour of a level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neighbour {
    /// Its distance, metres.
    pub distance: f64,
    /// The number of the line.
    pub line: u32,
}

impl Nearest {
    /// Of the lines with these numbers; `metres` is the length of a map unit in both directions.
    pub fn new(lines: &[ContourLine], numbers: &[u32], metres: DVec2) -> Self {
        let mut sorted: Vec<u32> = numbers.to_vec();
        let level = |number: &u32| lines[*number as usize].elevation;
        sorted.sort_by(|a, b| level(a).total_cmp(&level(b)));
        let groups: Vec<&[u32]> = sorted.chunk_by(|a, b| level(a) == level(b)).collect();
        let trees = parallel::map_each(&groups, |numbers| {
            let pieces = numbers.iter().flat_map(|&number| {
                let points = &lines[number as usize].points;
                points.windows(2).map(move |pair| segment([pair[0], pair[1]].map(|p| p * metres), number))
            });
            RTree::bulk_load(pieces.collect())
        });
        Self { levels: groups.iter().map(|numbers| level(&numbers[0])).collect(), trees }
    }

    /// The nearest contour of the next level below a height, and of the next one above it. None if no contour has such a level.
    pub fn beside(&self, place: DVec2, height: f64) -> [Option<Neighbour>; 2] {
        self.numbers_beside(height).map(|k| {
            let tree = self.trees.get(k?)?;
            nearest(tree, place)
        })
    }

    /// For each segment of a line: whether a contour of the two levels below or above it is closer than a distance, metres. The next
    /// level alone would not do: on steep slopes it may be left out.
    pub fn close(&self, line: &ContourLine, closest: f64, metres: DVec2) -> Vec<bool> {
        let below = self.levels.partition_point(|level| *level < line.elevation);
        let above = self.levels.partition_point(|level| *level <= line.elevation);
        let last = (above + 2).min(self.trees.len());
        let trees = [&self.trees[below.saturating_sub(2)..below], &self.trees[above..last]];
        let is_close = |pair: &[DVec2]| {
            let own = Segment { a: pair[0] * metres, b: pair[1] * metres };
            let Bounds { min, max } = own.bounds().grown(closest);
            let near = AABB::from_corners(min.to_array(), max.to_array());
            let other = |piece: &Piece| {
                let Line { from, to } = *piece.geom();
                Segment { a: from.into(), b: to.into() }
            };
            let mut found = trees.into_iter().flatten().flat_map(|tree| tree.locate_in_envelope_intersecting(&near));
            found.any(|piece| distance(&own, &other(piece)) < closest)
        };
        line.points.windows(2).map(is_close).collect()
    }

    /// The numbers of the next level below a height, and of the next one above it, in the list of levels.
    fn numbers_beside(&self, height: f64) -> [Option<usize>; 2] {
        let below = self.levels.partition_point(|level| *level < height).checked_sub(1);
        let above = self.levels.partition_point(|level| *level <= height);
        [below, Some(above)]
    }
}

fn nearest(tree: &RTree<Piece>, place: DVec2) -> Option<Neighbour> {
    let place = place.to_array();
    let found = tree.nearest_neighbor(&place)?;
    Some(Neighbour { distance: found.distance_2(&place).sqrt(), line: found.data })
}

fn segment([a, b]: [DVec2; 2], number: u32) -> Piece {
    GeomWithData::new(Line::new(a.to_array(), b.to_array()), number)
}

/// The border of the ground that is known. Beyond it, nobody knows where the next contour is.
pub(super) struct Edge(RTree<Piece>);

impl Edge {
    /// Of rings that repeat their first point, map units.
    pub fn new(rings: &[Vec<DVec2>], metres: DVec2) -> Self {
        let pieces =
            rings.iter().flat_map(|ring| ring.windows(2).map(|p| segment([p[0], p[1]].map(|p| p * metres), 0)));
        Self(RTree::bulk_load(pieces.collect()))
    }

    /// The distance to it, metres; infinite if there is none.
    pub fn distance(&self, place: DVec2) -> f64 {
        nearest(&self.0, place).map_or(f64::INFINITY, |found| found.distance)
    }
}
