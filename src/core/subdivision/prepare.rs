//! A map cut to its frame, with all that is triangulated besides it.

use geo::Area;

use super::constraints::Constraints;
use super::water::{Water, WaterBodies, sea_level};
use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::contour::{Clipped, ContourMap, Interval, clip, find_interval};
use crate::geometry::{common_area, with_corners_at};
use crate::subdomains::{Frame, FrameRing, OpenEnd, extend_open_ends, extensions_at, frame_ring};

/// Ground outside the convex hull is reported if it is at least this share of the frame polygon.
const TOLD: f64 = 1e-3;

/// A map in its frame, ready for the triangulation.
pub(crate) struct Prepared {
    /// The map, cut to the frame.
    pub map: ContourMap,
    /// The frame's outline.
    pub frame: FrameRing,
    /// The vertical interval.
    pub interval: Interval,
    /// The mean spacing of the contours, map units, if it is known from a larger map.
    pub spacing: Option<f64>,
    pub(super) ends: Vec<OpenEnd>,
    pub(super) constraints: Constraints,
    pub(super) findings: Vec<Finding>,
}

/// Cuts a map to its frame, and collects what is triangulated besides the contours.
///
/// # Errors
/// When the map has fewer than two levels, or when no contour lies at the level of the sea.
pub(crate) fn prepare(map: ContourMap, wanted: &Frame, water: &Water) -> Result<Prepared> {
    let frame = frame_ring(&map, wanted);
    let mut findings = Vec::new();
    let (map, frame) = match wanted {
        Frame::Polygon(_) | Frame::PolygonInHull(_) | Frame::Convex(_) => {
            findings.extend(beyond_map(&map, wanted, &frame));
            let area = with_corners_at(&map.places().collect::<Vec<_>>(), &frame.area);
            let Clipped { map, area } = clip(map, &area);
            (map, FrameRing { area })
        }
        Frame::Auto | Frame::Hull | Frame::Box | Frame::Outline(_) => (map, frame),
    };
    let sea = sea_level(water, &map, &mut findings)?;
    let interval = find_interval(&map.contours).ok_or_else(|| too_few_levels(&map, wanted))?;
    let tolerance = frame.tolerance();
    // All other frames lie inside the hull.
    let may_be_wider = matches!(wanted, Frame::Polygon(_) | Frame::Box);
    let hull = may_be_wider.then(|| frame_ring(&map, &Frame::Hull));
    let (ends, extensions) = extend_open_ends(&map, &frame, hull.as_ref(), tolerance);
    let frame = match wanted {
        Frame::Auto | Frame::Hull | Frame::Box | Frame::Convex(_) => frame,
        Frame::Polygon(_) | Frame::PolygonInHull(_) | Frame::Outline(_) => {
            frame.with_points(&extensions.iter().map(|l| l.frame).collect::<Vec<_>>())
        }
    };
    let is_polygon = !matches!(wanted, Frame::Auto | Frame::Hull | Frame::Box | Frame::Convex(_));
    let on_extensions = extensions_at(&map.spots, &extensions, tolerance);
    for (spot, extension) in map.spots.iter().zip(&on_extensions) {
        if let Some(extension) = extension.filter(|extension| extension.elevation != spot.z) {
            let message = format!(
                "the spot height {} m lies on the extension of the contour {} m to the frame; it is left out",
                spot.z, extension.elevation
            );
            let finding = Finding::at(FindingKind::SpotOnLine, spot.truncate(), message);
            findings.push(finding.of_elevations([spot.z, extension.elevation]));
        }
    }
    let spots = on_extensions.iter().map(Option::is_none).collect();
    let constraints = Constraints {
        is_polygon,
        extensions,
        tolerance,
        spots,
        water_bodies: WaterBodies::default(),
        sea,
        coast: water.coast.clone(),
    };
    Ok(Prepared { map, frame, interval, spacing: None, ends, constraints, findings })
}

/// Reports how much of the user's polygon lies outside the convex hull of the map. `frame` is what it has become.
fn beyond_map(map: &ContourMap, wanted: &Frame, frame: &FrameRing) -> Option<Finding> {
    let message = match wanted {
        Frame::PolygonInHull(polygon) if frame.area != *polygon => {
            "the frame polygon reaches beyond the contours; the surface ends at their convex hull".into()
        }
        Frame::Polygon(polygon) => {
            let (whole, hull) = (polygon.unsigned_area(), frame_ring(map, &Frame::Hull).area);
            let filled = frame.area.unsigned_area();
            let beyond = filled - common_area(&frame.area, &hull).unsigned_area();
            if beyond < TOLD * whole {
                return None;
            }
            let left = 100.0 * (1.0 - filled / whole);
            let left =
                if left < 0.1 { String::new() } else { format!("; {left:.1} % is too far away and has no heights") };
            format!(
                "{:.1} % of the frame polygon lies outside the convex hull of the contours, where heights are a guess: \
                 --no-extend leaves them out{left}",
                100.0 * beyond / whole
            )
        }
        _ => return None,
    };
    Some(Finding::general(FindingKind::FrameBeyondMap, message))
}

fn too_few_levels(map: &ContourMap, frame: &Frame) -> Error {
    let in_polygon = frame.polygon().is_some();
    match map.contours.first() {
        None => Error::NoContours { in_polygon },
        Some(c) => Error::TooFewLevels { lines: map.contours.len(), elevation: c.elevation, in_polygon },
    }
}
