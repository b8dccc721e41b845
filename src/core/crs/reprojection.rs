//! Keeps the original coordinates of a map's vertices while the map is on the working plane.
//!
//! A projection and its inverse do not return the last bits. So each vertex of the input is stored with its position on
//! the plane. On output it gets its own coordinates again. Only new vertices use the inverse projection.
//!
//! On the plane, coordinates are whole micrometres, also for maps that are in a plane system already. Smaller digits
//! are noise of a projection or of a sum. They would decide between surfaces that are equally good. So a map that was
//! converted to degrees and back gives the same lines again.

use std::collections::HashSet;
use std::sync::Arc;

use geo::{Coord, LineString, MapCoords, MultiPolygon, Polygon};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::definition::label;
use super::originals::{Key, Originals, in_order, on_steps};
use super::system::Crs;
use super::transform::Transform;
use crate::base::bits::bits;
use crate::base::error::{CrsNeed, Error, Finding, FindingKind, Report, Result};
use crate::base::{ElevationUnit, parallel};

/// Largest distance from a boundary to the straight piece between two of its vertices on the plane, metres.
const STRAIGHT: f64 = 1e-3;
/// Metres in a degree of latitude, about.
const DEGREE: f64 = 111_000.0;
/// Largest number of times that a piece of a boundary is halved.
const HALVINGS: u32 = 12;

/// The relation between the plane on which a map is worked on and the coordinates of its file.
#[derive(Debug, Clone, Default)]
pub struct Reprojection {
    /// The system of the file.
    input: Option<Crs>,
    /// The system of the plane.
    working: Option<Crs>,
    way: Option<Transform>,
    /// Whether coordinates on the plane are whole micrometres.
    in_steps: bool,
    originals: Arc<Originals>,
    /// The middle longitude of the file, if some longitudes are beyond 180 degrees.
    around: Option<f64>,
    /// Heights that [`ElevationUnit::from_metres`] does not give back bit for bit.
    heights: Arc<OddHeights>,
}

/// Heights of a file that come back from metres as a number beside their own: metres, and the number in the file; in the order
/// of the metres. Few maps have such heights.
#[derive(Debug, Default)]
struct OddHeights {
    unit: ElevationUnit,
    pairs: Vec<[f64; 2]>,
}

impl Reprojection {
    /// For a map that is worked on in its own coordinates.
    pub fn unmoved(crs: Option<Crs>) -> Self {
        let working = crs.as_ref().map(|crs| crs.with_heights_in(ElevationUnit::Metre));
        Self { input: crs, working, ..Self::default() }
    }

    /// Projects points to the plane of a projected system. Coordinates are transformed, if it is another system than
    /// `input`, and rounded to whole micrometres.
    ///
    /// The vertices of `lines` are stored and come back bit for bit. Vertices that would become equal by rounding keep
    /// all their digits. If they are equal even so, they become one vertex, with a finding. `others` are projected too,
    /// but not stored.
    ///
    /// # Errors
    /// [`Error::Data`] if there is no transformation between the systems, [`Error::NoPlace`] if a point cannot be
    /// projected. The points are then unusable.
    pub fn project(
        lines: &mut [&mut [DVec2]],
        others: &mut [DVec2],
        input: &Crs,
        working: &Crs,
    ) -> Result<Report<Self>> {
        let way = Transform::between(input, working)?;
        let forward = |p: DVec2| way.forward(p).ok_or_else(|| no_place(p, input, working));
        let pair = |p: &DVec2| Ok((bits(on_steps(forward(*p)?)), *p));
        let pairs = |line: &&mut [DVec2]| line.iter().map(pair).collect::<Result<Vec<(Key, DVec2)>>>();
        let pairs = parallel::map_each(lines, pairs).into_iter().collect::<Result<Vec<_>>>()?;
        let mut originals = in_order(pairs.concat());
        check_way(&way, &originals, input, working)?;
        let same_place = originals.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        let crowded: HashSet<Key> = same_place.map(|pair| pair[0].0).collect();
        let place = |p: DVec2| -> Result<DVec2> {
            let exact = forward(p)?;
            let place = on_steps(exact);
            Ok(if crowded.contains(&bits(place)) { exact } else { place })
        };
        lines.par_iter_mut().flat_map_iter(|line| line.iter_mut()).try_for_each(|p| {
            *p = place(*p)?;
            Ok::<(), Error>(())
        })?;
        for p in others {
            *p = place(*p)?;
        }
        let mut findings = Vec::new();
        if !crowded.is_empty() {
            for (k, original) in &mut originals {
                *k = if crowded.contains(k) { bits(forward(*original)?) } else { *k };
            }
            originals = in_order(originals);
            let before = originals.len();
            originals.dedup_by_key(|(k, _)| *k);
            findings.extend(coinciding(before - originals.len()));
        }
        let around = input.is_geographic().then(|| beyond(&originals)).flatten();
        if way.is_identity() {
            // Most coordinates have no digits below a micrometre. These need not be stored.
            originals.retain(|(k, p)| *k != p.to_array().map(f64::to_bits));
        }
        let reprojection = Self {
            input: Some(input.clone()),
            working: Some(working.clone()),
            way: (!way.is_identity()).then_some(way),
            in_steps: true,
            originals: Arc::new(Originals::new(originals, crowded)),
            around,
            heights: Arc::default(),
        };
        Ok(Report { value: reprojection, findings })
    }

    /// The same with the heights of the file in `unit`, so that outputs in this unit have the very numbers of the file.
    pub fn with_heights(self, unit: ElevationUnit, heights: impl IntoIterator<Item = f64>) -> Self {
        let pair = |height: f64| [unit.metres(height), height];
        let is_odd = |[metres, height]: &[f64; 2]| unit.from_metres(*metres).to_bits() != height.to_bits();
        let mut pairs: Vec<[f64; 2]> = heights.into_iter().map(pair).filter(is_odd).collect();
        pairs.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        pairs.dedup_by_key(|[metres, _]| metres.to_bits());
        Self { heights: Arc::new(OddHeights { unit, pairs }), ..self }
    }

    /// Stores vertices of another file, which states `crs`, so that these come back bit for bit too. In another system than
    /// that of the map's file, they cannot.
    ///
    /// # Errors
    /// As [`Transform::between`].
    pub fn keep(&mut self, vertices: impl Iterator<Item = DVec2>, crs: Option<&Crs>) -> Result<()> {
        let is_same = match (self.of_side(crs), &self.input) {
            (Some(side), Some(own)) => Transform::between(side, own)?.is_identity(),
            _ => false,
        };
        if self.in_steps && is_same {
            self.originals = Arc::new(self.originals.with(vertices, self.way.as_ref()));
        }
        Ok(())
    }

    /// Whether the map is worked on in the system of its file.
    pub fn are_unmoved(&self) -> bool {
        self.way.is_none()
    }

    /// The system of the file, if it is known.
    pub fn input_crs(&self) -> Option<&Crs> {
        self.input.as_ref()
    }

    /// The system of the plane, if it is known.
    pub fn working_crs(&self) -> Option<&Crs> {
        self.working.as_ref()
    }

    /// The position in the file's coordinates: a vertex gets its original coordinates, another point those of the
    /// inverse projection. `None` if there are none.
    pub fn in_input(&self, p: DVec2) -> Option<DVec2> {
        if let Some(original) = self.original(p) {
            return Some(original);
        }
        let Some(way) = &self.way else { return Some(p) };
        let found = way.inverse(p)?;
        Some(match self.around {
            Some(middle) => DVec2::new(middle + (found.x - middle + 180.0).rem_euclid(360.0) - 180.0, found.y),
            None => found,
        })
    }

    /// The position on the plane of a position in the file's coordinates.
    pub fn on_plane(&self, p: DVec2) -> Option<DVec2> {
        self.way.as_ref().map_or(Some(p), |way| way.forward(p))
    }

    fn original(&self, p: DVec2) -> Option<DVec2> {
        self.originals.at(p, self.way.as_ref())
    }

    /// The system of the file, if it is the plane of a drawing in another unit than metres. Then results are in this unit
    /// too: nobody knows the plane on which the map is worked on.
    pub fn plane_of_drawing(&self) -> Option<&Crs> {
        self.input.as_ref().filter(|crs| !self.are_unmoved() && crs.is_local())
    }

    /// The system of another file, which states `crs`. If it states none, it is that of the map. It is so too if only one
    /// of the two files names a system, and the other one states the same unit.
    pub fn of_side<'a>(&'a self, crs: Option<&'a Crs>) -> Option<&'a Crs> {
        match (crs, &self.input) {
            (Some(crs), Some(own)) if crs.is_unnamed_plane() != own.is_unnamed_plane() && is_same_unit(crs, own) => {
                Some(own)
            }
            (Some(crs), _) => Some(crs),
            (None, own) => own.as_ref(),
        }
    }

    /// The transformation for coordinates of another file, see [`Reprojection::of_side`].
    ///
    /// # Errors
    /// As [`Transform::between`].
    pub fn bring(&self, crs: Option<&Crs>) -> Result<ToWorking> {
        let (from, to) = match (self.of_side(crs), &self.working) {
            (Some(from), Some(to)) => (from, to),
            _ => return Ok(ToWorking { way: None, in_steps: self.in_steps, straight: STRAIGHT, names: String::new() }),
        };
        let way = Transform::between(from, to)?;
        let names = format!("{} and {}", label(from), label(to));
        // Height maps stay in degrees and feet.
        let unit = if to.is_geographic() { DEGREE } else { to.length_unit().map_or(1.0, |unit| unit.metres) };
        let straight = STRAIGHT / unit;
        Ok(ToWorking { way: (!way.is_identity()).then_some(way), in_steps: self.in_steps, straight, names })
    }

    /// The transformation to the output: to the coordinates of the file, or to those of the system `to`.
    ///
    /// # Errors
    /// As [`Transform::between`], and if `to` is given and the system of the file is not known.
    pub fn from_working(&self, to: Option<&Crs>) -> Result<FromWorking> {
        let Some(to) = to else {
            return Ok(FromWorking::new(self, Target::Input, self.input.as_ref()));
        };
        let (Some(input), Some(working)) = (&self.input, &self.working) else {
            return Err(Error::UnknownCrs { needed_for: CrsNeed::OtherOutput });
        };
        if input.is_unnamed_plane() && !to.is_local() {
            return Err(Error::UnknownCrs { needed_for: CrsNeed::OtherOutput });
        }
        let target = if to.horizontal().matches(&input.horizontal()) {
            Target::Input
        } else {
            Target::Other { from_input: Transform::between(input, to)?, from_working: Transform::between(working, to)? }
        };
        Ok(FromWorking::new(self, target, Some(to)))
    }
}

/// Whether both systems have plane coordinates in the same unit.
fn is_same_unit(a: &Crs, b: &Crs) -> bool {
    let units = a.length_unit().zip(b.length_unit());
    units.is_some_and(|(a, b)| (a.metres - b.metres).abs() <= 1e-9 * b.metres)
}

fn no_place(p: DVec2, from: &Crs, to: &Crs) -> Error {
    Error::NoPlace { place: p, from: label(from), to: label(to) }
}

/// Outside the area that they are made for, some projections give coordinates that do not lead back.
fn check_way(way: &Transform, originals: &[(Key, DVec2)], from: &Crs, to: &Crs) -> Result<()> {
    let step = originals.len().div_ceil(1024).max(1);
    for (k, original) in originals.iter().step_by(step) {
        let place = DVec2::new(f64::from_bits(k[0]), f64::from_bits(k[1]));
        let back = way.inverse(place).and_then(|back| way.forward(back));
        if !back.is_some_and(|back| back.distance(place) < 1e-3) {
            return Err(no_place(*original, from, to));
        }
    }
    Ok(())
}

/// The middle longitude, if longitudes go beyond 180 degrees.
fn beyond(originals: &[(Key, DVec2)]) -> Option<f64> {
    let span = |(lo, hi): (f64, f64), (_, p): &(Key, DVec2)| (lo.min(p.x), hi.max(p.x));
    let (lo, hi) = originals.iter().fold((f64::INFINITY, f64::NEG_INFINITY), span);
    (lo < -180.0 || hi > 180.0).then_some(0.5 * (lo + hi))
}

/// Transforms the coordinates of other files to the plane of the map.
#[derive(Debug, Clone)]
pub struct ToWorking {
    way: Option<Transform>,
    in_steps: bool,
    /// Largest distance from a boundary to the straight piece between two of its vertices, units of the plane.
    straight: f64,
    names: String,
}

impl ToWorking {
    fn place(&self, p: DVec2) -> Result<DVec2> {
        let wrong = || Error::Data(format!("{:?} {:?} exists in only one of the systems {}", p.x, p.y, self.names));
        let place = self.way.as_ref().map_or(Some(p), |way| way.forward(p)).ok_or_else(wrong)?;
        Ok(if self.in_steps { on_steps(place) } else { place })
    }

    /// A point with its height.
    ///
    /// # Errors
    /// [`Error::Data`] if it cannot be projected to the plane.
    pub fn point(&self, p: DVec3) -> Result<DVec3> {
        Ok(self.place(p.truncate())?.extend(p.z))
    }

    /// A polygon, by its vertices.
    ///
    /// # Errors
    /// [`Error::Data`] if a vertex cannot be projected to the plane.
    pub fn polygon(&self, polygon: &Polygon<f64>) -> Result<Polygon<f64>> {
        polygon.try_map_coords(|c| self.place(DVec2::new(c.x, c.y)).map(|p| Coord { x: p.x, y: p.y }))
    }

    /// A boundary. Vertices are added where a straight piece is a curve on the plane: the edge of a map along a
    /// parallel is long, and contours end on it.
    ///
    /// # Errors
    /// [`Error::Data`] if a vertex cannot be projected to the plane.
    pub fn boundary(&self, area: &MultiPolygon<f64>) -> Result<MultiPolygon<f64>> {
        if self.way.is_none() {
            return area.try_map_coords(|c| self.place(DVec2::new(c.x, c.y)).map(|p| Coord { x: p.x, y: p.y }));
        }
        let ring = |ring: &LineString<f64>| -> Result<LineString<f64>> {
            let mut out = Vec::with_capacity(ring.0.len());
            for line in ring.lines() {
                let [a, b] = [line.start, line.end].map(|c| DVec2::new(c.x, c.y));
                let (p, q) = (self.place(a)?, self.place(b)?);
                out.push(p);
                self.bend([a, b], [p, q], HALVINGS, &mut out)?;
            }
            out.extend(out.first().copied());
            Ok(out.into_iter().map(|p| Coord { x: p.x, y: p.y }).collect())
        };
        let polygon = |polygon: &Polygon<f64>| -> Result<Polygon<f64>> {
            let holes = polygon.interiors().iter().map(ring).collect::<Result<_>>()?;
            Ok(Polygon::new(ring(polygon.exterior())?, holes))
        };
        Ok(MultiPolygon::new(area.iter().map(polygon).collect::<Result<_>>()?))
    }

    /// How far a [`boundary`](Self::boundary) may be from its place, units of the plane, where straight pieces of it are curves.
    pub fn straight(&self) -> Option<f64> {
        self.way.as_ref().map(|_| self.straight)
    }

    /// Adds the vertices between two neighbouring vertices on the plane.
    fn bend(&self, [a, b]: [DVec2; 2], [p, q]: [DVec2; 2], halvings: u32, out: &mut Vec<DVec2>) -> Result<()> {
        let c = a.midpoint(b);
        let r = self.place(c)?;
        if halvings == 0 || r.distance(p.midpoint(q)) < self.straight {
            return Ok(());
        }
        self.bend([a, c], [p, r], halvings - 1, out)?;
        out.push(r);
        self.bend([c, b], [r, q], halvings - 1, out)
    }
}

/// Transforms positions on the plane to the coordinates of the output, and heights to their unit there.
#[derive(Debug, Clone)]
pub struct FromWorking {
    reprojection: Reprojection,
    target: Target,
    /// The system as it was given.
    whole: Option<Crs>,
    /// The same for heights in the unit of the output.
    crs: Option<Crs>,
    unit: ElevationUnit,
    has_depths: bool,
}

#[derive(Debug, Clone)]
enum Target {
    /// To the system of the file.
    Input,
    /// To another system. Vertices of the input are transformed from their own coordinates.
    Other { from_input: Transform, from_working: Transform },
}

impl FromWorking {
    fn new(reprojection: &Reprojection, target: Target, crs: Option<&Crs>) -> Self {
        let (reprojection, whole) = (reprojection.clone(), crs.cloned());
        Self { reprojection, target, whole, crs: None, unit: ElevationUnit::Metre, has_depths: false }
            .with_heights_in(ElevationUnit::Metre)
    }

    /// The same for an output with its heights in `unit`. Without this, they are in metres.
    pub fn with_heights_in(self, unit: ElevationUnit) -> Self {
        let crs = self.whole.as_ref().map(|crs| crs.with_heights_in(unit));
        Self { crs, unit, ..self }
    }

    /// The same for an output that has depths, positive downwards, beside its heights.
    pub fn with_depths(self) -> Self {
        Self { has_depths: true, ..self }
    }

    /// Whether the output has depths beside its heights.
    pub fn has_depths(&self) -> bool {
        self.has_depths
    }

    /// The same to the system `to`.
    ///
    /// # Errors
    /// As [`Reprojection::from_working`].
    pub fn to(&self, to: &Crs) -> Result<Self> {
        let to = self.reprojection.from_working(Some(to))?.with_heights_in(self.unit);
        Ok(Self { has_depths: self.has_depths, ..to })
    }

    /// The unit of heights in the output.
    pub fn unit(&self) -> ElevationUnit {
        self.unit
    }

    /// A height on the plane, which is in metres, in the unit of the output.
    ///
    /// A height of the file is the number that the file has. Files of other programs have heights such as
    /// 1246.716705938243 feet.
    pub fn height(&self, metres: f64) -> f64 {
        let OddHeights { unit, pairs } = &*self.reprojection.heights;
        let known = pairs.binary_search_by(|[known, _]| known.total_cmp(&metres)).ok().filter(|_| *unit == self.unit);
        known.and_then(|k| pairs.get(k)).map_or_else(|| self.unit.from_metres(metres), |[_, height]| *height)
    }

    /// The system of the output, if it is known. It has no vertical part in another unit than the heights.
    pub fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    /// Whether positions on the plane need no transformation.
    pub fn is_identity(&self) -> bool {
        match &self.target {
            Target::Input => self.reprojection.are_unmoved() && self.reprojection.originals.len() == 0,
            Target::Other { from_working, .. } => from_working.is_identity(),
        }
    }

    /// The position in the coordinates of the output, for a sentence.
    pub fn place_in_words(&self, p: DVec2) -> String {
        let decimals = if self.crs.as_ref().is_some_and(Crs::is_geographic) { 7 } else { 3 };
        let words = |p: DVec2| format!("{:.decimals$} {:.decimals$}", p.x, p.y);
        self.place(p).map_or("a place outside the coordinate reference system".to_owned(), words)
    }

    /// The position in the coordinates of the output; `None` if it has none.
    pub fn place(&self, p: DVec2) -> Option<DVec2> {
        match &self.target {
            Target::Input => self.reprojection.in_input(p),
            Target::Other { from_input, from_working } => match self.reprojection.original(p) {
                Some(original) if !from_working.is_identity() => from_input.forward(original),
                _ => from_working.forward(p),
            },
        }
    }
}

/// The finding about vertices that coincide after projection; none if there are none.
fn coinciding(count: usize) -> Option<Finding> {
    let message = || {
        format!("{count} vertices coincide with another one after projection; they are written with its coordinates")
    };
    (count > 0).then(|| Finding::general(FindingKind::RepeatedPoint, message()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of these points, brought from one system to another.
    fn project(from: u32, points: &[[f64; 2]], to: u32) -> Result<Report<(Vec<DVec2>, Reprojection)>> {
        let mut points: Vec<DVec2> = points.iter().map(|p| DVec2::from(*p)).collect();
        let report = Reprojection::project(&mut [&mut points], &mut [], &Crs::from_epsg(from), &Crs::from_epsg(to))?;
        Ok(Report { value: (points, report.value), findings: report.findings })
    }

    #[test]
    fn vertices_come_back_bit_for_bit_and_others_nearly() {
        let points: Vec<[f64; 2]> =
            (0..2000).map(|k| [138.7 + f64::from(k) * 0.000_137, 35.3 + f64::from(k * k % 977) * 0.000_031]).collect();
        let report = project(6668, &points, 6676).unwrap();
        assert!(report.findings.is_empty());
        let (flat, reprojection) = report.value;
        assert_eq!(reprojection.working_crs().and_then(|crs| crs.epsg), Some(6676));
        let back = reprojection.from_working(None).unwrap();
        for (p, q) in points.iter().zip(&flat) {
            assert_eq!(back.place(*q).map(|p| p.to_array().map(f64::to_bits)), Some(p.map(f64::to_bits)));
            let near = back.place(*q + DVec2::splat(1e-5)).unwrap();
            assert!(near.distance(DVec2::from(*p)) < 2e-10);
        }
        assert!(points.iter().any(|p| {
            let way = Transform::between(&Crs::from_epsg(6668), &Crs::from_epsg(6676)).unwrap();
            way.inverse(way.forward(DVec2::from(*p)).unwrap()) != Some(DVec2::from(*p))
        }));
        // To another system they go from their own coordinates.
        let target = reprojection.from_working(Some(&Crs::from_epsg(32654))).unwrap();
        let way = Transform::between(&Crs::from_epsg(6668), &Crs::from_epsg(32654)).unwrap();
        assert_eq!(target.place(flat[7]), way.forward(DVec2::from(points[7])));
        assert_eq!(target.crs().and_then(|crs| crs.epsg), Some(32654));
    }

    #[test]
    fn coordinates_that_were_projected_come_back_to_where_they_were() {
        let metric: Vec<DVec2> = (0..500)
            .map(|k| DVec2::new(436_265.68 + f64::from(k) * 0.37, 6_444_259.96 + f64::from(k) * 0.11))
            .collect();
        let metric: Vec<DVec2> = metric.into_iter().map(|p| (p * 100.0).round() / 100.0).collect();
        let way = Transform::between(&Crs::wgs84(), &Crs::from_epsg(25832)).unwrap();
        let degrees: Vec<[f64; 2]> = metric.iter().map(|p| way.inverse(*p).unwrap().to_array()).collect();
        let (flat, _) = project(4326, &degrees, 25832).unwrap().value;
        assert_eq!(flat, metric);
    }

    #[test]
    fn vertices_that_fall_together_keep_their_digits_or_are_reported() {
        // Three hundred nanometres apart.
        let near = [[138.7, 35.3], [138.7 + 3e-12, 35.3], [138.8, 35.3]];
        let report = project(6668, &near, 6676).unwrap();
        assert!(report.findings.is_empty(), "{:?}", report.findings);
        let (flat, reprojection) = report.value;
        for (p, q) in near.iter().zip(&flat) {
            assert_eq!(reprojection.in_input(*q).map(|p| p.to_array()), Some(*p));
        }
        // Near the meridian of Greenwich degrees have more digits than metres far from the equator.
        let nearest = [[1e-18, 60.0], [2e-18, 60.0], [0.1, 60.0]];
        let report = project(4326, &nearest, 32631).unwrap();
        assert_eq!(report.findings.len(), 1, "{:?}", report.findings);
    }

    #[test]
    fn noise_in_metres_is_taken_off_and_given_back() {
        let noisy = [[436_203.790_000_000_04, 6_444_375.560_000_000_5], [436_265.68, 6_444_259.96]];
        let (flat, reprojection) = project(25832, &noisy, 25832).unwrap().value;
        assert_eq!(flat[0], DVec2::new(436_203.79, 6_444_375.56));
        assert!(reprojection.are_unmoved() && reprojection.originals.len() == 1);
        let back = reprojection.from_working(None).unwrap();
        assert!(!back.is_identity());
        for (p, q) in noisy.iter().zip(&flat) {
            assert_eq!(back.place(*q).map(|p| p.to_array()), Some(*p));
        }
        assert_eq!(back.place(DVec2::new(0.1, 0.2)), Some(DVec2::new(0.1, 0.2)));
    }

    #[test]
    fn places_that_are_none_are_refused() {
        for points in [[[138.7, 35.3], [138.7, 95.0]], [[138.7, 35.3], [48.5, 0.0]]] {
            let error = project(6668, &points, 6676).unwrap_err();
            assert!(matches!(&error, Error::NoPlace { .. }), "{error}");
            assert!(error.to_string().ends_with("is that the right coordinate reference system?"), "{error}");
        }
    }

    #[test]
    fn longitudes_beyond_180_stay_there() {
        let (flat, reprojection) = project(4326, &[[179.9, -17.0], [180.2, -17.1]], 32701).unwrap().value;
        let middle = flat[0].midpoint(flat[1]);
        assert!((reprojection.in_input(middle).unwrap().x - 180.05).abs() < 1e-3);
    }

    #[test]
    fn boundaries_bend_and_lakes_do_not() {
        let (_, reprojection) = project(6668, &[[138.7, 35.3], [138.8, 35.4]], 6676).unwrap().value;
        let to_working = reprojection.bring(None).unwrap();
        let corners = [(138.75, 35.3), (138.875, 35.3), (138.875, 35.4), (138.75, 35.4), (138.75, 35.3)];
        let sheet = Polygon::new(LineString::from(corners.to_vec()), Vec::new());
        assert_eq!(to_working.polygon(&sheet).unwrap().exterior().0.len(), 5);
        let bent = to_working.boundary(&MultiPolygon::new(vec![sheet])).unwrap();
        let ring = bent.0[0].exterior();
        assert!(ring.is_closed() && ring.0.len() > 30 && ring.0.len() < 300, "{}", ring.0.len());
        // Ends on the parallel lie within the tolerance of the boundary.
        let end = to_working.point(DVec3::new(138.79, 35.3, 5.0)).unwrap();
        let off = ring.lines().map(|l| {
            let [a, b] = [l.start, l.end].map(|c| DVec2::new(c.x, c.y));
            let t = ((end.truncate() - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            a.lerp(b, t).distance(end.truncate())
        });
        assert!(off.fold(f64::INFINITY, f64::min) < 2e-3);
    }
}
