//! What a task needs of the map: the parts of lines that meet the window of its tile, and the points in it.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use glam::DVec2;
use tokosen_core::base::FeatureId;
use tokosen_core::base::bits::bits;
use tokosen_core::base::error::Result;
use tokosen_core::contour::{Contour, ContourMap, SoftSpot};

use super::beside;
use super::bytes::{In, Out};
use super::window::Window;
use crate::terrain::Beside;

/// The box around each line of a map.
pub fn boxes(map: &ContourMap) -> Vec<[DVec2; 2]> {
    let around = |line: &Contour| {
        line.points.iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], &p| [lo.min(p), hi.max(p)])
    };
    map.contours.iter().map(around).collect()
}

/// The part of a map that meets a window, and the number of the line of the map that each of its lines is a part of.
pub fn around(map: &ContourMap, boxes: &[[DVec2; 2]], window: &Window) -> (ContourMap, Vec<u32>) {
    let near = (0..).zip(&map.contours).zip(boxes).filter(|(_, [lo, hi])| window.meets(*lo, *hi));
    let part = |line: &Contour, points| Contour { elevation: line.elevation, points, feature: line.feature };
    let (contours, numbers): (Vec<Contour>, Vec<u32>) = near
        .flat_map(|((k, line), _)| window.runs(&line.points).into_iter().map(move |run| (part(line, run), k)))
        .unzip();
    let features: HashSet<FeatureId> = contours.iter().map(|line| line.feature).collect();
    let holds = |p: &DVec2| window.holds(*p);
    let found = ContourMap {
        spots: map.spots.iter().filter(|spot| window.holds(spot.truncate())).copied().collect(),
        soft_spots: map.soft_spots.iter().filter(|spot| window.holds(spot.place.truncate())).copied().collect(),
        depressions: map.depressions.iter().filter(|(f, _)| features.contains(f)).map(|(f, is)| (*f, *is)).collect(),
        mended: map.mended.iter().copied().filter(holds).collect(),
        cut_ends: map.cut_ends.iter().copied().filter(holds).collect(),
        contours,
        ..ContourMap::default()
    };
    (found, numbers)
}

/// What a task needs, as bytes.
pub fn encode((map, numbers): &(ContourMap, Vec<u32>), beside: &Beside) -> Vec<u8> {
    let mut out = Out::default();
    out.count(map.contours.len());
    for (line, number) in map.contours.iter().zip(numbers) {
        out.count(*number as usize);
        out.number(line.elevation);
        out.feature(line.feature);
        out.points(&line.points);
    }
    out.each(&map.spots, |out, spot| spot.to_array().into_iter().for_each(|v| out.number(v)));
    out.each(&map.soft_spots, |out, spot| {
        spot.place.to_array().into_iter().chain([spot.sigma]).for_each(|v| out.number(v));
    });
    out.count(map.depressions.len());
    for (feature, is_depression) in &map.depressions {
        out.feature(*feature);
        out.count(usize::from(*is_depression));
    }
    out.points(&map.mended);
    out.points(&map.cut_ends);
    beside::encode(&mut out, beside);
    out.0
}

/// The part of a map around a tile.
pub struct Around {
    /// The lines and points.
    pub map: ContourMap,
    /// What lies beside them.
    pub beside: Beside,
    /// The number, in the whole map, of the line that each vertex is on.
    lines: HashMap<[u64; 2], u32>,
}

impl Around {
    /// From the bytes of a file.
    ///
    /// # Errors
    /// The bytes end too early.
    pub fn decode(bytes: &[u8], file: &Path) -> Result<Self> {
        let mut bytes = In::new(bytes, file);
        let mut map = ContourMap::default();
        let mut numbers = Vec::new();
        map.contours = bytes.each(40, |bytes| {
            numbers.push(bytes.whole()? as u32);
            Ok(Contour { elevation: bytes.number()?, feature: bytes.feature()?, points: bytes.points()? })
        })?;
        map.spots = bytes.each(24, |bytes| Ok(bytes.point()?.extend(bytes.number()?)))?;
        map.soft_spots = bytes
            .each(32, |bytes| Ok(SoftSpot { place: bytes.point()?.extend(bytes.number()?), sigma: bytes.number()? }))?;
        map.depressions = bytes.each(24, |bytes| Ok((bytes.feature()?, bytes.whole()? != 0)))?.into_iter().collect();
        map.mended = bytes.points()?;
        map.cut_ends = bytes.points()?;
        let beside = beside::decode(&mut bytes)?;
        let mut lines = HashMap::new();
        for (line, &number) in map.contours.iter().zip(&numbers) {
            lines.extend(inner(&line.points).iter().map(|p| (bits(*p), number)));
        }
        // Lines may share their ends, and nothing else.
        for (line, &number) in map.contours.iter().zip(&numbers) {
            for p in line.points.first().into_iter().chain(line.points.last()) {
                lines.entry(bits(*p)).or_insert(number);
            }
        }
        Ok(Self { map, beside, lines })
    }

    /// The number of the line that a part of it belongs to.
    pub fn line_of(&self, points: &[DVec2]) -> Option<u32> {
        let number = |p: &DVec2| self.lines.get(&bits(*p)).copied();
        inner(points).iter().find_map(number).or_else(|| points.iter().find_map(number))
    }
}

fn inner(points: &[DVec2]) -> &[DVec2] {
    points.get(1..points.len().saturating_sub(1)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_ring_goes_on_through_its_first_point_and_vertices_stay_bit_for_bit() {
        let ring: Vec<DVec2> = (0..=40).map(|k| 10.0 * DVec2::from_angle(f64::from(k % 40) * 0.157)).collect();
        let window = Window::new([DVec2::new(5.0, -3.0), DVec2::new(20.0, 3.0)]);
        let runs = window.runs(&ring);
        assert_eq!(runs.len(), 1);
        let at = runs[0].iter().position(|p| *p == ring[0]).unwrap();
        assert!(at > 0 && at + 1 < runs[0].len());
        let map = ContourMap {
            contours: vec![
                Contour { elevation: 5.0, points: vec![DVec2::splat(50.0), DVec2::splat(60.0)], feature: 1.into() },
                Contour { elevation: 10.0, points: ring, feature: FeatureId::from(7).in_file(3) },
            ],
            spots: vec![DVec3::new(6.0, 0.1, 12.3), DVec3::new(0.0, 0.0, 1.0)],
            ..ContourMap::default()
        };
        let part = around(&map, &boxes(&map), &window);
        let bytes = encode(&part, &Beside::default());
        let around = Around::decode(&bytes, Path::new("x")).unwrap();
        assert_eq!(around.map, part.0);
        assert_eq!(around.map.contours.len(), 1);
        assert_eq!(around.map.contours[0], Contour { points: runs[0].clone(), ..map.contours[1].clone() });
        assert_eq!(around.map.spots, map.spots[..1]);
        assert_eq!(around.line_of(&runs[0][1..3]), Some(1));
        for cut in 0..bytes.len() {
            assert!(Around::decode(&bytes[..cut], Path::new("x")).is_err());
        }
    }
}
