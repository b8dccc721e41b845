//! What a task needs of the map: the parts of lines that meet the window of its tile, and the points in it.

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec2, DVec3};
use tokosen_core::base::FeatureId;
use tokosen_core::base::bits::bits;
use tokosen_core::base::error::Result;
use tokosen_core::contour::{Contour, ContourMap, SoftSpot};

use super::bytes::{In, Out};

/// A window.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    pub lo: DVec2,
    pub hi: DVec2,
}

impl Window {
    pub fn new([lo, hi]: [DVec2; 2]) -> Self {
        Self { lo, hi }
    }

    fn holds(&self, p: DVec2) -> bool {
        p.cmpge(self.lo).all() && p.cmple(self.hi).all()
    }

    /// Whether the box around a segment meets the window.
    fn meets(&self, a: DVec2, b: DVec2) -> bool {
        a.max(b).cmpge(self.lo).all() && a.min(b).cmple(self.hi).all()
    }

    /// The runs of a line whose segments meet the window. Ends of runs that are no ends of the line lie outside. A ring goes on
    /// through its first point.
    fn runs(&self, line: &[DVec2]) -> Vec<Vec<DVec2>> {
        let mut runs: Vec<Vec<DVec2>> = Vec::new();
        let mut is_open = false;
        for ends in line.windows(2) {
            let meets = self.meets(ends[0], ends[1]);
            match runs.last_mut().filter(|_| is_open) {
                Some(run) if meets => run.push(ends[1]),
                None if meets => runs.push(ends.to_vec()),
                _ => {}
            }
            is_open = meets;
        }
        let is_ring = line.len() > 3 && line.first() == line.last();
        if is_ring
            && is_open
            && runs.len() > 1
            && runs[0].first() == line.first()
            && let Some(mut last) = runs.pop()
        {
            last.extend(&runs[0][1..]);
            runs[0] = last;
        }
        runs
    }
}

/// The box around each line of a map.
pub fn boxes(map: &ContourMap) -> Vec<[DVec2; 2]> {
    let around = |line: &Contour| {
        line.points.iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], &p| [lo.min(p), hi.max(p)])
    };
    map.contours.iter().map(around).collect()
}

/// The part of a map around a tile, as bytes. Returns the number of vertices too.
pub fn encode(map: &ContourMap, boxes: &[[DVec2; 2]], window: &Window) -> (Vec<u8>, usize) {
    let (mut out, mut vertices) = (Out::default(), 0);
    let near = (0..).zip(&map.contours).zip(boxes).filter(|(_, [lo, hi])| window.meets(*lo, *hi));
    let runs: Vec<(usize, &Contour, Vec<DVec2>)> =
        near.flat_map(|((k, line), _)| window.runs(&line.points).into_iter().map(move |run| (k, line, run))).collect();
    out.count(runs.len());
    for (number, line, run) in runs {
        out.count(number);
        out.number(line.elevation);
        out.count(line.feature.file().unwrap_or(0) as usize);
        out.count(line.feature.number() as usize);
        out.points(&run);
        vertices += run.len();
    }
    let spots: Vec<&DVec3> = map.spots.iter().filter(|spot| window.holds(spot.truncate())).collect();
    out.count(spots.len());
    for spot in spots {
        out.0.extend(spot.to_array().iter().flat_map(|v| v.to_le_bytes()));
    }
    let soft: Vec<&SoftSpot> = map.soft_spots.iter().filter(|spot| window.holds(spot.place.truncate())).collect();
    out.count(soft.len());
    for spot in soft {
        out.0.extend(spot.place.to_array().iter().chain([&spot.sigma]).flat_map(|v| v.to_le_bytes()));
    }
    let mended: Vec<DVec2> = map.mended.iter().copied().filter(|p| window.holds(*p)).collect();
    out.points(&mended);
    (out.0, vertices)
}

/// The part of a map around a tile.
pub struct Around {
    /// The lines and points.
    pub map: ContourMap,
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
        for _ in 0..bytes.count(40)? {
            numbers.push(bytes.whole()? as u32);
            let elevation = bytes.number()?;
            let (file, number) = (bytes.whole()? as u32, bytes.whole()?);
            let feature = FeatureId::from(number).in_file(file);
            map.contours.push(Contour { elevation, points: bytes.points()?, feature });
        }
        for _ in 0..bytes.count(24)? {
            map.spots.push(bytes.point()?.extend(bytes.number()?));
        }
        for _ in 0..bytes.count(32)? {
            map.soft_spots.push(SoftSpot { place: bytes.point()?.extend(bytes.number()?), sigma: bytes.number()? });
        }
        map.mended = bytes.points()?;
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
        Ok(Self { map, lines })
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
        let (bytes, vertices) = encode(&map, &boxes(&map), &window);
        let around = Around::decode(&bytes, Path::new("x")).unwrap();
        assert_eq!((around.map.contours.len(), vertices), (1, runs[0].len()));
        assert_eq!(around.map.contours[0], Contour { points: runs[0].clone(), ..map.contours[1].clone() });
        assert_eq!(around.map.spots, map.spots[..1]);
        assert_eq!(around.line_of(&runs[0][1..3]), Some(1));
        for cut in 0..bytes.len() {
            assert!(Around::decode(&bytes[..cut], Path::new("x")).is_err());
        }
    }
}
