//! From polygons to lakes that fit the contours: heights, cuts and shared vertices.

use std::collections::HashSet;

use geo::{Area, BoundingRect, Euclidean, Length, MultiPolygon, Polygon};
use glam::DVec2;

use super::bodies::{WaterBodies, WaterBody, first_vertex, rounded};
use super::cut::{Clash, cut_back};
use super::dry::DrySubdivision;
use super::gathered::Gathered;
use super::height::{level_along, lowest_on_shore};
use super::net::Net;
use super::nodes::{Reach, conflict, node};
use crate::base::FeatureId;
use crate::base::bits::bits;
use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::clean::is_height;
use crate::contour::{Clipped, Contour, ContourMap, Lake, clip};
use crate::geometry::{rings, thinned};
use crate::subdomains::FrameRing;
use crate::tin::Tin;

/// A shore this near to a contour runs along it, as a share of the mean spacing.
const NEAR: f64 = 0.1;
/// How far a lake is cut back from contours of other levels, as a share of the mean spacing.
const BACK: f64 = 0.05;
/// How far vertices of a shore move onto a contour of its level, as a share of the mean spacing, or of the lake's size
/// if that is smaller.
const SNAP: f64 = 0.01;
/// Vertices of a shore that are closer to each other than the first share of the mean spacing are left out, where the others
/// show the shore up to the second.
const DENSE: f64 = 0.05;
const STRAIGHT: f64 = 1e-5;
/// A lake and a contour whose heights differ by no more have one level, metres: heights are often rounded to
/// centimetres.
const SAME_LEVEL: f64 = 0.01;

/// Why a lake is left out when nothing remains between its shores.
const NARROW: &str = "is too narrow beside a contour of its level";

/// Gives every lake a height, and a shore that meets contours only in common vertices. Gives the frame a vertex
/// wherever a shore meets it.
///
/// Long because the lakes are settled one after the other: each step needs those that were settled before.
///
/// # Errors
/// When the height of a lake is not a possible height.
pub(crate) fn settle(
    lakes: &[Lake],
    dry: &DrySubdivision,
    findings: &mut Vec<Finding>,
) -> Result<(WaterBodies, FrameRing)> {
    let length: f64 = dry.map.contours.iter().map(Contour::length).sum();
    let spacing = if length > 0.0 { dry.frame.area.unsigned_area() / length } else { 0.0 };
    let thin = |lake: &Lake| {
        let area = thinned(&lake.polygon.clone().into(), STRAIGHT * spacing, DENSE * spacing);
        Lake { polygon: area.into_iter().next().unwrap_or_else(|| lake.polygon.clone()), ..*lake }
    };
    let lakes: Vec<Lake> = lakes.iter().map(thin).collect();
    let mut net = Net::new(dry.map, dry.extensions, &lakes, NEAR * spacing);
    let mut gathered = Gathered::default();
    let levels = levels_in_order(dry.map);
    for lake in &lakes {
        let Some(height) = height_of(lake, dry, &levels, &net, NEAR * spacing)? else {
            findings.push(left_out(lake.feature, lake.height, first_point(lake), "lies outside of the map"));
            continue;
        };
        let area = MultiPolygon::from(lake.polygon.clone());
        let (area, clashes) = cut_back(area, height, &net, BACK * spacing);
        findings.extend(clashes.iter().map(|clash| crossed(lake.feature, height, clash)));
        for part in area {
            if width(&part) <= dry.frame.tolerance() {
                let place = first_vertex(&part.into());
                findings.push(left_out(lake.feature, Some(height), place, "has no width, except for rounding"));
                continue;
            }
            let body = WaterBody { area: part.into(), height, feature: lake.feature, shores: Vec::new(), used: true };
            gathered.add(body, BACK * spacing, findings);
        }
    }
    let mut water_bodies = gathered.into_bodies();

    // Shores are cut to the frame as contours are.
    let shore_lines = (0u64..).zip(&water_bodies).flat_map(|(id, body)| {
        let line = move |ring: &geo::LineString<f64>| Contour {
            elevation: body.height,
            points: ring.coords().map(|c| DVec2::new(c.x, c.y)).collect(),
            feature: id.into(),
        };
        rings(&body.area).map(line)
    });
    let shore_lines = ContourMap { contours: shore_lines.collect(), ..ContourMap::default() };
    let Clipped { map: shore_lines, area } = clip(shore_lines, &dry.frame.area);
    for Contour { points, feature, .. } in shore_lines.contours {
        water_bodies[feature.number() as usize].shores.push(points);
    }
    for body in &mut water_bodies {
        let place = first_vertex(&body.area);
        if body.shores.is_empty() {
            findings.push(left_out(body.feature, Some(body.height), place, "lies outside of the map"));
            body.used = false;
            continue;
        }
        // Where contours are far apart, the shore of a small lake must still not move further than its size allows.
        let size = body.area.bounding_rect().map_or(0.0, |r| r.width().hypot(r.height()));
        let reach = Reach { snap: SNAP * spacing.min(size), tolerance: dry.frame.tolerance() };
        let shores = std::mem::take(&mut body.shores).into_iter();
        body.shores = shores.map(|shore| node(shore, body.height, &mut net, reach)).collect();
        body.shores.retain(|shore| shore.len() >= 2);
        if body.shores.is_empty() {
            findings.push(left_out(body.feature, Some(body.height), place, NARROW));
            body.used = false;
        }
    }
    // This check comes last, because a later shore may add vertices to a contour that an earlier one follows.
    for body in water_bodies.iter_mut().filter(|body| body.used) {
        if let Some(place) = conflict(&body.shores, body.height, &net) {
            findings.push(left_out(
                body.feature,
                Some(body.height),
                place,
                "has a shore that weaves across a contour too closely to be kept",
            ));
            body.used = false;
        }
    }
    // Vertices where shores met the frame may be gone or have moved. Where a contour runs along the frame, such a
    // vertex would lie beside the contour, with another height.
    let shores = water_bodies.iter().filter(|body| body.used).flat_map(|body| &body.shores).flatten().copied();
    let kept: HashSet<[u64; 2]> = dry.frame.rings().flatten().chain(shores).map(bits).collect();
    // The vertices that contours along the frame got instead.
    let nodes: Vec<DVec2> = net.nodes.values().flatten().copied().collect();
    let frame = FrameRing { area }.only(|p| kept.contains(&bits(p))).with_points(&nodes);
    Ok((WaterBodies { water_bodies, nodes: net.nodes }, frame))
}

/// Mean width of an area, as of a long rectangle: twice the area divided by the perimeter.
fn width(area: &Polygon<f64>) -> f64 {
    2.0 * area.unsigned_area() / Euclidean.length(area.exterior())
}

/// Leaves out lakes that contain no triangle. Their vertices moved further than the lake is wide, and their shores
/// enclose nothing.
pub(crate) fn leave_out_vanished(water_bodies: &mut WaterBodies, tin: &Tin) -> Vec<Finding> {
    if water_bodies.is_empty() {
        return Vec::new();
    }
    let found: HashSet<u32> = (0..tin.len() as u32).filter_map(|t| tin.lake(t)).collect();
    let vanished = (0u32..).zip(&mut water_bodies.water_bodies).filter(|(id, body)| body.used && !found.contains(id));
    let findings = vanished.map(|(_, body)| {
        body.used = false;
        left_out(body.feature, Some(body.height), first_vertex(&body.area), NARROW)
    });
    findings.collect()
}

/// The levels of the contours, each once, in the order of their first contours.
fn levels_in_order(map: &ContourMap) -> Vec<f64> {
    let mut seen = HashSet::new();
    map.contours.iter().map(|c| c.elevation).filter(|level| seen.insert(level.to_bits())).collect()
}

/// The height of a lake: its own, or that of the contour along its shore, or that of the lowest ground on the shore.
fn height_of(lake: &Lake, dry: &DrySubdivision, levels: &[f64], net: &Net, near: f64) -> Result<Option<f64>> {
    let Some(height) = lake.height else {
        return Ok(level_along(&lake.polygon, net, near).or_else(|| lowest_on_shore(&lake.polygon, dry)));
    };
    if !is_height(height) {
        let message = format!(
            "the lake of feature {} has the height {height} m, which is not possible: correct it, or leave it \
             empty to take the height of the shore",
            lake.feature
        );
        return Err(Error::Data(message));
    }
    let nearest = levels.iter().copied().min_by(|a, b| (a - height).abs().total_cmp(&(b - height).abs()));
    Ok(nearest.filter(|level| (level - height).abs() <= SAME_LEVEL).or(Some(height)))
}

fn crossed(feature: FeatureId, height: f64, clash: &Clash) -> Finding {
    let course = if clash.is_extension { "the extension to the frame of contour" } else { "contour" };
    let message = format!(
        "the lake of feature {feature} at {} m is crossed or touched by {course} {} m; it is cut back from it",
        rounded(height),
        clash.level
    );
    Finding::at(FindingKind::LakeCutBack, clash.place, message).about(feature, height).of_elevations([clash.level])
}

fn left_out(feature: FeatureId, height: Option<f64>, place: DVec2, why: &str) -> Finding {
    let message = format!("the lake of feature {feature} {why}; it is left out");
    Finding::at(FindingKind::LakeLeftOut, place, message).about(feature, height.unwrap_or(f64::NAN))
}

fn first_point(lake: &Lake) -> DVec2 {
    lake.polygon.exterior().coords().next().map_or(DVec2::NAN, |c| DVec2::new(c.x, c.y))
}
