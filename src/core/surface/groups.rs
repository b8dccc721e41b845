//! Groups of ground that lie far from each other, such as islands. One working grid over all of them would be too coarse, so
//! each gets its own.

use geo::{BoundingRect, MultiPolygon, Rect};
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::params::SurfaceParams;
use crate::base::Grid;
use crate::base::union_find::UnionFind;
use crate::break_lines::{self, BreakLine};
use crate::contour::ContourMap;
use crate::spline::{coarser_than_asked, finer_grid, working_grid};
use crate::subdivision::Subdivision;
use crate::subdomains::{Frame, FrameRing, MapExtent};
use crate::tuning::BreakLineTuning;

/// Polygons of the frame nearer than this many mean spacings of the contours are one group.
const NEAR: f64 = 10.0;
/// Most groups. With more, polygons further apart are one group.
const MOST: usize = 50;

/// A group: some polygons of the frame, whose box holds no other group.
struct Group {
    lo: DVec2,
    hi: DVec2,
    frame: FrameRing,
    /// Number of vertices of its contours.
    vertices: usize,
}

impl Group {
    fn holds(&self, p: DVec2) -> bool {
        p.cmpge(self.lo).all() && p.cmple(self.hi).all()
    }

    /// The contours and spot heights of the group.
    fn part(&self, map: &ContourMap) -> ContourMap {
        let is_here = |points: &[DVec2]| points.first().is_some_and(|p| self.holds(*p));
        ContourMap {
            contours: map.contours.iter().filter(|line| is_here(&line.points)).cloned().collect(),
            spots: map.spots.iter().filter(|spot| self.holds(spot.truncate())).copied().collect(),
            mended: map.mended.iter().filter(|p| self.holds(**p)).copied().collect(),
            ..ContourMap::default()
        }
    }
}

/// The groups of a map.
pub(crate) struct Groups {
    /// In the order of the frame's polygons. Empty where one working grid is fine enough for the whole map.
    groups: Vec<Group>,
}

impl Groups {
    /// Divides a map into groups if one working grid would be coarser than its contours ask for.
    pub fn new(extent: &MapExtent<'_>, params: &SurfaceParams) -> Self {
        let wanted = params.spline.wanted;
        if params.whole.is_some()
            || extent.frame.area.0.len() < 2
            || coarser_than_asked(extent, wanted, &params.tuning.spline.grid).is_none()
        {
            return Self { groups: Vec::new() };
        }
        let boxes: Vec<Rect<f64>> = extent.frame.area.iter().filter_map(BoundingRect::bounding_rect).collect();
        let mut margin = NEAR * extent.spacing;
        let mut sets = apart(&boxes, margin);
        while sets.len() > MOST {
            margin *= 2.0;
            sets = apart(&boxes, margin);
        }
        let mut groups: Vec<Group> = sets
            .into_iter()
            .map(|(members, [lo, hi])| {
                let area = MultiPolygon(members.into_iter().map(|k| extent.frame.area.0[k].clone()).collect());
                Group { lo, hi, frame: FrameRing { area }, vertices: 0 }
            })
            .collect();
        for line in &extent.map.contours {
            let here = line.points.first().and_then(|p| groups.iter_mut().find(|group| group.holds(*p)));
            here.into_iter().for_each(|group| group.vertices += line.points.len());
        }
        // Ground without contours has no heights.
        groups.retain(|group| group.vertices > 0);
        if groups.len() < 2 {
            groups.clear();
        }
        Self { groups }
    }

    /// The frame and the map that hyper-parameters and errors are learnt on, if not on the whole map: the group with most
    /// vertices. The others would only show how coarse a grid over all of them is.
    pub fn largest(&self) -> Option<Largest<'_>> {
        let group = self.groups.iter().rev().max_by_key(|group| group.vertices)?;
        Some(Largest { group, frame: Frame::Outline(group.frame.area.clone()) })
    }

    /// The groups by themselves; the whole map where there are none.
    pub fn extents<T>(&self, subdivision: &Subdivision, mut each: impl FnMut(&MapExtent<'_>) -> T) -> Vec<T> {
        if self.groups.is_empty() {
            return vec![each(&subdivision.extent())];
        }
        let of =
            |group: &Group| each(&MapExtent::new(&group.part(&subdivision.map), &group.frame, subdivision.interval));
        self.groups.iter().map(of).collect()
    }

    /// The working grids. Their nodes are close enough for the contours, and for break lines that run beside each other.
    pub fn grids(&self, subdivision: &Subdivision, break_lines: &[BreakLine], params: &SurfaceParams) -> Vec<Grid> {
        if let Some(whole) = &params.whole {
            let (lo, hi) = subdivision.frame.extent();
            return vec![whole.grid_of([lo, hi])];
        }
        self.extents(subdivision, |extent| {
            node_grid(
                working_grid(extent, params.spline.wanted, &params.tuning.spline.grid),
                break_lines,
                &params.tuning.break_lines,
            )
        })
    }

    /// The items of each group, by their places. Items elsewhere, and those without a place, belong to the first group.
    pub fn shared<T>(&self, items: impl IntoIterator<Item = T>, place: impl Fn(&T) -> Option<DVec2>) -> Vec<Vec<T>> {
        let mut shares: Vec<Vec<T>> = (0..self.groups.len().max(1)).map(|_| Vec::new()).collect();
        for item in items {
            let at = place(&item).and_then(|p| self.groups.iter().position(|group| group.holds(p)));
            shares[at.unwrap_or(0)].push(item);
        }
        shares
    }
}

/// A working grid whose nodes are close enough for break lines that run beside each other, too.
pub(super) fn node_grid(grid: Grid, break_lines: &[BreakLine], tuning: &BreakLineTuning) -> Grid {
    let wanted = tuning.nodes_per_line_spacing * (grid.cell.x * grid.cell.y).sqrt();
    finer_grid(&grid, wanted / break_lines::spacing(break_lines, wanted))
}

/// The group of a map with most vertices.
pub(crate) struct Largest<'a> {
    group: &'a Group,
    /// What its trials are framed with.
    pub frame: Frame,
}

impl Largest<'_> {
    /// Its part of a map.
    pub fn part(&self, map: &ContourMap) -> ContourMap {
        self.group.part(map)
    }

    /// Its outline as a frame.
    pub fn ring(&self) -> &FrameRing {
        &self.group.frame
    }
}

/// Unites boxes that are nearer to each other than `margin`, until no two united boxes are. Gives the numbers of the boxes
/// in each set, and the box around them.
fn apart(boxes: &[Rect<f64>], margin: f64) -> Vec<(Vec<usize>, [DVec2; 2])> {
    let corners = |r: &Rect<f64>| [DVec2::new(r.min().x, r.min().y), DVec2::new(r.max().x, r.max().y)];
    let mut sets: Vec<(Vec<usize>, [DVec2; 2])> = (0..).zip(boxes).map(|(k, r)| (vec![k], corners(r))).collect();
    loop {
        let placed = sets
            .iter()
            .enumerate()
            .map(|(k, (_, [lo, hi]))| GeomWithData::new(Rectangle::from_corners(lo.to_array(), hi.to_array()), k));
        let tree = RTree::bulk_load(placed.collect());
        let mut united = UnionFind::new(sets.len());
        let mut any = false;
        for (k, (_, [lo, hi])) in sets.iter().enumerate() {
            let around = AABB::from_corners((*lo - margin).to_array(), (*hi + margin).to_array());
            for near in tree.locate_in_envelope_intersecting(&around) {
                any |= united.unite(k, near.data);
            }
        }
        if !any {
            return sets;
        }
        let mut merged: Vec<(Vec<usize>, [DVec2; 2])> = Vec::new();
        let mut number = std::collections::HashMap::new();
        for (k, (members, [lo, hi])) in sets.into_iter().enumerate() {
            let set = *number.entry(united.root(k)).or_insert_with(|| {
                merged.push((Vec::new(), [DVec2::INFINITY, DVec2::NEG_INFINITY]));
                merged.len() - 1
            });
            let (all, [least, most]) = &mut merged[set];
            all.extend(members);
            (*least, *most) = (least.min(lo), most.max(hi));
        }
        sets = merged;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_that_come_near_when_united_are_one_set() {
        let square = |x: f64, y: f64, side: f64| Rect::new((x, y), (x + side, y + side));
        // The first two come near each other. Only their common box comes near the third.
        let boxes = [square(0.0, 0.0, 10.0), square(12.0, 40.0, 10.0), square(11.0, 0.0, 1.0), square(500.0, 0.0, 1.0)];
        let sets = |margin: f64| -> Vec<Vec<usize>> {
            let numbers = apart(&boxes, margin).into_iter().map(|(mut members, _)| {
                members.sort_unstable();
                members
            });
            numbers.collect()
        };
        assert_eq!(sets(0.5), [vec![0], vec![1], vec![2], vec![3]]);
        assert_eq!(sets(2.0), [vec![0, 2], vec![1], vec![3]]);
        assert_eq!(sets(31.0), [vec![0, 1, 2], vec![3]]);
        assert_eq!(sets(1e3).len(), 1);
    }
}
