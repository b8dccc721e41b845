//! Areas between levels: [`bands`].
//!
//! The areas are made of lines that exist already, so their borders have the vertices of these lines and no others:
//!
//! 1. The lines and the shores get a vertex where they meet the frame, and the frame gets one where they end
//!    ([`clip`]).
//! 2. All of them are cut into chains between the vertices that several have in common. Following the chains around the
//!    plane gives the rings (`graph`).
//! 3. A ring around nothing but other ground is a hole. The nearest chain to the east of it tells the area that it is a hole
//!    of (`nest`).
//! 4. The lines on the border of an area say which levels it lies between: higher ground is on their right.
//!
//! [`areas_above`] puts areas together that lie at or above a level.
//!
//! No polygons are intersected, so the time is nearly proportional to the number of vertices.

mod above;
mod graph;
mod nest;
mod of_height_map;
mod of_surface;

use geo::{LineString, MultiPolygon, Polygon};
use glam::DVec2;

use crate::base::ElevationUnit;
use crate::base::error::{Finding, FindingKind, Report};
use crate::contour::{Contour, ContourLine, ContourMap, Target, clip, noded};
use crate::crs::Crs;
use crate::raster::equal_area;
use crate::slice::signed_area;
use graph::{Graph, Piece, Side};

pub(crate) use above::runs;
pub use above::{Rings, areas_above};
pub use of_height_map::bands_of_height_map;
pub use of_surface::bands_of_surface;

/// What covers an area.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BandKind {
    /// Ground between two levels.
    Ground,
    /// A lake, level.
    Lake,
    /// The sea, level.
    Sea,
}

impl BandKind {
    /// The word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ground => "ground",
            Self::Lake => "lake",
            Self::Sea => "sea",
        }
    }
}

/// A connected area between two levels, or of water.
#[derive(Debug, Clone, PartialEq)]
pub struct BandArea {
    /// What covers it.
    pub kind: BandKind,
    /// The level that its ground is not below, metres. `None` below the lowest of a list of levels. The level of water.
    pub from: Option<f64>,
    /// The level that its ground is below, metres. `None` above the highest of a list of levels. The level of water.
    pub to: Option<f64>,
    /// The outer ring, counter-clockwise, then the holes, clockwise; map units. The first point is repeated. Rings touch in
    /// single vertices at most.
    pub rings: Vec<Vec<DVec2>>,
    /// Its area on the ground, square metres. The scale factor of a projection is not corrected.
    pub area: f64,
    /// Its share of the sum of all areas, 0 to 1.
    pub share: f64,
}

impl BandArea {
    /// The height half-way between its levels, metres.
    pub fn middle(&self) -> Option<f64> {
        self.from.zip(self.to).map(|(from, to)| from.midpoint(to))
    }
}

/// Level water.
#[derive(Debug, Clone, PartialEq)]
pub struct WaterArea {
    /// [`BandKind::Lake`] or [`BandKind::Sea`].
    pub kind: BandKind,
    /// Its level, metres.
    pub level: f64,
    /// The area. Areas do not overlap.
    pub area: MultiPolygon<f64>,
}

/// What bounds areas, besides lines.
pub struct Ground<'a> {
    /// The area to divide.
    pub frame: &'a MultiPolygon<f64>,
    /// Water, which is no part of any band.
    pub water: &'a [WaterArea],
    /// The height at a vertex of the frame, metres. It is asked for where an area has no line on its border.
    pub height: &'a dyn Fn(DVec2) -> Option<f64>,
    /// The system of the coordinates, for areas in square metres.
    pub crs: Option<&'a Crs>,
}

/// Divides the frame at the lines that have a level of the target. Lines at other levels bound nothing, because nobody knows
/// whether they are complete.
///
/// Each area is connected. All areas together are the frame: they have the same vertices where they meet, do not overlap
/// and leave no gap. Their order is that of the lines.
///
/// A line that ends inside the frame bounds nothing and is a finding. So is an area whose lines do not agree on one pair of
/// neighbouring levels. It then reaches from the lowest to the highest level that they allow.
pub fn bands<'a>(
    lines: impl Iterator<Item = &'a ContourLine>,
    target: &Target,
    unit: ElevationUnit,
    ground: &Ground<'_>,
) -> Report<Vec<BandArea>> {
    let mut graph = Graph::new(pieces(lines, target, unit, ground));
    let mut findings = open_lines(&graph.remove_bridges());
    let scale = equal_area(ground.crs);
    let areas = nest::areas(&graph).into_iter().filter(|area| !area.side.is_outside).map(|found| {
        let water = found.side.water.map(|k| &ground.water[k as usize]);
        let [from, to] = match water {
            Some(water) => [water.level; 2],
            None => levels_of(&found, target, unit, ground, &mut findings),
        };
        let scaled = |ring: &Vec<DVec2>| signed_area(&ring.iter().map(|&p| scale(p)).collect::<Vec<_>>());
        BandArea {
            kind: water.map_or(BandKind::Ground, |water| water.kind),
            from: Some(from).filter(|from| from.is_finite()),
            to: Some(to).filter(|to| to.is_finite()),
            area: found.rings.iter().map(scaled).sum(),
            rings: found.rings,
            share: 0.0,
        }
    });
    let mut areas: Vec<BandArea> = areas.collect();
    let whole: f64 = areas.iter().map(|area| area.area).sum();
    areas.iter_mut().for_each(|area| area.share = area.area / whole);
    Report { value: areas, findings }
}

/// The pieces of lines and shores inside the frame, and the rings of the frame. They have a vertex wherever they meet.
fn pieces<'a>(
    lines: impl Iterator<Item = &'a ContourLine>,
    target: &Target,
    unit: ElevationUnit,
    ground: &Ground<'_>,
) -> Vec<Piece> {
    let (mut courses, mut kinds) = (Vec::new(), Vec::new());
    for line in lines.filter(|line| target.has(unit, line.elevation)) {
        let [below, above] = target.beside(unit, line.elevation);
        kinds.push((line.elevation, [Side::between(below, line.elevation), Side::between(line.elevation, above)]));
        courses.push(line.points.clone());
    }
    if !ground.water.is_empty() {
        let numbers: Vec<u32> =
            (0..).zip(ground.water).flat_map(|(k, w)| std::iter::repeat_n(k, w.area.0.len())).collect();
        let shores;
        (courses, shores) = noded(courses, &ground.water.iter().flat_map(|water| water.area.iter().cloned()).collect());
        for (polygon, k) in shores.iter().zip(numbers) {
            let shores = outlines(polygon);
            kinds.resize(
                kinds.len() + shores.len(),
                (f64::NAN, [Side { water: Some(k), ..Side::NOTHING }, Side::NOTHING]),
            );
            courses.extend(shores);
        }
    }
    let contour = |(k, points): (u64, _)| Contour { elevation: 0.0, points, feature: k.into() };
    let contours = (0u64..).zip(courses).map(contour).collect();
    let cut = clip(ContourMap { contours, ..ContourMap::default() }, ground.frame);
    let piece = |line: Contour| {
        let (level, sides) = kinds[line.feature.number() as usize];
        Piece { points: line.points, sides, level: Some(level).filter(|level| level.is_finite()) }
    };
    let outside = [Side::NOTHING, Side { is_outside: true, ..Side::NOTHING }];
    let frame = cut.area.iter().flat_map(outlines).map(|points| Piece { points, sides: outside, level: None });
    cut.map.contours.into_iter().map(piece).chain(frame).collect()
}

/// The rings of a polygon, its area on the left of each.
fn outlines(polygon: &Polygon<f64>) -> Vec<Vec<DVec2>> {
    let ring = |ring: &LineString<f64>, sign: f64| {
        let mut ring: Vec<DVec2> = ring.coords().map(|c| DVec2::new(c.x, c.y)).collect();
        if sign * signed_area(&ring) < 0.0 {
            ring.reverse();
        }
        ring
    };
    let holes = polygon.interiors().iter().map(|hole| ring(hole, -1.0));
    std::iter::once(ring(polygon.exterior(), 1.0)).chain(holes).collect()
}

/// The levels that the ground of an area lies between; infinite beyond a list of levels, and where nothing says it.
fn levels_of(
    found: &nest::Area,
    target: &Target,
    unit: ElevationUnit,
    ground: &Ground<'_>,
    findings: &mut Vec<Finding>,
) -> [f64; 2] {
    let Side { from, to, is_mixed, .. } = found.side;
    let place = found.rings[0][0];
    if from > to {
        // No line is on its border.
        let height = found.rings[0].iter().find_map(|&p| (ground.height)(p));
        return height.map_or([f64::NEG_INFINITY, f64::INFINITY], |height| {
            let [below, above] = target.beside(unit, height);
            [if target.has(unit, height) { height } else { below }, above]
        });
    }
    if is_mixed {
        let [low, high] = [from, to].map(|level| unit.about(level));
        let message = format!(
            "the lines around an area do not say which of the levels from {low} to {high} {} its ground lies between: lines are \
             missing there or end inside the map. It is written as one band",
            unit.symbol()
        );
        findings.push(Finding::at(FindingKind::BandUnclear, place, message).of_elevations([from, to]));
    }
    [from, to]
}

/// The findings about lines that part no two areas.
fn open_lines(bridges: &[(DVec2, f64)]) -> Vec<Finding> {
    let finding = |&(place, level): &(DVec2, f64)| {
        let message = format!("the contour {level} m ends inside the map, so no band ends at it");
        Finding::at(FindingKind::BandOpenLine, place, message).of_elevations([level])
    };
    bridges.iter().map(finding).collect()
}
