//! Projects a map to the plane on which it is worked on.

use glam::DVec2;

use super::map::ContourMap;
use crate::base::error::{CrsNeed, Error, Report, Result};
use crate::crs::{Crs, Reprojection};

/// Projects a map to the plane of a projected system. The [`Reprojection`] leads back.
///
/// Coordinates are transformed, if the map has another system, and rounded to whole micrometres. Vertices of contours
/// come back bit for bit. Vertices that would become equal by rounding keep all their digits. If they are equal even
/// so, they become one vertex, with a finding.
///
/// # Errors
/// [`Error::UnknownCrs`] if the map's system is not known. [`Error::Data`] if there is no transformation between the
/// systems. [`Error::NoPlace`] if a vertex cannot be projected.
pub fn reproject(mut map: ContourMap, working: &Crs) -> Result<Report<(ContourMap, Reprojection)>> {
    let Some(input) = map.crs.take() else {
        return Err(Error::UnknownCrs { needed_for: CrsNeed::Projecting });
    };
    let mut lines: Vec<&mut [DVec2]> = map.contours.iter_mut().map(|line| line.points.as_mut_slice()).collect();
    let mut others: Vec<DVec2> = map.spots.iter().map(|s| s.truncate()).collect();
    others.extend(map.mended.iter().chain(&map.cut_ends));
    others.extend(map.soft_spots.iter().map(|s| s.place.truncate()));
    let Report { value: places, findings } = Reprojection::project(&mut lines, &mut others, &input, working)?;
    let (spots, others) = others.split_at(map.spots.len());
    let (mended, others) = others.split_at(map.mended.len());
    let (cut_ends, soft_spots) = others.split_at(map.cut_ends.len());
    for (spot, place) in map.soft_spots.iter_mut().zip(soft_spots) {
        spot.place = place.extend(spot.place.z);
    }
    for (spot, place) in map.spots.iter_mut().zip(spots) {
        *spot = place.extend(spot.z);
    }
    map.mended.copy_from_slice(mended);
    map.cut_ends.copy_from_slice(cut_ends);
    map.crs = Some(working.clone());
    Ok(Report { value: (map, places), findings })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::contour::Contour;

    fn map(crs: Option<u32>) -> ContourMap {
        let points = vec![DVec2::new(138.7, 35.3), DVec2::new(138.8, 35.4)];
        ContourMap {
            contours: vec![Contour { elevation: 10.0, points, feature: 1.into() }],
            spots: vec![DVec3::new(138.7, 35.3, 5.0)],
            mended: vec![DVec2::new(138.8, 35.4)],
            crs: crs.map(Crs::from_epsg),
            ..ContourMap::default()
        }
    }

    #[test]
    fn all_points_of_a_map_move_and_heights_stay() {
        let plane = Crs::from_epsg(6676);
        let (flat, places) = reproject(map(Some(6668)), &plane).unwrap().value;
        assert_eq!(flat.crs, Some(plane));
        let points = &flat.contours[0].points;
        assert_eq!(flat.spots, [points[0].extend(5.0)]);
        assert_eq!(flat.mended, [points[1]]);
        let back: Vec<DVec2> = points.iter().map(|&p| places.in_input(p).unwrap()).collect();
        assert_eq!(back, map(None).contours[0].points);
    }

    #[test]
    fn a_map_of_an_unknown_system_is_refused() {
        assert!(reproject(map(None), &Crs::from_epsg(6676)).is_err());
    }
}
