//! A map cut to its frame, with all that is triangulated besides it.

use super::constraints::Constraints;
use super::water::{Water, WaterBodies, sea_level};
use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::contour::{Clipped, ContourMap, Interval, clip, find_interval};
use crate::geometry::with_corners_at;
use crate::subdomains::{Frame, FrameRing, OpenEnd, extend_open_ends, extensions_at, frame_ring};

/// A map in its frame, ready for the triangulation.
pub(crate) struct Prepared {
    /// The map, cut to the frame.
    pub map: ContourMap,
    /// The frame's outline.
    pub frame: FrameRing,
    /// The vertical interval.
    pub interval: Interval,
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
        Frame::Polygon(polygon) => {
            if frame.area != *polygon {
                let message = "the frame polygon reaches beyond the contours; the surface ends at their convex hull";
                findings.push(Finding::general(FindingKind::FrameBeyondMap, message));
            }
            let area = with_corners_at(&map.places().collect::<Vec<_>>(), &frame.area);
            let Clipped { map, area } = clip(map, &area);
            (map, FrameRing { area })
        }
        Frame::Auto | Frame::Hull | Frame::Box | Frame::Outline(_) => (map, frame),
    };
    let sea = sea_level(water, &map, &mut findings)?;
    let interval = find_interval(&map.contours).ok_or_else(|| too_few_levels(&map, wanted))?;
    let tolerance = frame.tolerance();
    let (ends, extensions) = extend_open_ends(&map, &frame, tolerance);
    let frame = match wanted {
        Frame::Auto | Frame::Hull | Frame::Box => frame,
        Frame::Polygon(_) | Frame::Outline(_) => {
            frame.with_points(&extensions.iter().map(|l| l.frame).collect::<Vec<_>>())
        }
    };
    let is_polygon = matches!(wanted, Frame::Polygon(_) | Frame::Outline(_));
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
    Ok(Prepared { map, frame, interval, ends, constraints, findings })
}

fn too_few_levels(map: &ContourMap, frame: &Frame) -> Error {
    let in_polygon = matches!(frame, Frame::Polygon(_));
    match map.contours.first() {
        None => Error::NoContours { in_polygon },
        Some(c) => Error::TooFewLevels { lines: map.contours.len(), elevation: c.elevation, in_polygon },
    }
}
