//! Heights of axis points: equation (1) of the paper between two levels, a rounded top where there is only one.

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::sync::{LazyLock, OnceLock};

use glam::DVec2;

use super::border_levels::{BorderLevels, NearLevel};
use super::caps::Cap;
use super::glimpse::Glimpse;
use super::pieces::AxisPoint;
use crate::base::parallel;
use crate::base::rows::Rows;
use crate::subdomains::{Region, Regions, Side, band_of};
use crate::tin::{Tin, VertexKind};
use crate::tuning::SkeletonTuning;

/// Places per parallel task. The search for the first triangle starts anew with each task.
const CHUNK: usize = 1024;

/// Heights of points inside sub-domains.
///
/// Between two levels the height is equation (1), `h = (h_l d_u + d_l h_u) / (d_u + d_l)`. The distances are the
/// shortest ones to visible contour segments on the border of the point's own sub-domain. Where the border has no level
/// on the side of the ground, the height rises (or falls) as described at [`Cap`]. Every height lies strictly inside
/// its band. It is NaN where no contour borders the sub-domain.
pub fn axis_heights(tin: &Tin, regions: &Regions, points: &[AxisPoint], tuning: &SkeletonTuning) -> Vec<f64> {
    if points.is_empty() {
        return Vec::new();
    }
    let mut is_asked = vec![false; regions.regions.len()];
    points.iter().for_each(|p| is_asked[p.region as usize] = true);
    let contents = Contents::new(tin, regions, |region| is_asked[region]);
    let levels = |region: usize| BorderLevels::new(tin, contents.borders.of(region));
    heights_in((tin, regions, &contents), levels, points, tuning)
}

/// Gives heights at places in sub-domains. The border of a sub-domain is indexed once, when a place in it is first asked
/// for.
pub(crate) struct Heights<'a> {
    pub(super) tin: &'a Tin,
    pub(super) regions: &'a Regions,
    contents: Contents,
    levels: Vec<OnceLock<BorderLevels>>,
}

impl<'a> Heights<'a> {
    /// Prepares the sub-domains of a triangulation.
    pub fn new(tin: &'a Tin, regions: &'a Regions) -> Self {
        let levels = regions.regions.iter().map(|_| OnceLock::new()).collect();
        Self { tin, regions, contents: Contents::new(tin, regions, |_| true), levels }
    }

    /// Heights by equation (1) at places in sub-domains, as [`axis_heights`]; NaN without a place. Where no contour gives
    /// a height, it is the middle of the band.
    pub fn at(&self, places: &[Option<(DVec2, u32)>]) -> Vec<f64> {
        let given: Vec<(usize, (DVec2, u32))> =
            places.iter().enumerate().filter_map(|(k, place)| Some((k, (*place)?))).collect();
        let chunks: Vec<&[(usize, (DVec2, u32))]> = given.chunks(CHUNK).collect();
        let found: Vec<(usize, AxisPoint)> = parallel::flat_map_each(&chunks, |chunk| {
            let mut near = 0;
            let point = |&(k, (position, region)): &(usize, (DVec2, u32))| {
                near = self.tin.walk(near, position).ok()?;
                Some((k, AxisPoint { position, level: None, triangle: near, region }))
            };
            chunk.iter().filter_map(point).collect::<Vec<_>>()
        });
        let (number, points): (Vec<usize>, Vec<AxisPoint>) = found.into_iter().unzip();
        let found = self.of_points(&points, &SkeletonTuning::default());
        let mut heights = vec![f64::NAN; places.len()];
        for ((k, z), point) in number.into_iter().zip(found).zip(&points) {
            let band = band_of(self.regions, point.region);
            heights[k] = if z.is_finite() { z } else { band.lo.midpoint(band.hi) };
        }
        heights
    }

    /// Heights of points inside sub-domains, as [`axis_heights`].
    pub fn of_points(&self, points: &[AxisPoint], tuning: &SkeletonTuning) -> Vec<f64> {
        let levels = |region: usize| {
            let index = || BorderLevels::new(self.tin, self.contents.borders.of(region));
            self.levels[region].get_or_init(index)
        };
        heights_in((self.tin, self.regions, &self.contents), levels, points, tuning)
    }
}

/// Heights of points. `levels` gives the index of a sub-domain's border.
fn heights_in<L: Borrow<BorderLevels>>(
    (tin, regions, contents): (&Tin, &Regions, &Contents),
    levels: impl Fn(usize) -> L + Sync,
    points: &[AxisPoint],
    tuning: &SkeletonTuning,
) -> Vec<f64> {
    let of_region =
        Rows::new(regions.regions.len(), || points.iter().enumerate().map(|(i, p)| (p.region as usize, i as u32)));
    // Computed on demand: few maps need it, and it takes time.
    let map_slope = LazyLock::new(|| {
        let inside = (0..tin.len() as u32).filter(|&t| tin.is_inside(t));
        let all: Vec<(u32, u8)> = inside.flat_map(|t| borders(tin, t)).collect();
        slope_outside((tin, regions), &all, None).unwrap_or(0.0)
    });
    // Only points with a level need it, and it takes time.
    let glimpse = points.iter().any(|point| point.level.is_some()).then(|| Glimpse::new(tin));
    let found: Vec<Vec<(u32, f64)>> = parallel::map(regions.regions.len(), |r| {
        let own = of_region.of(r);
        if own.is_empty() {
            return Vec::new();
        }
        let (levels, region) = (levels(r), &regions.regions[r]);
        let map_slope: &(dyn Fn() -> f64 + Sync) = &|| *map_slope;
        let ground =
            Ground { tin, glimpse: glimpse.as_ref(), regions, region, levels: levels.borrow(), map_slope, tuning };
        ground.heights(points, own, (contents.borders.of(r), contents.spots.of(r)))
    });
    let mut heights = vec![f64::NAN; points.len()];
    for (p, h) in found.into_iter().flatten() {
        heights[p as usize] = h;
    }
    heights
}

/// What lies in or on each sub-domain.
struct Contents {
    /// Triangle and edge of each piece of contour on the border.
    borders: Rows<(u32, u8)>,
    /// Vertices that are spot heights.
    spots: Rows<u32>,
}

impl Contents {
    /// Sorts the contents of those sub-domains that are asked for.
    fn new(tin: &Tin, regions: &Regions, is_asked: impl Fn(usize) -> bool + Sync) -> Self {
        let count = regions.regions.len();
        let region_of = |t: u32| regions.of_triangle[t as usize] as usize;
        let asked = |&t: &u32| tin.is_inside(t) && is_asked(region_of(t));
        let triangles = parallel::flat_map(tin.len(), |t| Some(t as u32).filter(asked));
        let is_spot = |&v: &u32| tin.kinds[v as usize] == VertexKind::Spot;
        let spots_of = |&t: &u32| tin.triangles[t as usize].into_iter().filter(is_spot).map(move |v| (v, region_of(t)));
        let region_of_spot: BTreeMap<u32, usize> = triangles.iter().flat_map(spots_of).collect();
        let borders_of = |&t: &u32| borders(tin, t).map(move |border| (region_of(t), border));
        let borders: Vec<(usize, (u32, u8))> = parallel::flat_map_each(&triangles, borders_of);
        Self {
            borders: Rows::new(count, || borders.iter().copied()),
            spots: Rows::new(count, || region_of_spot.iter().map(|(&v, &region)| (region, v))),
        }
    }
}

/// The edges of a triangle that are pieces of contour or of shore, with the triangle.
fn borders(tin: &Tin, t: u32) -> impl Iterator<Item = (u32, u8)> + '_ {
    (0..3).filter(move |&i| tin.border_level(t, i).is_some()).map(move |i| (t, i as u8))
}

/// What the contours around a point give for its height.
enum Known {
    /// The height, from two levels.
    Height(f64),
    /// The distance to the only level, and the side of it on which the point lies.
    Distance { from: f64, side: Side, distance: f64 },
}

/// A sub-domain and its border.
struct Ground<'a> {
    tin: &'a Tin,
    /// `None` if no point has a level.
    glimpse: Option<&'a Glimpse<'a>>,
    regions: &'a Regions,
    region: &'a Region,
    levels: &'a BorderLevels,
    /// Mean slope at the contours of the whole map.
    map_slope: &'a (dyn Fn() -> f64 + Sync),
    /// The tuned numbers.
    tuning: &'a SkeletonTuning,
}

impl Ground<'_> {
    /// The heights of its points, whose numbers are `own`. `borders` and `spots` are its contents.
    fn heights(&self, points: &[AxisPoint], own: &[u32], (borders, spots): (&[(u32, u8)], &[u32])) -> Vec<(u32, f64)> {
        let found: Vec<Known> = parallel::map_each(own, |&p| self.known(&points[p as usize]));
        let mut tops: Vec<(f64, Cap)> = Vec::new();
        let mut heights = Vec::with_capacity(own.len());
        for (&p, known) in own.iter().zip(&found) {
            let height = match *known {
                Known::Height(height) => height,
                Known::Distance { from, side, distance } => {
                    let k = tops.iter().position(|(level, _)| *level == from).unwrap_or_else(|| {
                        let distances = found.iter().filter_map(|k| match k {
                            Known::Distance { from: level, distance, .. } if *level == from => Some(*distance),
                            _ => None,
                        });
                        tops.push((from, self.cap(from, side, borders, spots, distances)));
                        tops.len() - 1
                    });
                    let height = tops[k].1.height(points[p as usize].position, distance);
                    // Beside water the band is narrower than one interval.
                    let band = self.region.band;
                    if band.contains(height) { height } else { band.strictly_inside(height) }
                }
            };
            heights.push((p, height));
        }
        heights
    }

    /// Equation (1) between the point's own level (or the nearest one) and the nearest other level on the sub-domain's
    /// side of it; the distance if there is no such level.
    fn known(&self, point: &AxisPoint) -> Known {
        let at = point.position;
        let own = match point.level {
            Some(level) => self.levels.of_point(self.tin, point, level),
            None => self
                .levels
                .nearest(at, |_| true, |near| near.distance)
                .and_then(|(_, level)| self.levels.near(level, at)),
        };
        let Some(own) = own else {
            // Only barrier edges: the level of the contour ends at both sides is all that is known.
            let height = point.level.filter(|_| self.region.band.lo.is_finite());
            return Known::Height(height.map_or(f64::NAN, |level| self.region.band.strictly_inside(level)));
        };
        let own_level = own.tree.level;
        let side = self.region.side(own_level).unwrap_or(Side::Above);
        // Only a nearer segment can block a line of sight.
        let own_distance = if self.levels.has_nearer_other(&own, at) {
            own.visible_distance(self.tin, self.glimpse, point)
        } else {
            own.distance
        };
        let is_beyond = |level: f64| match side {
            Side::Above => level > own_level,
            Side::Below => level < own_level,
        };
        let visible = |near: &NearLevel| near.visible_distance(self.tin, self.glimpse, point);
        let other = self.levels.nearest(at, is_beyond, visible);
        match other {
            Some((distance, level)) if distance + own_distance > 0.0 => {
                let height = (own_level * distance + level * own_distance) / (distance + own_distance);
                Known::Height(self.region.band.strictly_inside(height))
            }
            _ => Known::Distance { from: own_level, side, distance: own_distance },
        }
    }

    /// The rounded top or hollow beyond a level. `distances` are the distances of all points on it.
    fn cap(
        &self,
        level: f64,
        side: Side,
        borders: &[(u32, u8)],
        spots: &[u32],
        distances: impl Iterator<Item = f64>,
    ) -> Cap {
        let tree = self.levels.of(level);
        let spots: Vec<(DVec2, f64, f64)> = spots
            .iter()
            .map(|&v| {
                let at = self.tin.positions[v as usize];
                (at, self.tin.heights[v as usize], tree.map_or(0.0, |t| t.distance(at)))
            })
            .collect();
        let widest = distances.chain(spots.iter().map(|s| s.2)).fold(0.0f64, f64::max);
        let slope = slope_outside((self.tin, self.regions), borders, Some(level)).unwrap_or_else(self.map_slope);
        let share = if side == Side::Below { self.tuning.hollow_reach } else { self.tuning.top_reach };
        Cap::new(self.regions.beyond(level, side), side, widest, slope, share, spots)
    }
}

/// Mean slope just outside the border, at one level or at all: the interval divided by the mean width of the strip
/// beyond. None where no triangle beyond reaches another level. Water has no slope, even if a contour stands in it.
fn slope_outside((tin, regions): (&Tin, &Regions), borders: &[(u32, u8)], at: Option<f64>) -> Option<f64> {
    let (mut rise, mut run) = (0.0, 0.0);
    for &(t, i) in borders {
        let i = i as usize;
        let (Some(level), Some(n)) = (tin.border_level(t, i), tin.inner_neighbour(t, i)) else { continue };
        if at.is_some_and(|at| at != level) || regions.region(n).is_some_and(|beyond| beyond.water.is_some()) {
            continue;
        }
        let Some(j) = tin.edge_towards(n, t) else { continue };
        let apex = tin.triangles[n as usize][(j + 2) % 3] as usize;
        let step = (tin.heights[apex] - level).abs();
        let length = tin.edge_length(t, i);
        // NaN where the apex is a corner of the frame without a height.
        if step > 0.0 && length > 0.0 {
            let [a, b, c] = tin.corners(n);
            rise += step * length;
            run += (b - a).perp_dot(c - a).abs();
        }
    }
    (run > 0.0).then(|| rise / run)
}
